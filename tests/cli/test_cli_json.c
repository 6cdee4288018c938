/* The JSON writer: its text, byte for byte. */
#include <float.h>

#include "cli/command.h"
#include "cli/json_write.h"
#include "tests/support/check.h"

const cli_command *cli_find_command(const char *name) {
  (void)name;
  return NULL;
}

/* What is in `to`, from its beginning. */
static const char *text_of(FILE *to) {
  static char text[4096];
  fflush(to);
  rewind(to);
  text[fread(text, 1, sizeof text - 1, to)] = '\0';
  return text;
}

static void check_layout(void) {
  FILE *to = tmpfile();
  cli_json json;
  cli_json_begin(&json, to);
  cli_json_text(&json, "name", "value");
  cli_json_object(&json, "inner");
  cli_json_count(&json, "count", UINT64_MAX);
  cli_json_hash(&json, "hash", 0xAFu);
  cli_json_close(&json);
  cli_json_object(&json, "empty");
  cli_json_close(&json);
  cli_json_array(&json, "numbers");
  cli_json_number(&json, NULL, 1.0);
  cli_json_number(&json, NULL, -0.5);
  cli_json_close(&json);
  cli_json_array(&json, "objects");
  cli_json_object(&json, NULL);
  cli_json_bool(&json, "is", 3);
  CHECK(cli_json_end(&json)); /* closes what is open */
  const char *wanted = "{\n"
                       "  \"name\": \"value\",\n"
                       "  \"inner\": {\n"
                       "    \"count\": 18446744073709551615,\n"
                       "    \"hash\": \"00000000000000af\"\n"
                       "  },\n"
                       "  \"empty\": {},\n"
                       "  \"numbers\": [1, -0.5],\n"
                       "  \"objects\": [\n"
                       "    {\n"
                       "      \"is\": true\n"
                       "    }\n"
                       "  ]\n"
                       "}\n";
  const char *text = text_of(to);
  CHECK(strcmp(text, wanted) == 0);
  if (strcmp(text, wanted) != 0)
    fputs(text, stderr);
  fclose(to);
}

static void check_text(const char *value, const char *wanted) {
  FILE *to = tmpfile();
  char whole[512];
  cli_json json;
  cli_json_begin(&json, to);
  cli_json_text(&json, "t", value);
  CHECK(cli_json_end(&json));
  snprintf(whole, sizeof whole, "{\n  \"t\": %s\n}\n", wanted);
  const char *text = text_of(to);
  CHECK(strcmp(text, whole) == 0);
  if (strcmp(text, whole) != 0)
    fputs(text, stderr);
  fclose(to);
}

static void check_texts(void) {
  check_text(NULL, "null");
  check_text("", "\"\"");
  check_text("a \"b\" \\ c", "\"a \\\"b\\\" \\\\ c\"");
  check_text("line\nnext\t\x01", "\"line\\u000anext\\u0009\\u0001\"");
  check_text("\x1f \x7f", "\"\\u001f \x7f\"");
  check_text("Stra\xC3\x9F\x65 \xF0\x9F\x90\x87", "\"Stra\xC3\x9F\x65 \xF0\x9F\x90\x87\"");
  check_text("\xFF", "\"\xEF\xBF\xBD\"");                                 /* no UTF-8 at all */
  check_text("\xC3", "\"\xEF\xBF\xBD\"");                                 /* cut off */
  check_text("\xC0\x80", "\"\xEF\xBF\xBD\xEF\xBF\xBD\"");                 /* overlong */
  check_text("\xED\xA0\x80", "\"\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD\""); /* a surrogate */
}

static void check_number(double value) {
  FILE *to = tmpfile();
  cli_json json;
  cli_json_begin(&json, to);
  cli_json_number(&json, "x", value);
  CHECK(cli_json_end(&json));
  const char *digits = strchr(text_of(to), ':') + 2;
  if (value - value == 0.0)
    CHECK(strtod(digits, NULL) == value);
  else
    CHECK(strncmp(digits, "null\n", 5) == 0);
  fclose(to);
}

static void check_numbers(void) {
  const double values[] = {
      0.0, 0.1, 1.0 / 3.0, -2.5e-300, 4.9e-324, DBL_MAX, 123456789012345678.0, 5e-17, 0x1.fffffffffffffp-3};
  for (size_t i = 0; i < sizeof values / sizeof values[0]; i++)
    check_number(values[i]);
  check_number((double)INFINITY);
  check_number(-(double)INFINITY);
  check_number((double)NAN);
}

static void check_full_disk(void) {
  FILE *to = fopen("/dev/full", "w");
  cli_json json;
  if (!to) {
    fprintf(stderr, "skipped: no /dev/full here\n");
    return;
  }
  cli_json_begin(&json, to);
  CHECK(!cli_json_end(&json));
  fclose(to);
}

int main(void) {
  check_layout();
  check_texts();
  check_numbers();
  check_full_disk();
  return check_result();
}
