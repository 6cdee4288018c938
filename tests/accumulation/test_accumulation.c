/* Sums of samples: the same bits however they are cut, what becomes of odd numbers, files, and where samples look from.
 */
#include <unistd.h>

#include "accumulation/exact_sum.h"
#include "accumulation/sequence.h"
#include "tests/support/check.h"
#include "tests/support/folder.h"

enum { WIDTH = 7, HEIGHT = 5, N_PIXELS = WIDTH * HEIGHT, N = 37 };
enum { PLANES = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_NORMAL };

/* A picture of numbers of all sizes and both signs, and some that are none. */
static conic_image noise_picture(conic_context *context, uint64_t i_sample) {
  conic_image image;
  CHECK_OK(conic_image_allocate(context, WIDTH, HEIGHT, PLANES, &image));
  float *rgba = image.planes[CONIC_PLANE_RGBA], *normal = image.planes[CONIC_PLANE_NORMAL];
  for (uint64_t i = 0; i < 4 * N_PIXELS; i++)
    rgba[i] = (float)ldexp(conic_sequence_at(i_sample, 0) - 0.3, (int)((i_sample * 13 + i * 7) % 60) - 30);
  for (uint64_t i = 0; i < 3 * N_PIXELS; i++)
    normal[i] = (float)(conic_sequence_at(i_sample, 1) - 0.5);
  rgba[5] = i_sample == 3 ? NAN : 0.25f;
  return image;
}

static conic_accumulation *sums_from(conic_context *context, uint64_t first, uint64_t end) {
  conic_accumulation *sums;
  CHECK_OK(conic_accumulation_create(context, WIDTH, HEIGHT, PLANES, first, &sums));
  for (uint64_t i = first; i < end; i++) {
    conic_image image = noise_picture(context, i);
    CHECK_OK(conic_accumulation_add(sums, &image));
    conic_image_release(context, &image);
  }
  return sums;
}

/* Everything that sums say, as one number. */
static uint64_t hash_of(conic_context *context, const conic_accumulation *sums) {
  conic_image image;
  uint64_t hash = 0;
  unsigned planes = PLANES | 1u << CONIC_PLANE_SAMPLES | 1u << CONIC_PLANE_VARIANCE;
  CHECK_OK(conic_image_allocate(context, WIDTH, HEIGHT, planes, &image));
  CHECK_OK(conic_accumulation_resolve(sums, &image));
  for (int i = 0; i < CONIC_N_PLANES; i++)
    hash = hash * 31 + conic_image_hash(&image, (conic_plane)i);
  conic_image_release(context, &image);
  return hash;
}

static void test_cuts(conic_context *context, uint64_t whole) {
  for (uint64_t cut = 0; cut <= N; cut += 4) {
    uint64_t later = cut + (N - cut) / 3;
    conic_accumulation *parts[3] = {sums_from(context, 0, cut), sums_from(context, cut, later),
                                    sums_from(context, later, N)};
    if (cut % 8 == 0) { /* the end first */
      CHECK_OK(conic_accumulation_merge(parts[1], parts[2]));
      CHECK_OK(conic_accumulation_merge(parts[1], parts[0]));
    } else {
      CHECK_OK(conic_accumulation_merge(parts[0], parts[1]));
      CHECK_OK(conic_accumulation_merge(parts[0], parts[2]));
    }
    const conic_accumulation *all = parts[cut % 8 == 0];
    conic_accumulation_facts facts;
    conic_accumulation_inspect(all, &facts);
    CHECK(facts.first_sample == 0 && facts.end_sample == N && facts.planes == PLANES);
    CHECK(hash_of(context, all) == whole);
    for (int i = 0; i < 3; i++)
      conic_accumulation_destroy(parts[i]);
  }
}

