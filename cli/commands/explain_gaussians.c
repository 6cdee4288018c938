/* conic explain for a Gaussian scene: what a pixel is composited of, and which decisions rounding may turn either
 * way. */
#include "cli/commands/gaussian_commands.h"
#include "cli/render/sample_options.h"
#include "cli/scene/surfaces_drawn.h"

/* A number alone, or an array of several. */
static void write_list(cli_json *json, const char *key, const double *values, int n) {
  if (n == 1)
    cli_json_number(json, key, values[0]);
  else
    cli_json_numbers(json, key, values, n);
}

void cli_explain_planes(cli_json *json, const conic_image *image, int x, int y) {
  const size_t at = (size_t)y * (size_t)image->width + (size_t)x;
  cli_json_object(json, "planes");
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    const conic_plane_description *plane = conic_plane_describe((conic_plane)i);
    double values[4];
    for (size_t c = 0; image->planes[i] && c < (size_t)plane->n_channels; c++)
      values[c] = plane->is_uint ? (double)((const uint32_t *)image->planes[i])[(size_t)plane->n_channels * at + c]
                                 : (double)((const float *)image->planes[i])[(size_t)plane->n_channels * at + c];
    if (image->planes[i])
      write_list(json, plane->name, values, plane->n_channels);
  }
  cli_json_close(json);
}

/* Writes the range that floats may give. */
static void write_bounds(cli_json *json, const conic_gaussian_bound *b) {
  static const struct {
    const char *name;
    int at, n;
  } planes[] = {{"rgb", CONIC_BOUND_RGB, 3},
                {"T", CONIC_BOUND_T, 1},
                {"Z", CONIC_BOUND_Z, 1},
                {"medianZ", CONIC_BOUND_MEDIAN_Z, 1},
                {"inverseZ", CONIC_BOUND_INVERSE_Z, 1},
                {"count", CONIC_BOUND_COUNT, 1}};
  cli_json_object(json, "bounds");
  for (size_t i = 0; i < sizeof planes / sizeof *planes; i++) {
    cli_json_object(json, planes[i].name);
    write_list(json, "value", b->value + planes[i].at, planes[i].n);
    write_list(json, "low", b->least + planes[i].at, planes[i].n);
    write_list(json, "high", b->most + planes[i].at, planes[i].n);
    cli_json_close(json);
  }
  cli_json_close(json);
}

static void write_doubts(cli_json *json, unsigned doubts) {
  cli_json_array(json, "doubt");
  for (int k = 0; k < CONIC_N_GAUSSIAN_DOUBTS; k++)
    if (doubts >> k & 1)
      cli_json_text(json, NULL, conic_gaussian_doubt_name((conic_gaussian_doubt)k));
  cli_json_close(json);
}

static void write_entry(cli_json *json, const conic_gaussian_entry *e) {
  const double q[2] = {e->q_low, e->q_high}, alpha[2] = {e->alpha_low, e->alpha_high};
  cli_json_object(json, NULL);
  cli_json_count(json, "gaussian", e->index);
  cli_json_text(json, "verdict", conic_gaussian_part_name(e->part));
  cli_json_figures(json, NULL, {"key", e->key}, {"depth", e->z}, {"q", e->q});
  write_list(json, "q_range", q, 2);
  cli_json_number(json, "alpha", e->alpha);
  write_list(json, "alpha_range", alpha, 2);
  if (e->part == CONIC_PART_COMPOSITED) {
    cli_json_figures(json, NULL, {"before", e->before}, {"weight", e->weight}, {"after", e->after});
  }
  write_list(json, "color", e->color, 3);
  cli_json_number(json, "opacity", e->opacity);
  write_doubts(json, e->doubts);
  cli_json_close(json);
}

static void write_listing(cli_json *json, const conic_gaussian_listing *listing) {
  size_t counts[CONIC_N_GAUSSIAN_PARTS] = {0};
  for (size_t i = 0; i < listing->n; i++)
    counts[listing->entries[i].part]++;
  write_bounds(json, &listing->bound);
  cli_json_text(json, "end", listing->has_ended ? "stop" : "all");
  cli_json_count(json, "doubts", listing->bound.doubts);
  write_doubts(json, listing->bound.kinds);
  cli_json_object(json, "counts");
  for (int k = 0; k < CONIC_N_GAUSSIAN_PARTS; k++)
    cli_json_count(json, conic_gaussian_part_name((conic_gaussian_part)k), counts[k]);
  cli_json_close(json);
  if (listing->has_surface) {
    cli_json_object(json, "surface");
    cli_json_count(json, "id", listing->surface_id);
    cli_json_figures(json, NULL, {"depth", listing->surface_z}, {"weight", listing->surface_weight});
    write_list(json, "color", listing->surface_color, 3);
    cli_json_close(json);
  }
  cli_json_array(json, "contributions");
  for (size_t i = 0; i < listing->n; i++)
    write_entry(json, &listing->entries[i]);
  cli_json_close(json);
}

static int write_explanation(cli_session *session, const cli_render_job *scene, const conic_image *image, int x, int y,
                             const conic_gaussian_listing *listing) {
  cli_json *json;
  const double pixel[2] = {x, y};
  int exit_code = cli_json_open(session, &json);
  if (!json)
    return exit_code;
  cli_json_text(json, "profile", conic_gaussian_profile_name(scene->shot.gaussians.profile));
  cli_json_counts(json, NULL, {"width", (uint64_t)image->width}, {"height", (uint64_t)image->height});
  write_list(json, "pixel", pixel, 2);
  cli_explain_planes(json, image, x, y);
  write_listing(json, listing);
  return cli_json_finish(json);
}

int cli_explain_composited(cli_session *session, cli_render_job *scene, int x, int y) {
  const conic_gaussian_options options = cli_gaussian_options(scene);
  conic_gaussian_listing listing = {.n = 0};
  conic_image image = {.width = 0};
  cli_surfaces_drawn drawn = {.given = NULL};
  conic_camera camera;
  conic_status status = cli_sample_camera(session, scene, &camera);
  if (status == CONIC_OK && (x >= camera.width || y >= camera.height))
    return cli_usage("explain: the pixel %d,%d is not in a picture of %d x %d", x, y, camera.width, camera.height);
  if (status == CONIC_OK)
    status = conic_image_allocate(session->context, camera.width, camera.height, CLI_COMPOSITED_PLANES, &image);
  if (status == CONIC_OK)
    status = conic_source_draw(scene->source, scene->renderer, &camera, &scene->shot.render, &scene->shot.view, &image,
                               &scene->statistics);
  if (status == CONIC_OK)
    status = cli_draw_surfaces(scene, &camera, CLI_COMPOSITED_PLANES, &drawn);
  if (status == CONIC_OK)
    status = conic_gaussian_explain(session->context, conic_source_gaussians(scene->source), &camera, &options, NULL,
                                    drawn.given, x, y, &listing);
  int exit_code = status == CONIC_OK ? write_explanation(session, scene, &image, x, y, &listing) : cli_exit_of(status);
  conic_gaussian_listing_release(session->context, &listing);
  conic_image_release(session->context, &drawn.image);
  conic_image_release(session->context, &image);
  return exit_code;
}
