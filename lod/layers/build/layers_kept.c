#include "lod/layers/build/layers_kept.h"

#include "core/files/disk.h"
#include "core/files/file.h"
#include "lod/layers/build/layers_node.h"

enum { NAME_ROOM = 1100, LINE_ROOM = CONIC_FINISHED_HEAD_ROOM + 256 };

static const char list_name[] = "branches", list_ending[] = "list", branch_ending[] = "branch", input_ending[] = "axes";

/* --- names --- */

/* FOLDER/NAME; what is too long is cut, and is not there. */
static void name_in_folder(const conic_layers_kept *kept, const char *name, char *path) {
  snprintf(path, kept->n_folder + NAME_ROOM, "%s%s", kept->folder, name);
}

static char *allocate_name(const conic_layers_kept *kept) {
  return conic_memory_allocate(kept->context, kept->n_folder + NAME_ROOM, 1);
}

static void path_of_list(const conic_layers_kept *kept, int index, char *path) {
  char name[32];
  snprintf(name, sizeof name, "%d.%s", index, list_ending);
  name_in_folder(kept, name, path);
}

static void file_of_branch(const conic_layers_kept_branch *branch, char name[64]) {
  snprintf(name, 64, "%llu-%u.%s", (unsigned long long)branch->key, branch->n_bits, branch_ending);
}

static conic_status cannot_keep(const conic_layers_kept *kept, const char *path) {
  return conic_fail(kept->context, CONIC_ERROR_IO, "%s: cannot write: %s", path, strerror(errno));
}

/* --- the folder --- */

/* Removes files with an ending from the folder, all but the one of that name, which may be null. */
static void remove_files(const conic_layers_kept *kept, const char *ending, const char *but, char *path) {
  conic_disk_folder folder;
  conic_disk_open_folder(kept->folder, &folder);
  for (const char *name; (name = conic_disk_next_name(&folder));) {
    name_in_folder(kept, name, path);
    if (conic_file_has_ending(name, ending) && !(but && strcmp(name, but) == 0))
      conic_disk_remove(path);
  }
  conic_disk_close_folder(&folder);
}

static void remove_all(const conic_layers_kept *kept, char *path) {
  remove_files(kept, list_ending, NULL, path); /* first: they name the others */
  remove_files(kept, branch_ending, NULL, path);
  remove_files(kept, input_ending, NULL, path);
}

static conic_status clear_folder(const conic_layers_kept *kept, char *path) {
  conic_disk_entry entry;
  remove_all(kept, path);
  if (!conic_disk_make_folder(kept->folder) && !(conic_disk_look(kept->folder, &entry) && entry.is_folder))
    return cannot_keep(kept, kept->folder);
  return CONIC_OK;
}

static conic_status add_found(conic_layers_kept *kept, const conic_finished *list, size_t *room) {
  conic_finished_part part;
  conic_status status = CONIC_OK;
  for (size_t at = 0; status == CONIC_OK && conic_finished_next(list, &at, &part);) {
    size_t n = at - part.files_at, used = kept->found.n_bytes;
    status = conic_memory_reserve(kept->context, &kept->found.text, used, used + n, room, 1);
    if (status == CONIC_OK)
      memcpy(kept->found.text + used, list->text + part.files_at, n);
    kept->found.n_bytes += status == CONIC_OK ? n : 0;
  }
  return status;
}

/* The lists of all processes that there have been. */
static conic_status read_lists(conic_layers_kept *kept, char *path, int *n_lists) {
  conic_disk_folder folder;
  conic_status status = CONIC_OK;
  size_t room = 0;
  *n_lists = 0;
  conic_disk_open_folder(kept->folder, &folder);
  for (const char *name; status == CONIC_OK && (name = conic_disk_next_name(&folder));) {
    conic_finished list;
    if (name[0] == '.' || !conic_file_has_ending(name, list_ending))
      continue;
    name_in_folder(kept, name, path);
    status = conic_finished_read(kept->context, path, list_name, kept->key, &list);
    if (status == CONIC_OK)
      status = add_found(kept, &list, &room);
    conic_finished_release(kept->context, &list);
    ++*n_lists;
  }
  conic_disk_close_folder(&folder);
  return status;
}

