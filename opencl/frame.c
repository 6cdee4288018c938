#include "opencl/frame.h"

#include <string.h>

#include "core/memory.h"
#include "core/message.h"
#include "raster/clip_lines.h"
#include "raster/method.h"
#include "raster/projected.h"

/* A tile's fragments are counted in 32 bits: no more splats than this are on a device at a time. */
#define MOST_PART_SPLATS (((size_t)1 << 24) - 1)

/* Of a device's memory, what a frame may take. */
#define SHARE_OF_MEMORY 0.75

enum { ARGUMENTS_OF_RECORDS = 8, ARGUMENTS_OF_PLANES = 10 };

static cl_mem memory_of(const conic_frame *f, int buffer) {
  return f->opencl->buffers[buffer].memory;
}

static conic_argument buffer_argument(const conic_frame *f, int buffer) {
  return (conic_argument){sizeof(cl_mem), &f->opencl->buffers[buffer].memory};
}

static conic_status room(const conic_frame *f, int buffer, size_t count, size_t size) {
  return conic_queue_room(&f->opencl->queue, &f->opencl->buffers[buffer], count * size);
}

/* Runs a kernel over a row of work-items; one is a group on a CPU, where each has much to do. */
static conic_status run(const conic_frame *f, conic_stage stage, conic_kernel_name kernel,
                        const conic_argument *arguments, int n_arguments, size_t n_items) {
  const size_t items[2] = {n_items, 1}, group[2] = {f->opencl->device.is_cpu ? 1 : 64, 1};
  return conic_queue_run(&f->opencl->queue, stage, f->opencl->kernels[kernel], arguments, n_arguments, items, group);
}

/* --- before the parts --- */

/* The directions of the pixels along one axis, of whole tiles; 0 past the image. */
static conic_status write_directions(const conic_frame *f, int buffer, int n_tiles, int size, double principal,
                                     double focal) {
  size_t n = (size_t)n_tiles * CONIC_DEVICE_TILE;
  float *directions = conic_memory_allocate_zeroed(f->opencl->context, n, sizeof *directions);
  if (!directions)
    return CONIC_ERROR_MEMORY;
  for (int i = 0; i < size; i++)
    directions[i] = (float)(((double)i + 0.5 - principal) / focal);
  conic_status status = room(f, buffer, n, sizeof *directions);
  if (status == CONIC_OK)
    status = conic_queue_write(&f->opencl->queue, &f->opencl->buffers[buffer], directions, n * sizeof *directions);
  conic_memory_release(f->opencl->context, directions);
  return status;
}

static size_t plane_bytes(const conic_image *image, int plane) {
  return (size_t)image->width * (size_t)image->height * 4 *
         (size_t)conic_plane_describe((conic_plane)plane)->n_channels;
}

/* A CPU's device draws into the image itself, another into memory of its own. */
static conic_status open_planes(const conic_frame *f) {
  conic_opencl *opencl = f->opencl;
  conic_status status = CONIC_OK;
  for (int plane = 0; plane < CONIC_N_PLANES && status == CONIC_OK; plane++) {
    conic_buffer *buffer = &opencl->buffers[CONIC_BUFFER_PLANES + plane];
    size_t bytes = plane_bytes(f->image, plane);
    if (!f->image->planes[plane]) {
      conic_queue_release(buffer);
    } else if (opencl->device.is_cpu) {
      cl_int answer;
      conic_queue_release(buffer);
      buffer->memory = clCreateBuffer(opencl->queue.cl, CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes,
                                      f->image->planes[plane], &answer);
      status = conic_opencl_check(opencl->context, answer, "clCreateBuffer");
    } else
      status = conic_queue_room(&opencl->queue, buffer, bytes);
  }
  return status;
}

