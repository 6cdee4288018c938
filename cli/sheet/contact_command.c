/* conic contact: a sheet of small pictures of many files. */
#include "cli/command.h"
#include "cli/outputs.h"
#include "cli/points/points_input.h"
#include "cli/render/fill_shot.h"
#include "cli/render/units.h"
#include "cli/scene/background_options.h"
#include "cli/sheet/strokes.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/image/image_common.h"
#include "core/pictures/image_png.h"
#include "core/pictures/image_samples.h"

/* In pixels: around a cell, its words, and their heights. */
enum { GAP = 14, WORDS = 36, NAME_HEIGHT = 9, FACT_HEIGHT = 8 };
/* The first are pictures. */
enum { N_PICTURES = 11 };
static const char *const shown_endings[] = {"png", "exr", "jpg", "jpeg", "tif",   "tiff",   "pfm", "hdr", "webp",
                                            "gif", "bmp", "ply", "xyz",  "pts",   "csv",    "las", "laz", "pcd",
                                            "e57", "ptx", "obj", "stl",  "off",   "gltf",   "glb", "3mf", "dae",
                                            "fbx", "cot", "chy", "lpc",  "splat", "ksplat", "spz", "sog", NULL};

typedef struct contact_job {
  cli_session *session;
  const char *output;
  int edge, n_columns; /* of a picture, in pixels; in a row */
  char *names;         /* one after the other */
  size_t n, n_bytes, room;
  size_t n_unreadable, i_next;
  const char *next;   /* of the names */
  int width, n_rows;  /* of the sheet in pixels, and of pictures */
  unsigned char *row; /* of cells: their pixels */
} contact_job;

static int is_picture(const char *path) {
  for (int i = 0; i < N_PICTURES; i++)
    if (conic_file_has_ending(path, shown_endings[i]))
      return 1;
  return 0;
}

/* What could not be read is said in its cell. */
static int keep_quiet(conic_log_level level, const char *message) {
  (void)level, (void)message;
  return 1;
}

/* --- a cell --- */

/* The mean of each pixel's part of the picture, on grey where it is transparent. */
static void shrink(const conic_image *image, int width, int height, float *rgba) {
  const float *from = image->planes[CONIC_PLANE_RGBA];
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++) {
      long x0 = (long)x * image->width / width, x1 = (long)(x + 1) * image->width / width;
      long y0 = (long)y * image->height / height, y1 = (long)(y + 1) * image->height / height;
      float sum[4] = {0}, n = 0.0f, *to = rgba + 4 * ((size_t)y * (size_t)width + (size_t)x);
      x1 = x1 > x0 ? x1 : x0 + 1;
      y1 = y1 > y0 ? y1 : y0 + 1;
      for (long j = y0; j < y1; j++)
        for (long i = x0; i < x1; i++, n += 1.0f)
          for (int c = 0; c < 4; c++)
            sum[c] += from[4 * (j * image->width + i) + c];
      for (int c = 0; c < 3; c++)
        to[c] = sum[c] / n + 0.6f * (1.0f - sum[3] / n);
      to[3] = 1.0f;
    }
}

/* "1,234,567 points". */
static void count_things(const conic_source_scale *scale, char *text, size_t room) {
  unsigned long long n = scale->n_triangles ? scale->n_triangles : scale->n_splats;
  const char *things = scale->n_triangles                           ? "triangles"
                       : scale->abilities & CONIC_SOURCE_COMPOSITES ? "Gaussians"
                                                                    : "points";
  if (n >= 1000000)
    snprintf(text, room, "%.1f M %s", (double)n / 1e6, things);
  else
    snprintf(text, room, "%llu %s", n, things);
}

static conic_status draw_shot(cli_session *session, cli_render_job *scene, conic_image *drawn) {
  conic_shot_outcome outcome;
  conic_status status = cli_scene_begin(session, scene);
  if (status == CONIC_OK && cli_units_choose(session, scene) != CLI_DONE)
    status = CONIC_ERROR_ARGUMENT;
  if (status == CONIC_OK)
    status = cli_scene_open(session, scene);
  if (status == CONIC_OK)
    status = cli_shot_fill(session, scene, 0);
  const conic_camera *camera = &scene->shot.camera;
  if (status == CONIC_OK)
    status = conic_image_allocate(session->context, camera->width, camera->height, scene->shot.planes, drawn);
  return status == CONIC_OK ? cli_render_picture(scene, drawn, &outcome) : status;
}

