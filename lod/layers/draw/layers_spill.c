#include "lod/layers/draw/layers_spill.h"

#define NO_BLOCK UINT64_MAX

enum { LEAST_BLOCK = 16, MOST_BLOCK = 512, HEAD_BYTES = sizeof(uint64_t) };

/* What every splat has, of the set and of the spill. */
static size_t list_columns(const conic_layers_spill *spill, conic_layers_column columns[CONIC_LAYERS_MOST_COLUMNS]) {
  const conic_layers_set *set = spill->set;
  size_t n = conic_layers_set_arrays(spill->layers), n_arrays = n;
  for (size_t i = 0; i < n_arrays; i++)
    columns[i] = (conic_layers_column){sizeof(float), set->arrays ? (char *)(set->arrays + i * set->room) : NULL};
  columns[n++] = (conic_layers_column){sizeof *set->ids, (char *)set->ids};
  columns[n++] = (conic_layers_column){sizeof *spill->boxes, (char *)spill->boxes};
  if (conic_layers_schema_find(&spill->layers->header.schema, CONIC_LAYERS_CLIP) >= 0)
    columns[n++] = (conic_layers_column){sizeof *set->lines, (char *)set->lines};
  return n;
}

size_t conic_layers_spill_bytes(const conic_layers *layers) {
  int has_lines = conic_layers_schema_find(&layers->header.schema, CONIC_LAYERS_CLIP) >= 0;
  return conic_layers_set_arrays(layers) * sizeof(float) + sizeof(uint32_t) + sizeof(conic_box) +
         (has_lines ? sizeof(conic_layers_lines) : 0);
}

static size_t spill_block_bytes(const conic_layers_spill *spill) {
  return (HEAD_BYTES + spill->block_count * spill->splat_bytes + 7) / 8 * 8;
}

static unsigned char *begin_spill_block(const conic_layers_spill *spill, size_t i_window) {
  return spill->blocks + i_window * spill_block_bytes(spill);
}

/* In the system's folder for what is large and short-lived. */
static conic_status name_file(conic_layers_spill *spill) {
  const char *const names[] = {"TMPDIR", "TEMP"};
  const char *folder = NULL;
  for (size_t i = 0; i < sizeof names / sizeof *names && !(folder && *folder); i++)
    folder = getenv(names[i]);
  folder = folder && *folder ? folder : "/var/tmp";
  size_t room = strlen(folder) + sizeof "/clouds";
  spill->path = conic_memory_allocate(spill->layers->context, room, 1);
  if (spill->path)
    snprintf(spill->path, room, "%s/clouds", folder);
  return spill->path ? CONIC_OK : CONIC_ERROR_MEMORY;
}

conic_status conic_layers_spill_begin(size_t block_count, conic_layers_spill *spill) {
  conic_context *context = spill->layers->context;
  size_t n_windows = spill->windows->n_windows;
  spill->block_count = block_count < LEAST_BLOCK ? LEAST_BLOCK : block_count > MOST_BLOCK ? MOST_BLOCK : block_count;
  spill->splat_bytes = conic_layers_spill_bytes(spill->layers);
  conic_status status = conic_memory_allocate_these(context, CONIC_ZEROED(spill->heaps, n_windows),
                                                    CONIC_ROOM(spill->begin, n_windows + 1),
                                                    CONIC_ROOM(spill->blocks, n_windows * spill_block_bytes(spill)),
                                                    CONIC_ROOM(spill->read, spill_block_bytes(spill)));
  for (size_t i = 0; spill->heaps && i < n_windows; i++)
    spill->heaps[i].last_block = NO_BLOCK;
  return status == CONIC_OK ? name_file(spill) : status;
}

/* What only putting aside needs. */
static void release_parts(conic_layers_spill *spill) {
  conic_context *context = spill->layers->context;
  conic_memory_release_these(context, spill->begin, spill->list);
  spill->begin = NULL;
  spill->list = NULL;
}

void conic_layers_spill_end(conic_layers_spill *spill) {
  conic_context *context = spill->layers->context;
  if (spill->is_open)
    conic_pile_end(&spill->pile);
  release_parts(spill);
  conic_memory_release_these(context, spill->path, spill->heaps, spill->blocks, spill->read, spill->boxes);
}

/* --- putting aside --- */

