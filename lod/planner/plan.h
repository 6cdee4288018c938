/* Finds the least error on the screen that a number of primitives can give: of trees in which nodes stand for what is
 * below them, as in octrees and layered clouds; and of whatever can be chosen for an error, as in hybrid models. */
#pragma once

#include <stdint.h>

#include "conic/context.h"

/* A node gives way to its children once the error asked for is below `px`: its own and those of all nodes above, for
 * these have given way before. Then there are `change` more primitives. */
typedef struct conic_plan_opening {
  double px;
  int64_t change;
} conic_plan_opening;

typedef struct conic_plan_tree {
  const void *data;
  size_t n_nodes;
  /* Lists the nodes in sight that give way above `low_px`, and returns how many. There is room for all nodes.
   * `*n_first` becomes how many primitives there are where none gives way. */
  size_t (*open)(const void *data, double low_px, conic_plan_opening *openings, uint64_t *n_first);
} conic_plan_tree;

/* Finds the least error for which there are no more than `budget` primitives: that of a node, or 0. Where there are
 * more even if no node gives way it is infinite. Errors: MEMORY. */
conic_status conic_plan_fit_tree(conic_context *context, const conic_plan_tree *tree, uint64_t budget,
                                 double *error_px);

/* What takes so many primitives for an error; `*reached_px` is the error, and becomes the greatest of what was chosen,
 * for which the same would be. */
typedef uint64_t conic_plan_choose(void *data, double error_px, double *reached_px);

/* Halves the errors above `low_px`, for which the budget is not enough, to one for which it is while it is not for the
 * next less: the least of all, if the number never grows with the error. Returns whether there is any. */
int conic_plan_fit(conic_plan_choose *choose, void *data, uint64_t budget, double low_px, double *error_px);
