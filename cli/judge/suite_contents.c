/* The suite's scenes as files. */
#include "cli/judge/khr_assets.h"
#include "core/files/file.h"
#include "core/files/zip.h"
#include "gaussians/formats/gaussian_formats.h"
#include "gaussians/scene/activation.h"

static float to_steps(double value, double steps, double offset, double most) {
  double code = floor((value - offset) * steps + 0.5);
  code = code < 0.0 ? 0.0 : code > most ? most : code;
  return (float)(code / steps + offset);
}

/* Rounds the three smaller components of a unit quaternion to codes of 9 bits; the largest follows from them. */
static void settle_rotation(conic_gaussians *set, size_t i) {
  double q[4], sum = 0.0;
  int largest = 0;
  conic_gaussians_unit_rotation(set, i, q);
  for (int k = 1; k < 4; k++)
    largest = fabs(q[k]) > fabs(q[largest]) ? k : largest;
  for (int k = 0; k < 4; k++) {
    const double root_half = 0.70710678118654752;
    q[k] = (q[largest] < 0.0) != (q[k] < 0.0) ? -fabs(q[k]) : fabs(q[k]);
    if (k == largest)
      continue;
    q[k] = (q[k] < 0.0 ? -1.0 : 1.0) * root_half * floor(fabs(q[k]) / root_half * 511.0 + 0.5) / 511.0;
    sum += q[k] * q[k];
  }
  q[largest] = sqrt(1.0 - sum);
  for (int k = 0; k < 4; k++)
    set->rotation[k][i] = (float)q[k];
}

/* Moves the numbers of a scene of degree 0 to the nearest that an .spz can hold, so that both files mean the same. */
static void settle_for_spz(conic_gaussians *set) {
  for (size_t i = 0; i < set->count; i++) {
    settle_rotation(set, i);
    set->opacity[i] = to_steps((double)set->opacity[i], 255.0, 0.0, 255.0);
    for (int axis = 0; axis < 3; axis++) {
      float log_scale = to_steps((double)conic_gaussians_log_scale(set, axis, i), 16.0, -10.0, 255.0);
      set->position[axis][i] = to_steps((double)set->position[axis][i], 4096.0, -2048.0, 16777215.0);
      set->scale[axis][i] = conic_scale_of_log(log_scale);
      float *color = &set->sh[3 * i + (size_t)axis];
      *color = to_steps((double)*color, 0.15 * 255.0, -0.5 / 0.15, 255.0);
    }
  }
}

/* Writes gzip that is stored, not packed, since zlib's packing differs between versions. */
static void put_stored_gzip(FILE *to, const unsigned char *bytes, size_t n) {
  static const unsigned char head[10] = {0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 255};
  unsigned char tail[8];
  fwrite(head, 1, sizeof head, to);
  for (size_t at = 0; at < n;) {
    size_t here = n - at < 65535 ? n - at : 65535;
    const unsigned char block[5] = {at + here == n, (unsigned char)here, (unsigned char)(here >> 8),
                                    (unsigned char)~here, (unsigned char)(~here >> 8)};
    fwrite(block, 1, sizeof block, to);
    fwrite(bytes + at, 1, here, to);
    at += here;
  }
  conic_store_32(tail, conic_zip_sum(bytes, n));
  conic_store_32(tail + 4, (uint32_t)n);
  fwrite(tail, 1, sizeof tail, to);
}

static conic_status write_stored_spz(suite_files *suite, const char *path, const conic_gaussians *gaussians) {
  conic_gaussians_write_options options;
  unsigned char *block = NULL;
  size_t n = 0;
  conic_output *output;
  conic_status status = cli_suite_open_file(suite, path, &output);
  if (status != CONIC_OK)
    return status;
  conic_gaussians_write_options_init(&options);
  options.kind = CONIC_GAUSSIANS_SPZ;
  options.spz_version = 3;
  const conic_gaussian_writer writer = {suite->context, path,     conic_output_stream(output),
                                        gaussians,      &options, gaussians->sh_degree};
  status = conic_spz_make_block(&writer, &block, &n);
  if (status == CONIC_OK)
    put_stored_gzip(conic_output_stream(output), block, n);
  conic_memory_release(suite->context, block);
  status = conic_output_end(output, status);
  return status == CONIC_OK ? cli_suite_add_file(suite, path) : status;
}

