/* conic verify: how far a picture is from the oracle's reference. */

#include "cli/command.h"
#include "cli/commands/gaussian_commands.h"
#include "cli/commands/verify_reference.h"
#include "cli/outputs.h"
#include "cli/render/sample_options.h"

typedef struct verify_job {
  cli_render_job scene;
  int question;
  const char *image_path;      /* null: the picture is drawn here */
  unsigned long long n_pixels; /* 0: all */

  conic_image image;
  conic_reference reference;
  conic_oracle_verdict verdict;
  double render_ms, oracle_ms;
  cli_mean_verdict mean; /* with --accumulate; its reference and verdict are copied to those above */
} verify_job;

static conic_status get_image(cli_session *session, verify_job *job, const conic_drawing *drawing,
                              const conic_camera *camera) {
  if (job->image_path) /* the image was read before the scene */
    return CONIC_OK;
  conic_status status =
      conic_image_allocate(session->context, camera->width, camera->height, job->scene.shot.planes, &job->image);
  if (status != CONIC_OK)
    return status;
  double start = cli_seconds();
  status = conic_render_drawing(session->context, job->scene.renderer, drawing, camera, &job->scene.shot.render,
                                job->scene.shot.view.samples, &job->image, &job->scene.statistics);
  if (status == CONIC_OK && job->scene.shot.light.dome_stops > 0.0)
    status = conic_image_eye_dome(session->context, camera, job->scene.shot.light.dome_stops, &job->image);
  job->render_ms = 1e3 * (cli_seconds() - start);
  return status;
}

static conic_status compare(cli_session *session, verify_job *job) {
  const conic_source_choice *choice = conic_source_chosen(job->scene.source);
  conic_camera camera;
  conic_status status = cli_sample_camera(session, &job->scene, &camera);
  if (status == CONIC_OK) /* the oracle judges how the choice is drawn, not the choice itself */
    status = conic_source_choose(job->scene.source, &camera, &job->scene.shot.render, &job->scene.shot.view);
  if (status == CONIC_OK)
    status = get_image(session, job, &choice->drawing, &camera);
  if (status == CONIC_OK)
    status = cli_reference_check_size(job->image_path, &job->image, &camera);
  double start = cli_seconds();
  if (status == CONIC_OK)
    status = cli_reference_draw(session, &job->scene, &camera, (conic_oracle_question)job->question, CONIC_FLOATS_OWN,
                                (size_t)job->n_pixels, job->image_path != NULL, &job->reference);
  if (status == CONIC_OK && job->scene.shot.light.dome_stops > 0.0)
    status = conic_oracle_eye_dome(session->context, &camera, job->scene.shot.light.dome_stops, &job->image,
                                   &job->reference);
  job->oracle_ms = 1e3 * (cli_seconds() - start);
  if (status == CONIC_OK)
    status = conic_oracle_compare(session->context, &job->reference, &job->image, &job->verdict);
  return status;
}

static conic_status compare_mean(cli_session *session, verify_job *job) {
  conic_status status =
      cli_verify_mean(session, &job->scene, (size_t)job->n_pixels, job->image_path, &job->image, &job->mean);
  job->reference = job->mean.reference;
  job->verdict = job->mean.verdict;
  job->render_ms = job->mean.render_ms;
  job->oracle_ms = job->mean.oracle_ms;
  return status;
}

static void report_planes(cli_json *json, const verify_job *job) {
  cli_json_object(json, "planes");
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    if (!job->verdict.planes[i].is_compared)
      continue;
    cli_json_object(json, conic_plane_describe((conic_plane)i)->name);
    cli_json_figures(json, NULL, {"max_abs", job->verdict.planes[i].max_abs}, {"p999", job->verdict.planes[i].p999});
    if (i != CONIC_PLANE_ID && job->question == CONIC_ORACLE_METHOD)
      cli_json_number(json, "widest", conic_reference_width(&job->reference, (conic_plane)i));
    cli_json_close(json);
  }
  cli_json_close(json);
  cli_json_object(json, "bound");
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (job->verdict.planes[i].is_compared)
      cli_json_number(json, conic_plane_describe((conic_plane)i)->name, job->verdict.planes[i].bound);
  cli_json_close(json);
}

