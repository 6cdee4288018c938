/* Edges and points out of focus and in motion, against what the lens and the shutter make of them exactly. */
#include "tests/support/check.h"

enum { WIDTH = 48, HEIGHT = 24, N_SAMPLES = 1024 };

static const double pi = 3.14159265358979323846;

/* A white shape before nothing, drawn by a camera that looks along z. */
typedef struct stage {
  conic_context *context;
  conic_renderer *renderer;
  conic_splats splats;
  conic_triangles triangles;
  conic_render_options options;
  conic_camera camera;
  double speed; /* of the camera to the right, world units a shutter */
} stage;

static conic_status draw_stage(void *cookie, const conic_sample *sample, conic_image *image) {
  const stage *s = cookie;
  const conic_drawing drawing = {.splats = &s->splats, .triangles = &s->triangles};
  return conic_render_drawing(s->context, s->renderer, &drawing, &sample->camera, &s->options, 1, image, NULL);
}

static conic_status move_stage(void *cookie, double time, conic_camera *camera) {
  const stage *s = cookie;
  *camera = s->camera;
  camera->cam_from_world[0][3] -= s->speed * time;
  return CONIC_OK;
}

static stage stage_make(int threads) {
  stage s = {.context = check_context(threads)};
  CHECK_OK(conic_renderer_create(s.context, &s.renderer));
  conic_render_options_init(&s.options);
  s.options.shading = CONIC_SHADE_NONE;
  s.options.near_z = 0.01;
  s.camera = (conic_camera){.width = WIDTH, .height = HEIGHT, .fx = 100, .fy = 100, .cx = 24, .cy = 12};
  for (int i = 0; i < 3; i++)
    s.camera.cam_from_world[i][i] = 1.0;
  return s;
}

static void stage_end(stage *s) {
  conic_splats_release(s->context, &s->splats);
  conic_triangles_release(s->context, &s->triangles);
  conic_renderer_destroy(s->renderer);
  conic_context_destroy(s->context);
}

/* The half plane to the right of x = tilt·y at depth 2, of two triangles that reach beyond the picture. */
static void add_edge(stage *s, float tilt) {
  static const uint32_t corners[2][3] = {{0, 1, 2}, {0, 2, 3}};
  const float x[4] = {-2.0f * tilt, 9.0f, 9.0f, 2.0f * tilt}, y[4] = {-2.0f, -2.0f, 2.0f, 2.0f};
  CHECK_OK(conic_triangles_allocate(s->context, 2, 4, 0, &s->triangles));
  memcpy(s->triangles.corners, corners, sizeof corners);
  for (int i = 0; i < 4; i++) {
    s->triangles.position[0][i] = x[i];
    s->triangles.position[1][i] = y[i];
    s->triangles.position[2][i] = 2.0f;
  }
}

static conic_image accumulate_stage(stage *s, const conic_aperture *aperture, uint64_t n_samples, double *noise) {
  conic_accumulate_options options;
  conic_accumulation *sums;
  conic_image image;
  conic_accumulate_options_init(&options);
  options.camera = s->camera;
  options.aperture = *aperture;
  options.end_sample = n_samples;
  options.cookie = s;
  options.camera_at = s->speed != 0.0 ? move_stage : NULL;
  options.draw = draw_stage;
  CHECK_OK(conic_accumulation_create(s->context, WIDTH, HEIGHT, 1u << CONIC_PLANE_RGBA, 0, &sums));
  CHECK_OK(conic_accumulate(s->context, &options, sums));
  CHECK_OK(conic_image_allocate(s->context, WIDTH, HEIGHT, 1u << CONIC_PLANE_RGBA, &image));
  CHECK_OK(conic_accumulation_resolve(sums, &image));
  *noise = conic_accumulation_noise(sums);
  conic_accumulation_destroy(sums);
  return image;
}

/* The part of the unit disc that is to the left of x. */
static double disc_part(double x) {
  if (fabs(x) >= 1.0)
    return x > 0.0;
  return 0.5 + (x * sqrt(1.0 - x * x) + asin(x)) / pi;
}

/* What an edge's blur makes of a place so many pixels inside it. */
typedef double edge_blur(double inside_px, double size_px);

static double lens_blur(double inside_px, double radius_px) {
  return disc_part(inside_px / radius_px);
}

static double motion_blur(double inside_px, double length_px) {
  double part = inside_px / length_px;
  return part < 0.0 ? 0.0 : part > 1.0 ? 1.0 : part;
}

/* Its mean over a pixel. */
static double blurred_pixel(edge_blur *blur, double size_px, double tilt, double steepness, int x, int y) {
  enum { N = 64 };
  double sum = 0.0;
  for (int j = 0; j < N; j++)
    for (int i = 0; i < N; i++) {
      double px = x + (i + 0.5) / N - 24.0, py = y + (j + 0.5) / N - 12.0;
      sum += blur((px - tilt * py) * steepness, size_px);
    }
  return sum / (N * N);
}

typedef struct errors {
  double largest, rms;
} errors;

