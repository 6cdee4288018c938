/* From many points the few that stand for them: no two nearer than a distance, and none of the many farther from
 * one of them than that (a Poisson-disc set that has room for no more). */
#pragma once

#include "core/base/base.h"
#include "core/lanes/instruction_sets.h"

/* A set of points in a grid of cells, and room for what choosing them needs; each thread has its own. Coordinates are
 * steps of the file's grid, below 2²¹, and so are lengths. */
typedef struct conic_thinner conic_thinner;

/* For up to `most_points`. Errors: MEMORY. */
conic_status conic_thinner_create(conic_context *context, size_t most_points, conic_thinner **thinner);
void conic_thinner_destroy(conic_context *context, conic_thinner *thinner);

/* What that takes. */
size_t conic_thinner_bytes(size_t most_points);

/* Loads the n points with these keys, to choose from. Later calls speak of them in this order. */
void conic_thinner_load(conic_thinner *thinner, const uint64_t *keys, size_t stride_bytes, size_t n);

/* Chooses about `target` of the loaded points, and no more than `most`. *distance is a guess of the distance, and then
 * the one that was taken. Returns how many; is_chosen[i] says which. They stay in the grid for conic_thinner_reach. */
size_t conic_thinner_choose(conic_thinner *thinner, size_t target, size_t most, double *distance, uint8_t *is_chosen);

/* The greatest distance of the n points of these keys from a chosen one, plus `beyond`; or `reach` where that is more.
 * The greatest of several sets is the same in whichever order they come. Several threads may ask. */
double conic_thinner_reach(const conic_thinner *thinner, const uint64_t *keys, size_t n, double beyond, double reach);

/* Chosen points by their numbers in the grid's order. */
typedef struct conic_thinner_row {
  uint32_t begin, end;
} conic_thinner_row;

enum { CONIC_THINNER_ROWS = 256 }; /* more than points have room for there */
typedef struct conic_thinner_rows {
  size_t n;
  conic_thinner_row list[CONIC_THINNER_ROWS];
} conic_thinner_rows;

/* Lists chosen points about a place: all within the distance of it, or, `is_wide`, all within twice that. */
void conic_thinner_beside(const conic_thinner *thinner, const float at[3], int is_wide, conic_thinner_rows *rows);

/* The square of a distance within which all are listed if `is_wide`. */
float conic_thinner_beside2(const conic_thinner *thinner);

/* The number of the point that was chosen first. */
uint32_t conic_thinner_first(const conic_thinner *thinner);

/* numbers[i] is how many chosen points were loaded before number i of the grid's order. Returns how many were chosen.
 */
size_t conic_thinner_numbers(const conic_thinner *thinner, uint32_t *numbers);

/* --- how far full resolution is from the discs that stand for it (layers_discs_body.h) --- */

/* A sample as it is drawn; lengths in steps of the grid. */
typedef struct conic_layers_disc {
  float center[3], normal[3], radius;
  const uint8_t *code; /* of the normal, where that is not known yet; only `error` below allows this */
} conic_layers_disc;

struct conic_layers_chosen;
typedef struct conic_layers_disc_loops {
  /* The farthest that a disc, at its middle and at 16 places around it, is from the nearest of n discs; where it is no
   * more than `enough`, any number that is not. */
  float (*off)(const conic_layers_disc *disc, const conic_layers_disc *from, size_t n, float enough);
  /* The greatest distance of the n discs from the chosen ones, plus `beyond`, by which they are off already; or `error`
   * where that is more. It is a bound where one disc holds all of another; else it is measured at the middle and at 16
   * places around it. The greatest of several sets is the same in whichever order they come. */
  double (*error)(const struct conic_layers_chosen *chosen, const conic_layers_disc *discs, size_t n, double beyond,
                  double error);
} conic_layers_disc_loops;

CONIC_DECLARE_LOOPS(conic_layers_disc_loops);

/* The discs of the points that a thinner has chosen, in the grid's order, as columns; so many more of each can be read.
 * Several threads may look. */
enum { CONIC_CHOSEN_BEHIND = 16 };
typedef struct conic_layers_chosen {
  const conic_thinner *thinner;
  float *center[3], *normal[3], *radius;
  conic_layers_disc_loops loops;
} conic_layers_chosen;

/* Gives the chosen discs memory, which the caller releases by center[0]. Errors: MEMORY, UNSUPPORTED. */
conic_status conic_layers_chosen_create(conic_context *context, const conic_thinner *thinner, size_t n,
                                        conic_layers_chosen *chosen);
void conic_layers_chosen_put(const conic_layers_chosen *chosen, size_t i, const conic_layers_disc *disc);
