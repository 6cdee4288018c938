/* From records to pixels: the tiles' lists, and the passes over them. */
#include "opencl/frame.h"

enum { ARGUMENTS_OF_RECORDS = 9 };

/* Chunks that are counted and filled at the same time: enough of them for all units, few enough for their counts. */
static uint32_t chunks_of(const conic_frame *f) {
  size_t units = (size_t)f->opencl->device.n_compute_units;
  size_t most = (f->opencl->device.is_cpu ? 8 : 128) * units, n_chunks = f->n_drawn / 64 + 1;
  n_chunks = n_chunks < most ? n_chunks : most;
  while (n_chunks > 1 && n_chunks * f->n_tiles > (size_t)1 << 25)
    n_chunks /= 2;
  return (uint32_t)n_chunks;
}

static int fits_device(const conic_frame *f, uint64_t n_references) {
  const conic_opencl_device *device = &f->opencl->device;
  double bytes = (double)n_references * (double)sizeof(conic_device_reference); /* and those selected */
  return bytes <= (double)device->greatest_buffer_bytes && 2.0 * bytes <= 0.25 * (double)device->memory_bytes;
}

conic_status conic_frame_bin(conic_frame *f, int *fits) {
  uint32_t n_chunks = chunks_of(f), n_tiles_x = (uint32_t)f->constants.n_tiles_x;
  uint32_t chunk_size = (f->n_drawn + n_chunks - 1) / n_chunks;
  f->n_references = 0;
  *fits = 1;
  if (f->n_drawn == 0)
    return conic_queue_fill_zero(&f->opencl->queue, &f->opencl->buffers[CONIC_BUFFER_TILE_BEGIN],
                                 (f->n_tiles + (size_t)1) * sizeof(uint64_t));
  conic_status status = conic_frame_room(f, CONIC_BUFFER_TILE_COUNTS, (size_t)n_chunks * f->n_tiles, sizeof(uint32_t));
  conic_argument arguments[10] = {CONIC_ARGUMENT(n_chunks),
                                  CONIC_ARGUMENT(f->n_tiles),
                                  CONIC_ARGUMENT(n_tiles_x),
                                  CONIC_ARGUMENT(f->n_drawn),
                                  CONIC_ARGUMENT(chunk_size),
                                  conic_frame_argument(f, CONIC_BUFFER_ORDER),
                                  conic_frame_argument(f, CONIC_BUFFER_BOXES),
                                  conic_frame_argument(f, CONIC_BUFFER_TILE_COUNTS),
                                  conic_frame_argument(f, CONIC_BUFFER_TILE_BEGIN),
                                  conic_frame_argument(f, CONIC_BUFFER_REFERENCES)};
  const conic_argument of_places[] = {CONIC_ARGUMENT(f->n_tiles), CONIC_ARGUMENT(n_chunks),
                                      conic_frame_argument(f, CONIC_BUFFER_TILE_COUNTS),
                                      conic_frame_argument(f, CONIC_BUFFER_TILE_TOTALS)};
  if (status == CONIC_OK)
    status = conic_frame_run(f, CONIC_STAGE_BIN, CONIC_ENTRY_COUNT_TILES, arguments, 8, n_chunks);
  if (status == CONIC_OK)
    status = conic_frame_run(f, CONIC_STAGE_BIN, CONIC_ENTRY_PLACE_CHUNKS, of_places, 4, f->n_tiles);
  if (status == CONIC_OK)
    status = conic_frame_scan(f, CONIC_STAGE_BIN, f->n_tiles, CONIC_BUFFER_TILE_TOTALS, CONIC_BUFFER_TILE_BEGIN,
                              &f->n_references);
  if (status != CONIC_OK)
    return status;
  *fits = fits_device(f, f->n_references);
  if (!*fits)
    return CONIC_OK;
  status = conic_frame_room(f, CONIC_BUFFER_REFERENCES, f->n_references, sizeof(conic_device_reference));
  if (status == CONIC_OK && f->opencl->work == CONIC_OPENCL_WORK_TILES)
    status = conic_frame_room(f, CONIC_BUFFER_SELECTED, f->n_references, sizeof(conic_device_reference));
  return status == CONIC_OK ? conic_frame_run(f, CONIC_STAGE_BIN, CONIC_ENTRY_FILL_TILES, arguments, 10, n_chunks)
                            : status;
}