/* Finds the lists, in the first process. */
static conic_status find_lists(conic_layers_kept *kept, const conic_layers_keeping *keeping, char *path) {
  conic_finished none;
  int n_lists = 0;
  conic_status status = keeping->goes_on ? read_lists(kept, path, &n_lists) : CONIC_OK;
  if (status != CONIC_OK || n_lists > 0)
    return status;
  path_of_list(kept, 0, path);
  if (keeping->goes_on && !keeping->may_begin)
    return conic_finished_read(kept->context, path, list_name, kept->key, &none); /* which says why not */
  return clear_folder(kept, path);
}

static conic_status spread_found(conic_layers_kept *kept) {
  const conic_team *team = kept->team;
  size_t sizes[CONIC_MOST_IN_TEAM];
  conic_status status = CONIC_OK;
  if (!team)
    return CONIC_OK;
  char *all = team->collect(team->data, kept->found.text, kept->found.n_bytes, sizes);
  if (team->index > 0) {
    kept->found.text = conic_memory_allocate(kept->context, sizes[0], 1);
    kept->found.n_bytes = kept->found.text ? sizes[0] : 0;
    status = kept->found.text ? CONIC_OK : CONIC_ERROR_MEMORY;
    if (kept->found.text)
      memcpy(kept->found.text, all, sizes[0]);
  }
  team->release(team->data, all);
  return conic_team_agree(team, status);
}

/* --- branches --- */

static uint64_t last_key_of(const conic_layers_kept_branch *branch) {
  return branch->key + ((UINT64_C(1) << branch->n_bits) - 1);
}

static int parse_branch(const conic_finished_part *part, conic_layers_kept_branch *branch) {
  uint64_t numbers[3];
  if (!conic_finished_numbers(part, "branch", numbers, 3) || numbers[1] > 63 || numbers[2] == 0)
    return 0;
  *branch = (conic_layers_kept_branch){numbers[0], numbers[2], (unsigned)numbers[1]};
  return numbers[0] >> 63 == 0 && (numbers[0] & ((UINT64_C(1) << numbers[1]) - 1)) == 0;
}

static int is_of_input(const conic_finished_part *part, uint64_t *number) {
  return conic_finished_numbers(part, input_ending, number, 1);
}

/* Whether the file of a branch, which has the name that it should have, is as it was written. */
static int is_branch_whole(const conic_layers_kept *kept, const conic_finished_part *part,
                           const conic_layers_kept_branch *branch) {
  size_t at = part->files_at;
  conic_finished_file file;
  char name[64];
  file_of_branch(branch, name);
  return conic_finished_next_file(&kept->found, &at, &file) && file.n_name == strlen(name) &&
         memcmp(file.name, name, file.n_name) == 0 && conic_finished_is_there(kept->folder, &file);
}

/* Looks at the lists' branches, each in one process. Inputs are looked at when they are needed. `is_whole` has room for
 * all. */
static conic_status look_at_branches(conic_layers_kept *kept, size_t n, unsigned char *is_whole) {
  int index = kept->team ? kept->team->index : 0, count = kept->team ? kept->team->count : 1;
  conic_finished_part part;
  conic_layers_kept_branch branch;
  conic_status status = CONIC_OK;
  uint64_t number;
  size_t i = 0;
  for (size_t at = 0; status == CONIC_OK && conic_finished_next(&kept->found, &at, &part); i++)
    if ((int)(i % (size_t)count) == index) {
      is_whole[i] = (unsigned char)(is_of_input(&part, &number) ||
                                    (parse_branch(&part, &branch) && is_branch_whole(kept, &part, &branch)));
      status = conic_progress(kept->context, "look", (double)i / (double)n);
    }
  return status;
}

