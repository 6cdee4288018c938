#include "raster/frame/splat_boxes.h"

#include "core/base/base.h"
#include "core/image/view_arguments.h"
#include "raster/frame/drawing.h"
#include "raster/loops/raster_loops.h"

/* Splats that are projected at a time: their records stay in a core's cache. */
enum { CHUNK = 2048, PLACES = CHUNK + CONIC_PROJECT_SLACK };

/* A thread's records, which are dropped. */
typedef struct dropped_records {
  conic_footprint footprints[PLACES];
  conic_projected_surface surfaces[PLACES];
  conic_ray rays[PLACES];
  conic_box boxes[PLACES];
} dropped_records;

typedef struct box_search {
  const conic_splats *splats;
  conic_view view;
  conic_raster_loops loops;
  conic_box *boxes;
  dropped_records *records; /* a thread */
  conic_chunk *counts;      /* likewise */
} box_search;

static void find_boxes_of_chunk(void *data, size_t i_chunk, int i_thread) {
  box_search *s = data;
  dropped_records *r = &s->records[i_thread];
  conic_chunk chunk = {.first = 0};
  conic_projected projected = {.n_chunks = 1,
                               .chunk_size = CHUNK,
                               .chunks = &chunk,
                               .footprints = r->footprints,
                               .boxes = r->boxes,
                               .surfaces = r->surfaces,
                               .rays = r->rays};
  size_t begin = i_chunk * CHUNK, left = s->splats->count - begin, n = left < CHUNK ? left : CHUNK;
  s->loops.project.project(&s->view, s->splats, begin, begin + n, &projected, &chunk);
  memset(s->boxes + begin, 0, n * sizeof *s->boxes);
  for (size_t i = 0; i < chunk.n_drawn; i++)
    s->boxes[r->surfaces[i].index] = r->boxes[i];
  conic_chunk_add(&chunk, &s->counts[i_thread]);
}

static conic_status begin_box_search(conic_context *context, const conic_camera *camera,
                                     const conic_render_options *options, unsigned planes, box_search *s) {
  conic_isa isa;
  conic_status status = conic_isa_choose(context, options->isa, &isa);
  if (status == CONIC_OK)
    status = conic_view_init(context, s->splats, camera, options, options->near_z, options->splat_length, &s->view);
  if (status != CONIC_OK)
    return status;
  conic_raster_loops_init(&s->loops, isa);
  s->view.needs_nearness = options->passes != 1; /* what is not finite is skipped */
  s->view.needs_slope = options->passes != 1 || planes >> CONIC_PLANE_Z & 1;
  size_t n_threads = (size_t)conic_context_threads(context);
  return conic_memory_allocate_these(context, CONIC_ROOM(s->records, n_threads), CONIC_ZEROED(s->counts, n_threads));
}

conic_status conic_splats_find_boxes(conic_context *context, const conic_splats *splats, const conic_camera *camera,
                                     const conic_render_options *given, unsigned planes, conic_box *boxes,
                                     conic_render_statistics *statistics) {
  box_search s = {.splats = splats, .boxes = boxes};
  conic_render_options options;
  conic_status status = conic_view_arguments_take(context, "render", camera, given, &options);
  if (status == CONIC_OK)
    status = begin_box_search(context, camera, &options, planes, &s);
  if (status == CONIC_OK)
    status =
        conic_parallel_told(context, "render", 0.0, 0.0, (splats->count + CHUNK - 1) / CHUNK, find_boxes_of_chunk, &s);
  if (status == CONIC_OK)
    conic_chunks_count(s.counts, (size_t)conic_context_threads(context), options.method, statistics);
  conic_memory_release_these(context, s.records, s.counts);
  return status;
}
