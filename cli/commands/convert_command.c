/* conic convert: writes a Gaussian scene in another format, and says what was lost. */

#include <strings.h>

#include "cli/command.h"
#include "cli/commands/build_steps.h"
#include "cli/outputs.h"
#include "core/files/disk.h"
#include "core/files/file.h"

typedef struct convert_job {
  cli_build base;
  conic_gaussians_write_options write;
  const char *frame; /* null: the frame of the output's kind; "keep": the input's */
  const char *from_frame;
  int to, keeps_order, is_reordered; /* to: the kind of --to, plus 1 */
  int sh_bits;

  conic_gaussians scene, written; /* scene: as it was read, turned and ordered; written: as it is read back */
  char frame_in[4];
  conic_gaussian_kind kind_in;
  int is_checked, is_lossless;
  conic_gaussians_differences differences;
  char losses[400];
  int n_views;     /* from which pictures before and after are compared; 0: none are drawn */
  double psnr;     /* of R, G and B as display values from 0 to 1, over all views; infinite for equal pictures */
  double greatest; /* the greatest difference of a value */
} convert_job;

enum { READ, WORK, WRITE, CHECK };

static const char *const kind_names[] = {"auto", "ply", "compressed-ply", "splat", "spz", "sog", "gltf", "glb", NULL};

/* With neighbours together, chunks and pictures are smaller, and less rounded. */
static int wants_neighbours(conic_gaussian_kind kind) {
  return kind == CONIC_GAUSSIANS_COMPRESSED_PLY || kind == CONIC_GAUSSIANS_SOG;
}

static conic_status arrange(convert_job *job) {
  conic_context *context = job->base.session->context;
  const char *frame = job->frame ? job->frame : conic_gaussian_kind_frame(job->write.kind);
  conic_status status = CONIC_OK;
  if (job->from_frame)
    snprintf(job->scene.frame, sizeof job->scene.frame, "%s", job->from_frame);
  memcpy(job->frame_in, job->scene.frame, sizeof job->frame_in);
  job->kind_in = job->scene.kind;
  if (strcmp(frame, "keep") != 0)
    status = conic_gaussians_turn(context, &job->scene, frame);
  job->is_reordered = !job->keeps_order && wants_neighbours(job->write.kind) && !wants_neighbours(job->kind_in);
  if (status == CONIC_OK && job->is_reordered)
    status = conic_gaussians_sort(context, &job->scene);
  return status;
}

static void add_loss(convert_job *job, const char *format, double value) {
  size_t n = strlen(job->losses);
  n += (size_t)snprintf(job->losses + n, sizeof job->losses - n, "%s", n ? ", " : "");
  snprintf(job->losses + n, sizeof job->losses - n, format, value);
}

/* Says in words what has changed. */
static void find_losses(convert_job *job) {
  const conic_gaussians_differences *apart = &job->differences;
  const conic_gaussians *from = &job->scene, *to = &job->written;
  char degrees[64];
  snprintf(degrees, sizeof degrees, "harmonics of degree %d became %d", from->sh_degree, to->sh_degree);
  if (to->sh_degree != from->sh_degree)
    add_loss(job, degrees, 0.0);
  if (!from->scale[2] && to->scale[2])
    add_loss(job, "2D Gaussians became flat 3D ones", 0.0);
  if (from->is_antialiased && !to->is_antialiased)
    add_loss(job, "nothing says any more that it was trained antialiased", 0.0);
  if (from->is_linear && !to->is_linear)
    add_loss(job, "nothing says any more that colours are linear", 0.0);
  if (from->up[0] != to->up[0] || from->up[1] != to->up[1] || from->up[2] != to->up[2])
    add_loss(job, "nothing says any more which way is up", 0.0);
  if (from->n_left_out)
    add_loss(job, "%g columns that Gaussians do not need are left out", (double)from->n_left_out);
  const struct {
    const char *format;
    double value;
  } greatest[] = {
      {"means moved by up to %.2g", apart->position},    {"scales changed by up to %.2g %%", 100.0 * apart->scale},
      {"rotations by up to %.2g°", apart->rotation_deg}, {"opacities by up to %.2g", apart->opacity},
      {"colours by up to %.2g", apart->color},           {"harmonics by up to %.2g", apart->harmonics}};
  for (size_t i = 0; i < sizeof greatest / sizeof *greatest; i++)
    if (greatest[i].value > 0.0)
      add_loss(job, greatest[i].format, greatest[i].value);
  if (!job->losses[0])
    add_loss(job, "quaternions have other lengths", 0.0);
}

