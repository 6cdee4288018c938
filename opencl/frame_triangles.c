/* Triangles: set up on the host by plain C, drawn on the device before the splats, and added to their sums after them.
 */

#include "core/base/base.h"
#include "core/image/texture_levels.h"
#include "opencl/frame.h"
#include "raster/loops/raster_loops.h"

_Static_assert(CONIC_DEVICE_TEXTURE_LEVELS == CONIC_TEXTURE_LEVELS, "a device's texture has all levels");

/* An array of the host's that an entry reads; no bytes: absent. */
typedef struct host_array {
  int buffer;
  const void *from;
  size_t bytes;
} host_array;

enum { N_ARRAYS = CONIC_BUFFER_GAUSSIAN_PICTURE - CONIC_BUFFER_TRIANGLE_RECORDS };

static void list_columns(float *const *columns, int n_columns, size_t n, int buffer, host_array *arrays) {
  for (int i = 0; i < n_columns; i++)
    arrays[buffer - CONIC_BUFFER_TRIANGLE_RECORDS + i] = (host_array){buffer + i, columns[i], n * sizeof(float)};
}

/* What the frame and its set hold, but for materials. */
static void list_arrays(const conic_triangle_frame *t, host_array arrays[N_ARRAYS]) {
  const conic_triangles *set = t->triangles;
  size_t n_vertices = set->n_vertices, n_normals = set->normal_corners ? set->n_normals : n_vertices;
  size_t n_coordinates = set->texture_corners ? set->n_texture_coordinates : n_vertices;
  const host_array whole[] = {
      {CONIC_BUFFER_TRIANGLE_RECORDS, t->records, t->n_records * sizeof *t->records},
      {CONIC_BUFFER_TRIANGLE_PIECES, t->pieces, t->n_pieces * sizeof *t->pieces},
      {CONIC_BUFFER_TRIANGLE_ENTRIES, t->entries, t->n_entries * sizeof *t->entries},
      {CONIC_BUFFER_TRIANGLE_TILES, t->tile_begin, t->n_chunks * (t->n_tiles + 1) * sizeof *t->tile_begin},
      {CONIC_BUFFER_TRIANGLE_CORNERS, set->corners, set->count * sizeof *set->corners},
      {CONIC_BUFFER_TRIANGLE_NORMAL_CORNERS, set->normal_corners, set->count * sizeof *set->normal_corners},
      {CONIC_BUFFER_TRIANGLE_TEXTURE_CORNERS, set->texture_corners, set->count * sizeof *set->texture_corners},
      {CONIC_BUFFER_TRIANGLE_MATERIAL, set->material, set->count * sizeof *set->material}};
  for (size_t i = 0; i < sizeof whole / sizeof whole[0]; i++)
    arrays[whole[i].buffer - CONIC_BUFFER_TRIANGLE_RECORDS] = whole[i];
  list_columns(set->position, 3, n_vertices, CONIC_BUFFER_TRIANGLE_POSITIONS, arrays);
  list_columns(set->color, 3, n_vertices, CONIC_BUFFER_TRIANGLE_COLORS, arrays);
  list_columns(set->normal, 3, n_normals, CONIC_BUFFER_TRIANGLE_NORMALS, arrays);
  list_columns(set->texture_coordinate, 2, n_coordinates, CONIC_BUFFER_TRIANGLE_COORDINATES, arrays);
  for (int i = 0; i < N_ARRAYS; i++)
    arrays[i].bytes = arrays[i].from ? arrays[i].bytes : 0;
}

/* --- materials and textures: in one buffer, materials first --- */

/* Whether an earlier material has the material's texture, too: which. */
static size_t first_with_texture(const conic_triangles *set, size_t i_material) {
  size_t i = 0;
  while (set->materials[i].texture != set->materials[i_material].texture)
    i++;
  return i;
}

