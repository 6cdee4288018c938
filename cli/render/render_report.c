#include "cli/scene/background_options.h"

#include "cli/color_options.h"
#include "cli/render/frames.h"
#include "cli/render/kept_frames.h"
#include "cli/render/shot_record.h"
#include "cli/render/units.h"
#include "cli/scene/light_options.h"
#include "cli/scene/views.h"
#include "cli/source_facts.h"
#include "cli/tell.h"

enum { N_STAGES = 8, N_FRAME_STAGES = 6 };

/* What all of the run consists of. */
static void list_stages(const cli_render_job *job, cli_stage stages[N_STAGES]) {
  const conic_source_scale *scale = conic_source_measure(job->source);
  const cli_stage list[N_STAGES] = {{"start", job->begun_seconds - job->start_seconds},
                                    {"read", scale->read_seconds},
                                    {"estimate", scale->estimate_seconds},
                                    {"camera", 1e-3 * job->camera_ms},
                                    {"draw", 1e-3 * job->frames_ms},
                                    {"light", 1e-3 * job->light_ms},
                                    {"write", 1e-3 * job->write_ms},
                                    {"hashing", 1e-3 * job->hash_ms}};
  memcpy(stages, list, sizeof list);
}

/* What a frame consists of. */
static void list_frame_stages(const conic_render_milliseconds *ms, cli_stage stages[N_FRAME_STAGES]) {
  const cli_stage list[N_FRAME_STAGES] = {
      {"choose", 1e-3 * ms->lod, "lod"},     {"set up", 1e-3 * ms->setup, "setup"}, {"bin", 1e-3 * ms->bin},
      {"visibility", 1e-3 * ms->visibility}, {"accumulate", 1e-3 * ms->accumulate}, {"resolve", 1e-3 * ms->resolve}};
  memcpy(stages, list, sizeof list);
}

/* The formulas that splats are drawn by: the methods', and laplace, which is no method. */
enum { LAPLACE = CONIC_N_METHODS, N_FORMULAS };

static const char *formula_name(int formula) {
  return formula == LAPLACE ? "laplace" : conic_method_name((conic_method)formula);
}

static uint64_t splats_by_formula(const conic_render_statistics *s, int formula) {
  if (formula == LAPLACE)
    return s->splats_by_laplace;
  return s->splats_by_method[formula] - (formula == CONIC_METHOD_RAY ? s->splats_by_laplace : 0);
}

/* "1 by conic, 2 by ray", as far as there are any. */
static void list_formulas(const conic_render_statistics *s, char *text, size_t size) {
  size_t n = 0;
  text[0] = '\0';
  for (int i = 0; i < N_FORMULAS; i++)
    if (splats_by_formula(s, i) && n < size)
      n += (size_t)snprintf(text + n, size - n, "%s%llu by %s", n ? ", " : "",
                            (unsigned long long)splats_by_formula(s, i), formula_name(i));
}

void cli_render_tell(cli_session *session, const cli_render_job *job) {
  const conic_render_statistics *s = &job->statistics;
  cli_stage stages[N_STAGES], of_frame[N_FRAME_STAGES];
  char formulas[240];
  conic_context *context = session->context;
  list_stages(job, stages);
  list_frame_stages(&s->ms, of_frame);
  int has_choice = s->ms.lod > 0.0;
  if (s->triangles_in)
    conic_log(context, CONIC_LOG_INFO, "%llu triangles: %llu drawn, %llu culled, %llu skipped",
              (unsigned long long)s->triangles_in, (unsigned long long)s->triangles_drawn,
              (unsigned long long)s->triangles_culled, (unsigned long long)s->triangles_skipped);
  list_formulas(s, formulas, sizeof formulas);
  conic_log(context, CONIC_LOG_INFO, "%llu splats: %llu drawn%s%s%s, %llu culled, %llu skipped; %llu pixels covered",
            (unsigned long long)s->splats_in, (unsigned long long)s->splats_drawn, formulas[0] ? " (" : "", formulas,
            formulas[0] ? ")" : "", (unsigned long long)s->splats_culled, (unsigned long long)s->splats_skipped,
            (unsigned long long)s->pixels_covered);
  cli_tell_stages(session, of_frame + !has_choice, N_FRAME_STAGES - !has_choice,
                  cli_frames_count(job) * job->repeat > 1 ? "a frame" : "for the frame", 1e-3 * s->ms.frame);
  cli_tell_run(session, stages, job->hash_ms > 0.0 && session->json_path ? N_STAGES : N_STAGES - 1,
               1e-3 * job->total_ms);
}

