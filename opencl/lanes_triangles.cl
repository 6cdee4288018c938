/* Triangles a tile a work-item: raster/triangles/triangle_body.h in its order of arithmetic. */

/* The nearest triangles of a block: their depth, 0 where there is none, and their records. */
typedef struct lanes_nearest_triangles {
  lanes iz;
  int16 record;
} lanes_nearest_triangles;

/* A record, and what of it is the same in all blocks. */
typedef struct lanes_drawing {
  conic_triangle_record record;
  conic_triangle_edges edges;
  int16 within[3]; /* how far each edge's value is from that at the block's first pixel, in steps */
  int most[3];     /* the most that it gains */
  float iz_far, iz_near;
} lanes_drawing;

#define LANE_INT_COLUMNS ((int16)(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3))
#define LANE_INT_ROWS ((int16)(0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3))

static void lanes_begin_drawing(lanes_drawing *d) {
  conic_triangle_edges_of(&d->record, &d->edges);
  for (int k = 0; k < 3; k++) {
    int a = (int)d->edges.a[k], b = (int)d->edges.b[k];
    d->most[k] = (CONIC_BLOCK_EDGE - 1) * ((a > 0 ? a : 0) + (b > 0 ? b : 0));
    d->within[k] = LANE_INT_COLUMNS * a + LANE_INT_ROWS * b;
  }
  d->iz_far = conic_triangle_far(&d->record);
  d->iz_near = conic_triangle_near(&d->record);
}

/* The pixels of a block from the values of the edges at its first; returns those covered as ones. */
static int16 lanes_draw_block(const lanes_drawing *d, uint i_record, const lanes_tile *t, const long e[3], int x, int y,
                              lanes_nearest_triangles *nearest) {
  int steps[3];
  for (int k = 0; k < 3; k++) {
    steps[k] = conic_triangle_steps(e[k] + d->edges.bias[k]);
    if (steps[k] + d->most[k] < 0)
      return 0;
  }
  conic_affine depth = conic_triangle_depth(&d->record, &d->edges, e[1], e[2]);
  int16 covered = ((steps[0] + d->within[0]) | (steps[1] + d->within[1]) | (steps[2] + d->within[2])) >= 0;
  if (t->is_at_border)
    covered &= lanes_inside(t, x, y);
  lanes iz = (depth.at + depth.by_y * LANE_ROWS) + depth.by_x * LANE_COLUMNS;
  iz = iz > d->iz_far ? iz : d->iz_far;
  iz = iz < d->iz_near ? iz : d->iz_near;
  int16 is_nearer = covered & (nearest->iz < iz);
  nearest->iz = is_nearer ? iz : nearest->iz;
  nearest->record = is_nearer ? (int16)(int)i_record : nearest->record;
  return -covered;
}

/* The blocks of the tile that the record's box meets. */
static int16 lanes_draw_blocks(const lanes_drawing *d, uint i_record, const lanes_tile *t,
                               lanes_nearest_triangles *of_blocks) {
  const conic_box *box = &d->record.box;
  uint column_begin = box->x_begin > t->x ? (uint)(box->x_begin - t->x) / 4 : 0;
  uint row_begin = box->y_begin > t->y ? (uint)(box->y_begin - t->y) / 4 : 0;
  uint column_last = min((uint)(box->x_end - 1 - t->x) / 4, (uint)CONIC_DEVICE_TILE_BLOCKS - 1);
  uint row_last = min((uint)(box->y_end - 1 - t->y) / 4, (uint)CONIC_DEVICE_TILE_BLOCKS - 1);
  const long block_step = CONIC_BLOCK_EDGE * CONIC_SUBPIXELS;
  int16 found = 0;
  long of_row[3];
  for (int k = 0; k < 3; k++)
    of_row[k] = conic_triangle_edge_at(&d->edges, k, t->x + 4 * (int)column_begin, t->y + 4 * (int)row_begin);
  for (uint row = row_begin; row <= row_last; row++) {
    long e[3] = {of_row[0], of_row[1], of_row[2]};
    for (uint column = column_begin; column <= column_last; column++) {
      found += lanes_draw_block(d, i_record, t, e, t->x + 4 * (int)column, t->y + 4 * (int)row,
                                &of_blocks[CONIC_DEVICE_TILE_BLOCKS * row + column]);
      for (int k = 0; k < 3; k++)
        e[k] += d->edges.a[k] * block_step;
    }
    for (int k = 0; k < 3; k++)
      of_row[k] += d->edges.b[k] * block_step;
  }
  return found;
}

