/* The plain C reference of the triangles' slots: a sample at a time. */
#include "raster/triangles/triangle_tile.h"

#include "raster/tiles/coverage.h"

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

conic_triangle_canvas conic_triangle_canvas_of(const conic_triangle_frame *frame, int x, int y,
                                               conic_triangle_tile *tile) {
  return (conic_triangle_canvas){tile->blocks[0],    CONIC_BAND_BLOCKS,  x, y, frame->tile,
                                 frame->view->width, frame->view->height};
}

void conic_triangles_draw(const conic_triangle_frame *frame, size_t i_tile, int x, int y, conic_triangle_tile *tile) {
  const conic_triangle_canvas canvas = conic_triangle_canvas_of(frame, x, y, tile);
  tile->n_fragments = 0;
  memset(tile->covered, 0, sizeof tile->covered);
  memset(tile->blocks, 0, sizeof tile->blocks);
  for (size_t i = 0; i < frame->n_chunks; i++) {
    const conic_triangle_chunk *chunk = &frame->chunks[i];
    const uint32_t *begin = frame->tile_begin + i * (frame->n_tiles + 1) + i_tile;
    const uint32_t *entries = frame->entries + chunk->first_entry;
    for (uint32_t k = begin[0]; k < begin[1]; k++) {
      uint32_t i_record = (uint32_t)chunk->first_record + entries[k];
      tile->n_fragments += conic_triangle_draw_samples(&frame->records[i_record], i_record, &canvas);
    }
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
      float hides = conic_triangle_hides(epsilon, iz, dx, dy);
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
      if (!(row->blocks[block].iz[l] > band->nearest->iz[conic_nearest_place(band, block, l)])) {
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

/* Lists the records that a row sees, each once or little more often. */
static int list_records(const conic_band *band, uint32_t records[CONIC_BAND_BLOCKS * CONIC_BLOCK_PIXELS]) {
  int n = 0;
  uint32_t last = UINT32_MAX;
  for (int block = 0; block < band->n_blocks; block++)
    for (uint32_t left = band->triangles->visible[block]; left; left &= left - 1) {
      uint32_t i_record = band->triangles->blocks[block].record[__builtin_ctz(left)];
      records[n] = i_record;
      n += i_record != last;
      last = i_record;
    }
  return n;
}

void conic_triangle_fetch_row(const conic_band *band) {
  const conic_triangle_frame *frame = band->triangle_frame;
  const conic_triangles *t = frame->triangles;
  uint32_t records[CONIC_BAND_BLOCKS * CONIC_BLOCK_PIXELS + 1];
  int n = list_records(band, records);
  if (n <= 2 * CONIC_BAND_BLOCKS)
    return;
  for (int i = 0; i < n; i++)
    __builtin_prefetch(t->corners[frame->records[records[i]].index]);
  for (int i = 0; i < n; i++) {
    const uint32_t *corners = t->corners[frame->records[records[i]].index];
    for (int k = 0; k < 3; k++)
      for (int axis = 0; axis < 3; axis++) {
        __builtin_prefetch(&t->position[axis][corners[k]]);
        if (t->normal[0] && !t->normal_corners)
          __builtin_prefetch(&t->normal[axis][corners[k]]);
        if (t->color[0])
          __builtin_prefetch(&t->color[axis][corners[k]]);
      }
  }
}

void conic_triangle_see_pixel(const conic_band *band, const conic_finish *finish, const conic_tile_rays *rays,
                              int block, int l, conic_triangle_sight *sight) {
  const conic_triangle_record *record = &band->triangle_frame->records[band->triangles->blocks[block].record[l]];
  int i_row = (band->y - rays->y_begin) / CONIC_BLOCK_EDGE;
  const float ray[2] = {rays->block_x[block][l], rays->block_y[i_row][l]};
  conic_triangle_see(band->triangle_frame, record, finish->world_from_cam,
                     band->x + block * CONIC_BLOCK_EDGE + l / CONIC_BLOCK_EDGE, band->y + l % CONIC_BLOCK_EDGE, ray,
                     sight);
}

void conic_triangle_add_sight(const conic_triangle_sight *sight, int l, conic_block_sums *sums) {
  sums->weight[l] += 1.0f;
  sums->count[l]++;
  for (int channel = 0; channel < 3 && !sight->texture; channel++)
    sums->color[channel][l] += sight->color[channel];
  float size = 0.0f;
  for (int axis = 0; axis < 3; axis++) {
    sums->normal[axis][l] += sight->normal[axis];
    size += fabsf(sums->normal[axis][l]);
  }
  for (int axis = 0; axis < 3 && !(size > 0.0f); axis++)
    sums->normal[axis][l] = sight->normal[axis] * CONIC_LEAST_WEIGHT;
}

/* Adds the triangle that pixel l of the block sees to its sums. */
static void add_pixel(conic_band *band, const conic_finish *finish, const conic_tile_rays *rays, int block, int l) {
  conic_triangle_sight sight;
  conic_triangle_see_pixel(band, finish, rays, block, l, &sight);
  conic_triangle_lay_texture(&sight);
  conic_triangle_add_sight(&sight, l, &band->sums[block]);
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
