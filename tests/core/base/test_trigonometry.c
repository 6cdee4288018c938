/* Own sine, cosine, tangent against the C library's; own sRGB against pow. */
#include "core/base/color.h"
#include "core/base/trigonometry.h"
#include "tests/support/check.h"

int main(void) {
  float table[256], thresholds[255];
  for (int i = -40000; i <= 40000; i++) {
    double x = (double)i * 0.00137 + (double)(i % 7) * 1e-9;
    CHECK_NEAR(conic_sin(x), sin(x), 2.3e-16);
    CHECK_NEAR(conic_cos(x), cos(x), 2.3e-16);
  }
  for (int i = -1000; i <= 1000; i++)
    CHECK_NEAR(conic_sin((double)i * 97.31), sin((double)i * 97.31), 2.3e-16);
  CHECK_NEAR(conic_tan(conic_radians(20.0)), tan(20.0 * CONIC_PI / 180.0), 2.3e-16);
  CHECK(conic_sin(0.0) == 0.0 && conic_cos(0.0) == 1.0);
  for (int i = -4000; i <= 4000; i++) {
    double angle = (double)i * (CONIC_PI / 4000.0), length = 1.0 + (double)(i % 5 + 4);
    CHECK_NEAR(conic_angle(length * sin(angle), length * cos(angle)), atan2(length * sin(angle), length * cos(angle)),
               1e-14);
  }
  CHECK(conic_angle(0.0, 0.0) == 0.0);
  double infinite = HUGE_VAL;
  CHECK(isnan(conic_sin(infinite)) && isnan(conic_cos(infinite)));

  for (int i = 0; i <= 4000; i++) {
    double x = (double)i / 1000.0;
    double encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055;
    double decoded = x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4);
    CHECK_NEAR(conic_srgb_encode(x), encoded, 1e-15 + 1e-15 * encoded);
    CHECK_NEAR(conic_srgb_decode(x), decoded, 1e-15 + 2e-15 * decoded);
  }
  conic_srgb_decode_table(table);
  conic_srgb_thresholds(thresholds);
  for (int i = 0; i < 256; i++)
    CHECK(conic_srgb_code(thresholds, table[i]) == i);
  CHECK(conic_srgb_code(thresholds, -1.0f) == 0 && conic_srgb_code(thresholds, 9.0f) == 255);
  CHECK(conic_srgb_code(thresholds, (float)NAN) == 0);
  for (int i = -30; i <= 30; i++)
    CHECK_NEAR(conic_exposure_factor((double)i * 0.3), exp2((double)i * 0.3), 1e-7 * exp2((double)i * 0.3));
  return check_result();
}
