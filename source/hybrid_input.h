/* The input of hybrid models: a mesh, or splats. */
#ifndef CONIC_HYBRID_INPUT_H
#define CONIC_HYBRID_INPUT_H

#include "conic/coloring.h"
#include "conic/hybrid.h"

typedef struct conic_hybrid_input {
  int is_points; /* the input is splats; else the mesh */
  conic_triangles mesh;
  conic_splats splats;
  double up[3]; /* the direction that the file states for points; zero: none */
} conic_hybrid_input;

/* How the input is read: null pointers and zeros are the defaults. */
typedef struct conic_hybrid_reading {
  const char *texture_path;
  const conic_coloring_options *coloring;
  int is_smooth;
  double crease_deg;
  float cutoff;
  int n_neighbours;
} conic_hybrid_reading;

/* Reads a mesh and gives it normals; or, from a file without faces, points, which get sizes where they have none. On
 * success the caller releases *input, or builds a model of it. Errors: as conic_mesh_read's and
 * conic_model_to_splats's. */
conic_status conic_hybrid_input_read(conic_context *context, const char *path, const conic_hybrid_reading *reading,
                                     conic_hybrid_input *input);
void conic_hybrid_input_release(conic_context *context, conic_hybrid_input *input);

/* conic_hybrid_build or conic_hybrid_build_points: *input is empty afterwards. `report` may be null. */
conic_status conic_hybrid_input_build(conic_context *context, conic_hybrid_input *input,
                                      const conic_hybrid_options *options, conic_hybrid **hybrid,
                                      conic_hybrid_report *report);

#endif