static void test_refusals(conic_context *context) {
  conic_accumulation *sums = sums_from(context, 0, 4), *far = sums_from(context, 5, 6),
                     *next = sums_from(context, 4, 6);
  CHECK(conic_accumulation_merge(sums, far) == CONIC_ERROR_ARGUMENT);
  conic_accumulation_set_key(sums, 1);
  conic_accumulation_set_key(next, 2);
  CHECK(conic_accumulation_merge(sums, next) == CONIC_ERROR_ARGUMENT);
  conic_accumulation_set_key(next, 1);
  CHECK_OK(conic_accumulation_merge(sums, next));
  conic_accumulation_destroy(sums);
  conic_accumulation_destroy(far);
  conic_accumulation_destroy(next);
  CHECK(conic_accumulation_create(context, 4, 4, 1u << CONIC_PLANE_Z, 0, &sums) == CONIC_ERROR_ARGUMENT);
}

/* A file keeps every bit, and says where one is wrong. */
static void test_file(conic_context *context, uint64_t whole) {
  char folder[FOLDER_ROOM], path[FOLDER_ROOM + 16];
  conic_accumulation *sums = sums_from(context, 0, 20), *read = NULL, *rest = sums_from(context, 20, N);
  folder_make(folder);
  snprintf(path, sizeof path, "%s/sums", folder);
  CHECK_OK(conic_accumulation_write(sums, path));
  CHECK_OK(conic_accumulation_read(context, path, &read));
  CHECK_OK(conic_accumulation_merge(read, rest));
  CHECK(hash_of(context, read) == whole);
  conic_accumulation_destroy(read);
  for (long at = 3; at < 3000; at += 171) {
    FILE *file = fopen(path, "r+b");
    fseek(file, at, SEEK_SET);
    int byte = fgetc(file);
    fseek(file, at, SEEK_SET);
    fputc(byte ^ 1, file);
    fclose(file);
    CHECK(conic_accumulation_read(context, path, &read) == CONIC_ERROR_INPUT && !read);
    CHECK_OK(conic_accumulation_write(sums, path));
  }
  CHECK(truncate(path, 100) == 0 && conic_accumulation_read(context, path, &read) == CONIC_ERROR_INPUT);
  remove(path);
  rmdir(folder);
  conic_accumulation_destroy(sums);
  conic_accumulation_destroy(rest);
}

static void test_exact(void) {
  conic_exact_sum sum = {0, 0};
  const double large = 0x1p38, small = 0x1p-40;
  for (int i = 0; i < 1000; i++) {
    conic_exact_add(&sum, large);
    conic_exact_add(&sum, -small);
  }
  for (int i = 0; i < 1000; i++)
    conic_exact_add(&sum, -large);
  CHECK_NEAR(conic_exact_value(sum), -1000.0 * small, 0.0);
  conic_exact_add(&sum, NAN);
  conic_exact_add(&sum, 1e30);
  CHECK_NEAR(conic_exact_value(sum), large, 1e-4);
  conic_exact_add(&sum, -(double)INFINITY);
  CHECK_NEAR(conic_exact_value(sum), -1000.0 * small, 0.0);
}

/* --- where samples look from --- */

static conic_camera some_camera(void) {
  conic_camera camera = {.width = 64, .height = 48, .fx = 70, .fy = 75, .cx = 33, .cy = 22};
  const double rows[3][4] = {{0.6, 0.0, 0.8, 1.0}, {0.0, 1.0, 0.0, 2.0}, {-0.8, 0.0, 0.6, 5.0}};
  memcpy(camera.cam_from_world, rows, sizeof rows);
  return camera;
}

static void project(const conic_camera *camera, const double world[3], double px[2]) {
  double p[3];
  for (int row = 0; row < 3; row++) {
    const double *m = camera->cam_from_world[row];
    p[row] = m[0] * world[0] + m[1] * world[1] + m[2] * world[2] + m[3];
  }
  px[0] = camera->fx * p[0] / p[2] + camera->cx;
  px[1] = camera->fy * p[1] / p[2] + camera->cy;
}

/* What is at the focus stays but for the place in the pixel; the polygon lies in the circle, is as large as it should
 * be, and is filled evenly. */
