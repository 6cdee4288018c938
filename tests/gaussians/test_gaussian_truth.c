/* What has a closed form: harmonics degree by degree, and the truth of one and two Gaussians. */
#include "gaussians/scene/harmonics.h"
#include "oracle/gaussians/oracle_gaussian.h"
#include "tests/support/check.h"
#include "tests/support/gaussian_picture.h"

enum { SIDE = 5, MIDDLE = 2 * SIDE + 2 };

static const double pi = 3.14159265358979323846;

static double factorial(int n) {
  return n < 2 ? 1.0 : n * factorial(n - 1);
}

/* Legendre's associated function of degree l and order m at cos θ, by its sum, with Condon and Shortley's sign. */
static double legendre_by_sum(int l, int m, double theta) {
  double sum = 0.0, x = cos(theta);
  for (int k = 0; 2 * k <= l - m; k++)
    sum += (k % 2 ? -1.0 : 1.0) * factorial(2 * l - 2 * k) /
           (factorial(k) * factorial(l - k) * factorial(l - m - 2 * k)) * pow(x, l - m - 2 * k);
  return (m % 2 ? -1.0 : 1.0) * pow(sin(theta), m) * sum / pow(2.0, l);
}

static double harmonic_by_angles(int l, int m, double theta, double phi) {
  int order = abs(m);
  double norm = sqrt((2 * l + 1) / (4.0 * pi) * factorial(l - order) / factorial(l + order));
  return norm * legendre_by_sum(l, order, theta) *
         (m == 0 ? 1.0 : sqrt(2.0) * (m > 0 ? cos(order * phi) : sin(order * phi)));
}

