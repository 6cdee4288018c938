/* Gaussians in levels: moments by closed forms, what comes back of a file, bounds that hold, and files that are
 * spoiled. */
#include "conic/gaussian_render.h"
#include "gaussians/scene/made_gaussians.h"
#include "lod/blends/levels_build.h"
#include "lod/blends/levels_read.h"
#include "tests/support/files.h"
#include "tests/support/mend.h"

enum { SIDE = 24, SAMPLES = 4, FINE = SIDE * SAMPLES };

static conic_status build(conic_context *context, const char *path, const conic_gaussians *scene, uint32_t cloud_size,
                          uint64_t memory_bytes, conic_levels_statistics *statistics) {
  conic_levels_builder *builder;
  conic_gaussians own;
  CHECK_OK(conic_gaussians_allocate(context, scene->count, scene->sh_degree, 0, &own));
  conic_gaussians_put(scene, &own, 0);
  memcpy(own.frame, scene->frame, sizeof own.frame);
  CHECK_OK(conic_levels_builder_open(context, path, cloud_size, memory_bytes, &builder));
  CHECK_OK(conic_levels_builder_append(builder, path, &own));
  conic_gaussians_release(context, &own);
  return conic_levels_builder_finish(builder, statistics);
}

/* Two balls of deviation s, d to each side, of opacity o. */
static void moments(void) {
  const float s = 0.5f, d = 0.75f, o = 0.4f;
  float rows[2][14], row[14];
  conic_blend parts[2];
  for (int i = 0; i < 2; i++) {
    const float values[14] = {i ? d : -d,        1.0f, 2.0f, s, s, s, 1.0f, 0.0f, 0.0f, 0.0f, o, 0.5f,
                              i ? 0.25f : 0.75f, -1.0f};
    memcpy(rows[i], values, sizeof values);
    conic_blend_take(rows[i], 0, &parts[i]);
  }
  conic_blend_merge(parts, 2, 0, row);
  const double s2 = (double)(s * s), along = s2 + (double)(d * d), area = sqrt((s2 * s2 + 2.0 * s2 * along) / 3.0);
  const double opacity = 1.0 - exp(2.0 * log(1.0 - (double)o) * s2 / area);
  CHECK(fabs((double)row[0]) < 1e-6 && row[1] == 1.0f && row[2] == 2.0f);
  CHECK(fabs((double)row[3] - sqrt(along)) < 2e-4 && fabs((double)row[4] - (double)s) < 2e-4 &&
        fabs((double)row[5] - (double)s) < 2e-4);
  CHECK(fabs((double)row[CONIC_BLEND_OPACITY] - opacity) < 2e-4);
  CHECK(fabs((double)row[12] - 0.5) < 2e-4 && row[13] == -1.0f);
  /* one and the same twice changes the opacity alone: nothing is lost but what two of them cover */
  conic_blend whole;
  conic_blend_take(rows[0], 0, &whole);
  conic_blend_find_parts(parts, 1, 0, &whole);
  CHECK(whole.parts.light == 0.0f);
  conic_blend_take(row, 0, &whole);
  conic_blend_find_parts(parts, 2, 0, &whole);
  CHECK(whole.parts.light > 0.0f);
  CHECK((double)whole.parts.reach >= (double)d + 3.34 * (double)s);
}

/* Two of one colour lose nothing over that colour: what they change counts a fifth over black, and a 20th of itself. */
static void light_of_one_color(void) {
  double light[2];
  for (int is_white = 0; is_white < 2; is_white++) {
    float rows[2][14], row[14];
    conic_blend parts[2], whole;
    const float color = (float)((is_white - 0.5) / CONIC_SH_CONSTANT);
    for (int i = 0; i < 2; i++) {
      const float values[14] = {
          i ? 1.0f : -1.0f, 0.0f, 0.0f, 0.5f, 0.5f, 0.5f, 1.0f, 0.0f, 0.0f, 0.0f, 0.75f, color, color, color};
      memcpy(rows[i], values, sizeof values);
      conic_blend_take(rows[i], 0, &parts[i]);
    }
    conic_blend_merge(parts, 2, 0, row);
    conic_blend_take(row, 0, &whole);
    conic_blend_find_parts(parts, 2, 0, &whole);
    light[is_white] = (double)whole.parts.light;
  }
  CHECK(light[0] > 0.0 && fabs(light[1] / light[0] - (0.05 + 3.0 * 0.2) / 0.05) < 0.1);
}