/* As conic render draws it. */
static conic_status draw_scene(const contact_job *job, const char *path, conic_image *shown, char *fact, size_t room) {
  cli_session *session = job->session;
  cli_render_job scene;
  conic_image drawn = {0};
  char size[32], name[] = "contact", option[] = "--size", input[4096], *words[] = {name, input, option, size, NULL};
  snprintf(size, sizeof size, "%dx%d", job->edge, job->edge);
  snprintf(input, sizeof input, "%s", path);
  cli_scene_defaults(&scene);
  scene.is_for_looking = 1;
  scene.shot.planes = 1u << CONIC_PLANE_RGBA;
  scene.frames = (cli_frames){1, 1, 1, 0};
  conic_status status =
      cli_scene_parse(session, NULL, 0, 4, words, &scene) == CLI_DONE ? CONIC_OK : CONIC_ERROR_ARGUMENT;
  if (status == CONIC_OK) {
    status = draw_shot(session, &scene, &drawn);
    if (status == CONIC_OK)
      status = cli_backdrop_show(session, &scene, &drawn, shown);
    shown->is_display = drawn.is_display;
    if (status == CONIC_OK)
      count_things(conic_source_measure(scene.source), fact, room);
    cli_scene_release(session, &scene);
  }
  conic_image_release(session->context, &drawn);
  free(scene.inputs);
  return status;
}

static conic_status read_cell(const contact_job *job, const char *path, conic_image *shown, char *fact, size_t room) {
  if (!is_picture(path))
    return draw_scene(job, path, shown, fact, room);
  conic_status status = conic_image_read(job->session->context, path, shown);
  if (status == CONIC_OK && !shown->planes[CONIC_PLANE_RGBA])
    status = CONIC_ERROR_INPUT;
  if (status == CONIC_OK)
    snprintf(fact, room, "%d x %d", shown->width, shown->height);
  return status;
}

static void letter_cell(cli_strokes *strokes, const contact_job *job, const char *path, const char *fact, double x,
                        double y) {
  char name[512], facts[160], size[32] = "";
  conic_disk_entry found;
  const cli_lettering large = {.height = NAME_HEIGHT, .weight = 1.1, .grey = 0.05f};
  const cli_lettering small = {.height = FACT_HEIGHT, .weight = 0.9, .grey = 0.4f};
  if (conic_disk_look(path, &found) && found.is_file)
    snprintf(size, sizeof size, found.n_bytes < 1000000 ? "   %.0f kB" : "   %.1f MB",
             (double)found.n_bytes / (found.n_bytes < 1000000 ? 1e3 : 1e6));
  snprintf(name, sizeof name, "%.500s", conic_file_name(path));
  for (size_t n = strlen(name); n > 3 && cli_text_length(name, NAME_HEIGHT) > job->edge; n--)
    snprintf(name + n - 3, 3, "..");
  snprintf(facts, sizeof facts, "%.100s%s", fact, size);
  cli_strokes_text(strokes, name, x, y + job->edge + 16, &large);
  cli_strokes_text(strokes, facts, x, y + job->edge + 30, &small);
}

