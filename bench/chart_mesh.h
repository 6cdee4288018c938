/* The chart of representations: what draws a mesh best, by the size of its triangles on the screen. */
#ifndef CONIC_CHART_MESH_H
#define CONIC_CHART_MESH_H

#include "bench/chart.h"
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

#define CLI_MAX_MESH_SIZES 10

/* The picture of one size. */
typedef struct cli_mesh_size {
  double pixels_per_triangle; /* mean area on the screen, hidden or not */
  int edge;                   /* of the picture, in pixels */
  double zoom;                /* above 1 where the mesh does not fit into the largest picture */
  size_t covered;             /* pixels that the mesh touches */
} cli_mesh_size;

/* One representation at one size. */
typedef struct cli_mesh_point {
  double ms, lod_ms; /* a frame, and what of it was the choice of what to draw */
  size_t primitives; /* chosen */
  cli_chart_error error;
  size_t holes; /* pixels that the mesh fills and nothing was drawn in */
  int is_front; /* no other representation of this size is faster and nearer to the mesh */
} cli_mesh_point;

typedef struct cli_mesh_chart {
  const char *path; /* of the mesh; null: a generated terrain */
  int is_quick;
  size_t n_triangles;
  int n_sizes;
  cli_mesh_size sizes[CLI_MAX_MESH_SIZES];
  cli_mesh_point points[CLI_N_CHART_MODELS][CLI_MAX_MESH_SIZES];
} cli_mesh_chart;

/* Measures into a chart with path and is_quick set. */
conic_status cli_mesh_chart_measure(cli_session *session, cli_mesh_chart *chart);

/* FOLDER/representations.csv and representations.svg. */
conic_status cli_mesh_chart_write(const cli_session *session, const char *folder, const cli_mesh_chart *chart);

/* What is best for its time at each size, and where the others become cheaper than triangles. */
void cli_mesh_chart_print(const cli_mesh_chart *chart);

/* The pixels a triangle at which a representation takes as long as triangles, from large to small; returns how many.
 * Between two sizes both times are taken for powers of the size. */
int cli_mesh_chart_crossings(const cli_mesh_chart *chart, int model, double at[CLI_MAX_MESH_SIZES]);

/* Draws a cli_mesh_chart. */
void cli_mesh_chart_draw(FILE *to, const void *chart);

#endif
