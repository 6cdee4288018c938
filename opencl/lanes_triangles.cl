/* Triangles a tile a work-item: raster/triangle_body.h in its order of arithmetic. */

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
      if (!conic_triangle_covers(&d->record, &edges, x, y, &iz))
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
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void
lanes_triangles(TRIANGLE_LISTS, __global lanes *thresholds, __global lanes *nearest_iz, __global int16 *nearest,
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
    if (frame.is_single_pass)
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
  int16 index; /* in the set */
} lanes_look;

/* Triangle by triangle and, of each, pixel by pixel, by the shared text. */
static void lanes_look_at(const conic_device_frame *frame, const conic_triangle_frame *triangles, int16 visible,
                          int16 i_records, int x, int y, lanes dx, lanes dy, lanes_look *to) {
  for (int first = 0; first < 16; first++) {
    int i_record = ((const int *)&i_records)[first];
    if (!((const int *)&visible)[first])
      continue;
    conic_triangle_record record = triangles->records[(uint)i_record];
    conic_triangle_look look;
    conic_triangle_look_at(triangles, &record, x, y, &look);
    for (int lane = first; lane < 16; lane++) {
      if (!((const int *)&visible)[lane] || ((const int *)&i_records)[lane] != i_record)
        continue;
      conic_triangle_weights weights;
      float color[3], normal[3];
      conic_triangle_weights_at(&look, (float)(lane / 4), (float)(lane % 4), &weights);
      conic_triangle_color_at(&look, &weights, color);
      conic_triangle_normal_at(&look, &weights, frame->world_from_cam, ((const float *)&dx)[lane],
                               ((const float *)&dy)[lane], normal);
      for (int axis = 0; axis < 3; axis++) {
        ((float *)&to->color[axis])[lane] = color[axis];
        ((float *)&to->normal[axis])[lane] = normal[axis];
      }
      ((int *)&to->index)[lane] = (int)record.index;
      ((int *)&visible)[lane] = 0;
    }
  }
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
    s->values[i] = frame->has_sums ? sums[at * CONIC_N_SUMS + i] : (lanes)0.0f;
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
    int16 visible =
        (iz > 0.0f) & (frame.is_single_pass ? iz > s.values[CONIC_SUM_NEAREST_IZ] : iz >= thresholds[at]);
    if (lanes_any(visible)) {
      lanes_look look;
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
