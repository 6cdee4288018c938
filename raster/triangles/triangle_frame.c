#include "raster/triangles/triangle_frame.h"

#include "core/base/base.h"
#include "raster/tiles/bins_tiles.h"
#include "raster/triangles/triangle_loops.h"

/* Vertices that a task projects, and triangles that one sets up, unless their tables would be too many. */
enum { VERTICES_TOGETHER = 8192, TRIANGLES_TOGETHER = 8192 };

typedef struct preparation {
  conic_triangle_frame *frame;
  const conic_triangle_loops *loops;
} preparation;

void conic_triangle_frame_begin(conic_triangle_frame *frame, conic_context *context, const conic_triangles *triangles,
                                const conic_view *view, const conic_camera *camera) {
  frame->context = context;
  frame->triangles = triangles;
  frame->view = view;
  frame->epsilon = view->epsilon_cap;
  for (int i = 0; i < 3; i++) {
    const double *row = camera->cam_from_world[i];
    frame->translation[i] =
        ((row[0] * triangles->origin[0] + row[1] * triangles->origin[1]) + row[2] * triangles->origin[2]) + row[3];
  }
}

void conic_triangle_frame_tiles(conic_triangle_frame *frame, int tile) {
  frame->tile = tile;
  frame->tile_bits = __builtin_ctz((unsigned)tile);
  frame->n_tiles_x = (frame->view->width + tile - 1) / tile;
  frame->n_tiles = (size_t)frame->n_tiles_x * (size_t)((frame->view->height + tile - 1) / tile);
}

static conic_status plan(conic_triangle_frame *frame) {
  conic_context *context = frame->context;
  conic_kept_memory *memory = frame->memory;
  size_t n = frame->triangles->count, n_threads = (size_t)conic_context_threads(context);
  size_t size = TRIANGLES_TOGETHER;
  while ((n / size + 1) * frame->n_tiles > ((size_t)1 << 22) && size < n)
    size *= 2;
  frame->chunk_size = size;
  frame->n_chunks = (n + size - 1) / size;
  size_t most = CONIC_TRIANGLE_PIECES_MOST * (size < n ? size : n) + 1;
  frame->sorter_bytes = conic_memory_rounded(most * sizeof(conic_triangle_record)) +
                        conic_memory_rounded(most * sizeof(conic_triangle_piece)) +
                        conic_memory_rounded(frame->n_tiles * sizeof(uint32_t));
  frame->vertices =
      conic_keep_room(context, &memory[CONIC_TRIANGLE_VERTICES], frame->triangles->n_vertices, sizeof *frame->vertices);
  frame->chunks = conic_keep_room(context, &memory[CONIC_TRIANGLE_CHUNKS], frame->n_chunks, sizeof *frame->chunks);
  frame->tile_begin = conic_keep_room(context, &memory[CONIC_TRIANGLE_TABLES], frame->n_chunks * (frame->n_tiles + 1),
                                      sizeof *frame->tile_begin);
  frame->sorters = conic_keep_room(context, &memory[CONIC_TRIANGLE_SORTERS], n_threads, frame->sorter_bytes);
  frame->tiles = conic_keep_room(context, &memory[CONIC_TRIANGLE_TILES], n_threads, sizeof *frame->tiles);
  return frame->vertices && frame->chunks && frame->tile_begin && frame->sorters && frame->tiles ? CONIC_OK
                                                                                                 : CONIC_ERROR_MEMORY;
}

