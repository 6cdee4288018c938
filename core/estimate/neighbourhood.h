/* A set's points with their neighbours and normals, slot by slot, from which ellipses are estimated. */
#pragma once

#include "core/base/team_runs.h"
#include "core/estimate/neighbours.h"

enum { CONIC_MAX_NEIGHBOURS = 64 };

/* Flags of a slot, as bits. */
enum {
  CONIC_SLOT_WANTED = 1,     /* its ellipse will be estimated */
  CONIC_SLOT_LISTED = 2,     /* its neighbours are known */
  CONIC_SLOT_GUESSED = 4,    /* its normal comes from the neighbours' positions */
  CONIC_SLOT_NEAR = 8,       /* a neighbour of a WANTED slot */
  CONIC_SLOT_SCATTERED = 16, /* no surface is near it */
};

typedef struct conic_neighbourhood {
  conic_neighbours tree;
  size_t n_neighbours;  /* of each slot: the requested number, or all others where there are fewer */
  uint32_t *neighbours; /* of slot i from [i · n_neighbours] on, nearest first; valid where LISTED */
  uint8_t *flags;       /* by slot */
  float (*normals)[3];  /* by slot: unit; zero where not known */
} conic_neighbourhood;

/* Builds the tree, with room for the rest; flags and normals are zero. On success the caller releases it; on failure it
 * is empty. Errors: ARGUMENT, MEMORY. */
conic_status conic_neighbourhood_create(conic_context *context, const float *const positions[3], size_t count,
                                        size_t n_neighbours, conic_neighbourhood *neighbourhood);
void conic_neighbourhood_release(conic_context *context, conic_neighbourhood *neighbourhood);

/* Finds the neighbours of the slots that have a bit of `flags` and are not LISTED, and makes them LISTED. The progress
 * of "estimate" goes from `from` to `to`. Errors: CANCELLED. */
conic_status conic_neighbourhood_list(conic_context *context, conic_neighbourhood *neighbourhood, unsigned flags,
                                      double from, double to);

/* Gives the neighbours of all slots that have a bit of `flags` the bits `more`. */
void conic_neighbourhood_spread(conic_neighbourhood *neighbourhood, unsigned flags, unsigned more);

/* A piece of work on the slots [begin, end). */
typedef void conic_slots_task(void *data, size_t begin, size_t end);

/* Does all slots on all threads, and reports the progress of "estimate". Errors: CANCELLED. */
conic_status conic_slots_for(conic_context *context, size_t n_slots, conic_slots_task *task, void *data, double from,
                             double to);

/* conic_slots_for for long work, which a team shares: the task makes for each slot the values of n columns
 * (core/base/team_runs.h), and changes nothing else. Errors: CANCELLED, MEMORY. */
conic_status conic_slots_share(conic_context *context, size_t n_slots, conic_slots_task *task, void *data, double from,
                               double to, const conic_team_column *columns, size_t n);

static inline const uint32_t *conic_neighbourhood_of(const conic_neighbourhood *neighbourhood, size_t slot) {
  return neighbourhood->neighbours + slot * neighbourhood->n_neighbours;
}

static inline void conic_neighbourhood_position(const conic_neighbourhood *neighbourhood, size_t slot,
                                                double position[3]) {
  for (int axis = 0; axis < 3; axis++)
    position[axis] = (double)neighbourhood->tree.position[axis][slot];
}

/* The spread of points about a slot: their covariance, summed about the slot itself, where the numbers are small. */

typedef struct conic_covariance {
  double origin[3]; /* the slot's position; it adds only to the sums' number */
  double count, sum[3], products[6];
} conic_covariance;

conic_covariance conic_covariance_about(const conic_neighbourhood *neighbourhood, size_t slot);

/* Adds n slots. */
void conic_covariance_add(conic_covariance *covariance, const conic_neighbourhood *neighbourhood, const uint32_t *slots,
                          size_t n);

/* The matrix {xx, xy, xz, yy, yz, zz} about the mean, times the number of points. */
void conic_covariance_matrix(const conic_covariance *covariance, double matrix[6]);

/* Normals for points that have none: across the neighbours' plane, with one side for a whole surface. */

/* Gives every GUESSED (and LISTED) slot its normal, up to the sign: the direction in which the slot and its neighbours
 * spread least. Errors: CANCELLED. */
conic_status conic_normals_guess(conic_context *context, conic_neighbourhood *neighbourhood, double from, double to);

/* Turns GUESSED normals to where their points were seen from, where that is clear; these are then no longer GUESSED. */
void conic_normals_turn_to_sights(conic_neighbourhood *neighbourhood, float *const sight[3]);

/* Settles the signs of the GUESSED normals along the most reliable links between neighbours (a minimum spanning tree):
 * like the given normals where a surface has some; else outwards, as seen from the middle of the connected part.
 * Errors: MEMORY. */
conic_status conic_normals_orient(conic_context *context, conic_neighbourhood *neighbourhood);

/* Which points lie on no surface: foliage, wires, noise. */

/* Marks LISTED slots without a surface around them as SCATTERED. Their normals must be known, up to the sign. Errors:
 * MEMORY, CANCELLED. */
conic_status conic_scatter_find(conic_context *context, conic_neighbourhood *neighbourhood, double from, double to);

/* The reach of a dot at a slot, and its normal, which points outwards; zero where the neighbours do not tell. */
double conic_scatter_reach(const conic_neighbourhood *neighbourhood, size_t slot);
void conic_scatter_outside(const conic_neighbourhood *neighbourhood, size_t slot, double normal[3]);
