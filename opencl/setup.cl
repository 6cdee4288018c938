/* Set-up on a device: the very text of raster/project.c and its neighbours, and the kernel that hands it splats. */
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#include "opencl/shared.h"

#include "opencl/layout.h"
#include "raster/clip_disc.c"

#define cross conic_cross_of_rays
#include "raster/project_ray.c"
#undef cross
#include "raster/project.c"
#define cross conic_cross_of_lines
#define row_times conic_row_times_of_lines
#include "raster/clip_lines.c"
#undef cross
#undef row_times

/* One splat in private memory, in the form that the shared text reads. */
typedef struct one_splat {
  float position[3], tangent_u[3], tangent_v[3], color[3], opacity;
} one_splat;

static conic_splats splats_of(one_splat *one, uint fields) {
  conic_splats splats;
  splats.count = 1;
  for (int axis = 0; axis < 3; axis++) {
    splats.position[axis] = &one->position[axis];
    splats.tangent_u[axis] = &one->tangent_u[axis];
    splats.tangent_v[axis] = &one->tangent_v[axis];
    splats.color[axis] = fields & CONIC_DEVICE_HAS_COLOR ? &one->color[axis] : 0;
  }
  splats.opacity = fields & CONIC_DEVICE_HAS_OPACITY ? &one->opacity : 0;
  return splats;
}

static void count_outcome(const conic_view *view, conic_outcome outcome, uint counts[CONIC_DEVICE_N_COUNTS]) {
  int is_ray = outcome == CONIC_DRAWN_RAY;
  int is_own = is_ray ? conic_method_has_rays(view->method)
                      : outcome != CONIC_DRAWN_SEGMENT && conic_method_has_ellipses(view->method);
  counts[CONIC_DEVICE_CULLED] += outcome == CONIC_CULLED;
  counts[CONIC_DEVICE_SKIPPED] += outcome == CONIC_SKIPPED;
  counts[CONIC_DEVICE_FALLBACK] += outcome < CONIC_CULLED && !is_own;
  counts[CONIC_DEVICE_RAYS] += is_ray;
}

/* Projects splats_per_item splats after the item's first and packs the records of the drawn ones from there on.
 * `first` is the index of splat 0 in the whole set. Only the clip lines of these splats are given. */
__kernel void project(__constant conic_view *frame_view, uint n, uint first, uint splats_per_item, uint fields,
                      __global const float *px, __global const float *py, __global const float *pz,
                      __global const float *tux, __global const float *tuy, __global const float *tuz,
                      __global const float *tvx, __global const float *tvy, __global const float *tvz,
                      __global const float *red, __global const float *green, __global const float *blue,
                      __global const float *opacity, uint n_clips, __global const conic_clip *clips,
                      __global conic_footprint *footprints, __global conic_box *boxes,
                      __global conic_surface *surfaces, __global conic_ray *rays, __global conic_clip_record *records,
                      __global uint *n_drawn, __global uint *counts) {
  conic_view view = *frame_view;
  uint item = (uint)get_global_id(0), begin = item * splats_per_item, at = begin, own[CONIC_DEVICE_N_COUNTS] = {0};
  if (begin >= n)
    return;
  uint end = n - begin < splats_per_item ? n : begin + splats_per_item;
  uint i_clip = 0;
  for (uint past = n_clips; i_clip < past;) { /* the first record that is not before the item's first splat */
    uint middle = i_clip + (past - i_clip) / 2;
    if (clips[middle].splat < first + begin)
      i_clip = middle + 1;
    else
      past = middle;
  }
  for (uint i = begin; i < end; i++) {
    one_splat one = {{px[i], py[i], pz[i]}, {tux[i], tuy[i], tuz[i]}, {tvx[i], tvy[i], tvz[i]}, {1, 1, 1}, 1};
    if (fields & CONIC_DEVICE_HAS_COLOR) {
      one.color[0] = red[i];
      one.color[1] = green[i];
      one.color[2] = blue[i];
    }
    if (fields & CONIC_DEVICE_HAS_OPACITY)
      one.opacity = opacity[i];
    conic_splats splats = splats_of(&one, fields);
    conic_footprint footprint;
    conic_box box;
    conic_surface surface;
    conic_ray ray;
    splat_setup s = {.view = &view, .splats = &splats, .i = 0};
    s.footprint = &footprint;
    s.box = &box;
    s.surface = &surface;
    s.ray = &ray;
    conic_outcome outcome = project_splat(&s);
    count_outcome(&view, outcome, own);
    if (outcome >= CONIC_CULLED)
      continue;
    surface.index = first + i;
    if (outcome == CONIC_DRAWN_RAY) {
      footprint.i_ray = at;
      rays[at] = ray;
    }
    while (i_clip < n_clips && clips[i_clip].splat < first + i)
      i_clip++;
    if (i_clip < n_clips && clips[i_clip].splat == first + i) {
      conic_clip clip = clips[i_clip];
      clip.splat = 0;
      records[at] = project_clip(&view, &splats, &clip, &footprint);
      footprint.s3 = -footprint.s3;
    }
    footprints[at] = footprint;
    boxes[at] = box;
    surfaces[at++] = surface;
  }
  n_drawn[item] = at - begin;
  for (int i = 0; i < CONIC_DEVICE_N_COUNTS; i++)
    if (own[i])
      atomic_add(&counts[i], own[i]);
}
