#include "raster/oracle_clip.h"

/* Mates overlap by twice this. */
static const double overlap_px = 0.00390625;

/* The plane through the eye and the line: two points of the line in space span it. Towards the kept side it is positive
 * where the splat's plane turns t_u, t_v, p to the right hand. Returns 0 where the eye is on the line. */
static int plane_of(const oracle_placed *s, const float given[3], double plane[3]) {
  double a = (double)given[0], b = (double)given[1], c = (double)given[2], squared = a * a + b * b;
  double foot[3], along[3];
  for (int i = 0; i < 3; i++) {
    foot[i] = s->p[i] - c / squared * (a * s->tu[i] + b * s->tv[i]);
    along[i] = a * s->tv[i] - b * s->tu[i];
  }
  oracle_cross(along, foot, plane);
  return oracle_length(plane) > 1e-12 * oracle_length(along) * oracle_length(foot);
}

static int is_line(const float given[3]) {
  double sum = (double)given[0] + (double)given[1] + (double)given[2];
  return oracle_is_finite(sum) && (given[0] != 0.0f || given[1] != 0.0f);
}

void conic_oracle_clip(const oracle_view *view, const oracle_placed *s, const conic_clip *given, double extent,
                       oracle_clip *clip) {
  const conic_camera *camera = &view->camera;
  double normal[3], plane[3];
  clip->n_lines = clip->is_or = clip->is_unsure = 0;
  if (!given)
    return;
  oracle_cross(s->tu, s->tv, normal);
  double hand = oracle_dot(normal, s->p), longer = oracle_max(oracle_length(s->tu), oracle_length(s->tv));
  clip->is_unsure = !(fabs(hand) > 1e-13 * oracle_length(normal) * (extent + oracle_length(s->p)));
  double nearest = oracle_max(view->near_z, s->p[2] - 2.0 * view->cutoff * longer);
  clip->position_error = 1e-9 + 1e-15 * extent * oracle_max(camera->fx, camera->fy) / nearest;
  for (int i = 0; i < given->n_lines && i < 2; i++) {
    if (!is_line(given->lines[i]))
      continue;
    if (!plane_of(s, given->lines[i], plane))
      clip->is_unsure = 1;
    double gradient[2] = {plane[0] / camera->fx, plane[1] / camera->fy};
    double steepness = sqrt(gradient[0] * gradient[0] + gradient[1] * gradient[1]);
    if (hand == 0.0 || !(steepness > 0.0))
      continue;
    double scale = (hand > 0.0 ? 1.0 : -1.0) / steepness, *line = clip->lines[clip->n_lines++];
    line[0] = gradient[0] * scale;
    line[1] = gradient[1] * scale;
    line[2] = (plane[2] - gradient[0] * camera->cx - gradient[1] * camera->cy) * scale;
  }
  clip->is_or = clip->n_lines == 2 && given->operation == CONIC_CLIP_OR;
}

double conic_oracle_clip_margin(const oracle_clip *clip, double x, double y, double reach_px, double *error) {
  double margin = clip->is_or ? -INFINITY : INFINITY;
  *error = 0.0;
  if (clip->is_unsure)
    *error = INFINITY;
  if (!clip->n_lines)
    return 1.0;
  for (int i = 0; i < clip->n_lines; i++) {
    const double *line = clip->lines[i];
    double kept = line[0] * x + line[1] * y + line[2] + overlap_px;
    margin = clip->is_or ? oracle_max(margin, kept) : oracle_min(margin, kept);
    *error = oracle_max(*error, ORACLE_ROUNDINGS * ORACLE_UNIT * (fabs(kept) + reach_px) + clip->position_error);
  }
  return margin;
}
