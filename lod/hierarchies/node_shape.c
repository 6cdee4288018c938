#include "lod/hierarchies/node_shape.h"

#include "core/base/eigen.h"
#include "core/base/rank.h"
#include "core/base/vectors.h"
#include "lod/layers/format/layers_key.h"

/* A plane goes through so many of the nearest. Cells are so large that one has about so many points; where they are too
 * few about a point, cells of twice the size are looked at, and so on. */
enum {
  NEAREST = 12,
  LEAST_NEAREST = 4,
  SPACING_RANK = 8,
  POINTS_A_CELL = 5,
  MOST_CELL_BITS = 21,
  MOST_WIDER = 6,
  MOST_IN_RUN = 256,
  MOST_MEASURED = 4096
};

/* Neighbours lie in a plane where their variances, in order, are at least and at most such shares of the one before. */
static const double least_width = 0.1, most_thickness = 0.4;

/* A spacing is no greater than so many times both the node's median and the neighbours': the ends of a few points apart
 * from the others are no blobs. */
static const float most_excess = 2.0f;

#define NO_CELL UINT32_MAX

/* Cells of one size: runs of the points, found by a hash of their code. */
typedef struct cell_table {
  int shift; /* a cell's code is the key without so many bits, a multiple of 3 */
  size_t n_cells, n_places;
  uint32_t *first; /* of each cell, and where the last ends */
  uint32_t *cell_at;
} cell_table;

typedef struct shaping {
  const conic_node_shape *shape;
  cell_table table;
  uint8_t *is_done;
} shaping;

typedef struct nearest_points {
  int n;
  float distance2[NEAREST];
  uint32_t point[NEAREST];
} nearest_points;

static size_t place_of_code(const cell_table *t, uint64_t code) {
  uint64_t mixed = code * UINT64_C(0x9e3779b97f4a7c15);
  return (size_t)(mixed ^ mixed >> 29) & (t->n_places - 1);
}

static uint32_t find_table_cell(const cell_table *t, const uint64_t *keys, uint64_t code) {
  size_t at = place_of_code(t, code);
  while (t->cell_at[at] != NO_CELL && keys[t->first[t->cell_at[at]]] >> t->shift != code)
    at = (at + 1) & (t->n_places - 1);
  return t->cell_at[at];
}

static void fill_cell_table(cell_table *t, const uint64_t *keys, size_t n, int shift) {
  t->shift = shift;
  t->n_cells = 0;
  for (size_t i = 0; i < n; i++)
    if (i == 0 || keys[i] >> shift != keys[i - 1] >> shift)
      t->first[t->n_cells++] = (uint32_t)i;
  t->first[t->n_cells] = (uint32_t)n;
  for (t->n_places = 64; t->n_places < 2 * t->n_cells;)
    t->n_places *= 2;
  memset(t->cell_at, 0xff, t->n_places * sizeof *t->cell_at);
  for (size_t i = 0; i < t->n_cells; i++) {
    size_t at = place_of_code(t, keys[t->first[i]] >> shift);
    while (t->cell_at[at] != NO_CELL)
      at = (at + 1) & (t->n_places - 1);
    t->cell_at[at] = (uint32_t)i;
  }
}

/* The smallest cells that have enough points each, on average. */
static int choose_shift(const uint64_t *keys, size_t n) {
  size_t n_new[MOST_CELL_BITS + 1] = {0}, n_cells = 1; /* cells that begin with a point, by the bits that part them */
  for (size_t i = 1; i < n; i++) {
    uint64_t apart = keys[i] ^ keys[i - 1];
    int bits = apart ? (66 - (__builtin_clzll(apart) - 1)) / 3 - 1 : 0; /* the highest triple that differs, 1 to 21 */
    n_new[bits < MOST_CELL_BITS ? bits : MOST_CELL_BITS]++;
  }
  int level = MOST_CELL_BITS;
  for (; level > 0 && (n_cells + n_new[level]) * POINTS_A_CELL <= n; level--)
    n_cells += n_new[level];
  return 3 * level;
}

