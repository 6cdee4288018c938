/* Kernels against the C library's: the error bound of the exponential, and Confetti's printed formula against ours. */
#include "core/splats/kernel.h"
#include "tests/support/check.h"

static void test_exponential(void) {
  double worst = 0.0;
  for (int i = 0; i <= 4000000; i++) {
    float x = -(float)i * 2e-5f;
    double exact = exp((double)x), ulp = ldexp(1.0, ilogb(exact) - 23);
    double error = fabs((double)conic_exp_negative(x) - exact) / ulp;
    worst = error > worst ? error : worst;
  }
  printf("largest error of the exponential: %.3f ulp\n", worst);
  CHECK(worst <= 1.1);
  CHECK(conic_exp_negative(0.0f) == 1.0f);
  CHECK(conic_exp_negative(-1e30f) == conic_exp_negative(-80.0f));
  CHECK(conic_exp_negative((float)NAN) == conic_exp_negative(-80.0f));
}

static void test_narrow_gaussian(void) {
  double worst = 0.0;
  for (int i = 0; i <= 2250000; i++) {
    float q = (float)i * 1e-6f;
    double exact = exp(-0.5 * (double)q), error = fabs((double)conic_gauss_narrow(q) / exact - 1.0);
    worst = error > worst ? error : worst;
  }
  printf("largest relative error of the narrow Gaussian: %.3g\n", worst);
  CHECK(worst <= 2.4e-7);
  CHECK(conic_gauss_narrow(0.0f) == 1.0f);
}

/* As printed, without the division by b, Eq. 10 is neither 1 at 0 nor 0 at b. */
static double confetti_as_printed(double a, double b, int n, double r) {
  double t = pow(r - b, n);
  return exp(-a * t / (1.0 - t));
}

static void test_confetti(void) {
  conic_kernel kernel = {CONIC_KERNEL_CONFETTI, 1.5f, 4.0f, 1.5f, 5};
  CHECK(fabs(confetti_as_printed(4.0, 1.5, 5, 0.0) - 1.0) > 10.0);
  CHECK_NEAR(conic_kernel_value(&kernel, 0.0f), 1.0, 0.0);
  CHECK(conic_kernel_value(&kernel, 2.2499f) < 1e-30f);
  CHECK_NEAR(conic_kernel_value(&kernel, 1.0f), exp(-4.0 * pow(1 / 1.5, 5) / (1.0 - pow(1 / 1.5, 5))), 1e-6);
  float before = 2.0f;
  for (float q = 0.0f; q < 2.25f; q += 0.01f) {
    float value = conic_kernel_value(&kernel, q);
    CHECK(value <= before && value >= 0.0f);
    before = value;
  }
  kernel.b = 1.0f;
  CHECK(conic_kernel_support(&kernel) == 1.0f);
  kernel.b = 3.0f;
  CHECK(conic_kernel_support(&kernel) == 2.25f);
}

static void test_others(void) {
  conic_kernel hat = {CONIC_KERNEL_HAT, 2.0f, 0, 0, 0}, box = {CONIC_KERNEL_BOX, 2.0f, 0, 0, 0};
  CHECK(conic_kernel_value(&hat, 0.0f) == 1.0f && conic_kernel_value(&hat, 1.0f) == 0.5f);
  CHECK(conic_kernel_value(&box, 3.9f) == 1.0f);
}

int main(void) {
  test_exponential();
  test_narrow_gaussian();
  test_confetti();
  test_others();
  return check_result();
}
