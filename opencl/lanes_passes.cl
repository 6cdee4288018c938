/* Visibility and accumulation of a tile's splats, one row of its blocks after the other: raster/loops/pass_body.h in
 * its order of arithmetic. */

/* The fragments of so many splats are kept for a block from the first pass to the second; those of further ones, and
 * all where counts or ids are wanted, are evaluated again. */
#define LANES_KEPT 256

/* Of a kept splat's index: it has a scale of its own. */
#define LANES_SCALED 0x80000000u

/* So many kept splats ahead surfaces are called for. */
#define LANES_SURFACES_AHEAD 8

/* A block between the passes. The last place is for what is not kept. */
typedef struct lanes_kept {
  lanes threshold;
  lanes q[LANES_KEPT + 1], seen_iz[LANES_KEPT + 1]; /* -1 where not covered */
  lanes scale[LANES_KEPT + 1];
  uint index[LANES_KEPT + 1];
  uint n, not_kept; /* of the row's list: the first that covers a pixel here and is not kept */
} lanes_kept;

/* A tile's references that meet a row of its blocks, in order. */
typedef struct lanes_list {
  __global uint *footprints, *blocks;
  uint n;
} lanes_list;

/* A row of a tile's blocks; the last one is beside it, for splats that have no second block. */
typedef struct lanes_band {
  uint row;
  lanes x[CONIC_DEVICE_TILE_BLOCKS + 1], y; /* NaN outside of the image, where nothing is covered then */
  lanes_list list;
  uint room;
  index_lanes found;
  lanes_kept blocks[CONIC_DEVICE_TILE_BLOCKS + 1];
} lanes_band;

static lanes lanes_within(lanes pixels, int size) {
  return pixels < (float)size ? pixels : (lanes)nan(0u);
}

static void lanes_begin_band(const conic_device_frame *frame, const lanes_tile *t, uint row,
                             __global const lanes *thresholds, lanes_band *band) {
  int has_thresholds = !frame->is_first || frame->has_triangles || !(frame->walks & CONIC_WALK_VISIBILITY);
  int is_kept = (frame->planes & (1 << CONIC_PLANE_COUNT | 1 << CONIC_PLANE_ID)) == 0;
  band->row = row;
  band->y = lanes_within(rows_from(t->y + 4 * (int)row), t->height);
  band->room = is_kept && frame->walks == (CONIC_WALK_VISIBILITY | CONIC_WALK_ACCUMULATE) ? LANES_KEPT : 0;
  for (uint column = 0; column <= CONIC_DEVICE_TILE_BLOCKS; column++) {
    lanes_kept *kept = &band->blocks[column];
    int is_beside = column == CONIC_DEVICE_TILE_BLOCKS;
    band->x[column] = lanes_within(columns_from(t->x + 4 * (int)column), is_beside ? 0 : t->width);
    kept->threshold = has_thresholds && !is_beside
                          ? thresholds[lanes_block(t, frame, CONIC_DEVICE_TILE_BLOCKS * row + column)]
                          : (lanes)0.0f;
    kept->n = 0;
    kept->not_kept = frame->walks & CONIC_WALK_VISIBILITY ? UINT_MAX : 0;
  }
}

/* In the memory that the tile's references have in `selected`. */
static lanes_list lanes_select_row(__global const conic_device_reference *references, ulong begin, ulong end, uint row,
                                   __global uint *selected) {
  lanes_list list = {selected + 2 * begin, selected + begin + end, 0};
  ulong i = begin;
  for (; i + 16 <= end; i += 16) {
    index_lanes first = vload16(0, (__global const uint *)(references + i));
    index_lanes second = vload16(0, (__global const uint *)(references + i + 8));
    index_lanes blocks = (index_lanes)(first.odd, second.odd);
    lanes_mask meets = ((blocks >> 8 & 15) <= row) & (row <= blocks >> 12);
    vstore16(CONIC_LANES_PACK(meets, (index_lanes)(first.even, second.even)), 0, list.footprints + list.n);
    vstore16(CONIC_LANES_PACK(meets, blocks), 0, list.blocks + list.n);
    list.n += popcount(lanes_bits(meets));
  }
  for (; i < end; i++) {
    conic_device_reference reference = references[i];
    list.footprints[list.n] = reference.footprint;
    list.blocks[list.n] = reference.blocks;
    list.n += ((reference.blocks >> 8 & 15) <= row) & (row <= reference.blocks >> 12);
  }
  return list;
}

