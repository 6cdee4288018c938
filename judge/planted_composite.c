#include "judge/planted_composite.h"

#include "core/splats/kernel.h"
#include "gaussians/draw/ray_meetings.h"
#include "gaussians/draw/surfaces_join.h"
#include "gaussians/draw/view_rays.h"

/* A fine pixel during compositing. */
typedef struct composite_sums {
  float T, color[3], weight, z, median_z, inverse_z, normal[3], count;
} composite_sums;

void conic_planted_place(const conic_planted_frame *frame, const uint16_t place[2], int box[2][2]) {
  const int size[2] = {frame->planted->camera.width, frame->planted->camera.height};
  for (int axis = 0; axis < 2; axis++) {
    box[0][axis] = (frame->samples * (place[axis] - frame->planted->moves[axis]) + size[axis]) % size[axis];
    box[1][axis] = box[0][axis] + frame->samples - 1;
    if (frame->planted->mirrors[axis]) {
      int last = size[axis] - 1 - box[0][axis];
      box[0][axis] = size[axis] - 1 - box[1][axis];
      box[1][axis] = last;
    }
  }
}

/* A pixel's place in the order of its tile of 16 × 16 (gaussians/draw/gaussian_tile.h). */
static size_t place_in_tile(int x, int y) {
  int place = ((y >> 2 & 3) * 4 + (x >> 2 & 3)) * 16 + (x & 3) * 4 + (y & 3);
  return (size_t)place;
}

static conic_ray_meeting meet_plain_ray(const conic_kept_gaussian *k, float dx, float dy) {
  const conic_gaussian_ray *r = &k->ray;
  float g[3], c[3];
  for (int i = 0; i < 3; i++) {
    g[i] = r->g[0][i] + r->g[1][i] * dx + r->g[2][i] * dy;
    c[i] = r->c[0][i] + r->c[1][i] * dx + r->c[2][i] * dy;
  }
  float squares = conic_square_of(g), one_over = 1.0f / squares;
  return (conic_ray_meeting){squares > 0.0f ? 0.5f * (conic_square_of(c) * one_over) : -1.0f,
                             (r->e[0] + r->e[1] * dx + r->e[2] * dy) * one_over, k->footprint.opacity};
}

/* Whether the tiles of a length, in pixels, from a centre hold a pixel, along an axis. */
static int is_in_tiles(int pixel, float offset, float length, int tile) {
  const float center = (float)pixel + 0.5f - offset, size = (float)tile;
  const int at = pixel / tile;
  return at >= (int)floorf((center - length) / size) && at < (int)ceilf((center + length) / size);
}

/* Whether a pixel is within some standard deviations, as other programs cut them off. */
static int is_in_extent(const conic_planted *p, const conic_gaussian_footprint *f, const int at[2], float dx,
                        float dy) {
  const conic_planted_extent extent = p->extent;
  const float determinant = f->form[0] * f->form[2] - f->form[1] * f->form[1];
  float xx = f->form[2] / determinant, yy = f->form[0] / determinant, half = 0.5f * (xx + yy);
  float apart = half * half - 1.0f / determinant, longest = half + sqrtf(apart > 0.1f ? apart : 0.1f);
  const int is_listed = extent >= CONIC_EXTENT_LISTED, step = (int)(extent - CONIC_EXTENT_BOX) % 6;
  const int is_box = step < 2, is_whole = step % 2, tile = conic_profile_tile(&p->rules, &p->camera);
  float x = p->extent_sigmas * sqrtf(is_box ? xx : longest), y = p->extent_sigmas * sqrtf(is_box ? yy : longest);
  if (is_whole) {
    x = ceilf(x);
    y = ceilf(y);
  }
  if (extent == CONIC_EXTENT_CIRCLE || extent == CONIC_EXTENT_WHOLE_CIRCLE)
    return dx * dx + dy * dy <= x * x;
  return is_listed ? is_in_tiles(at[0], dx, x, tile) && is_in_tiles(at[1], dy, y, tile)
                   : fabsf(dx) <= x && fabsf(dy) <= y;
}