static size_t texture_bytes(const conic_texture *texture) {
  size_t bytes = sizeof(conic_device_texture);
  for (int i = 0; i < texture->n_levels; i++)
    bytes += (size_t)texture->levels[i].width * (size_t)texture->levels[i].height * 4 * sizeof(float);
  return bytes;
}

static size_t materials_bytes(const conic_triangles *set) {
  size_t bytes = set->n_materials * sizeof(conic_device_material);
  for (size_t i = 0; i < set->n_materials; i++)
    if (set->materials[i].texture && first_with_texture(set, i) == i)
      bytes += texture_bytes(set->materials[i].texture);
  return bytes;
}

/* Writes a texture at that byte of the materials' buffer. */
static conic_status write_texture(const conic_frame *f, const conic_texture *texture, size_t at) {
  conic_queue *queue = &f->opencl->queue;
  const conic_buffer *buffer = &f->opencl->buffers[CONIC_BUFFER_TRIANGLE_MATERIALS];
  conic_device_texture head = {.wrap = (int32_t)texture->wrap, .n_levels = texture->n_levels};
  size_t of_level = sizeof head;
  conic_status status = CONIC_OK;
  for (int i = 0; i < texture->n_levels && status == CONIC_OK; i++) {
    const conic_texture_level *level = &texture->levels[i];
    size_t bytes = (size_t)level->width * (size_t)level->height * 4 * sizeof(float);
    head.levels[i].width = level->width;
    head.levels[i].height = level->height;
    head.levels[i].texels = of_level - (size_t)((char *)&head.levels[i] - (char *)&head);
    status = conic_queue_write_at(queue, buffer, at + of_level, level->texels, bytes);
    of_level += bytes;
  }
  return status == CONIC_OK ? conic_queue_write_at(queue, buffer, at, &head, sizeof head) : status;
}

/* Fills materials, whose textures go to the device. */
static conic_status place_materials(const conic_frame *f, conic_device_material *materials) {
  const conic_triangles *set = f->triangles->triangles;
  size_t end = set->n_materials * sizeof *materials;
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < set->n_materials && status == CONIC_OK; i++) {
    const conic_material *from = &set->materials[i];
    size_t place = end, at = i * sizeof *materials, first = first_with_texture(set, i);
    materials[i] = (conic_device_material){{from->color[0], from->color[1], from->color[2]}, from->texture != NULL, 0};
    if (!from->texture)
      continue;
    if (first < i)
      place = first * sizeof *materials + materials[first].texture;
    else {
      status = write_texture(f, from->texture, place);
      end += texture_bytes(from->texture);
    }
    materials[i].texture = place - at;
  }
  return status;
}

static conic_status write_materials(const conic_frame *f) {
  const conic_triangles *set = f->triangles->triangles;
  conic_context *context = f->opencl->context;
  conic_device_material *materials;
  conic_status status = conic_frame_room(f, CONIC_BUFFER_TRIANGLE_MATERIALS, 1, materials_bytes(set));
  if (status != CONIC_OK || !set->n_materials)
    return status;
  materials = conic_memory_allocate(context, set->n_materials, sizeof *materials);
  if (!materials)
    return CONIC_ERROR_MEMORY;
  status = place_materials(f, materials);
  if (status == CONIC_OK)
    status = conic_queue_write(&f->opencl->queue, &f->opencl->buffers[CONIC_BUFFER_TRIANGLE_MATERIALS], materials,
                               set->n_materials * sizeof *materials);
  conic_memory_release(context, materials);
  return status;
}

/* --- the frame's --- */

static conic_status write_chunks(const conic_frame *f) {
  const conic_triangle_frame *t = f->triangles;
  conic_device_triangle_chunk *chunks = conic_memory_allocate(f->opencl->context, t->n_chunks, sizeof *chunks);
  if (!chunks)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < t->n_chunks; i++)
    chunks[i] = (conic_device_triangle_chunk){t->chunks[i].first_record, t->chunks[i].first_entry};
  conic_status status = conic_frame_copy(f, CONIC_BUFFER_TRIANGLE_CHUNKS, chunks, t->n_chunks * sizeof *chunks);
  conic_memory_release(f->opencl->context, chunks);
  return status;
}

