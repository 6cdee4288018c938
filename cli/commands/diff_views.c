#include "cli/commands/diff_views.h"

#include "cli/shell.h"
#include "core/files/file.h"
#include "core/files/guard.h"
#include "core/files/number.h"

int cli_diff_is_many(const char *path) {
  conic_disk_entry found;
  if (conic_disk_look(path, &found))
    return found.is_folder;
  return strpbrk(path, "*?[") != NULL;
}

/* --- names --- */

/* The length of a picture's ending, with its dot, at the end of the first n letters of a name; 0: none. */
static int picture_ending(const char *name, int n) {
  static const char *const endings[] = {"exr", "pfm", "png", "jpg", "jpeg", "tif", "tiff", "hdr", "webp", "tga", "bmp"};
  char stem[256];
  if (n >= (int)sizeof stem)
    return 0;
  snprintf(stem, sizeof stem, "%.*s", n, name);
  for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
    if (conic_file_has_ending(stem, endings[i]))
      return (int)strlen(endings[i]) + 1;
  return 0;
}

/* 12 for "name.0012"; -1 for other names. */
static long frame_number(const char *stem, int n) {
  int n_digits = 0;
  while (n_digits < n && stem[n - n_digits - 1] >= '0' && stem[n - n_digits - 1] <= '9')
    n_digits++;
  if (n_digits == 0 || n_digits > 9 || n_digits == n || stem[n - n_digits - 1] != '.')
    return -1;
  return strtol(stem + n - n_digits, NULL, 10);
}

/* Orders names by letters, and numbers in them by value: frame9 comes before frame10. */
static int compare_by_nature(const void *first, const void *second) {
  const char *a = ((const cli_diff_file *)first)->name, *b = ((const cli_diff_file *)second)->name;
  while (*a && *b) {
    if (conic_is_digit(*a) && conic_is_digit(*b)) {
      size_t n_a, n_b;
      a += strspn(a, "0");
      b += strspn(b, "0");
      n_a = strspn(a, "0123456789");
      n_b = strspn(b, "0123456789");
      int order = n_a != n_b ? (n_a < n_b ? -1 : 1) : strncmp(a, b, n_a);
      if (order)
        return order;
      a += n_a;
      b += n_b;
    } else if (*a++ != *b++)
      return (unsigned char)a[-1] < (unsigned char)b[-1] ? -1 : 1;
  }
  if (*a || *b)
    return *a ? 1 : -1;
  return strcmp(((const cli_diff_file *)first)->name, ((const cli_diff_file *)second)->name);
}

static int compare_stems(const void *first, const void *second) {
  const cli_diff_file *a = *(const cli_diff_file *const *)first, *b = *(const cli_diff_file *const *)second;
  int n = a->n_stem < b->n_stem ? a->n_stem : b->n_stem, order = memcmp(a->name, b->name, (size_t)n);
  return order ? order : a->n_stem - b->n_stem;
}

static int compare_numbers(const void *first, const void *second) {
  const cli_diff_file *a = *(const cli_diff_file *const *)first, *b = *(const cli_diff_file *const *)second;
  return a->number < b->number ? -1 : a->number > b->number;
}

/* --- lists --- */

static int no_room(void) {
  return cli_error(CLI_RESOURCE, "diff: out of memory");
}