/* Half of q, the depth and the opacity at the pixel. */
static conic_ray_meeting meet_kept(const conic_planted_frame *frame, const conic_kept_gaussian *k, int x, int y) {
  const conic_gaussian_footprint *f = &k->footprint;
  const float across = (float)(x - f->x) - frame->planted->shift_px[0];
  const float down = (float)(y - f->y) - frame->planted->shift_px[1];
  const float dx = across + f->dx, dy = down + f->dy;
  conic_gaussian_list list = {.footprints = f, .rays = &k->ray, .filters = &k->filter, .sights = &k->sight};
  conic_ray_meeting m = {-1.0f, f->z, f->opacity};
  list.is_parallel = frame->view->is_parallel;
  switch (frame->shape) {
  case CONIC_SHAPE_ELLIPSE:
    m.half_q = 0.5f * (f->form[0] * dx * dx + f->form[2] * dy * dy) + f->form[1] * dx * dy;
    break;
  case CONIC_SHAPE_RAY:
  case CONIC_SHAPE_SOLID:
    m = meet_plain_ray(k, across, down);
    break;
  case CONIC_SHAPE_DISC:
    m = meet_plain_ray(k, across, down);
    m.half_q = m.half_q < dx * dx + dy * dy ? m.half_q : dx * dx + dy * dy;
    break;
  case CONIC_SHAPE_FILTERED:
    return conic_meet_filtered(&list, 0, x, y);
  case CONIC_SHAPE_SIGHT:
  case CONIC_N_SHAPES: /* not a shape */
    list.tile_rays =
        &frame->view->rays->tiles[(size_t)(y / CONIC_GAUSSIAN_TILE) * (size_t)frame->view->rays->n_tiles[0] +
                                  (size_t)(x / CONIC_GAUSSIAN_TILE)];
    return conic_meet_sight(&list, 0, place_in_tile(x, y));
  }
  if (frame->planted->extent >= CONIC_EXTENT_BOX && frame->planted->extent <= CONIC_EXTENT_WHOLE_LISTED_SQUARE &&
      !is_in_extent(frame->planted, f, (const int[2]){x, y}, dx, dy))
    m.half_q = -1.0f;
  return m;
}

/* Returns α, or a negative number where nothing is composited. */
static float planted_alpha(const conic_planted_frame *frame, const conic_ray_meeting *m) {
  const conic_planted *p = frame->planted;
  const conic_gaussian_rules *rules = &frame->rules;
  const int is_ray = rules->shape == CONIC_SHAPE_RAY || rules->shape == CONIC_SHAPE_SOLID;
  const int is_tiny = !(m->half_q >= 0.0f && m->half_q < 80.0f); /* mistakes reach where exp_negative does not */
  float value = conic_exp_negative(is_tiny ? -80.0f : -m->half_q), most = rules->greatest_half_q;
  if (rules->fall_end > 0.0f)
    value = (value - rules->fall_end) * rules->fall_factor;
  if (!(m->half_q >= 0.0f) || (is_ray && !(m->z > 0.0f)) || (most > 0.0f && m->half_q > most) ||
      (p->extent == CONIC_EXTENT_ELLIPSE && m->half_q > 0.5f * p->extent_sigmas * p->extent_sigmas) ||
      (rules->shape == CONIC_SHAPE_DISC && rules->disc_near > 0.0f && m->z < rules->disc_near))
    return -1.0f;
  if (p->falloff_end > 0.0f) {
    const float end = conic_exp_negative(-p->falloff_end);
    value = m->half_q < p->falloff_end ? (value - end) / (1.0f - end) : 0.0f;
  }
  float alpha = m->opacity * value;
  alpha = alpha < rules->alpha_most ? alpha : rules->alpha_most;
  return alpha >= rules->alpha_least ? alpha : -1.0f;
}

/* Returns 0 where compositing has ended. */
static int composite_kept(const conic_planted_frame *frame, const conic_kept_gaussian *k, float z, float alpha,
                          composite_sums *s) {
  const conic_gaussian_rules *rules = &frame->rules;
  const float before = s->T, after = before * (1.0f - alpha), w = alpha * before;
  if (after < rules->stop || (rules->is_beyond_stop && after == rules->stop))
    return 0;
  const int how = frame->planted->reweighs;
  const float again = how > 2 ? 1.0f - alpha : alpha;
  const float of_color = how ? again * w : w, of_place = how && how % 2 == 0 ? again * w : w;
  for (int c = 0; c < 3; c++) {
    s->color[c] += of_color * k->footprint.color[c];
    s->normal[c] += of_place * k->normal[c];
  }
  s->T = after;
  s->weight += w;
  s->z += of_place * z;
  s->inverse_z += of_place / z;
  s->count += 1.0f;
  if (before > 0.5f && (rules->has_late_median || !(after > 0.5f)))
    s->median_z = z;
  return 1;
}

