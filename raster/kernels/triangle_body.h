/* The triangles' slots in lanes: the operations of triangle_vertices.c and triangle_tile.c in the same order. Included
 * by raster_kernels_body.h. */
#include "core/lanes/lanes_double.h"
#include "raster/kernels/texture_body.h"
#include "raster/triangles/triangle_look.h"
#include "raster/triangles/triangle_pixel.h"
#include "raster/triangles/triangle_tile.h"

/* wide_of's vectors of integers as they are compared. */
CONIC_INLINE wide_mask flag_where(wide_mask mask, int64_t bits) {
  return mask & (bits - (wide_mask){0});
}

CONIC_INLINE wide_ints snap_half(wide px) {
  const double guard = (double)CONIC_GUARD_PX, shift = 67108864.0;
  px = wide_min(wide_max(px, wide_of(-guard)), wide_of(guard));
  return __builtin_convertvector(px * (double)CONIC_SUBPIXELS + (shift + 0.5), wide_ints) - (int32_t)shift;
}

/* conic_triangle_place of as many vertices as half a vector has lanes. */
CONIC_INLINE void place_half(const conic_triangle_frame *frame, size_t i, conic_screen_vertex *to) {
  const conic_view *view = frame->view;
  const double guard = (double)CONIC_GUARD_PX;
  wide p[3], from[3];
  for (int axis = 0; axis < 3; axis++)
    from[axis] = wide_load_floats(frame->triangles->position[axis] + i);
  for (int row = 0; row < 3; row++) {
    const double *m = view->rotation[row];
    p[row] = ((m[0] * from[0] + m[1] * from[1]) + m[2] * from[2]) + frame->translation[row];
  }
  wide iz = 1.0 / p[2], x = view->fx * p[0] * iz + view->cx, y = view->fy * p[1] * iz + view->cy;
  wide_mask is_finite = (p[0] * 0.0 == 0.0) & (p[1] * 0.0 == 0.0) & (p[2] * 0.0 == 0.0);
  wide_mask is_before = p[2] - view->near_z >= 0.0;
  wide_mask outside = flag_where(~(view->fx * p[0] + (guard + view->cx) * p[2] >= 0.0), CONIC_VERTEX_LEFT) |
                      flag_where(~((guard - view->cx) * p[2] - view->fx * p[0] >= 0.0), CONIC_VERTEX_RIGHT) |
                      flag_where(~(view->fy * p[1] + (guard + view->cy) * p[2] >= 0.0), CONIC_VERTEX_ABOVE) |
                      flag_where(~((guard - view->cy) * p[2] - view->fy * p[1] >= 0.0), CONIC_VERTEX_BELOW);
  wide_mask is_held = (iz >= CONIC_LEAST_IZ) & (iz <= CONIC_GREATEST_IZ), has_place = is_finite & is_before & is_held;
  outside = (outside & is_held) | flag_where(~is_held, CONIC_VERTEX_BAD);
  outside = (outside & is_before) | flag_where(~is_before, CONIC_VERTEX_NEAR);
  outside = (outside & is_finite) | flag_where(~is_finite, CONIC_VERTEX_BAD);
  wide zero = wide_of(0.0);
  wide_mask has_snapped = is_finite & is_before;
  wide_ints snapped_x = snap_half(x), snapped_y = snap_half(y);
  wide_ints snaps = __builtin_convertvector(has_snapped, wide_ints);
  wide_ints bits = __builtin_convertvector(outside, wide_ints);
  wide_floats iz_float = __builtin_convertvector(wide_select(has_place, iz, zero), wide_floats);
  for (int lane = 0; lane < CONIC_WIDE_LANES; lane++)
    to[lane] = (conic_screen_vertex){snapped_x[lane] & snaps[lane], snapped_y[lane] & snaps[lane], iz_float[lane],
                                     (uint32_t)bits[lane]};
}

static void triangle_vertices(const conic_triangle_frame *frame, size_t begin, size_t end,
                              conic_screen_vertex *vertices) {
  size_t i = begin;
  for (; i + CONIC_WIDE_LANES <= end; i += CONIC_WIDE_LANES)
    place_half(frame, i, vertices + i);
  conic_triangle_vertices(frame, i, end, vertices);
}

