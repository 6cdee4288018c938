/* One frame on its way through a device's stages. Who wants to look at what a stage has made calls the stages one by
 * one and reads their buffers with conic_queue_read. */
#pragma once

#include "opencl/layout.h"
#include "opencl/opencl_renderer.h"

typedef struct conic_frame {
  conic_opencl *opencl;
  const conic_view *view;
  const conic_splats *splats;
  struct conic_triangle_frame *triangles; /* null: none */
  conic_image *image;
  conic_device_frame constants;
  uint32_t n_tiles;
  /* Of the part of the splats that is on the device: */
  size_t first;
  uint32_t n, n_items, splats_per_item, n_drawn;
  uint64_t n_references;
  uint64_t counts[CONIC_DEVICE_N_COUNTS]; /* of all parts of the first walk over them */
  uint64_t n_fragments, n_drawn_in_all;
  double triangle_bytes;   /* of the device's memory */
  uint64_t splats_version; /* of the options */
  int is_hiding;           /* CONIC_PASS_OF_HIDING: the plane Z is made here, of the device's thresholds */
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
/* Visibility and accumulation of all splats, which are on the device; by tiles as one, which counts as accumulation. */
conic_status conic_frame_blend(conic_frame *frame);
/* Brings the picture to the image. */
conic_status conic_frame_end(conic_frame *frame, uint64_t *n_covered);
/* Waits for all; after that, also after a failure, the device knows nothing more of the image and the splats. */
conic_status conic_frame_close(conic_frame *frame);

/* Triangles (opencl/frame_triangles.c). Their host's part, before everything else: they are set up by plain C on the
 * host's threads. Errors: UNSUPPORTED (no double precision), MEMORY (the device cannot hold them). */
conic_status conic_frame_set_up_triangles(conic_frame *frame, conic_isa isa);
/* Before the splats: the nearest triangle of every pixel, and the thresholds that the splats begin with. */
conic_status conic_frame_draw_triangles(conic_frame *frame);
/* After them: the triangles that are seen to the sums, and the picture. */
conic_status conic_frame_add_triangles(conic_frame *frame);
conic_status conic_frame_count_triangles(const conic_frame *frame, conic_render_statistics *statistics);

/* Of a device's memory, what a frame may take. */
#define CONIC_SHARE_OF_MEMORY 0.75

/* What the stages share: */

static inline conic_argument conic_frame_argument(const conic_frame *frame, int buffer) {
  return (conic_argument){sizeof(cl_mem), &frame->opencl->buffers[buffer].memory};
}

/* Room in a buffer for count × size bytes. */
conic_status conic_frame_room(const conic_frame *frame, int buffer, size_t count, size_t size);
/* Copies bytes to a buffer, which gets room for them. */
conic_status conic_frame_copy(const conic_frame *frame, int buffer, const void *from, size_t bytes);
/* The same of what an entry only reads: a CPU's device reads it where it is. No bytes: the buffer is absent. */
conic_status conic_frame_give(const conic_frame *frame, int buffer, const void *from, size_t bytes);
/* A picture's plane (null: it is not wanted, and the buffer absent): a CPU's device draws into it itself, another into
 * memory of its own, from which closing brings it. */
conic_status conic_frame_open_plane(const conic_frame *frame, int buffer, void *plane, size_t bytes);
conic_status conic_frame_close_plane(const conic_frame *frame, int buffer, void *plane, size_t bytes);
/* Runs an entry over a row of work-items; one is a group on a CPU and by tiles, where each has much to do. */
conic_status conic_frame_run(const conic_frame *frame, conic_stage stage, conic_entry_name entry,
                             const conic_argument *arguments, int n_arguments, size_t n_items);
/* places[i] = the sum of numbers[0 … i - 1], by the buffers' names; places[n] is the total, which comes back. */
conic_status conic_frame_scan(const conic_frame *frame, conic_stage stage, uint32_t n, int numbers, int places,
                              uint64_t *total);
/* Runs an entry of the raster: a tile or a pixel a work-item. */
conic_status conic_frame_run_raster(const conic_frame *frame, conic_stage stage, conic_entry_name entry,
                                    const conic_argument *arguments, int n_arguments);
/* Tells the raster's entries about the frame and the part of its splats that is on the device. */
conic_status conic_frame_write_constants(conic_frame *frame);
/* The arguments for the image's planes, and how many they are. */
enum { CONIC_FRAME_PLANE_ARGUMENTS = 3 + CONIC_N_DRAWN_PLANES };
int conic_frame_planes(const conic_frame *frame, conic_argument *to);
conic_status conic_frame_clear_tiles(const conic_frame *frame, int buffer);
/* Adds what the tiles have counted in a buffer to the sum. */
conic_status conic_frame_add_tiles(const conic_frame *frame, int buffer, uint64_t *sum);

/* The same as conic_frame_project on the host, for devices without double precision (opencl/host_setup.c). */
conic_status conic_frame_project_on_host(conic_frame *frame);

/* The slot of the backend. */
conic_status conic_frame_draw(conic_backend *backend, const conic_view *view, const conic_splats *splats,
                              struct conic_triangle_frame *triangles, const conic_finish *finish, conic_image *image,
                              conic_render_statistics *statistics);