/* Notes how much of the device's memory the triangles take; all of them have to be there at once. */
static conic_status measure_arrays(conic_frame *f, const host_array arrays[N_ARRAYS]) {
  const conic_opencl_device *device = &f->opencl->device;
  double greatest = (double)materials_bytes(f->triangles->triangles), sum = greatest;
  for (int i = 0; i < N_ARRAYS; i++) {
    greatest = (double)arrays[i].bytes > greatest ? (double)arrays[i].bytes : greatest;
    sum += (double)arrays[i].bytes;
  }
  f->triangle_bytes = sum;
  if (greatest > (double)device->greatest_buffer_bytes || sum > CONIC_SHARE_OF_MEMORY * (double)device->memory_bytes)
    return conic_fail(f->opencl->context, CONIC_ERROR_MEMORY,
                      "opencl: the device cannot hold the triangles: they take %.1f MiB", sum / 1048576.0);
  return CONIC_OK;
}

static void set_constants(conic_frame *f) {
  const conic_triangle_frame *t = f->triangles;
  f->constants.has_triangles = 1;
  f->constants.has_splats = f->splats->count > 0;
  f->constants.keeps_sums = 1;
  f->constants.n_triangle_chunks = (uint32_t)t->n_chunks;
  f->constants.n_materials = (uint32_t)t->triangles->n_materials;
  f->constants.first_triangle_id = t->first_id;
  f->constants.triangle_epsilon = f->is_hiding ? 0.0f : t->epsilon;
}

conic_status conic_frame_set_up_triangles(conic_frame *f, conic_isa isa) {
  host_array arrays[N_ARRAYS];
  conic_raster_loops loops;
  conic_status status = conic_opencl_need_triangles(f->opencl);
  if (status == CONIC_OK)
    status = conic_isa_choose(f->opencl->context, isa, &isa);
  if (status != CONIC_OK)
    return status;
  conic_raster_loops_init(&loops, isa);
  double start = conic_seconds_now();
  conic_triangle_frame_tiles(f->triangles, f->opencl->tile);
  status = conic_triangle_frame_prepare(f->triangles, &loops.triangles);
  if (status != CONIC_OK)
    return status;
  list_arrays(f->triangles, arrays);
  f->opencl->queue.ms[CONIC_STAGE_SETUP] += 1e3 * (conic_seconds_now() - start);
  return measure_arrays(f, arrays);
}

static conic_status give_all(const conic_frame *f) {
  host_array arrays[N_ARRAYS];
  conic_status status = write_chunks(f);
  list_arrays(f->triangles, arrays);
  for (int i = 0; i < N_ARRAYS && status == CONIC_OK; i++)
    status = conic_frame_give(f, arrays[i].buffer, arrays[i].from, arrays[i].bytes);
  return status == CONIC_OK ? write_materials(f) : status;
}

static conic_status make_room_on_device(const conic_frame *f) {
  size_t tile_pixels = (size_t)f->opencl->tile * (size_t)f->opencl->tile;
  conic_status status = conic_frame_room(f, CONIC_BUFFER_TRIANGLE_IZ, f->n_tiles, tile_pixels * sizeof(float));
  if (status == CONIC_OK)
    status = conic_frame_room(f, CONIC_BUFFER_TRIANGLE_NEAREST, f->n_tiles, tile_pixels * sizeof(uint32_t));
  if (status == CONIC_OK)
    status = conic_frame_room(f, CONIC_BUFFER_TRIANGLE_FRAGMENTS, f->n_tiles, 2 * sizeof(uint32_t));
  if (status == CONIC_OK)
    status = conic_queue_fill_zero(&f->opencl->queue, &f->opencl->buffers[CONIC_BUFFER_TRIANGLE_FRAGMENTS],
                                   (size_t)f->n_tiles * 2 * sizeof(uint32_t));
  return status;
}

