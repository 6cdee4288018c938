/* conic explain: tells why a pixel is as it is, and where a splat is on the screen. */

#include "cli/command.h"
#include "cli/commands/gaussian_commands.h"
#include "cli/outputs.h"
#include "cli/render/sample_options.h"
#include "core/files/file.h"

typedef struct explain_job {
  cli_render_job scene;
  int pixel[2], is_pixel_given;
  unsigned long long splat;
  int is_splat_given;
  const char *dump_path; /* --dump-projection; null: none */

  conic_camera camera;
  const conic_drawing *drawing;
  conic_contributions *contributions;
  conic_image image; /* all planes, if a pixel is asked about */
} explain_job;

/* X,Y */
static int parse_pixel(const char *text, void *value) {
  int *pixel = value;
  for (int i = 0; i < 2; i++) {
    char *end;
    long n = strtol(text, &end, 10);
    if (end == text || n < 0 || n > 65534 || *end != (i ? '\0' : ','))
      return 0;
    pixel[i] = (int)n;
    text = end + 1;
  }
  return 1;
}

static void write_vector(cli_json *json, const char *key, const float vector[3]) {
  double wide[3] = {(double)vector[0], (double)vector[1], (double)vector[2]};
  cli_json_numbers(json, key, wide, 3);
}

/* A splat's number in the drawing; and the point, node or cluster that it was chosen for. */
static void write_splat_name(cli_json *json, const explain_job *job, uint32_t splat) {
  uint32_t number;
  const char *name = conic_source_name_splat(job->scene.source, splat, &number);
  cli_json_count(json, "splat", splat);
  if (name)
    cli_json_count(json, name, number);
}

static void write_triangle_name(cli_json *json, const explain_job *job, uint32_t triangle) {
  cli_json_count(json, "triangle", triangle);
  if (job->drawing->triangles->cluster)
    cli_json_count(json, "cluster", job->drawing->triangles->cluster[triangle]);
}

/* A splat on the screen, for any pixel. */
static void write_projection(cli_json *json, const explain_job *job, const conic_projection *p) {
  write_splat_name(json, job, p->splat);
  cli_json_text(json, "fate", conic_fate_name(p->fate));
  if (p->fate > CONIC_FATE_RAY)
    return;
  const double box[4] = {p->x_begin, p->y_begin, p->x_end, p->y_end};
  cli_json_numbers(json, "box", box, 4);
  if (p->fate == CONIC_FATE_VARIANCE) {
    cli_json_numbers(json, "center", p->center_px, 2);
    cli_json_numbers(json, "variance", p->variance_px, 3);
    cli_json_numbers(json, "conic", p->conic, 3);
  }
  cli_json_figures(json, NULL, {"amplitude", p->amplitude}, {"nearest_z", p->nearest_z}, {"farthest_z", p->farthest_z},
                   {"nearness", p->nearness});
  write_vector(json, "color", p->color);
  write_vector(json, "normal", p->normal);
}

/* What reaches the pixel. */
typedef struct at_pixel {
  const conic_contribution *list;
  const conic_triangle_contribution *triangles;
  size_t n, n_triangles;
  double visible_weight;
  float threshold;
  size_t counts[CONIC_N_CONTRIBUTION_VERDICTS];
} at_pixel;

static conic_status write_contribution(cli_json *json, const explain_job *job, const conic_contribution *c,
                                       double visible_weight) {
  conic_projection projection;
  conic_status status = conic_contributions_project(job->contributions, c->splat, &projection);
  if (status != CONIC_OK)
    return status;
  cli_json_object(json, NULL);
  cli_json_text(json, "verdict", conic_contribution_verdict_name(c->verdict));
  if (c->verdict <= CONIC_CONTRIBUTION_HIDDEN) {
    cli_json_number(json, "weight", (double)c->weight);
    if (c->verdict == CONIC_CONTRIBUTION_VISIBLE)
      cli_json_number(json, "share", (double)c->weight / visible_weight);
    cli_json_figures(json, NULL, {"depth", (double)c->depth}, {"q", (double)c->q},
                     {"inverse_depth", (double)c->inverse_depth},
                     {"plane_inverse_depth", (double)c->plane_inverse_depth}, {"hides", (double)c->hides});
  }
  write_projection(json, job, &projection);
  cli_json_close(json);
  return CONIC_OK;
}