/* Reads the output back, and compares. */
static conic_status read_again(convert_job *job) {
  conic_context *context = job->base.session->context;
  conic_gaussians_read_options options;
  conic_gaussians_read_options_init(&options);
  options.keeps_source = 1;
  options.is_splat = job->write.kind == CONIC_GAUSSIANS_SPLAT;
  conic_status status = conic_gaussians_read(context, job->base.output, &options, &job->written);
  memcpy(job->written.frame, job->scene.frame, sizeof job->written.frame); /* files do not state their frame */
  if (status == CONIC_OK)
    status = conic_gaussians_compare(context, &job->scene, &job->written, &job->differences);
  job->is_checked = status == CONIC_OK;
  job->is_lossless = job->is_checked && job->differences.is_same && job->scene.n_left_out == 0;
  if (job->is_checked && !job->is_lossless)
    find_losses(job);
  return status;
}

enum { SIDE = 512 };

typedef struct two_pictures {
  conic_gaussian_planes planes[2];
  double squares, greatest;
} two_pictures;

static double display_value(float value) {
  return value < 0.0f ? 0.0 : value < 1.0f ? (double)value : 1.0;
}

static void add_differences(two_pictures *both) {
  for (size_t i = 0; i < 3 * (size_t)SIDE * SIDE; i++) {
    double apart = fabs(display_value(both->planes[0].rgb[i]) - display_value(both->planes[1].rgb[i]));
    both->squares += apart * apart;
    both->greatest = apart > both->greatest ? apart : both->greatest;
  }
}

static conic_status draw_views(conic_context *context, conic_source *source, const conic_gaussians *const scenes[2],
                               int n_views, two_pictures *both) {
  conic_framing framing;
  conic_status status = CONIC_OK;
  conic_framing_init(&framing);
  framing.width = framing.height = SIDE;
  for (int view = 0; view < n_views && status == CONIC_OK; view++) {
    conic_camera camera;
    framing.azimuth_deg = 30.0 + 360.0 * view / n_views;
    status = conic_source_frame(source, &framing, &camera);
    for (int i = 0; i < 2 && status == CONIC_OK; i++)
      status = conic_gaussians_render(context, scenes[i], &camera, NULL, &both->planes[i], NULL);
    if (status == CONIC_OK)
      add_differences(both);
  }
  return status;
}

/* Draws both scenes, which have the same order, with the profile `exact` from all sides of the output, and compares the
 * pictures. */
static conic_status measure_pictures(convert_job *job) {
  conic_context *context = job->base.session->context;
  const conic_gaussians *const scenes[2] = {&job->scene, &job->written};
  const size_t n = 3 * (size_t)SIDE * SIDE;
  conic_gaussian_options exact;
  conic_source_options opening;
  conic_source *source = NULL;
  two_pictures both = {.planes = {{.width = SIDE, .height = SIDE}, {.width = SIDE, .height = SIDE}}};
  conic_gaussian_options_init(&exact);
  conic_source_options_init(&opening);
  opening.gaussians = &exact;
  both.planes[0].rgb = malloc(n * sizeof(float));
  both.planes[1].rgb = malloc(n * sizeof(float));
  conic_status status = both.planes[0].rgb && both.planes[1].rgb ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = conic_source_open(context, &job->base.output, 1, &opening, &source);
  if (status == CONIC_OK)
    status = draw_views(context, source, scenes, job->n_views, &both);
  job->psnr = -10.0 * log10(both.squares / ((double)n * job->n_views));
  job->greatest = both.greatest;
  conic_source_close(source);
  free(both.planes[0].rgb);
  free(both.planes[1].rgb);
  return status;
}