conic_status conic_frame_begin(conic_frame *f) {
  conic_device_frame *c = &f->constants;
  c->width = f->view->width;
  c->height = f->view->height;
  c->n_tiles_x = (c->width + CONIC_DEVICE_TILE - 1) / CONIC_DEVICE_TILE;
  c->n_tiles_y = (c->height + CONIC_DEVICE_TILE - 1) / CONIC_DEVICE_TILE;
  c->n_blocks_x = c->n_tiles_x * (CONIC_DEVICE_TILE / 4);
  c->planes = (int32_t)conic_image_planes(f->image);
  c->keeps_sums = f->opencl->keeps_sums;
  f->n_tiles = (uint32_t)c->n_tiles_x * (uint32_t)c->n_tiles_y;
  const struct {
    int buffer;
    size_t bytes;
  } needed[] = {{CONIC_BUFFER_VIEW, sizeof *f->view},
                {CONIC_BUFFER_FRAME, sizeof *c},
                {CONIC_BUFFER_COUNTS, CONIC_DEVICE_N_COUNTS * sizeof(uint32_t)},
                {CONIC_BUFFER_TILE_TOTALS, f->n_tiles * sizeof(uint32_t)},
                {CONIC_BUFFER_TILE_BEGIN, (f->n_tiles + (size_t)1) * sizeof(uint64_t)},
                {CONIC_BUFFER_N_FRAGMENTS, f->n_tiles * sizeof(uint32_t)},
                {CONIC_BUFFER_N_COVERED, f->n_tiles * sizeof(uint32_t)}};
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < sizeof needed / sizeof needed[0] && status == CONIC_OK; i++)
    status = room(f, needed[i].buffer, 1, needed[i].bytes);
  if (status == CONIC_OK && !c->is_single_pass)
    status = room(f, CONIC_BUFFER_THRESHOLDS, f->n_tiles, CONIC_DEVICE_TILE * CONIC_DEVICE_TILE * sizeof(float));
  if (status == CONIC_OK)
    status = open_planes(f);
  if (status == CONIC_OK)
    status = conic_queue_write(&f->opencl->queue, &f->opencl->buffers[CONIC_BUFFER_VIEW], f->view, sizeof *f->view);
  const conic_view *v = f->view;
  if (status == CONIC_OK)
    status = write_directions(f, CONIC_BUFFER_DIRECTIONS_X, c->n_tiles_x, v->width, v->cx, v->fx);
  return status == CONIC_OK ? write_directions(f, CONIC_BUFFER_DIRECTIONS_Y, c->n_tiles_y, v->height, v->cy, v->fy)
                            : status;
}

/* --- set-up --- */

/* One column of the part's splats: a CPU's device reads it where it is. */
static conic_status write_column(const conic_frame *f, int column, const float *values) {
  conic_queue *queue = &f->opencl->queue;
  conic_buffer *buffer = &f->opencl->buffers[CONIC_BUFFER_COLUMNS + column];
  size_t bytes = f->n * sizeof *values;
  cl_int answer;
  if (!values || !f->opencl->device.is_cpu) {
    conic_status status = values ? conic_queue_room(queue, buffer, bytes) : CONIC_OK;
    return values && status == CONIC_OK ? conic_queue_write(queue, buffer, values + f->first, bytes) : status;
  }
  conic_queue_release(buffer);
  buffer->memory = clCreateBuffer(queue->cl, CL_MEM_READ_ONLY | CL_MEM_USE_HOST_PTR, bytes,
                                  (void *)(uintptr_t)(values + f->first), &answer);
  return conic_opencl_check(queue->context, answer, "clCreateBuffer");
}

static conic_status write_columns(const conic_frame *f) {
  const conic_splats *s = f->splats;
  const float *columns[13];
  conic_status status = CONIC_OK;
  for (int axis = 0; axis < 3; axis++) {
    columns[axis] = s->position[axis];
    columns[3 + axis] = s->tangent_u[axis];
    columns[6 + axis] = s->tangent_v[axis];
    columns[9 + axis] = s->color[axis];
  }
  columns[12] = s->opacity;
  for (int column = 0; column < 13 && status == CONIC_OK; column++)
    status = write_column(f, column, columns[column]);
  return status;
}

/* The clip lines of the part's splats. */
static conic_status write_clips(const conic_frame *f, uint32_t *n_clips) {
  const conic_splats *s = f->splats;
  size_t begin = 0, end;
  while (begin < s->n_clips && s->clips[begin].splat < f->first)
    begin++;
  for (end = begin; end < s->n_clips && s->clips[end].splat < f->first + f->n;)
    end++;
  *n_clips = (uint32_t)(end - begin);
  if (end == begin)
    return CONIC_OK;
  conic_status status = room(f, CONIC_BUFFER_CLIPS, end - begin, sizeof *s->clips);
  if (status == CONIC_OK)
    status = room(f, CONIC_BUFFER_CLIP_RECORDS, f->n, sizeof(conic_clip_record));
  if (status != CONIC_OK)
    return status;
  return conic_queue_write(&f->opencl->queue, &f->opencl->buffers[CONIC_BUFFER_CLIPS], s->clips + begin,
                           (end - begin) * sizeof *s->clips);
}