static int compare_kept_branches(const void *a, const void *b) {
  const conic_layers_kept_branch *first = a, *second = b;
  if (first->key != second->key)
    return first->key > second->key ? 1 : -1;
  return (first->n_bits < second->n_bits) - (first->n_bits > second->n_bits); /* what holds the other comes before it */
}

static void drop_overlapping(conic_layers_kept *kept) {
  size_t n = 0;
  if (kept->n > 0)
    qsort(kept->branches, kept->n, sizeof *kept->branches, compare_kept_branches);
  for (size_t i = 0; i < kept->n; i++)
    if (n == 0 || kept->branches[i].key > last_key_of(&kept->branches[n - 1]))
      kept->branches[n++] = kept->branches[i];
  kept->n = n;
  for (size_t i = 0; i < n; i++)
    kept->n_samples += kept->branches[i].n_samples;
}

/* In the first process: writes the list of what was there and is whole. The other lists go. */
static conic_status write_found(const conic_layers_kept *kept, const unsigned char *is_whole, char *path) {
  conic_output *output;
  conic_finished_part part;
  char own[32];
  path_of_list(kept, 0, path);
  conic_status status = conic_output_open(kept->context, path, &output);
  if (status != CONIC_OK)
    return status;
  FILE *stream = conic_output_stream(output); /* which remembers what fails, and commit says so */
  conic_finished_write_head(stream, list_name, kept->key);
  size_t i = 0;
  for (size_t at = 0; conic_finished_next(&kept->found, &at, &part); i++)
    if (is_whole[i])
      conic_finished_write_part(stream, &kept->found, &part);
  status = conic_output_commit(output);
  snprintf(own, sizeof own, "0.%s", list_ending);
  if (status == CONIC_OK)
    remove_files(kept, list_ending, own, path);
  return status;
}

static conic_status take_whole(conic_layers_kept *kept, const unsigned char *is_whole) {
  conic_finished_part part;
  conic_layers_kept_branch branch;
  conic_layers_kept_input input;
  conic_status status = CONIC_OK;
  size_t i = 0;
  for (size_t at = 0; status == CONIC_OK && conic_finished_next(&kept->found, &at, &part); i++) {
    input.file_at = part.files_at;
    if (is_whole[i] && is_of_input(&part, &input.number))
      status =
          conic_memory_append(kept->context, &kept->inputs, &kept->n_inputs, &kept->input_room, &input, sizeof input);
    else if (is_whole[i] && parse_branch(&part, &branch))
      status = conic_memory_append(kept->context, &kept->branches, &kept->n, &kept->room, &branch, sizeof branch);
  }
  if (status == CONIC_OK)
    drop_overlapping(kept);
  return status;
}

static conic_status find_branches(conic_layers_kept *kept, char *path) {
  conic_finished_part part;
  const conic_team *team = kept->team;
  size_t n = 0, count = team ? (size_t)team->count : 1;
  for (size_t at = 0; conic_finished_next(&kept->found, &at, &part);)
    n++;
  unsigned char *is_whole = conic_memory_allocate_zeroed(kept->context, n, 1);
  unsigned char *all = conic_memory_allocate(kept->context, n, count);
  conic_status status = is_whole && all ? look_at_branches(kept, n, is_whole) : CONIC_ERROR_MEMORY;
  status = conic_team_agree(team, status);
  if (status == CONIC_OK && team) {
    conic_team_collect(team, is_whole, n, all);
    for (size_t i = 0; i < n; i++)
      is_whole[i] = all[i % count * n + i];
  }
  if (status == CONIC_OK)
    status = take_whole(kept, is_whole);
  if (status == CONIC_OK && (!team || team->index == 0))
    status = write_found(kept, is_whole, path);
  conic_memory_release_these(kept->context, is_whole, all);
  return conic_team_agree(team, status);
}

/* --- beginning and end --- */

