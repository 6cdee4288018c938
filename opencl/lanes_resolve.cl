/* Pass 3 in lanes, a block at a time: raster/loops/resolve.c and raster/tiles/shade.c in their order of arithmetic. */

#include "raster/loops/shade_lanes.h"

/* A block's finished pixels. */
typedef struct lanes_pixels {
  lanes rgba[4], normal[3], albedo[3];
} lanes_pixels;

/* finish_covered and finish_uncovered; dx and dy are the pixels' directions. */
static void lanes_finish_pixels(const conic_device_frame *frame, const lanes_sums *s, lanes dx, lanes dy,
                                lanes_pixels *p) {
  conic_render_options options;
  conic_finish finish;
  lanes weight = s->values[CONIC_SUM_WEIGHT], part = 1.0f / weight, mean[3], viewer[3], shaded[3];
  int16 is_covered = weight > 0.0f;
  for (int axis = 0; axis < 3; axis++)
    p->albedo[axis] = s->values[CONIC_SUM_COLOR + axis] * part;
  lanes norm = lanes_mean_normal(s, mean), scale = 1.0f / norm;
  for (int axis = 0; axis < 3; axis++)
    p->normal[axis] = norm > 0.0f ? mean[axis] * scale : s->values[CONIC_SUM_HEAVIEST_NORMAL + axis];
  finish_of(frame, &options, &finish);
  look_back(frame->world_from_cam, dx, dy, viewer);
  for (int axis = 0; axis < 3; axis++)
    shaded[axis] = p->albedo[axis];
  if (options.shading != CONIC_SHADE_NONE)
    shade_lanes(&finish, p->albedo, p->normal, mean, viewer, shaded);
  for (int axis = 0; axis < 3; axis++) {
    p->rgba[axis] = is_covered ? shaded[axis] * frame->exposure : frame->background[axis];
    p->albedo[axis] = is_covered ? p->albedo[axis] : 0.0f;
    p->normal[axis] = is_covered ? p->normal[axis] : 0.0f;
  }
  p->rgba[3] = is_covered ? 1.0f : frame->background[3];
}

/* Writes a block's channels pixel by pixel, as far as they are in the image. */
static void lanes_store_pixels(const conic_device_frame *frame, const lanes *channels, int n_channels, int x, int y,
                               __global float *plane) {
  for (int lane = 0; lane < 16; lane++) {
    int px = x + lane / 4, py = y + lane % 4;
    if (px >= frame->width || py >= frame->height)
      continue;
    ulong at = (ulong)py * (ulong)frame->width + (ulong)px;
    for (int channel = 0; channel < n_channels; channel++)
      plane[at * (ulong)n_channels + (ulong)channel] = ((const float *)&channels[channel])[lane];
  }
}

/* One row of a block's four. */
static float4 lanes_pick_row(lanes values, int row) {
  return row == 0 ? values.s048c : row == 1 ? values.s159d : row == 2 ? values.s26ae : values.s37bf;
}

static void lanes_store_row(const lanes *channels, int n_channels, int row, __global float *to) {
  float4 a = lanes_pick_row(channels[0], row);
  if (n_channels == 1) {
    vstore4(a, 0, to);
    return;
  }
  float4 b = lanes_pick_row(channels[1], row), c = lanes_pick_row(channels[2], row);
  if (n_channels == 3) {
    vstore8((float8)(a.x, b.x, c.x, a.y, b.y, c.y, a.z, b.z), 0, to);
    vstore4((float4)(c.z, a.w, b.w, c.w), 0, to + 8);
    return;
  }
  float4 d = lanes_pick_row(channels[3], row);
  vstore16((float16)(a.x, b.x, c.x, d.x, a.y, b.y, c.y, d.y, a.z, b.z, c.z, d.z, a.w, b.w, c.w, d.w), 0, to);
}