static conic_status make_room_for_records(const conic_frame *f) {
  const struct {
    int buffer;
    size_t count, size;
  } needed[] = {{CONIC_BUFFER_FOOTPRINTS, f->n, sizeof(conic_footprint)},
                {CONIC_BUFFER_BOXES, f->n, sizeof(conic_box)},
                {CONIC_BUFFER_SURFACES, f->n, sizeof(conic_surface)},
                {CONIC_BUFFER_RAYS, f->n, sizeof(conic_ray)},
                {CONIC_BUFFER_ORDER, f->n, sizeof(uint32_t)},
                {CONIC_BUFFER_N_DRAWN, f->n_items, sizeof(uint32_t)},
                {CONIC_BUFFER_PLACES, f->n_items + (size_t)1, sizeof(uint64_t)}};
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < sizeof needed / sizeof needed[0] && status == CONIC_OK; i++)
    status = room(f, needed[i].buffer, needed[i].count, needed[i].size);
  return status;
}

static conic_status project_on_device(conic_frame *f) {
  conic_queue *queue = &f->opencl->queue;
  uint32_t n_clips = 0, fields = 0, first = (uint32_t)f->first;
  conic_argument arguments[26];
  int n = 0;
  fields |= f->splats->color[0] ? CONIC_DEVICE_HAS_COLOR : 0;
  fields |= f->splats->opacity ? CONIC_DEVICE_HAS_OPACITY : 0;
  conic_status status = write_columns(f);
  if (status == CONIC_OK)
    status = write_clips(f, &n_clips);
  if (status == CONIC_OK)
    status = conic_queue_fill_zero(queue, &f->opencl->buffers[CONIC_BUFFER_COUNTS],
                                   CONIC_DEVICE_N_COUNTS * sizeof(uint32_t));
  if (status != CONIC_OK)
    return status;
  arguments[n++] = buffer_argument(f, CONIC_BUFFER_VIEW);
  arguments[n++] = CONIC_ARGUMENT(f->n);
  arguments[n++] = CONIC_ARGUMENT(first);
  arguments[n++] = CONIC_ARGUMENT(f->splats_per_item);
  arguments[n++] = CONIC_ARGUMENT(fields);
  for (int column = 0; column < 13; column++)
    arguments[n++] = buffer_argument(f, CONIC_BUFFER_COLUMNS + column);
  arguments[n++] = CONIC_ARGUMENT(n_clips);
  for (int buffer = CONIC_BUFFER_CLIPS; buffer <= CONIC_BUFFER_COUNTS; buffer++)
    arguments[n++] = buffer_argument(f, buffer);
  int is_in_lanes = f->opencl->work == CONIC_OPENCL_WORK_TILES && !conic_method_is_dot(f->view->method);
  return run(f, CONIC_STAGE_SETUP, is_in_lanes ? CONIC_KERNEL_PROJECT_LANES : CONIC_KERNEL_PROJECT, arguments, n,
             f->n_items);
}

/* places[i] = the sum of numbers[0 … i - 1]; places[n] is the total, which comes back. */
static conic_status scan(const conic_frame *f, conic_stage stage, uint32_t n, int numbers, int places,
                         uint64_t *total) {
  uint32_t n_sums = (n + CONIC_SCAN_NUMBERS - 1) / CONIC_SCAN_NUMBERS;
  conic_status status = room(f, CONIC_BUFFER_SCAN_SUMS, n_sums, sizeof(uint64_t));
  const conic_argument sums = buffer_argument(f, CONIC_BUFFER_SCAN_SUMS), of = buffer_argument(f, numbers);
  const conic_argument first[] = {CONIC_ARGUMENT(n), of, sums}, second[] = {CONIC_ARGUMENT(n_sums), sums};
  const conic_argument third[] = {CONIC_ARGUMENT(n), of, sums, buffer_argument(f, places)};
  if (status == CONIC_OK)
    status = run(f, stage, CONIC_KERNEL_SCAN_SUMS, first, 3, n_sums);
  if (status == CONIC_OK)
    status = conic_queue_run(&f->opencl->queue, stage, f->opencl->kernels[CONIC_KERNEL_SCAN_TOPS], second, 2,
                             (const size_t[2]){1, 1}, (const size_t[2]){1, 1});
  if (status == CONIC_OK)
    status = run(f, stage, CONIC_KERNEL_SCAN_PLACES, third, 4, n_sums);
  if (status == CONIC_OK)
    status = conic_queue_read(&f->opencl->queue, &f->opencl->buffers[places], n * sizeof *total, total, sizeof *total);
  return status;
}

