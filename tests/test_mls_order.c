/* The order of the error (PSS Eq. 7): with h and the spacing halved together, a surface of degree m comes nearer to the
 * sampled one by 2^(m+1) at least. Even degrees gain one order more where the samples lie evenly about a point. */
#include "tests/surface_shapes.h"

static double rms_error(conic_context *context, shape s, size_t n, const conic_surface_options *given) {
  conic_splats samples = shape_sample(context, s, n, 0.0, 7);
  conic_surface_options options = *given;
  conic_surface_point *points;
  double sum2 = 0.0;
  size_t n_done = 0;
  options.h = 3.0 * shape_spacing(s, n);
  conic_surface *surface = shape_surface(context, &samples, &options);
  size_t n_points = shape_project(surface, &samples, n / 500, &points);
  for (size_t i = 0; i < n_points; i++) {
    double normal[3], distance = shape_distance(s, points[i].position, normal);
    n_done += points[i].outcome == CONIC_SURFACE_DONE;
    sum2 += distance * distance;
  }
  CHECK(n_done == n_points);
  free(points);
  conic_surface_destroy(surface);
  conic_splats_release(context, &samples);
  return sqrt(sum2 / (double)n_points);
}

static void check_order(conic_context *context, shape s, const conic_surface_options *options, double least) {
  double coarse = rms_error(context, s, 4000, options), fine = rms_error(context, s, 16000, options);
  double order = log(coarse / fine) / log(2.0);
  printf("%s, %s, %s, degree %d: error %.3g at h, %.3g at h/2: order %.2f\n", s == SHAPE_SPHERE ? "sphere" : "torus",
         options->type == CONIC_SURFACE_MLS ? "mls" : "apss", options->plane == CONIC_PLANE_FULL ? "full" : "fast",
         options->degree, coarse, fine, order);
  CHECK(order >= least);
}

int main(void) {
  conic_context *context = check_context(2);
  conic_surface_options options;
  conic_surface_options_init(&options);
  options.neglect = 2.5;
  for (int s = SHAPE_SPHERE; s <= SHAPE_TORUS; s++)
    for (int plane = CONIC_PLANE_FULL; plane <= CONIC_PLANE_FAST; plane++)
      for (options.degree = 1; options.degree <= 4; options.degree++) {
        options.plane = (conic_surface_plane)plane;
        check_order(context, (shape)s, &options, options.degree + 1.0 - 0.05);
      }
  options.degree = 1;
  options.type = CONIC_SURFACE_APSS;
  check_order(context, SHAPE_TORUS, &options, 1.95);
  CHECK(rms_error(context, SHAPE_SPHERE, 4000, &options) < 1e-6); /* a sphere is its own algebraic sphere */
  conic_context_destroy(context);
  return check_result();
}
