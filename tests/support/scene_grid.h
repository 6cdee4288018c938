/* Points sorted into the cells of a grid, for tests that ask what lies near a place. */
#pragma once

#include <stdint.h>

#include "tests/support/check.h"

typedef struct scene_grid {
  const conic_splats *splats;
  double cell;
  size_t n_heads; /* a power of two */
  int32_t *heads, *next;
} scene_grid;

static inline size_t scene_grid_slot(const scene_grid *grid, int64_t i, int64_t j, int64_t k) {
  uint64_t mixed = (uint64_t)i * 73856093u ^ (uint64_t)j * 19349663u ^ (uint64_t)k * 83492791u;
  return (size_t)(mixed & (grid->n_heads - 1));
}

static inline int64_t scene_grid_cell(const scene_grid *grid, double coordinate) {
  return (int64_t)floor(coordinate / grid->cell);
}

static inline scene_grid scene_grid_make(const conic_splats *splats, double cell) {
  scene_grid grid = {.splats = splats, .cell = cell, .n_heads = 1};
  while (grid.n_heads < splats->count)
    grid.n_heads *= 2;
  grid.heads = malloc(grid.n_heads * sizeof *grid.heads);
  grid.next = malloc((splats->count + 1) * sizeof *grid.next);
  if (!grid.heads || !grid.next)
    exit(1);
  memset(grid.heads, 0xff, grid.n_heads * sizeof *grid.heads);
  for (size_t i = 0; i < splats->count; i++) {
    size_t slot = scene_grid_slot(&grid, scene_grid_cell(&grid, (double)splats->position[0][i]),
                                  scene_grid_cell(&grid, (double)splats->position[1][i]),
                                  scene_grid_cell(&grid, (double)splats->position[2][i]));
    grid.next[i] = grid.heads[slot];
    grid.heads[slot] = (int32_t)i;
  }
  return grid;
}

static inline void scene_grid_release(scene_grid *grid) {
  free(grid->heads);
  free(grid->next);
}

static inline double scene_grid_squared_distance(const scene_grid *grid, int32_t i, const double place[3]) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double d = (double)grid->splats->position[axis][i] - place[axis];
    sum += d * d;
  }
  return sum;
}

/* How many points lie within `radius` (at most a cell) of the place; *nearest gets the least of their distances, or
 * HUGE_VAL. */
static inline size_t scene_grid_look(const scene_grid *grid, const double place[3], double radius, double *nearest) {
  int64_t middle[3];
  size_t n = 0;
  double least = HUGE_VAL;
  for (int axis = 0; axis < 3; axis++)
    middle[axis] = scene_grid_cell(grid, place[axis]);
  for (int neighbour = 0; neighbour < 27; neighbour++) {
    int64_t cell[3] = {middle[0] + neighbour % 3 - 1, middle[1] + neighbour / 3 % 3 - 1, middle[2] + neighbour / 9 - 1};
    for (int32_t i = grid->heads[scene_grid_slot(grid, cell[0], cell[1], cell[2])]; i >= 0; i = grid->next[i]) {
      /* Different cells may share a slot: a point counts in its own only. */
      if (scene_grid_cell(grid, (double)grid->splats->position[0][i]) != cell[0] ||
          scene_grid_cell(grid, (double)grid->splats->position[1][i]) != cell[1] ||
          scene_grid_cell(grid, (double)grid->splats->position[2][i]) != cell[2])
        continue;
      double squared = scene_grid_squared_distance(grid, i, place);
      n += squared < radius * radius;
      if (squared < least && squared < radius * radius)
        least = squared;
    }
  }
  *nearest = sqrt(least);
  return n;
}
