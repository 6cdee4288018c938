/* Set-up on a device: the very text of raster/project/project_splats.c and its neighbours, and the entry that hands it splats. */
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#include "opencl/shared.h"

#include "opencl/layout.h"
#include "raster/project/clip_disc.c"

#include "raster/project/project_ray.c"
#include "raster/project/project_splats.c"
#include "raster/project/clip_box.c"
#include "raster/project/clip_lines.c"

/* Where the splats are that a device has; `first` is the index of its splat 0 in the whole set. */
typedef struct splat_columns {
  __global const float *values[13]; /* position, tangent_u, tangent_v, colour, opacity */
  uint first, fields;
  __global const conic_clip *clips; /* of these splats only */
  uint n_clips, i_clip;             /* i_clip: none before it is of a splat to come */
} splat_columns;

/* Where records go: each item packs its own from its first splat's place on. */
typedef struct record_places {
  __global conic_footprint *footprints;
  __global conic_box *boxes;
  __global conic_projected_surface *surfaces;
  __global conic_ray *rays;
  __global conic_clip_record *clips;
  uint at;
} record_places;

/* One splat in private memory, in the form that the shared text reads. */
typedef struct one_splat {
  float position[3], tangent_u[3], tangent_v[3], color[3], opacity;
} one_splat;

static void load_splat(const splat_columns *columns, uint i, one_splat *one) {
  for (int axis = 0; axis < 3; axis++) {
    one->position[axis] = columns->values[axis][i];
    one->tangent_u[axis] = columns->values[3 + axis][i];
    one->tangent_v[axis] = columns->values[6 + axis][i];
    one->color[axis] = columns->fields & CONIC_DEVICE_HAS_COLOR ? columns->values[9 + axis][i] : 1.0f;
  }
  one->opacity = columns->fields & CONIC_DEVICE_HAS_OPACITY ? columns->values[12][i] : 1.0f;
}

static void point_to(one_splat *one, uint fields, conic_splats *splats) {
  splats->count = 1;
  for (int axis = 0; axis < 3; axis++) {
    splats->position[axis] = &one->position[axis];
    splats->tangent_u[axis] = &one->tangent_u[axis];
    splats->tangent_v[axis] = &one->tangent_v[axis];
    splats->color[axis] = fields & CONIC_DEVICE_HAS_COLOR ? &one->color[axis] : 0;
  }
  splats->opacity = fields & CONIC_DEVICE_HAS_OPACITY ? &one->opacity : 0;
}

static void count_outcome(const conic_view *view, conic_outcome outcome, uint counts[CONIC_DEVICE_N_COUNTS]) {
  counts[CONIC_DEVICE_CULLED] += outcome == CONIC_CULLED;
  counts[CONIC_DEVICE_SKIPPED] += outcome == CONIC_SKIPPED;
  counts[CONIC_DEVICE_FALLBACK] += outcome < CONIC_CULLED && is_fallback(view->method, outcome);
  counts[CONIC_DEVICE_RAYS] += outcome == CONIC_DRAWN_RAY;
}

/* Makes i_clip the first record that is not before the splat. */
static void seek_clip(splat_columns *columns, uint splat) {
  uint begin = 0, end = columns->n_clips;
  while (begin < end) {
    uint middle = begin + (end - begin) / 2;
    if (columns->clips[middle].splat < splat)
      begin = middle + 1;
    else
      end = middle;
  }
  columns->i_clip = begin;
}

/* conic_clip_chunk for one splat, whose record was written last. */
static void clip_record(const conic_view *view, splat_columns *columns, uint i, const record_places *to) {
  uint splat = columns->first + i;
  while (columns->i_clip < columns->n_clips && columns->clips[columns->i_clip].splat < splat)
    columns->i_clip++;
  if (columns->i_clip == columns->n_clips || columns->clips[columns->i_clip].splat != splat)
    return;
  one_splat one;
  conic_splats splats;
  conic_clip clip = columns->clips[columns->i_clip];
  conic_footprint footprint = to->footprints[to->at - 1];
  load_splat(columns, i, &one);
  point_to(&one, columns->fields, &splats);
  clip.splat = 0; /* of the one */
  to->clips[to->at - 1] = project_clip(view, &splats, &clip, &footprint);
  to->footprints[to->at - 1].s3 = -footprint.s3;
}

/* conic_project_one */
static void project_one(const conic_view *view, splat_columns *columns, uint i, record_places *to,
                        uint counts[CONIC_DEVICE_N_COUNTS]) {
  one_splat one;
  conic_splats splats;
  conic_footprint footprint;
  conic_box box;
  conic_projected_surface surface;
  conic_ray ray;
  splat_setup s = {.view = view, .splats = &splats, .i = 0};
  load_splat(columns, i, &one);
  point_to(&one, columns->fields, &splats);
  s.footprint = &footprint;
  s.box = &box;
  s.surface = &surface;
  s.ray = &ray;
  conic_outcome outcome = project_splat(&s);
  count_outcome(view, outcome, counts);
  counts[CONIC_DEVICE_LAPLACES] += outcome == CONIC_DRAWN_RAY && conic_is_laplace(&footprint);
  if (outcome >= CONIC_CULLED)
    return;
  surface.index = columns->first + i;
  if (outcome == CONIC_DRAWN_RAY) {
    footprint.i_ray = to->at;
    to->rays[to->at] = ray;
  }
  to->footprints[to->at] = footprint;
  to->boxes[to->at] = box;
  to->surfaces[to->at] = surface;
  to->at++;
  clip_record(view, columns, i, to);
}

#define SETUP_ARGUMENTS                                                                                                \
  __constant conic_view *frame_view, uint n, uint first, uint splats_per_item, uint fields, __global const float *px,  \
      __global const float *py, __global const float *pz, __global const float *tux, __global const float *tuy,        \
      __global const float *tuz, __global const float *tvx, __global const float *tvy, __global const float *tvz,      \
      __global const float *red, __global const float *green, __global const float *blue,                              \
      __global const float *opacity, uint n_clips, __global const conic_clip *clips,                                   \
      __global conic_footprint *footprints, __global conic_box *boxes, __global conic_projected_surface *surfaces,               \
      __global conic_ray *rays, __global conic_clip_record *records, __global uint *n_drawn, __global uint *counts

#define SETUP_COLUMNS                                                                                                  \
  { {px, py, pz, tux, tuy, tuz, tvx, tvy, tvz, red, green, blue, opacity}, first, fields, clips, n_clips, 0 }

static void add_counts(const uint own[CONIC_DEVICE_N_COUNTS], __global uint *counts) {
  for (int i = 0; i < CONIC_DEVICE_N_COUNTS; i++)
    if (own[i])
      atomic_add(&counts[i], own[i]);
}

/* Projects splats_per_item splats from the item's first on, one after the other. */
__kernel void project(SETUP_ARGUMENTS) {
  conic_view view = *frame_view;
  uint item = (uint)get_global_id(0), begin = item * splats_per_item, own[CONIC_DEVICE_N_COUNTS] = {0};
  if (begin >= n)
    return;
  uint end = n - begin < splats_per_item ? n : begin + splats_per_item;
  splat_columns columns = SETUP_COLUMNS;
  record_places to = {footprints, boxes, surfaces, rays, records, begin};
  seek_clip(&columns, first + begin);
  for (uint i = begin; i < end; i++)
    project_one(&view, &columns, i, &to, own);
  n_drawn[item] = to.at - begin;
  add_counts(own, counts);
}

#include "opencl/setup_lanes.cl"