static conic_status open_own_list(conic_layers_kept *kept, char *path) {
  int index = kept->team ? kept->team->index : 0;
  conic_status status = CONIC_OK;
  path_of_list(kept, index, path);
  if (index > 0) {
    conic_output *output;
    status = conic_output_open(kept->context, path, &output);
    if (status == CONIC_OK)
      conic_finished_write_head(conic_output_stream(output), list_name, kept->key);
    if (status == CONIC_OK)
      status = conic_output_commit(output);
  }
  if (status == CONIC_OK) {
    kept->stream = conic_disk_open_stream(path, "ab");
    status = kept->stream ? CONIC_OK : cannot_keep(kept, path);
  }
  return status;
}

static conic_status name_folder(conic_layers_kept *kept, const char *path) {
  size_t n = strlen(path) + 16;
  kept->folder = conic_memory_allocate(kept->context, n, 1);
  if (!kept->folder)
    return CONIC_ERROR_MEMORY;
  kept->n_folder = (size_t)snprintf(kept->folder, n, "%s.branches/", path);
  return CONIC_OK;
}

conic_status conic_layers_kept_begin(conic_context *context, const char *path, const conic_team *team,
                                     const conic_layers_keeping *keeping, conic_layers_kept *kept) {
  *kept = (conic_layers_kept){.context = context, .team = team};
  if (!keeping)
    return CONIC_OK;
  kept->key = keeping->key;
  conic_status status = name_folder(kept, path);
  char *name = status == CONIC_OK ? allocate_name(kept) : NULL;
  status = conic_team_agree(team, name ? CONIC_OK : CONIC_ERROR_MEMORY);
  if (status == CONIC_OK && (!team || team->index == 0))
    status = find_lists(kept, keeping, name);
  status = conic_team_agree(team, status);
  if (status == CONIC_OK)
    status = spread_found(kept);
  if (status == CONIC_OK)
    status = find_branches(kept, name);
  if (status == CONIC_OK)
    status = conic_team_agree(team, open_own_list(kept, name));
  conic_memory_release(context, name);
  return status;
}

void conic_layers_kept_end(conic_layers_kept *kept) {
  if (!kept->context)
    return;
  if (kept->stream)
    fclose(kept->stream);
  conic_finished_release(kept->context, &kept->found);
  conic_memory_release_these(kept->context, kept->branches, kept->inputs, kept->folder);
  memset(kept, 0, sizeof *kept);
}

void conic_layers_kept_remove(conic_layers_kept *kept) {
  if (!kept->key)
    return;
  fclose(kept->stream);
  kept->stream = NULL;
  conic_team_agree(kept->team, CONIC_OK); /* all have closed theirs */
  char *path = !kept->team || kept->team->index == 0 ? allocate_name(kept) : NULL;
  if (!path)
    return;
  remove_all(kept, path);
  conic_disk_remove_folder(kept->folder);
  conic_memory_release(kept->context, path);
}

/* --- while it is built --- */

const conic_layers_kept_branch *conic_layers_kept_find(const conic_layers_kept *kept, uint64_t key) {
  size_t low = conic_layers_count_to(kept->branches, sizeof *kept->branches, kept->n, key);
  return low > 0 && key <= last_key_of(&kept->branches[low - 1]) ? &kept->branches[low - 1] : NULL;
}

static conic_status write_pieces(const conic_layers_kept *kept, const char *path, const conic_layers_kept_bytes *pieces,
                                 size_t n_pieces, uint64_t *n_bytes, char hash[CONIC_SHA256_ROOM]) {
  conic_output *output;
  conic_sha256 sum;
  conic_status status = conic_output_open(kept->context, path, &output);
  if (status != CONIC_OK)
    return status;
  conic_sha256_begin(&sum);
  for (size_t i = 0; i < n_pieces; i++) {
    conic_sha256_add(&sum, pieces[i].bytes, pieces[i].n_bytes);
    fwrite(pieces[i].bytes, 1, pieces[i].n_bytes, conic_output_stream(output)); /* commit says what failed */
  }
  *n_bytes = sum.n_bytes;
  conic_sha256_end(&sum, hash);
  return conic_output_commit(output);
}