static conic_status compact(conic_frame *f) {
  uint64_t n_drawn;
  conic_status status = scan(f, CONIC_STAGE_SETUP, f->n_items, CONIC_BUFFER_N_DRAWN, CONIC_BUFFER_PLACES, &n_drawn);
  if (status != CONIC_OK)
    return status;
  f->n_drawn = (uint32_t)n_drawn;
  const conic_argument arguments[] = {CONIC_ARGUMENT(f->n_items), CONIC_ARGUMENT(f->splats_per_item),
                                      buffer_argument(f, CONIC_BUFFER_N_DRAWN), buffer_argument(f, CONIC_BUFFER_PLACES),
                                      buffer_argument(f, CONIC_BUFFER_ORDER)};
  return run(f, CONIC_STAGE_SETUP, CONIC_KERNEL_COMPACT, arguments, 5, f->n_items);
}

conic_status conic_frame_project(conic_frame *f, size_t first, size_t n) {
  f->first = first;
  f->n = (uint32_t)n;
  f->n_drawn = 0;
  f->splats_per_item =
      f->opencl->work == CONIC_OPENCL_WORK_TILES || f->opencl->projects_on_host ? CONIC_SETUP_SPLATS : 1;
  f->n_items = (f->n + f->splats_per_item - 1) / f->splats_per_item;
  conic_status status = make_room_for_records(f);
  if (status != CONIC_OK || n == 0)
    return status;
  status = f->opencl->projects_on_host ? conic_frame_project_on_host(f) : project_on_device(f);
  return status == CONIC_OK ? compact(f) : status;
}

/* --- binning --- */

/* Chunks that are counted and filled at the same time: enough of them for all units, few enough for their counts. */
static uint32_t chunks_of(const conic_frame *f) {
  size_t units = (size_t)f->opencl->device.n_compute_units;
  size_t most = f->opencl->device.is_cpu ? 8 * units : 128 * units, least_splats = f->opencl->device.is_cpu ? 2048 : 64;
  size_t n_chunks = f->n_drawn / least_splats + 1;
  n_chunks = n_chunks < most ? n_chunks : most;
  while (n_chunks > 1 && n_chunks * f->n_tiles > (size_t)1 << 25)
    n_chunks /= 2;
  return (uint32_t)n_chunks;
}

static int fits_device(const conic_frame *f, uint64_t n_references) {
  const conic_opencl_device *device = &f->opencl->device;
  double bytes = (double)n_references * (double)sizeof(conic_device_reference);
  return bytes <= (double)device->greatest_buffer_bytes && bytes <= 0.25 * (double)device->memory_bytes;
}