/* A part's columns and rows of pixels. */
CONIC_INLINE int_lanes part_columns(int part) {
  return lanes_columns() + part * (CONIC_LANES / CONIC_BLOCK_EDGE);
}

/* A record, and what of it is the same in all blocks. */
typedef struct drawing {
  int_lanes within[3][CONIC_PARTS]; /* how far each edge's value is from that at the block's first pixel, in steps */
  lanes iz_far, iz_near;
  const conic_triangle_record *record;
  conic_triangle_edges edges;
  int32_t most[3]; /* the most that it gains */
  uint32_t i_record;
} drawing;

CONIC_INLINE void begin_drawing(const conic_triangle_record *record, uint32_t i_record, drawing *d) {
  d->record = record;
  d->i_record = i_record;
  conic_triangle_edges_of(record, &d->edges);
  for (int k = 0; k < 3; k++) {
    int32_t a = (int32_t)d->edges.a[k], b = (int32_t)d->edges.b[k];
    d->most[k] = (CONIC_BLOCK_EDGE - 1) * ((a > 0 ? a : 0) + (b > 0 ? b : 0));
    for (int part = 0; part < CONIC_PARTS; part++)
      d->within[k][part] = part_columns(part) * a + lanes_rows() * b;
  }
  d->iz_far = lanes_of(conic_triangle_far(record));
  d->iz_near = lanes_of(conic_triangle_near(record));
}

/* The samples of a block from the values of the edges at its first; those beyond the image are none. */
CONIC_INLINE unsigned draw_block(const drawing *d, const int64_t e[3], int columns_left, int rows_left,
                                 conic_triangle_block *block) {
  int32_t steps[3];
  for (int k = 0; k < 3; k++) {
    steps[k] = conic_triangle_steps(e[k] + d->edges.bias[k]);
    if (steps[k] + d->most[k] < 0)
      return 0;
  }
  conic_affine depth = conic_triangle_depth(d->record, &d->edges, e[1], e[2]);
  unsigned n_covered = 0;
  for (int part = 0; part < CONIC_PARTS; part++) {
    size_t at = (size_t)part * CONIC_LANES;
    int_lanes columns = part_columns(part), rows = lanes_rows();
    int_lanes inside = (steps[0] + d->within[0][part]) | (steps[1] + d->within[1][part]) |
                       (steps[2] + d->within[2][part]); /* its sign is set where any of theirs is */
    lanes_mask covered = lanes_less_int(lanes_of_int(-1), inside);
    if (columns_left < CONIC_BLOCK_EDGE || rows_left < CONIC_BLOCK_EDGE)
      covered &= lanes_less_int(columns, lanes_of_int(columns_left)) & lanes_less_int(rows, lanes_of_int(rows_left));
    lanes iz = (depth.at + depth.by_y * __builtin_convertvector(rows, lanes)) +
               depth.by_x * __builtin_convertvector(columns, lanes);
    iz = lanes_min(lanes_max(iz, d->iz_far), d->iz_near);
    lanes kept = lanes_load(block->iz + at);
    lanes_mask nearer = covered & lanes_less(kept, iz);
    lanes_store(block->iz + at, lanes_select(nearer, iz, kept));
    lanes_replace_indices(block->record + at, nearer, lanes_of_index(d->i_record));
    n_covered += lanes_count(covered);
  }
  return n_covered;
}

