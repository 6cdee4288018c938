/* The splats' passes a tile a work-item, a block's 16 pixels a vector: for CPUs. */
#include "opencl/lanes_tile.cl"

#include "raster/kernels/coverage_lanes.h"

/* So many references ahead records are called for. */
#define LANES_AHEAD 12

/* A reference's splat. */
typedef struct lanes_splat {
  uint index;
  int is_special;
  conic_footprint footprint;
  conic_ray ray;                                       /* of a ray */
  conic_clip_record clip;                              /* of one with clip lines */
  uint column_begin, column_last, row_begin, row_last; /* of the tile's blocks */
} lanes_splat;

static void lanes_fetch(__global const conic_device_reference *reference, __global const conic_footprint *footprints,
                        __global const conic_ray *rays, __global const conic_clip_record *clips, lanes_splat *splat) {
  uint blocks = reference->blocks;
  splat->index = reference->footprint;
  splat->footprint = footprints[splat->index];
  splat->is_special = !(splat->footprint.s3 > 0.0f);
  if (splat->footprint.s3 == 0.0f)
    splat->ray = rays[splat->footprint.i_ray];
  if (conic_is_clipped(&splat->footprint))
    splat->clip = clips[splat->index];
  splat->column_begin = blocks & 15;
  splat->column_last = blocks >> 4 & 15;
  splat->row_begin = blocks >> 8 & 15;
  splat->row_last = blocks >> 12;
}

/* In the rows from y on. */
static splat_rows lanes_begin(const conic_view *view, const lanes_splat *splat, int y) {
  splat_rows rows = begin_rows(&splat->footprint, rows_from(y));
  if (view->profile.table)
    begin_profile(view, &splat->footprint, &splat->ray, 0, &rows);
  return rows;
}

/* Its fragments in block (column, row) of the tile; 0 where it covers none of its pixels. */
static int lanes_cover(const conic_view *view, const lanes_tile *t, const lanes_splat *splat, const splat_rows *rows,
                       uint column, uint i_row, fragments *f) {
  int x = t->x + 4 * (int)column;
  fragments_at(view, view->support, &splat->footprint, &splat->ray, 0, &splat->clip, 0, rows, columns_from(x),
               view->profile.table ? SPLAT_PROFILED : splat->is_special ? SPLAT_SPECIAL : SPLAT_USUAL, f);
  if (t->is_at_border)
    f->covered &= lanes_inside(t, x, t->y + 4 * (int)i_row);
  return lanes_any(f->covered);
}

/* Goes through the tile's splats in order and, of each, through the blocks that it covers: `body` sees `splat`,
 * `fragment` and `block`. `before` and `after` are done for each reference i. */
#define LANES_FOR_FRAGMENTS(before, body, after)                                                                       \
  for (ulong i = tile_begin[t.index]; i < tile_begin[t.index + 1]; i++) {                                              \
    lanes_splat splat;                                                                                                 \
    CONIC_FETCH_AHEAD(&footprints[references[min(i + LANES_AHEAD, tile_begin[t.index + 1] - 1)].footprint]);           \
    before lanes_fetch(&references[i], footprints, rays, clips, &splat);                                               \
    for (uint i_row = splat.row_begin; i_row <= splat.row_last; i_row++) {                                             \
      splat_rows row = lanes_begin(&view, &splat, t.y + 4 * (int)i_row);                                  \
      for (uint column = splat.column_begin; column <= splat.column_last; column++) {                                  \
        uint block = CONIC_DEVICE_TILE_BLOCKS * i_row + column;                                                        \
        fragments fragment;                                                                                       \
        if (lanes_cover(&view, &t, &splat, &row, column, i_row, &fragment)) {                                          \
          body                                                                                                         \
        }                                                                                                              \
      }                                                                                                                \
    }                                                                                                                  \
    after                                                                                                              \
  }

/* The blocks of a tile as bits: those that a reference's box meets. */
static ulong lanes_box_mask(uint blocks) {
  ulong columns = ((ulong)2 << (blocks >> 4 & 15)) - ((ulong)1 << (blocks & 15)), mask = 0;
  for (uint row = blocks >> 8 & 15; row <= blocks >> 12; row++)
    mask |= columns << CONIC_DEVICE_TILE_BLOCKS * row;
  return mask;
}

