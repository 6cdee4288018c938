/* Gaussians, whose lists the host has made, composited on the device: some tiles at a time. */

#include "core/base/base.h"
#include "opencl/frame.h"
#include "opencl/gaussian_layout.h"

/* Tiles have so many entries at a time, or are one: the device is not held up for long, and work can be given up. */
#define MOST_ENTRIES ((uint64_t)1 << 20)

enum { N_PLANES = 9 };

typedef struct gaussian_frame {
  conic_frame frame; /* for the stages' common functions, which look at its device alone */
  const conic_gaussian_composition *composition;
  conic_device_gaussians picture;
  void *planes[N_PLANES];
  size_t plane_bytes[N_PLANES];
  size_t n_tiles, room_bytes; /* for an entry */
} gaussian_frame;

static size_t entries_before(const gaussian_frame *g, size_t i_tile) {
  return g->composition->bins->tile_begin[i_tile];
}

static void list_planes(gaussian_frame *g) {
  const conic_gaussian_target *t = &g->composition->target;
  void *const planes[N_PLANES] = {t->rgb,    t->transparency, t->z,  t->median_z, t->inverse_z,
                                  t->normal, t->count,        t->id, t->last};
  for (int i = 0; i < N_PLANES; i++) {
    size_t n_channels = i == 0 || i == 5 ? 3 : 1;
    g->planes[i] = planes[i];
    g->plane_bytes[i] = (size_t)t->width * (size_t)t->height * n_channels * sizeof(float);
  }
}

/* The memory that a CPU's device does not have already. */
static conic_status check_gaussian_memory(const gaussian_frame *g, size_t most_entries) {
  const conic_opencl_device *device = &g->frame.opencl->device;
  const conic_gaussian_composition *c = g->composition;
  const double n = device->is_cpu ? 0.0 : (double)c->n;
  const double buffers[] = {n * (double)sizeof *c->footprints, c->rays ? n * (double)sizeof *c->rays : 0.0,
                            c->normals ? n * (double)sizeof *c->normals : 0.0,
                            device->is_cpu ? 0.0 : (double)most_entries * (double)sizeof(uint32_t),
                            (double)most_entries * (double)g->room_bytes};
  double sum = 0.0, greatest = 0.0;
  for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) {
    sum += buffers[i];
    greatest = buffers[i] > greatest ? buffers[i] : greatest;
  }
  for (int i = 0; i < N_PLANES && !device->is_cpu; i++)
    sum += g->planes[i] ? (double)g->plane_bytes[i] : 0.0;
  if (sum <= CONIC_SHARE_OF_MEMORY * (double)device->memory_bytes && greatest <= (double)device->greatest_buffer_bytes)
    return CONIC_OK;
  return conic_fail(g->frame.opencl->context, CONIC_ERROR_MEMORY,
                    "opencl:%d.%d: %zu Gaussians of this picture need %.1f MiB, %.1f in one piece; the device has %.1f "
                    "and %.1f",
                    device->i_platform, device->i_device, c->n_drawn, sum / 1048576.0, greatest / 1048576.0,
                    (double)device->memory_bytes / 1048576.0, (double)device->greatest_buffer_bytes / 1048576.0);
}

/* The tiles from `first` on that are drawn at a time: as many as have no more entries than are allowed, at least one.
 */
static size_t end_of_band(const gaussian_frame *g, size_t first, size_t most_entries) {
  size_t end = first + 1;
  while (end < g->n_tiles && entries_before(g, end + 1) - entries_before(g, first) <= most_entries)
    end++;
  return end;
}

/* So many entries are drawn at a time, whose room takes an eighth of the memory at most; but no fewer than the longest
 * list has. */
static size_t most_entries_of(const gaussian_frame *g) {
  const conic_opencl *opencl = g->frame.opencl;
  uint64_t most = opencl->part_splats ? opencl->part_splats : MOST_ENTRIES;
  if (g->room_bytes && opencl->device.memory_bytes / 8 / g->room_bytes < most)
    most = opencl->device.memory_bytes / 8 / g->room_bytes;
  for (size_t i = 0; i < g->n_tiles; i++) {
    uint64_t n = entries_before(g, i + 1) - entries_before(g, i);
    most = n > most ? n : most;
  }
  uint64_t all = entries_before(g, g->n_tiles);
  return (size_t)(most < all ? most : all);
}

/* What all bands share. */
static conic_status begin_gaussian_picture(gaussian_frame *g, size_t most_entries) {
  const conic_gaussian_composition *c = g->composition;
  const conic_frame *f = &g->frame;
  conic_status status =
      conic_frame_give(f, CONIC_BUFFER_GAUSSIAN_FOOTPRINTS, c->footprints, c->n * sizeof *c->footprints);
  if (status == CONIC_OK)
    status = conic_frame_give(f, CONIC_BUFFER_GAUSSIAN_RAYS, c->rays, c->rays ? c->n * sizeof *c->rays : 0);
  if (status == CONIC_OK)
    status = conic_frame_give(f, CONIC_BUFFER_GAUSSIAN_NORMALS, c->normals, c->normals ? c->n * sizeof *c->normals : 0);
  if (status == CONIC_OK)
    status =
        conic_frame_copy(f, CONIC_BUFFER_GAUSSIAN_TILE_BEGIN, c->bins->tile_begin, (g->n_tiles + 1) * sizeof(uint64_t));
  if (status == CONIC_OK)
    status = conic_frame_room(f, CONIC_BUFFER_GAUSSIAN_PICTURE, 1, sizeof g->picture);
  if (status == CONIC_OK && g->room_bytes)
    status = conic_frame_room(f, CONIC_BUFFER_GAUSSIAN_ROOM, most_entries, g->room_bytes);
  for (int i = 0; i < N_PLANES && status == CONIC_OK; i++)
    status = conic_frame_open_plane(f, CONIC_BUFFER_GAUSSIAN_PLANES + i, g->planes[i], g->plane_bytes[i]);
  return status;
}