static void test_lens(conic_context *context) {
  const double point[3] = {0.3 * 0.6 - 0.8 * 2.0, -1.0, 0.3 * 0.8 + 0.6 * 2.0}; /* at depth 7 */
  const conic_camera camera = some_camera();
  double plain[2], moved[2];
  project(&camera, point, plain);
  for (int n_blades = 0; n_blades <= 6; n_blades += n_blades ? 1 : 3) {
    const conic_aperture aperture = {.diameter = 0.5, .focus = 7.0, .n_blades = n_blades};
    double square = 0.0, sums[2] = {0.0, 0.0};
    enum { N_PLACES = 1024 };
    for (uint64_t i = 0; i < N_PLACES; i++) {
      conic_sample sample;
      CHECK_OK(conic_sample_place(context, &camera, &aperture, i, &sample));
      project(&sample.camera, point, moved);
      for (int axis = 0; axis < 2; axis++) {
        CHECK_NEAR(moved[axis] - plain[axis], 0.5 - conic_sequence_at(i, axis), 1e-12);
        sums[axis] += sample.lens[axis] / N_PLACES;
      }
      double r2 = sample.lens[0] * sample.lens[0] + sample.lens[1] * sample.lens[1];
      CHECK(r2 <= 0.25 * 0.25 * (1.0 + 1e-12));
      square += r2 / N_PLACES;
    }
    double step = n_blades ? 6.28318530717958648 / n_blades : 0.0; /* the polar moment of a polygon over its area */
    double moment = 0.25 * 0.25 * (n_blades ? (2.0 + cos(step)) / 6.0 : 0.5);
    CHECK_NEAR(square, moment, 2e-4);
    CHECK(fabs(sums[0]) < 1e-3 && fabs(sums[1]) < 1e-3);
  }
  const conic_aperture wrong[] = {
      {.diameter = -1, .focus = 1}, {.diameter = 1}, {.diameter = 1, .focus = 1, .n_blades = 2}};
  conic_sample sample;
  for (int i = 0; i < 3; i++)
    CHECK(conic_sample_place(context, &camera, &wrong[i], 0, &sample) == CONIC_ERROR_ARGUMENT);
}

/* Ends are kept to the bit; halfway of a quarter turn is an eighth, and the eye is in the middle. */
static void test_between(conic_context *context) {
  conic_camera from = some_camera(), to = from, between;
  const double rows[3][4] = {{0.8, 0.0, -0.6, 3.0}, {0.0, 1.0, 0.0, 1.0}, {0.6, 0.0, 0.8, 0.0}};
  memcpy(to.cam_from_world, rows, sizeof rows);
  CHECK_OK(conic_camera_between(context, &from, &to, 1.0, &between));
  CHECK(memcmp(&between, &to, sizeof to) == 0);
  CHECK_OK(conic_camera_between(context, &from, &to, 0.5, &between));
  double sine = 0.5 * (0.8 - 0.6), cosine = 0.5 * (0.6 + 0.8), length = hypot(sine, cosine);
  CHECK_NEAR(between.cam_from_world[0][0], cosine / length, 1e-14);
  CHECK_NEAR(between.cam_from_world[0][2], sine / length, 1e-14);
  for (int axis = 0; axis < 3; axis++) {
    double eyes[3] = {0.0, 0.0, 0.0};
    for (int row = 0; row < 3; row++) {
      eyes[0] -= from.cam_from_world[row][axis] * from.cam_from_world[row][3];
      eyes[1] -= between.cam_from_world[row][axis] * between.cam_from_world[row][3];
      eyes[2] -= to.cam_from_world[row][axis] * to.cam_from_world[row][3];
    }
    CHECK_NEAR(eyes[1], 0.5 * (eyes[0] + eyes[2]), 1e-13);
  }
  to.width++;
  CHECK(conic_camera_between(context, &from, &to, 0.5, &between) == CONIC_ERROR_ARGUMENT);
}

/* --- the loop --- */

typedef struct loop {
  conic_context *context;
  uint64_t n_drawn, n_shaded, n_watched;
  float brightness;
} loop;