static void report_pixels(cli_json *json, const verify_job *job) {
  const conic_oracle_verdict *verdict = &job->verdict;
  const conic_reference *reference = &job->reference;
  cli_json_counts(json, NULL, {"judged_pixels", reference->n_pixels}, {"compared_pixels", verdict->compared_pixels},
                  {"unstable_pixels", verdict->unstable_pixels}, {"covered_pixels", verdict->covered_pixels});
  if (job->scene.shot.view.samples > 1) {
    cli_json_count(json, "unstable_samples", reference->unstable_samples);
    cli_json_count(json, "covered_samples", reference->covered_samples);
  }
  cli_json_count(json, "undecided_ids", reference->undecided_ids);
  cli_json_count(json, "unbounded_pixels", reference->unbounded_pixels);
  cli_json_number(json, "unbounded_limit", verdict->unbounded_limit);
  cli_json_object(json, "unstable_by_reason");
  for (int i = 0; i < CONIC_N_UNSTABLE_REASONS; i++)
    cli_json_count(json, conic_unstable_reason_name((conic_unstable_reason)i), reference->unstable_by_reason[i]);
  cli_json_close(json);
  cli_json_count(json, "wrong_pixels", verdict->wrong_pixels);
  if (verdict->wrong_pixels)
    cli_report_fault(json, "worst", &verdict->worst);
}

/* Reports which samples were judged, too. */
static void report_samples(cli_json *json, const verify_job *job) {
  const cli_accumulate_job *asked = &job->scene.accumulating;
  if (asked->is_sample_given)
    cli_json_count(json, "sample", asked->i_sample);
  if (!asked->n_samples)
    return;
  cli_json_object(json, "accumulated");
  cli_json_count(json, "samples", asked->n_samples);
  if (!job->image_path)
    cli_json_count(json, "wrong_pixels", job->mean.n_wrong);
  cli_json_close(json);
}

static void report_weights(cli_json *json, const conic_weight_error *error) {
  cli_json_object(json, "weight_error");
  cli_json_figures(json, NULL, {"max_abs", error->max_abs}, {"p999", error->p999}, {"max_of_peak", error->max_of_peak},
                   {"p999_of_peak", error->p999_of_peak}, {"quadrature", error->quadrature});
  cli_json_count(json, "weights", error->n_weights);
  cli_json_close(json);
}

static void write_statistics(cli_json *json, const void *cookie) {
  const verify_job *job = cookie;
  cli_json_text(json, "against", conic_oracle_question_name((conic_oracle_question)job->question));
  cli_json_text(json, "method", cli_method_name(&job->scene));
  if (job->scene.shot.view.samples > 1)
    cli_json_count(json, "samples", (uint64_t)job->scene.shot.view.samples);
  report_samples(json, job);
  report_planes(json, job);
  report_pixels(json, job);
  if (job->question == CONIC_ORACLE_EXACT)
    report_weights(json, &job->reference.weight_error);
  cli_json_figures(json, "ms", {"render", job->render_ms}, {"oracle", job->oracle_ms});
  cli_json_bool(json, "pass", job->verdict.pass);
}

static void print_unstable(const verify_job *job) {
  const conic_oracle_verdict *verdict = &job->verdict;
  const conic_reference *reference = &job->reference;
  double covered = verdict->covered_pixels ? (double)verdict->covered_pixels : 1.0;
  printf("unstable  %zu of %zu covered pixels (%.3f %%)", verdict->unstable_pixels, verdict->covered_pixels,
         100.0 * (double)verdict->unstable_pixels / covered);
  if (job->scene.shot.view.samples > 1)
    printf(", %zu of %zu samples", reference->unstable_samples, reference->covered_samples);
  const char *separator = ": ";
  for (int i = 0; i < CONIC_N_UNSTABLE_REASONS; i++)
    if (reference->unstable_by_reason[i]) {
      printf("%s%s %zu", separator, conic_unstable_reason_name((conic_unstable_reason)i),
             reference->unstable_by_reason[i]);
      separator = ", ";
    }
  putchar('\n');
  if (reference->unbounded_pixels)
    printf("unbounded %zu of %zu judged pixels; at most %g %% may be\n", reference->unbounded_pixels,
           reference->n_pixels, 100.0 * verdict->unbounded_limit);
}

static void print_samples(const verify_job *job) {
  unsigned long long n = job->scene.accumulating.n_samples;
  if (!n || job->image_path)
    return;
  printf("samples   %llu, %zu pixels of them wrong", n, job->mean.n_wrong);
  if (job->mean.n_wrong)
    printf(", the first in sample %llu, such as pixel %d,%d", job->mean.i_worst, job->mean.worst.x, job->mean.worst.y);
  putchar('\n');
}