/* Widened, one alone stays what it is, and two that are small beside what is added are one behind the other. */
static void dilation(void) {
  float rows[2][14], row[14];
  conic_blend parts[2], whole;
  for (int i = 0; i < 2; i++) {
    const float values[14] = {
        i ? 1e-3f : -1e-3f, 0.0f, 0.0f, 1e-3f, 2e-3f, 4e-3f, 0.5f, 0.5f, 0.5f, 0.5f, i ? 0.75f : 0.3f, 0.5f,
        i ? 0.25f : 0.75f,  -1.0f};
    memcpy(rows[i], values, sizeof values);
    conic_blend_take(rows[i], 0, &parts[i]);
  }
  memcpy(row, rows[1], sizeof row);
  for (double variance = 1e-7; variance < 1.0; variance *= 10.0) {
    conic_blend_dilate(&parts[1].parts, variance, row);
    CHECK(fabsf(row[CONIC_BLEND_OPACITY] - 0.75f) < 1e-5f && row[12] == 0.25f);
  }
  conic_blend_merge(parts, 2, 0, row);
  conic_blend_take(row, 0, &whole);
  conic_blend_find_parts(parts, 2, 0, &whole);
  conic_blend_dilate(&whole.parts, 1.0, row);
  const double depths[2] = {log(0.7), log(0.25)};
  CHECK(fabs((double)row[CONIC_BLEND_OPACITY] - (1.0 - 0.7 * 0.25)) < 1e-3);
  CHECK(fabs((double)row[12] - (0.75 * depths[0] + 0.25 * depths[1]) / (depths[0] + depths[1])) < 1e-3);
}

/* Files that differ in nothing, whatever the threads and the memory; and all that came, to the bit and in its order. */
static void round_trip(conic_context *context) {
  conic_context *other;
  conic_context_options options;
  conic_gaussians scene, again;
  conic_gaussians_differences differences;
  conic_levels_statistics statistics;
  conic_levels *levels;
  uint64_t n_damaged, n_unbounded;
  unsigned char *bytes[2];
  size_t n[2];
  CHECK_OK(conic_gaussians_make(context, 1500, 1, 7, &scene));
  scene.position[1][17] = NAN;
  scene.rotation[0][18] = scene.rotation[1][18] = scene.rotation[2][18] = scene.rotation[3][18] = 0.0f;
  CHECK_OK(build(context, files_path("a.lpc"), &scene, 64, 1 << 30, &statistics));
  CHECK(statistics.n == 1500 && statistics.n_levels == 4 && statistics.n_clouds == 24 + 6 + 2 + 1);
  conic_context_options_init(&options);
  options.threads = 3;
  CHECK_OK(conic_context_create(&options, &other));
  CHECK_OK(build(other, files_path("b.lpc"), &scene, 64, 1 << 17, &statistics));
  n[0] = files_read(files_path("a.lpc"), &bytes[0]);
  n[1] = files_read(files_path("b.lpc"), &bytes[1]);
  CHECK(n[0] == statistics.n_bytes && n[0] == n[1] && memcmp(bytes[0], bytes[1], n[0]) == 0);
  CHECK_OK(conic_levels_read(context, files_path("a.lpc"), &again));
  CHECK_OK(conic_gaussians_compare(context, &scene, &again, &differences));
  CHECK(differences.is_same);
  CHECK_OK(conic_levels_open(context, files_path("a.lpc"), NULL, &levels));
  CHECK_OK(conic_levels_check(levels, &n_damaged, &n_unbounded));
  CHECK(n_damaged == 0 && n_unbounded == 0);
  conic_levels_close(levels);
  conic_gaussians_release(context, &scene);
  conic_gaussians_release(context, &again);
  conic_context_destroy(other);
  for (int i = 0; i < 2; i++) {
    free(bytes[i]);
    CHECK(unlink(files_path(i ? "b.lpc" : "a.lpc")) == 0);
  }
}

