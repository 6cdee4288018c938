#include "opencl/frame.h"

#include "core/image/image_common.h"
#include "raster/project/clip_lines.h"
#include "raster/view/method.h"

/* A tile's fragments are counted in 32 bits: no more splats than this are on a device at a time. */
#define MOST_PART_SPLATS (((size_t)1 << 24) - 1)

conic_status conic_frame_room(const conic_frame *f, int buffer, size_t count, size_t size) {
  return conic_queue_room(&f->opencl->queue, &f->opencl->buffers[buffer], count * size);
}

conic_status conic_frame_copy(const conic_frame *f, int buffer, const void *from, size_t bytes) {
  conic_status status = conic_frame_room(f, buffer, 1, bytes);
  return status == CONIC_OK ? conic_queue_write(&f->opencl->queue, &f->opencl->buffers[buffer], from, bytes) : status;
}

conic_status conic_frame_give(const conic_frame *f, int buffer, const void *from, size_t bytes) {
  conic_opencl *opencl = f->opencl;
  if (bytes && opencl->device.is_cpu)
    return conic_queue_wrap(&opencl->queue, &opencl->buffers[buffer], CL_MEM_READ_ONLY, from, bytes);
  if (bytes)
    return conic_frame_copy(f, buffer, from, bytes);
  conic_queue_release(&opencl->queue, &opencl->buffers[buffer]);
  return CONIC_OK;
}

conic_status conic_frame_run(const conic_frame *f, conic_stage stage, conic_entry_name entry,
                             const conic_argument *arguments, int n_arguments, size_t n_items) {
  int is_alone = f->opencl->device.is_cpu || f->opencl->work == CONIC_OPENCL_WORK_TILES;
  const size_t items[2] = {n_items, 1}, group[2] = {is_alone ? 1 : 64, 1};
  return conic_queue_run(&f->opencl->queue, stage, f->opencl->entries[entry], arguments, n_arguments, items, group);
}

conic_status conic_frame_scan(const conic_frame *f, conic_stage stage, uint32_t n, int numbers, int places,
                              uint64_t *total) {
  uint32_t n_sums = (n + CONIC_SCAN_NUMBERS - 1) / CONIC_SCAN_NUMBERS;
  conic_status status = conic_frame_room(f, CONIC_BUFFER_SCAN_SUMS, n_sums, sizeof(uint64_t));
  const conic_argument sums = conic_frame_argument(f, CONIC_BUFFER_SCAN_SUMS), of = conic_frame_argument(f, numbers);
  const conic_argument first[] = {CONIC_ARGUMENT(n), of, sums}, second[] = {CONIC_ARGUMENT(n_sums), sums};
  const conic_argument third[] = {CONIC_ARGUMENT(n), of, sums, conic_frame_argument(f, places)};
  if (status == CONIC_OK)
    status = conic_frame_run(f, stage, CONIC_ENTRY_SCAN_SUMS, first, 3, n_sums);
  if (status == CONIC_OK)
    status = conic_queue_run(&f->opencl->queue, stage, f->opencl->entries[CONIC_ENTRY_SCAN_TOPS], second, 2,
                             (const size_t[2]){1, 1}, (const size_t[2]){1, 1});
  if (status == CONIC_OK)
    status = conic_frame_run(f, stage, CONIC_ENTRY_SCAN_PLACES, third, 4, n_sums);
  if (status == CONIC_OK)
    status = conic_queue_read(&f->opencl->queue, &f->opencl->buffers[places], n * sizeof *total, total, sizeof *total);
  return status;
}

conic_status conic_frame_add_tiles(const conic_frame *f, int buffer, uint64_t *sum) {
  conic_context *context = f->opencl->context;
  uint32_t *of_tiles = conic_memory_allocate(context, f->n_tiles, sizeof *of_tiles);
  if (!of_tiles)
    return CONIC_ERROR_MEMORY;
  conic_status status =
      conic_queue_read(&f->opencl->queue, &f->opencl->buffers[buffer], 0, of_tiles, f->n_tiles * sizeof *of_tiles);
  for (uint32_t i = 0; i < f->n_tiles && status == CONIC_OK; i++)
    *sum += of_tiles[i];
  conic_memory_release(context, of_tiles);
  return status;
}

