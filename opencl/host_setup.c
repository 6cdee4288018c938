/* Set-up on the host, by plain C, for devices without double precision: the records then go to the device as it would
 * have made them. */

#include "core/base/base.h"
#include "opencl/frame.h"
#include "raster/project/clip_lines.h"

typedef struct host_setup {
  const conic_frame *frame;
  conic_projected projected;
  uint32_t *n_drawn;
} host_setup;

/* One item of the device's, which is a chunk here. */
static void project_item(void *data, size_t i_item) {
  host_setup *h = data;
  const conic_frame *f = h->frame;
  conic_chunk *chunk = &h->projected.chunks[i_item];
  size_t begin = i_item * f->splats_per_item, end = begin + f->splats_per_item;
  memset(chunk, 0, sizeof *chunk);
  chunk->first = chunk->first_ray = begin;
  end = end < f->n ? end : f->n;
  conic_project_range(f->view, f->splats, f->first + begin, f->first + end, &h->projected, chunk);
  if (h->projected.clips)
    conic_clip_chunk(f->view, f->splats, f->first + begin, &h->projected, chunk);
  h->n_drawn[i_item] = (uint32_t)chunk->n_drawn;
}

static conic_status allocate_setup(host_setup *h) {
  const conic_frame *f = h->frame;
  conic_context *context = f->opencl->context;
  conic_projected *p = &h->projected;
  p->n_chunks = f->n_items;
  p->chunk_size = f->splats_per_item;
  p->chunks = conic_memory_allocate(context, f->n_items, sizeof *p->chunks);
  p->footprints = conic_memory_allocate_zeroed(context, f->n, sizeof *p->footprints);
  p->boxes = conic_memory_allocate_zeroed(context, f->n, sizeof *p->boxes);
  p->surfaces = conic_memory_allocate_zeroed(context, f->n, sizeof *p->surfaces);
  p->rays = conic_memory_allocate_zeroed(context, f->n, sizeof *p->rays);
  p->clips = f->splats->n_clips ? conic_memory_allocate_zeroed(context, f->n, sizeof *p->clips) : NULL;
  h->n_drawn = conic_memory_allocate(context, f->n_items, sizeof *h->n_drawn);
  return p->chunks && p->footprints && p->boxes && p->surfaces && p->rays && h->n_drawn &&
                 (p->clips || !f->splats->n_clips)
             ? CONIC_OK
             : CONIC_ERROR_MEMORY;
}

static void release_setup(host_setup *h) {
  conic_context *context = h->frame->opencl->context;
  conic_projected *p = &h->projected;
  void *all[] = {p->chunks, p->footprints, p->boxes, p->surfaces, p->rays, p->clips, h->n_drawn};
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
    conic_memory_release(context, all[i]);
}

static conic_status upload(const host_setup *h) {
  const conic_frame *f = h->frame;
  const conic_projected *p = &h->projected;
  uint32_t counts[CONIC_DEVICE_N_COUNTS] = {0};
  for (size_t i = 0; i < f->n_items; i++) {
    counts[CONIC_DEVICE_CULLED] += (uint32_t)p->chunks[i].n_culled;
    counts[CONIC_DEVICE_SKIPPED] += (uint32_t)p->chunks[i].n_skipped;
    counts[CONIC_DEVICE_FALLBACK] += (uint32_t)p->chunks[i].n_fallback;
    counts[CONIC_DEVICE_RAYS] += (uint32_t)p->chunks[i].n_rays;
    counts[CONIC_DEVICE_LAPLACES] += (uint32_t)p->chunks[i].n_laplaces;
  }
  conic_status status = CONIC_OK;
  const struct {
    int buffer;
    const void *from;
    size_t bytes;
  } all[] = {{CONIC_BUFFER_FOOTPRINTS, p->footprints, f->n * sizeof *p->footprints},
             {CONIC_BUFFER_BOXES, p->boxes, f->n * sizeof *p->boxes},
             {CONIC_BUFFER_SURFACES, p->surfaces, f->n * sizeof *p->surfaces},
             {CONIC_BUFFER_RAYS, p->rays, f->n * sizeof *p->rays},
             {CONIC_BUFFER_CLIP_RECORDS, p->clips, p->clips ? f->n * sizeof *p->clips : 0},
             {CONIC_BUFFER_N_DRAWN, h->n_drawn, f->n_items * sizeof *h->n_drawn},
             {CONIC_BUFFER_COUNTS, counts, sizeof counts}};
  for (size_t i = 0; i < sizeof all / sizeof all[0] && status == CONIC_OK; i++)
    status = conic_frame_copy(f, all[i].buffer, all[i].from, all[i].bytes);
  return status;
}

conic_status conic_frame_project_on_host(conic_frame *f) {
  host_setup h = {.frame = f};
  conic_status status = allocate_setup(&h);
  if (status == CONIC_OK) {
    conic_parallel_for(f->opencl->context, f->n_items, project_item, &h);
    status = upload(&h);
  }
  release_setup(&h);
  return status;
}
