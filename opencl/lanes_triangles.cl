/* Triangles a tile a work-item: raster/loops/triangle_body.h in its order of arithmetic. */

#include "raster/triangles/draw_lanes.h"
#include "raster/triangles/look_lanes.h"

/* The nearest triangle of every pixel, and where splats are to be blended what it hides: the splats' thresholds begin
 * with that. */
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void lanes_triangles(TRIANGLE_LISTS, __global lanes *thresholds,
                                                                             __global lanes *nearest_iz,
                                                                             __global int16 *nearest,
                                                                             __global uint *n_fragments) {
  conic_device_frame frame = *frame_constants;
  lanes_tile t = lanes_tile_of(&frame);
  conic_triangle_block of_blocks[N_TILE_BLOCKS];
  const conic_triangle_canvas canvas = {of_blocks, CONIC_DEVICE_TILE_BLOCKS, t.x,     t.y,
                                        CONIC_DEVICE_TILE,                   t.width, t.height};
  ulong n_covered = 0;
  for (uint block = 0; block < N_TILE_BLOCKS; block++) {
    lanes_store(of_blocks[block].iz, (lanes)0.0f);
    vstore16((index_lanes)0, 0, of_blocks[block].record);
  }
  for (uint i_chunk = 0; i_chunk < frame.n_triangle_chunks; i_chunk++) {
    ulong begin, end;
    triangles_of_tile(&frame, i_chunk, t.index, chunks, tile_begin, &begin, &end);
    uint first_record = (uint)chunks[i_chunk].first_record;
    for (ulong i = begin; i < end; i++) {
      uint i_record = first_record + entries[i];
      CONIC_FETCH_AHEAD(&records[first_record + entries[min(i + 8, end - 1)]]);
      const conic_triangle_record record = records[i_record];
      n_covered += has_few_samples(&record.box) ? conic_triangle_draw_samples(&record, i_record, &canvas)
                                                : draw_blocks(&record, i_record, &canvas);
    }
  }
  for (uint block = 0; block < N_TILE_BLOCKS; block++) {
    ulong at = lanes_block(&t, &frame, block);
    lanes iz = lanes_load(of_blocks[block].iz), dx, dy;
    nearest_iz[at] = iz;
    nearest[at] = as_int16(vload16(0, of_blocks[block].record));
    if (frame.is_single_pass || !frame.has_splats)
      continue;
    lanes_directions(columns, rows, lanes_block_x(&t, block), lanes_block_y(&t, block), &dx, &dy);
    lanes hides = iz * (1.0f / (1.0f + frame.triangle_epsilon * iz / sqrt((dx * dx + dy * dy) + 1.0f)));
    thresholds[at] = iz > 0.0f ? hides : 0.0f;
  }
  n_fragments[2 * t.index] = (uint)n_covered;
  n_fragments[2 * t.index + 1] = (uint)(n_covered >> 32);
}

/* What the triangles look like at a block's pixels. */
typedef struct lanes_look {
  lanes color[3], normal[3];
  int16 index;                  /* in the set */
  const conic_texture *texture; /* that colours are still without */
  int16 textured;               /* where, and where it is seen there */
  lanes uv[2], along[2], across[2];
} lanes_look;

/* Gives colours their texture, whichever triangles the pixels see. */
static void lanes_lay_texture(lanes_look *to) {
  lanes texel[3] = {1.0f, 1.0f, 1.0f};
  if (!lanes_any(to->textured))
    return;
  lanes_sample_texture(to->texture, to->uv, to->along, to->across, to->textured, texel);
  for (int channel = 0; channel < 3; channel++)
    to->color[channel] = to->textured ? to->color[channel] * texel[channel] : to->color[channel];
  to->textured = 0;
}

/* Notes down where a triangle's texture is seen. */
static void lanes_note_texture(const conic_triangle_look *look, const look_places *p, int16 mask, lanes_look *to) {
  if (to->texture != look->texture)
    lanes_lay_texture(to);
  to->texture = look->texture;
  to->textured |= mask;
  for (int i = 0; i < 2; i++) {
    lanes uv, along, across;
    find_texture_places(look, p, i, &uv, &along, &across);
    to->uv[i] = mask ? uv : to->uv[i];
    to->along[i] = mask ? along : to->along[i];
    to->across[i] = mask ? across : to->across[i];
  }
}

/* Takes one triangle's looks where the mask holds. */
static void lanes_take_look(const conic_device_frame *frame, const conic_triangle_look *look, int16 mask, lanes dx,
                            lanes dy, lanes_look *to) {
  look_places p;
  lanes color[3], normal[3];
  find_places(look, lanes_of_ints(lanes_columns()), lanes_of_ints(lanes_rows()), &p);
  find_colors(look, &p, color);
  if (look->texture)
    lanes_note_texture(look, &p, mask, to);
  find_normals(look, &p, frame->world_from_cam, dx, dy, normal);
  for (int axis = 0; axis < 3; axis++) {
    to->color[axis] = mask ? color[axis] : to->color[axis];
    to->normal[axis] = mask ? normal[axis] : to->normal[axis];
  }
}