/* A record of many samples, block by block. */
static unsigned draw_blocks(const conic_triangle_frame *frame, uint32_t i_record, int x, int y,
                            conic_triangle_tile *tile) {
  const conic_triangle_record *record = &frame->records[i_record];
  const conic_box *box = &record->box;
  int first = box->x_begin > x ? (box->x_begin - x) / CONIC_BLOCK_EDGE : 0;
  int first_row = box->y_begin > y ? (box->y_begin - y) / CONIC_BLOCK_EDGE : 0;
  int x_end = box->x_end < x + frame->tile ? box->x_end : x + frame->tile;
  int y_end = box->y_end < y + frame->tile ? box->y_end : y + frame->tile;
  enum { BLOCK_STEP = CONIC_BLOCK_EDGE * CONIC_SUBPIXELS };
  unsigned n_covered = 0;
  int64_t of_row[3];
  drawing d;
  begin_drawing(record, i_record, &d);
  for (int k = 0; k < 3; k++)
    of_row[k] = conic_triangle_edge_at(&d.edges, k, x + first * CONIC_BLOCK_EDGE, y + first_row * CONIC_BLOCK_EDGE);
  for (int i_row = first_row; y + i_row * CONIC_BLOCK_EDGE < y_end; i_row++) {
    int64_t e[3] = {of_row[0], of_row[1], of_row[2]};
    int rows_left = frame->view->height - (y + i_row * CONIC_BLOCK_EDGE);
    for (int block = first; x + block * CONIC_BLOCK_EDGE < x_end; block++) {
      int columns_left = frame->view->width - (x + block * CONIC_BLOCK_EDGE);
      n_covered += draw_block(&d, e, columns_left, rows_left, &tile->blocks[i_row][block]);
      for (int k = 0; k < 3; k++)
        e[k] += d.edges.a[k] * BLOCK_STEP;
    }
    for (int k = 0; k < 3; k++)
      of_row[k] += d.edges.b[k] * BLOCK_STEP;
  }
  return n_covered;
}

CONIC_INLINE int has_few_samples(const conic_box *box) {
  enum { FEW = 3 };
  return (box->x_end - box->x_begin) * (box->y_end - box->y_begin) <= FEW;
}

CONIC_INLINE uint32_t covered_bits(const conic_triangle_block *block) {
  uint32_t bits = 0;
  for (int part = 0; part < CONIC_PARTS; part++)
    bits |= lanes_bits(lanes_less(lanes_of(0.0f), lanes_load(block->iz + (size_t)part * CONIC_LANES)))
            << (part * CONIC_LANES);
  return bits;
}

static void triangles_draw(const conic_triangle_frame *frame, size_t i_tile, int x, int y, conic_triangle_tile *tile) {
  enum { AHEAD = 8 };
  uint64_t n_fragments = 0;
  memset(tile->covered, 0, sizeof tile->covered);
  memset(tile->blocks, 0, sizeof tile->blocks);
  for (size_t i = 0; i < frame->n_chunks; i++) {
    const conic_triangle_chunk *chunk = &frame->chunks[i];
    const uint32_t *begin = frame->tile_begin + i * (frame->n_tiles + 1) + i_tile;
    const uint32_t *entries = frame->entries + chunk->first_entry;
    for (uint32_t k = begin[0]; k < begin[1]; k++) {
      uint32_t i_record = (uint32_t)chunk->first_record + entries[k];
      __builtin_prefetch(&frame->records[chunk->first_record + entries[k + AHEAD < begin[1] ? k + AHEAD : k]]);
      n_fragments += has_few_samples(&frame->records[i_record].box)
                         ? conic_triangle_draw_samples(frame, i_record, x, y, tile)
                         : draw_blocks(frame, i_record, x, y, tile);
    }
  }
  tile->n_fragments = n_fragments;
  for (int i_row = 0; i_row < frame->tile / CONIC_BLOCK_EDGE && n_fragments; i_row++)
    for (int block = 0; block < frame->tile / CONIC_BLOCK_EDGE; block++)
      tile->covered[i_row][block] = covered_bits(&tile->blocks[i_row][block]);
}

