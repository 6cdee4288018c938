#include "bench/chart_mesh.h"

#include <math.h>
#include <string.h>

#include "source/mesh_input.h"

const char *cli_chart_model_name(cli_chart_model representation) {
  static const char *const names[CLI_N_CHART_MODELS] = {"triangles", "surfels", "hybrid", "octree", "points"};
  return (unsigned)representation < CLI_N_CHART_MODELS ? names[representation] : NULL;
}

/* Hills of six sizes, lower on one side: something for every representation. */
static double height_at(double u, double v) {
  double height = 0.0, size = 0.12;
  for (int octave = 0; octave < 6; octave++, size *= 0.45) {
    double f = 5.0 * (double)(1 << octave);
    height += size * sin(f * u + 1.3 * octave) * sin(f * v + 0.7 * octave * octave);
  }
  return u > 0.7 ? 0.2 * height : height;
}

static void place_vertices(size_t side, conic_triangles *mesh) {
  for (size_t y = 0; y <= side; y++)
    for (size_t x = 0; x <= side; x++) {
      size_t i = y * (side + 1) + x;
      double u = (double)x / (double)side, v = (double)y / (double)side, height = height_at(u, v);
      double rise = fmin(1.0, fmax(0.0, 0.5 + 3.0 * height));
      const double at[3] = {u, height, v}, color[3] = {0.2 + 0.6 * rise, 0.5, 0.6 - 0.4 * rise};
      for (int k = 0; k < 3; k++) {
        mesh->position[k][i] = (float)at[k];
        mesh->color[k][i] = (float)color[k];
      }
    }
}

static conic_status make_terrain(conic_context *context, size_t side, conic_triangles *mesh) {
  conic_status status =
      conic_triangles_allocate(context, 2 * side * side, (side + 1) * (side + 1), CONIC_TRIANGLES_COLORS, mesh);
  if (status != CONIC_OK)
    return status;
  place_vertices(side, mesh);
  for (size_t y = 0; y < side; y++)
    for (size_t x = 0; x < side; x++) {
      uint32_t i = (uint32_t)(y * (side + 1) + x), below = i + (uint32_t)side + 1;
      const uint32_t both[2][3] = {{i, below, i + 1}, {i + 1, below, below + 1}};
      memcpy(mesh->corners + 2 * (y * side + x), both, sizeof both);
    }
  return CONIC_OK;
}

static conic_status read_mesh(cli_session *session, const char *path, size_t side, conic_triangles *mesh) {
  conic_status status =
      path ? conic_mesh_read(session->context, path, mesh) : make_terrain(session->context, side, mesh);
  if (status == CONIC_OK && !mesh->normal[0])
    status = conic_triangles_smooth(session->context, mesh);
  return status;
}

/* The vertices with axes from the faces about them; the faces are lent. */
static conic_status make_points(conic_context *context, const conic_triangles *mesh, conic_splats *points) {
  conic_estimate_options options;
  conic_model model = {.n_triangles = mesh->count, .triangles = mesh->corners, .kind = CONIC_MODEL_OBJ};
  unsigned fields = mesh->color[0] ? (unsigned)CONIC_SPLATS_COLORS : 0u;
  conic_status status = conic_splats_allocate(context, mesh->n_vertices, fields, &model.points);
  if (status != CONIC_OK)
    return status;
  memcpy(model.points.origin, mesh->origin, sizeof mesh->origin);
  for (int k = 0; k < 3; k++) {
    memcpy(model.points.position[k], mesh->position[k], mesh->n_vertices * sizeof(float));
    if (fields)
      memcpy(model.points.color[k], mesh->color[k], mesh->n_vertices * sizeof(float));
  }
  conic_estimate_options_init(&options);
  status = conic_model_to_splats(context, &options, &model, NULL);
  if (status == CONIC_OK)
    *points = model.points;
  else
    conic_splats_release(context, &model.points);
  return status;
}

static conic_status make_hybrid(cli_session *session, const char *path, size_t side,
                                const conic_hybrid_options *options, conic_source **source) {
  conic_hybrid *hybrid;
  conic_triangles mesh = {0}; /* once more: it is taken over */
  conic_status status = read_mesh(session, path, side, &mesh);
  if (status == CONIC_OK)
    status = conic_hybrid_build(session->context, &mesh, options, &hybrid, NULL);
  if (status == CONIC_OK)
    status = conic_source_of_hybrid(session->context, hybrid, source);
  conic_triangles_release(session->context, &mesh);
  return status;
}

/* One that chooses, and one of surfels only. */
static conic_status make_hybrids(cli_session *session, const char *path, size_t side, cli_chart_models *models) {
  conic_hybrid_options options;
  conic_hybrid_options_init(&options);
  conic_status status = make_hybrid(session, path, side, &options, &models->sources[CLI_CHART_HYBRID]);
  options.phase2 = 1e6;
  options.most_error = 0.0;
  options.has_single_levels = 1;
  return status == CONIC_OK ? make_hybrid(session, path, side, &options, &models->sources[CLI_CHART_SURFELS]) : status;
}

static conic_status make_octree(conic_context *context, conic_splats *points, conic_source **source) {
  conic_octree_options options;
  conic_octree *octree;
  conic_octree_options_init(&options);
  conic_status status = conic_octree_build(context, points, &options, &octree);
  return status == CONIC_OK ? conic_source_of_octree(context, octree, source) : status;
}

conic_status cli_chart_models_build(cli_session *session, const char *path, size_t side, cli_chart_models *models) {
  conic_context *context = session->context;
  conic_splats none = {0}, leaves = {0}, points = {0};
  conic_triangles mesh = {0};
  conic_status status = read_mesh(session, path, side, &mesh);
  if (status == CONIC_OK)
    status = make_points(context, &mesh, &leaves);
  if (status == CONIC_OK)
    status = make_points(context, &mesh, &points);
  if (status == CONIC_OK)
    status = conic_source_of_drawing(context, &none, &mesh, &models->sources[CLI_CHART_TRIANGLES]);
  if (status == CONIC_OK) {
    models->mesh = conic_source_chosen(models->sources[CLI_CHART_TRIANGLES])->drawing.triangles;
    status = make_hybrids(session, path, side, models);
  }
  if (status == CONIC_OK)
    status = make_octree(context, &leaves, &models->sources[CLI_CHART_OCTREE]);
  if (status == CONIC_OK)
    status = conic_source_of_drawing(context, &points, NULL, &models->sources[CLI_CHART_POINTS]);
  conic_splats_release(context, &leaves);
  conic_splats_release(context, &points);
  conic_triangles_release(context, &mesh);
  return status;
}

void cli_chart_models_release(cli_chart_models *models) {
  for (int i = 0; i < CLI_N_CHART_MODELS; i++)
    conic_source_close(models->sources[i]);
}

conic_status cli_chart_models_choose(cli_chart_models *models, cli_chart_model representation,
                                     const conic_camera *camera, double error_px, conic_render_options *options,
                                     conic_drawing *drawing) {
  conic_source *source = models->sources[representation];
  conic_source_view view;
  conic_source_view_init(&view);
  view.error_px = representation == CLI_CHART_SURFELS ? 0.0 : error_px; /* they stay as built */
  options->method = representation == CLI_CHART_POINTS ? CONIC_METHOD_POINT : CONIC_METHOD_CONIC;
  options->near_z = conic_source_measure(models->sources[CLI_CHART_TRIANGLES])->near_z;
  conic_source_settle(source, options);
  conic_status status = conic_source_choose(source, camera, options, &view);
  *drawing = conic_source_chosen(source)->drawing;
  return status;
}
