/* The inside of conic bench: medians, the comparison of pictures, lines that are measured, the model of their work. */
#include "bench/bench.h"
#include "cli/command.h"
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
  const cli_bench_patience patience = {2, 2, 0.0};
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
  const cli_bench_machine machine = {1, 2e9, 1e9, 1e9, 4e9};
  const cli_bench_work moves = {2e9, 1e9, 4e9}, computes = {2e9, 1e9, 12e9};
  CHECK_NEAR(cli_bench_floor_ms(&moves, &machine), 2000.0, 1e-9);
  CHECK_NEAR(cli_bench_floor_ms(&computes, &machine), 3000.0, 1e-9);
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
  cli_session_close(&session);
  return check_result();
}
