/* What the OpenCL tests share: a device or a skip, splats of all kinds with clip lines, and pictures compared. */
#pragma once

#include "bench/loops/cross_desk.h"

/* Ends the program with a message where no OpenCL device is. */
static inline void opencl_need_device(conic_context *context) {
  conic_opencl_device *devices;
  size_t n;
  if (conic_opencl_devices(context, &devices, &n) != CONIC_OK || n == 0) {
    fprintf(stderr, "skipped: no OpenCL device is there\n");
    exit(77);
  }
  conic_opencl_devices_release(context, devices);
}

/* Gives every third splat one or two clip lines; some are none. */
static inline void opencl_add_clips(fixture *f, uint64_t *state) {
  size_t n = f->splats.count;
  f->splats.n_clips = 0;
  f->splats.clips = calloc(n, sizeof *f->splats.clips);
  if (!f->splats.clips)
    exit(1);
  for (size_t i = 0; i < n; i += 3) {
    conic_clip *clip = &f->splats.clips[f->splats.n_clips++];
    clip->splat = (uint32_t)i;
    clip->n_lines = (uint16_t)(1 + i % 2);
    clip->operation = (uint16_t)(i / 2 % 2);
    for (int line = 0; line < 2; line++)
      for (int k = 0; k < 3; k++)
        clip->lines[line][k] = any_value(state, 2.0, 0.02);
  }
}

static inline void opencl_drop_clips(fixture *f) {
  free(f->splats.clips);
  f->splats.clips = NULL;
  f->splats.n_clips = 0;
}

/* Whether the pictures are the same in every bit; says where they first differ. */
static inline int opencl_same(const conic_image *a, const conic_image *b, const char *what) {
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++) {
    const conic_plane_description *about = conic_plane_describe((conic_plane)plane);
    size_t n = (size_t)a->width * (size_t)a->height * (size_t)about->n_channels, at = 0;
    const uint32_t *of_a = a->planes[plane], *of_b = b->planes[plane];
    while (at < n && of_a[at] == of_b[at])
      at++;
    if (at == n)
      continue;
    size_t i_pixel = at / (size_t)about->n_channels;
    fprintf(stderr, "%s: plane %s differs at pixel %zu, %zu: %08x and %08x\n", what, about->name,
            i_pixel % (size_t)a->width, i_pixel / (size_t)a->width, of_a[at], of_b[at]);
    return 0;
  }
  return 1;
}