/* --- before the parts --- */

/* The directions of the pixels along one axis, of whole tiles; 0 past the image. */
static conic_status write_directions(const conic_frame *f, int buffer, int n_tiles, int size, double principal,
                                     double focal) {
  size_t n = (size_t)n_tiles * (size_t)f->opencl->tile;
  float *directions = conic_memory_allocate_zeroed(f->opencl->context, n, sizeof *directions);
  if (!directions)
    return CONIC_ERROR_MEMORY;
  for (int i = 0; i < size; i++)
    directions[i] = (float)(((double)i + 0.5 - principal) / focal);
  conic_status status = conic_frame_copy(f, buffer, directions, n * sizeof *directions);
  conic_memory_release(f->opencl->context, directions);
  return status;
}

conic_status conic_frame_open_plane(const conic_frame *f, int buffer, void *plane, size_t bytes) {
  conic_opencl *opencl = f->opencl;
  if (!plane)
    conic_queue_release(&opencl->queue, &opencl->buffers[buffer]);
  else if (opencl->device.is_cpu)
    return conic_queue_wrap(&opencl->queue, &opencl->buffers[buffer], CL_MEM_READ_WRITE, plane, bytes);
  else
    return conic_queue_room(&opencl->queue, &opencl->buffers[buffer], bytes);
  return CONIC_OK;
}

conic_status conic_frame_close_plane(const conic_frame *f, int buffer, void *plane, size_t bytes) {
  conic_opencl *opencl = f->opencl;
  cl_mem memory = opencl->buffers[buffer].memory;
  cl_int answer;
  if (!plane)
    return CONIC_OK;
  if (!opencl->device.is_cpu)
    return conic_queue_read(&opencl->queue, &opencl->buffers[buffer], 0, plane, bytes);
  void *mapped =
      clEnqueueMapBuffer(opencl->queue.queue, memory, CL_TRUE, CL_MAP_READ, 0, bytes, 0, NULL, NULL, &answer);
  if (mapped)
    clEnqueueUnmapMemObject(opencl->queue.queue, memory, mapped, 0, NULL, NULL);
  return conic_opencl_check(opencl->context, answer, "clEnqueueMapBuffer");
}

/* What the device draws into; null: no such plane. */
static void *drawn_plane(const conic_frame *f, int plane) {
  return f->is_hiding ? NULL : f->image->planes[plane];
}

static conic_status open_planes(const conic_frame *f) {
  conic_status status = CONIC_OK;
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES && status == CONIC_OK; plane++)
    status = conic_frame_open_plane(f, CONIC_BUFFER_PLANES + plane, drawn_plane(f, plane),
                                    conic_image_plane_bytes(f->image, plane));
  return status;
}