/* One triangle after the other. */
static void lanes_look_at(const conic_device_frame *frame, const conic_triangle_frame *triangles, int16 visible,
                          int16 i_records, int x, int y, lanes dx, lanes dy, lanes_look *to) {
  for (int lane = 0; lane < 16; lane++) {
    int i_record = ((const int *)&i_records)[lane];
    if (!((const int *)&visible)[lane])
      continue;
    int16 mask = visible & (i_records == i_record);
    conic_triangle_record record = triangles->records[(uint)i_record];
    conic_triangle_look look;
    conic_triangle_look_at(triangles, &record, x, y, &look);
    lanes_take_look(frame, &look, mask, dx, dy, to);
    to->index = mask ? (int16)(int)record.index : to->index;
    visible &= ~mask;
  }
  lanes_lay_texture(to);
}

/* add_part, and what it needs to know of the splats before. */
static void lanes_add_look(const conic_device_frame *frame, int16 visible, lanes iz, const lanes_look *look,
                           lanes_sums *s) {
  lanes sum[3], size = 0.0f;
  int16 is_heaviest = visible & (1.0f > s->values[CONIC_SUM_HEAVIEST_WEIGHT]);
  int16 is_nearest = visible & (iz > s->values[CONIC_SUM_NEAREST_IZ]);
  int16 id = (int)frame->first_triangle_id + look->index;
  s->values[CONIC_SUM_Z] = is_heaviest ? 1.0f / iz : s->values[CONIC_SUM_Z];
  s->values[CONIC_SUM_ID] = as_float16(is_nearest ? id : as_int16(s->values[CONIC_SUM_ID]));
  s->values[CONIC_SUM_COUNT] = as_float16(as_int16(s->values[CONIC_SUM_COUNT]) - visible);
  s->values[CONIC_SUM_WEIGHT] = visible ? s->values[CONIC_SUM_WEIGHT] + 1.0f : s->values[CONIC_SUM_WEIGHT];
  for (int axis = 0; axis < 3; axis++) {
    lanes *color = &s->values[CONIC_SUM_COLOR + axis];
    *color = visible ? *color + look->color[axis] : *color;
    sum[axis] = s->values[CONIC_SUM_NORMAL + axis] + look->normal[axis];
    size += fabs(sum[axis]);
  }
  for (int axis = 0; axis < 3; axis++) {
    lanes *normal = &s->values[CONIC_SUM_NORMAL + axis];
    sum[axis] = size > 0.0f ? sum[axis] : look->normal[axis] * CONIC_LEAST_WEIGHT;
    *normal = visible ? sum[axis] : *normal;
  }
}

/* The sums of a block's splats. */
static void lanes_load_sums(const conic_device_frame *frame, __global const lanes *sums, ulong at, lanes_sums *s) {
  for (int i = 0; i < CONIC_N_SUMS; i++)
    s->values[i] = frame->has_splats ? sums[at * CONIC_N_SUMS + i] : (lanes)0.0f;
}

/* The triangles that are seen to the sums of the splats, and pass 3. */
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void
lanes_add_triangles(TRIANGLE_SET, __global const lanes *nearest_iz, __global const int16 *nearest,
                    __global const lanes *thresholds, __global const lanes *sums, PIXEL_PLANES) {
  TRIANGLE_SET_TAKEN
  lanes_tile t = lanes_tile_of(&frame);
  uint n = 0;
  for (uint block = 0; block < N_TILE_BLOCKS; block++) {
    int x = lanes_block_x(&t, block), y = lanes_block_y(&t, block);
    if (x >= frame.width || y >= frame.height)
      continue;
    ulong at = lanes_block(&t, &frame, block);
    lanes iz = nearest_iz[at], dx, dy;
    lanes_sums s;
    lanes_load_sums(&frame, sums, at, &s);
    int16 visible = iz > 0.0f;
    if (frame.has_splats)
      visible &= frame.is_single_pass ? iz > s.values[CONIC_SUM_NEAREST_IZ] : iz >= thresholds[at];
    if (lanes_any(visible)) {
      lanes_look look = {{0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f}, 0, 0, 0};
      for (int i = 0; i < CONIC_N_SUMS && frame.is_single_pass; i++)
        s.values[i] = visible ? 0.0f : s.values[i];
      lanes_directions(columns, rows, x, y, &dx, &dy);
      lanes_look_at(&frame, &triangles, visible, nearest[at], x, y, dx, dy, &look);
      lanes_add_look(&frame, visible, iz, &look, &s);
    }
    n += lanes_resolve(&frame, &s, x, y, PIXEL_PLANES_PASSED);
  }
  n_covered[t.index] = n;
}
