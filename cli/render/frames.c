#include "cli/render/frames.h"

#include <stdlib.h>
#include <string.h>

#include "cli/outputs.h"
#include "core/base/trigonometry.h"
#include "core/base/vectors.h"

enum { MOST_FRAMES = 9999 };

/* A number of a frame at `*text`, and past it; 0 where there is none. */
static int take_frame_number(const char **text) {
  char *end;
  long n = **text >= '0' && **text <= '9' ? strtol(*text, &end, 10) : 0;
  if (n < 1 || n > MOST_FRAMES)
    return 0;
  *text = end;
  return (int)n;
}

int cli_parse_turntable(const char *text, void *value) {
  cli_render_job *job = value;
  job->is_turntable = 1;
  job->n_frames = take_frame_number(&text);
  return job->n_frames > 0 && *text == '\0';
}

int cli_parse_frames(const char *text, void *value) {
  int numbers[3] = {0, 0, 1}, n = 0;
  do
    numbers[n] = take_frame_number(&text);
  while (numbers[n++] && n < 3 && *text == ':' && *++text);
  if (n == 1)
    numbers[1] = numbers[0];
  *(cli_frames *)value = (cli_frames){numbers[0], numbers[1], numbers[2]};
  return *text == '\0' && text[-1] != ':' && numbers[0] && numbers[0] <= numbers[1] && numbers[2];
}

int cli_frames_count(const cli_render_job *job) {
  return (job->frames.last - job->frames.first) / job->frames.step + 1;
}

/* --- names --- */

/* The first %d or %0Nd of a name, with its length and N; null: there is none. Any other % is a letter like others. */
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
  return NULL;
}

char *cli_frame_name(const cli_render_job *job, const char *path, int i_frame) {
  const char *slash = strrchr(path, '/'), *dot = strrchr(path, '.'), *end = path + strlen(path);
  size_t length = 0, room = strlen(path) + 32;
  int width = 4;
  char *name = malloc(room);
  if (!name)
    return NULL;
  int is_numbered = job->is_turntable && strcmp(path, "-") != 0; /* there one comes after the other */
  const char *pattern = is_numbered ? find_pattern(path, &length, &width) : NULL;
  if (!is_numbered)
    snprintf(name, room, "%s", path);
  else if (pattern)
    snprintf(name, room, "%.*s%0*d%s", (int)(pattern - path), path, width, i_frame + 1, pattern + length);
  else {
    const char *ending = dot && (!slash || dot > slash) ? dot : end;
    snprintf(name, room, "%.*s.%04d%s", (int)(ending - path), path, i_frame + 1, ending);
  }
  return name;
}

static int check_pattern(const char *path) {
  size_t length;
  int width;
  const char *first = path ? find_pattern(path, &length, &width) : NULL;
  if (first && find_pattern(first + length, &length, &width))
    return cli_usage("%s: the number of the frame has one place, and here are two such as %%04d", path);
  return CLI_DONE;
}

/* What frame `i_frame` writes. */
static int check_files(const cli_session *session, const cli_render_job *job, const char *const *paths, int n_paths,
                       int i_frame) {
  char **names = calloc((size_t)n_paths, sizeof *names);
  int answer = names ? CLI_DONE : cli_error(CLI_RESOURCE, "%s: out of memory", session->command);
  for (int i = 0; i < n_paths && answer == CLI_DONE; i++)
    if (paths[i] && !(names[i] = cli_frame_name(job, paths[i], i_frame)))
      answer = cli_error(CLI_RESOURCE, "%s: out of memory", session->command);
  if (answer == CLI_DONE)
    answer = cli_check_outputs(session, (const char *const *)names, n_paths);
  if (answer == CLI_DONE)
    answer = cli_scene_inputs_stay(session, job, (const char *const *)names, n_paths);
  for (int i = 0; names && i < n_paths; i++)
    free(names[i]);
  free(names);
  return answer;
}

int cli_frames_check(const cli_session *session, cli_render_job *job, const char *const *paths, int n_paths) {
  int answer = CLI_DONE, is_given = job->frames.first > 0;
  if (is_given && !job->is_turntable)
    return cli_usage("%s: --frames chooses of a turntable's frames; give --turntable, too", session->command);
  if (is_given && job->frames.last > job->n_frames)
    return cli_usage("%s: --frames asks for frame %d, and --turntable has %d", session->command, job->frames.last,
                     job->n_frames);
  if (!is_given)
    job->frames = (cli_frames){1, job->n_frames, 1};
  for (int i = 0; i < n_paths && answer == CLI_DONE && job->is_turntable; i++)
    answer = check_pattern(paths[i]);
  if (answer == CLI_DONE)
    answer = check_files(session, job, paths, n_paths, job->frames.first - 1);
  return answer == CLI_DONE ? check_files(session, job, paths, n_paths, job->frames.last - 1) : answer;
}

/* --- cameras --- */

/* By Rodrigues' formula: against the clock as seen from where the axis, which is unit, points to. */
static void turn_about(const double axis[3], double cosine, double sine, double v[3]) {
  double across[3], along = conic_dot(axis, v) * (1.0 - cosine);
  conic_cross(axis, v, across);
  for (int i = 0; i < 3; i++)
    v[i] = v[i] * cosine + across[i] * sine + axis[i] * along;
}

void cli_frame_orbit(const cli_render_job *job, int i_frame, conic_camera *camera) {
  const conic_source_scale *scale = conic_source_measure(job->source);
  const double *up = job->is_up_given ? job->framing.up : scale->up;
  double angle = conic_radians(360.0 * (double)i_frame / (double)job->n_frames), length = conic_length(up);
  const double axis[3] = {up[0] / length, up[1] / length, up[2] / length};
  double center[3];
  if (i_frame == 0)
    return; /* to the bit where the file puts it */
  for (int i = 0; i < 3; i++)
    center[i] = 0.5 * scale->minimum[i] + 0.5 * scale->maximum[i];
  for (int i = 0; i < 3; i++) {
    double *row = camera->cam_from_world[i], to_center = conic_dot(row, center);
    turn_about(axis, conic_cos(angle), conic_sin(angle), row);
    row[3] += to_center - conic_dot(row, center);
  }
}