conic_status conic_frame_begin(conic_frame *f) {
  conic_device_frame *c = &f->constants;
  int tile = f->opencl->tile;
  c->width = f->view->width;
  c->height = f->view->height;
  c->n_tiles_x = (c->width + tile - 1) / tile;
  c->n_tiles_y = (c->height + tile - 1) / tile;
  c->n_blocks_x = c->n_tiles_x * (tile / 4);
  c->planes = f->is_hiding ? 0 : (int32_t)conic_image_planes(f->image);
  c->keeps_sums = f->opencl->keeps_sums;
  f->n_tiles = (uint32_t)c->n_tiles_x * (uint32_t)c->n_tiles_y;
  const struct {
    int buffer;
    size_t bytes;
  } needed[] = {{CONIC_BUFFER_FRAME, sizeof *c},
                {CONIC_BUFFER_COUNTS, CONIC_DEVICE_N_COUNTS * sizeof(uint32_t)},
                {CONIC_BUFFER_TILE_TOTALS, f->n_tiles * sizeof(uint32_t)},
                {CONIC_BUFFER_TILE_BEGIN, (f->n_tiles + (size_t)1) * sizeof(uint64_t)},
                {CONIC_BUFFER_N_FRAGMENTS, f->n_tiles * sizeof(uint32_t)},
                {CONIC_BUFFER_N_COVERED, f->n_tiles * sizeof(uint32_t)}};
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < sizeof needed / sizeof needed[0] && status == CONIC_OK; i++)
    status = conic_frame_room(f, needed[i].buffer, 1, needed[i].bytes);
  if (status == CONIC_OK && !c->is_single_pass)
    status = conic_frame_room(f, CONIC_BUFFER_THRESHOLDS, f->n_tiles, (size_t)tile * (size_t)tile * sizeof(float));
  if (status == CONIC_OK)
    status = open_planes(f);
  if (status == CONIC_OK)
    status = conic_frame_copy(f, CONIC_BUFFER_VIEW, f->view, sizeof *f->view);
  const conic_view *v = f->view;
  if (status == CONIC_OK)
    status = conic_frame_give(f, CONIC_BUFFER_PROFILE, v->profile.table,
                              v->profile.table ? CONIC_PROFILE_FLOATS * sizeof(float) : 0);
  if (status == CONIC_OK)
    status = write_directions(f, CONIC_BUFFER_DIRECTIONS_X, c->n_tiles_x, v->width, v->cx, v->fx);
  return status == CONIC_OK ? write_directions(f, CONIC_BUFFER_DIRECTIONS_Y, c->n_tiles_y, v->height, v->cy, v->fy)
                            : status;
}

/* --- after the parts --- */

/* The thresholds lie block by block, and those of a block column by column. */
static void take_hiding(const conic_frame *f, const float *thresholds, uint64_t *n_covered) {
  float *z = f->image->planes[CONIC_PLANE_Z];
  size_t width = (size_t)f->image->width, n_blocks_x = (size_t)f->constants.n_blocks_x;
  for (size_t y = 0; y < (size_t)f->image->height; y++)
    for (size_t x = 0; x < width; x++) {
      float iz = thresholds[16 * (y / 4 * n_blocks_x + x / 4) + 4 * (x % 4) + y % 4];
      z[y * width + x] = iz > 0.0f ? 1.0f / iz : 0.0f;
      *n_covered += iz > 0.0f;
    }
}

static conic_status end_hiding(const conic_frame *f, uint64_t *n_covered) {
  conic_context *context = f->opencl->context;
  size_t n = (size_t)f->n_tiles * (size_t)f->opencl->tile * (size_t)f->opencl->tile;
  float *thresholds = conic_memory_allocate(context, n, sizeof *thresholds);
  if (!thresholds)
    return CONIC_ERROR_MEMORY;
  conic_status status = conic_queue_read(&f->opencl->queue, &f->opencl->buffers[CONIC_BUFFER_THRESHOLDS], 0, thresholds,
                                         n * sizeof *thresholds);
  if (status == CONIC_OK)
    take_hiding(f, thresholds, n_covered);
  conic_memory_release(context, thresholds);
  return status;
}

conic_status conic_frame_end(conic_frame *f, uint64_t *n_covered) {
  conic_status status = CONIC_OK;
  if (f->is_hiding)
    return end_hiding(f, n_covered);
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES && status == CONIC_OK; plane++)
    status = conic_frame_close_plane(f, CONIC_BUFFER_PLANES + plane, drawn_plane(f, plane),
                                     conic_image_plane_bytes(f->image, plane));
  return status == CONIC_OK ? conic_frame_add_tiles(f, CONIC_BUFFER_N_COVERED, n_covered) : status;
}

