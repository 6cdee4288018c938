#include "cli/render/film.h"

#include "cli/outputs.h"
#include "cli/scene/background_options.h"
#include "cli/shell.h"
#include "core/base/byte_order.h"
#include "core/files/file.h"
#include "core/pictures/image_samples.h"

static const char *const films[] = {"mp4", "webm", "gif", NULL};

/* What ffmpeg is told of the colours' codes: 8 or 10 bits, of edges that are even. */
static const char *const filter = "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv,"
                                  "setparams=colorspace=bt709:color_primaries=bt709:color_trc=bt709";
static const char *const palette = "split[a][b];[a]palettegen[p];[b][p]paletteuse";

static int film_kind(const char *path) {
  for (int i = 0; films[i]; i++)
    if (conic_file_has_ending(path, films[i]))
      return i;
  return -1;
}

int cli_parse_film(const char *text, void *value) {
  cli_film *film = value;
  double pair[2] = {0.0, -1.0};
  if (!(strchr(text, ':') ? cli_parse_pair(text, ':', pair) : cli_parse_number(text, pair)) ||
      (pair[0] != 8.0 && pair[0] != 10.0) || pair[1] != floor(pair[1]) || pair[1] > 63.0)
    return 0;
  film->bits = (int)pair[0];
  film->quality = (int)pair[1];
  return pair[1] >= 0.0 || !strchr(text, ':');
}

/* A film that was asked for and cannot be is a failure, found before anything is drawn. */
static int fail_without_ffmpeg(const cli_render_job *job, const char *path) {
  int n_stem = (int)(conic_file_ending(path) - path);
  return cli_error(
      CLI_RESOURCE,
      "%s: there is no ffmpeg to make it; draw frames by -o '%.*spng', of which it makes the film anywhere: "
      "ffmpeg -framerate %g -start_number %d -i '%.*s%%04d.png' '%s'",
      path, n_stem, path, job->fps, job->frames.is_given ? job->frames.first : job->is_turntable, n_stem, path, path);
}

int cli_film_check(const cli_session *session, cli_render_job *job) {
  cli_film *film = &job->film;
  int is_many = job->is_turntable || job->path_file || (job->view_name && strcmp(job->view_name, "all") == 0);
  for (int i = 0; i < job->n_outputs; i++) {
    const char *path = job->outputs[i];
    int kind = film_kind(path);
    if (kind < 0 || (kind == 2 && (!is_many || strchr(path, '%')))) /* a .gif of one picture is one */
      continue;
    if (strchr(path, '%'))
      return cli_usage("%s: a film is one file, and its name has no %% for the number of a frame", path);
    if (!is_many)
      return cli_usage("%s: a film has several pictures; give --path, --turntable or --view all, too", path);
    if (!(job->shot.planes & 1u << CONIC_PLANE_RGBA))
      return cli_usage("%s: a film shows rgba", path);
    if (film->path)
      return cli_usage("render: one film at a time; %s is the second", path);
    if (job->accumulating.is_resumable || job->accumulating.resume_path || job->stereo.distance > 0.0)
      return cli_usage("%s: a film is made at once, and of one eye: not with --resumable, --resume or --stereo", path);
    film->path = path;
    film->kind = kind;
    if (!session->host && !cli_shell_has_program("ffmpeg"))
      return fail_without_ffmpeg(job, path);
    memmove(job->outputs + i, job->outputs + i + 1, (size_t)(--job->n_outputs - i) * sizeof *job->outputs);
    i--;
  }
  int answer = cli_check_outputs(session, &film->path, 1);
  return answer == CLI_DONE ? cli_scene_inputs_stay(session, job, &film->path, 1) : answer;
}

static conic_status begin_film(cli_session *session, cli_render_job *job, const conic_image *image) {
  cli_film *film = &job->film;
  char size[32], fps[32], quality[16];
  int bits = film->bits ? film->bits : 8, is_gif = film->kind == 2;
  static const char *const codecs[] = {"libx264", "libvpx-vp9"};
  snprintf(size, sizeof size, "%dx%d", image->width, image->height);
  snprintf(fps, sizeof fps, "%.9g", job->fps);
  snprintf(quality, sizeof quality, "%d", film->bits && film->quality >= 0 ? film->quality : film->kind ? 24 : 17);
  conic_status status = conic_output_open(session->context, film->path, &film->output);
  if (status != CONIC_OK)
    return status;
  const char *words[40] = {
      "ffmpeg",      "-y", "-loglevel",  "quiet", "-f", "rawvideo", "-pix_fmt", "rgb48le",
      "-video_size", size, "-framerate", fps,     "-i", "-",        "-vf",      is_gif ? palette : filter};
  int n = 16;
  const char *const coding[] = {
      "-c:v", codecs[film->kind % 2], "-crf", quality, "-b:v", "0", "-pix_fmt", bits == 10 ? "yuv420p10le" : "yuv420p"};
  for (size_t i = 0; i < sizeof coding / sizeof *coding && !is_gif; i++)
    words[n++] = coding[i];
  words[n++] = "-f";
  words[n++] = films[film->kind];
  words[n++] = conic_output_temporary(film->output);
  film->pipe = cli_shell_pipe_to(words);
  film->width = image->width;
  film->height = image->height;
  return film->pipe ? CONIC_OK : CONIC_ERROR_IO;
}

static conic_status fail_film(const cli_session *session, const cli_film *film) {
  return conic_fail(session->context, CONIC_ERROR_IO, "%s: cannot write: ffmpeg ended early", film->path);
}

conic_status cli_film_add(cli_session *session, cli_render_job *job, const conic_image *drawn) {
  conic_context *context = session->context;
  cli_film *film = &job->film;
  conic_image shown = {0};
  if (!film->path)
    return CONIC_OK;
  conic_status status = film->pipe ? CONIC_OK : begin_film(session, job, drawn);
  if (status == CONIC_OK && (drawn->width != film->width || drawn->height != film->height))
    status =
        conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the pictures of a film have one size; give --size", film->path);
  if (status == CONIC_OK)
    status = cli_backdrop_show(session, job, drawn, &shown);
  if (status != CONIC_OK)
    return status;
  size_t n = (size_t)drawn->width * (size_t)drawn->height;
  const conic_image_options writing = cli_picture_writing(job);
  const conic_samples_layout layout = {
      .n_channels = 3, .sample_bytes = 2, .is_display = drawn->is_display != 0, .tone = writing.tone};
  uint16_t *codes = conic_memory_allocate(context, n, 3 * sizeof *codes);
  if (codes) {
    conic_samples_from_rgba(context, shown.planes[CONIC_PLANE_RGBA], drawn->width, drawn->height, layout, codes);
    conic_turn_words((unsigned char *)codes, 3 * n, sizeof *codes);
    status = fwrite(codes, 3 * sizeof *codes, n, film->pipe) == n ? CONIC_OK : fail_film(session, film);
  } else
    status = CONIC_ERROR_MEMORY;
  conic_memory_release(context, codes);
  conic_image_release(context, &shown);
  return status;
}

conic_status cli_film_end(cli_session *session, cli_render_job *job, conic_status status) {
  cli_film *film = &job->film;
  if (film->pipe && cli_shell_pipe_end(film->pipe) != 0 && status == CONIC_OK)
    status = fail_film(session, film);
  film->pipe = NULL;
  status = film->output ? conic_output_end(film->output, status) : status;
  film->output = NULL;
  return status;
}
