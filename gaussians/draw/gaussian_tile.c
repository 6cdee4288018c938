/* Compositing in plain C: the reference of what lanes do. OpenCL C shares this text, with a pixel as the tile. */
#include "gaussians/draw/gaussian_tile.h"

#include "core/splats/kernel.h"
#include "gaussians/draw/ray_hits.h"

static void composite_planes(const conic_gaussian_list *list, uint32_t i_footprint, float z, float w, float before,
                             float after, conic_gaussian_tile *tile, size_t at) {
  const conic_gaussian_rules *rules = list->rules;
  tile->sum[at] += w;
  tile->sum_of_z[at] += w * z;
  tile->inverse_z[at] += w / z;
  if (before > 0.5f && (rules->has_late_median || !(after > 0.5f)))
    tile->median_z[at] = z;
  if (w > tile->heaviest[at]) {
    tile->heaviest[at] = w;
    tile->id[at] = list->footprints[i_footprint].index;
  }
  tile->last[at] = list->footprints[i_footprint].index;
  for (int c = 0; c < 3 && list->normals; c++)
    tile->normal[c][at] += w * list->normals[i_footprint][c];
}

#ifndef CONIC_ON_DEVICE
static void note_step(const conic_gaussian_list *list, const conic_gaussian_footprint *f, float z, float alpha,
                      const conic_gaussian_tile *tile, size_t at) {
  const conic_gaussian_steps *to = list->steps;
  const size_t x = (size_t)(tile->x + conic_gaussian_column(at) - to->first[0]),
               y = (size_t)(tile->y + conic_gaussian_row(at) - to->first[1]), pixel = y * (size_t)to->width + x;
  if (x < (size_t)to->width) /* and no pixel beside the picture */
    to->steps[to->next[pixel]++] = (conic_gaussian_step){z, alpha, {f->color[0], f->color[1], f->color[2]}, f->index};
}
#endif

/* Returns 0 where compositing has ended at the pixel. What is not before its surface is left out. */
static int composite_one(const conic_gaussian_list *list, uint32_t i_footprint, float z, float alpha,
                         conic_gaussian_tile *tile, size_t at) {
  const CONIC_STORED conic_gaussian_footprint *f = &list->footprints[i_footprint];
  const conic_gaussian_rules *rules = list->rules;
  float before = tile->T[at], after = before * (1.0f - alpha), w = alpha * before;
  const float *surface_z = conic_gaussian_list_surface(list, at);
  if (surface_z && !(z < *surface_z))
    return 1;
  if (after < rules->stop || (rules->is_beyond_stop && after == rules->stop))
    return 0;
  for (int c = 0; c < 3; c++)
    tile->rgb[c][at] += w * f->color[c];
  tile->T[at] = after;
  tile->count[at]++;
#ifndef CONIC_ON_DEVICE
  if (list->steps)
    note_step(list, f, z, alpha, tile, at);
#endif
  if (list->wants)
    composite_planes(list, i_footprint, z, w, before, after, tile, at);
  return 1;
}

static float alpha_of(const conic_gaussian_rules *rules, const CONIC_STORED conic_gaussian_footprint *f, float half_q) {
  float fall = conic_exp_negative(-half_q);
  if (rules->fall_end > 0.0f)
    fall = (fall - rules->fall_end) * rules->fall_factor;
  float alpha = f->opacity * fall;
  return alpha < rules->alpha_most ? alpha : rules->alpha_most;
}

static int covers_pixel(const CONIC_STORED conic_gaussian_footprint *f, int x, int y) {
  return x >= f->box[0][0] && x <= f->box[1][0] && y >= f->box[0][1] && y <= f->box[1][1];
}

static void composite_ellipses(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  const conic_gaussian_rules *rules = list->rules;
  for (size_t at = 0; at < CONIC_GAUSSIAN_TILE_PIXELS; at++) {
    int x = tile->x + conic_gaussian_column(at), y = tile->y + conic_gaussian_row(at);
    for (size_t i = 0; i < list->n; i++) {
      const CONIC_STORED conic_gaussian_footprint *f = &list->footprints[list->entries[i]];
      float dx = (float)(x - f->x) + f->dx, dy = (float)(y - f->y) + f->dy;
      float half_q = 0.5f * (f->form[0] * dx * dx + f->form[2] * dy * dy) + f->form[1] * dx * dy;
      float alpha = alpha_of(rules, f, half_q);
      if (covers_pixel(f, x, y) && half_q >= 0.0f &&
          (!(rules->greatest_half_q > 0.0f) || rules->greatest_half_q >= half_q) && alpha >= rules->alpha_least &&
          !composite_one(list, list->entries[i], f->z, alpha, tile, at))
        break;
    }
  }
}

typedef struct meeting {
  float half_q, z;
} meeting;

static float affine(float at_reference, float by_x, float by_y, float dx, float dy) {
  return at_reference + by_x * dx + by_y * dy;
}

