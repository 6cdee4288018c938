/* What the steps of an estimate share; core/estimate/estimate.c runs them. */
#pragma once

#include "conic/model.h"
#include "core/estimate/neighbourhood.h"

/* The state of a point. */
typedef enum conic_point_state {
  CONIC_POINT_RAW = 0,  /* has no axes yet */
  CONIC_POINT_KEPT,     /* came with good axes */
  CONIC_POINT_FACED,    /* got its axes from its faces */
  CONIC_POINT_SPREAD,   /* got its axes from its neighbours */
  CONIC_POINT_ISOLATED, /* as SPREAD, but kept small */
  CONIC_POINT_FAILED,
  CONIC_POINT_NOWHERE /* its position is not finite */
} conic_point_state;

typedef struct conic_estimate {
  const conic_model *model;
  double cutoff;
  uint8_t *states;     /* conic_point_state of each point */
  float *tangent_u[3]; /* of each point, beside the model's own: valid where FACED, SPREAD or ISOLATED */
  float *tangent_v[3];
  float *dot; /* of each point; null: dots are not looked for */
  conic_ellipse_rule rule;
  double tolerance; /* for blending, no vertex's outline grows farther than this from its faces */
} conic_estimate;

/* How far an outline reaches beyond the cell that it must cover: on curved surfaces the cells of neighbours move apart,
 * and blending needs overlapping outlines. docs/notes/estimation.md says what was tried. */
#define CONIC_OUTLINE_COVER 1.2
#define CONIC_OUTLINE_BLEND 1.4
#define CONIC_OUTLINE_RATIO 0.2 /* the least ratio of minor to major axis */

/* Whether conic_model_to_splats, without faces or features, would leave a set unchanged, with any options. */
int conic_splats_need_no_repair(conic_context *context, const conic_splats *splats);

/* Does what conic_model_to_splats would do to a set with axes and without clip lines, if no splat of it needs its
 * neighbours; else returns 0. Adds the number of splats whose position is not finite. */
int conic_splats_repair_alone(conic_splats *splats, size_t *n_nowhere);

/* Gives points without axes the axes that conic_model_to_splats made of the same model, without features: three of each
 * array, which the model takes over. `dot` says which are dots; null: none is. On failure the caller still owns the
 * arrays. Errors: MEMORY. */
conic_status conic_model_take_axes(conic_context *context, conic_model *model, float *const tangent_u[3],
                                   float *const tangent_v[3], float *dot);

/* The unit vector along vector i of three arrays; returns 0 where it has no direction. */
int conic_unit_vector(float *const arrays[3], size_t i, double unit[3]);

/* Gives the RAW vertices that have a face with an area their axes: FACED. Errors: ARGUMENT (more triangles than can be
 * numbered, an index out of range), MEMORY, CANCELLED. */
conic_status conic_estimate_from_faces(conic_context *context, conic_estimate *estimate);

/* How far a splat may stand out from a mesh of these vertices: less than a pixel of a picture that shows the whole
 * mesh. */
double conic_mesh_tolerance(conic_context *context, const conic_splats *points);

/* Whether the points of a mesh without a triangle are leftovers of its maker, not meant to be seen. */
static inline int conic_mesh_has_leftovers(size_t n_points, size_t n_loose) {
  return n_loose < n_points / 10;
}

/* Replaces a vertex's splat by one for each of its triangles, clipped to the triangle, where the splat reaches farther
 * from the mesh than allowed, or two of the triangles meet at more than the angle of that cosine (-1: ignored). The
 * first takes the vertex's place, the others come after all. Leftovers get NaN axes, and count as failed where
 * `repairs` is not null. Errors: as above; the model is then as it was. */
conic_status conic_mesh_bound(conic_context *context, double cutoff, double cosine, conic_model *model,
                              conic_repairs *repairs);

/* The local spacing of the LISTED slots, from their own neighbours alone. */
conic_status conic_estimate_spacings(conic_context *context, const conic_neighbourhood *neighbourhood,
                                     double *spacings);

/* Gives the RAW points their axes, from their neighbours and the spacings, which it uses up: SPREAD, ISOLATED or
 * FAILED. Errors: CANCELLED. */
conic_status conic_estimate_from_neighbours(conic_context *context, conic_estimate *estimate,
                                            const conic_neighbourhood *neighbourhood, double *spacings);
