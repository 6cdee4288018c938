/* The splats' passes a tile a work-item, a block's 16 pixels a vector: for CPUs. */
#include "opencl/lanes_tile.cl"

#include "raster/loops/coverage_lanes.h"

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

static void lanes_fetch(uint index, uint blocks, __global const conic_footprint *footprints,
                        __global const conic_ray *rays, __global const conic_clip_record *clips, lanes_splat *splat) {
  splat->index = index;
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

/* In the rows y, where no NaN is one. */
static splat_rows lanes_begin(const conic_view *view, const lanes_splat *splat, lanes y) {
  splat_rows rows = begin_rows(&splat->footprint, y);
  if (view->profile.table)
    begin_profile(view, &splat->footprint, &splat->ray, 0, &rows);
  return rows;
}

/* Its fragments in a block's columns x, where no NaN is one; 0 where it covers none of its pixels. */
static int lanes_cover(const conic_view *view, const lanes_splat *splat, const splat_rows *rows, lanes x,
                       fragments *f) {
  fragments_at(view, view->support, &splat->footprint, &splat->ray, 0, &splat->clip, 0, rows, x,
               view->profile.table ? SPLAT_PROFILED : splat->is_special ? SPLAT_SPECIAL : SPLAT_USUAL, f);
  return lanes_any(f->covered);
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

#include "opencl/lanes_passes.cl"

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

/* The sums of one of a tile's blocks, as they begin. */
static void lanes_begin_sums(const conic_device_frame *frame, const lanes_tile *t, uint block,
                             __global const lanes *sums, lanes_sums *s) {
  /* Where all splats are in one part and nobody asks for counts or ids, only the first of the sums are looked at. */
  int needs_all = !frame->is_first || !frame->is_last || frame->keeps_sums || frame->is_single_pass ||
                  (frame->planes & (1 << CONIC_PLANE_COUNT | 1 << CONIC_PLANE_ID)) != 0;
  int n_used = needs_all ? CONIC_N_SUMS : CONIC_SUM_NEAREST_IZ;
  __global const lanes *from = sums + lanes_block(t, frame, block) * CONIC_N_SUMS;
  for (int i = 0; i < n_used; i++)
    s->values[i] = frame->is_first ? (lanes)0.0f : from[i];
  s->taken = -1;
}

#include "opencl/lanes_resolve.cl"

/* Pass 2 and, with the last part of the splats, pass 3 of a row; returns how many pixels are covered. */
static uint lanes_accumulate_row(const conic_view *view, const conic_device_frame *frame, const lanes_tile *t,
                                 const lanes_band *band, __global const conic_footprint *footprints,
                                 __global const conic_projected_surface *surfaces, __global const conic_ray *rays,
                                 __global const conic_clip_record *clips, __global lanes *sums, PIXEL_PLANES) {
  lanes_sums of_blocks[CONIC_DEVICE_TILE_BLOCKS];
  uint first = CONIC_DEVICE_TILE_BLOCKS * band->row, n = 0;
  kernel_kind kind = kind_of_view(view);
  for (uint column = 0; column < CONIC_DEVICE_TILE_BLOCKS; column++) {
    lanes_begin_sums(frame, t, first + column, sums, &of_blocks[column]);
    if (kind == KERNEL_NARROW_GAUSS)
      lanes_blend_kept(view, KERNEL_NARROW_GAUSS, &band->blocks[column], surfaces, &of_blocks[column]);
    else
      lanes_blend_kept(view, kind, &band->blocks[column], surfaces, &of_blocks[column]);
  }
  lanes_blend_rest(view, frame, band, footprints, surfaces, rays, clips, of_blocks);
  for (uint column = 0; column < CONIC_DEVICE_TILE_BLOCKS; column++) {
    lanes_keep_heaviest(frame, footprints, surfaces, t->x + 4 * (int)column, t->y + 4 * (int)band->row,
                        &of_blocks[column]);
    n += lanes_finish(frame, t, first + column, &of_blocks[column], sums, PIXEL_PLANES_PASSED);
  }
  return n;
}

/* The passes that the frame says, one or both. */
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void
lanes_passes(GATHER_RECORDS, __global lanes *thresholds, __global uint *n_fragments,
             __global uint *selected, __global lanes *sums, PIXEL_PLANES) {
  conic_view view = view_of(frame_view, profile_table);
  conic_device_frame frame = *frame_constants;
  lanes_tile t = lanes_tile_of(&frame);
  ulong begin = tile_begin[t.index], end = tile_begin[t.index + 1];
  int does_both = frame.walks == (CONIC_WALK_VISIBILITY | CONIC_WALK_ACCUMULATE);
  lanes_band band;
  uint covered = 0;
  band.found = 0;
  for (uint row = 0; row < CONIC_DEVICE_TILE_BLOCKS && t.y + 4 * (int)row < frame.height; row++) {
    lanes_begin_band(&frame, &t, row, thresholds, &band);
    band.list = lanes_select_row(references, begin, end, row, selected);
    if (frame.walks & CONIC_WALK_VISIBILITY)
      lanes_pass_row(&view, &t, footprints, rays, clips, columns, rows, &band);
    for (uint column = 0; column < CONIC_DEVICE_TILE_BLOCKS && (!does_both || frame.has_triangles); column++)
      thresholds[lanes_block(&t, &frame, CONIC_DEVICE_TILE_BLOCKS * row + column)] = band.blocks[column].threshold;
    if (frame.walks & CONIC_WALK_ACCUMULATE)
      covered += lanes_accumulate_row(&view, &frame, &t, &band, footprints, surfaces, rays, clips,
                                      sums, PIXEL_PLANES_PASSED);
  }
  if (frame.walks & CONIC_WALK_VISIBILITY)
    n_fragments[t.index] = sum_of_lanes(band.found);
  n_covered[t.index] = covered;
}

/* The nearest splats' own sums. They take the place of what earlier parts of the splats left there. */
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
  uint covered = 0;
  for (uint block = 0; block < N_TILE_BLOCKS; block++)
    lanes_begin_sums(&frame, &t, block, sums, &of_blocks[block]);
  for (ulong i = tile_begin[t.index]; i < tile_begin[t.index + 1]; i++) {
    lanes_splat splat;
    CONIC_FETCH_AHEAD(&footprints[references[min(i + LANES_AHEAD, tile_begin[t.index + 1] - 1)].footprint]);
    lanes_fetch(references[i].footprint, references[i].blocks, footprints, rays, clips, &splat);
    for (uint row = splat.row_begin; row <= splat.row_last; row++) {
      splat_rows of_rows = lanes_begin(&view, &splat, lanes_within(rows_from(t.y + 4 * (int)row), t.height));
      for (uint column = splat.column_begin; column <= splat.column_last; column++) {
        uint block = CONIC_DEVICE_TILE_BLOCKS * row + column;
        lanes_sums *s = &of_blocks[block];
        fragments f;
        if (!lanes_cover(&view, &splat, &of_rows, lanes_within(columns_from(t.x + 4 * (int)column), t.width), &f))
          continue;
        int16 is_nearest = f.covered & (s->values[CONIC_SUM_NEAREST_IZ] < f.iz);
        s->values[CONIC_SUM_NEAREST_IZ] = is_nearest ? f.iz : s->values[CONIC_SUM_NEAREST_IZ];
        q[block] = is_nearest ? f.q : q[block];
        scale[block] = is_nearest ? f.scale : scale[block];
        s->taken = is_nearest ? (int16)(int)splat.index : s->taken;
        found = lanes_increment(f.covered, found);
      }
    }
  }
  n_fragments[t.index] = sum_of_lanes(found);
  for (uint block = 0; block < N_TILE_BLOCKS; block++) {
    lanes_take_nearest(&view, &frame, footprints, surfaces, &q[block], &scale[block], lanes_block_x(&t, block),
                       lanes_block_y(&t, block), &of_blocks[block]);
    covered += lanes_finish(&frame, &t, block, &of_blocks[block], sums, PIXEL_PLANES_PASSED);
  }
  n_covered[t.index] = covered;
}