static double per_second_in_millions(double count, double ms) {
  return ms > 0.0 ? count / ms * 1e-3 : 0.0;
}

static conic_status report_source(cli_json *json, const cli_render_job *job) {
  conic_facts *facts;
  conic_status status = conic_source_describe(job->source, &job->statistics, &facts);
  if (status != CONIC_OK)
    return status;
  cli_facts_report(json, facts, 0);
  conic_facts_destroy(facts);
  return CONIC_OK;
}

static conic_status report_counts(cli_json *json, const cli_render_job *job) {
  const conic_render_statistics *s = &job->statistics;
  double overdraw = s->pixels_covered ? (double)s->fragments / (double)s->pixels_covered : 0.0;
  cli_json_counts(json, NULL, {"splats_in", s->splats_in}, {"splats_culled", s->splats_culled},
                  {"splats_skipped", s->splats_skipped}, {"splats_drawn", s->splats_drawn},
                  {"splats_fallback", s->splats_fallback}, {"fragments", s->fragments},
                  {"pixels_covered", s->pixels_covered});
  if (s->triangles_in) {
    cli_json_counts(json, NULL, {"triangles_in", s->triangles_in}, {"triangles_culled", s->triangles_culled},
                    {"triangles_skipped", s->triangles_skipped}, {"triangles_drawn", s->triangles_drawn},
                    {"triangle_fragments", s->triangle_fragments});
  }
  cli_json_number(json, "overdraw", overdraw);
  cli_json_text(json, "method", cli_method_name(job));
  cli_json_object(json, "methods");
  for (int i = 0; i < N_FORMULAS; i++)
    if (splats_by_formula(s, i))
      cli_json_count(json, formula_name(i), splats_by_formula(s, i));
  cli_json_close(json);
  if (job->shot.view.error_px > 0.0)
    cli_json_number(json, "error_px_asked", job->shot.view.error_px);
  if (job->shot.planes >> CONIC_PLANE_BOUND & 1)
    cli_json_number(json, "bound", job->bound);
  return report_source(json, job);
}

/* As a camera's file has it, so that this can be one. */
static void report_camera(cli_json *json, const cli_render_job *job) {
  if (!job->camera_path) {
    const conic_source_scale *scale = conic_source_measure(job->source);
    cli_json_array(json, "up");
    for (int i = 0; i < 3; i++)
      cli_json_number(json, NULL, job->is_up_given ? job->framing.up[i] : scale->up[i]);
    cli_json_close(json);
    cli_json_text(json, "up_basis", job->is_up_given ? "given" : conic_up_basis_name(scale->up_basis));
  }
  cli_json_object(json, "camera");
  cli_camera_write(json, &job->last_camera);
  cli_json_close(json);
  if (!job->cameras.count)
    return;
  cli_json_object(json, "view");
  cli_json_count(json, "index", job->i_view);
  if (*job->cameras.names[job->i_view])
    cli_json_text(json, "name", job->cameras.names[job->i_view]);
  cli_json_close(json);
}

static void report_top(cli_json *json, const cli_top_job *top) {
  cli_json_object(json, "top");
  cli_json_number(json, "gsd", top->gsd);
  cli_json_counts(json, NULL, {"width", (uint64_t)top->width}, {"height", (uint64_t)top->height});
  cli_json_array(json, "corner");
  cli_json_number(json, NULL, (double)top->column * top->gsd);
  cli_json_number(json, NULL, -(double)top->row * top->gsd);
  cli_json_close(json);
  if (top->found_epsg)
    cli_json_count(json, "epsg", top->found_epsg);
  cli_json_count(json, "blocks", top->n_blocks);
  cli_json_close(json);
}

