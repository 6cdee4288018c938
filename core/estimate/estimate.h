/* What the steps of an estimate share (core/estimate/estimate.c drives them). */
#ifndef CONIC_ESTIMATE_H
#define CONIC_ESTIMATE_H

#include <stdint.h>

#include "conic/model.h"
#include "core/estimate/neighbourhood.h"

/* What has become of a point. */
typedef enum conic_point_state {
  CONIC_POINT_RAW = 0,  /* has no axes yet */
  CONIC_POINT_KEPT,     /* came with good axes */
  CONIC_POINT_FACED,    /* got its axes from its faces */
  CONIC_POINT_SPREAD,   /* got its axes from its neighbours */
  CONIC_POINT_ISOLATED, /* the same, but kept small */
  CONIC_POINT_FAILED,
  CONIC_POINT_NOWHERE /* its position is not finite */
} conic_point_state;

typedef struct conic_estimate {
  const conic_model *model;
  double cutoff;
  uint8_t *states;     /* conic_point_state of each point */
  float *tangent_u[3]; /* of each point, beside the model's own: valid where FACED, SPREAD or ISOLATED */
  float *tangent_v[3];
  float *dot; /* of each point; null: none are looked for */
  conic_ellipse_rule rule;
  double tolerance; /* no outline of a vertex grows, for blending, farther than this from its faces */
} conic_estimate;

/* How far an outline reaches beyond the cell that it must cover: curved surfaces take the cells of neighbours
 * apart, and blending wants several outlines on each other. See docs/notes/estimation.md for what was tried. */
#define CONIC_OUTLINE_COVER 1.2
#define CONIC_OUTLINE_BLEND 1.4
#define CONIC_OUTLINE_RATIO 0.2 /* the least ratio of minor to major axis */

/* Whether conic_model_to_splats, without faces or features, would leave a set as it is, whatever its options. */
int conic_splats_need_no_repair(conic_context *context, const conic_splats *splats);

/* Does what conic_model_to_splats would to a set with axes and without clip lines, if no splat of it needs its
 * neighbours; else returns 0. Adds how many are nowhere. */
int conic_splats_repair_alone(conic_splats *splats, size_t *n_nowhere);

/* Gives points without axes those that conic_model_to_splats has made of the same model, without features: three of
 * each array, which the model takes over, and which of them are dots, where any is; else null. On failure the caller
 * still has them. Errors: MEMORY. */
conic_status conic_model_take_axes(conic_context *context, conic_model *model, float *const tangent_u[3],
                                   float *const tangent_v[3], float *dot);

/* The unit vector along vector i of three arrays; 0 where there is none. */
int conic_unit_vector(float *const arrays[3], size_t i, double unit[3]);

/* Gives the RAW vertices that have a face with an area their axes: FACED. Errors: ARGUMENT (more triangles than can be
 * numbered, an index out of range), MEMORY, CANCELLED. */
conic_status conic_estimate_from_faces(conic_context *context, conic_estimate *estimate);

/* How far a splat may stand out from a mesh of these vertices: less than a pixel of a picture that shows all of it. */
double conic_mesh_tolerance(const conic_splats *points);

/* Whether the points of a mesh that are in no triangle are what its maker left behind, and not there to be seen. */
static inline int conic_mesh_has_leftovers(size_t n_points, size_t n_loose) {
  return n_loose < n_points / 10;
}

/* Where a vertex's splat reaches farther from the mesh, or two of its triangles meet by more than the angle of that
 * cosine (-1: none do), it becomes one for each of the triangles, clipped to that: the first takes its place, the
 * others stand after all. Leftovers get axes that are no numbers, and are counted as failed where `repairs` is not
 * null. Errors: as above; the model is then as it was. */
conic_status conic_mesh_bound(conic_context *context, double cutoff, double cosine, conic_model *model,
                              conic_repairs *repairs);

/* The local spacing of the LISTED slots, by their own neighbours alone. */
conic_status conic_estimate_spacings(conic_context *context, const conic_neighbourhood *neighbourhood,
                                     double *spacings);

/* Gives the RAW points their axes, from their neighbours and the spacings: SPREAD, ISOLATED or FAILED.
 * Errors: CANCELLED. */
conic_status conic_estimate_from_neighbours(conic_context *context, conic_estimate *estimate,
                                            const conic_neighbourhood *neighbourhood, const double *spacings);

#endif