/* Writes what is blended, in the order of the sums: splats in their order, and the triangle last. */
static void write_blended(cli_json *json, const explain_job *job, const at_pixel *at) {
  cli_json_array(json, "blended");
  for (size_t i = 0; i < at->n; i++)
    if (at->list[i].verdict == CONIC_CONTRIBUTION_VISIBLE) {
      cli_json_object(json, NULL);
      write_splat_name(json, job, at->list[i].splat);
      cli_json_figures(json, NULL, {"weight", (double)at->list[i].weight},
                       {"share", (double)at->list[i].weight / at->visible_weight},
                       {"depth", (double)at->list[i].depth});
      cli_json_close(json);
    }
  for (size_t i = 0; i < at->n_triangles; i++)
    if (at->triangles[i].verdict == CONIC_CONTRIBUTION_VISIBLE) {
      cli_json_object(json, NULL);
      write_triangle_name(json, job, at->triangles[i].triangle);
      cli_json_figures(json, NULL, {"weight", 1.0}, {"share", 1.0 / at->visible_weight},
                       {"depth", (double)at->triangles[i].depth});
      cli_json_close(json);
    }
  cli_json_close(json);
}

static void write_triangles(cli_json *json, const explain_job *job, const conic_triangle_contribution *list, size_t n,
                            double visible_weight) {
  cli_json_array(json, "triangles");
  for (size_t i = 0; i < n; i++) {
    cli_json_object(json, NULL);
    cli_json_text(json, "verdict", conic_contribution_verdict_name(list[i].verdict));
    cli_json_number(json, "weight", 1.0);
    if (list[i].verdict == CONIC_CONTRIBUTION_VISIBLE)
      cli_json_number(json, "share", 1.0 / visible_weight);
    cli_json_figures(json, NULL, {"depth", (double)list[i].depth}, {"inverse_depth", (double)list[i].inverse_depth},
                     {"hides", (double)list[i].hides});
    write_triangle_name(json, job, list[i].triangle);
    write_vector(json, "color", list[i].color);
    write_vector(json, "normal", list[i].normal);
    cli_json_close(json);
  }
  cli_json_close(json);
}

static conic_status look_at_pixel(const explain_job *job, at_pixel *at) {
  const int x = job->pixel[0], y = job->pixel[1];
  float weight = 0.0f;
  memset(at, 0, sizeof *at);
  conic_status status = conic_contributions_at(job->contributions, x, y, &at->list, &at->n);
  if (status == CONIC_OK)
    status = conic_contributions_triangles_at(job->contributions, x, y, &at->triangles, &at->n_triangles);
  if (status != CONIC_OK)
    return status;
  for (size_t i = 0; i < at->n; i++) {
    at->counts[at->list[i].verdict]++;
    weight += at->list[i].verdict == CONIC_CONTRIBUTION_VISIBLE ? at->list[i].weight : 0.0f;
    at->threshold = at->threshold < at->list[i].hides ? at->list[i].hides : at->threshold;
  }
  for (size_t i = 0; i < at->n_triangles; i++) {
    weight += at->triangles[i].verdict == CONIC_CONTRIBUTION_VISIBLE ? 1.0f : 0.0f;
    at->threshold = at->threshold < at->triangles[i].hides ? at->triangles[i].hides : at->threshold;
  }
  at->visible_weight = (double)weight;
  return CONIC_OK;
}

static conic_status write_pixel(cli_json *json, const explain_job *job) {
  at_pixel at;
  const double pixel[2] = {job->pixel[0], job->pixel[1]};
  conic_status status = look_at_pixel(job, &at);
  if (status != CONIC_OK)
    return status;
  cli_json_numbers(json, "pixel", pixel, 2);
  cli_explain_planes(json, &job->image, job->pixel[0], job->pixel[1]);
  cli_json_number(json, "threshold", (double)at.threshold);
  cli_json_object(json, "counts");
  for (int i = 0; i < CONIC_N_CONTRIBUTION_VERDICTS; i++)
    cli_json_count(json, conic_contribution_verdict_name((conic_contribution_verdict)i), at.counts[i]);
  cli_json_close(json);
  if (job->drawing->triangles->count)
    write_blended(json, job, &at);
  cli_json_array(json, "contributions");
  for (size_t i = 0; i < at.n && status == CONIC_OK; i++)
    status = write_contribution(json, job, &at.list[i], at.visible_weight);
  cli_json_close(json);
  if (job->drawing->triangles->count)
    write_triangles(json, job, at.triangles, at.n_triangles, at.visible_weight);
  return status;
}