/* Raises the thresholds of a block and keeps its fragments. */
CONIC_INLINE void lanes_pass_block(lanes_band *band, uint column, uint i, uint index, lanes hides, int has_scale,
                             const fragments *f) {
  lanes_kept *kept = &band->blocks[column];
  uint place = kept->n, is_covered = lanes_any(f->covered);
  kept->threshold = lanes_max(lanes_keep(f->covered, hides), kept->threshold);
  kept->q[place] = f->q;
  kept->seen_iz[place] = lanes_select(f->covered, lanes_max(f->plane_iz, f->iz), (lanes)-1.0f);
  kept->index[place] = index;
  if (has_scale)
    kept->scale[place] = f->scale;
  band->found = lanes_increment(f->covered, band->found);
  if (place < band->room)
    kept->n = place + is_covered;
  else if (is_covered)
    kept->not_kept = min(kept->not_kept, i);
}

/* An ellipse that is neither wide nor clipped nor has a profile, in one block. */
CONIC_INLINE void lanes_pass_usual(const conic_view *view, lanes_band *band, uint column, uint i, uint index,
                                   float nearness, const splat_rows *rows) {
  fragments f;
  ellipse_fragments(view, rows, view->support, SPLAT_USUAL, (band->x[column] - rows->x) + rows->dx0, &f);
  lanes_pass_block(band, column, i, index, nearness * lanes_min(f.plane_iz, f.iz), 0, &f);
}

/* Whatever the splat is. */
static void lanes_pass_special(const conic_view *view, const lanes_tile *t, lanes_band *band,
                               const lanes_splat *splat, uint i, __global const float *columns,
                               __global const float *rows) {
  splat_rows of_rows = lanes_begin(view, splat, band->y);
  for (uint column = splat->column_begin; column <= splat->column_last; column++) {
    fragments f;
    lanes_cover(view, splat, &of_rows, band->x[column], &f);
    lanes hides =
        lanes_hiding_iz(&splat->footprint, &f, columns, rows, t->x + 4 * (int)column, t->y + 4 * (int)band->row);
    lanes_pass_block(band, column, i, splat->index | LANES_SCALED, hides, 1, &f);
  }
}

/* Pass 1 of a row. Two blocks of a usual splat are done in any case, the second perhaps beside the row: most have one
 * or two, and which, no branch can foresee. */
static void lanes_pass_row(const conic_view *view, const lanes_tile *t, __global const conic_footprint *footprints,
                           __global const conic_ray *rays, __global const conic_clip_record *clips,
                           __global const float *columns, __global const float *rows, lanes_band *band) {
  lanes_list list = band->list;
  for (uint i = 0; i < list.n; i++) {
    uint index = list.footprints[i], blocks = list.blocks[i], first = blocks & 15, last = blocks >> 4 & 15;
    CONIC_FETCH_AHEAD(&footprints[list.footprints[min(i + LANES_AHEAD, list.n - 1)]]);
    conic_footprint footprint = footprints[index];
    if (view->profile.table || !(footprint.s3 > 0.0f) || !(footprint.nearness > 0.0f)) {
      lanes_splat splat;
      lanes_fetch(list.footprints[i], list.blocks[i], footprints, rays, clips, &splat);
      lanes_pass_special(view, t, band, &splat, i, columns, rows);
      continue;
    }
    splat_rows of_rows = begin_rows(&footprint, band->y);
    lanes_pass_usual(view, band, first, i, index, footprint.nearness, &of_rows);
    uint second = last > first ? first + 1 : CONIC_DEVICE_TILE_BLOCKS;
    lanes_pass_usual(view, band, second, i, index, footprint.nearness, &of_rows);
    for (uint column = first + 2; column <= last; column++)
      lanes_pass_usual(view, band, column, i, index, footprint.nearness, &of_rows);
  }
}

