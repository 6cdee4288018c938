/* The inside of conic bench: medians, the comparison of pictures, lines that are measured, the model of their work. */
#include "bench/bench.h"
#include "cli/command.h"
#include "core/base/threads.h"
#include "tests/support/check.h"

const cli_command *cli_find_command(const char *name) {
  (void)name;
  return NULL;
}

static void test_median(void) {
  double odd[] = {5.0, 1.0, 4.0, 2.0, 3.0}, even[] = {4.0, 1.0, 3.0, 2.0}, one[] = {7.0}, quartiles[2];
  CHECK(cli_bench_median(odd, 5, quartiles) == 3.0);
  CHECK(quartiles[0] == 2.0 && quartiles[1] == 4.0);
  CHECK(cli_bench_median(even, 4, NULL) == 2.5);
  CHECK(cli_bench_median(one, 1, quartiles) == 7.0 && quartiles[0] == 7.0 && quartiles[1] == 7.0);
}

/* Every bit of every common plane counts, and nothing else. */
static void test_difference(conic_context *context) {
  conic_image a, b;
  const unsigned planes = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_ID | 1u << CONIC_PLANE_NORMAL;
  CHECK_OK(conic_image_allocate(context, 5, 3, planes, &a));
  CHECK_OK(conic_image_allocate(context, 5, 3, planes | 1u << CONIC_PLANE_Z, &b));
  CHECK(cli_bench_difference(&a, &b) == -1);
  for (int plane = 0; plane < CONIC_N_PLANES; plane++) {
    if (!a.planes[plane])
      continue;
    size_t last = (size_t)5 * 3 * 4 * (size_t)conic_plane_describe((conic_plane)plane)->n_channels - 1;
    ((unsigned char *)b.planes[plane])[last] ^= 0x80; /* of a float: -0 is not 0 */
    CHECK(cli_bench_difference(&a, &b) == plane);
    ((unsigned char *)b.planes[plane])[last] ^= 0x80;
  }
  conic_image_release(context, &a);
  conic_image_release(context, &b);
}

static cli_bench_line line_of(int i_method, int edge) {
  cli_bench_line line;
  memset(&line, 0, sizeof line);
  line.i_method = i_method;
  line.isa = conic_isa_best();
  line.width = edge;
  line.height = edge - 10;
  return line;
}

/* A line passes with the right reference, and not with one that has a bit wrong in any plane, timed or not. */
static void test_planted(cli_session *session, const char *scene_name, int i_method) {
  const cli_bench_patience patience = {2, 2, 0.0, 1};
  cli_bench_scene scene;
  cli_bench_pictures pictures = {.timed_planes = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_WEIGHT};
  cli_bench_line line = line_of(i_method, 90);
  const unsigned all = CONIC_DRAWN_PLANES;
  CHECK(cli_bench_scene_open(session, scene_name, NULL, &scene) == CLI_DONE);
  CHECK_OK(conic_image_allocate(session->context, line.width, line.height, all, &pictures.reference));
  CHECK_OK(conic_image_allocate(session->context, line.width, line.height, all, &pictures.drawn));
  CHECK_OK(cli_bench_refer(session, &scene, &line, &pictures.reference));
  for (int plane = -1; plane < CONIC_N_DRAWN_PLANES; plane++) {
    unsigned char *bytes = plane < 0 ? NULL : pictures.reference.planes[plane];
    if (bytes)
      bytes[4000] ^= 1;
    CHECK_OK(cli_bench_measure(session, &scene, &patience, NULL, &pictures, &line));
    CHECK(line.i_wrong_plane == plane);
    CHECK(line.n_frames == 2 && line.statistics.ms.frame > 0.0 && line.first_ms > 0.0);
    CHECK(isnan(line.cycles));
    if (bytes)
      bytes[4000] ^= 1;
  }
  CHECK(line.statistics.fragments > 1000 && line.statistics.splats_drawn > 0);
  conic_image_release(session->context, &pictures.reference);
  conic_image_release(session->context, &pictures.drawn);
  cli_bench_scene_release(session, &scene);
}

/* The model: set-up reads all splats, resolving writes all pixels, twice the fragments are twice the operations. */
static void test_work(void) {
  cli_bench_work work[CLI_BENCH_N_STAGES], twice[CLI_BENCH_N_STAGES];
  conic_render_statistics s = {.splats_in = 1000, .splats_drawn = 1000, .fragments = 8000, .pixels_covered = 500};
  conic_splats splats = {.count = 1000};
  float pixel;
  conic_image image = {.width = 40, .height = 30, .planes = {[CONIC_PLANE_RGBA] = &pixel, [CONIC_PLANE_Z] = &pixel}};
  s.splats_by_method[CONIC_METHOD_CONIC] = 1000;
  cli_bench_work_of(&s, &splats, &image, 3, work);
  CHECK(work[0].read_bytes == 48.0 * 1000.0);
  CHECK(work[4].written_bytes == 20.0 * 40.0 * 30.0);
  s.fragments *= 2;
  cli_bench_work_of(&s, &splats, &image, 3, twice);
  CHECK(twice[2].operations == 2.0 * work[2].operations && twice[3].operations == 2.0 * work[3].operations);
  CHECK(twice[0].operations == work[0].operations && twice[2].read_bytes == work[2].read_bytes);
  s.splats_by_method[CONIC_METHOD_RAY] = 1000;
  cli_bench_work_of(&s, &splats, &image, 3, work);
  CHECK(work[2].operations > 2.0 * twice[2].operations);
}