/* conic_hiding_iz in the block whose first pixel is at (x, y). */
static lanes lanes_hiding_iz(const conic_footprint *footprint, const fragments *f, __global const float *columns,
                             __global const float *rows, int x, int y) {
  lanes iz = lanes_min(f->plane_iz, f->iz), ray_x, ray_y;
  if (!conic_is_wide(footprint))
    return footprint->nearness * iz;
  lanes_directions(columns, rows, x, y, &ray_x, &ray_y);
  return wide_hiding(footprint, iz, ray_lengths(ray_x, ray_y));
}

/* Pass 1. Of each reference it also notes in which blocks the splat may be seen, as far as those before it and itself
 * tell: thresholds only rise, so that pass 2 need not look at others. */
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void
lanes_visibility(GATHER_RECORDS, __global const float *columns, __global const float *rows, __global lanes *thresholds,
                 __global uint *n_fragments, __global ulong *masks) {
  conic_view view = view_of(frame_view, profile_table);
  conic_device_frame frame = *frame_constants;
  lanes_tile t = lanes_tile_of(&frame);
  lanes threshold[N_TILE_BLOCKS];
  index_lanes found = 0;
  for (uint block = 0; block < N_TILE_BLOCKS; block++)
    threshold[block] =
        frame.is_first && !frame.has_triangles ? (lanes)0.0f : thresholds[lanes_block(&t, &frame, block)];
  LANES_FOR_FRAGMENTS(
      ulong mask = 0;,
                     {
                       lanes offset_iz = lanes_hiding_iz(&splat.footprint, &fragment, columns, rows,
                                                         lanes_block_x(&t, block), lanes_block_y(&t, block));
                       threshold[block] =
                           (fragment.covered & (offset_iz > threshold[block])) ? offset_iz : threshold[block];
                       found = lanes_increment(fragment.covered, found);
                       int16 may_be_seen = fragment.covered & (lanes_max(fragment.plane_iz, fragment.iz) >= threshold[block]);
                       mask |= lanes_any(may_be_seen) ? (ulong)1 << block : 0;
                     },
                     masks[i] = mask;)
  for (uint block = 0; block < N_TILE_BLOCKS; block++)
    thresholds[lanes_block(&t, &frame, block)] = threshold[block];
  n_fragments[t.index] = sum_of_lanes(found);
}

static void lanes_blend(const conic_view *view, const lanes_splat *splat, __global const conic_projected_surface *surface,
                        const fragments *f, lanes_mask is_visible, lanes_sums *s) {
  lanes weight = weigh(view, splat->footprint.amplitude, f->q, f->scale, is_visible, kind_of_view(view));
  s->values[CONIC_SUM_WEIGHT] += weight;
  for (int axis = 0; axis < 3; axis++) {
    s->values[CONIC_SUM_COLOR + axis] += weight * surface->color[axis];
    s->values[CONIC_SUM_NORMAL + axis] += weight * surface->normal[axis];
  }
  int16 is_heaviest = s->values[CONIC_SUM_HEAVIEST_WEIGHT] < weight;
  s->values[CONIC_SUM_HEAVIEST_WEIGHT] = is_heaviest ? weight : s->values[CONIC_SUM_HEAVIEST_WEIGHT];
  s->taken = is_heaviest ? (int16)(int)splat->index : s->taken;
}

static void lanes_note(__global const conic_projected_surface *surface, const fragments *fragment, int16 is_visible,
                       lanes_sums *s) {
  int16 is_nearest = is_visible & (s->values[CONIC_SUM_NEAREST_IZ] < fragment->iz);
  s->values[CONIC_SUM_COUNT] = as_float16(as_int16(s->values[CONIC_SUM_COUNT]) - is_visible);
  s->values[CONIC_SUM_NEAREST_IZ] = is_nearest ? fragment->iz : s->values[CONIC_SUM_NEAREST_IZ];
  s->values[CONIC_SUM_ID] = as_float16(is_nearest ? (int16)(int)surface->index : as_int16(s->values[CONIC_SUM_ID]));
}

/* conic_plane_z of the splats taken, in the lanes that have one. */
static lanes lanes_plane_z(__global const conic_footprint *footprints, int16 taken, int x, int y) {
  lanes fields[16];
  for (int lane = 0; lane < 16; lane++) {
    int i_footprint = ((const int *)&taken)[lane];
    __global const float *from = (__global const float *)&footprints[i_footprint < 0 ? 0 : i_footprint];
    for (int field = 0; field < 16; field++)
      ((float *)&fields[field])[lane] = from[field];
  }
  lanes dx = (columns_from(x) - fields[0]) + fields[2], dy = (rows_from(y) - fields[1]) + fields[3];
  lanes iz = (fields[7] + fields[11] * dy) + fields[10] * dx;
  return 1.0f / lanes_min(lanes_max(iz, fields[12]), fields[13]);
}

