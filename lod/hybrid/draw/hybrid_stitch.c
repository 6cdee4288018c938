/* Clusters side by side at different levels: vertices that one has along their border, and the other has not, are put
 * in. */
#include "lod/hybrid/draw/hybrid_selecting.h"

/* The next slot of a border after `slot` that the cluster across still has, or the border's end. */
static uint32_t next_slot(const conic_hybrid_frame *frame, const conic_cluster_border *border, uint32_t stage,
                          uint32_t slot) {
  uint32_t step = border->from < border->to ? 1u : UINT32_MAX; /* backwards */
  do
    slot += step;
  while (slot != border->to && frame->stages[slot] < stage);
  return slot;
}

static int is_free(const conic_cluster_border *border, uint32_t stage) {
  return stage == CONIC_HYBRID_HIDDEN || border->from == border->to;
}

size_t conic_hybrid_count_stitches(const conic_hybrid *h, uint32_t cluster, const conic_hybrid_level *level,
                                   const uint32_t *stages) {
  size_t n = 0;
  if (level->n_borders == 0)
    return 0;
  conic_hybrid_frame frame = conic_hybrid_frame_of(h, cluster);
  for (size_t i = 0; i < level->n_borders; i++) {
    const conic_cluster_border *border = &frame.borders[level->first_border + i];
    uint32_t stage = stages[border->across];
    if (is_free(border, stage))
      continue;
    for (uint32_t slot = next_slot(&frame, border, stage, border->from); slot != border->to;
         slot = next_slot(&frame, border, stage, slot))
      n++;
  }
  return n;
}

static uint32_t put_vertex(conic_hybrid_stitching *s, uint32_t slot) {
  size_t at = s->vertex++;
  for (int axis = 0; axis < 3; axis++) {
    s->to->position[axis][at] = s->ends.position[axis][slot];
    if (s->to->normal[0])
      s->to->normal[axis][at] = s->ends.normal[axis][slot];
    if (s->to->color[0])
      s->to->color[axis][at] = s->ends.color[axis][slot];
  }
  for (int k = 0; k < 2 && s->to->texture_coordinate[0]; k++)
    s->to->texture_coordinate[k][at] = s->ends.texture_coordinate[k][slot];
  return (uint32_t)at;
}

/* A triangle like `from`, but for its corners. */
static size_t put_triangle(conic_hybrid_stitching *s, size_t from, uint32_t a, uint32_t b, uint32_t c) {
  conic_triangles *to = s->to;
  size_t at = s->triangle++;
  to->corners[at][0] = a;
  to->corners[at][1] = b;
  to->corners[at][2] = c;
  to->cluster[at] = to->cluster[from];
  if (to->material)
    to->material[at] = to->material[from];
  return at;
}

/* Cuts the triangle `host` from its opposite corner to what is put into the edge that begins at `begin`. Returns the
 * piece at the edge's end; the host itself becomes that at its beginning. */
static size_t cut_triangle(conic_hybrid_stitching *s, size_t host, uint32_t begin, const conic_cluster_border *border) {
  const uint32_t *corners = s->to->corners[host];
  uint32_t k = corners[0] == begin ? 0 : corners[1] == begin ? 1 : 2;
  uint32_t end = corners[(k + 1) % 3], opposite = corners[(k + 2) % 3], stage = s->stages[border->across];
  size_t piece = host;
  for (uint32_t slot = next_slot(&s->frame, border, stage, border->from); slot != border->to;
       slot = next_slot(&s->frame, border, stage, slot)) {
    uint32_t put = put_vertex(s, slot);
    s->to->corners[piece][piece == host ? (k + 1) % 3 : 1] = put;
    piece = put_triangle(s, host, put, end, opposite);
  }
  return piece;
}

/* Up to three edges of one triangle. Which piece has an edge changes as those before it are cut. */
static size_t stitch_triangle(conic_hybrid_stitching *s, const conic_cluster_border *borders, size_t n) {
  size_t triangle = s->first_triangle + borders[0].edge / 4, i = 0;
  size_t hosts[3] = {triangle, triangle, triangle};
  const uint32_t corners[3] = {s->to->corners[triangle][0], s->to->corners[triangle][1], s->to->corners[triangle][2]};
  for (; i < n && borders[i].edge / 4 == borders[0].edge / 4; i++) {
    uint32_t corner = borders[i].edge % 4, next = (corner + 1) % 3;
    if (is_free(&borders[i], s->stages[borders[i].across]))
      continue;
    size_t host = hosts[corner], piece = cut_triangle(s, host, corners[corner], &borders[i]);
    if (hosts[next] == host)
      hosts[next] = piece;
  }
  return i;
}

void conic_hybrid_stitch(conic_hybrid_stitching *s) {
  s->frame = conic_hybrid_frame_of(s->hybrid, s->cluster);
  s->ends = conic_hybrid_ends_of(s->hybrid, s->cluster);
  const conic_cluster_border *borders = s->frame.borders + s->level->first_border;
  for (size_t i = 0; i < s->level->n_borders;)
    i += stitch_triangle(s, borders + i, s->level->n_borders - i);
}