conic_status conic_frame_close(conic_frame *f) {
  conic_opencl *opencl = f->opencl;
  conic_status status = conic_queue_finish(&opencl->queue);
  if (opencl->device.is_cpu) /* the image and the splats are the caller's */
    for (int buffer = CONIC_BUFFER_COLUMNS; buffer < CONIC_N_BUFFER_NAMES; buffer++)
      if (buffer < CONIC_BUFFER_CLIPS || buffer >= CONIC_BUFFER_PLANES)
        conic_queue_release(&opencl->queue, &opencl->buffers[buffer]);
  return status;
}

/* --- the frame --- */

/* How many splats the device holds at a time, with all that becomes of them. */
static size_t part_of(const conic_frame *f) {
  const conic_opencl *opencl = f->opencl;
  double pixel_bytes = 4.0 * (1 + CONIC_N_SUMS) + 64.0, image = (double)f->view->width * (double)f->view->height;
  size_t splat_bytes = sizeof(conic_footprint) + sizeof(conic_box) + sizeof(conic_projected_surface) +
                       sizeof(conic_ray) + (f->splats->n_clips ? sizeof(conic_clip_record) : 0) + 4 +
                       4 * (sizeof(conic_device_reference) + sizeof(uint64_t)) +
                       (opencl->device.is_cpu ? 0 : 13 * sizeof(float));
  double memory = CONIC_SHARE_OF_MEMORY * (double)opencl->device.memory_bytes - f->triangle_bytes;
  double n = (memory - image * pixel_bytes) / (double)splat_bytes;
  double most = (double)opencl->device.greatest_buffer_bytes / (double)sizeof(conic_footprint);
  n = n < most ? n : most;
  size_t part = n > 1.0 ? n < (double)MOST_PART_SPLATS ? (size_t)n : MOST_PART_SPLATS : 1;
  return opencl->part_splats && opencl->part_splats < part ? opencl->part_splats : part;
}

static conic_status add_counts(conic_frame *f) {
  uint32_t counts[CONIC_DEVICE_N_COUNTS] = {0};
  conic_status status =
      f->n ? conic_queue_read(&f->opencl->queue, &f->opencl->buffers[CONIC_BUFFER_COUNTS], 0, counts, sizeof counts)
           : CONIC_OK;
  for (int i = 0; i < CONIC_DEVICE_N_COUNTS; i++)
    f->counts[i] += counts[i];
  f->n_drawn_in_all += f->n_drawn;
  return status;
}

/* What is done with a part: in a walk of its own where there are several. */
typedef enum walk {
  WALK_VISIBILITY, /* and accumulation too, where the part is all there is */
  WALK_ACCUMULATE
} walk;

static conic_status take_part(conic_frame *f, walk purpose) {
  conic_status status = CONIC_OK;
  int counts = purpose == WALK_VISIBILITY || f->constants.is_single_pass;
  if (counts)
    status = add_counts(f);
  if (status != CONIC_OK)
    return status;
  if (purpose == WALK_ACCUMULATE)
    return conic_frame_accumulate(f);
  return f->n == f->splats->count && !f->is_hiding ? conic_frame_blend(f) : conic_frame_visibility(f);
}

/* Walks over the splats part by part; parts become smaller where their lists are too long for the device. */
static conic_status walk_parts(conic_frame *f, walk purpose, size_t *part) {
  size_t first = 0, count = f->splats->count;
  conic_status status = CONIC_OK;
  do {
    size_t n = count - first < *part ? count - first : *part;
    int fits = 1;
    status = conic_progress(f->opencl->context, "render", count ? (double)first / (double)count : 0.0);
    if (status == CONIC_OK)
      status = conic_frame_project(f, first, n);
    if (status == CONIC_OK)
      status = conic_frame_bin(f, &fits);
    if (status == CONIC_OK && !fits && n == 1)
      return conic_fail(f->opencl->context, CONIC_ERROR_MEMORY, "opencl: the device cannot hold the tiles' lists");
    if (status == CONIC_OK && !fits) {
      *part = n / 2;
      continue;
    }
    if (status == CONIC_OK)
      status = take_part(f, purpose);
    first += n;
  } while (status == CONIC_OK && first < count);
  return status;
}

