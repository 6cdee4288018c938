#include "cli/points/points_input.h"
#include "core/files/disk.h"
#include "core/files/file.h"

static conic_status append_name(conic_context *context, const char *folder, const char *name, char **names,
                                size_t *n_bytes, size_t *room) {
  size_t n = strlen(folder) + strlen(name) + 2;
  const char *between = *folder && *name && !conic_disk_is_separator(folder[strlen(folder) - 1]) ? "/" : "";
  conic_status status = conic_memory_reserve(context, names, *n_bytes, *n_bytes + n, room, 1);
  if (status == CONIC_OK)
    *n_bytes += (size_t)snprintf(*names + *n_bytes, n, "%s%s%s", folder, between, name) + 1;
  return status;
}

static int is_listed(const char *name, const char *const *endings) {
  for (size_t i = 0; endings[i] && name[0] != '.'; i++)
    if (conic_file_has_ending(name, endings[i]))
      return 1;
  return 0;
}

static int compare_file_names(const void *a, const void *b) {
  return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Sorts consecutive names. */
static conic_status sort_names(conic_context *context, char *row, size_t n_bytes, size_t n) {
  const char **names = conic_memory_allocate(context, n, sizeof *names);
  char *sorted = conic_memory_allocate(context, n_bytes, 1), *at = row;
  for (size_t i = 0; i < n && names && sorted; i++, at += strlen(at) + 1)
    names[i] = at;
  if (names && sorted) {
    qsort(names, n, sizeof *names, compare_file_names);
    at = sorted;
    for (size_t i = 0; i < n; i++) {
      memcpy(at, names[i], strlen(names[i]) + 1);
      at += strlen(at) + 1;
    }
    memcpy(row, sorted, n_bytes);
  }
  conic_status status = names && sorted ? CONIC_OK : CONIC_ERROR_MEMORY;
  conic_memory_release_these(context, names, sorted);
  return status;
}

conic_status cli_points_folder_list(conic_context *context, const char *path, const char *const *endings, char **names,
                                    size_t *n_bytes, size_t *room) {
  static const char *const of_points[] = {"las", "laz", "ply", "e57", "pcd", "ptx", "pts", "xyz", NULL};
  conic_disk_folder folder;
  conic_disk_entry found;
  size_t n = 0, begun = *n_bytes;
  if (!conic_disk_look(path, &found) || !found.is_folder || cli_points_are_hierarchy(path))
    return append_name(context, path, "", names, n_bytes, room);
  conic_status status = CONIC_OK;
  if (!conic_disk_open_folder(path, &folder))
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read the directory", path);
  for (const char *name; status == CONIC_OK && (name = conic_disk_next_name(&folder));)
    if (is_listed(name, endings ? endings : of_points)) {
      status = append_name(context, path, name, names, n_bytes, room);
      n++;
    }
  conic_disk_close_folder(&folder);
  if (status == CONIC_OK && n == 0)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: it is a directory without files%s", path,
                      endings ? " that are shown" : " of points");
  return status == CONIC_OK ? sort_names(context, *names + begun, *n_bytes - begun, n) : status;
}