conic_status conic_frame_bin(conic_frame *f, int *fits) {
  uint32_t n_chunks = chunks_of(f), n_tiles_x = (uint32_t)f->constants.n_tiles_x;
  uint32_t chunk_size = (f->n_drawn + n_chunks - 1) / n_chunks;
  f->n_references = 0;
  *fits = 1;
  if (f->n_drawn == 0)
    return conic_queue_fill_zero(&f->opencl->queue, &f->opencl->buffers[CONIC_BUFFER_TILE_BEGIN],
                                 (f->n_tiles + (size_t)1) * sizeof(uint64_t));
  conic_status status = room(f, CONIC_BUFFER_TILE_COUNTS, (size_t)n_chunks * f->n_tiles, sizeof(uint32_t));
  conic_argument arguments[10] = {CONIC_ARGUMENT(n_chunks),
                                  CONIC_ARGUMENT(f->n_tiles),
                                  CONIC_ARGUMENT(n_tiles_x),
                                  CONIC_ARGUMENT(f->n_drawn),
                                  CONIC_ARGUMENT(chunk_size),
                                  buffer_argument(f, CONIC_BUFFER_ORDER),
                                  buffer_argument(f, CONIC_BUFFER_BOXES),
                                  buffer_argument(f, CONIC_BUFFER_TILE_COUNTS),
                                  buffer_argument(f, CONIC_BUFFER_TILE_BEGIN),
                                  buffer_argument(f, CONIC_BUFFER_REFERENCES)};
  const conic_argument of_places[] = {CONIC_ARGUMENT(f->n_tiles), CONIC_ARGUMENT(n_chunks),
                                      buffer_argument(f, CONIC_BUFFER_TILE_COUNTS),
                                      buffer_argument(f, CONIC_BUFFER_TILE_TOTALS)};
  if (status == CONIC_OK)
    status = run(f, CONIC_STAGE_BIN, CONIC_KERNEL_COUNT_TILES, arguments, 8, n_chunks);
  if (status == CONIC_OK)
    status = run(f, CONIC_STAGE_BIN, CONIC_KERNEL_PLACE_CHUNKS, of_places, 4, f->n_tiles);
  if (status == CONIC_OK)
    status = scan(f, CONIC_STAGE_BIN, f->n_tiles, CONIC_BUFFER_TILE_TOTALS, CONIC_BUFFER_TILE_BEGIN, &f->n_references);
  if (status != CONIC_OK)
    return status;
  *fits = fits_device(f, f->n_references);
  if (!*fits)
    return CONIC_OK;
  status = room(f, CONIC_BUFFER_REFERENCES, f->n_references, sizeof(conic_device_reference));
  return status == CONIC_OK ? run(f, CONIC_STAGE_BIN, CONIC_KERNEL_FILL_TILES, arguments, 10, n_chunks) : status;
}

/* --- the raster --- */

/* What every kernel of the raster reads. */
static int records(const conic_frame *f, conic_argument *to) {
  const int buffers[ARGUMENTS_OF_RECORDS] = {CONIC_BUFFER_VIEW,       CONIC_BUFFER_FRAME,       CONIC_BUFFER_TILE_BEGIN,
                                             CONIC_BUFFER_REFERENCES, CONIC_BUFFER_FOOTPRINTS,  CONIC_BUFFER_SURFACES,
                                             CONIC_BUFFER_RAYS,       CONIC_BUFFER_CLIP_RECORDS};
  for (int i = 0; i < ARGUMENTS_OF_RECORDS; i++)
    to[i] = buffer_argument(f, buffers[i]);
  return ARGUMENTS_OF_RECORDS;
}

static int planes(const conic_frame *f, conic_argument *to) {
  to[0] = buffer_argument(f, CONIC_BUFFER_DIRECTIONS_X);
  to[1] = buffer_argument(f, CONIC_BUFFER_DIRECTIONS_Y);
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    to[2 + plane] = buffer_argument(f, CONIC_BUFFER_PLANES + plane);
  to[2 + CONIC_N_PLANES] = buffer_argument(f, CONIC_BUFFER_N_COVERED);
  return ARGUMENTS_OF_PLANES;
}

/* A tile or a pixel a work-item. */
static conic_status run_raster(const conic_frame *f, conic_stage stage, conic_kernel_name kernel,
                               const conic_argument *arguments, int n_arguments) {
  if (f->opencl->work == CONIC_OPENCL_WORK_TILES)
    return conic_queue_run(&f->opencl->queue, stage, f->opencl->kernels[kernel], arguments, n_arguments,
                           (const size_t[2]){f->n_tiles, 1}, (const size_t[2]){1, 1});
  const size_t items[2] = {(size_t)f->constants.n_tiles_x * CONIC_DEVICE_TILE,
                           (size_t)f->constants.n_tiles_y * CONIC_DEVICE_TILE};
  return conic_queue_run(&f->opencl->queue, stage, f->opencl->kernels[kernel], arguments, n_arguments, items,
                         (const size_t[2]){CONIC_DEVICE_TILE, CONIC_DEVICE_TILE});
}