static void keep_near_point(nearest_points *found, float distance2, uint32_t point) {
  int i = NEAREST - 1;
  if (found->n == NEAREST && distance2 >= found->distance2[i])
    return;
  i = found->n < NEAREST ? found->n++ : i;
  for (; i > 0 && found->distance2[i - 1] > distance2; i--) {
    found->distance2[i] = found->distance2[i - 1];
    found->point[i] = found->point[i - 1];
  }
  found->distance2[i] = distance2;
  found->point[i] = point;
}

/* Runs of the points in a cell and those about it, in a fixed order. */
static int list_runs(const shaping *s, uint64_t code, uint32_t runs[27][2]) {
  const uint64_t *keys = s->shape->keys;
  int64_t side = INT64_C(1) << (MOST_CELL_BITS - s->table.shift / 3);
  int n = 0;
  for (int i = 0; i < 27; i++) {
    int64_t x = (int64_t)conic_layers_step(code, 0) + i % 3 - 1,
            y = (int64_t)conic_layers_step(code, 1) + i / 3 % 3 - 1,
            z = (int64_t)conic_layers_step(code, 2) + i / 9 - 1;
    if (x < 0 || y < 0 || z < 0 || x >= side || y >= side || z >= side)
      continue;
    uint32_t cell = find_table_cell(&s->table, keys, conic_layers_key((uint32_t)x, (uint32_t)y, (uint32_t)z));
    if (cell == NO_CELL)
      continue;
    runs[n][0] = s->table.first[cell];
    runs[n++][1] = s->table.first[cell + 1];
  }
  return n;
}

static void find_nearest_points(const conic_node_shape *shape, size_t i, uint32_t runs[27][2], int n_runs,
                                nearest_points *found) {
  found->n = 0;
  for (int r = 0; r < n_runs; r++) {
    uint32_t stride = (runs[r][1] - runs[r][0]) / MOST_IN_RUN + 1; /* crowds tell no more than some of them */
    for (uint32_t k = runs[r][0]; k < runs[r][1]; k += stride) {
      float x = shape->position[0][k] - shape->position[0][i], y = shape->position[1][k] - shape->position[1][i],
            z = shape->position[2][k] - shape->position[2][i];
      if (k != i)
        keep_near_point(found, x * x + y * y + z * z, k);
    }
  }
}

static void set_normal(const conic_node_shape *shape, size_t i, const nearest_points *found) {
  double mean[3] = {0.0, 0.0, 0.0}, spread[6] = {0.0}, values[3], vectors[3][3], d[NEAREST + 1][3];
  int n = found->n + 1;
  for (int k = 0; k < n; k++)
    for (int axis = 0; axis < 3; axis++) {
      d[k][axis] = k == 0 ? 0.0 : (double)shape->position[axis][found->point[k - 1]] - (double)shape->position[axis][i];
      mean[axis] += d[k][axis] / (double)n;
    }
  for (int k = 0; k < n; k++) {
    double apart[3];
    conic_subtract(d[k], mean, apart);
    conic_add_outer(spread, apart, apart);
  }
  conic_eigen3(spread, values, vectors);
  int has_plane = values[1] > least_width * values[0] && values[2] < most_thickness * values[1];
  double side = vectors[2][2] < 0.0 ? -1.0 : 1.0;
  for (int axis = 0; axis < 3; axis++)
    shape->normal[axis][i] = has_plane ? (float)(side * vectors[2][axis]) : 0.0f;
}

static float spacing_by_nearest(const nearest_points *found) {
  int rank = found->n < SPACING_RANK ? found->n : SPACING_RANK;
  double area = rank > 0 ? 3.14159265358979323846 * (double)found->distance2[rank - 1] / (double)rank : 0.0;
  return (float)sqrt(area);
}

/* No nearer point is outside the cells about it than their width. */
static int has_seen_nearest(const nearest_points *found, float width) {
  return found->n >= SPACING_RANK && found->distance2[SPACING_RANK - 1] <= width * width;
}