/* The order of operations here is that of docs/reference/gaussians.md. */
static meeting meet_ray(const CONIC_STORED conic_gaussian_footprint *f, const CONIC_STORED conic_gaussian_ray *r, int x,
                        int y) {
  float dx = (float)(x - f->x), dy = (float)(y - f->y), g[3], c[3];
  for (int k = 0; k < 3; k++) {
    g[k] = affine(r->g[0][k], r->g[1][k], r->g[2][k], dx, dy);
    c[k] = affine(r->c[0][k], r->c[1][k], r->c[2][k], dx, dy);
  }
  float squares = g[0] * g[0] + g[1] * g[1] + g[2] * g[2], one_over = 1.0f / squares;
  float half_q = 0.5f * ((c[0] * c[0] + c[1] * c[1] + c[2] * c[2]) * one_over);
  return (meeting){squares > 0.0f ? half_q : -1.0f, affine(r->e[0], r->e[1], r->e[2], dx, dy) * one_over};
}

static void composite_rays(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  CONIC_STORED conic_ray_hit *hits = list->room;
  for (size_t at = 0; at < CONIC_GAUSSIAN_TILE_PIXELS; at++) {
    int x = tile->x + conic_gaussian_column(at), y = tile->y + conic_gaussian_row(at);
    size_t n = 0;
    for (size_t i = 0; i < list->n; i++) {
      const CONIC_STORED conic_gaussian_footprint *f = &list->footprints[list->entries[i]];
      if (!covers_pixel(f, x, y))
        continue;
      meeting m = meet_ray(f, &list->rays[list->entries[i]], x, y);
      float alpha = alpha_of(list->rules, f, m.half_q);
      if (m.z > 0.0f && m.half_q >= 0.0f && alpha >= list->rules->alpha_least)
        hits[n++] = (conic_ray_hit){m.z, alpha, list->entries[i]};
    }
    conic_sort_hits(hits, n);
    for (size_t i = 0; i < n && composite_one(list, hits[i].which, hits[i].z, hits[i].alpha, tile, at); i++)
      ;
  }
}

/* And solids, which have no dot. */
static void composite_discs(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  const conic_gaussian_rules *rules = list->rules;
  const int is_solid = rules->shape == CONIC_SHAPE_SOLID;
  for (size_t at = 0; at < CONIC_GAUSSIAN_TILE_PIXELS; at++) {
    int x = tile->x + conic_gaussian_column(at), y = tile->y + conic_gaussian_row(at);
    for (size_t i = 0; i < list->n; i++) {
      const CONIC_STORED conic_gaussian_footprint *f = &list->footprints[list->entries[i]];
      meeting m = meet_ray(f, &list->rays[list->entries[i]], x, y);
      float dx = (float)(x - f->x) + f->dx, dy = (float)(y - f->y) + f->dy, dot = dx * dx + dy * dy;
      float half_q = m.half_q < dot || is_solid ? m.half_q : dot, alpha = alpha_of(rules, f, half_q);
      if (covers_pixel(f, x, y) && half_q >= 0.0f && (!(rules->disc_near > 0.0f) || m.z >= rules->disc_near) &&
          (!is_solid || m.z > 0.0f) && alpha >= rules->alpha_least &&
          !composite_one(list, list->entries[i], rules->disc_near > 0.0f ? m.z : f->z, alpha, tile, at))
        break;
    }
  }
}

#ifndef CONIC_ON_DEVICE
#include "gaussians/draw/ray_meetings.h"

/* Solids come in the order of their means, at their depths. */
static float z_of_meeting(const conic_gaussian_list *list, uint32_t i_footprint, float z) {
  return list->rules->shape == CONIC_SHAPE_SOLID ? list->footprints[i_footprint].z : z;
}

static void composite_meetings(const conic_gaussian_list *list, conic_gaussian_tile *tile, int is_filtered) {
  conic_ray_hit *hits = list->room;
  for (size_t at = 0; at < CONIC_GAUSSIAN_TILE_PIXELS; at++) {
    int x = tile->x + conic_gaussian_column(at), y = tile->y + conic_gaussian_row(at);
    size_t n = 0;
    for (size_t i = 0; i < list->n; i++) {
      if (!covers_pixel(&list->footprints[list->entries[i]], x, y))
        continue;
      conic_ray_meeting m = is_filtered ? conic_meet_filtered(list, list->entries[i], x, y)
                                        : conic_meet_sight(list, list->entries[i], at);
      float alpha = m.opacity * conic_exp_negative(-m.half_q);
      alpha = alpha < list->rules->alpha_most ? alpha : list->rules->alpha_most;
      if (m.z > 0.0f && m.half_q >= 0.0f && alpha >= list->rules->alpha_least)
        hits[n++] = (conic_ray_hit){z_of_meeting(list, list->entries[i], m.z), alpha, list->entries[i]};
    }
    conic_sort_hits(hits, n);
    for (size_t i = 0; i < n && composite_one(list, hits[i].which, hits[i].z, hits[i].alpha, tile, at); i++)
      ;
  }
}

static void composite_filtered(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  composite_meetings(list, tile, 1);
}

static void composite_sights(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  composite_meetings(list, tile, 0);
}

CONIC_DEFINE_LOOPS(conic_gaussian_loops)

void conic_gaussian_loops_scalar(conic_gaussian_loops *loops) {
  loops->set_up = NULL;
  loops->composite[CONIC_SHAPE_ELLIPSE] = composite_ellipses;
  loops->composite[CONIC_SHAPE_RAY] = composite_rays;
  loops->composite[CONIC_SHAPE_DISC] = loops->composite[CONIC_SHAPE_SOLID] = composite_discs;
  loops->composite[CONIC_SHAPE_FILTERED] = composite_filtered;
  loops->composite[CONIC_SHAPE_SIGHT] = composite_sights;
}
#endif
