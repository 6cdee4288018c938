/* The triangles' slots in lanes: the operations of triangle_vertices.c and triangle_tile.c in the same order. Included
 * by raster_loops_body.h. */
#include "core/lanes/lanes_double.h"
#include "raster/loops/texture_body.h"
#include "raster/triangles/draw_lanes.h"
#include "raster/triangles/look_lanes.h"
#include "raster/triangles/triangle_look.h"
#include "raster/triangles/triangle_pixel.h"
#include "raster/triangles/triangle_tile.h"

/* The bits where the mask holds. */
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

CONIC_INLINE uint32_t covered_bits(const conic_triangle_block *block) {
  uint32_t bits = 0;
  for (int part = 0; part < CONIC_PARTS; part++)
    bits |= lanes_bits(lanes_less(lanes_of(0.0f), lanes_load(block->iz + (size_t)part * CONIC_LANES)))
            << (part * CONIC_LANES);
  return bits;
}

static void triangles_draw(const conic_triangle_frame *frame, size_t i_tile, int x, int y, conic_triangle_tile *tile) {
  enum { AHEAD = 8 };
  const conic_triangle_canvas canvas = conic_triangle_canvas_of(frame, x, y, tile);
  uint64_t n_fragments = 0;
  memset(tile->covered, 0, sizeof tile->covered);
  memset(tile->blocks, 0, sizeof tile->blocks);
  for (size_t i = 0; i < frame->n_chunks; i++) {
    const conic_triangle_chunk *chunk = &frame->chunks[i];
    const uint32_t *begin = frame->tile_begin + i * (frame->n_tiles + 1) + i_tile;
    const uint32_t *entries = frame->entries + chunk->first_entry;
    for (uint32_t k = begin[0]; k < begin[1]; k++) {
      uint32_t i_record = (uint32_t)chunk->first_record + entries[k];
      const conic_triangle_record *record = &frame->records[i_record];
      __builtin_prefetch(&frame->records[chunk->first_record + entries[k + AHEAD < begin[1] ? k + AHEAD : k]]);
      n_fragments += has_few_samples(&record->box) ? conic_triangle_draw_samples(record, i_record, &canvas)
                                                   : draw_blocks(record, i_record, &canvas);
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

CONIC_INLINE void note_part(const conic_triangle_look *look, const look_places *p, int part, lanes_mask mask,
                            const lanes color[3], textured_pixels *t) {
  size_t at = (size_t)part * CONIC_LANES;
  for (int i = 0; i < 2; i++) {
    lanes uv, along, across;
    find_texture_places(look, p, i, &uv, &along, &across);
    lanes_replace(t->places.uv[i] + at, mask, uv);
    lanes_replace(t->places.along[i] + at, mask, along);
    lanes_replace(t->places.across[i] + at, mask, across);
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
  lanes columns = lanes_of_ints(part_columns(part)), rows = lanes_of_ints(lanes_rows()), color[3], normal[3], sum[3],
        size = lanes_of(0.0f);
  look_places p;
  find_places(look, columns, rows, &p);
  find_colors(look, &p, color);
  if (look->texture)
    note_part(look, &p, part, mask, color, textured);
  else
    add_colors(color, part, mask, sums);
  find_normals(look, &p, finish->world_from_cam, dx, dy, normal);
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