/* Points of cells about which there are enough; the others wait for wider cells. */
static size_t shape_cells(shaping *s, float width, int is_last) {
  const conic_node_shape *shape = s->shape;
  size_t n_left = 0;
  for (size_t cell = 0; cell < s->table.n_cells; cell++) {
    uint32_t runs[27][2];
    int n_runs = -1;
    for (uint32_t i = s->table.first[cell]; i < s->table.first[cell + 1]; i++) {
      nearest_points found;
      if (s->is_done[i])
        continue;
      if (n_runs < 0)
        n_runs = list_runs(s, shape->keys[i] >> s->table.shift, runs);
      find_nearest_points(shape, i, runs, n_runs, &found);
      if (!has_seen_nearest(&found, width) && !is_last) {
        n_left++;
        continue;
      }
      s->is_done[i] = 1;
      shape->spacing[i] = spacing_by_nearest(&found);
      if (found.n >= LEAST_NEAREST)
        set_normal(shape, i, &found);
    }
  }
  return n_left;
}

static conic_status find_median(conic_context *context, const conic_node_shape *shape, float *median) {
  size_t n = 0, stride = shape->n / MOST_MEASURED + 1;
  float *some = conic_memory_allocate(context, shape->n / stride + 1, sizeof *some);
  if (!some)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < shape->n; i += stride)
    if (shape->spacing[i] > 0.0f)
      some[n++] = shape->spacing[i];
  *median = n ? conic_float_of_rank(some, n, (n - 1) / 2) : 0.0f;
  conic_memory_release(context, some);
  return CONIC_OK;
}

/* Bounds the spacings that are far above the median by those of the neighbours, in the last table's cells. */
static void bound_spacings(const shaping *s, float median) {
  const conic_node_shape *shape = s->shape;
  for (uint32_t i = 0; i < shape->n; i++) {
    uint32_t runs[27][2];
    nearest_points found;
    float near_it[NEAREST];
    if (shape->spacing[i] <= most_excess * median)
      continue;
    find_nearest_points(shape, i, runs, list_runs(s, shape->keys[i] >> s->table.shift, runs), &found);
    for (int k = 0; k < found.n; k++)
      near_it[k] = shape->spacing[found.point[k]];
    float usual = found.n ? conic_float_of_rank(near_it, (size_t)found.n, (size_t)found.n / 2) : median;
    float most = most_excess * (usual > median ? usual : median);
    shape->spacing[i] = shape->spacing[i] < most ? shape->spacing[i] : most;
  }
}

conic_status conic_node_shape_find(conic_context *context, const conic_node_shape *shape, float *median) {
  shaping s = {.shape = shape};
  size_t n = shape->n, n_places = 64;
  while (n_places < 2 * n)
    n_places *= 2;
  *median = 0.0f;
  conic_status status = conic_memory_allocate_these(
      context, CONIC_ROOM(s.table.first, n + 1), CONIC_ROOM(s.table.cell_at, n_places), CONIC_ZEROED(s.is_done, n + 1));
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    shape->normal[0][i] = shape->normal[1][i] = shape->normal[2][i] = shape->spacing[i] = 0.0f;
  if (status == CONIC_OK && n > 1) {
    int shift = choose_shift(shape->keys, n), most = 3 * MOST_CELL_BITS;
    size_t n_left = n;
    for (int i = 0; n_left > 0; i++, shift += 3) {
      int is_last = i == MOST_WIDER || shift + 3 >= most;
      fill_cell_table(&s.table, shape->keys, n, shift < most - 3 ? shift : most - 3);
      n_left = shape_cells(&s, (float)(shape->step * (double)(UINT64_C(1) << s.table.shift / 3)), is_last);
      if (is_last)
        break;
    }
  }
  if (status == CONIC_OK)
    status = find_median(context, shape, median);
  if (status == CONIC_OK && n > 1)
    bound_spacings(&s, *median);
  conic_memory_release_these(context, s.table.first, s.table.cell_at, s.is_done);
  return status;
}
