/* The order of the error (PSS Eq. 7): with h and the spacing halved together, a surface of degree m comes nearer to the
 * sampled one by 2^(m+1) at least. Even degrees gain one order more where the samples lie evenly about a point. */
#include "tests/support/surface_shapes.h"

/* The order is that of a limit; between two values of h that are not yet small it may be a little less. */
static const double SLACK = 0.15;

/* Of the gyroid, only what has neighbours all around is looked at. */
static int is_inside(shape s, const double p[3]) {
  return s != SHAPE_GYROID ||
         (p[0] > 0.0 && p[0] < gyroid_cell && p[1] > 0.0 && p[1] < gyroid_cell && p[2] > 0.0 && p[2] < gyroid_cell);
}

/* With h in spacings; *failed is the share of points without a projection. */
static double rms_error(conic_context *context, shape s, size_t n, double noise, double h,
                        const conic_surface_options *given, double *failed) {
  conic_splats samples = shape_sample(context, s, n, noise, 7);
  conic_surface_options options = *given;
  conic_surface_point *points;
  double sum2 = 0.0;
  size_t n_done = 0, n_failed = 0;
  options.h = h * shape_spacing(s, n);
  conic_surface *surface = shape_surface(context, &samples, &options);
  size_t n_points = shape_project(surface, &samples, n / 1000, &points);
  for (size_t i = 0; i < n_points; i++) {
    if (!is_inside(s, points[i].position))
      continue;
    n_failed += points[i].outcome != CONIC_SURFACE_DONE;
    if (points[i].outcome != CONIC_SURFACE_DONE)
      continue;
    double normal[3], distance = shape_distance(s, points[i].position, normal);
    n_done++;
    sum2 += distance * distance;
  }
  *failed = (double)n_failed / (double)(n_done + n_failed);
  free(points);
  conic_surface_destroy(surface);
  conic_splats_release(context, &samples);
  return sqrt(sum2 / (double)n_points);
}

static const char *const shape_names[] = {"sphere", "torus", "gyroid"};

static void check_order(conic_context *context, shape s, const conic_surface_options *options, double least) {
  size_t n = s == SHAPE_GYROID ? 30000 : 4000;
  double coarse_failed, fine_failed;
  double coarse = rms_error(context, s, n, 0.0, 3.0, options, &coarse_failed);
  double fine = rms_error(context, s, 4 * n, 0.0, 3.0, options, &fine_failed);
  double order = log(coarse / fine) / log(2.0);
  printf("%s, %s, %s, degree %d: error %.3g at h, %.3g at h/2: order %.2f\n", shape_names[s],
         options->type == CONIC_SURFACE_MLS ? "mls" : "apss", options->plane == CONIC_PLANE_FULL ? "full" : "fast",
         options->degree, coarse, fine, order);
  CHECK(order >= least);
  CHECK(coarse_failed <= 0.002 && fine_failed <= 0.002);
}

static void check_orders(conic_context *context) {
  conic_surface_options options;
  double failed;
  conic_surface_options_init(&options);
  options.neglect = 2.5;
  for (int s = SHAPE_SPHERE; s <= SHAPE_GYROID; s++)
    for (int plane = CONIC_PLANE_FULL; plane <= CONIC_PLANE_FAST; plane++)
      for (options.degree = 1; options.degree <= 4; options.degree++) {
        if (s == SHAPE_GYROID && plane == CONIC_PLANE_FAST)
          continue;
        options.plane = (conic_surface_plane)plane;
        check_order(context, (shape)s, &options, options.degree + 1.0 - SLACK);
      }
  options.degree = 1;
  options.type = CONIC_SURFACE_APSS;
  options.plane = CONIC_PLANE_FULL;
  check_order(context, SHAPE_TORUS, &options, 1.95);
  CHECK(rms_error(context, SHAPE_SPHERE, 4000, 0.0, 3.0, &options, &failed) < 1e-6); /* its own algebraic sphere */
}

/* Noise of half a spacing: what is left of it, in spacings, over h. Normals are the true ones, which flatters APSS. */
static void check_noise(conic_context *context) {
  const size_t n = 16000;
  const double unit = shape_spacing(SHAPE_TORUS, n);
  conic_surface_options options;
  conic_surface_options_init(&options);
  for (int type = CONIC_SURFACE_MLS; type <= CONIC_SURFACE_APSS; type++)
    for (options.degree = 1; options.degree <= (type == CONIC_SURFACE_MLS ? 4 : 1); options.degree++) {
      options.type = (conic_surface_type)type;
      printf("noisy torus, %s, degree %d: h, left, failed:", type == CONIC_SURFACE_MLS ? "mls" : "apss",
             options.degree);
      for (double h = 1.5; h < 7.0; h += h < 2.0 ? 0.5 : h < 4.0 ? 1.0 : 2.0) {
        double failed, left = rms_error(context, SHAPE_TORUS, n, 0.5, h, &options, &failed) / unit;
        printf("  %.1f %.3f %.1f%%", h, left, 100.0 * failed);
        if (options.degree >= 2)
          CHECK(left < 0.4);
        if (h >= 4.0 && options.degree >= 2)
          CHECK(left < 0.2 && failed < 0.01);
      }
      printf("\n");
    }
}

int main(void) {
  conic_context *context = check_context(2);
  check_orders(context);
  check_noise(context);
  conic_context_destroy(context);
  return check_result();
}