static int convert_scene(void *cookie) {
  convert_job *job = cookie;
  conic_context *context = job->base.session->context;
  conic_gaussians_read_options options;
  conic_gaussians_read_options_init(&options);
  options.keeps_source = 1;
  double start = cli_seconds();
  conic_status status = conic_gaussians_read(context, job->base.input, &options, &job->scene);
  start = cli_build_end_stage(&job->base.stages[READ], start);
  if (status == CONIC_OK && job->scene.count == 0)
    status = conic_fail(context, CONIC_ERROR_INPUT, "%s: there are no Gaussians in it", job->base.input);
  if (status == CONIC_OK)
    status = arrange(job);
  start = cli_build_end_stage(&job->base.stages[WORK], start);
  if (status == CONIC_OK)
    status = conic_gaussians_write(context, job->base.output, &job->scene, &job->write);
  start = cli_build_end_stage(&job->base.stages[WRITE], start);
  if (status == CONIC_OK && strcmp(job->base.output, "-") != 0)
    status = read_again(job);
  if (job->is_checked && job->n_views > 0)
    status = measure_pictures(job);
  cli_build_end_stage(&job->base.stages[CHECK], start);
  return cli_exit_of(status);
}

static void tell_losses(const void *cookie) {
  const convert_job *job = cookie;
  if (!job->frame && memcmp(job->frame_in, job->scene.frame, 3) != 0)
    cli_note(
        job->base.session,
        "%s: its axes are %s, as its kind has them, and were %s: cameras of %s do not fit; --frame keep turns nothing",
        job->base.output, job->scene.frame, job->frame_in, job->base.input);
  if (job->is_checked && !job->is_lossless)
    cli_note(job->base.session, "%s: not all of it is as it was: %s", job->base.output, job->losses);
  const char *sides = job->n_views == 1 ? "side" : "sides";
  if (!job->is_checked || job->n_views == 0)
    return;
  if (job->greatest > 0.0)
    cli_note(NULL, "%s: its pictures from %d %s have a PSNR of %.1f dB, and differ by up to %.3f", job->base.output,
             job->n_views, sides, job->psnr, job->greatest);
  else
    cli_note(NULL, "%s: its pictures from %d %s are the same", job->base.output, job->n_views, sides);
}

static uint64_t bytes_written(const char *path) {
  conic_disk_entry found;
  return conic_disk_look(path, &found) && found.is_file ? found.n_bytes : 0;
}

static void report_conversion(cli_json *json, const void *cookie) {
  const convert_job *job = cookie;
  const conic_gaussians *scene = &job->scene;
  int most = conic_gaussian_kind_sh_degree(job->write.kind);
  most = most < job->write.most_sh_degree ? most : job->write.most_sh_degree;
  cli_json_text(json, "kind_in", conic_gaussian_kind_name(job->kind_in));
  cli_json_text(json, "kind_out", conic_gaussian_kind_name(job->write.kind));
  cli_json_counts(json, NULL, {"gaussians", scene->count}, {"sh_degree_in", (uint64_t)scene->sh_degree},
                  {"sh_degree_out", (uint64_t)(scene->sh_degree < most ? scene->sh_degree : most)});
  cli_json_texts(json, NULL, {"frame_in", job->frame_in}, {"frame_out", scene->frame});
  cli_json_bool(json, "reordered", job->is_reordered);
  if (job->is_checked) {
    cli_json_bool(json, "lossless", job->is_lossless);
    cli_json_text(json, "lost", job->is_lossless ? NULL : job->losses);
    cli_json_figures(json, "differences", {"position", job->differences.position}, {"scale", job->differences.scale},
                     {"rotation_deg", job->differences.rotation_deg}, {"opacity", job->differences.opacity},
                     {"color", job->differences.color}, {"harmonics", job->differences.harmonics});
    if (job->n_views > 0) {
      cli_json_object(json, "pictures");
      cli_json_count(json, "views", (uint64_t)job->n_views);
      cli_json_figures(json, NULL, {"psnr", job->psnr}, {"greatest", job->greatest});
      cli_json_close(json);
    }
    cli_json_count(json, "bytes", bytes_written(job->base.output));
  }
  cli_build_report_cost(json, &job->base, "gaussians_per_s",
                        (double)scene->count / (job->base.stages[READ].seconds + job->base.stages[WRITE].seconds));
}

static void release_scenes(void *cookie) {
  convert_job *job = cookie;
  conic_gaussians_release(job->base.session->context, &job->scene);
  conic_gaussians_release(job->base.session->context, &job->written);
}

static int holds_points(const char *path) {
  static const char *const endings[] = {"las", "laz", "xyz", "pts", "csv", "pcd", "e57", "ptx", "txt"};
  for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
    if (strcasecmp(conic_file_ending(path), endings[i]) == 0)
      return 1;
  return 0;
}