static void print_pixels(const verify_job *job) {
  const conic_oracle_verdict *verdict = &job->verdict;
  const conic_reference *reference = &job->reference;
  size_t n_pixels = (size_t)reference->width * (size_t)reference->height;
  printf("judged    %zu of %zu pixels, %zu wrong\n", reference->n_pixels, n_pixels, verdict->wrong_pixels);
  print_unstable(job);
  if (!verdict->wrong_pixels || job->question == CONIC_ORACLE_EXACT)
    return;
  const conic_oracle_fault *worst = &verdict->worst;
  printf("worst     pixel %d,%d: %s[%d] is %.9g; it may be %.9g", worst->x, worst->y,
         conic_plane_describe((conic_plane)worst->plane)->name, worst->channel, worst->found, worst->low);
  if (worst->high > worst->low)
    printf(" to %.9g", worst->high);
  putchar('\n');
}

static void print_result(const verify_job *job) {
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    const conic_oracle_plane_verdict *plane = &job->verdict.planes[i];
    if (!plane->is_compared)
      continue;
    printf("%-9s max %-11.4g p99.9 %-11.4g", conic_plane_describe((conic_plane)i)->name, plane->max_abs, plane->p999);
    if (plane->bound == plane->bound) {
      double width = conic_reference_width(&job->reference, (conic_plane)i);
      if (width > 0.0)
        printf("doubt %-9.3g ", width);
      printf("bound %-8.4g%s", plane->bound, plane->max_abs <= plane->bound ? "" : "  FAILED");
    }
    putchar('\n');
  }
  print_pixels(job);
  print_samples(job);
  if (job->question == CONIC_ORACLE_EXACT) {
    const conic_weight_error *error = &job->reference.weight_error;
    printf("weights   max %-12.4g p99.9 %-12.4g of the peak: max %.4g, p99.9 %.4g (%zu weights, integrals to %.1g)\n",
           error->max_abs, error->p999, error->max_of_peak, error->p999_of_peak, error->n_weights, error->quadrature);
  }
  puts(job->verdict.pass ? "pass" : "FAILED");
}

static int finish(cli_session *session, const verify_job *job) {
  int exit_code = cli_json_write(session, write_statistics, job);
  if (exit_code != CLI_DONE)
    return exit_code;
  if (cli_json_leaves_text(session))
    print_result(job);
  return job->verdict.pass ? CLI_DONE : CLI_DIFFERENT;
}

static int verify(cli_session *session, void *cookie) {
  verify_job *job = cookie;
  int exit_code;
  conic_status status = cli_scene_begin(session, &job->scene);
  if (status == CONIC_OK && job->image_path)
    status = conic_image_read(session->context, job->image_path, &job->image);
  if (status == CONIC_OK)
    status = cli_scene_open(session, &job->scene);
  if (status == CONIC_OK && cli_is_composited(&job->scene))
    exit_code = cli_verify_composited(session, &job->scene, (size_t)job->n_pixels, job->image_path, &job->image);
  else {
    if (status == CONIC_OK)
      status = job->scene.accumulating.n_samples ? compare_mean(session, job) : compare(session, job);
    exit_code = status == CONIC_OK ? finish(session, job) : cli_exit_of(status);
  }
  conic_reference_release(session->context, &job->reference);
  conic_image_release(session->context, &job->image);
  return exit_code;
}

/* Checks that the final picture can be judged. */
static int check_samples(const cli_session *session, verify_job *job) {
  int answer = cli_sample_check(session, &job->scene);
  if (answer != CLI_DONE || !job->scene.accumulating.n_samples)
    return answer;
  const unsigned of_gaussians = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_TRANSPARENCY;
  if (cli_is_composited(&job->scene)) {
    if (job->scene.is_aov_given && job->scene.shot.planes & ~of_gaussians)
      return cli_usage(
          "verify: of means of a Gaussian scene, it judges rgba and T; --sample I judges all planes of one");
    job->scene.shot.planes &= of_gaussians;
    return CLI_DONE;
  }
  if (job->question == CONIC_ORACLE_EXACT)
    return cli_usage("verify: --accumulate judges means of splats and triangles by their method; give --sample I");
  if (job->scene.shot.light.dome_stops > 0.0)
    return cli_usage("verify: of --shade edl, it judges samples one by one: --sample I");
  const unsigned normals = 1u << CONIC_PLANE_NORMAL; /* the picture has the direction of the sum of normals */
  if (job->scene.is_aov_given && job->scene.shot.planes & normals)
    return cli_usage("verify: of N, a mean of samples is not judged; --sample I judges that of a sample");
  job->scene.shot.planes &= ~normals;
  return CLI_DONE;
}