static conic_status write_splat(cli_json *json, const explain_job *job) {
  conic_projection projection;
  conic_status status = conic_contributions_project(job->contributions, (size_t)job->splat, &projection);
  if (status != CONIC_OK)
    return status;
  cli_json_object(json, "projection");
  write_projection(json, job, &projection);
  cli_json_close(json);
  return CONIC_OK;
}

static int write_report(cli_session *session, const explain_job *job) {
  cli_json *json;
  conic_status status = CONIC_OK;
  int exit_code = cli_json_open(session, &json);
  if (!json)
    return exit_code;
  cli_json_text(json, "method", cli_method_name(&job->scene));
  if (job->scene.accumulating.is_sample_given)
    cli_json_count(json, "sample", job->scene.accumulating.i_sample);
  cli_json_counts(json, NULL, {"width", (uint64_t)job->camera.width}, {"height", (uint64_t)job->camera.height});
  if (job->is_splat_given)
    status = write_splat(json, job);
  if (job->is_pixel_given && status == CONIC_OK)
    status = write_pixel(json, job);
  exit_code = cli_json_finish(json);
  return status == CONIC_OK ? exit_code : cli_exit_of(status);
}

static void write_row(FILE *to, const conic_projection *p) {
  fprintf(to, "%lu,%s", (unsigned long)p->splat, conic_fate_name(p->fate));
  if (p->fate > CONIC_FATE_RAY) {
    fputs(",,,,,,,,,,,,,,,,\n", to);
    return;
  }
  fprintf(to, ",%d,%d,%d,%d", p->x_begin, p->y_begin, p->x_end, p->y_end);
  if (p->fate == CONIC_FATE_VARIANCE) {
    fprintf(to, ",%.17g,%.17g,%.17g,%.17g,%.17g", p->center_px[0], p->center_px[1], p->variance_px[0],
            p->variance_px[1], p->variance_px[2]);
    fprintf(to, ",%.17g,%.17g,%.17g", p->conic[0], p->conic[1], p->conic[2]);
  } else
    fputs(",,,,,,,,", to);
  fprintf(to, ",%.17g,%.17g,%.17g,%.17g\n", p->amplitude, p->nearest_z, p->farthest_z, p->nearness);
}

/* Writes a line for each splat, below the names of the columns. */
static conic_status dump_projection(cli_session *session, const explain_job *job, size_t n_splats) {
  conic_output *output;
  if (!job->dump_path)
    return CONIC_OK;
  conic_status status = conic_output_open(session->context, job->dump_path, &output);
  if (status != CONIC_OK)
    return status;
  FILE *to = conic_output_stream(output);
  fputs("splat,fate,x_begin,y_begin,x_end,y_end,center_x,center_y,variance_xx,variance_xy,variance_yy,conic_a,conic_b,"
        "conic_c,amplitude,nearest_z,farthest_z,nearness\n",
        to);
  for (size_t i = 0; i < n_splats && status == CONIC_OK; i++) {
    conic_projection projection;
    if (i % 4096 == 0)
      status = conic_progress(session->context, "dump", (double)i / (double)n_splats);
    if (status == CONIC_OK)
      status = conic_contributions_project(job->contributions, i, &projection);
    if (status == CONIC_OK)
      write_row(to, &projection);
  }
  if (status == CONIC_OK)
    status = conic_progress(session->context, "dump", 1.0);
  return conic_output_end(output, status);
}

static conic_status draw(cli_session *session, explain_job *job) {
  unsigned planes =
      CONIC_DRAWN_PLANES | (job->scene.abilities & CONIC_SOURCE_CLUSTERS ? 1u << CONIC_PLANE_CLUSTER : 0u);
  if (!job->is_pixel_given)
    return CONIC_OK;
  conic_status status =
      conic_image_allocate(session->context, job->camera.width, job->camera.height, planes, &job->image);
  if (status == CONIC_OK)
    status = conic_render_drawing(session->context, job->scene.renderer, job->drawing, &job->camera,
                                  &job->scene.shot.render, 1, &job->image, NULL);
  if (status == CONIC_OK)
    conic_source_name_image(job->scene.source, &job->image);
  return status;
}

/* Checks that the splat and pixel that were asked about exist, which is known only now. */
static int check_questions(const explain_job *job) {
  size_t n_splats = job->drawing->splats->count;
  if (job->is_splat_given && n_splats == 0)
    return cli_usage("explain: there is no splat %llu: triangles alone are drawn", job->splat);
  if (job->is_splat_given && job->splat >= n_splats)
    return cli_usage("explain: there is no splat %llu: the last is %zu", job->splat, n_splats - 1);
  if (job->is_pixel_given && (job->pixel[0] >= job->camera.width || job->pixel[1] >= job->camera.height))
    return cli_usage("explain: the pixel %d,%d is not in a picture of %d x %d", job->pixel[0], job->pixel[1],
                     job->camera.width, job->camera.height);
  return CLI_DONE;
}

