/* From many points the few that stand for them: no two nearer than a distance, and none of the many farther from
 * one of them than that (a Poisson-disc set that has room for no more). */
#ifndef CONIC_LAYERS_THIN_H
#define CONIC_LAYERS_THIN_H

#include <stddef.h>
#include <stdint.h>

#include "conic/context.h"

/* A set of points in a grid of cells, and room for what choosing them needs; each thread has its own. Coordinates are
 * steps of the file's grid, below 2²¹, and so are lengths. */
typedef struct conic_thinner conic_thinner;

/* For up to `most_points`. Errors: MEMORY. */
conic_status conic_thinner_create(conic_context *context, size_t most_points, conic_thinner **thinner);
void conic_thinner_destroy(conic_context *context, conic_thinner *thinner);

/* What that takes. */
size_t conic_thinner_bytes(size_t most_points);

/* Makes the n points with these keys the ones that are chosen from; in the order in which they are given later. */
void conic_thinner_load(conic_thinner *thinner, const uint64_t *keys, size_t stride_bytes, size_t n);

/* Chooses about `target` of the loaded points, and no more than `most`; *distance is a guess of the distance, and the
 * one that was taken. Returns how many; is_chosen[i] says which. They stay in the grid for conic_thinner_reach. */
size_t conic_thinner_choose(conic_thinner *thinner, size_t target, size_t most, double *distance, uint8_t *is_chosen);

/* How far the n points of these keys are at most from a chosen one, `beyond` added to each; `reach` where that is more.
 * The greatest of several is the same in whichever order they come; several threads may ask. */
double conic_thinner_reach(const conic_thinner *thinner, const uint64_t *keys, size_t n, double beyond, double reach);

/* Chosen points about a place, by their numbers in the order in which they were chosen, up to `most`: all within the
 * distance of it, or, `is_wide`, all within twice that. Returns how many. */
size_t conic_thinner_beside(const conic_thinner *thinner, const float at[3], int is_wide, uint32_t *list, size_t most);

/* Of the chosen points, in the order in which they were, which each is in the order of the loaded ones. Returns how
 * many there are. */
size_t conic_thinner_ranks(const conic_thinner *thinner, uint32_t *ranks);

#endif