/* A record of few samples, one by one; returns how many it covers. */
static uint lanes_draw_samples(const lanes_drawing *d, uint i_record, const lanes_tile *t,
                               lanes_nearest_triangles *of_blocks) {
  const conic_box *box = &d->record.box;
  int x_end = min((int)box->x_end, t->x + CONIC_DEVICE_TILE), y_end = min((int)box->y_end, t->y + CONIC_DEVICE_TILE);
  conic_triangle_edges edges;
  uint n_covered = 0;
  conic_triangle_edges_of(&d->record, &edges);
  for (int y = max((int)box->y_begin, t->y); y < y_end; y++)
    for (int x = max((int)box->x_begin, t->x); x < x_end; x++) {
      lanes_nearest_triangles *nearest = &of_blocks[(y - t->y) / 4 * CONIC_DEVICE_TILE_BLOCKS + (x - t->x) / 4];
      int lane = x % 4 * 4 + y % 4;
      float iz;
      if (!conic_triangle_sample(&d->record, &edges, x, y, &iz))
        continue;
      n_covered++;
      if (!(((const float *)&nearest->iz)[lane] < iz))
        continue;
      ((float *)&nearest->iz)[lane] = iz;
      ((int *)&nearest->record)[lane] = (int)i_record;
    }
  return n_covered;
}

static int lanes_has_few_samples(const conic_box *box) {
  return (box->x_end - box->x_begin) * (box->y_end - box->y_begin) <= 3;
}

/* The directions of a block's pixels. */
static void lanes_directions(__global const float *columns, __global const float *rows, int x, int y, lanes *dx,
                             lanes *dy) {
  float4 of_columns = vload4(0, columns + x), of_rows = vload4(0, rows + y); /* there are some of all whole tiles */
  *dx = (lanes)(of_columns.xxxx, of_columns.yyyy, of_columns.zzzz, of_columns.wwww);
  *dy = (lanes)(of_rows, of_rows, of_rows, of_rows);
}

/* The nearest triangle of every pixel, and where splats are to be blended what it hides: the splats' thresholds begin
 * with that. */
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void lanes_triangles(TRIANGLE_LISTS, __global lanes *thresholds,
                                                                             __global lanes *nearest_iz,
                                                                             __global int16 *nearest,
                                                                             __global uint *n_fragments) {
  conic_device_frame frame = *frame_constants;
  lanes_tile t = lanes_tile_of(&frame);
  lanes_nearest_triangles of_blocks[N_TILE_BLOCKS];
  ulong n_covered = 0;
  for (uint block = 0; block < N_TILE_BLOCKS; block++) {
    of_blocks[block].iz = 0.0f;
    of_blocks[block].record = 0;
  }
  for (uint i_chunk = 0; i_chunk < frame.n_triangle_chunks; i_chunk++) {
    ulong begin, end;
    triangles_of_tile(&frame, i_chunk, t.index, chunks, tile_begin, &begin, &end);
    uint first_record = (uint)chunks[i_chunk].first_record;
    for (ulong i = begin; i < end; i++) {
      uint i_record = first_record + entries[i];
      lanes_drawing d;
      CONIC_FETCH_AHEAD(&records[first_record + entries[min(i + 8, end - 1)]]);
      d.record = records[i_record];
      if (lanes_has_few_samples(&d.record.box)) {
        n_covered += lanes_draw_samples(&d, i_record, &t, of_blocks);
        continue;
      }
      lanes_begin_drawing(&d);
      n_covered += lanes_sum(lanes_draw_blocks(&d, i_record, &t, of_blocks));
    }
  }
  for (uint block = 0; block < N_TILE_BLOCKS; block++) {
    ulong at = lanes_block(&t, &frame, block);
    lanes iz = of_blocks[block].iz, dx, dy;
    nearest_iz[at] = iz;
    nearest[at] = of_blocks[block].record;
    if (frame.is_single_pass || !frame.has_splats)
      continue;
    lanes_directions(columns, rows, lanes_block_x(&t, block), lanes_block_y(&t, block), &dx, &dy);
    lanes hides = iz * (1.0f / (1.0f + frame.triangle_epsilon * iz / sqrt((dx * dx + dy * dy) + 1.0f)));
    thresholds[at] = iz > 0.0f ? hides : 0.0f;
  }
  n_fragments[2 * t.index] = (uint)n_covered;
  n_fragments[2 * t.index + 1] = (uint)(n_covered >> 32);
}