/* Checks which planes can be judged. */
static int check_judged_planes(verify_job *job) {
  int is_composited = cli_is_composited(&job->scene);
  if (is_composited && !job->scene.is_aov_given)
    job->scene.shot.planes = CLI_COMPOSITED_PLANES;
  if (is_composited && job->scene.shot.planes & ~CLI_COMPOSITED_PLANES)
    return cli_usage("verify: of a Gaussian scene, it judges rgba, Z, N, count, id, T, medianZ, inverseZ and last");
  if (job->scene.is_transparent && !(job->scene.abilities & CONIC_SOURCE_MIXES))
    return cli_usage("verify: --transparency is of surfaces among Gaussians; those alone are judged as opaque");
  if (is_composited && job->question == CONIC_ORACLE_EXACT)
    return cli_usage("verify: a Gaussian scene is judged by its profile, and --against exact is of splats");
  if (!is_composited && job->scene.shot.planes & ~CONIC_DRAWN_PLANES)
    return cli_usage("verify: the planes cluster and P are made of id and Z; the oracle knows what is drawn");
  return CLI_DONE;
}

static int run(cli_session *session, int argc, char **argv) {
  static const char *const questions[] = {"method", "exact", NULL};
  verify_job job = {.question = CONIC_ORACLE_METHOD};
  cli_scene_defaults(&job.scene);
  job.scene.shot.planes = CONIC_DRAWN_PLANES;
  const cli_option own[] = {
      {"against", CLI_CHOICE, &job.question, "WHAT",
       "method: its own formula in double precision; exact: the kernel itself, projected and filtered [method]",
       .choices = questions},
      {"image", CLI_TEXT, &job.image_path, "FILE", "the picture to verify, of whatever renderer [drawn anew]"},
      {"pixels", CLI_COUNT, &job.n_pixels, "N", "judge this many pixels, spread evenly; always the same ones [all]",
       .minimum = 1, .maximum = 4294836225.0},
      CLI_SAMPLE_OPTIONS(&job.scene),
      {"accumulate", CLI_COUNT, &job.scene.accumulating.n_samples, "N",
       "as conic render has it: judge the mean of N samples, and where they are drawn anew, each of them, too",
       .minimum = 1, .maximum = 65536},
      {"transparency", CLI_FLAG, &job.scene.is_transparent, NULL,
       "as conic render has it: surfaces among Gaussians let light through, each sample by chance",
       .acts = {.on = CLI_FACT(ALPHA), .is_warned = 1}},
  };
  int exit_code = cli_scene_parse(session, own, (int)(sizeof own / sizeof own[0]), argc, argv, &job.scene);
  cli_transparency_settle(&job.scene);
  if (exit_code == CLI_DONE)
    exit_code = check_judged_planes(&job);
  if (exit_code == CLI_DONE)
    exit_code = check_samples(session, &job);
  if (exit_code == CLI_DONE)
    exit_code = cli_check_outputs(session, NULL, 0);
  if (exit_code == CLI_DONE)
    exit_code = cli_scene_inputs_stay(session, &job.scene, &job.image_path, 0);
  return cli_scene_run(session, exit_code, &job.scene, verify, &job);
}

const cli_command cli_verify = {
    .name = "verify",
    .summary = "measures pictures against a slow, exact reference",
    .usage = "conic verify IN… [--against method|exact] [--image FILE] [--pixels N] [--sample I | --accumulate N] "
             "[camera and render options]",
    .run = run,
    .description = "Draws a scene, or takes a picture of it, and computes the same pixels in double precision, slowly "
                   "and by other code. It ends with 1 where they differ by more than rounding explains.",
    .examples = {{"is this picture right?", "conic verify scene.ply --size 640x480"},
                 {"is this final picture the mean of its 64 samples?",
                  "conic verify scene.ply --accumulate 64 --aperture 0.1 --image final.exr"},
                 {"how far is the method from the truth?", "conic verify scene.ply --method affine --against exact"}},
};
