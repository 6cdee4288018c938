/* Kernels that are no Gaussian under the prefilter: the weights of one splat against the convolution, summed up here,
 * from a quarter of a pixel to 64, from frontal to edge-on. */
#include "tests/support/fixture.h"

enum { N_STEPS = 160, SIZE = 256 };

static const double pi = 3.14159265358979323846, filter_reach = 5.0;

/* A kernel and what is asked of it. */
typedef struct kind {
  const char *name;
  conic_kernel kernel;
  double bound; /* of the error over the peak */
} kind;

static const kind kinds[] = {{"hat", {CONIC_KERNEL_HAT, 1.5f, 0, 0, 0}, 0.01},
                             {"confetti:6,1.5,3", {CONIC_KERNEL_CONFETTI, 1.5f, 6.0f, 1.5f, 3}, 0.02},
                             {"confetti:4,1.5,5", {CONIC_KERNEL_CONFETTI, 1.5f, 4.0f, 1.5f, 5}, 0.02},
                             {"confetti:4,1,5", {CONIC_KERNEL_CONFETTI, 1.5f, 4.0f, 1.0f, 5}, 0.02},
                             {"hat, cutoff 3", {CONIC_KERNEL_HAT, 3.0f, 0, 0, 0}, 0.02},
                             {"box", {CONIC_KERNEL_BOX, 1.5f, 0, 0, 0}, 0.03}};

/* Splats that are narrower have polynomials, which are nearer. */
static const double smooth_px = 3.8, smooth_bound = 0.01;

static double kernel_at(const conic_kernel *kernel, double r) {
  double end = kernel->type == CONIC_KERNEL_CONFETTI ? (double)kernel->b : (double)kernel->cutoff, part = r / end;
  if (!(part < 1.0))
    return 0.0;
  if (kernel->type == CONIC_KERNEL_BOX)
    return 1.0;
  if (kernel->type == CONIC_KERNEL_HAT)
    return 1.0 - part;
  double power = pow(part, kernel->n);
  return exp(-(double)kernel->a * power / (1.0 - power));
}

/* One axis of the sum: places in standard deviations of the splat, and the filter's weights there. Steps are the
 * filter's where the splat is the wider, and else the splat's own. */
static void fill_axis(const conic_kernel *kernel, double sigma_px, double offset_px, double places[N_STEPS],
                      double weights[N_STEPS]) {
  double end = kernel->type == CONIC_KERNEL_CONFETTI ? (double)kernel->b : (double)kernel->cutoff;
  for (int i = 0; i < N_STEPS; i++) {
    double middle = 2.0 * (i + 0.5) / N_STEPS - 1.0, step, from_pixel;
    if (sigma_px >= 1.0) {
      from_pixel = filter_reach * middle;
      places[i] = (offset_px + from_pixel) / sigma_px;
      step = 2.0 * filter_reach / N_STEPS;
    } else {
      places[i] = end * middle;
      from_pixel = places[i] * sigma_px - offset_px;
      step = 2.0 * end * sigma_px / N_STEPS;
    }
    weights[i] = step * exp(-0.5 * from_pixel * from_pixel) / sqrt(2.0 * pi);
  }
}

static double convolve_kernel(const conic_kernel *kernel, const double sigma_px[2], const double offset_px[2]) {
  double places[2][N_STEPS], weights[2][N_STEPS], sum = 0.0;
  for (int axis = 0; axis < 2; axis++)
    fill_axis(kernel, sigma_px[axis], offset_px[axis], places[axis], weights[axis]);
  for (int i = 0; i < N_STEPS; i++)
    for (int j = 0; j < N_STEPS; j++)
      sum += weights[0][i] * weights[1][j] * kernel_at(kernel, hypot(places[0][i], places[1][j]));
  return sum;
}

static const double center_px[2] = {0.5 * SIZE + 0.3, 0.5 * SIZE - 0.1}, turn = 0.4;

/* Draws a splat of so many pixels, tilted about its longer axis. */
static void draw_splat(fixture *f, double sigma_px, double cosine) {
  const double focal = 2e5, c = cos(turn), s = sin(turn), size = sigma_px / focal;
  const double p[3] = {(center_px[0] - 0.5 * SIZE) / focal, (center_px[1] - 0.5 * SIZE) / focal, 1.0};
  const double u[3] = {c * size, s * size, 0.0};
  const double v[3] = {-s * size * cosine, c * size * cosine, size * sqrt(1.0 - cosine * cosine)};
  fixture_camera(f, SIZE, SIZE, focal);
  fixture_splats(f, 1);
  fixture_set(f, 0, p, u, v, 1.0f, 1.0f, 1.0f);
  f->options.near_z = 1e-3;
  fixture_render(f);
}

