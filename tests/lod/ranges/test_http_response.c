/* What the lines of a response's header say, and what they do not: the numbers of a range must fit each other. */
#include "lod/ranges/http_response.h"

#include "tests/support/check.h"

static conic_http_response read_lines(const char *const *lines, int n) {
  conic_http_response response;
  memset(&response, 0, sizeof response);
  for (int i = 0; i < n; i++)
    CHECK(conic_http_header(&response, lines[i], strlen(lines[i])));
  return response;
}

static void test_ranges(void) {
  static const struct {
    const char *line;
    int is_range;
  } cases[] = {{"Content-Range: bytes 0-9/10\r\n", 1},
               {"content-range:bytes 3-3/10", 1},
               {"CONTENT-RANGE: \tbytes \t18446744073709551613-18446744073709551614/18446744073709551615", 1},
               {"Content-Range: bytes 0-10/10", 0},
               {"Content-Range: bytes 4-3/10", 0},
               {"Content-Range: bytes 0-9/*", 0},
               {"Content-Range: bytes */10", 0},
               {"Content-Range: bytes -9/10", 0},
               {"Content-Range: bytes 0-9/10 and more", 0},
               {"Content-Range: bytes 0-9/18446744073709551616", 0},
               {"Content-Range: lines 0-9/10", 0}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    conic_http_response response = read_lines(&cases[i].line, 1);
    if (response.has_range != cases[i].is_range) {
      fprintf(stderr, "%s: %d\n", cases[i].line, response.has_range);
      check_failures++;
    }
  }
  conic_http_response response = read_lines(&cases[0].line, 1);
  CHECK(response.first == 0 && response.last == 9 && response.size == 10);
}

/* A second response, after a redirection say, begins anew. */
static void test_lines(void) {
  static const char *const lines[] = {"HTTP/1.1 302 Found\r\n", "Content-Length: 12\r\n", "ETag: \"a\"\r\n",
                                      "HTTP/2 206\r\n",         "Content-Length: 7x\r\n", "ETag: W/\"b\"\r\n"};
  conic_http_response response = read_lines(lines, 3);
  CHECK(response.status == 302 && response.has_length && response.length == 12 && strcmp(response.tag, "\"a\"") == 0);
  response = read_lines(lines, 6);
  CHECK(response.status == 206 && !response.has_length && !response.has_range && !response.tag[0]);
}

/* A header without end is given up. */
static void test_endless(void) {
  conic_http_response response;
  int n = 0;
  memset(&response, 0, sizeof response);
  while (n < 100000 && conic_http_header(&response, "X-Much: of the same\r\n", 21))
    n++;
  CHECK(n > 1000 && n < 10000);
}

int main(void) {
  test_ranges();
  test_lines();
  test_endless();
  return check_result();
}
