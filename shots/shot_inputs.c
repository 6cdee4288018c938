#include "shots/shot_inputs.h"

#include <pthread.h>
#include <stdatomic.h>
#include <unistd.h>

#include "core/files/file.h"
#include "core/files/guard.h"
#include "shots/shot_key.h"

enum { PIECE_BYTES = 1 << 20, MOST_PIECES = 64, PATH_ROOM = 4096 };
static const uint64_t most_whole_bytes = (uint64_t)MOST_PIECES * PIECE_BYTES;

/* --- what a file holds --- */

/* Somebody who looks at files: the thread that has the context, or one beside it, which has none. */
typedef struct looker {
  conic_context *context;
  atomic_int *is_ended; /* set, where the thread beside is to end */
} looker;

static conic_status go_on_looking(const looker *l, double part) {
  if (l->context)
    return conic_progress(l->context, "look", part);
  return atomic_load(l->is_ended) ? CONIC_ERROR_CANCELLED : CONIC_OK;
}

/* Adds what a file has from a place on: so little at a time that it stays near the processor. */
static void hash_piece(conic_sha256 *sum, int descriptor, uint64_t at) {
  unsigned char bytes[1 << 16];
  ptrdiff_t n_read = 1;
  for (size_t n = 0; n < PIECE_BYTES && n_read > 0; n += (size_t)n_read) {
    n_read = conic_disk_read_at(descriptor, bytes, sizeof bytes, at + n);
    conic_sha256_add(sum, bytes, n_read > 0 ? (size_t)n_read : 0);
  }
}

/* Adds a whole file, or pieces of one that is large. */
static conic_status hash_file_into(const looker *l, conic_sha256 *sum, const char *path, int is_sampled) {
  conic_disk_entry entry;
  conic_status status = CONIC_OK;
  int descriptor = conic_file_is_there(path) ? conic_disk_open(path) : -1;
  if (descriptor < 0 || !conic_disk_look_at(descriptor, &entry))
    return CONIC_OK;
  uint64_t n_whole = (entry.n_bytes + PIECE_BYTES - 1) / PIECE_BYTES, n = is_sampled ? MOST_PIECES : n_whole;
  uint64_t step = is_sampled ? (entry.n_bytes - PIECE_BYTES) / (MOST_PIECES - 1) : PIECE_BYTES;
  if (is_sampled) {
    conic_key_add_number(sum, entry.n_bytes);
    conic_key_add_number(sum, (uint64_t)entry.modified_seconds);
  }
  for (uint64_t i = 0; i < n && status == CONIC_OK; i++) {
    hash_piece(sum, descriptor, is_sampled && i == MOST_PIECES - 1 ? entry.n_bytes - PIECE_BYTES : i * step);
    status = go_on_looking(l, (double)i / (double)n);
  }
  close(descriptor);
  return status;
}

static conic_status look_at_file(const looker *l, const char *path, const conic_disk_entry *entry,
                                 conic_shot_input *input) {
  conic_sha256 sum;
  input->n_bytes = entry->n_bytes;
  input->is_sampled = entry->n_bytes > most_whole_bytes;
  conic_sha256_begin(&sum);
  conic_status status = hash_file_into(l, &sum, path, input->is_sampled);
  conic_sha256_end(&sum, input->sha256);
  return status;
}

/* --- what a folder holds --- */

typedef struct folder_file {
  char *path;
  uint64_t n_bytes;
  int64_t modified_seconds;
} folder_file;

typedef struct folder_list {
  conic_context *context;
  folder_file *files;
  size_t n, room;
  uint64_t n_bytes;
} folder_list;

enum { MOST_DEPTH = 16 };

static conic_status add_to_folder_list(folder_list *list, const char *path, const conic_disk_entry *entry) {
  conic_status status =
      conic_memory_reserve(list->context, &list->files, list->n, list->n + 1, &list->room, sizeof *list->files);
  char *copy = status == CONIC_OK ? conic_memory_copy_text(list->context, path) : NULL;
  if (!copy)
    return CONIC_ERROR_MEMORY;
  list->files[list->n++] = (folder_file){copy, entry->n_bytes, entry->modified_seconds};
  list->n_bytes += entry->n_bytes;
  return CONIC_OK;
}

static conic_status list_folder_files(folder_list *list, const char *folder, int depth) {
  conic_disk_folder listing;
  conic_status status = CONIC_OK;
  const char *name;
  char path[PATH_ROOM];
  if (depth == MOST_DEPTH || !conic_disk_open_folder(folder, &listing))
    return CONIC_OK;
  while (status == CONIC_OK && (name = conic_disk_next_name(&listing))) {
    conic_disk_entry entry;
    int n = snprintf(path, sizeof path, "%s/%s", folder, name);
    if (strcmp(name, ".") == 0 || strcmp(name, "..") == 0 || n < 0 || (size_t)n >= sizeof path ||
        !conic_disk_look(path, &entry))
      continue;
    if (entry.is_folder)
      status = list_folder_files(list, path, depth + 1);
    else if (entry.is_file)
      status = add_to_folder_list(list, path, &entry);
  }
  conic_disk_close_folder(&listing);
  return status;
}

