/* Normals for samples that came without. */

#include "core/base/eigen.h"
#include "core/base/trigonometry.h"
#include "core/base/vectors.h"
#include "core/estimate/estimate.h"
#include "core/estimate/voronoi_cell.h"
#include "lod/layers/build/layers_node.h"
#include "lod/layers/format/layers_axes.h"
#include "lod/layers/format/layers_key.h"

/* A plane through fewer is no plane; more than that many, the nearest first, say nothing new. */
enum { LEAST_NEIGHBOURS = 8, MOST_NEIGHBOURS = 24, MOST_WIDENINGS = 4 };

/* Neighbours are looked for so far away at first, in sampling distances. */
static const double first_reach = 2.5;

/* A sample's part of the plane reaches no farther, in distances of its neighbours. */
static const double most_spacings = 1.5;

#define NO_SAMPLE UINT32_MAX

/* Samples in cells, chained by the hash of their cell. */
typedef struct sample_grid {
  size_t n, n_chains;
  float (*at)[3];
  uint32_t *first, *next;
  float reach; /* as wide as a cell */
} sample_grid;

typedef struct neighbours {
  int n;
  float distance2[MOST_NEIGHBOURS];
  uint32_t sample[MOST_NEIGHBOURS];
} neighbours;

static uint32_t *chain_of(const sample_grid *g, int32_t x, int32_t y, int32_t z) {
  uint64_t mixed = (uint64_t)(uint32_t)x * UINT64_C(0x9e3779b97f4a7c15) ^
                   (uint64_t)(uint32_t)y * UINT64_C(0xc2b2ae3d27d4eb4f) ^
                   (uint64_t)(uint32_t)z * UINT64_C(0x165667b19e3779f9);
  return &g->first[(mixed ^ mixed >> 32) & (g->n_chains - 1)];
}

static void cell_of(const sample_grid *g, const float at[3], int32_t cell[3]) {
  for (int axis = 0; axis < 3; axis++)
    cell[axis] = (int32_t)(at[axis] / g->reach);
}

static void fill_grid(sample_grid *g, float reach) {
  g->reach = reach;
  memset(g->first, 0xff, g->n_chains * sizeof *g->first);
  for (uint32_t i = 0; i < g->n; i++) {
    int32_t cell[3];
    cell_of(g, g->at[i], cell);
    uint32_t *chain = chain_of(g, cell[0], cell[1], cell[2]);
    g->next[i] = *chain;
    *chain = i;
  }
}

/* Keeps the nearest; of equally near ones those of the lower number. */
static void keep_found(neighbours *found, float distance2, uint32_t i_sample) {
  int i = MOST_NEIGHBOURS - 1;
  if (distance2 > found->distance2[i] || (distance2 == found->distance2[i] && i_sample > found->sample[i]))
    return;
  for (; i > 0 && (found->distance2[i - 1] > distance2 ||
                   (found->distance2[i - 1] == distance2 && found->sample[i - 1] > i_sample));
       i--) {
    found->distance2[i] = found->distance2[i - 1];
    found->sample[i] = found->sample[i - 1];
  }
  found->distance2[i] = distance2;
  found->sample[i] = i_sample;
  found->n += found->n < MOST_NEIGHBOURS;
}

static void look_into(const sample_grid *g, const int32_t cell[3], const float at[3], neighbours *found) {
  for (uint32_t i = *chain_of(g, cell[0], cell[1], cell[2]); i != NO_SAMPLE; i = g->next[i]) {
    int32_t own[3];
    cell_of(g, g->at[i], own);
    float x = g->at[i][0] - at[0], y = g->at[i][1] - at[1], z = g->at[i][2] - at[2], d2 = x * x + y * y + z * z;
    if (own[0] == cell[0] && own[1] == cell[1] && own[2] == cell[2] && d2 <= g->reach * g->reach)
      keep_found(found, d2, i);
  }
}

static void find_neighbours(const sample_grid *g, const float at[3], neighbours *found) {
  int32_t cell[3];
  found->n = 0;
  for (int i = 0; i < MOST_NEIGHBOURS; i++) {
    found->distance2[i] = HUGE_VALF;
    found->sample[i] = NO_SAMPLE;
  }
  cell_of(g, at, cell);
  for (int i = 0; i < 27; i++) {
    const int32_t beside[3] = {cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 - 1};
    look_into(g, beside, at, found);
  }
}

/* The direction of least spread; whether there is one. */
static int fit_plane(const sample_grid *g, const neighbours *found, float normal[3]) {
  double mean[3] = {0.0, 0.0, 0.0}, covariance[6] = {0.0}, values[3], vectors[3][3];
  for (int i = 0; i < found->n; i++)
    for (int axis = 0; axis < 3; axis++)
      mean[axis] += (double)g->at[found->sample[i]][axis] / (double)found->n;
  for (int i = 0; i < found->n; i++) {
    double d[3];
    for (int axis = 0; axis < 3; axis++)
      d[axis] = (double)g->at[found->sample[i]][axis] - mean[axis];
    conic_add_outer(covariance, d, d);
  }
  conic_eigen3(covariance, values, vectors);
  if (!(values[1] > 0.0)) /* on a line, or all in one place */
    return 0;
  double side = vectors[2][2] < 0.0 ? -1.0 : 1.0;
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = (float)(side * vectors[2][axis]);
  return 1;
}