/* The largest picture of that shape in the middle of the cell. */
static conic_status put_cell(contact_job *job, const conic_image *shown, int left) {
  conic_context *context = job->session->context;
  int larger = shown->width > shown->height ? shown->width : shown->height;
  int width = (int)((long)shown->width * job->edge / larger), height = (int)((long)shown->height * job->edge / larger);
  width = width > 0 ? width : 1;
  height = height > 0 ? height : 1;
  float *rgba = conic_memory_allocate(context, (size_t)width * (size_t)height, 4 * sizeof *rgba);
  unsigned char *codes = conic_memory_allocate(context, (size_t)width * (size_t)height, 4);
  if (rgba && codes) {
    shrink(shown, width, height, rgba);
    conic_samples_from_rgba(
        context, rgba, width, height,
        (conic_samples_layout){.n_channels = 4, .sample_bytes = 1, .is_display = shown->is_display != 0}, codes);
    for (int y = 0; y < height; y++)
      memcpy(job->row + 4 * ((size_t)(GAP + (job->edge - height) / 2 + y) * (size_t)job->width +
                             (size_t)(left + (job->edge - width) / 2)),
             codes + (size_t)4 * (size_t)width * (size_t)y, (size_t)4 * (size_t)width);
  }
  conic_status status = rgba && codes ? CONIC_OK : CONIC_ERROR_MEMORY;
  conic_memory_release_these(context, rgba, codes);
  return status;
}

static conic_status make_cell(contact_job *job, cli_strokes *strokes, const char *path, int left) {
  conic_image shown = {0};
  char fact[120] = "cannot be read";
  cli_session_part(job->session, "file", (int)job->i_next, (int)job->n);
  cli_session_hold(keep_quiet);
  conic_status status = read_cell(job, path, &shown, fact, sizeof fact);
  cli_session_hold(NULL);
  int is_read = status == CONIC_OK, is_ended = status == CONIC_ERROR_CANCELLED;
  status = is_read ? put_cell(job, &shown, left) : is_ended ? status : CONIC_OK;
  conic_image_release(job->session->context, &shown);
  if (!is_read) {
    double x1 = left + job->edge, y1 = GAP + job->edge;
    job->n_unreadable++;
    snprintf(fact, sizeof fact, "cannot be read");
    cli_strokes_line(strokes, left, GAP, x1, y1, 1.0, 0.7f);
    cli_strokes_line(strokes, left, y1, x1, GAP, 1.0, 0.7f);
    const double corners[5][2] = {{left, GAP}, {x1, GAP}, {x1, y1}, {left, y1}, {left, GAP}};
    for (int i = 0; i < 4; i++)
      cli_strokes_line(strokes, corners[i][0], corners[i][1], corners[i + 1][0], corners[i + 1][1], 1.0, 0.7f);
  }
  letter_cell(strokes, job, path, fact, left, GAP);
  return status;
}

static int row_height(const contact_job *job) {
  return job->edge + WORDS + GAP;
}

static conic_status next_row(void *cookie, int y, unsigned char *row) {
  contact_job *job = cookie;
  size_t row_bytes = (size_t)4 * (size_t)job->width;
  cli_strokes strokes = {.context = job->session->context};
  conic_status status = CONIC_OK;
  if (y % row_height(job) == 0) {
    memset(job->row, 0xff, row_bytes * (size_t)row_height(job));
    for (int i = 0; i < job->n_columns && job->i_next < job->n && status == CONIC_OK; i++) {
      job->i_next++;
      status = make_cell(job, &strokes, job->next, GAP + i * (job->edge + GAP));
      job->next += strlen(job->next) + 1;
    }
    status = status == CONIC_OK ? strokes.status : status;
    cli_strokes_paint(&strokes, 0, row_height(job), job->width, job->row);
    cli_strokes_release(&strokes);
  }
  memcpy(row, job->row + row_bytes * (size_t)(y % row_height(job)), row_bytes);
  return status;
}

/* --- the command --- */

static conic_status write_contact(contact_job *job) {
  conic_context *context = job->session->context;
  if (job->n_columns == 0)
    for (job->n_columns = 1; (size_t)job->n_columns * (size_t)job->n_columns < job->n + job->n / 3;)
      job->n_columns++;
  job->n_columns = (size_t)job->n_columns < job->n ? job->n_columns : (int)job->n;
  job->n_rows = (int)((job->n + (size_t)job->n_columns - 1) / (size_t)job->n_columns);
  job->width = GAP + job->n_columns * (job->edge + GAP);
  const double height = (double)job->n_rows * row_height(job);
  if (job->width > CONIC_IMAGE_MAX_SIZE || height > CONIC_IMAGE_MAX_SIZE)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: %d x %.0f pixels are too many; a smaller --size may do",
                      job->output, job->width, height);
  job->row = conic_memory_allocate(context, (size_t)job->width * (size_t)row_height(job), 4);
  job->next = job->names;
  const conic_png_rows rows = {job->width, (int)height, 96.0, job, next_row};
  return job->row ? conic_png_write_rows(context, job->output, &rows) : CONIC_ERROR_MEMORY;
}