/* Of Gaussians, set-up reads all, and harmonics only of those that are drawn; pairs are what compositing is made of. */
static void test_gaussian_work(cli_session *session) {
  cli_bench_scene scene;
  cli_bench_line line = line_of(CLI_BENCH_N_METHODS + CONIC_PROFILE_GSPLAT_1_6, 90);
  CHECK(cli_bench_scene_open(session, "gaussians-100", NULL, &scene) == CLI_DONE);
  CHECK(scene.is_gaussian && scene.gaussians.count == 100);
  line.statistics = (conic_render_statistics){.splats_in = 1000, .splats_drawn = 100, .fragments = 1000000};
  cli_bench_gaussians_work(&scene, &line);
  CHECK(line.work[0].read_bytes == 44.0 * 1000.0 + 192.0 * 100.0);
  double operations = line.work[3].operations;
  line.i_method = CLI_BENCH_N_METHODS + CONIC_PROFILE_EXACT;
  cli_bench_gaussians_work(&scene, &line);
  CHECK(operations > 30e6 && line.work[3].operations > 1.5 * operations);
  CHECK(strcmp(cli_bench_method_name(line.i_method), "exact") == 0 && strcmp(cli_bench_method_name(1), "ray") == 0);
  cli_bench_scene_release(session, &scene);
}

/* Memory or vectors, whichever holds up longer. */
static void test_floor(void) {
  const cli_bench_machine machine = {.threads = 1,
                                     .read_bytes_per_s = 2e9,
                                     .write_bytes_per_s = 1e9,
                                     .copy_bytes_per_s = 1e9,
                                     .moved_bytes_per_s = 1e9,
                                     .operations_per_s = 4e9,
                                     .divisions_per_s = 1e9,
                                     .gathered_per_s = 1e9};
  const cli_bench_work moves = {.read_bytes = 2e9, .written_bytes = 1e9, .operations = 4e9};
  const cli_bench_work computes = {.read_bytes = 2e9, .written_bytes = 1e9, .operations = 12e9};
  CHECK_NEAR(cli_bench_floor_ms(&moves, &machine), 2000.0, 1e-9);
  CHECK_NEAR(cli_bench_floor_ms(&computes, &machine), 3000.0, 1e-9);
}

/* A trace as if its tasks had taken so many seconds. */
static cli_bench_trace trace_of_seconds(cli_bench_region *regions, size_t n_regions, double *seconds) {
  return (cli_bench_trace){.last_regions = regions, .n_last_regions = n_regions, .kept = seconds, .n_rows = 1};
}

/* Three threads, of which the last begins after 1 ms, do 2, 1, 1, 1, 5 ms and then one task alone. */
static void test_schedule(void) {
  cli_bench_region regions[] = {{"tile_task", 5}, {"sort", 1}, {"tile_task", 2}};
  double seconds[] = {0.25e-3, 2e-3, 1e-3, 1e-3, 1e-3, 5e-3, 0.5e-3, 4e-3, 0.0, 1e-3, 1e-3, 0.25e-3};
  const double at_once[] = {0.0, 0.0, 0.0}, late[] = {0.0, 0.5, 1.0};
  cli_bench_trace trace = trace_of_seconds(regions, 3, seconds);
  cli_bench_schedule schedule;
  const char *region;
  cli_bench_schedule_make(&trace, 3, at_once, &schedule);
  CHECK(schedule.n_regions == 2 && schedule.threads == 3 && schedule.start_ms == 0.0);
  CHECK(strcmp(schedule.regions[0].name, "tile") == 0 && strcmp(schedule.regions[1].name, "sort") == 0);
  CHECK(schedule.regions[0].n_tasks == 7 && schedule.regions[0].n_regions == 2);
  CHECK_NEAR(schedule.serial_ms, 1.0, 1e-12);
  CHECK_NEAR(schedule.work_ms, 17.0, 1e-12);
  CHECK_NEAR(schedule.regions[0].ms, 6.0 + 1.0, 1e-12); /* 1 and then 5; 1 */
  CHECK_NEAR(schedule.regions[0].longest_ms, 5.0, 1e-12);
  CHECK_NEAR(schedule.ms, 1.0 + 4.0 + 7.0, 1e-12);
  CHECK_NEAR(schedule.lost_ms[CLI_BENCH_LOSS_STARTS], 0.0, 1e-12);
  CHECK_NEAR(schedule.lost_ms[CLI_BENCH_LOSS_SERIAL], 1.0 - 1.0 / 3.0, 1e-12);
  CHECK(cli_bench_schedule_limit(&schedule, &region) == CLI_BENCH_LOSS_LONGEST && strcmp(region, "sort") == 0);
  cli_bench_schedule_make(&trace, 3, late, &schedule);
  CHECK_NEAR(schedule.regions[0].ms, 7.0 + 1.5, 1e-12); /* 0 to 2, and 5; 0.5 to 1.5 */
  CHECK_NEAR(schedule.lost_ms[CLI_BENCH_LOSS_STARTS], 1.5, 1e-12);
  CHECK(schedule.start_ms == 1.0);
}