static int take_arguments(const conic_frame *f, const int *buffers, int n, conic_argument *to) {
  for (int i = 0; i < n; i++)
    to[i] = conic_frame_argument(f, buffers[i]);
  return n;
}

conic_status conic_frame_draw_triangles(conic_frame *f) {
  static const int buffers[] = {CONIC_BUFFER_FRAME,
                                CONIC_BUFFER_TRIANGLE_RECORDS,
                                CONIC_BUFFER_TRIANGLE_CHUNKS,
                                CONIC_BUFFER_TRIANGLE_TILES,
                                CONIC_BUFFER_TRIANGLE_ENTRIES,
                                CONIC_BUFFER_DIRECTIONS_X,
                                CONIC_BUFFER_DIRECTIONS_Y,
                                CONIC_BUFFER_THRESHOLDS,
                                CONIC_BUFFER_TRIANGLE_IZ,
                                CONIC_BUFFER_TRIANGLE_NEAREST,
                                CONIC_BUFFER_TRIANGLE_FRAGMENTS};
  enum { N = sizeof buffers / sizeof buffers[0] };
  conic_argument arguments[N];
  set_constants(f);
  conic_status status = give_all(f);
  if (status == CONIC_OK)
    status = make_room_on_device(f);
  if (status == CONIC_OK)
    status = conic_frame_write_constants(f);
  take_arguments(f, buffers, N, arguments);
  return status == CONIC_OK ? conic_frame_run_raster(f, CONIC_STAGE_VISIBILITY, CONIC_ENTRY_TRIANGLES, arguments, N)
                            : status;
}

conic_status conic_frame_add_triangles(conic_frame *f) {
  static const int before[] = {CONIC_BUFFER_VIEW, CONIC_BUFFER_FRAME, CONIC_BUFFER_TRIANGLE_RECORDS};
  static const int after[] = {CONIC_BUFFER_TRIANGLE_MATERIALS, CONIC_BUFFER_TRIANGLE_IZ, CONIC_BUFFER_TRIANGLE_NEAREST,
                              CONIC_BUFFER_THRESHOLDS, CONIC_BUFFER_SUMS};
  conic_argument arguments[N_ARRAYS + 3 + 5 + CONIC_FRAME_PLANE_ARGUMENTS];
  int n = take_arguments(f, before, sizeof before / sizeof before[0], arguments);
  for (int buffer = CONIC_BUFFER_TRIANGLE_PIECES; buffer < CONIC_BUFFER_GAUSSIAN_PICTURE; buffer++)
    arguments[n++] = conic_frame_argument(f, buffer);
  n += take_arguments(f, after, sizeof after / sizeof after[0], arguments + n);
  n += conic_frame_planes(f, arguments + n);
  conic_status status = conic_frame_clear_tiles(f, CONIC_BUFFER_N_COVERED);
  return status == CONIC_OK ? conic_frame_run_raster(f, CONIC_STAGE_ACCUMULATE, CONIC_ENTRY_ADD_TRIANGLES, arguments, n)
                            : status;
}

conic_status conic_frame_count_triangles(const conic_frame *f, conic_render_statistics *statistics) {
  conic_context *context = f->opencl->context;
  uint32_t(*counts)[2] = conic_memory_allocate(context, f->n_tiles, sizeof *counts);
  if (!counts)
    return CONIC_ERROR_MEMORY;
  conic_status status = conic_queue_read(&f->opencl->queue, &f->opencl->buffers[CONIC_BUFFER_TRIANGLE_FRAGMENTS], 0,
                                         counts, f->n_tiles * sizeof *counts);
  for (uint32_t i = 0; i < f->n_tiles && status == CONIC_OK; i++)
    statistics->triangle_fragments += counts[i][0] | (uint64_t)counts[i][1] << 32;
  conic_memory_release(context, counts);
  conic_triangle_frame_count(f->triangles, statistics);
  return status;
}