/* Adds a file, which is an input from now on; folders and other things are left out. */
static int add_file(const cli_diff_job *job, cli_diff_list *list, const char *folder, const char *name) {
  conic_disk_entry found;
  size_t room = strlen(folder) + strlen(name) + 2;
  cli_diff_file file = {.path = malloc(room)};
  if (!file.path)
    return no_room();
  int is_inside = *folder && !conic_disk_is_separator(folder[strlen(folder) - 1]);
  snprintf(file.path, room, "%s%s%s", folder, is_inside ? "/" : "", name);
  if (!conic_disk_look(file.path, &found) || !found.is_file) {
    free(file.path);
    return CLI_DONE;
  }
  if ((list->n & (list->n - 1)) == 0) { /* doubles the room */
    cli_diff_file *files = realloc(list->files, (list->n ? 2 * list->n : 1) * sizeof *files);
    if (!files) {
      free(file.path);
      return no_room();
    }
    list->files = files;
  }
  file.name = conic_file_name(file.path);
  file.n_stem = (int)strlen(file.name);
  for (int n; (n = picture_ending(file.name, file.n_stem)) > 0;)
    file.n_stem -= n;
  file.number = frame_number(file.name, file.n_stem);
  list->files[list->n++] = file;
  return cli_exit_of(conic_guard_note(job->session->context, file.path, &found));
}

static int list_folder(const cli_diff_job *job, const char *folder, cli_diff_list *list) {
  conic_disk_folder listing;
  int exit_code = CLI_DONE;
  if (!conic_disk_open_folder(folder, &listing))
    return cli_error(CLI_INPUT, "%s: cannot read: %s", folder, strerror(errno));
  for (const char *entry; exit_code == CLI_DONE && (entry = conic_disk_next_name(&listing));)
    if (entry[0] != '.' && picture_ending(entry, (int)strlen(entry)))
      exit_code = add_file(job, list, folder, entry);
  conic_disk_close_folder(&listing);
  return exit_code;
}

typedef struct matched_list {
  const cli_diff_job *job;
  cli_diff_list *list;
  int exit_code;
} matched_list;

static int add_matched(void *cookie, const char *path) {
  matched_list *matched = cookie;
  matched->exit_code = add_file(matched->job, matched->list, "", path);
  return matched->exit_code == CLI_DONE;
}

static int list_pattern(const cli_diff_job *job, const char *pattern, cli_diff_list *list) {
  matched_list matched = {job, list, CLI_DONE};
  return cli_shell_match(pattern, add_matched, &matched) ? matched.exit_code : no_room();
}

static int list_pictures(const cli_diff_job *job, const char *path, cli_diff_list *list) {
  conic_disk_entry found;
  int is_folder = conic_disk_look(path, &found) && found.is_folder;
  int exit_code = is_folder ? list_folder(job, path, list) : list_pattern(job, path, list);
  if (exit_code == CLI_DONE && list->n == 0)
    return cli_error(CLI_INPUT, is_folder ? "%s: there is no picture in it" : "%s: no file has such a name", path);
  if (exit_code == CLI_DONE)
    qsort(list->files, list->n, sizeof *list->files, compare_by_nature);
  return exit_code;
}

/* --- views --- */

static void add_view(cli_diff_views *views, size_t i_a, size_t i_b) {
  views->has_view[0][i_a] = views->has_view[1][i_b] = 1;
  views->views[views->n++] = (cli_diff_view){.files = {&views->lists[0].files[i_a], &views->lists[1].files[i_b]}};
}

typedef int (*file_order)(const void *first, const void *second);

/* The files in that order, for bsearch; null after a message. */
static const cli_diff_file **sort_files(const cli_diff_list *list, file_order order, int *exit_code) {
  const cli_diff_file **sorted = malloc(list->n * sizeof *sorted);
  if (!sorted) {
    *exit_code = no_room();
    return NULL;
  }
  for (size_t i = 0; i < list->n; i++)
    sorted[i] = &list->files[i];
  qsort(sorted, list->n, sizeof *sorted, order);
  for (size_t i = 1; i < list->n; i++)
    if (order(&sorted[i - 1], &sorted[i]) == 0) {
      *exit_code = cli_error(CLI_INPUT, "%s and %s have one name; say which by a pattern, as \"FOLDER/*.png\"",
                             sorted[i - 1]->path, sorted[i]->path);
      free(sorted);
      return NULL;
    }
  return sorted;
}