/* Sorts by z, equal ones in their order. Shell's sort, because a wrong scene may be in no order at all. */
static void sort_planted_hits(conic_planted_hit *hits, size_t n) {
  size_t gap = 1;
  while (gap < n / 3)
    gap = 3 * gap + 1;
  for (; gap > 0; gap /= 3)
    for (size_t i = gap; i < n; i++) {
      conic_planted_hit moved = hits[i];
      size_t at = i;
      for (; at >= gap &&
             (hits[at - gap].z > moved.z || (hits[at - gap].z == moved.z && hits[at - gap].kept > moved.kept));
           at -= gap)
        hits[at] = hits[at - gap];
      hits[at] = moved;
    }
}

static int covers_fine(const conic_planted_frame *frame, uint32_t k, int x, int y) {
  const uint16_t(*box)[2] = frame->boxes[k];
  return x >= box[0][0] && x <= box[1][0] && y >= box[0][1] && y <= box[1][1];
}

/* Which fine pixel of the surfaces it is, if there is one there. */
static int find_surface(const conic_planted *p, int x, int y, size_t *at) {
  const conic_image *image = p->surfaces ? p->surfaces->image : NULL;
  *at = image ? (size_t)y * (size_t)image->width + (size_t)x : 0;
  return image && ((const float *)image->planes[CONIC_PLANE_RGBA])[4 * *at + 3] > 0.0f;
}

/* How deep Gaussians are composited at a surface. */
static float depth_of_hiding(const conic_planted *p, size_t at) {
  const float *z = p->surfaces->image->planes[CONIC_PLANE_Z];
  return p->surfaces_are == CONIC_SURFACES_BEHIND_ALL   ? INFINITY
         : p->surfaces_are == CONIC_SURFACES_BEFORE_ALL ? 0.0f
                                                        : z[at];
}

/* The light that is left is the surface's. */
static void composite_surface(const conic_planted *p, size_t at, composite_sums *s) {
  const conic_image *image = p->surfaces->image;
  const float *rgba = (const float *)image->planes[CONIC_PLANE_RGBA] + 4 * at,
              *normal = image->planes[CONIC_PLANE_NORMAL];
  const float z = ((const float *)image->planes[CONIC_PLANE_Z])[at];
  const int is_linear = p->surfaces->is_linear || p->surfaces_are == CONIC_SURFACES_LINEAR;
  for (size_t c = 0; c < 3; c++) {
    s->color[c] += s->T * conic_surface_shown(rgba[c], rgba[3], is_linear);
    s->normal[c] += normal ? s->T * normal[3 * at + c] : 0.0f;
  }
  s->weight += s->T;
  s->z += s->T * z;
  s->inverse_z += s->T / z;
  s->count += 1.0f;
  s->median_z = s->T > 0.5f ? z : s->median_z;
  s->T = 0.0f;
}

static void composite_gaussians(const conic_planted_frame *frame, const conic_composite_scratch *scratch,
                                size_t n_listed, int x, int y, float hiding_z, composite_sums *s) {
  const conic_gaussian_rules *rules = &frame->rules;
  const int is_by_ray = rules->shape == CONIC_SHAPE_RAY && frame->planted->order == CONIC_ORDER_OWN;
  size_t n_hits = 0;
  for (size_t i = 0; i < n_listed; i++) {
    uint32_t at = scratch->listed[i];
    if (!covers_fine(frame, at, x, y))
      continue;
    const conic_kept_gaussian *k = frame->kept[at];
    const conic_ray_meeting m = meet_kept(frame, k, x, y);
    const float alpha = planted_alpha(frame, &m);
    const int is_at_mean =
        rules->shape == CONIC_SHAPE_SOLID || (rules->shape == CONIC_SHAPE_DISC && !(rules->disc_near > 0.0f));
    const float z = is_at_mean ? k->footprint.z : m.z;
    if (alpha < 0.0f || z >= hiding_z)
      continue;
    if (is_by_ray)
      scratch->hits[n_hits++] = (conic_planted_hit){frame->planted->is_reversed ? -z : z, alpha, at};
    else if (!composite_kept(frame, k, z, alpha, s))
      return;
  }
  sort_planted_hits(scratch->hits, n_hits);
  for (size_t i = 0; i < n_hits; i++)
    if (!composite_kept(frame, frame->kept[scratch->hits[i].kept], fabsf(scratch->hits[i].z), scratch->hits[i].alpha,
                        s))
      return;
}