static int compare_folder_files(const void *a, const void *b) {
  return strcmp(((const folder_file *)a)->path, ((const folder_file *)b)->path);
}

/* Of a large one every file's name, length and time, and what 64 of them hold at their beginning. */
static conic_status look_at_folder(conic_context *context, const char *folder, conic_shot_input *input) {
  folder_list list = {.context = context};
  const looker own = {.context = context};
  conic_sha256 sum;
  conic_status status = list_folder_files(&list, folder, 0);
  size_t n_folder = strlen(folder);
  if (list.n)
    qsort(list.files, list.n, sizeof *list.files, compare_folder_files);
  input->n_bytes = list.n_bytes;
  input->is_sampled = list.n_bytes > most_whole_bytes;
  conic_sha256_begin(&sum);
  for (size_t i = 0; i < list.n && status == CONIC_OK; i++) {
    const folder_file *file = &list.files[i];
    conic_key_add_text(&sum, file->path + n_folder);
    conic_key_add_number(&sum, file->n_bytes);
    if (input->is_sampled)
      conic_key_add_number(&sum, (uint64_t)file->modified_seconds);
    if (!input->is_sampled || i % (list.n / MOST_PIECES + 1) == 0)
      status = hash_file_into(&own, &sum, file->path, file->n_bytes > most_whole_bytes);
  }
  conic_sha256_end(&sum, input->sha256);
  for (size_t i = 0; i < list.n; i++)
    conic_memory_release(context, list.files[i].path);
  conic_memory_release(context, list.files);
  return status;
}

/* The folder that a hierarchy of files is in: as it was named, or its first file. */
static int find_hierarchy_folder(const char *path, char folder[PATH_ROOM]) {
  conic_disk_entry entry;
  const char *name = conic_file_name(path);
  int is_first_file = strcmp(name, "ept.json") == 0 || strcmp(name, "metadata.json") == 0;
  if (!conic_disk_look(path, &entry) || (!entry.is_folder && !is_first_file) || !conic_layers_is_hierarchy(path))
    return 0;
  int n = entry.is_folder ? snprintf(folder, PATH_ROOM, "%s", path)
                          : snprintf(folder, PATH_ROOM, "%.*s.", (int)(name - path), path);
  if (n < 0 || n >= PATH_ROOM)
    return 0;
  while (entry.is_folder && n > 1 && conic_disk_is_separator(folder[n - 1]))
    folder[--n] = '\0';
  return 1;
}

/* Whether there is a file or folder to look at. */
static int is_on_disk(const char *path, conic_disk_entry *entry) {
  return strcmp(path, "-") != 0 && !conic_layers_is_url(path) && conic_disk_look(path, entry);
}

conic_status conic_shot_input_look(conic_context *context, const char *path, conic_shot_input *input) {
  const looker own = {.context = context};
  conic_disk_entry entry;
  char folder[PATH_ROOM];
  if (!is_on_disk(path, &entry))
    return CONIC_OK;
  return find_hierarchy_folder(path, folder) ? look_at_folder(context, folder, input)
                                             : look_at_file(&own, path, &entry, input);
}

/* --- beside who reads and draws --- */

struct conic_shot_looking {
  pthread_t thread;
  atomic_int is_ended;
  conic_shot_input *inputs; /* nobody else touches these */
  size_t n, n_done;
};

static void *look_beside(void *data) {
  struct conic_shot_looking *looking = data;
  const looker beside = {.is_ended = &looking->is_ended};
  char folder[PATH_ROOM];
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < looking->n && status == CONIC_OK; i++) {
    conic_shot_input *input = &looking->inputs[i];
    conic_disk_entry entry;
    if (!is_on_disk(input->name, &entry) || find_hierarchy_folder(input->name, folder))
      break; /* what it is takes memory of the context to say */
    status = look_at_file(&beside, input->name, &entry, input);
    looking->n_done += status == CONIC_OK;
  }
  return NULL;
}

/* Returns how many inputs have been looked at. */
static size_t end_looking(conic_context *context, conic_shot_inputs *inputs, int is_ended) {
  struct conic_shot_looking *looking = inputs->looking;
  if (!looking)
    return 0;
  atomic_store(&looking->is_ended, is_ended);
  pthread_join(looking->thread, NULL);
  size_t n_done = looking->n_done;
  conic_memory_release(context, looking);
  inputs->looking = NULL;
  return n_done;
}

/* --- the list --- */

static conic_status add_input(conic_context *context, conic_shot_inputs *inputs, const char *name,
                              conic_shot_role role) {
  conic_status status =
      conic_memory_reserve(context, &inputs->inputs, inputs->n, inputs->n + 1, &inputs->room, sizeof *inputs->inputs);
  char *copy = status == CONIC_OK ? conic_memory_copy_text(context, name) : NULL;
  if (!copy)
    return CONIC_ERROR_MEMORY;
  inputs->inputs[inputs->n++] = (conic_shot_input){.name = copy, .role = role};
  return CONIC_OK;
}