static void triangles_hide(conic_band *band, const conic_tile_rays *rays) {
  conic_triangle_row *row = band->triangles;
  int i_row = (band->y - rays->y_begin) / CONIC_BLOCK_EDGE;
  float epsilon = band->triangle_frame->epsilon;
  for (int block = 0; block < band->n_blocks; block++) {
    row->visible[block] = row->covered[block];
    if (!row->covered[block] || conic_block_is_empty(band, block))
      continue;
    uint32_t visible = 0;
    for (int part = 0; part < CONIC_PARTS; part++) {
      int at = part * CONIC_LANES;
      lanes iz = lanes_load(row->blocks[block].iz + at), threshold = lanes_load(band->kept[block].threshold + at);
      lanes dx = lanes_load(rays->block_x[block] + at), dy = lanes_load(rays->block_y[i_row] + at);
      lanes hides = iz * (1.0f / (1.0f + epsilon * iz / lanes_sqrt((dx * dx + dy * dy) + 1.0f)));
      visible |= lanes_bits(lanes_at_least(iz, threshold)) << at;
      lanes_store(band->kept[block].threshold + at, lanes_max(hides, threshold)); /* 0 where there is no triangle */
    }
    row->visible[block] &= visible;
  }
}

/* A triangle's look at the pixels of a part. */
typedef struct places {
  lanes at[2], by_x[2], by_y[2];
} places;

CONIC_INLINE lanes affine_at(const conic_affine *f, lanes column, lanes row) {
  return (f->at + f->by_y * row) + f->by_x * column;
}

CONIC_INLINE void find_places(const conic_triangle_look *look, lanes column, lanes row, places *p) {
  lanes iz = affine_at(&look->iz, column, row), zero = lanes_of(0.0f), one = lanes_of(1.0f);
  iz = lanes_min(lanes_max(iz, lanes_of(look->iz_far)), lanes_of(look->iz_near));
  lanes z = 1.0f / iz;
  const conic_affine *weights[2] = {&look->first, &look->second};
  for (int i = 0; i < 2; i++) {
    p->at[i] = lanes_min(lanes_max(affine_at(weights[i], column, row) * z, zero), one);
    p->by_x[i] = (weights[i]->by_x - p->at[i] * look->iz.by_x) * z;
    p->by_y[i] = (weights[i]->by_y - p->at[i] * look->iz.by_y) * z;
  }
  if (!look->is_piece)
    return;
  const places of_piece = *p;
  for (int i = 0; i < 2; i++) {
    p->at[i] = look->at[0][i] + (of_piece.at[0] * look->at[1][i] + of_piece.at[1] * look->at[2][i]);
    p->by_x[i] = of_piece.by_x[0] * look->at[1][i] + of_piece.by_x[1] * look->at[2][i];
    p->by_y[i] = of_piece.by_y[0] * look->at[1][i] + of_piece.by_y[1] * look->at[2][i];
  }
}

/* Pixels of a block whose triangles have a texture, one for all: their colours are added when it is known at all of
 * them, since it is filtered a pixel a lane, whichever triangles they see. */
typedef struct textured_pixels {
  const conic_texture *texture;
  uint32_t pixels;
  conic_texture_places places;
  float color[3][CONIC_BLOCK_PIXELS]; /* without the texture's */
} textured_pixels;

static __attribute__((noinline)) void add_textured(textured_pixels *t, conic_block_sums *sums) {
  float texel[3][CONIC_BLOCK_PIXELS];
  texture_at_places(t->texture, &t->places, t->pixels, texel);
  for (int at = 0; at < CONIC_BLOCK_PIXELS; at += CONIC_LANES) {
    lanes_mask mask = lanes_mask_of(t->pixels >> at & ((1u << CONIC_LANES) - 1));
    for (int channel = 0; channel < 3; channel++) {
      float *sum = sums->color[channel] + at;
      lanes_replace(sum, mask, lanes_load(sum) + lanes_load(t->color[channel] + at) * lanes_load(texel[channel] + at));
    }
  }
  t->pixels = 0;
}

/* Before pixels of a triangle are noted down: those of another texture are added. */
CONIC_INLINE void turn_to_texture(const conic_texture *texture, textured_pixels *t, conic_block_sums *sums) {
  if (t->pixels && t->texture != texture)
    add_textured(t, sums);
  t->texture = texture;
}