static int check_paths(convert_job *job, const char *const *inputs, int n_inputs) {
  cli_session *session = job->base.session;
  if (n_inputs != 1)
    return cli_usage("convert: %s; see conic help convert", n_inputs ? "one input at a time" : "no input given");
  job->base.input = inputs[0];
  if (!job->base.output)
    return cli_usage("convert: no output given (-o OUT)");
  if (job->n_views > 0 && strcmp(job->base.output, "-") == 0)
    return cli_usage("convert: --measure looks at the output, so it is to be a file");
  if (job->to)
    job->write.kind = (conic_gaussian_kind)(job->to - 1);
  else if (!conic_gaussians_find_kind(job->base.output, &job->write.kind))
    return cli_usage(
        "convert: %s: give the output the ending .ply, .compressed.ply, .splat, .spz, .sog, .gltf or .glb, "
        "or say --to KIND; points are written by conic cut, as .ply or .las",
        job->base.output);
  job->write.sh_bits[0] = job->write.sh_bits[1] = job->sh_bits;
  if (holds_points(inputs[0]))
    return cli_error(
        CLI_INPUT,
        "%s: convert is of Gaussian scenes; conic prepare %s -o OUT.ply writes points as splats, with normals "
        "and sizes",
        inputs[0], inputs[0]);
  int exit_code = cli_check_outputs(session, &job->base.output, 1);
  return exit_code == CLI_DONE ? cli_check_inputs_stay(session, inputs, 1, &job->base.output, 1) : exit_code;
}

static int run_convert(cli_session *session, int argc, char **argv) {
  static const cli_build_steps steps = {convert_scene, tell_losses, report_conversion, release_scenes};
  convert_job job = {.base = {session, .stages = {{"read"}, {"work"}, {"write"}, {"check"}}}, .sh_bits = 8};
  const char *positional[argc];
  int n_positional;
  conic_gaussians_write_options_init(&job.write);
  const cli_option options[] = {
      {"o", CLI_TEXT, &job.base.output, "OUT", "the file to write: .ply .compressed.ply .splat .spz .sog .gltf .glb"},
      {"to", CLI_CHOICE, &job.to, "KIND", "the format, where the name does not say it [as the name says]",
       .choices = kind_names},
      {"sh-degree", CLI_INT, &job.write.most_sh_degree, "N", "keep harmonics up to this degree [4]", 0, 4},
      {"frame", CLI_TEXT, &job.frame, "XYZ",
       "where x, y, z shall point, as rdf: right, down, forward; or keep [the format's habit]"},
      {"from-frame", CLI_TEXT, &job.from_frame, "XYZ", "where they point in the input [the format's habit]"},
      {"keep-order", CLI_FLAG, &job.keeps_order, NULL,
       "keep the order of the Gaussians; else neighbours are brought together, which packs better",
       .acts.with = "to=compressed-ply|to=sog|o=.compressed.ply|o=.sog"},
      {"sh-bits", CLI_INT, &job.sh_bits, "N", "of .spz: bits of each number of the harmonics, 1 to 8 [8]", 1, 8,
       .acts.with = "to=spz|o=.spz"},
      {"measure", CLI_INT, &job.n_views, "N", "draw both scenes from N sides, and say how pictures differ", 1, 360},
      {"spz-version", CLI_INT, &job.write.spz_version, "V", "of .spz: 3 for readers of before 2026 [4]", 3, 4,
       .acts.with = "to=spz|o=.spz"},
      CLI_OUTSIDE(session),
  };
  int exit_code = cli_parse(session, options, sizeof options / sizeof *options, argc, argv, positional, &n_positional);
  if (exit_code == CLI_DONE)
    exit_code = check_paths(&job, positional, n_positional);
  return cli_build_run(&job, &steps, exit_code);
}

const cli_command cli_convert = {
    .name = "convert",
    .summary = "writes a Gaussian scene in another format, and says what is lost",
    .usage = "conic convert SCENE -o SCENE [--sh-degree N] [--frame XYZ]",
    .run = run_convert,
    .description = "Reads and writes scenes of 3D Gaussian splatting, and reports what the other format cannot hold.",
    .examples = {{"make a trained scene small, and see what that costs",
                  "conic convert point_cloud.ply -o scene.spz --measure 4"}},
};