/* The largest error over the peak. */
static double error_of(const fixture *f, const kind *k, double sigma_px, double cosine) {
  const double sigma[2] = {sigma_px, sigma_px * cosine}, origin[2] = {0.0, 0.0};
  double worst = 0.0, peak = convolve_kernel(&k->kernel, sigma, origin);
  int n = 0, i_covered = 0, stride;
  const float *weights = f->image.planes[CONIC_PLANE_WEIGHT];
  for (int i = 0; i < SIZE * SIZE; i++)
    n += weights[i] > 0.0f;
  CHECK(n > 0);
  stride = 1 + n / 24;
  for (int i = 0; i < SIZE * SIZE; i++) {
    if (!(weights[i] > 0.0f) || i_covered++ % stride != 0)
      continue;
    double dx = i % SIZE + 0.5 - center_px[0], dy = i / SIZE + 0.5 - center_px[1];
    const double offset[2] = {cos(turn) * dx + sin(turn) * dy, cos(turn) * dy - sin(turn) * dx};
    double error = fabs((double)weights[i] - convolve_kernel(&k->kernel, sigma, offset)) / peak;
    worst = error > worst ? error : worst;
  }
  return worst;
}

static void test_against_convolution(fixture *f, const kind *k) {
  static const double sigmas[] = {0.25, 0.5, 1.0, 2.0, 4.0, 16.0, 64.0}, cosines[] = {1.0, 0.7, 0.3, 0.1, 0.01};
  static const conic_method methods[] = {CONIC_METHOD_CONIC, CONIC_METHOD_AFFINE, CONIC_METHOD_RAY, CONIC_METHOD_AUTO};
  double worst = 0.0;
  f->options.kernel = k->kernel;
  for (size_t i = 0; i < sizeof sigmas / sizeof *sigmas; i++)
    for (size_t j = 0; j < sizeof cosines / sizeof *cosines; j++) {
      f->options.method = methods[(i + j) % 4];
      draw_splat(f, sigmas[i], cosines[j]);
      double error = error_of(f, k, sigmas[i], cosines[j]), bound = sigmas[i] < smooth_px ? smooth_bound : k->bound;
      if (!(error <= bound))
        printf("%s, σ %g px, cosine %g: %.4f of the peak\n", k->name, sigmas[i], cosines[j], error);
      CHECK(error <= bound);
      worst = error > worst ? error : worst;
    }
  printf("%s: at most %.4f of the peak\n", k->name, worst);
}

/* Without a prefilter and without end, it is the kernel itself. */
static void test_plain_kernel(fixture *f, const kind *k) {
  for (int is_wide = 0; is_wide < 2; is_wide++) {
    f->options.kernel = k->kernel;
    f->options.method = CONIC_METHOD_CONIC;
    f->options.prefilter = is_wide ? 1e-6f : 0.0f;
    draw_splat(f, 16.0, 0.7);
    const float *weights = f->image.planes[CONIC_PLANE_WEIGHT];
    double worst = 0.0;
    for (int i = 0; i < SIZE * SIZE; i++) {
      double dx = i % SIZE + 0.5 - center_px[0], dy = i / SIZE + 0.5 - center_px[1];
      double u = (cos(turn) * dx + sin(turn) * dy) / 16.0, v = (cos(turn) * dy - sin(turn) * dx) / (16.0 * 0.7);
      double error = fabs((double)weights[i] - kernel_at(&k->kernel, hypot(u, v)));
      if (weights[i] > 0.0f && hypot(u, v) < 0.98 * (double)k->kernel.cutoff)
        worst = error > worst ? error : worst;
    }
    CHECK(worst <= (is_wide ? 0.015 : 1e-3));
  }
  f->options.prefilter = 1.0f;
}

int main(void) {
  fixture f = fixture_open(2);
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
    test_against_convolution(&f, &kinds[i]);
    test_plain_kernel(&f, &kinds[i]);
  }
  fixture_close(&f);
  return check_result();
}