static conic_status write_ply(suite_files *suite, const char *path, const conic_gaussians *gaussians) {
  conic_output *output;
  conic_status status = cli_suite_open_file(suite, path, &output);
  if (status != CONIC_OK)
    return status;
  const conic_gaussian_writer writer = {.context = suite->context,
                                        .path = path,
                                        .to = conic_output_stream(output),
                                        .gaussians = gaussians,
                                        .sh_degree = gaussians->sh_degree,
                                        .lacks_normals = gaussians->count > 100000}; /* a fifth of the file */
  status = conic_output_end(output, conic_gaussian_ply_write(&writer));
  return status == CONIC_OK ? cli_suite_add_file(suite, path) : status;
}

static conic_status write_of_kind(suite_files *suite, const char *path, const conic_gaussians *gaussians,
                                  conic_gaussian_kind kind) {
  char full[4096];
  conic_gaussians_write_options options;
  conic_gaussians_write_options_init(&options);
  options.kind = kind;
  conic_status status = cli_suite_join(suite->context, suite->folder, path, full, sizeof full);
  if (status == CONIC_OK)
    status = conic_gaussians_write(suite->context, full, gaussians, &options);
  return status == CONIC_OK ? cli_suite_add_file(suite, path) : status;
}

void cli_suite_release_content(conic_context *context, suite_content *content) {
  conic_gaussians_release(context, &content->gaussians);
  conic_model_release(context, &content->model);
}

/* Writes the .ply, and reads back its contents. */
static conic_status write_gaussian_scene(suite_files *suite, const suite_scene *scene, const char *path,
                                         const char *full, suite_content *content) {
  conic_gaussians made;
  conic_status status = cli_suite_make(suite->context, scene, &made);
  if (status == CONIC_OK && scene->formats & SUITE_SPZ)
    settle_for_spz(&made);
  if (status == CONIC_OK)
    status = write_ply(suite, path, &made);
  conic_gaussians_release(suite->context, &made);
  return status == CONIC_OK ? conic_gaussians_read(suite->context, full, NULL, &content->gaussians) : status;
}

static conic_status write_splat_scene(suite_files *suite, const suite_scene *scene, const char *path, const char *full,
                                      suite_content *content) {
  conic_splats made;
  conic_status status = scene->make_splats(suite->context, &made);
  if (status == CONIC_OK)
    status = conic_splats_write(suite->context, full, &made, NULL);
  conic_splats_release(suite->context, &made);
  if (status == CONIC_OK)
    status = cli_suite_add_file(suite, path);
  return status == CONIC_OK ? conic_model_read(suite->context, full, NULL, &content->model) : status;
}

/* Of conic's own writer, too. */
static conic_status write_asset(suite_files *suite, const khr_asset *asset, conic_gaussians *seen) {
  char path[SUITE_PATH_ROOM];
  conic_status status = cli_khr_write(suite, asset, seen);
  cli_khr_path(asset, path);
  if (status == CONIC_OK && asset->flags & KHR_BY_CONIC)
    status = write_of_kind(suite, path, seen, asset->flags & KHR_GLB ? CONIC_GAUSSIANS_GLB : CONIC_GAUSSIANS_GLTF);
  return status;
}

conic_status cli_suite_write_scene(suite_files *suite, const suite_scene *scene, suite_content *content) {
  char path[SUITE_PATH_ROOM], full[4096];
  memset(content, 0, sizeof *content);
  if (scene->asset)
    return write_asset(suite, scene->asset, &content->gaussians);
  snprintf(path, sizeof path, "scenes/%s.ply", scene->name);
  conic_status status = cli_suite_join(suite->context, suite->folder, path, full, sizeof full);
  if (status == CONIC_OK)
    status = scene->make_splats ? write_splat_scene(suite, scene, path, full, content)
                                : write_gaussian_scene(suite, scene, path, full, content);
  snprintf(path, sizeof path, "scenes/%s.spz", scene->name);
  if (status == CONIC_OK && scene->formats & SUITE_SPZ)
    status = write_stored_spz(suite, path, &content->gaussians);
  snprintf(path, sizeof path, "scenes/%s.glb", scene->name);
  if (status == CONIC_OK && scene->formats & SUITE_GLB)
    status = write_of_kind(suite, path, &content->gaussians, CONIC_GAUSSIANS_GLB);
  if (status != CONIC_OK)
    cli_suite_release_content(suite->context, content);
  return status;
}