/* A sheet of Gaussians across the line of sight, none behind another. */
static conic_gaussians sheet(conic_context *context) {
  enum { ROW = 40 };
  conic_gaussians set;
  CHECK_OK(conic_gaussians_allocate(context, (size_t)ROW * ROW, 0, 0, &set));
  for (size_t i = 0; i < set.count; i++) {
    const double u = (double)(i % ROW) / ROW - 0.5, v = (double)(i / ROW) / ROW - 0.5;
    for (int axis = 0; axis < 3; axis++) {
      set.position[axis][i] = (float)(axis == 0 ? u : axis == 1 ? v : 1e-5 * (double)(i * 7 % 1600));
      set.scale[axis][i] = axis == 2 ? 1e-4f : 0.006f + 0.004f * (float)(i % 5) / 5.0f;
      set.sh[3 * i + (size_t)axis] = (float)(i * (size_t)(axis + 3) % 11) / 11.0f - 0.5f;
    }
    for (int k = 0; k < 4; k++)
      set.rotation[k][i] = k == 0;
    set.opacity[i] = 0.5f + 0.4f * (float)(i % 3) / 2.0f;
  }
  return set;
}

static conic_camera camera_before(int side, double distance) {
  return (conic_camera){.width = side,
                        .height = side,
                        .fx = 1.2 * side,
                        .fy = 1.2 * side,
                        .cx = 0.5 * side,
                        .cy = 0.5 * side,
                        .cam_from_world = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, distance}}};
}

/* Means of pixels, as many samples. */
static void draw(conic_context *context, const conic_gaussians *set, double distance, float *pixels) {
  static float rgb[3 * FINE * FINE];
  const conic_camera camera = camera_before(FINE, distance);
  conic_gaussian_planes planes = {.width = FINE, .height = FINE, .rgb = rgb};
  CHECK_OK(conic_gaussians_render(context, set, &camera, NULL, &planes, NULL));
  memset(pixels, 0, 3 * SIDE * SIDE * sizeof *pixels);
  for (size_t i = 0; i < 3 * FINE * FINE; i++) {
    const size_t x = i / 3 % FINE / SAMPLES, y = i / 3 / FINE / SAMPLES;
    pixels[3 * (y * SIDE + x) + i % 3] += rgb[i] / (SAMPLES * SAMPLES);
  }
}

static conic_levels_cut choose(conic_levels_scene *scene, const conic_levels_wish *wish, conic_camera camera,
                               conic_gaussians *set) {
  scene->camera = camera;
  CHECK_OK(conic_levels_choose(scene, 1, wish));
  *set = scene->set;
  return scene->cut;
}

/* Two scenes share one budget by one error, which is each one's alone; what is too little is told with its least. */
static void budgets_shared(conic_context *context) {
  conic_gaussians scene = sheet(context);
  conic_levels_statistics statistics;
  conic_levels_scene scenes[2];
  uint64_t n[2];
  memset(scenes, 0, sizeof scenes);
  CHECK_OK(build(context, files_path("sheet.lpc"), &scene, 64, 1 << 26, &statistics));
  for (int i = 0; i < 2; i++) {
    CHECK_OK(conic_levels_open(context, files_path("sheet.lpc"), NULL, &scenes[i].levels));
    scenes[i].camera = camera_before(SIDE, i ? 5.0 : 3.0);
  }
  for (uint64_t budget = 200; budget < 1600; budget *= 3) {
    const conic_levels_wish wish = {.budget = budget};
    CHECK_OK(conic_levels_choose(scenes, 2, &wish));
    const conic_levels_wish same = {.error = scenes[0].cut.error};
    CHECK(scenes[0].cut.error == scenes[1].cut.error && scenes[0].cut.n + scenes[1].cut.n <= budget);
    CHECK(scenes[0].cut.n + scenes[1].cut.n > budget / 2 && scenes[0].cut.n > scenes[1].cut.n);
    for (int i = 0; i < 2; i++) {
      n[i] = scenes[i].cut.n;
      conic_gaussians_release(context, &scenes[i].set);
      CHECK_OK(conic_levels_choose(&scenes[i], 1, &same));
      CHECK(scenes[i].cut.n == n[i]);
      conic_gaussians_release(context, &scenes[i].set);
    }
  }
  const conic_levels_wish few = {.budget = 3};
  CHECK(conic_levels_choose(scenes, 2, &few) == CONIC_ERROR_INPUT);
  conic_levels_close(scenes[0].levels);
  conic_levels_close(scenes[1].levels);
  CHECK(unlink(files_path("sheet.lpc")) == 0);
  conic_gaussians_release(context, &scene);
}