/* Medians over the frames that are as the last, without the first of them. */
static void test_trace(void) {
  cli_bench_trace trace;
  memset(&trace, 0, sizeof trace);
  CHECK(cli_bench_trace_settle(&trace) == CONIC_ERROR_MEMORY);
  for (int frame = 0; frame < 5; frame++) {
    size_t n_tasks = frame ? 3 : 4;
    cli_bench_trace_begin(&trace);
    for (size_t n_done = 0; n_done <= n_tasks; n_done++)
      cli_bench_trace_watch(&trace, "tile_task", n_tasks, n_done);
    cli_bench_trace_end(&trace);
  }
  CHECK(trace.n_rows == 4 && trace.n_a_row == 5 && trace.n_last_regions == 1 && trace.last_regions[0].n_tasks == 3);
  for (size_t row = 0; row < 4; row++)
    for (size_t i = 0; i < 5; i++)
      trace.kept[row * 5 + i] = (double)(row == 0 ? 100 : row * (i + 1));
  CHECK_OK(cli_bench_trace_settle(&trace));
  CHECK(trace.n_rows == 1 && trace.kept[0] == 2.0 && trace.kept[4] == 10.0);
  cli_bench_trace_release(&trace);
}

/* A frame that is shared out as for sixteen has more chunks and is the same picture; its tasks add up to it. */
static void test_simulation(cli_session *session) {
  const cli_bench_patience patience = {3, 3, 0.0, 1};
  cli_bench_scene scene;
  cli_session planner = {.command = "bench", .threads = 1};
  cli_bench_pictures pictures = {.timed_planes = 1u << CONIC_PLANE_RGBA};
  cli_bench_trace trace;
  cli_bench_schedule schedule;
  cli_bench_line line = line_of(0, 200);
  double start_ms[16];
  memset(&trace, 0, sizeof trace);
  CHECK(cli_session_open(&planner) == CLI_DONE);
  CHECK(cli_bench_scene_open(session, "sphere-200k", NULL, &scene) == CLI_DONE);
  CHECK_OK(conic_image_allocate(session->context, line.width, line.height, 1u, &pictures.reference));
  CHECK_OK(conic_image_allocate(session->context, line.width, line.height, 1u, &pictures.drawn));
  CHECK_OK(cli_bench_refer(session, &scene, &line, &pictures.reference));
  line.trace = &trace;
  conic_parallel_plan(planner.context, 16, cli_bench_trace_watch, &trace);
  CHECK_OK(cli_bench_measure(&planner, &scene, &patience, NULL, &pictures, &line));
  CHECK(line.i_wrong_plane == -1);
  CHECK_OK(cli_bench_trace_settle(&trace));
  CHECK_OK(cli_bench_starts_measure(16, start_ms));
  CHECK(start_ms[0] >= 0.0 && start_ms[15] >= start_ms[0]);
  cli_bench_schedule_make(&trace, 16, start_ms, &schedule);
  CHECK(schedule.n_regions == 2 && strcmp(schedule.regions[0].name, "project") == 0);
  CHECK(schedule.regions[0].n_tasks == (200000 + 2047) / 2048 && schedule.regions[1].n_tasks == 4 * 3);
  CHECK(schedule.serial_ms > 0.0 && schedule.work_ms > schedule.serial_ms + schedule.regions[0].work_ms);
  CHECK(schedule.ms > schedule.regions[1].longest_ms);
  cli_bench_trace_release(&trace);
  conic_image_release(session->context, &pictures.reference);
  conic_image_release(session->context, &pictures.drawn);
  cli_bench_scene_release(session, &scene);
  cli_session_close(&planner);
}

int main(void) {
  cli_session session = {.command = "bench", .threads = 2};
  if (cli_session_open(&session) != CLI_DONE)
    return 1;
  test_median();
  test_difference(session.context);
  for (int i_method = 0; i_method < CLI_BENCH_N_METHODS; i_method++)
    test_planted(&session, "sphere-3000", i_method);
  test_planted(&session, "mixed-300", 0);
  test_planted(&session, "needles-300", 0);
  test_planted(&session, "subpixel-3k", 0);
  test_planted(&session, "huge-5", 0);
  test_planted(&session, "gaussians-500", CLI_BENCH_N_METHODS + CONIC_PROFILE_GSPLAT_1_6);
  test_planted(&session, "gaussians-500", CLI_BENCH_N_METHODS + CONIC_PROFILE_EXACT);
  test_work();
  test_gaussian_work(&session);
  test_floor();
  test_schedule();
  test_trace();
  test_simulation(&session);
  cli_session_close(&session);
  return check_result();
}