static void test_harmonics(void) {
  double apart[CONIC_MAX_SH_DEGREE + 1] = {0};
  for (int i = 0; i < 400; i++) {
    double theta = pi * (i % 20 + 0.37) / 20.0, phi = 2.0 * pi * ((i / 20) + 0.19) / 20.0, y[25];
    const double d[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
    conic_harmonics_evaluate(d, CONIC_MAX_SH_DEGREE, y);
    for (int l = 0, k = 0; l <= CONIC_MAX_SH_DEGREE; l++)
      for (int m = -l; m <= l; m++, k++) {
        double wanted = harmonic_by_angles(l, m, theta, phi), sh[75] = {0}, color[3];
        sh[3 * k] = 0.2; /* ½ + 0.2·Y is over 0 */
        conic_oracle_harmonics(sh, CONIC_MAX_SH_DEGREE, d, color);
        apart[l] = fmax(apart[l], fmax(fabs(y[k] - wanted), fabs((color[0] - 0.5) / 0.2 - wanted)));
      }
  }
  for (int l = 0; l <= CONIC_MAX_SH_DEGREE; l++) {
    printf("harmonics of degree %d: %.2g\n", l, apart[l]);
    CHECK(apart[l] <= 1e-14);
  }
}

/* The colour of a Gaussian that is seen aside, whose harmonics are all of one degree. */
static void test_harmonics_in_picture(conic_context *context) {
  for (int degree = 0; degree <= CONIC_MAX_SH_DEGREE; degree++) {
    conic_gaussians scene = gaussians_random(context, 1, degree, 0);
    const double d[3] = {3.0 / 13.0, -4.0 / 13.0, 12.0 / 13.0}, theta = acos(d[2]), phi = atan2(d[1], d[0]);
    conic_camera camera = {.width = SIDE, .height = SIDE, .fx = 8.0, .fy = 8.0, .cx = 0.5, .cy = 4.5};
    for (int axis = 0; axis < 3; axis++) {
      camera.cam_from_world[axis][axis] = 1.0;
      scene.position[axis][0] = (float)(13.0 * d[axis]); /* on the screen at (2.5, 1.833) */
      scene.scale[axis][0] = 4.0f;
    }
    scene.opacity[0] = 0.9f;
    for (size_t k = 0; k < conic_harmonics_of_degree(degree); k++)
      if (k < (size_t)(3 * degree * degree))
        scene.sh[k] = 0.0f;
    conic_gaussian_planes p = picture_draw(context, &scene, &camera, CONIC_PROFILE_EXACT, CONIC_ISA_AUTO);
    const size_t at = 1 * SIDE + 2;
    for (int c = 0; c < 3; c++) {
      double sum = 0.5;
      for (int m = -degree; m <= degree; m++)
        sum += harmonic_by_angles(degree, m, theta, phi) * (double)scene.sh[3 * (degree * degree + degree + m) + c];
      CHECK_NEAR((double)p.rgb[3 * at + (size_t)c] / (1.0 - (double)p.transparency[at]), fmax(sum, 0.0), 1e-6);
    }
    picture_release(&p);
    conic_gaussians_release(context, &scene);
  }
}

/* Balls on the axis before an eye at the origin. */
static conic_gaussians make_balls(conic_context *context, size_t n, const double (*balls)[6]) {
  conic_gaussians scene = gaussians_random(context, n, 0, 0);
  for (size_t i = 0; i < n; i++) {
    scene.opacity[i] = (float)balls[i][2];
    for (int k = 0; k < 3; k++) {
      scene.position[k][i] = k == 2 ? (float)balls[i][0] : 0.0f;
      scene.scale[k][i] = (float)balls[i][1];
      scene.sh[3 * i + (size_t)k] = (float)((balls[i][3 + k] - 0.5) / 0.28209479177387814);
    }
    for (int k = 0; k < 4; k++)
      scene.rotation[k][i] = k == 0;
  }
  return scene;
}

static conic_gaussian_reference truth_of(conic_context *context, const conic_gaussians *scene,
                                         conic_gaussian_question question) {
  conic_camera camera = {.width = SIDE, .height = SIDE, .fx = 8.0, .fy = 8.0, .cx = 2.5, .cy = 2.5};
  for (int axis = 0; axis < 3; axis++)
    camera.cam_from_world[axis][axis] = 1.0;
  return picture_reference(context, scene, &camera, CONIC_PROFILE_EXACT, question);
}

/* z, standard deviation, opacity, colour */
static const double one[1][6] = {{4.0, 0.3, 0.7, 0.8, 0.3, 0.1}};

/* A ball hides o^…: by overlap the opacity of `exact`, by volume 1 − (1 − o)^(e^(−q/2)), o in the middle of both. */
static void test_one(conic_context *context) {
  conic_gaussians scene = make_balls(context, 1, one);
  const double o = (double)scene.opacity[0], s = (double)scene.scale[0][0];
  for (int question = CONIC_GAUSSIAN_OVERLAP; question <= CONIC_GAUSSIAN_VOLUME; question++) {
    conic_gaussian_reference r = truth_of(context, &scene, (conic_gaussian_question)question);
    for (int x = 0; x < SIDE; x++) {
      double slope = (x - 2) / 8.0, q = 16.0 * slope * slope / (1.0 + slope * slope) / (s * s),
             response = exp(-0.5 * q);
      double alpha = question == CONIC_GAUSSIAN_OVERLAP ? o * response : 1.0 - pow(1.0 - o, response);
      CHECK_NEAR(1.0 - r.transparency[2 * SIDE + x], alpha, 1e-12);
      for (int c = 0; c < 3; c++)
        CHECK_NEAR(r.rgb[3 * (2 * SIDE + x) + c], alpha * one[0][3 + c], 1e-7); /* the colour is a float's */
    }
    conic_gaussian_reference_release(context, &r);
  }
  conic_gaussians_release(context, &scene);
}

/* Emission and absorption of two densities on a ray, by Simpson's rule with the C library's error function. */
static void integrate_two(const double (*balls)[6], double color[3]) {
  enum { STEPS = 20000 };
  const double from = 0.0, to = 12.0, step = (to - from) / STEPS;
  color[0] = color[1] = color[2] = 0.0;
  for (int i = 0; i <= STEPS; i++) {
    double z = from + i * step, depth = 0.0, density[2];
    for (int k = 0; k < 2; k++) {
      double u = (z - balls[k][0]) / balls[k][1], tau = -log(1.0 - balls[k][2]);
      depth += tau * 0.5 * erfc(-u / sqrt(2.0));
      density[k] = tau * exp(-0.5 * u * u) / (sqrt(2.0 * pi) * balls[k][1]);
    }
    for (int c = 0; c < 3; c++)
      color[c] += (i == 0 || i == STEPS ? 1.0
                   : i % 2              ? 4.0
                                        : 2.0) *
                  step / 3.0 * exp(-depth) * (density[0] * balls[0][3 + c] + density[1] * balls[1][3 + c]);
  }
}

/* Far from each other, one behind the other; at one place, mixed by optical depth; in between, the integral. T is the
 * product in all cases, and where both have one colour, so is what they show. */
static void test_two(conic_context *context) {
  static const double pairs[5][2][6] = {
      {{3.0, 0.1, 0.6, 0.9, 0.1, 0.3}, {6.0, 0.1, 0.5, 0.2, 0.8, 0.4}},
      {{4.0, 0.3, 0.6, 0.9, 0.1, 0.3}, {4.0, 0.3, 0.5, 0.2, 0.8, 0.4}},
      {{4.0, 0.3, 0.6, 0.9, 0.1, 0.3}, {4.2, 0.3, 0.5, 0.2, 0.8, 0.4}},
      {{4.3, 0.5, 0.9, 0.9, 0.1, 0.3}, {4.2, 0.1, 0.8, 0.2, 0.8, 0.4}},
      {{4.0, 0.3, 0.6, 0.9, 0.1, 0.3}, {4.1, 0.2, 0.5, 0.9, 0.1, 0.3}},
  };
  for (int k = 0; k < 5; k++) {
    const double(*b)[6] = pairs[k];
    conic_gaussians scene = make_balls(context, 2, b);
    double wanted[3], rest[2];
    for (int i = 0; i < 2; i++)
      rest[i] = 1.0 - b[i][2];
    integrate_two(b, wanted);
    for (int question = CONIC_GAUSSIAN_OVERLAP; question <= CONIC_GAUSSIAN_VOLUME; question++) {
      conic_gaussian_reference r = truth_of(context, &scene, (conic_gaussian_question)question);
      CHECK_NEAR(r.transparency[MIDDLE], rest[0] * rest[1], 2e-7);
      for (int c = 0; c < 3; c++) {
        double share = log(rest[0]) / log(rest[0] * rest[1]), closed = wanted[c];
        if (k == 0)
          closed = b[0][2] * b[0][3 + c] + rest[0] * b[1][2] * b[1][3 + c];
        if (k == 1)
          closed = (1.0 - rest[0] * rest[1]) * (share * b[0][3 + c] + (1.0 - share) * b[1][3 + c]);
        if (k == 4)
          closed = (1.0 - rest[0] * rest[1]) * b[0][3 + c];
        CHECK_NEAR(closed, wanted[c], 1e-9);
        CHECK_NEAR(r.rgb[3 * MIDDLE + c], closed, 2e-7); /* numbers of the scene are floats */
      }
      CHECK(r.quadrature <= 1e-10);
      conic_gaussian_reference_release(context, &r);
    }
    conic_gaussians_release(context, &scene);
  }
}

int main(void) {
  conic_context *context = check_context(1);
  test_harmonics();
  test_harmonics_in_picture(context);
  test_one(context);
  test_two(context);
  conic_context_destroy(context);
  return check_result();
}
