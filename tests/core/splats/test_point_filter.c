/* Expressions that choose points: what they mean, and what is said of those that mean nothing. */
#include <math.h>
#include <string.h>

#include "core/splats/point_filter.h"
#include "tests/support/check.h"

static const struct {
  const char *expression;
  const char *passes; /* of a = 0, 1, 2 … 9, with b = 10 − a */
} meanings[] = {{"a = 3", "3"},
                {"a==3", "3"},
                {"a != 3", "012456789"},
                {"a <> 3", "012456789"},
                {"a < 3", "012"},
                {"a <= 3", "0123"},
                {"a > 6.5", "789"},
                {"a >= 7e0", "789"},
                {"a > -1", "0123456789"},
                {"a = 1, 3, 7..8", "1378"},
                {"a in (1, 3..4)", "134"},
                {"a != 1..8", "09"},
                {"a = 1 or a = 2 and b = 8", "12"},
                {"(a = 1 or a = 2) and b = 8", "2"},
                {"not a = 1 and a < 4", "023"},
                {"NOT (a = 1 OR b = 7) AND a < 5", "024"},
                {"!(a < 8) && b < 2 || a = 0", "09"},
                {"\"a\" = 5", "5"},
                {"a = 4 and c = 1", ""},
                {"not c < 5 and a < 2", "01"},
                {"c != 1 and a = 2", "2"}};

static const struct {
  const char *expression, *says;
} wrong[] = {{"", "it ends where a name is expected (at character 1)"},
             {"a", "=, !=, <, <=, >, >= or in is expected here (at character 2)"},
             {"a = ", "it ends where a number is expected (at character 5)"},
             {"a = b", "a number is expected here (at character 5)"},
             {"a = 3..2", "a range ends before it begins"},
             {"a = 1 a", "'and' or 'or' is expected here (at character 7)"},
             {"(a = 1", "a ) is expected here (at character 7)"},
             {"a in (1", "a list does not end"},
             {"\"a = 1", "a quoted name does not end"},
             {"3 = a", "a name is expected here, in double quotes if it has other signs than letters (at character 1)"},
             {"'a b' = 3", "a name is expected here, in double quotes if"},
             {"a b = 3", "or in is expected here; a name with blanks or signs in it stands in double quotes, as '"}};

static char last_message[400];

static void keep_message(void *cookie, conic_log_level level, const char *message) {
  (void)cookie;
  (void)level;
  snprintf(last_message, sizeof last_message, "%s", message);
}

static void check_meaning(conic_context *context, const char *expression, const char *passes) {
  conic_filter *filter;
  char found[16] = "";
  CHECK_OK(conic_filter_parse(context, expression, &filter));
  for (int a = 0; a < 10 && filter; a++) {
    double values[CONIC_FILTER_MOST_NAMES];
    for (size_t k = 0; k < conic_filter_names(filter); k++) {
      char name = conic_filter_name(filter, k)[0];
      values[k] = name == 'a' ? (double)a : name == 'b' ? 10.0 - (double)a : (double)NAN;
    }
    if (conic_filter_passes(filter, values))
      found[strlen(found)] = (char)('0' + a);
  }
  if (strcmp(found, passes) != 0) {
    fprintf(stderr, "'%s' passes %s in place of %s\n", expression, found, passes);
    check_failures++;
  }
  conic_filter_destroy(context, filter);
}

static void check_deep(conic_context *context) {
  char text[4096] = "";
  conic_filter *filter;
  for (int i = 0; i < 1000; i++)
    strcat(text, "(");
  CHECK(conic_filter_parse(context, text, &filter) == CONIC_ERROR_ARGUMENT && !filter);
  text[0] = 0;
  for (int i = 0; i < 600; i++)
    strcat(text, i ? ",1" : "a=1");
  CHECK(conic_filter_parse(context, text, &filter) == CONIC_ERROR_ARGUMENT && !filter);
}

int main(void) {
  conic_context_options options;
  conic_context *context;
  conic_context_options_init(&options);
  options.log = keep_message;
  CHECK_OK(conic_context_create(&options, &context));
  conic_filter *filter;
  for (size_t i = 0; i < sizeof meanings / sizeof *meanings; i++)
    check_meaning(context, meanings[i].expression, meanings[i].passes);
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    CHECK(conic_filter_parse(context, wrong[i].expression, &filter) == CONIC_ERROR_ARGUMENT && !filter);
    CHECK(strstr(last_message, wrong[i].says));
  }
  check_deep(context);
  conic_context_destroy(context);
  return check_result();
}