/* The pixels that a piece's splats may meet; none: an empty box. */
static void find_boxes(void *data, size_t i_piece) {
  const conic_layers_spill *spill = data;
  const conic_layers_piece *piece = &spill->set->pieces[i_piece];
  const conic_layers_place *place = &spill->cut->places[piece->i_place];
  const conic_splats *splats = &spill->set->splats;
  double radius = (double)conic_layers_place_entry(spill->layers, place)->radius;
  for (size_t i = piece->at; i < piece->at + piece->n_chosen; i++) {
    const float position[3] = {splats->position[0][i], splats->position[1][i], splats->position[2][i]};
    conic_window pixels = conic_layers_fine_pixels(place, spill->samples);
    spill->boxes[i] = (conic_box){0};
    if (conic_layers_narrow(spill->view, position, radius, &pixels))
      spill->boxes[i] = (conic_box){(uint16_t)pixels.x_begin, (uint16_t)pixels.x_end, (uint16_t)pixels.y_begin,
                                    (uint16_t)pixels.y_end};
  }
}

/* The cells that a box meets. */
static inline conic_window cells_of_box(const conic_layers_windows *w, const conic_box *box) {
  conic_window in = conic_window_meet(&w->part, &(conic_window){box->x_begin, box->x_end, box->y_begin, box->y_end});
  if (in.x_begin >= in.x_end || in.y_begin >= in.y_end)
    return (conic_window){0, 0, 0, 0};
  return (conic_window){conic_layers_cell_column(w, in.x_begin), conic_layers_cell_column(w, in.x_end - 1) + 1,
                        conic_layers_cell_row(w, in.y_begin), conic_layers_cell_row(w, in.y_end - 1) + 1};
}

/* The window that has the cell, where the cell is the first of the visited ones in it; else none. */
static inline uint32_t window_at(const conic_layers_windows *w, const conic_window *v, int x, int y) {
  size_t at = (size_t)y * (size_t)w->n_columns + (size_t)x;
  uint32_t i = w->window_of[at];
  if ((x > v->x_begin && w->window_of[at - 1] == i) || (y > v->y_begin && w->window_of[at - (size_t)w->n_columns] == i))
    return UINT32_MAX;
  return i;
}

/* Counts, or lists, the windows' splats: begin[i + 1] is where the i-th window's next goes. */
static void visit_windows(const conic_layers_spill *spill, int is_listing) {
  const conic_layers_windows *w = spill->windows;
  for (size_t i = 0; i < spill->set->splats.count; i++) {
    conic_window v = cells_of_box(w, &spill->boxes[i]);
    for (int y = v.y_begin; y < v.y_end; y++)
      for (int x = v.x_begin; x < v.x_end; x++) {
        uint32_t window = window_at(w, &v, x, y);
        if (window == UINT32_MAX)
          continue;
        if (is_listing)
          spill->list[spill->begin[window]] = (uint32_t)i;
        spill->begin[window]++;
      }
  }
}

/* Lists the set's splats window by window; begin[i] … begin[i + 1] are the i-th window's. */
static conic_status list_by_window(conic_layers_spill *spill) {
  size_t n_windows = spill->windows->n_windows, sum = 0;
  memset(spill->begin, 0, (n_windows + 1) * sizeof *spill->begin);
  visit_windows(spill, 0);
  for (size_t i = 0; i <= n_windows; i++) {
    size_t n = spill->begin[i];
    spill->begin[i] = sum;
    sum += n;
  }
  if (sum > spill->listed_room) {
    conic_status status = conic_memory_grow(spill->layers->context, &spill->list, 0, sum, sizeof *spill->list);
    if (status != CONIC_OK)
      return status;
    spill->listed_room = sum;
  }
  visit_windows(spill, 1);
  memmove(spill->begin + 1, spill->begin, n_windows * sizeof *spill->begin);
  spill->begin[0] = 0;
  return CONIC_OK;
}

/* Writes so many elements, named by the list, behind `at` others of a block's column. */
static void copy_elements(const conic_layers_column *column, const uint32_t *list, size_t n, unsigned char *to) {
  if (column->n_bytes == sizeof(uint32_t)) {
    const uint32_t *from = (const uint32_t *)(const void *)column->elements;
    uint32_t *words = (uint32_t *)(void *)to;
    for (size_t i = 0; i < n; i++)
      words[i] = from[list[i]];
    return;
  }
  for (size_t i = 0; i < n; i++)
    memcpy(to + i * column->n_bytes, column->elements + (size_t)list[i] * column->n_bytes, column->n_bytes);
}

