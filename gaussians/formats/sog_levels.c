/* lod-meta.json, streamed .sog (PlayCanvas): a tree whose leaves name, by level, rows of several .sog, each of which
 * has one level. All files of level 0, the finest, are read. */

#include "core/base/real.h"
#include "core/files/json_read.h"
#include "gaussians/formats/gaussian_formats.h"

typedef struct levels_reader {
  const conic_gaussian_bytes *file;
  conic_json json;
  conic_texts names;
  size_t *files; /* of level 0, by their places among the names; the same file again for every leaf */
  size_t n_files, room;
} levels_reader;

/* The levels of a leaf, by number: which file, and which of its rows. */
static conic_status read_levels(levels_reader *self) {
  char level[CONIC_JSON_KEY_ROOM], key[CONIC_JSON_KEY_ROOM];
  conic_json *json = &self->json;
  conic_json_begin_object(json);
  while (conic_json_next_member(json, level)) {
    double number = -1.0;
    conic_json_begin_object(json);
    while (conic_json_next_member(json, key))
      if (strcmp(key, "file") == 0)
        conic_json_number(json, &number);
      else
        conic_json_skip(json);
    const size_t i_file = number >= 0.0 && number < 1e9 ? (size_t)number : SIZE_MAX;
    if (json->status == CONIC_OK && strcmp(level, "0") == 0)
      json->status =
          conic_memory_append(self->file->context, &self->files, &self->n_files, &self->room, &i_file, sizeof i_file);
  }
  return json->status;
}

/* As deep as JSON may be. */
static conic_status read_tree(levels_reader *self) { /* NOLINT(misc-no-recursion) */
  char key[CONIC_JSON_KEY_ROOM];
  conic_json_begin_object(&self->json);
  while (conic_json_next_member(&self->json, key))
    if (strcmp(key, "lods") == 0)
      read_levels(self);
    else if (strcmp(key, "children") == 0) {
      conic_json_begin_array(&self->json);
      while (conic_json_next_item(&self->json))
        read_tree(self);
    } else
      conic_json_skip(&self->json);
  return self->json.status;
}

static conic_status read_levels_meta(levels_reader *self) {
  char key[CONIC_JSON_KEY_ROOM], name[512];
  conic_json *json = &self->json;
  conic_json_begin_object(json);
  while (conic_json_next_member(json, key))
    if (strcmp(key, "tree") == 0)
      read_tree(self);
    else if (strcmp(key, "filenames") == 0) {
      conic_json_begin_array(json);
      while (conic_json_next_item(json))
        if (conic_json_text(json, name, sizeof name) == CONIC_OK)
          json->status = conic_texts_add(self->file->context, &self->names, name, strlen(name));
    } else
      conic_json_skip(json);
  return json->status == CONIC_OK && self->n_files == 0
             ? conic_gaussian_bytes_wrong(self->file, 0, "no leaf of its tree has level 0")
             : json->status;
}

CONIC_DEFINE_ORDER_OF(compare_places, size_t)

/* A .sog that belongs to it, which lies beside or below. */
static conic_status read_unit(const levels_reader *self, size_t i_file, conic_gaussians *unit) {
  const conic_gaussian_bytes *file = self->file;
  const char *name = i_file < self->names.count ? conic_texts_at(&self->names, i_file) : "";
  char path[4096];
  conic_mapping mapping;
  memset(unit, 0, sizeof *unit);
  conic_status status = conic_gaussian_bytes_open(file, name, path, &mapping);
  if (status != CONIC_OK)
    return status;
  const conic_gaussian_bytes bytes = {file->context, path, path, mapping.bytes, mapping.n_bytes, file->options};
  status = conic_sog_read(&bytes, unit);
  conic_mapping_close(file->context, &mapping);
  return status;
}

/* Adds a unit to the set, which took its degree and fields of the first. */
static conic_status append_unit(levels_reader *self, const conic_gaussians *unit, conic_gaussians *set) {
  if (unit->sh_degree != set->sh_degree || conic_gaussians_fields(unit) != conic_gaussians_fields(set))
    return conic_gaussian_bytes_wrong(self->file, 0, "its files are of several kinds");
  conic_status status = conic_gaussians_grow(self->file->context, set, set->count, set->count + unit->count);
  if (status == CONIC_OK) {
    conic_gaussians_put(unit, set, set->count);
    set->count += unit->count;
  }
  return status;
}

conic_status conic_sog_levels_read(const conic_gaussian_bytes *file, conic_gaussians *gaussians) {
  levels_reader self = {.file = file};
  conic_gaussians unit;
  conic_status status = conic_json_take(file->context, file->name, file->bytes, file->n_bytes, &self.json);
  if (status == CONIC_OK) {
    status = read_levels_meta(&self);
    conic_json_close(&self.json);
  }
  if (status == CONIC_OK)
    qsort(self.files, self.n_files, sizeof *self.files, compare_places);
  for (size_t i = 0; status == CONIC_OK && i < self.n_files; i++) {
    if (i > 0 && self.files[i] == self.files[i - 1])
      continue;
    status = read_unit(&self, self.files[i], i == 0 ? gaussians : &unit);
    if (i == 0)
      continue;
    if (status == CONIC_OK)
      status = append_unit(&self, &unit, gaussians);
    conic_gaussians_release(file->context, &unit);
  }
  conic_memory_release_these(file->context, self.files, self.names.bytes);
  return status;
}