static int match_by_key(cli_diff_views *views, file_order order) {
  int exit_code = CLI_DONE;
  const cli_diff_file **first = sort_files(&views->lists[0], order, &exit_code);
  const cli_diff_file **second = first ? sort_files(&views->lists[1], order, &exit_code) : NULL;
  for (size_t i = 0; second && i < views->lists[0].n; i++) {
    const cli_diff_file *file = &views->lists[0].files[i];
    const cli_diff_file *const *found = bsearch(&file, second, views->lists[1].n, sizeof *second, order);
    if (found)
      add_view(views, i, (size_t)(*found - views->lists[1].files));
  }
  free(first);
  free(second);
  return exit_code;
}

static int is_numbered(const cli_diff_list *list) {
  size_t n = 0;
  while (n < list->n && list->files[n].number >= 0)
    n++;
  return n == list->n;
}

/* Matches frames with frames of the same number; or pictures by their place, as --view all numbers views, from 0. */
static int match_by_number(cli_diff_views *views) {
  int is_a = is_numbered(&views->lists[0]), is_b = is_numbered(&views->lists[1]);
  const cli_diff_list *numbered = &views->lists[is_a ? 0 : 1], *other = &views->lists[is_a ? 1 : 0];
  if (is_a && is_b)
    return match_by_key(views, compare_numbers);
  for (size_t i = 0; (is_a || is_b) && i < numbered->n; i++) {
    size_t place = (size_t)numbered->files[i].number;
    if (place >= other->n || views->has_view[is_a ? 1 : 0][place])
      continue;
    if (is_a)
      add_view(views, i, place);
    else
      add_view(views, place, i);
  }
  return CLI_DONE;
}

static int match_in_order(const cli_diff_job *job, cli_diff_views *views) {
  const cli_diff_list *lists = views->lists;
  if (lists[0].n != lists[1].n)
    return cli_error(CLI_INPUT, "%s: %zu pictures, but %zu in %s: which belong together?", job->paths[0], lists[0].n,
                     lists[1].n, job->paths[1]);
  for (size_t i = 0; i < lists[0].n; i++)
    add_view(views, i, i);
  return CLI_DONE;
}

/* Matches in the requested way, or in the first way that finds any matches. */
static int match_views(const cli_diff_job *job, cli_diff_views *views) {
  int exit_code = CLI_DONE, is_auto = job->match == CLI_MATCH_AUTO;
  for (int match = CLI_MATCH_NAME; match <= CLI_MATCH_ORDER && views->n == 0 && exit_code == CLI_DONE; match++) {
    if (!is_auto && match != job->match)
      continue;
    views->match = (cli_diff_match)match;
    if (match == CLI_MATCH_NAME)
      exit_code = match_by_key(views, compare_stems);
    else if (match == CLI_MATCH_NUMBER)
      exit_code = match_by_number(views);
    else
      exit_code = match_in_order(job, views);
  }
  if (exit_code == CLI_DONE && views->n == 0)
    return cli_error(CLI_INPUT, "%s: no picture there belongs to one of %s", job->paths[0], job->paths[1]);
  return exit_code;
}

int cli_diff_views_find(const cli_diff_job *job, cli_diff_views *views) {
  int exit_code = CLI_DONE;
  memset(views, 0, sizeof *views);
  for (int i = 0; i < 2 && exit_code == CLI_DONE; i++) {
    exit_code = list_pictures(job, job->paths[i], &views->lists[i]);
    views->has_view[i] = calloc(views->lists[i].n + 1, 1);
    if (exit_code == CLI_DONE && !views->has_view[i])
      exit_code = no_room();
  }
  if (exit_code != CLI_DONE)
    return exit_code;
  views->views = calloc(views->lists[0].n + 1, sizeof *views->views);
  return views->views ? match_views(job, views) : no_room();
}

void cli_diff_views_release(cli_diff_views *views) {
  for (int k = 0; k < 2; k++) {
    for (size_t i = 0; i < views->lists[k].n; i++)
      free(views->lists[k].files[i].path);
    free(views->lists[k].files);
    free(views->has_view[k]);
  }
  free(views->views);
}