static void fill_block(const conic_layers_spill *spill, size_t i_window, size_t at, const uint32_t *list, size_t n) {
  conic_layers_column columns[CONIC_LAYERS_MOST_COLUMNS];
  size_t n_columns = list_columns(spill, columns);
  unsigned char *to = begin_spill_block(spill, i_window) + HEAD_BYTES;
  for (size_t i = 0; i < n_columns; i++) {
    copy_elements(&columns[i], list, n, to + at * columns[i].n_bytes);
    to += spill->block_count * columns[i].n_bytes;
  }
}

static conic_status end_spill_block(conic_layers_spill *spill, size_t i_window) {
  conic_layers_heap *heap = &spill->heaps[i_window];
  unsigned char *block = begin_spill_block(spill, i_window);
  memcpy(block, &heap->last_block, sizeof heap->last_block);
  return conic_pile_append(&spill->pile, block, spill_block_bytes(spill), &heap->last_block);
}

static void put_aside(void *data, size_t i_window) {
  conic_layers_spill *spill = data;
  conic_layers_heap *heap = &spill->heaps[i_window];
  for (size_t i = spill->begin[i_window]; i < spill->begin[i_window + 1];) {
    size_t at = heap->count % spill->block_count, left = spill->begin[i_window + 1] - i;
    size_t n = spill->block_count - at < left ? spill->block_count - at : left;
    fill_block(spill, i_window, at, spill->list + i, n);
    heap->count += n;
    i += n;
    if (at + n == spill->block_count && end_spill_block(spill, i_window) != CONIC_OK)
      atomic_store(&spill->failed, 1);
  }
}

/* Nothing is written before a block is full. */
static conic_status open_pile(conic_layers_spill *spill) {
  for (size_t i = 0; i < spill->windows->n_windows && !spill->is_open; i++)
    if (spill->heaps[i].count + spill->begin[i + 1] - spill->begin[i] >= spill->block_count) {
      conic_status status = conic_pile_begin(spill->layers->context, spill->path, &spill->pile);
      if (status != CONIC_OK)
        return status;
      spill->is_open = 1;
    }
  return CONIC_OK;
}

/* For as many splats as the set has room for; those that there are stay. */
static conic_status reserve_boxes(conic_layers_spill *spill) {
  if (spill->set->room <= spill->boxes_room)
    return CONIC_OK;
  conic_status status = conic_memory_grow(spill->layers->context, &spill->boxes, spill->boxes_room, spill->set->room,
                                          sizeof *spill->boxes);
  spill->boxes_room = status == CONIC_OK ? spill->set->room : 0;
  return status;
}

conic_status conic_layers_spill_look(conic_layers_spill *spill) {
  conic_status status = reserve_boxes(spill);
  if (status == CONIC_OK)
    conic_parallel_for(spill->layers->context, spill->set->n_pieces, find_boxes, spill);
  return status;
}

conic_status conic_layers_spill_take(conic_layers_spill *spill) {
  conic_context *context = spill->layers->context;
  conic_status status = conic_layers_spill_look(spill);
  if (status == CONIC_OK)
    status = list_by_window(spill);
  if (status == CONIC_OK)
    status = open_pile(spill);
  if (status != CONIC_OK)
    return status;
  conic_parallel_for(context, spill->windows->n_windows, put_aside, spill);
  return atomic_load(&spill->failed) ? CONIC_ERROR_IO : CONIC_OK;
}

conic_status conic_layers_spill_close(conic_layers_spill *spill) {
  conic_status status = CONIC_OK;
  release_parts(spill);
  if (!spill->is_open)
    return CONIC_OK;
  for (size_t i = 0; i < spill->windows->n_windows && status == CONIC_OK; i++)
    if (spill->heaps[i].count % spill->block_count)
      status = end_spill_block(spill, i);
  conic_memory_release(spill->layers->context, spill->blocks);
  spill->blocks = NULL;
  return status;
}

/* --- taking back --- */

