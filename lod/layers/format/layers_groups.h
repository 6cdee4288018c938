/* Samples of a place in groups, each of which is drawn as one ellipse. How they are parted follows from their places on
 * the grid alone, so that who builds a file and who draws it part them alike. */
#pragma once

#include "lod/layers/format/layers_format.h"

/* A sample or an ellipse as it is drawn. */
typedef struct conic_layers_disc {
  float center[3], normal[3];
  float radius, longer; /* half axes of the outline; equal: it is a circle */
  float major[3];       /* unit, along the longer one; of a circle, zero */
} conic_layers_disc;

/* A group's members are order[begin] … order[end − 1], ascending. */
typedef struct conic_layers_group {
  uint32_t begin, end;
  double spread;  /* the sum of the members' squared distances from their mean; 0: they coincide */
  int axis;       /* along which they spread most, */
  uint64_t limit; /* and up to which sum of (step × members) they are on the first side */
} conic_layers_group;

/* Room for grouping; zero before the first use. */
typedef struct conic_layers_grouping {
  size_t n, n_groups, room;
  uint32_t (*steps)[3];
  uint32_t *order, *spare;
  conic_layers_group *groups; /* a heap: the first spreads most */
} conic_layers_grouping;

/* Room for n samples; what was there is lost. Errors: MEMORY. */
conic_status conic_layers_grouping_reserve(conic_context *context, conic_layers_grouping *grouping, size_t n);

/* Puts n samples into one group. Errors: MEMORY. */
conic_status conic_layers_group_all(conic_context *context, conic_layers_grouping *grouping, const uint64_t *keys,
                                    size_t n);
void conic_layers_grouping_release(conic_context *context, conic_layers_grouping *grouping);

/* Parts the group that spreads most until there are so many, or all members of each coincide. */
void conic_layers_part_groups(conic_layers_grouping *grouping, size_t n_groups);

/* Brings the groups into the order of their first members. They cannot be parted any more. */
void conic_layers_sort_groups(conic_layers_grouping *grouping);

/* The ellipse that stands for the group's members: about their mean, in the plane of their mean normal. Seen along
 * that, it holds all of them. */
void conic_layers_fit_group(const conic_layers_grouping *grouping, const conic_layers_group *group,
                            const conic_layers_disc *members, int is_unoriented, conic_layers_disc *ellipse);

/* Unit vectors along its axes, the longer one first. */
void conic_layers_disc_axes(const conic_layers_disc *disc, float u[3], float v[3]);

/* How large a sample is in its group, where it is drawn with `reach` at least by itself: for ellipses overlap, and hold
 * what lies between their samples. */
static inline float conic_layers_member_radius(float own, float reach) {
  float least = 0.8f * reach;
  return own > least ? own : least;
}

/* Where groups are drawn, a place is drawn as a quarter of its samples, and a leaf as half of them or all, too. */
static inline uint32_t conic_layers_part_of(uint32_t n_drawn, uint32_t one_in) {
  return (n_drawn + one_in - 1) / one_in;
}
