#include "cli/judge/suite_files.h"

#include "core/files/disk.h"
#include "core/files/file.h"

conic_status cli_suite_join(conic_context *context, const char *folder, const char *path, char *full, size_t room) {
  const char *slash = folder[0] && conic_disk_is_separator(folder[strlen(folder) - 1]) ? "" : "/";
  int n = snprintf(full, room, "%s%s%s", folder, path[0] ? slash : "", path);
  return n > 0 && (size_t)n < room ? CONIC_OK
                                   : conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the name is too long", folder);
}

conic_status cli_suite_make_folder(suite_files *suite, const char *path) {
  char full[4096];
  conic_disk_entry found;
  conic_status status = cli_suite_join(suite->context, suite->folder, path, full, sizeof full);
  if (status != CONIC_OK || conic_disk_make_folder(full) ||
      (errno == EEXIST && conic_disk_look(full, &found) && found.is_folder))
    return status;
  return conic_fail(suite->context, CONIC_ERROR_IO, "%s: cannot make the folder: %s", full, strerror(errno));
}

conic_status cli_suite_add_file(suite_files *suite, const char *path) {
  char full[4096];
  unsigned char bytes[8192];
  size_t n = 0;
  conic_sha256 sum;
  suite_file *file = &suite->files[suite->n];
  conic_status status = cli_suite_join(suite->context, suite->folder, path, full, sizeof full);
  if (status == CONIC_OK && suite->n == SUITE_MOST_FILES)
    status = conic_fail(suite->context, CONIC_ERROR_ARGUMENT, "%s: too many files", full);
  FILE *from = status == CONIC_OK ? conic_disk_open_stream(full, "rb") : NULL;
  if (status == CONIC_OK && !from)
    status = conic_fail(suite->context, CONIC_ERROR_IO, "%s: cannot read it again: %s", full, strerror(errno));
  if (!from)
    return status;
  snprintf(file->path, sizeof file->path, "%s", path);
  file->bytes = 0;
  conic_sha256_begin(&sum);
  while ((n = fread(bytes, 1, sizeof bytes, from)) > 0) {
    conic_sha256_add(&sum, bytes, n);
    file->bytes += n;
  }
  conic_sha256_end(&sum, file->sha256);
  if (ferror(from))
    status = conic_fail(suite->context, CONIC_ERROR_IO, "%s: cannot read it again", full);
  fclose(from);
  suite->n++;
  return status;
}

conic_status cli_suite_open_file(suite_files *suite, const char *path, conic_output **output) {
  char full[4096];
  conic_status status = cli_suite_join(suite->context, suite->folder, path, full, sizeof full);
  return status == CONIC_OK ? conic_output_open(suite->context, full, output) : status;
}

conic_status cli_suite_end_file(suite_files *suite, const char *path, conic_output *output) {
  conic_status status = conic_output_commit(output);
  return status == CONIC_OK ? cli_suite_add_file(suite, path) : status;
}

conic_status cli_suite_write_text(suite_files *suite, const char *path, const char *text) {
  conic_output *output;
  conic_status status = cli_suite_open_file(suite, path, &output);
  if (status != CONIC_OK)
    return status;
  fputs(text, conic_output_stream(output));
  return cli_suite_end_file(suite, path, output);
}

/* --- cameras --- */

static conic_status write_own_camera(suite_files *suite, const suite_scene *scene, const conic_camera *camera) {
  char path[SUITE_PATH_ROOM];
  conic_output *output;
  snprintf(path, sizeof path, "cameras/%s.json", scene->name);
  conic_status status = cli_suite_open_file(suite, path, &output);
  if (status != CONIC_OK)
    return status;
  FILE *to = conic_output_stream(output);
  fprintf(to, "{\n  \"width\": %d,\n  \"height\": %d,\n  \"fx\": %.17g,\n  \"fy\": %.17g,\n", camera->width,
          camera->height, camera->fx, camera->fy);
  fprintf(to, "  \"cx\": %.17g,\n  \"cy\": %.17g,\n  \"world_to_camera\": [\n", camera->cx, camera->cy);
  for (int i = 0; i < 3; i++)
    fprintf(to, "    [%.17g, %.17g, %.17g, %.17g],\n", camera->cam_from_world[i][0], camera->cam_from_world[i][1],
            camera->cam_from_world[i][2], camera->cam_from_world[i][3]);
  fputs("    [0, 0, 0, 1]\n  ]\n}\n", to);
  return cli_suite_end_file(suite, path, output);
}