static void report_contact(cli_json *json, const void *cookie) {
  const contact_job *job = cookie;
  cli_json_text(json, "output", job->output);
  cli_json_counts(json, NULL, {"width", (uint64_t)job->width}, {"height", (uint64_t)(job->n_rows * row_height(job))},
                  {"columns", (uint64_t)job->n_columns}, {"files", job->n}, {"unreadable", job->n_unreadable},
                  {"peak_rss_bytes", cli_peak_rss_bytes()});
}

static conic_status list_files(contact_job *job, const char *const *inputs, int n_inputs) {
  conic_status status = CONIC_OK;
  for (int i = 0; i < n_inputs && status == CONIC_OK; i++)
    status =
        cli_points_folder_list(job->session->context, inputs[i], shown_endings, &job->names, &job->n_bytes, &job->room);
  for (size_t i = 0; i < job->n_bytes; i++)
    job->n += !job->names[i];
  return status;
}

static int run_contact(cli_session *session, int argc, char **argv) {
  contact_job job = {.session = session, .edge = 256};
  const char *inputs[argc];
  int n_inputs;
  const cli_option options[] = {
      {"o", CLI_TEXT, &job.output, "SHEET.png", "where the sheet goes"},
      {"size", CLI_INT, &job.edge, "PX", "the longer side of a picture on it [256]", 16, 4096},
      {"columns", CLI_INT, &job.n_columns, "N", "pictures in a row [so that the sheet is about 4 : 3]", 1, 4096},
  };
  int exit_code = cli_parse(session, options, sizeof options / sizeof *options, argc, argv, inputs, &n_inputs);
  if (exit_code == CLI_DONE && n_inputs == 0)
    exit_code = cli_usage("contact: no files; see conic help contact");
  if (exit_code == CLI_DONE && (!job.output || !conic_file_has_ending(job.output, "png")))
    exit_code = job.output ? cli_usage("contact: %s: a contact sheet is a .png", job.output)
                           : cli_usage("contact: no output; give one with -o SHEET.png");
  if (exit_code == CLI_DONE)
    exit_code = cli_check_outputs(session, &job.output, 1);
  if (exit_code == CLI_DONE)
    exit_code = cli_check_inputs_stay(session, inputs, n_inputs, &job.output, 1);
  if (exit_code == CLI_DONE)
    exit_code = cli_session_open(session);
  if (exit_code != CLI_DONE)
    return exit_code < 0 ? CLI_DONE : exit_code;
  conic_status status = list_files(&job, inputs, n_inputs);
  if (status == CONIC_OK)
    status = write_contact(&job);
  exit_code = status == CONIC_OK ? cli_json_write(session, report_contact, &job) : cli_exit_of(status);
  if (status == CONIC_OK && !session->is_quiet && cli_json_leaves_text(session))
    printf("%s: %zu files, of which %zu cannot be read\n", job.output, job.n, job.n_unreadable);
  conic_memory_release_these(session->context, job.row, job.names);
  return exit_code;
}

const cli_command cli_contact = {
    .name = "contact",
    .summary = "shows many files on one sheet, each small",
    .usage = "conic contact DIR|FILES… -o SHEET.png [--size PX] [--columns N]",
    .run = run_contact,
    .description =
        "Draws what is in folders, or files by their names: scans, meshes and Gaussian scenes as conic render "
        "draws them, and pictures as they are; with their names, counts and sizes. What cannot be read is "
        "shown as such.",
    .examples = {{"what is in a folder", "conic contact scans -o sheet.png"},
                 {"a turntable on one sheet", "conic contact turn_*.png --columns 6 -o turn.png"}},
};
