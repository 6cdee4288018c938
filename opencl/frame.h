/* One frame on its way through a device's stages. Who wants to look at what a stage has made calls the stages one by
 * one and reads their buffers with conic_queue_read. */
#ifndef OPENCL_FRAME_H
#define OPENCL_FRAME_H

#include "opencl/layout.h"
#include "opencl/renderer.h"

typedef struct conic_frame {
  conic_opencl *opencl;
  const conic_view *view;
  const conic_splats *splats;
  conic_image *image;
  conic_device_frame constants;
  uint32_t n_tiles;
  /* Of the part of the splats that is on the device: */
  size_t first;
  uint32_t n, n_items, splats_per_item, n_drawn;
  uint64_t n_references;
  uint64_t counts[CONIC_DEVICE_N_COUNTS]; /* of all parts of the first walk over them */
  uint64_t n_fragments, n_drawn_in_all;
} conic_frame;

/* Makes ready what all parts share. */
conic_status conic_frame_begin(conic_frame *frame);
/* Projects the splats first … first + n - 1 and packs them; n may be 0. */
conic_status conic_frame_project(conic_frame *frame, size_t first, size_t n);
/* Makes the tiles' lists of them. *fits is 0, and there are no lists, where the device cannot hold them. */
conic_status conic_frame_bin(conic_frame *frame, int *fits);
conic_status conic_frame_visibility(conic_frame *frame);
/* Accumulation or, in a single pass, the nearest splats; with the last part, the picture. */
conic_status conic_frame_accumulate(conic_frame *frame);
/* Brings the picture to the image. */
conic_status conic_frame_end(conic_frame *frame, uint64_t *n_covered);

/* The same as conic_frame_project on the host, for devices without double precision (opencl/host_setup.c). */
conic_status conic_frame_project_on_host(conic_frame *frame);

/* The slot of the backend. */
conic_status conic_frame_draw(conic_backend *backend, const conic_view *view, const conic_splats *splats,
                              const conic_finish *finish, conic_image *image, conic_render_statistics *statistics);

#endif