/* OpenGL's camera has y up and z backwards: these columns of the camera's rotation are negated. */
static conic_status write_transforms(suite_files *suite, const suite_scene *scene, const conic_camera *camera) {
  char path[SUITE_PATH_ROOM];
  conic_output *output;
  snprintf(path, sizeof path, "cameras/%s.transforms.json", scene->name);
  conic_status status = cli_suite_open_file(suite, path, &output);
  if (status != CONIC_OK)
    return status;
  FILE *to = conic_output_stream(output);
  fprintf(to, "{\n  \"camera_model\": \"PINHOLE\",\n  \"w\": %d,\n  \"h\": %d,\n  \"fl_x\": %.17g,\n", camera->width,
          camera->height, camera->fx);
  fprintf(to, "  \"fl_y\": %.17g,\n  \"cx\": %.17g,\n  \"cy\": %.17g,\n  \"frames\": [\n    {\n", camera->fy,
          camera->cx, camera->cy);
  fprintf(to, "      \"file_path\": \"%s.png\",\n      \"transform_matrix\": [\n", scene->name);
  for (int i = 0; i < 3; i++)
    fprintf(to, "        [%.17g, %.17g, %.17g, %.17g],\n", camera->cam_from_world[0][i],
            0.0 - camera->cam_from_world[1][i], 0.0 - camera->cam_from_world[2][i], scene->eye[i]);
  fputs("        [0, 0, 0, 1]\n      ]\n    }\n  ]\n}\n", to);
  return cli_suite_end_file(suite, path, output);
}

static conic_status write_colmap(suite_files *suite, const suite_scene *scene, const conic_camera *camera) {
  char path[SUITE_PATH_ROOM], text[1024];
  const double *q = scene->rotation;
  const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  snprintf(path, sizeof path, "cameras/%s", scene->name);
  conic_status status = cli_suite_make_folder(suite, path);
  snprintf(path, sizeof path, "cameras/%s/cameras.txt", scene->name);
  snprintf(text, sizeof text, "# CAMERA_ID MODEL WIDTH HEIGHT FX FY CX CY\n1 PINHOLE %d %d %.17g %.17g %.17g %.17g\n",
           camera->width, camera->height, camera->fx, camera->fy, camera->cx, camera->cy);
  if (status == CONIC_OK)
    status = cli_suite_write_text(suite, path, text);
  snprintf(path, sizeof path, "cameras/%s/images.txt", scene->name);
  snprintf(text, sizeof text,
           "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, and a line of points\n"
           "1 %.17g %.17g %.17g %.17g %.17g %.17g %.17g 1 %s.png\n\n",
           q[0] / length, q[1] / length, q[2] / length, q[3] / length, camera->cam_from_world[0][3],
           camera->cam_from_world[1][3], camera->cam_from_world[2][3], scene->name);
  if (status == CONIC_OK)
    status = cli_suite_write_text(suite, path, text);
  snprintf(path, sizeof path, "cameras/%s/points3D.txt", scene->name);
  return status == CONIC_OK ? cli_suite_write_text(suite, path, "# there are no points\n") : status;
}

conic_status cli_suite_write_camera(suite_files *suite, const suite_scene *scene) {
  conic_camera camera;
  cli_suite_camera(scene, &camera);
  conic_status status = write_own_camera(suite, scene, &camera);
  if (status == CONIC_OK)
    status = write_transforms(suite, scene, &camera);
  return status == CONIC_OK ? write_colmap(suite, scene, &camera) : status;
}