static void report_settings(cli_json *json, const cli_render_job *job) {
  const conic_render_statistics *s = &job->statistics;
  cli_json_texts(json, NULL, {"device", job->device.used}, {"isa", s->isa});
  cli_json_counts(json, NULL, {"threads", (uint64_t)s->threads}, {"tile", (uint64_t)s->tile},
                  {"samples", (uint64_t)job->shot.view.samples});
  cli_accumulate_report(json, job);
  cli_json_number(json, "exposure", job->shot.render.exposure);
  cli_json_text(json, "tone", conic_tone_name((conic_tone)job->tone));
  cli_json_text(json, "epsilon_mode", s->epsilon_is_fixed ? "fixed" : "auto");
  cli_json_figures(json, NULL, {"epsilon", s->epsilon}, {"near", s->near_z});
  report_camera(json, job);
  if (job->top.is_wanted)
    report_top(json, &job->top);
  cli_lights_report(json, job);
  cli_backdrop_report(json, job);
  cli_json_count(json, "frames", (uint64_t)cli_frames_count(job));
  cli_color_report(json, conic_source_coloring(job->source));
}

static void report_stages(cli_json *json, const cli_stage *stages, int n) {
  for (int i = 0; i < n; i++)
    cli_json_number(json, stages[i].key ? stages[i].key : stages[i].name, 1e3 * stages[i].seconds);
}

static void report_times(cli_json *json, const cli_render_job *job) {
  const conic_render_statistics *s = &job->statistics;
  cli_stage stages[N_STAGES], of_frame[N_FRAME_STAGES];
  list_stages(job, stages);
  list_frame_stages(&s->ms, of_frame);
  cli_json_object(json, "ms");
  report_stages(json, stages, N_STAGES);
  cli_json_number(json, "other", 1e3 * cli_other_seconds(stages, N_STAGES, 1e-3 * job->total_ms));
  report_stages(json, of_frame, N_FRAME_STAGES);
  cli_json_figures(json, NULL, {"frame_other", 1e3 * cli_other_seconds(of_frame, N_FRAME_STAGES, 1e-3 * s->ms.frame)},
                   {"frame", s->ms.frame}, {"total", job->total_ms});
  cli_json_close(json);
  cli_json_number(json, "ms_first", job->first_frame_ms);
  cli_json_number(json, "msplats_per_s", per_second_in_millions((double)s->splats_in, s->ms.frame));
  cli_json_number(json, "drawn_msplats_per_s", per_second_in_millions((double)s->splats_drawn, s->ms.frame));
  if (s->triangles_in)
    cli_json_number(json, "mtriangles_per_s", per_second_in_millions((double)s->triangles_in, s->ms.frame));
  cli_json_number(json, "mfragments_per_s", per_second_in_millions((double)s->fragments, s->ms.frame));
  cli_json_count(json, "peak_rss_bytes", cli_peak_rss_bytes());
}

static void report_hashes(cli_json *json, const cli_render_job *job, const conic_image *image) {
  cli_json_object(json, "hash");
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (image->planes[i] || job->banded_planes >> i & 1)
      cli_json_hash(json, conic_plane_describe((conic_plane)i)->name, job->hashes[i]);
  cli_json_close(json);
}

int cli_render_report(cli_session *session, cli_render_job *job, const conic_image *image) {
  cli_json *json;
  int exit_code = cli_json_open(session, &json);
  if (!json)
    return exit_code;
  conic_status status = report_counts(json, job);
  report_settings(json, job);
  if (status == CONIC_OK)
    status = cli_shot_report(session, json, job);
  report_hashes(json, job, image);
  if (job->kept)
    cli_json_count(json, "frames_finished", (uint64_t)cli_kept_frames_count(job));
  cli_units_report(json, job);
  report_times(json, job);
  exit_code = cli_json_finish(json);
  return status == CONIC_OK ? exit_code : cli_exit_of(status);
}
