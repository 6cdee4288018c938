#include "cli/render/frames.h"

#include "cli/outputs.h"
#include "cli/scene/stereo.h"
#include "cli/scene/views.h"
#include "core/files/file.h"

enum { MOST_FRAMES = 9999, MOST_VIEWS = 9999999 };

/* A number of a frame at `*text`, and past it; -1 where there is none. */
static int take_frame_number(const char **text) {
  char *end;
  long n = **text >= '0' && **text <= '9' ? strtol(*text, &end, 10) : -1;
  if (n < 0 || n > MOST_VIEWS)
    return -1;
  *text = end;
  return (int)n;
}

int cli_parse_turntable(const char *text, void *value) {
  cli_render_job *job = value;
  job->is_turntable = 1;
  job->n_frames = take_frame_number(&text);
  return job->n_frames > 0 && job->n_frames <= MOST_FRAMES && *text == '\0';
}

/* A:B:STEP, or A-BxSTEP as queues of farms have it. */
int cli_parse_frames(const char *text, void *value) {
  static const char *const separators[] = {":-", ":x"};
  int numbers[3] = {0, 0, 1}, n = 0;
  do
    numbers[n] = take_frame_number(&text);
  while (numbers[n++] >= 0 && n < 3 && *text && strchr(separators[n - 1], *text) && *++text);
  if (n == 1)
    numbers[1] = numbers[0];
  *(cli_frames *)value = (cli_frames){numbers[0], numbers[1], numbers[2], 1};
  return *text == '\0' && numbers[0] >= 0 && numbers[0] <= numbers[1] && numbers[2] > 0 && !strchr(":-x", text[-1]);
}

/* --- names --- */

/* The first %d or %0Nd of a name, or else ## or more, with its length and N; null: there is none. Any other % and # is
 * a letter like others. */
static const char *find_pattern(const char *path, size_t *length, int *width) {
  for (const char *percent = strchr(path, '%'); percent; percent = strchr(percent + 1, '%')) {
    const char *end = percent + 1;
    *width = 1;
    if (end[0] == '0' && end[1] >= '1' && end[1] <= '9') {
      *width = end[1] - '0';
      end += 2;
    }
    *length = (size_t)(end + 1 - percent);
    if (*end == 'd')
      return percent;
  }
  const char *signs = strstr(path, "##");
  *length = signs ? strspn(signs, "#") : 0;
  *width = *length < 9 ? (int)*length : 9;
  return signs;
}

char *cli_frame_name(const cli_render_job *job, const char *path, int i_frame) {
  const char *base = conic_file_name(path), *dot = strrchr(base, '.'), *end = path + strlen(path);
  char stem[1024] = "";
  if (job->is_every_view)
    cli_view_stem(&job->cameras, (size_t)i_frame, stem, sizeof stem);
  size_t length = 0, room = strlen(path) + strlen(stem) + 32;
  int width = 4, number = i_frame + !job->is_every_view;
  char *name = malloc(room);
  if (!name)
    return NULL;
  int is_numbered = cli_frames_are_many(job) && strcmp(path, "-") != 0; /* there one comes after the other */
  const char *pattern = is_numbered ? find_pattern(path, &length, &width) : NULL;
  const char *place = is_numbered && job->is_every_view ? strstr(path, "%s") : NULL;
  if (!is_numbered)
    snprintf(name, room, "%s", path);
  else if (pattern)
    snprintf(name, room, "%.*s%0*d%s", (int)(pattern - path), path, width, number, pattern + length);
  else if (place)
    snprintf(name, room, "%.*s%s%s", (int)(place - path), path, stem, place + 2);
  else {
    const char *ending = dot ? dot : end;
    snprintf(name, room, "%.*s.%04d%s", (int)(ending - path), path, number, ending);
  }
  return cli_stereo_name(job, name);
}