/* Places within the patch, in steps; a bare sample says where in its step it is. */
static void place_samples(const unsigned char *samples, size_t stride, size_t n, float (*at)[3]) {
  uint32_t low[3] = {UINT32_MAX, UINT32_MAX, UINT32_MAX};
  for (size_t i = 0; i < n; i++)
    for (int axis = 0; axis < 3; axis++) {
      uint32_t step = conic_layers_step(conic_layers_sample_at(samples, stride, i)->key, axis);
      low[axis] = step < low[axis] ? step : low[axis];
    }
  for (size_t i = 0; i < n; i++) {
    const conic_layers_sample *sample = conic_layers_sample_at(samples, stride, i);
    for (int axis = 0; axis < 3; axis++) {
      float within = sample->bare ? 0.25f * (float)(sample->bare >> 2 * axis & 3) + 0.125f : 0.5f;
      at[i][axis] = (float)(conic_layers_step(sample->key, axis) - low[axis]) + within;
    }
  }
}

/* How far the part of the plane reaches that is nearer to sample i than to its neighbours, with the overlap that other
 * outlines have. As at a border in core/estimate, it reaches no farther than a few spacings. In steps. */
static double outline_among(const sample_grid *g, const neighbours *found, uint32_t i, const float normal[3]) {
  conic_voronoi_cell cell;
  float u[3], v[3];
  double farthest2 = (double)found->distance2[found->n - 1];
  double spacing = sqrt(CONIC_PI * farthest2 / (double)found->n);
  conic_layers_frame(normal, u, v);
  conic_voronoi_cell_begin(&cell, most_spacings * spacing);
  for (int k = 0; k < found->n && 0.25 * (double)found->distance2[k] < cell.greatest2; k++) {
    double x = 0.0, y = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      double d = (double)g->at[found->sample[k]][axis] - (double)g->at[i][axis];
      x += d * (double)u[axis];
      y += d * (double)v[axis];
    }
    if (4.0 * (x * x + y * y) > (double)found->distance2[k] && found->sample[k] != i)
      conic_voronoi_cell_cut(&cell, x, y);
  }
  return CONIC_OUTLINE_COVER * sqrt(cell.greatest2);
}

/* Turns a normal to where its sample was seen from. Where none was found, it is that direction. */
static void turn_to_sight(const conic_layers_sample *sample, int is_found, float normal[3]) {
  float sight[3], along = 0.0f;
  if ((sample->bare & CONIC_LAYERS_SEEN) != CONIC_LAYERS_SEEN)
    return;
  conic_layers_normal_of(sample->normal, sight);
  for (int axis = 0; axis < 3; axis++)
    along += normal[axis] * sight[axis];
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = !is_found ? sight[axis] : along < 0.0f ? -normal[axis] : normal[axis];
}

/* One pass over those that still have none; returns how many are left. */
static size_t pass(const sample_grid *g, const conic_layers_plan *plan, unsigned char *samples, int is_last) {
  size_t n_left = 0;
  for (uint32_t i = 0; i < g->n; i++) {
    neighbours found;
    float normal[3] = {0.0f, 0.0f, 1.0f};
    conic_layers_sample *sample = conic_layers_sample_in(samples, plan->sample_bytes, i);
    if (!sample->bare)
      continue;
    find_neighbours(g, g->at[i], &found);
    int is_found = found.n >= LEAST_NEIGHBOURS && fit_plane(g, &found, normal);
    if (is_found || is_last) {
      turn_to_sight(sample, is_found, normal);
      if (is_found && sample->size == 0)
        sample->size = conic_layers_code_size((float)(outline_among(g, &found, i, normal) * plan->quantum));
      conic_layers_code_normal(normal, sample->normal);
      sample->bare = 0;
    } else
      n_left++;
  }
  return n_left;
}

conic_status conic_layers_find_normals(const conic_layers_plan *plan, unsigned char *samples, size_t n) {
  conic_context *context = plan->context;
  sample_grid g = {.n = n, .n_chains = 64};
  while (g.n_chains < n)
    g.n_chains *= 2;
  conic_status status =
      conic_memory_allocate_these(context, CONIC_ROOM(g.at, n), CONIC_ROOM(g.first, g.n_chains), CONIC_ROOM(g.next, n));
  if (status == CONIC_OK) {
    double reach = first_reach * plan->spacing / plan->quantum;
    size_t n_left = n;
    place_samples(samples, plan->sample_bytes, n, g.at);
    for (int i = 0; i < MOST_WIDENINGS && n_left > 0; i++, reach *= 2.0) {
      fill_grid(&g, reach > 1.0 ? (float)reach : 1.0f);
      n_left = pass(&g, plan, samples, i == MOST_WIDENINGS - 1);
    }
  }
  conic_memory_release_these(context, g.at, g.first, g.next);
  return status;
}
