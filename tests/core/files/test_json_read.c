/* Strings of JSON: escapes in UTF-8, pairs of them, cut between characters, and what is no escape. */
#include "core/files/json_read.h"
#include "tests/support/check.h"

static conic_status read_text(conic_context *context, const char *json_text, char *text, size_t room, size_t *whole) {
  conic_json json;
  CHECK_OK(conic_json_take(context, "made", json_text, strlen(json_text), &json));
  *whole = conic_json_text_room(&json);
  conic_status status = conic_json_text(&json, text, room);
  conic_json_close(&json);
  return status;
}

static void check_text(conic_context *context, const char *json_text, const char *wanted) {
  char text[64];
  size_t whole;
  CHECK_OK(read_text(context, json_text, text, sizeof text, &whole));
  CHECK(strcmp(text, wanted) == 0);
  CHECK(whole > strlen(wanted));
}

int main(void) {
  static const char *const wrong[] = {"\"\\x\"", "\"\\u12\"", "\"\\u12g4\"", "\"\\", "\"a", "\"\\u", "\"\\\"", "7"};
  conic_context *context = check_context(1);
  char text[8];
  size_t whole;
  check_text(context, " \"plain\" ", "plain");
  check_text(context, "\"\\\"\\\\\\/\\b\\f\\n\\r\\t\"", "\"\\/\b\f\n\r\t");
  check_text(context, "\"\\u0041\\u00e9\\u20AC\"", "A\xc3\xa9\xe2\x82\xac");
  check_text(context, "\"\\ud83d\\ude00!\"", "\xf0\x9f\x98\x80!");
  check_text(context, "\"\\ud83d\\u0041 \\ude00 \\ud83d\\n \\u0000\"", "?A ? ?\n ?");
  /* Cut to the room, but not within a character. */
  CHECK_OK(read_text(context, "\"abc\\u20ac\\u20acd\"", text, sizeof text, &whole));
  CHECK(strcmp(text, "abc\xe2\x82\xac") == 0 && whole == 17);
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
    CHECK(read_text(context, wrong[i], text, sizeof text, &whole) == CONIC_ERROR_INPUT);
  conic_context_destroy(context);
  return check_result();
}
