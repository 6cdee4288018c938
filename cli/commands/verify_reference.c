#include "cli/commands/verify_reference.h"

conic_status cli_reference_check_size(const char *path, const conic_image *image, const conic_camera *camera) {
  if (image->width == camera->width && image->height == camera->height)
    return CONIC_OK;
  cli_error(CLI_INPUT, "%s: it has %d x %d pixels, and the picture to compare with %d x %d", path, image->width,
            image->height, camera->width, camera->height);
  return CONIC_ERROR_INPUT;
}

/* A picture from a file has the names of the choice, where the oracle has indices. */
static void name_reference(const conic_source_choice *choice, conic_reference *r) {
  const uint32_t *names = choice->ids;
  size_t n_names = choice->drawing.splats ? choice->drawing.splats->count : 0;
  double *ids = r->planes[CONIC_PLANE_ID];
  for (size_t i = 0; names && i < r->n_pixels; i++)
    if (ids[i] < (double)n_names)
      ids[i] = (double)names[(size_t)ids[i]];
  for (size_t i = 0; names && i < r->n_ids; i++)
    if (r->ids[i].id < n_names)
      r->ids[i].id = names[r->ids[i].id];
}

conic_status cli_reference_draw(cli_session *session, const cli_render_job *scene, const conic_camera *camera,
                                conic_oracle_question question, conic_float_kind floats, size_t n_pixels,
                                int is_from_file, conic_reference *reference) {
  const conic_source_choice *choice = conic_source_chosen(scene->source);
  const conic_splats *splats = choice->drawing.splats;
  conic_render_options options = scene->shot.render;
  int is_at_rest = !scene->accumulating.motion; /* moving splats keep their length at rest */
  if (choice->is_all && !(splats && splats->dot) && is_at_rest)
    options.splat_length = 0.0; /* the oracle gets all splats as they are kept, and measures them itself */
  conic_oracle_asking asking;
  conic_oracle_asking_init(&asking);
  asking.question = question;
  asking.samples = scene->shot.view.samples;
  asking.n_pixels = n_pixels;
  asking.floats = floats;
  conic_status status =
      conic_oracle_render_asked(session->context, &choice->drawing, camera, &options, &asking, reference);
  if (status == CONIC_OK && is_from_file)
    name_reference(choice, reference);
  return status;
}

void cli_fault_members(cli_json *json, const conic_oracle_fault *fault) {
  cli_json_counts(json, NULL, {"x", (uint64_t)fault->x}, {"y", (uint64_t)fault->y});
  cli_json_text(json, "plane", conic_plane_describe((conic_plane)fault->plane)->name);
  cli_json_count(json, "channel", (uint64_t)fault->channel);
  cli_json_figures(json, NULL, {"found", fault->found}, {"low", fault->low}, {"high", fault->high});
}

void cli_report_fault(cli_json *json, const char *key, const conic_oracle_fault *fault) {
  cli_json_object(json, key);
  cli_fault_members(json, fault);
  cli_json_close(json);
}
