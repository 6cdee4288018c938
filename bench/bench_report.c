/* What `conic bench` prints and writes of its lines. */

#include "bench/bench.h"

static double millions_per_s(double n, double ms) {
  return 1e-3 * n / ms;
}

static double overdraw(const conic_render_statistics *s) {
  return s->pixels_covered ? (double)s->fragments / (double)s->pixels_covered : 0.0;
}

static cli_bench_work sum_of(const cli_bench_work work[CLI_BENCH_N_STAGES]) {
  cli_bench_work sum = {0.0};
  for (int i = 0; i < CLI_BENCH_N_STAGES; i++) {
    sum.read_bytes += work[i].read_bytes;
    sum.written_bytes += work[i].written_bytes + work[i].moved_bytes;
    sum.operations += work[i].operations;
  }
  return sum;
}

/* --- the table --- */

void cli_bench_print_head(void) {
  printf("%-34s %8s %8s %8s  %7s %7s %6s %7s %7s %7s  %8s %7s %8s %6s\n", "scene/method/isa/threads", "first", "frame",
         "cpu", "choice", "setup", "bin", "visib.", "accum.", "resolve", "Msplat/s", "drawn", "Mfrag/s", "over");
}

void cli_bench_print_line(const cli_bench_line *line) {
  const conic_render_statistics *s = &line->statistics;
  const conic_render_milliseconds *ms = &s->ms;
  printf("%-34s %8.2f %8.2f %8.2f  %7.2f %7.2f %6.2f %7.2f %7.2f %7.2f  %8.2f %7.2f %8.1f %6.1f%s\n", line->name,
         line->first_ms, ms->frame, line->cpu_ms, ms->lod, ms->setup, ms->bin, ms->visibility, ms->accumulate,
         ms->resolve, millions_per_s((double)s->splats_in, ms->frame),
         millions_per_s((double)s->splats_drawn, ms->frame), millions_per_s((double)s->fragments, ms->frame),
         overdraw(s), line->i_wrong_plane >= 0 ? "  WRONG PICTURE" : "");
  fflush(stdout);
}

void cli_bench_print_curve(const cli_bench_line *lines, int n_lines) {
  printf("\n%-34s %10s %10s %10s %12s %12s\n", "cost curve", "frame ms", "ns/splat", "ns/pixel", "ns/drawn",
         "ns/fragment");
  for (int i = 0; i < n_lines; i++) {
    const conic_render_statistics *s = &lines[i].statistics;
    double ns = 1e6 * s->ms.frame;
    printf("%-34s %10.2f %10.2f %10.2f %12.2f %12.3f\n", lines[i].name, s->ms.frame, ns / (double)s->splats_in,
           ns / ((double)lines[i].width * (double)lines[i].height), ns / (double)s->splats_drawn,
           ns / (double)s->fragments);
  }
}

/* --- JSON --- */

static void report_counts(cli_json *json, const cli_bench_line *line) {
  const conic_render_statistics *s = &line->statistics;
  cli_json_texts(json, NULL, {"scene", line->scene_name}, {"method", cli_bench_method_name(line->i_method)},
                 {"isa", s->isa});
  cli_json_counts(json, NULL, {"threads", (uint64_t)line->threads}, {"width", (uint64_t)line->width},
                  {"height", (uint64_t)line->height}, {"splats_in", s->splats_in}, {"splats_drawn", s->splats_drawn},
                  {"triangles_in", s->triangles_in});
  if (line->chooses)
    cli_json_number(json, "error_px", line->error_px);
  cli_json_counts(json, NULL, {"fragments", s->fragments}, {"pixels_covered", s->pixels_covered});
  cli_json_number(json, "overdraw", overdraw(s));
}

static void report_picture(cli_json *json, const cli_bench_line *line) {
  cli_json_bool(json, "identical", line->i_wrong_plane < 0);
  cli_json_object(json, "hash");
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    if (line->hash[plane])
      cli_json_hash(json, conic_plane_describe((conic_plane)plane)->name, line->hash[plane]);
  cli_json_close(json);
}

/* Each stage's time, multiplied by a factor, and the frame's. */
static void report_stages(cli_json *json, const char *key, const conic_render_milliseconds *ms, double factor) {
  cli_json_object(json, key);
  for (int i = 0; i < CLI_BENCH_N_STAGES; i++)
    cli_json_number(json, cli_bench_stages[i], factor * cli_bench_stage_ms(ms, i));
  cli_json_number(json, "frame", factor * ms->frame);
  cli_json_close(json);
}

static void report_times(cli_json *json, const cli_bench_line *line) {
  const conic_render_statistics *s = &line->statistics;
  cli_json_count(json, "frames", (uint64_t)line->n_frames);
  report_stages(json, "ms", &s->ms, 1.0);
  cli_json_figures(json, NULL, {"ms_first", line->first_ms}, {"ms_choice", s->ms.lod}, {"cpu_ms", line->cpu_ms});
  cli_json_numbers(json, "ms_quartiles", line->quartile_ms, 2);
  cli_json_number(json, "interval", line->interval);
  report_stages(json, "ns_per_splat", &s->ms, 1e6 / (double)s->splats_in);
  cli_json_figures(json, NULL, {"cycles", line->cycles}, {"instructions", line->instructions},
                   {"cycles_per_splat", line->cycles / (double)s->splats_in},
                   {"msplats_per_s", millions_per_s((double)s->splats_in, s->ms.frame)},
                   {"drawn_msplats_per_s", millions_per_s((double)s->splats_drawn, s->ms.frame)},
                   {"mfragments_per_s", millions_per_s((double)s->fragments, s->ms.frame)});
}

static void report_work(cli_json *json, const cli_bench_line *line) {
  cli_bench_work sum = sum_of(line->work);
  cli_json_object(json, "bytes");
  for (int i = 0; i < CLI_BENCH_N_STAGES; i++)
    cli_json_number(json, cli_bench_stages[i],
                    line->work[i].read_bytes + line->work[i].written_bytes + line->work[i].moved_bytes);
  cli_json_number(json, "frame", sum.read_bytes + sum.written_bytes);
  cli_json_close(json);
  cli_json_object(json, "operations");
  for (int i = 0; i < CLI_BENCH_N_STAGES; i++)
    cli_json_number(json, cli_bench_stages[i], line->work[i].operations);
  cli_json_number(json, "frame", sum.operations);
  cli_json_close(json);
}

void cli_bench_report_line(cli_json *json, const cli_bench_line *line) {
  cli_json_object(json, line->name);
  report_counts(json, line);
  report_picture(json, line);
  report_times(json, line);
  report_work(json, line);
  if (line->n_schedules)
    cli_bench_report_schedules(json, line);
  if (!isnan(line->old_ms[CLI_BENCH_N_STAGES])) {
    cli_json_object(json, "speedup");
    for (int i = 0; i < CLI_BENCH_N_STAGES; i++)
      cli_json_number(json, cli_bench_stages[i], line->old_ms[i] / cli_bench_stage_ms(&line->statistics.ms, i));
    cli_json_number(json, "frame", line->old_ms[CLI_BENCH_N_STAGES] / line->statistics.ms.frame);
    cli_json_close(json);
  }
  cli_json_close(json);
}