CONIC_INLINE void note_part(const conic_triangle_look *look, const places *p, int part, lanes_mask mask,
                            const lanes color[3], textured_pixels *t) {
  size_t at = (size_t)part * CONIC_LANES;
  for (int i = 0; i < 2; i++) {
    lanes_replace(t->places.uv[i] + at, mask, look->uv[0][i] + (p->at[0] * look->uv[1][i] + p->at[1] * look->uv[2][i]));
    lanes_replace(t->places.along[i] + at, mask, p->by_x[0] * look->uv[1][i] + p->by_x[1] * look->uv[2][i]);
    lanes_replace(t->places.across[i] + at, mask, p->by_y[0] * look->uv[1][i] + p->by_y[1] * look->uv[2][i]);
  }
  for (int channel = 0; channel < 3; channel++)
    lanes_replace(t->color[channel] + at, mask, color[channel]);
  t->pixels |= (uint32_t)lanes_bits(mask) << at;
}

CONIC_INLINE void note_pixel(const conic_triangle_sight *sight, int l, textured_pixels *t) {
  for (int i = 0; i < 2; i++) {
    t->places.uv[i][l] = sight->uv[i];
    t->places.along[i][l] = sight->along[i];
    t->places.across[i][l] = sight->across[i];
  }
  for (int channel = 0; channel < 3; channel++)
    t->color[channel][l] = sight->color[channel];
  t->pixels |= 1u << l;
}

CONIC_INLINE void find_normals(const conic_triangle_look *look, const places *p, const conic_finish *finish, lanes dx,
                               lanes dy, lanes normal[3]) {
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = lanes_of(look->face[axis]);
  if (look->has_normals) {
    lanes mean[3];
    for (int axis = 0; axis < 3; axis++)
      mean[axis] = look->normal[0][axis] + (p->at[0] * look->normal[1][axis] + p->at[1] * look->normal[2][axis]);
    lanes squared = (mean[0] * mean[0] + mean[1] * mean[1]) + mean[2] * mean[2], scale = 1.0f / lanes_sqrt(squared);
    lanes_mask is_usable = lanes_less(lanes_of(1e-30f), squared) & lanes_less(squared, lanes_of(1e30f));
    for (int axis = 0; axis < 3; axis++)
      normal[axis] = lanes_select(is_usable, mean[axis] * scale, normal[axis]);
  }
  lanes away = lanes_of(0.0f);
  for (int i = 0; i < 3; i++) {
    const float *m = finish->world_from_cam[i];
    away += normal[i] * ((m[0] * dx + m[1] * dy) + m[2]);
  }
  lanes_mask is_away = lanes_less(lanes_of(0.0f), away);
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = lanes_select(is_away, -normal[axis], normal[axis]);
}

CONIC_INLINE void add_colors(const lanes color[3], int part, lanes_mask mask, conic_block_sums *sums) {
  for (int channel = 0; channel < 3; channel++) {
    float *sum = sums->color[channel] + (size_t)part * CONIC_LANES;
    lanes_replace(sum, mask, lanes_load(sum) + color[channel]);
  }
}

/* Adds one triangle to the pixels of a part where the mask holds; colours that want a texture are noted down. */
CONIC_INLINE void add_part(const conic_triangle_look *look, const conic_finish *finish, lanes dx, lanes dy, int part,
                           lanes_mask mask, textured_pixels *textured, conic_block_sums *sums) {
  size_t at = (size_t)part * CONIC_LANES;
  lanes columns = __builtin_convertvector(part_columns(part), lanes);
  lanes rows = __builtin_convertvector(lanes_rows(), lanes), color[3], normal[3], sum[3], size = lanes_of(0.0f);
  places p;
  find_places(look, columns, rows, &p);
  for (int channel = 0; channel < 3; channel++)
    color[channel] = look->color[0][channel] + (p.at[0] * look->color[1][channel] + p.at[1] * look->color[2][channel]);
  if (look->texture)
    note_part(look, &p, part, mask, color, textured);
  else
    add_colors(color, part, mask, sums);
  find_normals(look, &p, finish, dx, dy, normal);
  lanes_replace(sums->weight + at, mask, lanes_load(sums->weight + at) + 1.0f);
  lanes_store_indices(sums->count + at, lanes_increment(mask, lanes_load_indices(sums->count + at)));
  for (int axis = 0; axis < 3; axis++) {
    sum[axis] = lanes_load(sums->normal[axis] + at) + normal[axis];
    size += lanes_absolute(sum[axis]);
  }
  lanes_mask has_size = lanes_less(lanes_of(0.0f), size);
  for (int axis = 0; axis < 3; axis++)
    lanes_replace(sums->normal[axis] + at, mask, lanes_select(has_size, sum[axis], normal[axis] * CONIC_LEAST_WEIGHT));
}