/* Of a sheet no pixel is off by more than a quarter of the error, nor are any more are drawn than the budget says. */
static void bounds_hold(conic_context *context) {
  conic_gaussians scene = sheet(context), set;
  conic_levels_statistics statistics;
  conic_levels_cut cut;
  conic_levels_scene one;
  static float truth[3 * SIDE * SIDE], pixels[3 * SIDE * SIDE];
  const double distance = 3.0;
  CHECK_OK(build(context, files_path("sheet.lpc"), &scene, 64, 1 << 26, &statistics));
  memset(&one, 0, sizeof one);
  CHECK_OK(conic_levels_open(context, files_path("sheet.lpc"), NULL, &one.levels));
  draw(context, &scene, distance, truth);
  uint64_t n_before = scene.count + 1;
  for (int i = 0; i < 5; i++) {
    const double errors[5] = {1e-9, 0.4, 0.8, 1.6, 3.2};
    const conic_levels_wish wish = {.error = errors[i]};
    double most = 0.0;
    cut = choose(&one, &wish, camera_before(SIDE, distance), &set);
    draw(context, &set, distance, pixels);
    for (int k = 0; k < 3 * SIDE * SIDE; k++)
      most = fmax(most, fabs((double)(pixels[k] - truth[k])));
    CHECK(cut.error == errors[i] && cut.n == set.count);
    CHECK(most <= 0.25 * errors[i] + 1e-5 && cut.n < n_before);
    CHECK(i > 0 ? cut.n_merged > 0 : cut.n == scene.count && most == 0.0);
    n_before = cut.n;
    conic_gaussians_release(context, &set);
  }
  CHECK(n_before < scene.count / 2);
  for (uint64_t budget = 100; budget < 1600; budget *= 3) {
    const conic_levels_wish wish = {.budget = budget};
    cut = choose(&one, &wish, camera_before(SIDE, distance), &set);
    CHECK(cut.n <= budget && cut.n > budget / 2 && !cut.is_short);
    conic_gaussians_release(context, &set);
  }
  /* what is out of sight is not drawn, nor read */
  const conic_levels_wish beside = {.error = 0.01};
  cut = choose(&one, &beside, camera_before(SIDE, -3.0), &set);
  CHECK(cut.n == 0);
  conic_gaussians_release(context, &set);
  conic_levels_close(one.levels);
  CHECK(unlink(files_path("sheet.lpc")) == 0);
  conic_gaussians_release(context, &scene);
}

/* Whatever byte is another, with its sums or against them: it is refused, or is read as something else. */
static void spoiled(conic_context *context) {
  conic_gaussians scene, set;
  conic_levels_statistics statistics;
  unsigned char *bytes;
  CHECK_OK(conic_gaussians_make(context, 90, 0, 3, &scene));
  CHECK_OK(build(context, files_path("small.lpc"), &scene, 20, 1 << 20, &statistics));
  const size_t n_bytes = files_read(files_path("small.lpc"), &bytes);
  unsigned char *other = malloc(n_bytes);
  CHECK(bytes && other && n_bytes == statistics.n_bytes);
  for (size_t at = 0; at < n_bytes; at += at < 256 ? 1 : 29)
    for (int is_mended = 0; is_mended < 2; is_mended++) {
      memcpy(other, bytes, n_bytes);
      other[at] ^= (unsigned char)(1u << at % 8);
      if (is_mended)
        mend_levels(other, n_bytes);
      files_write_bytes("spoiled.lpc", other, n_bytes);
      const conic_status status = conic_levels_read(context, files_path("spoiled.lpc"), &set);
      CHECK(status == CONIC_ERROR_INPUT || status == CONIC_OK);
      CHECK(is_mended || status == CONIC_ERROR_INPUT || (at >= 256 && at < n_bytes)); /* of what is not read */
      conic_gaussians_release(context, &set);
    }
  for (size_t n = 0; n < n_bytes; n += 53) {
    files_write_bytes("spoiled.lpc", bytes, n);
    CHECK(conic_levels_read(context, files_path("spoiled.lpc"), &set) == CONIC_ERROR_INPUT);
  }
  free(bytes);
  free(other);
  CHECK(unlink(files_path("small.lpc")) == 0 && unlink(files_path("spoiled.lpc")) == 0);
  conic_gaussians_release(context, &scene);
}

int main(void) {
  conic_context *context = files_context();
  conic_zstd *zstd;
  if (conic_zstd_create(context, &zstd) == CONIC_ERROR_UNSUPPORTED) {
    printf("skipped: this build has no zstd\n");
    return 77;
  }
  conic_zstd_destroy(context, zstd);
  moments();
  light_of_one_color();
  dilation();
  round_trip(context);
  bounds_hold(context);
  budgets_shared(context);
  spoiled(context);
  files_end(context);
  return check_result();
}