static conic_status draw_gaussian_band(gaussian_frame *g, size_t first, size_t end) {
  enum { N_ARGUMENTS = CONIC_N_BUFFER_NAMES - CONIC_BUFFER_GAUSSIAN_PICTURE };
  conic_opencl *opencl = g->frame.opencl;
  const int by_pixels = opencl->work == CONIC_OPENCL_WORK_PIXELS;
  const size_t group[2] = {by_pixels ? CONIC_GAUSSIAN_TILE_PIXELS : 1, 1}, items[2] = {(end - first) * group[0], 1};
  const size_t begin = entries_before(g, first);
  conic_argument arguments[N_ARGUMENTS];
  g->picture.first_tile = (uint32_t)first;
  g->picture.n_tiles = (uint32_t)(end - first);
  g->picture.first_entry = begin;
  conic_status status = conic_queue_write(&opencl->queue, &opencl->buffers[CONIC_BUFFER_GAUSSIAN_PICTURE], &g->picture,
                                          sizeof g->picture);
  if (status == CONIC_OK)
    status = conic_frame_give(&g->frame, CONIC_BUFFER_GAUSSIAN_ENTRIES, g->composition->bins->entries + begin,
                              (entries_before(g, end) - begin) * sizeof(uint32_t));
  for (int i = 0; i < N_ARGUMENTS; i++)
    arguments[i] = conic_frame_argument(&g->frame, CONIC_BUFFER_GAUSSIAN_PICTURE + i);
  if (status == CONIC_OK)
    status = conic_queue_run(&opencl->queue, CONIC_STAGE_ACCUMULATE, opencl->entries[CONIC_ENTRY_GAUSSIANS], arguments,
                             N_ARGUMENTS, items, group);
  return status == CONIC_OK ? conic_queue_finish(&opencl->queue) : status;
}

static conic_status draw_gaussian_picture(gaussian_frame *g) {
  conic_context *context = g->frame.opencl->context;
  size_t most_entries = most_entries_of(g);
  conic_status status = check_gaussian_memory(g, most_entries);
  if (status == CONIC_OK)
    status = begin_gaussian_picture(g, most_entries);
  for (size_t first = 0, end; first < g->n_tiles && status == CONIC_OK; first = end) {
    end = end_of_band(g, first, most_entries);
    status = conic_progress(context, "composite", 0.5 + 0.5 * (double)first / (double)g->n_tiles);
    if (status == CONIC_OK)
      status = draw_gaussian_band(g, first, end);
  }
  for (int i = 0; i < N_PLANES && status == CONIC_OK; i++)
    status = conic_frame_close_plane(&g->frame, CONIC_BUFFER_GAUSSIAN_PLANES + i, g->planes[i], g->plane_bytes[i]);
  return status == CONIC_OK ? conic_progress(context, "composite", 1.0) : status;
}

/* Waits for all; after that the device knows nothing more of the caller's memory. */
static conic_status close_gaussian_picture(const gaussian_frame *g) {
  conic_opencl *opencl = g->frame.opencl;
  conic_status status = conic_queue_finish(&opencl->queue);
  for (int buffer = CONIC_BUFFER_GAUSSIAN_PICTURE; buffer < CONIC_N_BUFFER_NAMES && opencl->device.is_cpu; buffer++)
    conic_queue_release(&opencl->queue, &opencl->buffers[buffer]);
  return status;
}

conic_status conic_opencl_composite(conic_gaussian_device *device, const conic_gaussian_composition *c) {
  conic_opencl *opencl = (conic_opencl *)((char *)device - offsetof(conic_opencl, gaussian_device));
  gaussian_frame g = {.frame = {.opencl = opencl}, .composition = c, .n_tiles = c->bins->n_tiles};
  g.picture = (conic_device_gaussians){.rules = *c->rules,
                                       .width = c->target.width,
                                       .height = c->target.height,
                                       .n_tiles_x = (int32_t)c->bins->n_tiles_x,
                                       .wants = c->wants};
  for (int i = 0; i < 3; i++)
    g.picture.background[i] = c->target.background[i];
  if (c->rules->shape == CONIC_SHAPE_RAY)
    g.room_bytes = opencl->work == CONIC_OPENCL_WORK_PIXELS ? CONIC_PIXELS_ROOM : CONIC_TILES_ROOM;
  list_planes(&g);
  conic_status status = conic_opencl_need_gaussians(opencl);
  if (status == CONIC_OK)
    status = draw_gaussian_picture(&g);
  conic_status closed = close_gaussian_picture(&g);
  return status == CONIC_OK ? closed : status;
}