static conic_status write_constants(conic_frame *f) {
  f->constants.is_first = f->first == 0;
  f->constants.is_last = f->first + f->n == f->splats->count;
  return conic_queue_write(&f->opencl->queue, &f->opencl->buffers[CONIC_BUFFER_FRAME], &f->constants,
                           sizeof f->constants);
}

/* Adds up what the tiles have counted of the part. */
static conic_status add_tiles(const conic_frame *f, int buffer, uint64_t *sum) {
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

static conic_status clear_tiles(const conic_frame *f, int buffer) {
  return conic_queue_fill_zero(&f->opencl->queue, &f->opencl->buffers[buffer], f->n_tiles * sizeof(uint32_t));
}

conic_status conic_frame_visibility(conic_frame *f) {
  conic_argument arguments[ARGUMENTS_OF_RECORDS + 2];
  int n = records(f, arguments);
  arguments[n++] = buffer_argument(f, CONIC_BUFFER_THRESHOLDS);
  arguments[n++] = buffer_argument(f, CONIC_BUFFER_N_FRAGMENTS);
  conic_status status = write_constants(f);
  if (status == CONIC_OK)
    status = clear_tiles(f, CONIC_BUFFER_N_FRAGMENTS);
  if (status == CONIC_OK)
    status = run_raster(f, CONIC_STAGE_VISIBILITY, CONIC_KERNEL_VISIBILITY, arguments, n);
  return status == CONIC_OK ? add_tiles(f, CONIC_BUFFER_N_FRAGMENTS, &f->n_fragments) : status;
}

conic_status conic_frame_accumulate(conic_frame *f) {
  conic_argument arguments[ARGUMENTS_OF_RECORDS + 2 + ARGUMENTS_OF_PLANES];
  int n = records(f, arguments), is_single = f->constants.is_single_pass, counts = CONIC_BUFFER_N_FRAGMENTS;
  arguments[n++] = buffer_argument(f, is_single ? counts : CONIC_BUFFER_THRESHOLDS);
  arguments[n++] = buffer_argument(f, CONIC_BUFFER_SUMS);
  n += planes(f, arguments + n);
  conic_status status = write_constants(f);
  if (status == CONIC_OK && (!f->constants.is_first || !f->constants.is_last || f->constants.keeps_sums)) {
    status = room(f, CONIC_BUFFER_SUMS, f->n_tiles,
                  (size_t)CONIC_DEVICE_TILE * CONIC_DEVICE_TILE * CONIC_N_SUMS * sizeof(float));
    arguments[ARGUMENTS_OF_RECORDS + 1] = buffer_argument(f, CONIC_BUFFER_SUMS);
  }
  if (status == CONIC_OK && is_single)
    status = clear_tiles(f, counts);
  if (status == CONIC_OK)
    status = clear_tiles(f, CONIC_BUFFER_N_COVERED);
  if (status == CONIC_OK)
    status =
        run_raster(f, CONIC_STAGE_ACCUMULATE, is_single ? CONIC_KERNEL_NEAREST : CONIC_KERNEL_ACCUMULATE, arguments, n);
  return status == CONIC_OK && is_single ? add_tiles(f, counts, &f->n_fragments) : status;
}

conic_status conic_frame_end(conic_frame *f, uint64_t *n_covered) {
  conic_opencl *opencl = f->opencl;
  conic_status status = CONIC_OK;
  for (int plane = 0; plane < CONIC_N_PLANES && status == CONIC_OK; plane++) {
    cl_mem memory = memory_of(f, CONIC_BUFFER_PLANES + plane);
    size_t bytes = plane_bytes(f->image, plane);
    if (!f->image->planes[plane])
      continue;
    if (!opencl->device.is_cpu) {
      status = conic_queue_read(&opencl->queue, &opencl->buffers[CONIC_BUFFER_PLANES + plane], 0,
                                f->image->planes[plane], bytes);
      continue;
    }
    cl_int answer;
    void *mapped =
        clEnqueueMapBuffer(opencl->queue.queue, memory, CL_TRUE, CL_MAP_READ, 0, bytes, 0, NULL, NULL, &answer);
    status = conic_opencl_check(opencl->context, answer, "clEnqueueMapBuffer");
    if (mapped)
      clEnqueueUnmapMemObject(opencl->queue.queue, memory, mapped, 0, NULL, NULL);
  }
  if (status == CONIC_OK)
    status = add_tiles(f, CONIC_BUFFER_N_COVERED, n_covered);
  conic_status finished = conic_queue_finish(&opencl->queue);
  if (opencl->device.is_cpu) /* the image and the splats are the caller's */
    for (int buffer = CONIC_BUFFER_COLUMNS; buffer < CONIC_N_BUFFER_NAMES; buffer++)
      if (buffer < CONIC_BUFFER_CLIPS || buffer >= CONIC_BUFFER_PLANES)
        conic_queue_release(&opencl->buffers[buffer]);
  return status == CONIC_OK ? finished : status;
}

/* --- the frame --- */

/* How many splats the device holds at a time, with all that becomes of them. */
static size_t part_of(const conic_frame *f) {
  const conic_opencl *opencl = f->opencl;
  double pixel_bytes = 4.0 * (1 + CONIC_N_SUMS) + 56.0, image = (double)f->view->width * (double)f->view->height;
  size_t splat_bytes = sizeof(conic_footprint) + sizeof(conic_box) + sizeof(conic_surface) + sizeof(conic_ray) +
                       (f->splats->n_clips ? sizeof(conic_clip_record) : 0) + 4 + 4 * sizeof(conic_device_reference) +
                       (opencl->device.is_cpu ? 0 : 13 * sizeof(float));
  double n = (SHARE_OF_MEMORY * (double)opencl->device.memory_bytes - image * pixel_bytes) / (double)splat_bytes;
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
  if (status == CONIC_OK && purpose == WALK_VISIBILITY)
    status = conic_frame_visibility(f);
  if (status == CONIC_OK && (purpose == WALK_ACCUMULATE || f->n == f->splats->count))
    status = conic_frame_accumulate(f);
  return status;
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
  c->has_light = finish->options->has_light;
  memcpy(c->world_from_cam, finish->world_from_cam, sizeof c->world_from_cam);
  memcpy(c->light, finish->light, sizeof c->light);
  memcpy(c->background, finish->background, sizeof c->background);
  c->exposure = finish->exposure;
}

static void report(const conic_frame *f, conic_render_statistics *s) {
  const double *ms = f->opencl->queue.ms;
  s->splats_culled = f->counts[CONIC_DEVICE_CULLED];
  s->splats_skipped = f->counts[CONIC_DEVICE_SKIPPED];
  s->splats_fallback = f->counts[CONIC_DEVICE_FALLBACK];
  s->splats_drawn = f->n_drawn_in_all;
  s->fragments = f->n_fragments;
  conic_method_count(f->view->method, f->counts[CONIC_DEVICE_RAYS], s);
  s->threads = f->opencl->device.n_compute_units;
  s->tile = CONIC_DEVICE_TILE;
  s->isa = "opencl";
  s->ms.setup = ms[CONIC_STAGE_SETUP];
  s->ms.bin = ms[CONIC_STAGE_BIN];
  s->ms.visibility = ms[CONIC_STAGE_VISIBILITY];
  s->ms.accumulate = ms[CONIC_STAGE_ACCUMULATE];
  s->ms.resolve = ms[CONIC_STAGE_RESOLVE];
}

conic_status conic_frame_draw(conic_backend *backend, const conic_view *view, const conic_splats *splats,
                              const conic_finish *finish, conic_image *image, conic_render_statistics *statistics) {
  conic_opencl *opencl = (conic_opencl *)backend;
  conic_frame f = {.opencl = opencl, .view = view, .splats = splats, .image = image};
  memset(opencl->queue.ms, 0, sizeof opencl->queue.ms);
  set_finish(finish, &f.constants);
  size_t part = part_of(&f);
  conic_status status = conic_frame_begin(&f);
  if (status == CONIC_OK && !f.constants.is_single_pass)
    status = walk_parts(&f, WALK_VISIBILITY, &part);
  if (status == CONIC_OK && (f.constants.is_single_pass || f.n < splats->count))
    status = walk_parts(&f, WALK_ACCUMULATE, &part);
  conic_status ended = conic_frame_end(&f, &statistics->pixels_covered);
  status = status == CONIC_OK ? ended : status;
  if (status != CONIC_OK)
    return status;
  report(&f, statistics);
  return conic_progress(opencl->context, "render", 1.0);
}