static void set_finish(const conic_finish *finish, conic_device_frame *c) {
  c->is_single_pass = finish->options->passes == 1;
  c->shading = (int32_t)finish->options->shading;
  memcpy(c->world_from_cam, finish->world_from_cam, sizeof c->world_from_cam);
  c->lights = *finish->lights;
  memcpy(c->background, finish->background, sizeof c->background);
  c->exposure = finish->exposure;
}

static void report_frame(const conic_frame *f, conic_render_statistics *s) {
  const double *ms = f->opencl->queue.ms;
  s->splats_culled = f->counts[CONIC_DEVICE_CULLED];
  s->splats_skipped = f->counts[CONIC_DEVICE_SKIPPED];
  s->splats_fallback = f->counts[CONIC_DEVICE_FALLBACK];
  s->splats_drawn = f->n_drawn_in_all;
  s->fragments = f->n_fragments;
  conic_method_count(f->view->method, f->counts[CONIC_DEVICE_RAYS], s);
  s->splats_by_laplace = f->counts[CONIC_DEVICE_LAPLACES];
  s->threads = f->opencl->device.n_compute_units;
  s->tile = f->opencl->tile;
  s->isa = "opencl";
  s->ms.setup = ms[CONIC_STAGE_SETUP];
  s->ms.bin = ms[CONIC_STAGE_BIN];
  s->ms.visibility = ms[CONIC_STAGE_VISIBILITY];
  s->ms.accumulate = ms[CONIC_STAGE_ACCUMULATE];
  s->ms.resolve = ms[CONIC_STAGE_RESOLVE];
}

/* The splats part by part, between the triangles' two stages. */
static conic_status draw_parts(conic_frame *f) {
  size_t part = part_of(f), count = f->splats->count;
  int draws_splats = count || !f->triangles, is_single = f->constants.is_single_pass;
  conic_status status = conic_progress(f->opencl->context, "render", 0.0);
  if (status == CONIC_OK)
    status = conic_frame_begin(f);
  if (status == CONIC_OK && f->triangles)
    status = conic_frame_draw_triangles(f);
  if (status == CONIC_OK && draws_splats && !is_single)
    status = walk_parts(f, WALK_VISIBILITY, &part);
  if (status == CONIC_OK && draws_splats && !f->is_hiding && (is_single || f->n < count))
    status = walk_parts(f, WALK_ACCUMULATE, &part);
  return status == CONIC_OK && f->triangles && !f->is_hiding ? conic_frame_add_triangles(f) : status;
}

conic_status conic_frame_draw(conic_backend *backend, const conic_view *view, const conic_splats *splats,
                              struct conic_triangle_frame *triangles, const conic_finish *finish, conic_image *image,
                              conic_render_statistics *statistics) {
  conic_opencl *opencl = (conic_opencl *)backend;
  conic_frame f = {.opencl = opencl,
                   .view = view,
                   .splats = splats,
                   .triangles = triangles,
                   .image = image,
                   .splats_version = finish->options->splats_version,
                   .is_hiding = finish->options->passes == CONIC_PASS_OF_HIDING};
  memset(opencl->queue.ms, 0, sizeof opencl->queue.ms);
  set_finish(finish, &f.constants);
  conic_status status = conic_opencl_need_splats(opencl);
  if (status == CONIC_OK && triangles)
    status = conic_frame_set_up_triangles(&f, finish->options->isa);
  if (status == CONIC_OK)
    status = draw_parts(&f);
  if (status == CONIC_OK)
    status = conic_frame_end(&f, &statistics->pixels_covered);
  if (status == CONIC_OK && triangles)
    status = conic_frame_count_triangles(&f, statistics);
  conic_status closed = conic_frame_close(&f);
  status = status == CONIC_OK ? closed : status;
  if (status != CONIC_OK)
    return status;
  report_frame(&f, statistics);
  return conic_progress(opencl->context, "render", 1.0);
}
