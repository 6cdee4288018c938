/* From vertices on the screen to records of what may cover a sample. */
#include "core/base/real.h"
#include "raster/triangles/triangle_frame.h"

typedef enum fate { DRAWN, CULLED, SKIPPED } fate;

/* The first pixel whose centre is not before the place, and the first whose centre is after it. */
static int first_from(int32_t place) {
  return (place + CONIC_SUBPIXELS / 2 - 1) >> CONIC_SUBPIXEL_BITS;
}

static int first_after(int32_t place) {
  return ((place - CONIC_SUBPIXELS / 2) >> CONIC_SUBPIXEL_BITS) + 1;
}

/* Whether there are centres of the image's pixels in the triangle's box. */
static int find_box(const conic_view *view, const int32_t x[3], const int32_t y[3], conic_box *box) {
  int x_begin = first_from(conic_least(conic_least(x[0], x[1]), x[2])),
      x_end = first_after(conic_greatest(conic_greatest(x[0], x[1]), x[2]));
  int y_begin = first_from(conic_least(conic_least(y[0], y[1]), y[2])),
      y_end = first_after(conic_greatest(conic_greatest(y[0], y[1]), y[2]));
  x_begin = conic_greatest(x_begin, 0);
  y_begin = conic_greatest(y_begin, 0);
  x_end = conic_least(x_end, view->width);
  y_end = conic_least(y_end, view->height);
  if (x_begin >= x_end || y_begin >= y_end)
    return 0;
  *box = (conic_box){(uint16_t)x_begin, (uint16_t)x_end, (uint16_t)y_begin, (uint16_t)y_end};
  return 1;
}

/* Most triangles of a fine mesh have one sample in their box, and most of those do not cover it. */
static int misses_its_only_sample(const conic_triangle_record *record) {
  conic_triangle_edges edges;
  int is_inside = 1;
  if (record->box.x_end - record->box.x_begin > 1 || record->box.y_end - record->box.y_begin > 1)
    return 0;
  conic_triangle_edges_of(record, &edges);
  for (int k = 0; k < 3; k++)
    is_inside &= conic_triangle_edge_at(&edges, k, record->box.x_begin, record->box.y_begin) + edges.bias[k] >= 0;
  return !is_inside;
}

/* Appends a triangle of three places on the screen. */
static fate add(const conic_triangle_frame *frame, const conic_screen_vertex *const v[3], uint32_t index,
                uint32_t piece, conic_triangle_sorter *sorter) {
  conic_triangle_record *record = &sorter->records[sorter->n_records];
  const int32_t x[3] = {v[0]->x, v[1]->x, v[2]->x}, y[3] = {v[0]->y, v[1]->y, v[2]->y};
  if (!find_box(frame->view, x, y, &record->box))
    return CULLED;
  int64_t area = (int64_t)(x[1] - x[0]) * (y[2] - y[0]) - (int64_t)(x[2] - x[0]) * (y[1] - y[0]);
  if (area == 0 ||
      (area > 0 && frame->view->cull_back)) /* with y down, what is counter-clockwise has no positive area */
    return CULLED;
  int second = area > 0 ? 1 : 2, third = 3 - second;
  record->is_swapped = area < 0;
  record->x[0] = x[0];
  record->x[1] = x[second];
  record->x[2] = x[third];
  record->y[0] = y[0];
  record->y[1] = y[second];
  record->y[2] = y[third];
  if (misses_its_only_sample(record))
    return DRAWN;
  record->iz[0] = v[0]->iz;
  record->iz[1] = v[second]->iz;
  record->iz[2] = v[third]->iz;
  record->index = index;
  record->piece = piece;
  record->part = 1.0 / (double)(area > 0 ? area : -area);
  sorter->n_records++;
  return DRAWN;
}

/* Some corners have no place on the screen. What clipping leaves of the triangle is drawn as a fan. */
static fate add_clipped(const conic_triangle_frame *frame, size_t i, conic_triangle_sorter *sorter) {
  conic_clip_corner corners[CONIC_CLIPPED_CORNERS];
  conic_screen_vertex places[CONIC_CLIPPED_CORNERS];
  fate of_all = CULLED;
  int n = conic_triangle_clip(frame, i, corners);
  for (int k = 0; k < n; k++) {
    places[k] = conic_triangle_place(frame, corners[k].p);
    if (places[k].outside == CONIC_VERTEX_BAD)
      return SKIPPED;
  }
  for (int k = 1; k + 1 < n; k++) {
    const conic_screen_vertex *const v[3] = {&places[0], &places[k], &places[k + 1]};
    const conic_clip_corner *const c[3] = {&corners[0], &corners[k], &corners[k + 1]};
    size_t n_before = sorter->n_records;
    if (add(frame, v, (uint32_t)i, (uint32_t)sorter->n_pieces, sorter) == DRAWN)
      of_all = DRAWN;
    if (sorter->n_records == n_before)
      continue;
    for (int corner = 0; corner < 3; corner++)
      for (int axis = 0; axis < 2; axis++)
        sorter->pieces[sorter->n_pieces].at[corner][axis] = (float)c[corner]->at[axis];
    sorter->n_pieces++;
  }
  return of_all;
}

static fate add_triangle(const conic_triangle_frame *frame, size_t i, conic_triangle_sorter *sorter) {
  const uint32_t *corners = frame->triangles->corners[i];
  const conic_screen_vertex *const v[3] = {&frame->vertices[corners[0]], &frame->vertices[corners[1]],
                                           &frame->vertices[corners[2]]};
  uint32_t any = v[0]->outside | v[1]->outside | v[2]->outside;
  if (__builtin_expect(any == 0, 1))
    return add(frame, v, (uint32_t)i, CONIC_NO_PIECE, sorter);
  if (any & CONIC_VERTEX_BAD)
    return SKIPPED;
  return v[0]->outside & v[1]->outside & v[2]->outside ? CULLED : add_clipped(frame, i, sorter);
}

void conic_triangle_set_up(const conic_triangle_frame *frame, size_t begin, size_t end, conic_triangle_sorter *sorter,
                           conic_triangle_chunk *chunk) {
  enum { AHEAD = 16 };
  size_t n[3] = {0, 0, 0};
  sorter->n_records = sorter->n_pieces = 0;
  for (size_t i = begin; i < end; i++) {
    const uint32_t *later = frame->triangles->corners[i + AHEAD < end ? i + AHEAD : i];
    for (int k = 0; k < 3; k++)
      __builtin_prefetch(&frame->vertices[later[k]]);
    n[add_triangle(frame, i, sorter)]++;
  }
  chunk->n_drawn = n[DRAWN];
  chunk->n_culled = n[CULLED];
  chunk->n_skipped = n[SKIPPED];
}