/* A block's channels to a plane that the image has. */
static void lanes_store_plane(const conic_device_frame *frame, int plane, const lanes *channels, int n_channels, int x, int y,
                        __global float *to) {
  if (!(frame->planes & 1 << plane))
    return;
  if (x + 4 > frame->width || y + 4 > frame->height) {
    lanes_store_pixels(frame, channels, n_channels, x, y, to);
    return;
  }
  __global float *corner = to + ((ulong)y * (ulong)frame->width + (ulong)x) * (ulong)n_channels;
  ulong stride = (ulong)frame->width * (ulong)n_channels;
  lanes_store_row(channels, n_channels, 0, corner);
  lanes_store_row(channels, n_channels, 1, corner + stride);
  lanes_store_row(channels, n_channels, 2, corner + 2 * stride);
  lanes_store_row(channels, n_channels, 3, corner + 3 * stride);
}

/* Pass 3 of a block; returns how many of its pixels are covered. */
static uint lanes_resolve(const conic_device_frame *frame, const lanes_sums *s, int x, int y, PIXEL_PLANES) {
  lanes_pixels p;
  lanes weight = s->values[CONIC_SUM_WEIGHT];
  int16 is_covered = weight > 0.0f;
  if (lanes_any(is_covered)) {
    float4 dx = vload4(0, columns + x), dy = vload4(0, rows + y); /* there are some of all whole tiles */
    lanes_finish_pixels(frame, s, (lanes)(dx.xxxx, dx.yyyy, dx.zzzz, dx.wwww), (lanes)(dy, dy, dy, dy), &p);
  } else {
    for (int axis = 0; axis < 3; axis++)
      p.normal[axis] = p.albedo[axis] = 0.0f;
    for (int channel = 0; channel < 4; channel++)
      p.rgba[channel] = frame->background[channel];
  }
  lanes z = is_covered ? s->values[CONIC_SUM_Z] : 0.0f;
  lanes count = as_float16(is_covered ? as_int16(s->values[CONIC_SUM_COUNT]) : 0);
  lanes id = as_float16(is_covered ? as_int16(s->values[CONIC_SUM_ID]) : -1); /* CONIC_NO_ID */
  lanes_store_plane(frame, CONIC_PLANE_RGBA, p.rgba, 4, x, y, rgba);
  lanes_store_plane(frame, CONIC_PLANE_NORMAL, p.normal, 3, x, y, normal_plane);
  lanes_store_plane(frame, CONIC_PLANE_ALBEDO, p.albedo, 3, x, y, albedo_plane);
  lanes_store_plane(frame, CONIC_PLANE_WEIGHT, &weight, 1, x, y, weight_plane);
  lanes_store_plane(frame, CONIC_PLANE_Z, &z, 1, x, y, z_plane);
  lanes_store_plane(frame, CONIC_PLANE_COUNT, &count, 1, x, y, (__global float *)count_plane);
  lanes_store_plane(frame, CONIC_PLANE_ID, &id, 1, x, y, (__global float *)id_plane);
  return lanes_count(is_covered);
}

/* A block of a part of the splats: on with the sums, or the picture where it is the last and no triangles follow.
 * Returns how many of its pixels are covered then. */
static uint lanes_finish(const conic_device_frame *frame, const lanes_tile *t, uint block, const lanes_sums *s,
                         __global lanes *sums, PIXEL_PLANES) {
  int x = lanes_block_x(t, block), y = lanes_block_y(t, block);
  if (!frame->is_last || frame->keeps_sums) {
    __global lanes *to = sums + lanes_block(t, frame, block) * CONIC_N_SUMS;
    for (int i = 0; i < CONIC_N_SUMS; i++)
      to[i] = s->values[i];
  }
  if (!frame->is_last || frame->has_triangles || x >= frame->width || y >= frame->height)
    return 0;
  return lanes_resolve(frame, s, x, y, PIXEL_PLANES_PASSED);
}