static conic_status add_named(conic_context *context, const conic_shot_names *names, conic_shot_inputs *inputs) {
  const char *const others[] = {names->texture, names->sky, names->motion};
  const conic_shot_role roles[] = {CONIC_SHOT_TEXTURE, CONIC_SHOT_SKY, CONIC_SHOT_MOTION};
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < names->n_scene && status == CONIC_OK; i++)
    status = add_input(context, inputs, names->scene[i], CONIC_SHOT_SCENE);
  for (size_t i = 0; i < sizeof others / sizeof *others && status == CONIC_OK; i++)
    if (others[i])
      status = add_input(context, inputs, others[i], roles[i]);
  return status;
}

conic_status conic_shot_inputs_begin(conic_context *context, const conic_shot_names *names, conic_shot_inputs *inputs) {
  conic_status status = add_named(context, names, inputs);
  struct conic_shot_looking *looking =
      status == CONIC_OK ? conic_memory_allocate_zeroed(context, 1, sizeof *looking) : NULL;
  if (!looking)
    return CONIC_ERROR_MEMORY;
  looking->inputs = inputs->inputs;
  looking->n = inputs->n;
  if (conic_context_threads(context) > 1 && pthread_create(&looking->thread, NULL, look_beside, looking) == 0)
    inputs->looking = looking;
  else
    conic_memory_release(context, looking);
  return CONIC_OK;
}

static int are_one_file(const char *a, const char *b) {
  conic_disk_entry first, second;
  if (!a || !b)
    return 0;
  if (strcmp(a, b) == 0)
    return 1;
  return conic_disk_look(a, &first) && conic_disk_look(b, &second) && first.device == second.device &&
         first.number == second.number;
}

/* Whether it was named, or lies in the folder of what was. */
static int is_named(const conic_shot_names *names, const char *path) {
  char folder[PATH_ROOM];
  const char *const others[] = {names->texture, names->sky, names->motion};
  for (size_t i = 0; i < names->n_scene; i++) {
    const char *scene = names->scene[i];
    if (are_one_file(scene, path))
      return 1;
    if (find_hierarchy_folder(scene, folder)) {
      size_t n = strlen(folder);
      n -= n > 1 && folder[n - 1] == '.' && conic_disk_is_separator(folder[n - 2]) ? 2 : 0;
      if (n == 1 && folder[0] == '.' ? !conic_disk_is_absolute(path)
                                     : strncmp(folder, path, n) == 0 && conic_disk_is_separator(path[n]))
        return 1;
    }
  }
  for (size_t i = 0; i < sizeof others / sizeof *others; i++)
    if (are_one_file(others[i], path))
      return 1;
  return 0;
}

/* A part's name from the folder of the first file of the scene, where it lies there. */
static const char *name_of_part(const conic_shot_names *names, const char *path) {
  const char *first = names->n_scene ? names->scene[0] : "", *name = conic_file_name(first);
  size_t n = (size_t)(name - first);
  return strncmp(first, path, n) == 0 && !conic_disk_is_absolute(path + n) ? path + n : conic_file_name(path);
}

static conic_status add_part(conic_context *context, const conic_shot_names *names, const char *path,
                             conic_shot_inputs *inputs) {
  conic_status status = add_input(context, inputs, name_of_part(names, path), CONIC_SHOT_PART);
  return status == CONIC_OK ? conic_shot_input_look(context, path, &inputs->inputs[inputs->n - 1]) : status;
}

static int compare_parts(const void *a, const void *b) {
  const conic_shot_input *first = a, *second = b;
  int order = strcmp(first->name, second->name);
  return order ? order : strcmp(first->sha256, second->sha256);
}

conic_status conic_shot_inputs_find(conic_context *context, const conic_shot_names *names, conic_shot_inputs *inputs) {
  conic_guarded read;
  size_t n_known = end_looking(context, inputs, 0);
  conic_status status = inputs->n ? CONIC_OK : add_named(context, names, inputs);
  for (size_t i = n_known; i < inputs->n && status == CONIC_OK; i++)
    status = conic_shot_input_look(context, inputs->inputs[i].name, &inputs->inputs[i]);
  const size_t first_part = inputs->n;
  for (size_t at = 0; status == CONIC_OK && conic_guard_next(context, &at, &read);) {
    if (!is_named(names, read.path))
      status = add_part(context, names, read.path, inputs);
    for (size_t i = 0; conic_layers_is_url(read.path) && i < first_part; i++)
      if (strcmp(inputs->inputs[i].name, read.path) == 0)
        inputs->inputs[i].n_bytes = read.n_bytes;
  }
  if (inputs->n > first_part)
    qsort(inputs->inputs + first_part, inputs->n - first_part, sizeof *inputs->inputs, compare_parts);
  return status;
}

void conic_shot_inputs_release(conic_context *context, conic_shot_inputs *inputs) {
  end_looking(context, inputs, 1);
  for (size_t i = 0; i < inputs->n; i++)
    conic_memory_release(context, (void *)inputs->inputs[i].name);
  conic_memory_release(context, inputs->inputs);
  memset(inputs, 0, sizeof *inputs);
}