/* The weights of a triangle's second and third corner at a block's pixels: conic_triangle_weights. */
typedef struct lanes_weights {
  lanes at[2], by_x[2], by_y[2];
} lanes_weights;

static lanes lanes_affine_at(const conic_affine *f) {
  return (f->at + f->by_y * LANE_ROWS) + f->by_x * LANE_COLUMNS;
}

static void lanes_weights_at(const conic_triangle_look *look, lanes_weights *w) {
  lanes iz = lanes_affine_at(&look->iz);
  iz = iz > look->iz_far ? iz : look->iz_far;
  iz = iz < look->iz_near ? iz : look->iz_near;
  lanes z = 1.0f / iz;
  const conic_affine *weights[2] = {&look->first, &look->second};
  for (int i = 0; i < 2; i++) {
    lanes at = lanes_at_least_zero(lanes_affine_at(weights[i]) * z);
    w->at[i] = at < 1.0f ? at : 1.0f;
    w->by_x[i] = (weights[i]->by_x - w->at[i] * look->iz.by_x) * z;
    w->by_y[i] = (weights[i]->by_y - w->at[i] * look->iz.by_y) * z;
  }
  if (!look->is_piece)
    return;
  const lanes_weights of_piece = *w;
  for (int i = 0; i < 2; i++) {
    w->at[i] = look->at[0][i] + (of_piece.at[0] * look->at[1][i] + of_piece.at[1] * look->at[2][i]);
    w->by_x[i] = of_piece.by_x[0] * look->at[1][i] + of_piece.by_x[1] * look->at[2][i];
    w->by_y[i] = of_piece.by_y[0] * look->at[1][i] + of_piece.by_y[1] * look->at[2][i];
  }
}

static void lanes_normals(const conic_triangle_look *look, const lanes_weights *w, const conic_device_frame *frame,
                          lanes dx, lanes dy, lanes normal[3]) {
  lanes away = 0.0f;
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = look->face[axis];
  if (look->has_normals) {
    lanes mean[3];
    for (int axis = 0; axis < 3; axis++)
      mean[axis] = look->normal[0][axis] + (w->at[0] * look->normal[1][axis] + w->at[1] * look->normal[2][axis]);
    lanes squared = (mean[0] * mean[0] + mean[1] * mean[1]) + mean[2] * mean[2], scale = 1.0f / sqrt(squared);
    int16 is_usable = (squared > 1e-30f) & (squared < 1e30f);
    for (int axis = 0; axis < 3; axis++)
      normal[axis] = is_usable ? mean[axis] * scale : normal[axis];
  }
  for (int i = 0; i < 3; i++) {
    const float *m = frame->world_from_cam[i];
    away += normal[i] * ((m[0] * dx + m[1] * dy) + m[2]);
  }
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = away > 0.0f ? -normal[axis] : normal[axis];
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
static void lanes_note_texture(const conic_triangle_look *look, const lanes_weights *w, int16 mask, lanes_look *to) {
  if (to->texture != look->texture)
    lanes_lay_texture(to);
  to->texture = look->texture;
  to->textured |= mask;
  for (int i = 0; i < 2; i++) {
    lanes uv = look->uv[0][i] + (w->at[0] * look->uv[1][i] + w->at[1] * look->uv[2][i]);
    lanes along = w->by_x[0] * look->uv[1][i] + w->by_x[1] * look->uv[2][i];
    lanes across = w->by_y[0] * look->uv[1][i] + w->by_y[1] * look->uv[2][i];
    to->uv[i] = mask ? uv : to->uv[i];
    to->along[i] = mask ? along : to->along[i];
    to->across[i] = mask ? across : to->across[i];
  }
}

/* Takes one triangle's looks where the mask holds. */
static void lanes_take_look(const conic_device_frame *frame, const conic_triangle_look *look, int16 mask, lanes dx,
                            lanes dy, lanes_look *to) {
  lanes_weights w;
  lanes color[3], normal[3];
  lanes_weights_at(look, &w);
  for (int channel = 0; channel < 3; channel++)
    color[channel] = look->color[0][channel] + (w.at[0] * look->color[1][channel] + w.at[1] * look->color[2][channel]);
  if (look->texture)
    lanes_note_texture(look, &w, mask, to);
  lanes_normals(look, &w, frame, dx, dy, normal);
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
