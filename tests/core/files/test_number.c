/* Decimal numbers: against the C library's, which are correctly rounded, too; and back. */
#include <stdint.h>

#include "core/files/number.h"
#include "tests/support/check.h"

static uint64_t state = 1;

static uint64_t next_random(void) {
  state ^= state << 13;
  state ^= state >> 7;
  state ^= state << 17;
  return state;
}

static int same(double a, double b) {
  return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}

static void check_text(const char *text) {
  double value = 12345.0;
  char *end;
  double expected = strtod(text, &end);
  size_t n = conic_number_parse(text, strlen(text), &value);
  if (n != (size_t)(end - text) || !same(value, expected)) {
    fprintf(stderr, "'%s' is read as %a (%zu bytes), not %a (%zu)\n", text, value, n, expected, (size_t)(end - text));
    check_failures++;
  }
}

static void check_known(void) {
  static const char *const texts[] = {
      "0",
      "-0",
      "1",
      "+1.5",
      ".5",
      "5.",
      "-.25e1",
      "1e5",
      "1E+5",
      "1e-5",
      "123456789012345678901234567890",
      "0.1",
      "9007199254740993",
      "9007199254740992.999999999999999999999999999999999999",
      "1e23",
      "8.5e22",
      "2.2250738585072011e-308",
      "2.2250738585072012e-308",
      "4.9e-324",
      "2.4703282292062327e-324",
      "2.4703282292062328e-324",
      "1.7976931348623157e308",
      "1.7976931348623158e308",
      "1.7976931348623159e308",
      "1e400",
      "1e-400",
      "1e99999999999999999999",
      "0e99999999999999999999",
      "1e-99999999999999999999",
      "inf",
      "-Infinity",
      "NaN",
      "nan(ind)",
      "1e",
      "1e+",
      "1.2.3",
      "12abc",
      "0.000000000000000000000000000000000000000000001234567890123456",
      "100000000000000000000000000000000000000000000000000000000000000000000000000000000000",
      "3.14159265358979323846",
      "0000000000000000000000000000000000001",
      "1.00000000000000011102230246251565404236316680908203125",
      "1.00000000000000011102230246251565404236316680908203124",
      "1.00000000000000011102230246251565404236316680908203126"};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    check_text(texts[i]);
  double value;
  CHECK(conic_number_parse("", 0, &value) == 0);
  CHECK(conic_number_parse("-", 1, &value) == 0);
  CHECK(conic_number_parse(".", 1, &value) == 0);
  CHECK(conic_number_parse("x", 1, &value) == 0);
  CHECK(conic_number_parse("e5", 2, &value) == 0);
  CHECK(conic_number_parse("12", 1, &value) == 1 && value == 1.0);
}

/* A tie that only the thousandth digit breaks. */
static void check_long(void) {
  char text[1200] = "1.00000000000000011102230246251565404236316680908203125";
  size_t n = strlen(text);
  memset(text + n, '0', 1000);
  text[n + 1000] = 0;
  check_text(text);
  text[n + 999] = '1';
  check_text(text);
  memset(text, '9', 1000);
  text[1] = '.';
  text[1000] = 0;
  check_text(text);
}

static void check_random(void) {
  char text[64];
  for (int i = 0; i < 60000; i++) {
    uint64_t bits = next_random();
    double value;
    memcpy(&value, &bits, sizeof value);
    snprintf(text, sizeof text, "%.*e", (int)(next_random() % 21), value);
    check_text(text);
    snprintf(text, sizeof text, "%.*f", (int)(next_random() % 12), (double)(int64_t)next_random() * 1e-9);
    check_text(text);
  }
}

static void check_prints_back(double value) {
  char text[CONIC_NUMBER_ROOM];
  double again = 0.5;
  size_t n = conic_number_print(text, value);
  CHECK(n < sizeof text && strlen(text) == n && conic_number_parse(text, n, &again) == n && same(again, value));
}

static void check_float_prints_back(float value) {
  char text[CONIC_NUMBER_ROOM], shorter[CONIC_NUMBER_ROOM];
  double again = 0.5;
  size_t n = conic_number_print_float(text, value);
  CHECK(strlen(text) == n && conic_number_parse(text, n, &again) == n);
  CHECK((float)again == value || isnan(value));
  for (int digits = 1; digits < 9; digits++) { /* no fewer digits do */
    size_t n_digits = 0;
    int is_leading = 1;
    for (const char *c = text; *c && *c != 'e'; c++) {
      is_leading = is_leading && !(*c >= '1' && *c <= '9');
      n_digits += !is_leading && *c >= '0' && *c <= '9';
    }
    snprintf(shorter, sizeof shorter, "%.*e", digits - 1, (double)value);
    if (strtof(shorter, NULL) == value && fabs((double)value) < 1e6)
      CHECK(n_digits <= (size_t)digits || strchr(text, '.') == NULL);
  }
}

static void check_printing(void) {
  char text[CONIC_NUMBER_ROOM];
  conic_number_print(text, 0.1);
  CHECK(strcmp(text, "0.1") == 0);
  conic_number_print(text, -1234.5);
  CHECK(strcmp(text, "-1234.5") == 0);
  conic_number_print(text, 1e300);
  CHECK(strcmp(text, "1e300") == 0);
  conic_number_print(text, 100000.0);
  CHECK(strcmp(text, "100000") == 0);
  conic_number_print_float(text, 0.1f);
  CHECK(strcmp(text, "0.1") == 0);
  conic_number_print_float(text, 255.0f);
  CHECK(strcmp(text, "255") == 0);
  conic_number_print_float(text, 0.000123f);
  CHECK(strcmp(text, "0.000123") == 0);
  check_prints_back(HUGE_VAL);
  check_prints_back(-0.0);
  check_prints_back(4.9e-324);
  check_prints_back((double)NAN);
  for (int i = 0; i < 20000; i++) {
    uint64_t bits = next_random();
    uint32_t half = (uint32_t)bits;
    double value;
    float small;
    memcpy(&value, &bits, sizeof value);
    memcpy(&small, &half, sizeof small);
    if (!isnan(value))
      check_prints_back(value);
    if (!isnan(small))
      check_float_prints_back(small);
    check_float_prints_back((float)((double)(int64_t)bits * 1e-18));
  }
}

int main(void) {
  check_known();
  check_long();
  check_random();
  check_printing();
  return check_result();
}