/* Adds the triangle that pixel l sees, by plain C but for the texture. */
CONIC_INLINE void add_alone(conic_band *band, const conic_finish *finish, const conic_tile_rays *rays, int i_block,
                            int l, textured_pixels *textured) {
  conic_triangle_sight sight;
  conic_triangle_see_pixel(band, finish, rays, i_block, l, &sight);
  if (sight.texture) {
    turn_to_texture(sight.texture, textured, &band->sums[i_block]);
    note_pixel(&sight, l, textured);
  }
  conic_triangle_add_sight(&sight, l, &band->sums[i_block]);
}

/* Whether the first of the pixels is the only one of them that sees the record. */
CONIC_INLINE int is_alone(const conic_triangle_block *block, uint32_t i_record, uint32_t pixels) {
  uint32_t same = 0;
  for (int part = 0; part < CONIC_PARTS; part++) {
    index_lanes other = lanes_load_indices(block->record + (size_t)part * CONIC_LANES) ^ i_record;
    same |= (~lanes_bits(lanes_has_bits(other, ~0u)) & ((1u << CONIC_LANES) - 1)) << (part * CONIC_LANES);
  }
  same &= pixels;
  return (same & (same - 1)) == 0;
}

/* All pixels of the block that see a triangle, one triangle after the other. */
CONIC_INLINE void add_block(conic_band *band, const conic_finish *finish, const conic_tile_rays *rays, int i_block) {
  const conic_triangle_block *block = &band->triangles->blocks[i_block];
  int i_row = (band->y - rays->y_begin) / CONIC_BLOCK_EDGE;
  textured_pixels textured;
  textured.pixels = 0;
  for (uint32_t left = band->triangles->visible[i_block]; left;) {
    uint32_t i_record = block->record[__builtin_ctz(left)], done = 0;
    /* In a fine mesh, hardly two pixels see the same triangle. */
    if (is_alone(block, i_record, left)) {
      add_alone(band, finish, rays, i_block, __builtin_ctz(left), &textured);
      left &= left - 1;
      continue;
    }
    conic_triangle_look look;
    conic_triangle_look_at(band->triangle_frame, &band->triangle_frame->records[i_record],
                           band->x + i_block * CONIC_BLOCK_EDGE, band->y, &look);
    if (look.texture)
      turn_to_texture(look.texture, &textured, &band->sums[i_block]);
    for (int part = 0; part < CONIC_PARTS; part++) {
      int at = part * CONIC_LANES;
      unsigned of_part = left >> at & ((1u << CONIC_LANES) - 1);
      if (!of_part)
        continue;
      index_lanes other = lanes_load_indices(block->record + at) ^ i_record;
      of_part &= ~lanes_bits(lanes_has_bits(other, ~0u));
      done |= of_part << at;
      if (of_part)
        add_part(&look, finish, lanes_load(rays->block_x[i_block] + at), lanes_load(rays->block_y[i_row] + at), part,
                 lanes_mask_of(of_part), &textured, &band->sums[i_block]);
    }
    left &= ~done;
  }
  if (textured.pixels)
    add_textured(&textured, &band->sums[i_block]);
}

static void triangles_add(conic_band *band, const conic_finish *finish, const conic_tile_rays *rays) {
  conic_triangle_row *row = band->triangles;
  conic_triangle_fetch_row(band);
  for (int block = 0; block < band->n_blocks; block++) {
    if (!row->visible[block])
      continue;
    if (conic_block_is_empty(band, block)) {
      memset(&band->sums[block], 0, sizeof band->sums[block]);
      band->n_kept[block] = 1;
      row->heaviest[block] = row->nearest[block] = row->visible[block];
    } else
      conic_triangle_rank_block(band, block);
    add_block(band, finish, rays, block);
  }
}