static errors errors_of(const conic_image *image, const double *truth) {
  errors e = {0.0, 0.0};
  double n_blurred = 0.0;
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    double error = fabs((double)((const float *)image->planes[CONIC_PLANE_RGBA])[4 * i + 3] - truth[i]);
    e.largest = fmax(e.largest, error);
    e.rms += error * error;
    n_blurred += truth[i] > 0.0 && truth[i] < 1.0;
  }
  e.rms = sqrt(e.rms / n_blurred);
  return e;
}

/* Out of focus by 8 pixels: the lens's radius as it is seen at the focus, over the picture. */
static const conic_aperture wide = {.diameter = 0.64, .focus = 4.0};
static const double wide_px = 100.0 * 0.32 * (1.0 / 2.0 - 1.0 / 4.0);

static errors edge_errors(const conic_aperture *aperture, double speed, float tilt, uint64_t n_samples) {
  double truth[WIDTH * HEIGHT], noise;
  stage s = stage_make(2);
  add_edge(&s, tilt);
  s.speed = speed;
  double length_px = fabs(speed) / 2.0 * 100.0;
  conic_image image = accumulate_stage(&s, aperture, n_samples, &noise);
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++) {
      double in_motion = speed != 0.0 ? blurred_pixel(motion_blur, length_px, (double)tilt, 1.0, x, y) : 0.0;
      truth[y * WIDTH + x] =
          speed != 0.0 ? in_motion
                       : blurred_pixel(lens_blur, wide_px, (double)tilt, 1.0 / sqrt(1.0 + (double)(tilt * tilt)), x, y);
    }
  errors e = errors_of(&image, truth);
  fprintf(stderr, "%s tilt %g, %llu samples: largest %.2e, rms %.2e, noise %.2e\n", speed != 0.0 ? "motion" : "lens",
          (double)tilt, (unsigned long long)n_samples, e.largest, e.rms, noise);
  conic_image_release(s.context, &image);
  stage_end(&s);
  return e;
}

/* The part of a disc of radius `a` that another of radius `b` covers, whose centre is so far away. */
static double disc_overlap(double distance, double a, double b) {
  if (distance >= a + b)
    return 0.0;
  if (distance <= fabs(b - a))
    return b >= a ? 1.0 : b * b / (a * a);
  double ca = (distance * distance + a * a - b * b) / (2.0 * distance * a);
  double cb = (distance * distance + b * b - a * a) / (2.0 * distance * b);
  double kite = 0.5 * sqrt((a + b - distance) * (distance + a - b) * (distance - a + b) * (distance + a + b));
  return (a * a * acos(ca) + b * b * acos(cb) - kite) / (pi * a * a);
}

static errors point_errors(uint64_t n_samples) {
  double truth[WIDTH * HEIGHT], noise;
  const double radius_px = 1.5;
  stage s = stage_make(2);
  CHECK_OK(conic_splats_allocate(s.context, 1, CONIC_SPLATS_TANGENTS, &s.splats));
  s.options.method = CONIC_METHOD_DISC;
  s.options.kernel.type = CONIC_KERNEL_BOX;
  s.splats.position[0][0] = s.splats.position[1][0] = 0.0f;
  s.splats.position[2][0] = 2.0f;
  s.splats.tangent_u[1][0] = s.splats.tangent_u[2][0] = s.splats.tangent_v[0][0] = s.splats.tangent_v[2][0] = 0.0f;
  s.splats.tangent_u[0][0] = s.splats.tangent_v[1][0] = (float)(radius_px / 1.5 / 100.0 * 2.0);
  conic_image image = accumulate_stage(&s, &wide, n_samples, &noise);
  for (int p = 0; p < WIDTH * HEIGHT; p++) {
    enum { N = 32 };
    truth[p] = 0.0;
    for (int k = 0; k < N * N; k++)
      truth[p] += disc_overlap(hypot(p % WIDTH + (k % N + 0.5) / N - 24.0, p / WIDTH + (k / N + 0.5) / N - 12.0),
                               wide_px, radius_px) /
                  (N * N);
  }
  errors e = errors_of(&image, truth);
  fprintf(stderr, "point, %llu samples: largest %.2e, rms %.2e, noise %.2e\n", (unsigned long long)n_samples, e.largest,
          e.rms, noise);
  conic_image_release(s.context, &image);
  stage_end(&s);
  return e;
}

/* With 64 times as many samples, errors are 64^-0.65 of what they were, and small. Edges in three and four dimensions
 * cannot do better than N^-2/3 and N^-5/8 (docs/reference/accumulation.md). */
static void check_errors(errors few, errors many) {
  CHECK(many.rms <= few.rms * pow(64.0, -0.65));
  CHECK(many.rms <= 2.5e-3 && many.largest <= 1e-2);
}

int main(void) {
  static const conic_aperture pinhole = {0};
  for (int i = 0; i < 2; i++) {
    float tilt = i ? 0.3f : 0.0f;
    check_errors(edge_errors(&wide, 0.0, tilt, N_SAMPLES / 64), edge_errors(&wide, 0.0, tilt, N_SAMPLES));
    check_errors(edge_errors(&pinhole, -0.25, tilt, N_SAMPLES / 64), edge_errors(&pinhole, -0.25, tilt, N_SAMPLES));
  }
  check_errors(point_errors(N_SAMPLES / 64), point_errors(N_SAMPLES));
  return check_result();
}