/* What every entry of the raster reads. */
static int records(const conic_frame *f, conic_argument *to) {
  const int buffers[ARGUMENTS_OF_RECORDS] = {
      CONIC_BUFFER_VIEW,       CONIC_BUFFER_FRAME,        CONIC_BUFFER_TILE_BEGIN,
      CONIC_BUFFER_REFERENCES, CONIC_BUFFER_FOOTPRINTS,   CONIC_BUFFER_SURFACES,
      CONIC_BUFFER_RAYS,       CONIC_BUFFER_CLIP_RECORDS, CONIC_BUFFER_PROFILE};
  for (int i = 0; i < ARGUMENTS_OF_RECORDS; i++)
    to[i] = conic_frame_argument(f, buffers[i]);
  return ARGUMENTS_OF_RECORDS;
}

int conic_frame_planes(const conic_frame *f, conic_argument *to) {
  to[0] = conic_frame_argument(f, CONIC_BUFFER_DIRECTIONS_X);
  to[1] = conic_frame_argument(f, CONIC_BUFFER_DIRECTIONS_Y);
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++)
    to[2 + plane] = conic_frame_argument(f, CONIC_BUFFER_PLANES + plane);
  to[2 + CONIC_N_DRAWN_PLANES] = conic_frame_argument(f, CONIC_BUFFER_N_COVERED);
  return CONIC_FRAME_PLANE_ARGUMENTS;
}

/* A tile or a pixel a work-item. */
conic_status conic_frame_run_raster(const conic_frame *f, conic_stage stage, conic_entry_name entry,
                                    const conic_argument *arguments, int n_arguments) {
  if (f->opencl->work == CONIC_OPENCL_WORK_TILES)
    return conic_queue_run(&f->opencl->queue, stage, f->opencl->entries[entry], arguments, n_arguments,
                           (const size_t[2]){f->n_tiles, 1}, (const size_t[2]){1, 1});
  const size_t items[2] = {(size_t)(f->constants.n_tiles_x * f->opencl->tile),
                           (size_t)(f->constants.n_tiles_y * f->opencl->tile)};
  return conic_queue_run(&f->opencl->queue, stage, f->opencl->entries[entry], arguments, n_arguments, items,
                         (const size_t[2]){CONIC_DEVICE_GROUP, CONIC_DEVICE_GROUP});
}

conic_status conic_frame_write_constants(conic_frame *f) {
  f->constants.is_first = f->first == 0;
  f->constants.is_last = f->first + f->n == f->splats->count;
  return conic_queue_write(&f->opencl->queue, &f->opencl->buffers[CONIC_BUFFER_FRAME], &f->constants,
                           sizeof f->constants);
}

conic_status conic_frame_clear_tiles(const conic_frame *f, int buffer) {
  return conic_queue_fill_zero(&f->opencl->queue, &f->opencl->buffers[buffer], f->n_tiles * sizeof(uint32_t));
}

/* Where sums are looked at after this. */
static conic_status make_room_for_sums(const conic_frame *f) {
  size_t tile_pixels = (size_t)f->opencl->tile * (size_t)f->opencl->tile;
  if (f->constants.is_first && f->constants.is_last && !f->constants.keeps_sums)
    return CONIC_OK;
  return conic_frame_room(f, CONIC_BUFFER_SUMS, f->n_tiles, tile_pixels * CONIC_N_SUMS * sizeof(float));
}