/* What of each pixel's heaviest splat the picture shows beside the sums. Its normal only where the sum has no
 * direction, unless another part of the splats follows. */
static void lanes_keep_heaviest(const conic_device_frame *frame, __global const conic_footprint *footprints,
                                __global const conic_projected_surface *surfaces, int x, int y, lanes_sums *s) {
  int keeps_all = !frame->is_last || frame->keeps_sums;
  int16 is_taken = s->taken >= 0;
  lanes mean[3];
  if (!lanes_any(is_taken))
    return;
  if (keeps_all || frame->planes & 1 << CONIC_PLANE_Z)
    s->values[CONIC_SUM_Z] = is_taken ? lanes_plane_z(footprints, s->taken, x, y) : s->values[CONIC_SUM_Z];
  int16 needs_normal = keeps_all ? is_taken : is_taken & ~(lanes_mean_normal(s, mean) > 0.0f);
  if (!lanes_any(needs_normal))
    return;
  for (int lane = 0; lane < 16; lane++)
    for (int axis = 0; axis < 3 && ((const int *)&needs_normal)[lane]; axis++)
      ((float *)&s->values[CONIC_SUM_HEAVIEST_NORMAL + axis])[lane] =
          surfaces[((const int *)&s->taken)[lane]].normal[axis];
}

static void lanes_begin_sums(const conic_device_frame *frame, const lanes_tile *t, __global const lanes *sums,
                             lanes_sums *of_blocks) {
  /* Where all splats are in one part and nobody asks for counts or ids, only the first of the sums are looked at. */
  int needs_all = !frame->is_first || !frame->is_last || frame->keeps_sums || frame->is_single_pass ||
                  (frame->planes & (1 << CONIC_PLANE_COUNT | 1 << CONIC_PLANE_ID)) != 0;
  int n_used = needs_all ? CONIC_N_SUMS : CONIC_SUM_NEAREST_IZ;
  for (uint block = 0; block < N_TILE_BLOCKS; block++) {
    __global const lanes *from = sums + lanes_block(t, frame, block) * CONIC_N_SUMS;
    for (int i = 0; i < n_used; i++)
      of_blocks[block].values[i] = frame->is_first ? (lanes)0.0f : from[i];
    of_blocks[block].taken = -1;
  }
}

#include "opencl/lanes_resolve.cl"

/* Calls for what pass 2 reads of a reference's splat, where it reads any of it. */
static void lanes_call_for(__global const conic_device_reference *references, __global const ulong *masks, ulong i,
                           __global const conic_footprint *footprints, __global const conic_projected_surface *surfaces) {
  if (masks[i] == 0)
    return;
  CONIC_FETCH_AHEAD(&footprints[references[i].footprint]);
  CONIC_FETCH_AHEAD(&surfaces[references[i].footprint]);
}

/* Pass 2 and, with the last part of the splats, pass 3. Masks are those of pass 1 where all splats are in one part. */
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void lanes_accumulate(GATHER_RECORDS,
                                                                              __global const lanes *thresholds,
                                                                              __global lanes *sums, PIXEL_PLANES,
                                                                              __global const ulong *masks) {
  conic_view view = view_of(frame_view, profile_table);
  conic_device_frame frame = *frame_constants;
  lanes_tile t = lanes_tile_of(&frame);
  lanes threshold[N_TILE_BLOCKS];
  lanes_sums of_blocks[N_TILE_BLOCKS];
  int keeps_indices = (frame.planes & (1 << CONIC_PLANE_COUNT | 1 << CONIC_PLANE_ID)) != 0;
  int has_masks = frame.is_first && frame.is_last;
  ulong end = tile_begin[t.index + 1];
  for (uint block = 0; block < N_TILE_BLOCKS; block++)
    threshold[block] = thresholds[lanes_block(&t, &frame, block)];
  lanes_begin_sums(&frame, &t, sums, of_blocks);
  for (ulong i = tile_begin[t.index]; i < end; i++) {
    if (has_masks)
      lanes_call_for(references, masks, min(i + LANES_AHEAD, end - 1), footprints, surfaces);
    ulong mask = has_masks ? masks[i] : lanes_box_mask(references[i].blocks);
    if (mask == 0)
      continue;
    lanes_splat splat;
    splat_rows row;
    uint row_begun = CONIC_DEVICE_TILE_BLOCKS;
    __global const conic_projected_surface *surface = &surfaces[references[i].footprint];
    lanes_fetch(&references[i], footprints, rays, clips, &splat);
    for (; mask; mask &= mask - 1) {
      uint block = 63 - (uint)clz(mask & -mask), i_row = block / CONIC_DEVICE_TILE_BLOCKS;
      fragments fragment;
      if (i_row != row_begun)
        row = lanes_begin(&view, &splat, t.y + 4 * (int)i_row);
      row_begun = i_row;
      lanes_cover(&view, &t, &splat, &row, block % CONIC_DEVICE_TILE_BLOCKS, i_row, &fragment);
      int16 is_visible = fragment.covered & (lanes_max(fragment.plane_iz, fragment.iz) >= threshold[block]);
      if (!lanes_any(is_visible))
        continue;
      lanes_blend(&view, &splat, surface, &fragment, is_visible, &of_blocks[block]);
      if (keeps_indices)
        lanes_note(surface, &fragment, is_visible, &of_blocks[block]);
    }
  }
  for (uint block = 0; block < N_TILE_BLOCKS; block++)
    lanes_keep_heaviest(&frame, footprints, surfaces, lanes_block_x(&t, block), lanes_block_y(&t, block),
                        &of_blocks[block]);
  lanes_finish(&frame, &t, of_blocks, sums, PIXEL_PLANES_PASSED);
}

