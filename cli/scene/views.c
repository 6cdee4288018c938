#include "cli/scene/views.h"

#include "core/files/file.h"
#include "core/image/camera_shutter.h"

int cli_views_are_all(const char *view) {
  return view && strcmp(view, "all") == 0;
}

/* That one has to be chosen, of which. */
static conic_status ask_for_view(const cli_views_wish *wish, const conic_cameras *cameras) {
  enum { SHOWN = 3 };
  char names[512];
  size_t n = 0;
  names[0] = 0;
  for (size_t i = 0; i < SHOWN && i < cameras->count && *cameras->names[i]; i++) {
    int added = snprintf(names + n, sizeof names - n, "%s%.100s", i ? ", " : ": ", cameras->names[i]);
    n += added > 0 ? (size_t)added : 0;
  }
  cli_error(CLI_USAGE, "%s: it has %zu views%s%s; give --view INDEX (from 0), NAME or all, too", wish->path,
            cameras->count, names, n && cameras->count > SHOWN ? " …" : "");
  return CONIC_ERROR_ARGUMENT;
}

conic_status cli_views_read(cli_session *session, const cli_views_wish *wish, conic_cameras *cameras, size_t *i_view) {
  conic_cameras_options options;
  conic_cameras_options_init(&options);
  options.width = wish->width;
  options.height = wish->height;
  *i_view = 0;
  conic_status status = conic_cameras_read(session->context, wish->path, &options, cameras);
  if (status != CONIC_OK || cli_views_are_all(wish->view))
    return status;
  if (!wish->view)
    return cameras->count == 1 ? CONIC_OK : ask_for_view(wish, cameras);
  return conic_cameras_find(session->context, cameras, wish->view, i_view);
}

void cli_view_stem(const conic_cameras *cameras, size_t i_view, char *stem, size_t room) {
  const char *base = conic_file_name(cameras->names[i_view]), *dot = strrchr(base, '.');
  int length = dot && dot > base ? (int)(dot - base) : (int)strlen(base);
  if (*base)
    snprintf(stem, room, "%.*s", length, base);
  else
    snprintf(stem, room, "%04zu", i_view);
  if (*stem == '.') /* neither a hidden file nor a folder */
    *stem = '_';
}

static void write_pose(cli_json *json, const char *name, const double rows[3][4]) {
  cli_json_array(json, name);
  for (int row = 0; row < 4; row++) {
    cli_json_array(json, NULL);
    for (int column = 0; column < 4; column++)
      cli_json_number(json, NULL, row < 3 ? rows[row][column] : column == 3 ? 1.0 : 0.0);
    cli_json_close(json);
  }
  cli_json_close(json);
}

void cli_camera_write(cli_json *json, const conic_camera *camera) {
  cli_json_counts(json, NULL, {"width", (uint64_t)camera->width}, {"height", (uint64_t)camera->height});
  cli_json_figures(json, NULL, {"fx", camera->fx}, {"fy", camera->fy}, {"cx", camera->cx}, {"cy", camera->cy});
  if (camera->kind != CONIC_CAMERA_PERSPECTIVE)
    cli_json_text(json, "kind", conic_camera_kind_name((conic_camera_kind)camera->kind));
  if (camera->lens != CONIC_LENS_NONE) {
    cli_json_text(json, "lens", conic_lens_name((conic_lens)camera->lens));
    cli_json_array(json, "distortion");
    for (int i = 0; i < 8; i++)
      cli_json_number(json, NULL, camera->distortion[i]);
    cli_json_close(json);
  }
  write_pose(json, "world_to_camera", camera->cam_from_world);
  if (camera->shutter) {
    double end[3][4];
    conic_camera_shutter_end(camera, end);
    cli_json_text(json, "shutter", conic_shutter_name((conic_shutter)camera->shutter));
    write_pose(json, "world_to_camera_end", (const double(*)[4])end);
  }
}