static void composite_fine(const conic_planted_frame *frame, const conic_composite_scratch *scratch, size_t n_listed,
                           int x, int y, composite_sums *s) {
  const conic_planted *p = frame->planted;
  size_t at;
  const int is_there = find_surface(p, x, y, &at);
  *s = (composite_sums){.T = 1.0f};
  composite_gaussians(frame, scratch, n_listed, x, y, is_there ? depth_of_hiding(p, at) : INFINITY, s);
  if (is_there)
    composite_surface(p, at, s);
}

/* The values of a pixel's middle sample; of an even number, the one before the middle. */
static void put_single_values(const composite_sums *s, conic_channels v) {
  v[CONIC_CHANNEL_Z] = s->weight > 0.0f ? s->z / s->weight : 0.0f;
  v[CONIC_CHANNEL_MEDIAN_Z] = s->median_z;
  v[CONIC_CHANNEL_INVERSE_Z] = s->inverse_z;
  float length = sqrtf(conic_square_of(s->normal));
  for (int c = 0; c < 3; c++)
    v[CONIC_CHANNEL_NORMAL + c] = length > 0.0f ? s->normal[c] / length : 0.0f;
}

static void composite_sample(const conic_planted_frame *frame, const conic_composite_scratch *scratch, size_t n_listed,
                             const uint16_t place[2], conic_channels v) {
  const int n = frame->samples, middle = (n - 1) / 2;
  const float share = 1.0f / (float)(n * n);
  int box[2][2];
  conic_planted_place(frame, place, box);
  memset(v, 0, sizeof(conic_channels));
  for (int y = box[0][1]; y <= box[1][1]; y++)
    for (int x = box[0][0]; x <= box[1][0]; x++) {
      composite_sums s;
      composite_fine(frame, scratch, n_listed, x, y, &s);
      for (int c = 0; c < 3; c++)
        v[c] += share * s.color[c];
      v[CONIC_CHANNEL_T] += share * s.T;
      v[CONIC_CHANNEL_WEIGHT] += share * s.weight;
      v[CONIC_CHANNEL_COUNT] = s.count > v[CONIC_CHANNEL_COUNT] ? s.count : v[CONIC_CHANNEL_COUNT];
      if (x - box[0][0] == middle && y - box[0][1] == middle)
        put_single_values(&s, v);
    }
}

void conic_planted_composite(const conic_planted_frame *frame, const conic_diagnosis_samples *at,
                             const conic_sample_cell *cell, conic_composite_scratch *scratch, conic_channels *values) {
  int least[2] = {65535 * 16, 65535 * 16}, most[2] = {-1, -1};
  size_t n_listed = 0;
  for (size_t i = cell->first; i < cell->first + cell->n; i++) {
    int box[2][2];
    conic_planted_place(frame, at->places[i], box);
    for (int axis = 0; axis < 2; axis++) {
      least[axis] = box[0][axis] < least[axis] ? box[0][axis] : least[axis];
      most[axis] = box[1][axis] > most[axis] ? box[1][axis] : most[axis];
    }
  }
  for (uint32_t k = 0; k < frame->n; k++) {
    const uint16_t(*box)[2] = frame->boxes[k];
    if (box[0][0] <= most[0] && box[1][0] >= least[0] && box[0][1] <= most[1] && box[1][1] >= least[1])
      scratch->listed[n_listed++] = k;
  }
  for (size_t i = cell->first; i < cell->first + cell->n; i++)
    composite_sample(frame, scratch, n_listed, at->places[i], values[i]);
}