/* Lists those of a block's first splats that may meet the part. */
static size_t choose_of_block(const conic_layers_spill *spill, const unsigned char *block, size_t n,
                              const conic_window *part, uint32_t chosen[MOST_BLOCK]) {
  size_t at_boxes = conic_layers_set_arrays(spill->layers) * sizeof(float) + sizeof(uint32_t), n_chosen = 0;
  const unsigned char *boxes = block + HEAD_BYTES + spill->block_count * at_boxes;
  for (size_t i = 0; i < n; i++) {
    conic_box box;
    memcpy(&box, boxes + i * sizeof box, sizeof box);
    chosen[n_chosen] = (uint32_t)i;
    n_chosen += box.x_begin < part->x_end && box.x_end > part->x_begin && box.y_begin < part->y_end &&
                box.y_end > part->y_begin;
  }
  return n_chosen;
}

static void take_of_block(const conic_layers_spill *spill, const unsigned char *block, const uint32_t *chosen,
                          size_t n_chosen, size_t to) {
  conic_layers_column columns[CONIC_LAYERS_MOST_COLUMNS];
  size_t n_columns = list_columns(spill, columns);
  block += HEAD_BYTES;
  for (size_t i = 0; i < n_columns; i++) {
    size_t n_bytes = columns[i].n_bytes;
    char *elements = columns[i].elements ? columns[i].elements + to * n_bytes : NULL;
    if (elements && n_chosen == chosen[n_chosen - 1] + (size_t)1) /* all from the first on */
      memcpy(elements, block, n_chosen * n_bytes);
    for (size_t k = 0; elements && k < n_chosen && n_chosen <= chosen[n_chosen - 1]; k++)
      memcpy(elements + k * n_bytes, block + chosen[k] * n_bytes, n_bytes);
    block += spill->block_count * n_bytes;
  }
}

/* Goes from the last block to the first, and fills the set from its end. Returns where what was taken begins, or
 * SIZE_MAX where there is no room for all. */
static conic_status take_blocks(conic_layers_spill *spill, size_t i_window, const conic_window *part, size_t *at) {
  const conic_layers_heap *heap = &spill->heaps[i_window];
  uint32_t chosen[MOST_BLOCK + 1];
  const unsigned char *block = spill->read;
  uint64_t before = heap->last_block;
  for (size_t left = heap->count; left > 0;) {
    size_t n = left % spill->block_count ? left % spill->block_count : spill->block_count;
    if (spill->blocks) /* which are all there is */
      block = begin_spill_block(spill, i_window);
    else {
      conic_status status = conic_pile_read(&spill->pile, before, spill->read, spill_block_bytes(spill));
      if (status != CONIC_OK)
        return status;
      memcpy(&before, spill->read, sizeof before);
    }
    size_t n_chosen = choose_of_block(spill, block, n, part, chosen);
    if (n_chosen > *at) {
      *at = SIZE_MAX;
      return CONIC_OK;
    }
    *at -= n_chosen;
    if (n_chosen)
      take_of_block(spill, block, chosen, n_chosen, *at);
    left -= n;
  }
  return CONIC_OK;
}

conic_status conic_layers_spill_load(conic_layers_spill *spill, size_t i_window, const conic_window *part, size_t most,
                                     int *is_too_much) {
  conic_layers_set *set = spill->set;
  conic_layers_column columns[CONIC_LAYERS_MOST_COLUMNS];
  const conic_window *whole = &spill->windows->windows[i_window];
  size_t count = spill->heaps[i_window].count, room = most && most < count ? most : count, at = room;
  set->splats.count = set->splats.n_clips = 0;
  conic_status status = conic_layers_set_reserve(spill->layers, set, 0, room);
  if (status == CONIC_OK)
    status = reserve_boxes(spill);
  if (status == CONIC_OK && room < count && memcmp(part, whole, sizeof *part) == 0)
    at = SIZE_MAX;
  else if (status == CONIC_OK)
    status = take_blocks(spill, i_window, part, &at);
  *is_too_much = status == CONIC_OK && at == SIZE_MAX;
  if (status != CONIC_OK || *is_too_much)
    return status;
  size_t n_columns = list_columns(spill, columns);
  for (size_t i = 0; i < n_columns && columns[i].elements && at > 0; i++)
    memmove(columns[i].elements, columns[i].elements + at * columns[i].n_bytes, (room - at) * columns[i].n_bytes);
  set->splats.count = room - at;
  return conic_layers_set_list_lines(spill->layers, set);
}