/* A file, and then, once it is whole, its lines. */
static conic_status add_part(conic_layers_kept *kept, const char *name, const char *words,
                             const conic_layers_kept_bytes *pieces, size_t n_pieces) {
  char hash[CONIC_SHA256_ROOM], line[LINE_ROOM];
  uint64_t n_bytes;
  char *path = allocate_name(kept);
  if (!path)
    return CONIC_ERROR_MEMORY;
  name_in_folder(kept, name, path);
  conic_status status = write_pieces(kept, path, pieces, n_pieces, &n_bytes, hash);
  if (status == CONIC_OK) {
    size_t n = conic_finished_file_head(hash, n_bytes, line);
    n += (size_t)snprintf(line + n, sizeof line - n, "%s\n%s\n", name, words);
    if (fwrite(line, 1, n, kept->stream) != n || fflush(kept->stream) != 0) /* as one: of several threads */
      status = cannot_keep(kept, kept->folder);
  }
  conic_memory_release(kept->context, path);
  return status;
}

conic_status conic_layers_kept_add(conic_layers_kept *kept, const conic_layers_kept_branch *branch,
                                   const unsigned char *bytes, size_t n_bytes) {
  char name[64], words[128];
  const conic_layers_kept_bytes piece = {bytes, n_bytes};
  file_of_branch(branch, name);
  snprintf(words, sizeof words, "branch %llu %u %llu", (unsigned long long)branch->key, branch->n_bits,
           (unsigned long long)branch->n_samples);
  return add_part(kept, name, words, &piece, 1);
}

conic_status conic_layers_kept_add_input(conic_layers_kept *kept, uint64_t number,
                                         const conic_layers_kept_bytes *pieces, size_t n_pieces) {
  char name[64], words[64];
  snprintf(name, sizeof name, "%llu.%s", (unsigned long long)number, input_ending);
  snprintf(words, sizeof words, "%s %llu", input_ending, (unsigned long long)number);
  return add_part(kept, name, words, pieces, n_pieces);
}

FILE *conic_layers_kept_open_input(const conic_layers_kept *kept, uint64_t number, uint64_t n_bytes) {
  char name[64], *path;
  conic_finished_file file;
  size_t i = kept->n_inputs;
  while (i > 0 && kept->inputs[i - 1].number != number)
    i--;
  if (i == 0)
    return NULL;
  size_t at = kept->inputs[i - 1].file_at;
  int n = snprintf(name, sizeof name, "%llu.%s", (unsigned long long)number, input_ending);
  if (!conic_finished_next_file(&kept->found, &at, &file) || file.n_bytes != n_bytes || file.n_name != (size_t)n ||
      memcmp(file.name, name, file.n_name) != 0 || !conic_finished_is_there(kept->folder, &file) ||
      !(path = allocate_name(kept)))
    return NULL;
  name_in_folder(kept, name, path);
  FILE *stream = conic_disk_open_stream(path, "rb");
  conic_memory_release(kept->context, path);
  return stream;
}

conic_status conic_layers_kept_read(const conic_layers_kept *kept, const conic_layers_kept_branch *branch,
                                    unsigned char **bytes, size_t *n_bytes) {
  char name[64], *path = allocate_name(kept);
  conic_disk_entry entry;
  conic_status status = path ? CONIC_OK : CONIC_ERROR_MEMORY;
  *bytes = NULL;
  if (!path)
    return status;
  file_of_branch(branch, name);
  name_in_folder(kept, name, path);
  FILE *stream = conic_disk_open_stream(path, "rb");
  int is_there = stream && conic_disk_look_at(fileno(stream), &entry) && entry.n_bytes < SIZE_MAX;
  if (is_there) {
    *n_bytes = (size_t)entry.n_bytes;
    *bytes = conic_memory_allocate(kept->context, *n_bytes, 1);
    status = *bytes ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  if (!is_there || (*bytes && fread(*bytes, 1, *n_bytes, stream) != *n_bytes))
    status = conic_fail(kept->context, CONIC_ERROR_IO, "%s: cannot read", path);
  if (stream)
    fclose(stream);
  conic_memory_release(kept->context, path);
  return status;
}