static int answer(cli_session *session, explain_job *job) {
  conic_status status = cli_sample_camera(session, &job->scene, &job->camera);
  if (status == CONIC_OK) /* a choice is what is drawn, and what is explained */
    status = conic_source_choose(job->scene.source, &job->camera, &job->scene.shot.render, &job->scene.shot.view);
  job->drawing = &conic_source_chosen(job->scene.source)->drawing;
  int exit_code = status == CONIC_OK ? check_questions(job) : cli_exit_of(status);
  if (exit_code != CLI_DONE)
    return exit_code;
  status = conic_contributions_create_drawing(session->context, job->drawing, &job->camera, &job->scene.shot.render,
                                              &job->contributions);
  if (status == CONIC_OK)
    status = draw(session, job);
  if (status == CONIC_OK)
    status = dump_projection(session, job, job->drawing->splats->count);
  exit_code = cli_exit_of(status);
  if (exit_code == CLI_DONE && (job->is_pixel_given || job->is_splat_given))
    exit_code = write_report(session, job);
  conic_image_release(session->context, &job->image);
  conic_contributions_destroy(job->contributions);
  return exit_code;
}

static int explain(cli_session *session, void *cookie) {
  explain_job *job = cookie;
  conic_status status = cli_scene_begin(session, &job->scene);
  if (status == CONIC_OK)
    status = cli_scene_open(session, &job->scene);
  if (status == CONIC_OK && cli_is_composited(&job->scene))
    return cli_explain_composited(session, &job->scene, job->pixel[0], job->pixel[1]);
  return status == CONIC_OK ? answer(session, job) : cli_exit_of(status);
}

/* The answer goes to standard output, unless --json names a file. */
static int check(cli_session *session, explain_job *job) {
  if (!job->is_pixel_given && !job->is_splat_given && !job->dump_path)
    return cli_usage("explain: nothing is asked; give --pixel X,Y, --splat I or --dump-projection FILE");
  if (job->scene.shot.view.samples > 1)
    return cli_usage("explain: it explains pixels, not --samples");
  if (cli_is_composited(&job->scene) && (job->is_splat_given || job->dump_path))
    return cli_usage("explain: --splat and --dump-projection are of splats; give --profile surface, too");
  if (!session->json_path && (job->is_pixel_given || job->is_splat_given))
    session->json_path = "-";
  int exit_code = cli_check_outputs(session, &job->dump_path, 1);
  return exit_code == CLI_DONE ? cli_scene_inputs_stay(session, &job->scene, &job->dump_path, 1) : exit_code;
}

static int run(cli_session *session, int argc, char **argv) {
  explain_job job = {.splat = 0};
  cli_scene_defaults(&job.scene);
  const cli_option own[] = {
      {"pixel", CLI_PARSED, job.pixel, "X,Y", "every splat in reach of this pixel, from 0,0 at the upper left",
       .parse = parse_pixel, .is_given = &job.is_pixel_given},
      {"splat", CLI_COUNT, &job.splat, "I", "where splat I of the input lies on the screen", 0, 4294967294.0,
       .is_given = &job.is_splat_given},
      {"dump-projection", CLI_TEXT, &job.dump_path, "FILE", "where every splat does, as a table (CSV)"},
      CLI_SAMPLE_OPTIONS(&job.scene),
  };
  int exit_code = cli_scene_parse(session, own, (int)(sizeof own / sizeof own[0]), argc, argv, &job.scene);
  if (exit_code == CLI_DONE)
    exit_code = check(session, &job);
  if (exit_code == CLI_DONE)
    exit_code = cli_sample_check(session, &job.scene);
  return cli_scene_run(session, exit_code, &job.scene, explain, &job);
}

const cli_command cli_explain = {
    .name = "explain",
    .summary = "says why a pixel is as it is, splat by splat",
    .usage =
        "conic explain IN… --pixel X,Y [--splat I] [--dump-projection FILE] [--sample I] [camera and render options]",
    .run = run,
    .description = "Lists what a pixel is made of, from front to back: each splat's place, depth, weight and colour, "
                   "and why it counts or does not.",
    .examples = {{"ask about a pixel of the picture that conic render draws",
                  "conic explain scan.ply --size 640x480 --pixel 320,240"}},
};