static int check_pattern(const char *path) {
  size_t length;
  int width;
  const char *first = path ? find_pattern(path, &length, &width) : NULL;
  if (first && find_pattern(first + length, &length, &width))
    return cli_usage("%s: the number of the frame has one place, and here are two such as %%04d", path);
  return CLI_DONE;
}

static void free_names(char **names, int n) {
  for (int i = 0; names && i < n; i++)
    free(names[i]);
  free(names);
}

/* What frame `i_frame` writes. */
static int check_files(const cli_session *session, const cli_render_job *job, const char *const *paths, int n_paths,
                       int i_frame) {
  char **names = calloc((size_t)n_paths, sizeof *names);
  int is_there = names != NULL;
  for (int i = 0; i < n_paths && is_there; i++)
    is_there = !paths[i] || (names[i] = cli_frame_name(job, paths[i], i_frame));
  int answer = is_there ? cli_check_outputs(session, (const char *const *)names, n_paths)
                        : cli_error(CLI_RESOURCE, "%s: out of memory", session->command);
  if (answer == CLI_DONE)
    answer = cli_scene_inputs_stay(session, job, (const char *const *)names, n_paths);
  free_names(names, n_paths);
  return answer;
}

static int compare_frame_names(const void *a, const void *b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Names of views may be the same but for their folders. */
static int check_view_names(const cli_session *session, const cli_render_job *job, const char *path) {
  int n = cli_frames_count(job), answer = CLI_DONE;
  char **names = calloc((size_t)n, sizeof *names);
  int is_there = names != NULL;
  for (int i = 0; i < n && is_there; i++)
    is_there = (names[i] = cli_frame_name(job, path, job->frames.first - 1 + i * job->frames.step)) != NULL;
  if (is_there)
    qsort(names, (size_t)n, sizeof *names, compare_frame_names);
  else
    answer = cli_error(CLI_RESOURCE, "%s: out of memory", session->command);
  for (int i = 1; i < n && is_there && answer == CLI_DONE; i++)
    if (strcmp(names[i - 1], names[i]) == 0)
      answer = cli_usage("%s: two views would be written to %s; number them, as by %%04d", session->command, names[i]);
  free_names(names, n);
  return answer;
}

/* Which there are, by numbers from 1. */
static int check_frame_numbers(const cli_session *session, cli_render_job *job) {
  cli_frames *frames = &job->frames;
  int from = job->is_every_view ? 0 : 1; /* as users count */
  if (frames->is_given && !cli_frames_are_many(job))
    return cli_usage("%s: --frames chooses of a turntable's frames or of all views; give --turntable or --view all, "
                     "too",
                     session->command);
  if (frames->is_given && (frames->first < from || frames->last >= from + job->n_frames))
    return cli_usage("%s: --frames asks for %s %d, and there are %d to %d", session->command,
                     job->is_every_view ? "view" : "frame", frames->first < from ? frames->first : frames->last, from,
                     from + job->n_frames - 1);
  *frames = frames->is_given ? (cli_frames){frames->first + 1 - from, frames->last + 1 - from, frames->step, 1}
                             : (cli_frames){1, job->n_frames, 1, 0};
  return CLI_DONE;
}

int cli_frames_check(const cli_session *session, cli_render_job *job, const char *const *paths, int n_paths) {
  int answer = check_frame_numbers(session, job);
  for (int i = 0; i < n_paths && answer == CLI_DONE && cli_frames_are_many(job); i++)
    answer = check_pattern(paths[i]);
  for (int i = 0; i < n_paths && answer == CLI_DONE && job->is_every_view; i++)
    if (paths[i] && strstr(paths[i], "%s"))
      answer = check_view_names(session, job, paths[i]);
  for (int eye = 0; eye < cli_stereo_eyes(job) && answer == CLI_DONE; eye++) {
    cli_stereo_begin(job, eye);
    answer = check_files(session, job, paths, n_paths, job->frames.first - 1);
    if (answer == CLI_DONE)
      answer = check_files(session, job, paths, n_paths, job->frames.last - 1);
  }
  return answer;
}