/* The nearest splats' own sums, in place of those of what was nearest in the parts before. */
static void lanes_take_nearest(const conic_view *view, const conic_device_frame *frame,
                               __global const conic_footprint *footprints, __global const conic_projected_surface *surfaces,
                               const lanes *q, const lanes *scale, int x, int y, lanes_sums *s) {
  for (int lane = 0; lane < 16; lane++) {
    int i_nearest = ((const int *)&s->taken)[lane], is_heaviest;
    if (i_nearest < 0)
      continue;
    conic_footprint footprint = footprints[i_nearest];
    conic_fragment nearest = {((const float *)q)[lane], 0.0f, 0.0f, ((const float *)scale)[lane]};
    gather_sums one = {0};
    gather_blend(view, &footprint, &surfaces[i_nearest], &nearest, &one, &is_heaviest);
    ((float *)&s->values[CONIC_SUM_WEIGHT])[lane] = one.weight;
    for (int axis = 0; axis < 3; axis++) {
      ((float *)&s->values[CONIC_SUM_COLOR + axis])[lane] = one.color[axis];
      ((float *)&s->values[CONIC_SUM_NORMAL + axis])[lane] = one.normal[axis];
    }
    ((float *)&s->values[CONIC_SUM_HEAVIEST_WEIGHT])[lane] = one.heaviest_weight;
    ((uint *)&s->values[CONIC_SUM_COUNT])[lane] = 1;
    ((uint *)&s->values[CONIC_SUM_ID])[lane] = surfaces[i_nearest].index;
  }
  lanes_keep_heaviest(frame, footprints, surfaces, x, y, s);
}

/* In place of both where the nearest splat wins alone. */
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void lanes_nearest(GATHER_RECORDS, __global uint *n_fragments,
                                                                           __global lanes *sums, PIXEL_PLANES) {
  conic_view view = view_of(frame_view, profile_table);
  conic_device_frame frame = *frame_constants;
  lanes_tile t = lanes_tile_of(&frame);
  lanes q[N_TILE_BLOCKS], scale[N_TILE_BLOCKS];
  lanes_sums of_blocks[N_TILE_BLOCKS];
  index_lanes found = 0;
  lanes_begin_sums(&frame, &t, sums, of_blocks);
  LANES_FOR_FRAGMENTS(
      , {
        lanes_sums *s = &of_blocks[block];
        int16 is_nearest = fragment.covered & (s->values[CONIC_SUM_NEAREST_IZ] < fragment.iz);
        s->values[CONIC_SUM_NEAREST_IZ] = is_nearest ? fragment.iz : s->values[CONIC_SUM_NEAREST_IZ];
        q[block] = is_nearest ? fragment.q : q[block];
        scale[block] = is_nearest ? fragment.scale : scale[block];
        s->taken = is_nearest ? (int16)(int)splat.index : s->taken;
        found = lanes_increment(fragment.covered, found);
      }, )
  n_fragments[t.index] = sum_of_lanes(found);
  for (uint block = 0; block < N_TILE_BLOCKS; block++)
    lanes_take_nearest(&view, &frame, footprints, surfaces, &q[block], &scale[block], lanes_block_x(&t, block),
                       lanes_block_y(&t, block), &of_blocks[block]);
  lanes_finish(&frame, &t, of_blocks, sums, PIXEL_PLANES_PASSED);
}
