#include "cli/color_options.h"
#include "cli/render/render_job.h"
#include "cli/source_facts.h"

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
  cli_json_count(json, "splats_in", s->splats_in);
  cli_json_count(json, "splats_culled", s->splats_culled);
  cli_json_count(json, "splats_skipped", s->splats_skipped);
  cli_json_count(json, "splats_drawn", s->splats_drawn);
  cli_json_count(json, "splats_fallback", s->splats_fallback);
  cli_json_count(json, "fragments", s->fragments);
  cli_json_count(json, "pixels_covered", s->pixels_covered);
  if (s->triangles_in) {
    cli_json_count(json, "triangles_in", s->triangles_in);
    cli_json_count(json, "triangles_culled", s->triangles_culled);
    cli_json_count(json, "triangles_skipped", s->triangles_skipped);
    cli_json_count(json, "triangles_drawn", s->triangles_drawn);
    cli_json_count(json, "triangle_fragments", s->triangle_fragments);
  }
  cli_json_number(json, "overdraw", overdraw);
  cli_json_text(json, "method", cli_method_name(job));
  cli_json_object(json, "methods");
  for (int i = 0; i < CONIC_N_METHODS; i++)
    if (s->splats_by_method[i])
      cli_json_count(json, conic_method_name((conic_method)i), s->splats_by_method[i]);
  cli_json_close(json);
  return report_source(json, job);
}

static void report_settings(cli_json *json, const cli_render_job *job) {
  const conic_render_statistics *s = &job->statistics;
  cli_json_text(json, "device", job->device.used);
  cli_json_text(json, "isa", s->isa);
  cli_json_count(json, "threads", (uint64_t)s->threads);
  cli_json_count(json, "tile", (uint64_t)s->tile);
  cli_json_count(json, "samples", (uint64_t)job->view.samples);
  cli_json_text(json, "epsilon_mode", s->epsilon_is_fixed ? "fixed" : "auto");
  cli_json_number(json, "epsilon", s->epsilon);
  cli_json_number(json, "near", s->near_z);
  cli_json_count(json, "frames", (uint64_t)job->n_frames);
  cli_color_report(json, conic_source_coloring(job->source));
}

static void report_times(cli_json *json, const cli_render_job *job) {
  const conic_source_scale *scale = conic_source_measure(job->source);
  const conic_render_statistics *s = &job->statistics;
  cli_json_object(json, "ms");
  cli_json_number(json, "read", 1e3 * scale->read_seconds);
  cli_json_number(json, "estimate", 1e3 * scale->estimate_seconds);
  cli_json_number(json, "lod", s->ms.lod);
  cli_json_number(json, "setup", s->ms.setup);
  cli_json_number(json, "bin", s->ms.bin);
  cli_json_number(json, "visibility", s->ms.visibility);
  cli_json_number(json, "accumulate", s->ms.accumulate);
  cli_json_number(json, "resolve", s->ms.resolve);
  cli_json_number(json, "write", job->write_ms);
  cli_json_number(json, "frame", s->ms.frame);
  cli_json_number(json, "total", job->total_ms);
  cli_json_close(json);
  cli_json_number(json, "ms_first", job->first_frame_ms);
  cli_json_number(json, "msplats_per_s", per_second_in_millions((double)s->splats_in, s->ms.frame));
  cli_json_number(json, "drawn_msplats_per_s", per_second_in_millions((double)s->splats_drawn, s->ms.frame));
  if (s->triangles_in)
    cli_json_number(json, "mtriangles_per_s", per_second_in_millions((double)s->triangles_in, s->ms.frame));
  cli_json_number(json, "mfragments_per_s", per_second_in_millions((double)s->fragments, s->ms.frame));
  cli_json_count(json, "peak_rss_bytes", cli_peak_rss_bytes());
}

static void report_hashes(cli_json *json, const conic_image *image) {
  cli_json_object(json, "hash");
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (image->planes[i])
      cli_json_hash(json, conic_plane_describe((conic_plane)i)->name, conic_image_hash(image, (conic_plane)i));
  cli_json_close(json);
}

int cli_render_report(cli_session *session, const cli_render_job *job, const conic_image *image) {
  cli_json_file *file;
  int exit_code = CLI_DONE;
  cli_json *json = cli_json_open(session, &file, &exit_code);
  if (!json)
    return exit_code;
  conic_status status = report_counts(json, job);
  report_settings(json, job);
  report_hashes(json, image);
  report_times(json, job);
  exit_code = cli_json_finish(file);
  return status == CONIC_OK ? exit_code : cli_exit_of(status);
}
