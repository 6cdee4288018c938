/* The plain C reference of the triangles' slots: a sample at a time. */
#include "raster/triangle_tile.h"

#include <math.h>
#include <string.h>

#include "raster/coverage.h"
#include "raster/triangle_pixel.h"

void conic_triangle_tile_row(const conic_triangle_frame *frame, conic_triangle_tile *tile, int i_row,
                             conic_band *band) {
  uint32_t any = 0;
  for (int block = 0; block < band->n_blocks; block++)
    any |= tile->covered[i_row][block];
  band->triangles = any ? &tile->row : NULL;
  band->triangle_frame = frame;
  if (!any)
    return;
  memset(&tile->row, 0, sizeof tile->row);
  tile->row.blocks = tile->blocks[i_row];
  memcpy(tile->row.covered, tile->covered[i_row], sizeof tile->row.covered);
}

unsigned conic_triangle_draw_samples(const conic_triangle_frame *frame, uint32_t i_record, int x, int y,
                                     conic_triangle_tile *tile) {
  const conic_triangle_record *record = &frame->records[i_record];
  const conic_box *box = &record->box;
  int x_begin = box->x_begin > x ? box->x_begin : x, y_begin = box->y_begin > y ? box->y_begin : y;
  int x_end = box->x_end < x + frame->tile ? box->x_end : x + frame->tile;
  int y_end = box->y_end < y + frame->tile ? box->y_end : y + frame->tile;
  unsigned n_covered = 0;
  conic_triangle_edges edges;
  conic_triangle_edges_of(record, &edges);
  for (int j = y_begin; j < y_end; j++)
    for (int i = x_begin; i < x_end; i++) {
      float iz;
      if (!conic_triangle_covers(record, &edges, i, j, &iz))
        continue;
      conic_triangle_block *block = &tile->blocks[(j - y) / CONIC_BLOCK_EDGE][(i - x) / CONIC_BLOCK_EDGE];
      int l = i % CONIC_BLOCK_EDGE * CONIC_BLOCK_EDGE + j % CONIC_BLOCK_EDGE;
      n_covered++;
      if (!(block->iz[l] < iz))
        continue;
      block->iz[l] = iz;
      block->record[l] = i_record;
    }
  return n_covered;
}

void conic_triangles_draw(const conic_triangle_frame *frame, size_t i_tile, int x, int y, conic_triangle_tile *tile) {
  tile->n_fragments = 0;
  memset(tile->covered, 0, sizeof tile->covered);
  memset(tile->blocks, 0, sizeof tile->blocks);
  for (size_t i = 0; i < frame->n_chunks; i++) {
    const conic_triangle_chunk *chunk = &frame->chunks[i];
    const uint32_t *begin = frame->tile_begin + i * (frame->n_tiles + 1) + i_tile;
    const uint32_t *entries = frame->entries + chunk->first_entry;
    for (uint32_t k = begin[0]; k < begin[1]; k++)
      tile->n_fragments += conic_triangle_draw_samples(frame, (uint32_t)chunk->first_record + entries[k], x, y, tile);
  }
  for (int i_row = 0; i_row < CONIC_BAND_BLOCKS; i_row++)
    for (int block = 0; block < CONIC_BAND_BLOCKS; block++)
      for (int l = 0; l < CONIC_BLOCK_PIXELS; l++)
        tile->covered[i_row][block] |= tile->blocks[i_row][block].iz[l] > 0.0f ? 1u << l : 0u;
}

void conic_triangles_hide(conic_band *band, const conic_tile_rays *rays) {
  conic_triangle_row *row = band->triangles;
  int i_row = (band->y - rays->y_begin) / CONIC_BLOCK_EDGE;
  float epsilon = band->triangle_frame->epsilon;
  for (int block = 0; block < band->n_blocks; block++) {
    row->visible[block] = row->covered[block];
    if (!row->covered[block] || conic_block_is_empty(band, block))
      continue;
    float *threshold = band->kept[block].threshold;
    for (int l = 0; l < CONIC_BLOCK_PIXELS; l++) {
      if (!(row->covered[block] >> l & 1))
        continue;
      float iz = row->blocks[block].iz[l], dx = rays->block_x[block][l], dy = rays->block_y[i_row][l];
      float hides = iz * (1.0f / (1.0f + epsilon * iz / sqrtf((dx * dx + dy * dy) + 1.0f)));
      if (!(iz >= threshold[l]))
        row->visible[block] &= ~(1u << l);
      threshold[l] = hides > threshold[l] ? hides : threshold[l];
    }
  }
}

