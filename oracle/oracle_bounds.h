/* What a pixel in doubt may hold: bounds of every plane, whichever way each of its decisions falls. */
#pragma once

#include "oracle/oracle_triangle.h"

/* A contribution, and its share: `least` is 0 where it may be missing. */
typedef struct oracle_part {
  const oracle_fragment *fragment;
  double least, most;
} oracle_part;

/* The parts of a pixel. Their order is that of the fragments. */
typedef struct oracle_mixture {
  oracle_part *parts;
  size_t n;
} oracle_mixture;

/* The least and greatest Σ w (n·d) / Σ w over all weights and normals that the parts may have. */
void conic_oracle_mean_along(const oracle_mixture *mixture, const double d[3], double range[2]);

/* Ranges of the values that shading looks at: [0] the least and [1] the greatest of each component. */
typedef struct oracle_surface_range {
  double albedo[2][3], mean_normal[2][3], normal[2][3];
} oracle_surface_range;

/* What conic_oracle_shade may make of these. */
void conic_oracle_shade_range(const conic_camera *camera, const conic_render_options *options, double x, double y,
                              const oracle_mixture *mixture, const oracle_surface_range *range, double low[4],
                              double high[4]);

/* The directions of all vectors in a box; everything where the box holds 0. */
void conic_oracle_direction_range(const double box[2][3], double low[3], double high[3]);

/* What was found about pixels in doubt; the lists grow, and are their owner's to release. */
typedef struct oracle_doubts {
  conic_context *context;
  conic_alternative *alternatives;
  size_t n, room;
  conic_admissible_id *ids;
  size_t n_ids, id_room;
} oracle_doubts;

void conic_oracle_doubts_release(oracle_doubts *doubts);
/* Both copy what they are given. Errors: MEMORY. */
conic_status conic_oracle_doubts_add(oracle_doubts *doubts, const conic_alternative *alternative);
/* Each id is noted once; of more than ORACLE_MAX_IDS from number `first` on, only CONIC_ANY_ID is left. */
enum { ORACLE_MAX_IDS = 64 };
conic_status conic_oracle_doubts_admit(oracle_doubts *doubts, size_t first, uint32_t pixel, uint32_t id);

/* Room for the parts of a pixel, and for their order. */
typedef struct oracle_bounding {
  const conic_camera *camera;
  const conic_render_options *options;
  oracle_part *parts;
  uint32_t *order;
} oracle_bounding;

/* The alternatives of a pixel of `n` fragments of splats, behind which there is room for one more, and of rival
 * triangles, null where there are none. *is_unbounded is set where a plane's bounds say nothing. Errors: MEMORY. */
conic_status conic_oracle_bound(const oracle_bounding *room, double x, double y, uint32_t pixel,
                                oracle_fragment *fragments, size_t n, const oracle_rivals *rivals,
                                oracle_doubts *doubts, int *is_unbounded);