static conic_status draw_number(void *cookie, const conic_sample *sample, conic_image *image) {
  loop *l = cookie;
  l->n_drawn++;
  for (int i = 0; i < 4 * N_PIXELS; i++)
    ((float *)image->planes[CONIC_PLANE_RGBA])[i] = l->brightness * (float)sample->time;
  return CONIC_OK;
}

static conic_status shade_number(void *cookie, uint64_t i_sample, const conic_camera *camera, conic_image *image) {
  loop *l = cookie;
  l->n_shaded += camera->width == WIDTH && i_sample < N;
  for (int i = 0; i < 4 * N_PIXELS; i++)
    ((float *)image->planes[CONIC_PLANE_RGBA])[i] *= 2.0f;
  return CONIC_OK;
}

static conic_status watch_number(void *cookie, const conic_accumulation *sums) {
  loop *l = cookie;
  (void)sums;
  l->n_watched++;
  return CONIC_OK;
}

static void test_loop(conic_context *context) {
  loop l = {.context = context, .brightness = 1.0f};
  conic_accumulate_options options;
  conic_accumulation *sums;
  conic_accumulation_facts facts;
  conic_image image;
  conic_accumulate_options_init(&options);
  options.camera = some_camera();
  options.camera.width = WIDTH;
  options.camera.height = HEIGHT;
  options.end_sample = 33;
  options.cookie = &l;
  options.draw = draw_number;
  options.shade = shade_number;
  options.watch = watch_number;
  CHECK_OK(conic_image_allocate(context, WIDTH, HEIGHT, 1u << CONIC_PLANE_RGBA, &image));
  CHECK_OK(conic_accumulation_create(context, WIDTH, HEIGHT, 1u << CONIC_PLANE_RGBA, 0, &sums));
  CHECK_OK(conic_accumulate(context, &options, sums));
  CHECK(l.n_drawn == 33 && l.n_shaded == 33 && l.n_watched == 33);
  CHECK_OK(conic_accumulation_resolve(sums, &image));
  CHECK_NEAR((double)((float *)image.planes[CONIC_PLANE_RGBA])[9], 1.0, 0.05); /* twice the mean of the time */
  options.end_sample = N; /* it goes on, and looks at sample 0 again */
  CHECK_OK(conic_accumulate(context, &options, sums));
  CHECK(l.n_drawn == 33 + 1 + N - 33);
  l.brightness = 1.5f;
  options.end_sample++;
  CHECK(conic_accumulate(context, &options, sums) == CONIC_ERROR_ARGUMENT); /* another picture */
  conic_accumulation_destroy(sums);

  options.end_sample = 10000;
  options.noise = 0.02;
  CHECK_OK(conic_accumulation_create(context, WIDTH, HEIGHT, 1u << CONIC_PLANE_RGBA, 0, &sums));
  CHECK_OK(conic_accumulate(context, &options, sums));
  conic_accumulation_inspect(sums, &facts);
  CHECK((facts.end_sample & (facts.end_sample - 1)) == 0 && facts.end_sample >= 16 && facts.end_sample < 10000);
  CHECK(conic_accumulation_noise(sums) <= 0.02 && conic_accumulation_noise(sums) >= 0.0);
  options.noise = 0.0;
  options.seconds = 1e-9;
  CHECK_OK(conic_accumulate(context, &options, sums));
  conic_accumulation_inspect(sums, &facts);
  CHECK(facts.end_sample < 10000);
  conic_accumulation_destroy(sums);
  conic_image_release(context, &image);
}

int main(void) {
  conic_context *context = check_context(1), *threads = check_context(3);
  conic_accumulation *sums = sums_from(context, 0, N), *other = sums_from(threads, 0, N);
  uint64_t whole = hash_of(context, sums);
  CHECK(hash_of(threads, other) == whole);
  conic_accumulation_destroy(sums);
  conic_accumulation_destroy(other);
  test_exact();
  test_cuts(context, whole);
  test_refusals(context);
  test_file(context, whole);
  test_lens(context);
  test_between(context);
  test_loop(context);
  conic_context_destroy(context);
  conic_context_destroy(threads);
  return check_result();
}
