#include "source/lean_cache.h"

#include "conic/version.h"
#include "core/base/context_struct.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/image/texture_levels.h"

/* --- what decides it --- */

static void add_array(conic_sha256 *sum, const void *array, size_t n, size_t n_bytes) {
  const uint64_t n_there = array ? n : 0;
  conic_sha256_add(sum, &n_there, sizeof n_there);
  if (n_there)
    conic_sha256_add(sum, array, n * n_bytes);
}

static void add_floats(conic_sha256 *sum, float *const *arrays, int n_arrays, size_t n) {
  for (int i = 0; i < n_arrays; i++)
    add_array(sum, arrays[i], n, sizeof(float));
}

static void add_splats(conic_sha256 *sum, const conic_splats *s) {
  add_array(sum, s->origin, 3, sizeof *s->origin);
  add_floats(sum, s->position, 3, s->count);
  add_floats(sum, s->tangent_u, 3, s->count);
  add_floats(sum, s->tangent_v, 3, s->count);
  add_floats(sum, s->color, 3, s->count);
  add_array(sum, s->opacity, s->count, sizeof(float));
  add_array(sum, s->dot, s->count, sizeof(float));
  add_array(sum, s->clips, s->n_clips, sizeof *s->clips);
}

static void add_material(conic_sha256 *sum, const conic_material *material) {
  const conic_texture *texture = material->texture;
  add_array(sum, material->color, 3, sizeof(float));
  if (!texture)
    return;
  const conic_texture_level *level = &texture->levels[0];
  const int numbers[] = {level->width, level->height, (int)texture->wrap};
  add_array(sum, numbers, 3, sizeof *numbers);
  add_array(sum, level->texels, (size_t)level->width * (size_t)level->height, sizeof *level->texels);
}

static void add_triangles(conic_sha256 *sum, const conic_triangles *t) {
  const size_t n_normals = t->normal_corners ? t->n_normals : t->n_vertices;
  const size_t n_places = t->texture_corners ? t->n_texture_coordinates : t->n_vertices;
  add_array(sum, t->origin, 3, sizeof *t->origin);
  add_array(sum, t->corners, t->count, sizeof *t->corners);
  add_floats(sum, t->position, 3, t->n_vertices);
  add_floats(sum, t->color, 3, t->n_vertices);
  add_floats(sum, t->normal, 3, n_normals);
  add_array(sum, t->normal_corners, t->count, sizeof *t->normal_corners);
  add_floats(sum, t->texture_coordinate, 2, n_places);
  add_array(sum, t->texture_corners, t->count, sizeof *t->texture_corners);
  add_array(sum, t->material, t->count, sizeof *t->material);
  for (size_t i = 0; i < t->n_materials; i++)
    add_material(sum, &t->materials[i]);
}

conic_status conic_lean_cache_path(conic_context *context, const char *folder, const conic_drawing *of, float cutoff,
                                   const char *ending, char path[CONIC_LEAN_CACHE_PATH]) {
  const char *version = conic_version();
  char key[CONIC_SHA256_ROOM];
  conic_sha256 sum;
  conic_sha256_begin(&sum);
  conic_sha256_add(&sum, version, strlen(version) + 1);
  conic_sha256_add(&sum, &cutoff, sizeof cutoff);
  if (of->splats)
    add_splats(&sum, of->splats);
  if (of->triangles)
    add_triangles(&sum, of->triangles);
  conic_sha256_end(&sum, key);
  conic_disk_make_folder(folder); /* or it is there */
  int n = snprintf(path, CONIC_LEAN_CACHE_PATH, "%s/%s.%s", folder, key, ending);
  if (n < 0 || n >= CONIC_LEAN_CACHE_PATH || !conic_disk_can_write_in(folder))
    return conic_fail(context, CONIC_ERROR_IO, "%s: it cannot be written in", folder);
  return CONIC_OK;
}

conic_status conic_lean_cache_read(conic_context *context, const char *path, conic_lean_cache_reader *read,
                                   void **built) {
  const conic_context_options before = context->options;
  const int guards = context->guards_inputs;
  *built = NULL;
  if (!conic_file_is_there(path))
    return CONIC_OK;
  context->options.log = NULL;
  context->guards_inputs = 0;
  conic_status status = read(context, path, built);
  context->guards_inputs = guards;
  context->options.log = before.log;
  return status == CONIC_ERROR_MEMORY || status == CONIC_ERROR_CANCELLED ? status : CONIC_OK;
}

/* --- how much is kept --- */

/* Whether a file of a folder is one of these. */
static int is_kept(const char *name) {
  const char *ending = conic_file_ending(name);
  return strlen(name) == CONIC_SHA256_ROOM - 1 + 4 && strspn(name, "0123456789abcdef") == CONIC_SHA256_ROOM - 1 &&
         (strcmp(ending, "cot") == 0 || strcmp(ending, "chy") == 0);
}

/* The bytes of all, and the oldest that is not `path`. */
static uint64_t look_at_kept(const char *folder, const char *path, char oldest[CONIC_LEAN_CACHE_PATH]) {
  conic_disk_folder listing;
  conic_disk_entry entry;
  uint64_t n_bytes = 0;
  int64_t least = INT64_MAX;
  char found[CONIC_LEAN_CACHE_PATH];
  *oldest = '\0';
  for (const char *name = conic_disk_open_folder(folder, &listing) ? conic_disk_next_name(&listing) : NULL; name;
       name = conic_disk_next_name(&listing)) {
    snprintf(found, sizeof found, "%s/%s", folder, name);
    if (!is_kept(name) || !conic_disk_look(found, &entry))
      continue;
    n_bytes += entry.n_bytes;
    if (entry.modified_seconds < least && strcmp(found, path) != 0) {
      least = entry.modified_seconds;
      memcpy(oldest, found, strlen(found) + 1);
    }
  }
  conic_disk_close_folder(&listing);
  return n_bytes;
}

static void trim(const char *folder, const char *path) {
  char oldest[CONIC_LEAN_CACHE_PATH];
  while (look_at_kept(folder, path, oldest) > CONIC_LEAN_CACHE_BYTES && *oldest && conic_disk_remove(oldest))
    continue;
}

conic_status conic_lean_cache_write(conic_context *context, const char *folder, const char *path,
                                    conic_lean_cache_writer *write, void *built) {
  const conic_context_options before = context->options;
  context->options.log = NULL;
  conic_status status = write(built, path);
  context->options.log = before.log;
  trim(folder, path);
  if (status == CONIC_OK || status == CONIC_ERROR_MEMORY || status == CONIC_ERROR_CANCELLED)
    return status;
  conic_log(context, CONIC_LOG_WARNING, "%s: what was built is not kept: it cannot be written", path);
  return CONIC_OK;
}