/* Room for so many records, pieces and entries. */
static conic_status plan_results(conic_triangle_frame *frame, size_t n_records, size_t n_pieces, size_t n_entries) {
  conic_context *context = frame->context;
  conic_kept_memory *memory = frame->memory;
  frame->records = conic_keep_room(context, &memory[CONIC_TRIANGLE_RECORDS], n_records, sizeof *frame->records);
  frame->pieces = conic_keep_room(context, &memory[CONIC_TRIANGLE_PIECES], n_pieces, sizeof *frame->pieces);
  frame->entries = conic_keep_room(context, &memory[CONIC_TRIANGLE_ENTRIES], n_entries, sizeof *frame->entries);
  frame->n_record_room = memory[CONIC_TRIANGLE_RECORDS].bytes / sizeof *frame->records;
  frame->n_piece_room = memory[CONIC_TRIANGLE_PIECES].bytes / sizeof *frame->pieces;
  frame->n_entry_room = memory[CONIC_TRIANGLE_ENTRIES].bytes / sizeof *frame->entries;
  return frame->records && frame->pieces && frame->entries ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static void vertices_task(void *data, size_t i_item) {
  preparation *p = data;
  size_t n = p->frame->triangles->n_vertices, begin = i_item * VERTICES_TOGETHER, end = begin + VERTICES_TOGETHER;
  p->loops->vertices(p->frame, begin, end < n ? end : n, p->frame->vertices);
}

/* Turns the counts in `next` into places. Returns how many entries there are; no more than fit into 32 bits have a
 * place.
 */
static size_t place_records(const conic_triangle_frame *frame, uint32_t *next, uint32_t *tile_begin) {
  size_t n = 0;
  for (size_t i = 0; i < frame->n_tiles; i++) {
    uint32_t count = next[i];
    next[i] = tile_begin[i] = (uint32_t)n;
    n += count;
  }
  tile_begin[frame->n_tiles] = (uint32_t)n;
  return n;
}

static size_t count_entries(const conic_triangle_frame *frame, const conic_triangle_sorter *sorter,
                            uint32_t *tile_begin) {
  memset(sorter->next, 0, frame->n_tiles * sizeof *sorter->next);
  for (size_t i = 0; i < sorter->n_records; i++) {
    conic_tile_range range = conic_tiles_of(frame->tile_bits, &sorter->records[i].box);
    for (int y = range.y_begin; y < range.y_end; y++)
      for (int x = range.x_begin; x < range.x_end; x++)
        sorter->next[y * frame->n_tiles_x + x]++;
  }
  return place_records(frame, sorter->next, tile_begin);
}

static void enter(const conic_triangle_frame *frame, const conic_triangle_sorter *sorter, uint32_t *entries) {
  for (size_t i = 0; i < sorter->n_records; i++) {
    conic_tile_range range = conic_tiles_of(frame->tile_bits, &sorter->records[i].box);
    for (int y = range.y_begin; y < range.y_end; y++)
      for (int x = range.x_begin; x < range.x_end; x++)
        entries[sorter->next[y * frame->n_tiles_x + x]++] = (uint32_t)i;
  }
}

/* Copies what a thread has made of a chunk to its place in the frame, if there is room for it. */
static void hand_over_records(conic_triangle_frame *frame, conic_triangle_sorter *sorter, size_t i_chunk) {
  conic_triangle_chunk *chunk = &frame->chunks[i_chunk];
  size_t n_records = sorter->n_records, n_pieces = sorter->n_pieces;
  size_t n_entries = count_entries(frame, sorter, frame->tile_begin + i_chunk * (frame->n_tiles + 1));
  chunk->first_record = atomic_fetch_add(&frame->n_records, n_records);
  chunk->first_piece = atomic_fetch_add(&frame->n_pieces, n_pieces);
  chunk->first_entry = atomic_fetch_add(&frame->n_entries, n_entries);
  if (n_entries > UINT32_MAX)
    atomic_store(&frame->is_uncountable, 1);
  if (n_entries > UINT32_MAX || chunk->first_record + n_records > frame->n_record_room ||
      chunk->first_piece + n_pieces > frame->n_piece_room || chunk->first_entry + n_entries > frame->n_entry_room)
    return;
  for (size_t i = 0; i < n_records && n_pieces; i++)
    if (sorter->records[i].piece != CONIC_NO_PIECE)
      sorter->records[i].piece += (uint32_t)chunk->first_piece;
  memcpy(frame->records + chunk->first_record, sorter->records, n_records * sizeof *frame->records);
  memcpy(frame->pieces + chunk->first_piece, sorter->pieces, n_pieces * sizeof *frame->pieces);
  enter(frame, sorter, frame->entries + chunk->first_entry);
}

static void triangles_task(void *data, size_t i_chunk, int i_thread) {
  conic_triangle_frame *frame = ((preparation *)data)->frame;
  conic_triangle_sorter sorter;
  char *memory = frame->sorters + (size_t)i_thread * frame->sorter_bytes;
  size_t n = frame->triangles->count, begin = i_chunk * frame->chunk_size, end = begin + frame->chunk_size;
  size_t most = CONIC_TRIANGLE_PIECES_MOST * (frame->chunk_size < n ? frame->chunk_size : n) + 1;
  sorter.records = (conic_triangle_record *)(void *)memory;
  memory += conic_memory_rounded(most * sizeof *sorter.records);
  sorter.pieces = (conic_triangle_piece *)(void *)memory;
  sorter.next = (uint32_t *)(void *)(memory + conic_memory_rounded(most * sizeof *sorter.pieces));
  conic_triangle_set_up(frame, begin, end < n ? end : n, &sorter, &frame->chunks[i_chunk]);
  hand_over_records(frame, &sorter, i_chunk);
}

conic_status conic_triangle_frame_prepare(conic_triangle_frame *frame, const conic_triangle_loops *loops) {
  preparation p = {frame, loops};
  size_t n = frame->triangles->count, n_vertices = frame->triangles->n_vertices;
  conic_status status = plan(frame);
  if (status == CONIC_OK)
    status = plan_results(frame, n / 4 + 1024, 64, n / 4 + frame->n_tiles + 1024);
  if (status != CONIC_OK)
    return status;
  conic_parallel_for(frame->context, (n_vertices + VERTICES_TOGETHER - 1) / VERTICES_TOGETHER, vertices_task, &p);
  for (;;) {
    atomic_store(&frame->n_records, 0);
    atomic_store(&frame->n_pieces, 0);
    atomic_store(&frame->n_entries, 0);
    atomic_store(&frame->is_uncountable, 0);
    conic_parallel_for(frame->context, frame->n_chunks, triangles_task, &p);
    size_t n_records = atomic_load(&frame->n_records), n_pieces = atomic_load(&frame->n_pieces);
    size_t n_entries = atomic_load(&frame->n_entries);
    if (n_records > UINT32_MAX || n_pieces >= CONIC_NO_PIECE || atomic_load(&frame->is_uncountable))
      return conic_fail(frame->context, CONIC_ERROR_MEMORY, "too many triangles in so many tiles");
    if (n_records <= frame->n_record_room && n_pieces <= frame->n_piece_room && n_entries <= frame->n_entry_room)
      return CONIC_OK;
    status = plan_results(frame, n_records, n_pieces, n_entries);
    if (status != CONIC_OK)
      return status;
  }
}

void conic_triangle_frame_release(conic_context *context, conic_triangle_frame *frame) {
  for (int i = 0; i < CONIC_TRIANGLE_N_MEMORIES; i++)
    conic_memory_release(context, frame->memory[i].pointer);
  memset(frame->memory, 0, sizeof frame->memory);
}

void conic_triangle_frame_count(const conic_triangle_frame *frame, conic_render_statistics *statistics) {
  statistics->triangles_in = frame->triangles->count;
  for (size_t i = 0; i < frame->n_chunks; i++) {
    statistics->triangles_culled += frame->chunks[i].n_culled;
    statistics->triangles_skipped += frame->chunks[i].n_skipped;
    statistics->triangles_drawn += frame->chunks[i].n_drawn;
  }
}

int conic_triangle_frame_meets(const conic_triangle_frame *frame, size_t i_tile) {
  int has_any = 0;
  for (size_t i = 0; i < frame->n_chunks; i++) {
    const uint32_t *begin = frame->tile_begin + i * (frame->n_tiles + 1) + i_tile;
    has_any |= begin[0] < begin[1];
  }
  return has_any;
}