CONIC_INLINE void lanes_blend(const conic_view *view, kernel_kind kind, uint index, float amplitude,
                              __global const conic_projected_surface *surface, lanes q, lanes scale,
                              lanes_mask is_visible, lanes_sums *s) {
  lanes weight = weigh(view, amplitude, q, scale, is_visible, kind);
  s->values[CONIC_SUM_WEIGHT] += weight;
#pragma unroll
  for (int axis = 0; axis < 3; axis++) {
    s->values[CONIC_SUM_COLOR + axis] += weight * surface->color[axis];
    s->values[CONIC_SUM_NORMAL + axis] += weight * surface->normal[axis];
  }
  int16 is_heaviest = s->values[CONIC_SUM_HEAVIEST_WEIGHT] < weight;
  s->values[CONIC_SUM_HEAVIEST_WEIGHT] = is_heaviest ? weight : s->values[CONIC_SUM_HEAVIEST_WEIGHT];
  s->taken = is_heaviest ? (int16)(int)index : s->taken;
}

/* Pass 2 of what a block has kept. The sums are copied, so that they stay in registers. */
CONIC_INLINE void lanes_blend_kept(const conic_view *view, kernel_kind kind, const lanes_kept *kept,
                                   __global const conic_projected_surface *surfaces, lanes_sums *to) {
  lanes_sums s;
  lanes threshold = kept->threshold;
#pragma unroll
  for (int i = 0; i < CONIC_SUM_NEAREST_IZ; i++)
    s.values[i] = to->values[i];
  s.taken = to->taken;
  for (uint i = 0; i < kept->n; i++) {
    uint index = kept->index[i] & ~LANES_SCALED;
    CONIC_FETCH_AHEAD(&surfaces[kept->index[min(i + LANES_SURFACES_AHEAD, kept->n - 1)] & ~LANES_SCALED]);
    lanes_mask is_visible = kept->seen_iz[i] >= threshold;
    if (!lanes_any(is_visible))
      continue;
    lanes scale = kept->index[i] & LANES_SCALED ? kept->scale[i] : (lanes)1.0f;
    lanes_blend(view, kind, index, surfaces[index].amplitude, &surfaces[index], kept->q[i], scale, is_visible, &s);
  }
#pragma unroll
  for (int i = 0; i < CONIC_SUM_NEAREST_IZ; i++)
    to->values[i] = s.values[i];
  to->taken = s.taken;
}

static void lanes_note(__global const conic_projected_surface *surface, const fragments *fragment, int16 is_visible,
                       lanes_sums *s) {
  int16 is_nearest = is_visible & (s->values[CONIC_SUM_NEAREST_IZ] < fragment->iz);
  s->values[CONIC_SUM_COUNT] = as_float16(as_int16(s->values[CONIC_SUM_COUNT]) - is_visible);
  s->values[CONIC_SUM_NEAREST_IZ] = is_nearest ? fragment->iz : s->values[CONIC_SUM_NEAREST_IZ];
  s->values[CONIC_SUM_ID] = as_float16(is_nearest ? (int16)(int)surface->index : as_int16(s->values[CONIC_SUM_ID]));
}

/* Pass 2 of what was not kept in the row, splat by splat. */
static void lanes_blend_rest(const conic_view *view, const conic_device_frame *frame, const lanes_band *band,
                             __global const conic_footprint *footprints,
                             __global const conic_projected_surface *surfaces, __global const conic_ray *rays,
                             __global const conic_clip_record *clips, lanes_sums *to) {
  int keeps_indices = (frame->planes & (1 << CONIC_PLANE_COUNT | 1 << CONIC_PLANE_ID)) != 0;
  uint first = UINT_MAX;
  for (uint column = 0; column < CONIC_DEVICE_TILE_BLOCKS; column++)
    first = min(first, band->blocks[column].not_kept);
  lanes_list list = band->list;
  for (uint i = first; i < list.n; i++) {
    lanes_splat splat;
    lanes_fetch(list.footprints[i], list.blocks[i], footprints, rays, clips, &splat);
    splat_rows rows = lanes_begin(view, &splat, band->y);
    for (uint column = splat.column_begin; column <= splat.column_last; column++) {
      fragments f;
      if (i < band->blocks[column].not_kept)
        continue;
      lanes_cover(view, &splat, &rows, band->x[column], &f);
      int16 is_visible = f.covered & (lanes_max(f.plane_iz, f.iz) >= band->blocks[column].threshold);
      if (!lanes_any(is_visible))
        continue;
      lanes_blend(view, kind_of_view(view), splat.index, splat.footprint.amplitude, &surfaces[splat.index], f.q,
                  f.scale, is_visible, &to[column]);
      if (keeps_indices)
        lanes_note(&surfaces[splat.index], &f, is_visible, &to[column]);
    }
  }
}
