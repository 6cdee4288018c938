/* One mesh as everything that draws it: triangles, surfels, a hybrid, an octree, points. */
#ifndef CONIC_CHART_MODELS_H
#define CONIC_CHART_MODELS_H

#include "cli/session.h"

typedef enum cli_chart_model {
  CLI_CHART_TRIANGLES, /* the mesh itself */
  CLI_CHART_SURFELS,   /* a hybrid without triangles, as built */
  CLI_CHART_HYBRID,    /* of each cluster the cheapest level within the error */
  CLI_CHART_OCTREE,    /* the vertices as splats, no more of them than the error needs */
  CLI_CHART_POINTS     /* the vertices, a pixel each */
} cli_chart_model;

#define CLI_N_CHART_MODELS 5

/* "triangles", "surfels", "hybrid", "octree", "points". */
const char *cli_chart_model_name(cli_chart_model representation);

/* Zero before it is built. */
typedef struct cli_chart_models {
  conic_source *sources[CLI_N_CHART_MODELS];
  const conic_triangles *mesh; /* theirs */
} cli_chart_models;

/* Reads the mesh, or where `path` is null makes a terrain of side × side squares, and makes the others of it; all with
 * smooth normals where the file has none. Released by cli_chart_models_release, after a failure too. */
conic_status cli_chart_models_build(cli_session *session, const char *path, size_t side, cli_chart_models *models);
void cli_chart_models_release(cli_chart_models *models);

/* What that representation draws of the scene at this error, which is the models' until the next call. Sets in
 * `options` what is the representation's own: method, near distance and the length of its splats. */
conic_status cli_chart_models_choose(cli_chart_models *models, cli_chart_model representation,
                                     const conic_camera *camera, double error_px, conic_render_options *options,
                                     conic_drawing *drawing);

#endif