void conic_triangles_win(conic_band *band) {
  conic_triangle_row *row = band->triangles;
  for (int block = 0; block < band->n_blocks; block++) {
    row->visible[block] = row->covered[block];
    if (!row->covered[block] || conic_block_is_empty(band, block))
      continue;
    for (int l = 0; l < CONIC_BLOCK_PIXELS; l++) {
      size_t at;
      const conic_nearest_strip *strip = conic_strip_of(band, block, l, &at);
      if (!(row->blocks[block].iz[l] > strip->iz[at])) {
        row->visible[block] &= ~(1u << l);
        continue;
      }
      conic_block_sums *sums = &band->sums[block];
      sums->weight[l] = 0.0f;
      sums->count[l] = 0;
      for (int axis = 0; axis < 3; axis++)
        sums->color[axis][l] = sums->normal[axis][l] = 0.0f;
    }
  }
}

static void rank(const conic_band *band, int block, int l, int *is_heaviest, int *is_nearest) {
  const conic_block_sums *sums = &band->sums[block];
  int x = band->x + block * CONIC_BLOCK_EDGE + l / CONIC_BLOCK_EDGE, y = band->y + l % CONIC_BLOCK_EDGE;
  conic_fragment fragment;
  *is_heaviest = *is_nearest = 1;
  if (!(sums->weight[l] > 0.0f))
    return;
  const conic_footprint *heaviest = &band->projected->footprints[sums->heaviest[l]];
  if (conic_fragment_at(band->view, band->projected, heaviest, x, y, &fragment))
    *is_heaviest = 1.0f > conic_final_weight(band->view, heaviest, fragment.q, fragment.scale);
  if (!band->keeps_indices)
    return;
  const conic_footprint *nearest = &band->projected->footprints[sums->nearest[l]];
  if (conic_fragment_at(band->view, band->projected, nearest, x, y, &fragment))
    *is_nearest = band->triangles->blocks[block].iz[l] > fragment.iz;
}

void conic_triangle_rank_block(const conic_band *band, int block) {
  conic_triangle_row *row = band->triangles;
  for (int l = 0; l < CONIC_BLOCK_PIXELS; l++) {
    int is_heaviest, is_nearest;
    if (!(row->visible[block] >> l & 1))
      continue;
    rank(band, block, l, &is_heaviest, &is_nearest);
    row->heaviest[block] |= (uint32_t)is_heaviest << l;
    row->nearest[block] |= (uint32_t)is_nearest << l;
  }
}

static void add_pixel(conic_band *band, const conic_finish *finish, const conic_tile_rays *rays, int block, int l) {
  conic_block_sums *sums = &band->sums[block];
  const conic_triangle_record *record = &band->triangle_frame->records[band->triangles->blocks[block].record[l]];
  int i_row = (band->y - rays->y_begin) / CONIC_BLOCK_EDGE;
  conic_triangle_look look;
  conic_triangle_weights weights;
  float color[3], normal[3];
  conic_triangle_look_at(band->triangle_frame, record, band->x + block * CONIC_BLOCK_EDGE, band->y, &look);
  conic_triangle_weights_at(&look, (float)(l / CONIC_BLOCK_EDGE), (float)(l % CONIC_BLOCK_EDGE), &weights);
  conic_triangle_color_at(&look, &weights, color);
  conic_triangle_normal_at(&look, &weights, finish->world_from_cam, rays->block_x[block][l], rays->block_y[i_row][l],
                           normal);
  sums->weight[l] += 1.0f;
  sums->count[l]++;
  float size = 0.0f;
  for (int axis = 0; axis < 3; axis++) {
    sums->color[axis][l] += color[axis];
    sums->normal[axis][l] += normal[axis];
    size += fabsf(sums->normal[axis][l]);
  }
  for (int axis = 0; axis < 3 && !(size > 0.0f); axis++)
    sums->normal[axis][l] = normal[axis] * CONIC_LEAST_WEIGHT;
}

void conic_triangles_add(conic_band *band, const conic_finish *finish, const conic_tile_rays *rays) {
  conic_triangle_row *row = band->triangles;
  for (int block = 0; block < band->n_blocks; block++) {
    if (!row->visible[block])
      continue;
    if (conic_block_is_empty(band, block)) {
      memset(&band->sums[block], 0, sizeof band->sums[block]);
      band->n_kept[block] = 1;
    }
    conic_triangle_rank_block(band, block);
    for (int l = 0; l < CONIC_BLOCK_PIXELS; l++)
      if (row->visible[block] >> l & 1)
        add_pixel(band, finish, rays, block, l);
  }
}
