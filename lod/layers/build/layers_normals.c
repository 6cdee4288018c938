#include "lod/layers/build/layers_normals.h"

#include <math.h>
#include <string.h>

#include "core/base/eigen.h"
#include "core/base/memory.h"
#include "lod/layers/format/layers_key.h"

/* A plane through fewer is no plane; more than that many, the nearest first, say nothing new. */
enum { LEAST_NEIGHBOURS = 8, MOST_NEIGHBOURS = 24, MOST_WIDENINGS = 4 };

/* Neighbours are looked for so far away at first, in sampling distances. */
static const double first_reach = 2.5;

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
    covariance[0] += d[0] * d[0];
    covariance[1] += d[0] * d[1];
    covariance[2] += d[0] * d[2];
    covariance[3] += d[1] * d[1];
    covariance[4] += d[1] * d[2];
    covariance[5] += d[2] * d[2];
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
static void place_samples(const conic_layers_sample *samples, size_t n, float (*at)[3]) {
  uint32_t low[3] = {UINT32_MAX, UINT32_MAX, UINT32_MAX};
  for (size_t i = 0; i < n; i++)
    for (int axis = 0; axis < 3; axis++) {
      uint32_t step = conic_layers_step(samples[i].key, axis);
      low[axis] = step < low[axis] ? step : low[axis];
    }
  for (size_t i = 0; i < n; i++)
    for (int axis = 0; axis < 3; axis++) {
      float within = samples[i].bare ? 0.25f * (float)(samples[i].bare >> 2 * axis & 3) + 0.125f : 0.5f;
      at[i][axis] = (float)(conic_layers_step(samples[i].key, axis) - low[axis]) + within;
    }
}

/* One pass over those that still have none; returns how many are left. */
static size_t pass(const sample_grid *g, conic_layers_sample *samples, int is_last) {
  size_t n_left = 0;
  for (size_t i = 0; i < g->n; i++) {
    neighbours found;
    float normal[3] = {0.0f, 0.0f, 1.0f};
    if (!samples[i].bare)
      continue;
    find_neighbours(g, g->at[i], &found);
    if ((found.n >= LEAST_NEIGHBOURS && fit_plane(g, &found, normal)) || is_last) {
      conic_layers_code_normal(normal, samples[i].normal);
      samples[i].bare = 0;
    } else
      n_left++;
  }
  return n_left;
}

conic_status conic_layers_find_normals(const conic_layers_plan *plan, conic_layers_sample *samples, size_t n) {
  conic_context *context = plan->context;
  sample_grid g = {.n = n, .n_chains = 64};
  while (g.n_chains < n)
    g.n_chains *= 2;
  g.at = conic_memory_allocate(context, n, sizeof *g.at);
  g.first = conic_memory_allocate(context, g.n_chains, sizeof *g.first);
  g.next = conic_memory_allocate(context, n, sizeof *g.next);
  conic_status status = g.at && g.first && g.next ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    double reach = first_reach * plan->spacing / plan->quantum;
    size_t n_left = n;
    place_samples(samples, n, g.at);
    for (int i = 0; i < MOST_WIDENINGS && n_left > 0; i++, reach *= 2.0) {
      fill_grid(&g, reach > 1.0 ? (float)reach : 1.0f);
      n_left = pass(&g, samples, i == MOST_WIDENINGS - 1);
    }
  }
  conic_memory_release(context, g.at);
  conic_memory_release(context, g.first);
  conic_memory_release(context, g.next);
  return status;
}
