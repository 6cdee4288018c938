#include "oracle/oracle_scene.h"

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

/* The points of the plane that may be the farthest of a part that lines bound: (u, v), and the part's lines. */
typedef struct clipped_part {
  double lines[3][3];
  int n_lines, n_points;
  double places[2][2]; /* minimum and maximum in x, y */
} clipped_part;

static void add_point(const oracle_view *view, const oracle_placed *s, double u, double v, clipped_part *part) {
  const conic_camera *c = &view->camera;
  double at[3], place[2];
  if (!(u * u + v * v <= view->cutoff * view->cutoff * (1.0 + 1e-9)))
    return;
  for (int i = 0; i < part->n_lines; i++) {
    const double *l = part->lines[i];
    if (!(l[0] * u + l[1] * v + l[2] >= -1e-9 * (fabs(l[0] * u) + fabs(l[1] * v) + fabs(l[2]))))
      return;
  }
  for (int i = 0; i < 3; i++)
    at[i] = s->p[i] + u * s->tu[i] + v * s->tv[i];
  at[2] = oracle_max(at[2], view->near_z);
  place[0] = c->fx * at[0] / at[2] + c->cx;
  place[1] = c->fy * at[1] / at[2] + c->cy;
  for (int i = 0; i < 2; i++) {
    part->places[0][i] = part->n_points ? oracle_min(part->places[0][i], place[i]) : place[i];
    part->places[1][i] = part->n_points ? oracle_max(part->places[1][i], place[i]) : place[i];
  }
  part->n_points++;
}

/* Where a line of the plane meets the outline, from its foot. */
static void add_chord(const oracle_view *view, const oracle_placed *s, const double l[3], clipped_part *part) {
  double squared = l[0] * l[0] + l[1] * l[1], away = l[2] / squared;
  double half = sqrt(view->cutoff * view->cutoff / squared - away * away);
  for (int side = -1; side <= 1 && oracle_is_finite(half); side += 2)
    add_point(view, s, -away * l[0] - side * half * l[1], -away * l[1] + side * half * l[0], part);
}

/* Extremes lie where lines meet the outline or each other, or where a column or row of the screen touches the outline.
 */
static void find_corner_places(const oracle_view *view, const oracle_placed *s, clipped_part *part) {
  part->n_points = 0;
  for (int axis = 0; axis < 2; axis++) {
    /* In homogeneous coordinates the lines of all columns run through one point of the plane, where x and z are 0. The
     * lines among them that touch the outline do so on that point's polar. */
    const double column[3] = {s->tu[axis], s->tv[axis], s->p[axis]}, depth[3] = {s->tu[2], s->tv[2], s->p[2]};
    double pole[3], f = view->cutoff;
    oracle_cross(column, depth, pole);
    const double polar[3] = {pole[0], pole[1], -f * f * pole[2]};
    add_chord(view, s, polar, part);
  }
  for (int i = 0; i < part->n_lines; i++) {
    add_chord(view, s, part->lines[i], part);
    for (int j = 0; j < i; j++) {
      double corner[3];
      oracle_cross(part->lines[i], part->lines[j], corner);
      add_point(view, s, corner[0] / corner[2], corner[1] / corner[2], part);
    }
  }
}

/* The box of the part of the disc, before near, that the lines leave: that all of them keep, or that either keeps. */
static void set_box(const oracle_view *view, const oracle_placed *s, const conic_clip *given, oracle_clip *clip) {
  double lines[2][3];
  int n_lines = 0;
  for (int i = 0; i < given->n_lines && i < 2; i++)
    if (is_line(given->lines[i])) {
      for (int k = 0; k < 3; k++)
        lines[n_lines][k] = (double)given->lines[i][k];
      n_lines++;
    }
  int is_or = n_lines == 2 && given->operation == CONIC_CLIP_OR;
  clip->has_box = n_lines > 0 && view->method != CONIC_METHOD_DISC && view->method != CONIC_METHOD_POINT;
  for (int i = 0; i < 2; i++) {
    clip->box[0][i] = INFINITY;
    clip->box[1][i] = -INFINITY;
  }
  for (int k = 0; k < (is_or ? 2 : 1); k++) {
    clipped_part part = {{{s->tu[2], s->tv[2], s->p[2] - view->near_z}}, 1, 0, {{0.0, 0.0}, {0.0, 0.0}}};
    for (int i = 0; i < n_lines; i++)
      if (!is_or || i == k) {
        for (int j = 0; j < 3; j++)
          part.lines[part.n_lines][j] = lines[i][j];
        part.n_lines++;
      }
    find_corner_places(view, s, &part);
    for (int i = 0; i < 2 && part.n_points; i++) {
      clip->box[0][i] = oracle_min(clip->box[0][i], part.places[0][i] - view->reach_px - overlap_px);
      clip->box[1][i] = oracle_max(clip->box[1][i], part.places[1][i] + view->reach_px + overlap_px);
    }
  }
}

void conic_oracle_clip(const oracle_view *view, const oracle_placed *s, const conic_clip *given, double extent,
                       oracle_clip *clip) {
  const conic_camera *camera = &view->camera;
  double normal[3], plane[3];
  clip->n_lines = clip->is_or = clip->is_unsure = clip->has_box = 0;
  if (!given)
    return;
  oracle_cross(s->tu, s->tv, normal);
  double hand = oracle_dot(normal, s->p), longer = oracle_max(oracle_length(s->tu), oracle_length(s->tv));
  clip->is_unsure = !(fabs(hand) > 1e-13 * oracle_length(normal) * (extent + oracle_length(s->p)));
  double nearest = oracle_max(view->near_z, s->p[2] - 2.0 * view->cutoff * longer);
  double roundoff = oracle_max(1e-15, view->floats.centre);
  clip->position_error = 1e-9 + roundoff * extent * oracle_max(camera->fx, camera->fy) / nearest +
                         view->floats.place * (camera->width + camera->height);
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
  set_box(view, s, given, clip);
}

/* The lesser of both margins, with the error that is its own. */
static double within_box(const oracle_clip *clip, double x, double y, double margin, double *error) {
  const double place[2] = {x, y};
  for (int i = 0; i < 2 && clip->has_box; i++) {
    double kept = oracle_min(place[i] - clip->box[0][i], clip->box[1][i] - place[i]);
    if (kept < margin) {
      margin = kept;
      *error = 100.0 * clip->position_error; /* a chord's end moves by more than its line */
    }
  }
  return margin;
}

double conic_oracle_clip_margin(const oracle_clip *clip, double x, double y, double reach_px, double *error) {
  double margin = clip->is_or ? -INFINITY : INFINITY;
  *error = 0.0;
  for (int i = 0; i < clip->n_lines; i++) {
    const double *line = clip->lines[i];
    double kept = line[0] * x + line[1] * y + line[2] + overlap_px;
    margin = clip->is_or ? oracle_max(margin, kept) : oracle_min(margin, kept);
    *error = oracle_max(*error, ORACLE_ROUNDINGS * ORACLE_UNIT * (fabs(kept) + reach_px) + clip->position_error);
  }
  if (!clip->n_lines)
    margin = 1.0;
  if (clip->is_unsure)
    *error = INFINITY;
  return within_box(clip, x, y, margin, error);
}