/* One pass, or both, a tile a work-item. */
static conic_status walk_tiles(conic_frame *f, conic_stage stage, int32_t walks) {
  conic_argument arguments[ARGUMENTS_OF_RECORDS + 4 + CONIC_FRAME_PLANE_ARGUMENTS];
  int n = records(f, arguments);
  f->constants.walks = walks;
  conic_status status = conic_frame_write_constants(f);
  if (status == CONIC_OK && walks & CONIC_WALK_ACCUMULATE)
    status = make_room_for_sums(f);
  arguments[n++] = conic_frame_argument(f, CONIC_BUFFER_THRESHOLDS);
  arguments[n++] = conic_frame_argument(f, CONIC_BUFFER_N_FRAGMENTS);
  arguments[n++] = conic_frame_argument(f, CONIC_BUFFER_SELECTED);
  arguments[n++] = conic_frame_argument(f, CONIC_BUFFER_SUMS);
  n += conic_frame_planes(f, arguments + n);
  if (status == CONIC_OK)
    status = conic_frame_run_raster(f, stage, CONIC_ENTRY_ACCUMULATE, arguments, n);
  return status == CONIC_OK && walks & CONIC_WALK_VISIBILITY
             ? conic_frame_add_tiles(f, CONIC_BUFFER_N_FRAGMENTS, &f->n_fragments)
             : status;
}

conic_status conic_frame_visibility(conic_frame *f) {
  conic_argument arguments[ARGUMENTS_OF_RECORDS + 4];
  int n = records(f, arguments);
  if (f->opencl->work == CONIC_OPENCL_WORK_TILES)
    return walk_tiles(f, CONIC_STAGE_VISIBILITY, CONIC_WALK_VISIBILITY);
  arguments[n++] = conic_frame_argument(f, CONIC_BUFFER_DIRECTIONS_X);
  arguments[n++] = conic_frame_argument(f, CONIC_BUFFER_DIRECTIONS_Y);
  arguments[n++] = conic_frame_argument(f, CONIC_BUFFER_THRESHOLDS);
  arguments[n++] = conic_frame_argument(f, CONIC_BUFFER_N_FRAGMENTS);
  conic_status status = conic_frame_write_constants(f);
  if (status == CONIC_OK)
    status = conic_frame_clear_tiles(f, CONIC_BUFFER_N_FRAGMENTS);
  if (status == CONIC_OK)
    status = conic_frame_run_raster(f, CONIC_STAGE_VISIBILITY, CONIC_ENTRY_VISIBILITY, arguments, n);
  return status == CONIC_OK ? conic_frame_add_tiles(f, CONIC_BUFFER_N_FRAGMENTS, &f->n_fragments) : status;
}

conic_status conic_frame_accumulate(conic_frame *f) {
  conic_argument arguments[ARGUMENTS_OF_RECORDS + 2 + CONIC_FRAME_PLANE_ARGUMENTS];
  int n = records(f, arguments), is_single = f->constants.is_single_pass, counts = CONIC_BUFFER_N_FRAGMENTS;
  if (f->opencl->work == CONIC_OPENCL_WORK_TILES && !is_single)
    return walk_tiles(f, CONIC_STAGE_ACCUMULATE, CONIC_WALK_ACCUMULATE);
  conic_status status = conic_frame_write_constants(f);
  if (status == CONIC_OK)
    status = make_room_for_sums(f);
  arguments[n++] = conic_frame_argument(f, is_single ? counts : CONIC_BUFFER_THRESHOLDS);
  arguments[n++] = conic_frame_argument(f, CONIC_BUFFER_SUMS);
  n += conic_frame_planes(f, arguments + n);
  if (status == CONIC_OK && is_single)
    status = conic_frame_clear_tiles(f, counts);
  if (status == CONIC_OK)
    status = conic_frame_clear_tiles(f, CONIC_BUFFER_N_COVERED);
  if (status == CONIC_OK)
    status = conic_frame_run_raster(f, CONIC_STAGE_ACCUMULATE, is_single ? CONIC_ENTRY_NEAREST : CONIC_ENTRY_ACCUMULATE,
                                    arguments, n);
  return status == CONIC_OK && is_single ? conic_frame_add_tiles(f, counts, &f->n_fragments) : status;
}

conic_status conic_frame_blend(conic_frame *f) {
  if (f->opencl->work == CONIC_OPENCL_WORK_TILES)
    return walk_tiles(f, CONIC_STAGE_ACCUMULATE, CONIC_WALK_VISIBILITY | CONIC_WALK_ACCUMULATE);
  conic_status status = conic_frame_visibility(f);
  return status == CONIC_OK ? conic_frame_accumulate(f) : status;
}
