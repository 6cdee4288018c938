/* The access layer: ranges of a file from a map and from web servers, good and hostile. Never wrong bytes, never a
 * hang: that it ends at all, within the test's time, is part of what is tested. */
#include "core/base/clock.h"
#include "lod/ranges/ranges.h"
#include "tests/support/files.h"
#include "tests/support/http_server.h"
#include "tests/support/image_fixture.h"
#include "tests/support/random_numbers.h"

enum { N_BYTES = 3 << 20, N_RANGES = 200 };

static unsigned char *bytes;

static conic_ranges_options quick(void) {
  conic_ranges_options options;
  conic_ranges_options_init(&options);
  options.connect_seconds = 2.0;
  options.stall_seconds = 0.3;
  options.n_retries = 2;
  options.pause_seconds = 0.01;
  return options;
}

/* What came of asking for many ranges. */
typedef struct outcome {
  size_t n_good, n_given_up, n_wrong; /* the last of those given up: not late, but wrong */
  char reason[256];
} outcome;

/* Asks for ranges all over the file and takes all answers; whatever is good must be right. */
static outcome take_all(conic_ranges *ranges, uint64_t seed) {
  outcome o = {0, 0, 0, ""};
  conic_range asked[N_RANGES];
  int is_answered[N_RANGES] = {0};
  uint64_t state = seed;
  for (uint32_t i = 0; i < N_RANGES; i++) {
    size_t n = 1 + (size_t)(random_unit(&state) * 20000.0), at = (size_t)(random_unit(&state) * (double)(N_BYTES - n));
    asked[i] = (conic_range){.offset = at, .n_bytes = n, .priority = at, .id = i};
    CHECK_OK(conic_ranges_request(ranges, &asked[i]));
  }
  CHECK(conic_ranges_pending(ranges) == N_RANGES);
  while (conic_ranges_pending(ranges) > 0) {
    conic_range_answer answer;
    if (!conic_ranges_next(ranges, 0.2, &answer))
      continue;
    CHECK(answer.id < N_RANGES && !is_answered[answer.id]);
    is_answered[answer.id] = 1;
    if (answer.status != CONIC_OK) {
      CHECK((answer.status == CONIC_ERROR_IO || answer.status == CONIC_ERROR_INPUT) && answer.reason && *answer.reason);
      o.n_wrong += answer.status == CONIC_ERROR_INPUT;
      snprintf(o.reason, sizeof o.reason, "%s", answer.reason);
      o.n_given_up++;
      continue;
    }
    const conic_range *r = &asked[answer.id];
    CHECK(answer.n_bytes == r->n_bytes && memcmp(answer.bytes, bytes + r->offset, r->n_bytes) == 0);
    conic_ranges_release(ranges, &answer);
    o.n_good++;
  }
  return o;
}

static void check_file(conic_context *context) {
  conic_ranges *ranges;
  conic_ranges_options options = quick();
  const char *path = files_path("bytes");
  FILE *file = fopen(path, "wb");
  CHECK(file && fwrite(bytes, 1, N_BYTES, file) == N_BYTES && fclose(file) == 0);
  CHECK_OK(conic_ranges_open(context, path, &options, &ranges));
  CHECK(conic_ranges_size(ranges) == N_BYTES);
  for (uint64_t round = 0; round < 20; round++) /* enough for pages to be given back */
    CHECK(take_all(ranges, 1 + round).n_good == N_RANGES);
  conic_range outside = {.offset = N_BYTES - 10, .n_bytes = 11};
  CHECK(conic_ranges_request(ranges, &outside) == CONIC_ERROR_ARGUMENT);
  outside = (conic_range){.offset = UINT64_MAX - 2, .n_bytes = 2};
  CHECK(conic_ranges_request(ranges, &outside) == CONIC_ERROR_ARGUMENT);
  conic_ranges_close(ranges);
  CHECK(conic_ranges_open(context, files_path("none"), &options, &ranges) == CONIC_ERROR_INPUT && !ranges);
  remove(path);
}

/* Answers come by priority, and what is cancelled never does. */
static void check_order(conic_context *context) {
  conic_ranges *ranges;
  conic_ranges_options options = quick();
  const char *path = files_path("bytes");
  FILE *file = fopen(path, "wb");
  CHECK(file && fwrite(bytes, 1, N_BYTES, file) == N_BYTES && fclose(file) == 0);
  CHECK_OK(conic_ranges_open(context, path, &options, &ranges));
  for (uint32_t i = 0; i < 100; i++) {
    conic_range range = {.offset = i, .n_bytes = 1, .priority = (i * 37) % 100, .id = (i * 37) % 100};
    CHECK_OK(conic_ranges_request(ranges, &range));
  }
  for (uint32_t i = 0; i < 50; i++) {
    conic_range_answer answer;
    CHECK(conic_ranges_next(ranges, 0.0, &answer) && answer.id == i);
    conic_ranges_release(ranges, &answer);
  }
  conic_ranges_cancel(ranges);
  conic_range_answer answer;
  CHECK(conic_ranges_pending(ranges) == 0 && !conic_ranges_next(ranges, 0.0, &answer));
  conic_ranges_close(ranges);
  remove(path);
}

static conic_ranges *open_mode(conic_context *context, const http_server *server, const char *mode,
                               const conic_ranges_options *options, conic_status expected) {
  char url[128];
  conic_ranges *ranges;
  snprintf(url, sizeof url, "http://127.0.0.1:%d/%s/file.lpc", server->port, mode);
  files_message[0] = '\0';
  conic_status status = conic_ranges_open(context, url, options, &ranges);
  if (status != expected) {
    fprintf(stderr, "%s: %s: %s\n", mode, conic_status_string(status), files_message);
    check_failures++;
  }
  CHECK(status == CONIC_OK || (!ranges && strstr(files_message, url)));
  return ranges;
}

static void check_good_server(conic_context *context) {
  http_server server;
  conic_ranges_options options = quick();
  http_server_start(&server, bytes, N_BYTES, 1 << 30);
  conic_ranges *ranges = open_mode(context, &server, "good", &options, CONIC_OK);
  CHECK(conic_ranges_size(ranges) == N_BYTES);
  CHECK(take_all(ranges, 7).n_good == N_RANGES);
  CHECK(atomic_load(&server.n_connections) <= options.n_connections); /* kept alive, */
  CHECK(atomic_load(&server.n_requests) < N_RANGES / 2);              /* and neighbours joined */
  int n_before = atomic_load(&server.n_requests);
  conic_range first = {.offset = 100, .n_bytes = 1000}; /* the beginning came along with the first answer */
  conic_range_answer answer;
  CHECK_OK(conic_ranges_request(ranges, &first));
  CHECK(conic_ranges_next(ranges, 1.0, &answer) && memcmp(answer.bytes, bytes + 100, 1000) == 0);
  conic_ranges_release(ranges, &answer);
  conic_ranges_close(ranges);
  CHECK(atomic_load(&server.n_requests) == n_before);
  ranges = open_mode(context, &server, "good", &options, CONIC_OK);
  for (uint32_t i = 0; i < 50; i++) {
    conic_range range = {.offset = 70000 + 50000 * (uint64_t)i, .n_bytes = 100, .priority = i, .id = i};
    CHECK_OK(conic_ranges_request(ranges, &range));
  }
  if (conic_ranges_next(ranges, 0.0, &answer)) /* requests are under way now, or answered */
    conic_ranges_release(ranges, &answer);
  conic_ranges_cancel(ranges);
  CHECK(take_all(ranges, 8).n_good == N_RANGES); /* and nothing of them comes after */
  conic_ranges_close(ranges);
  http_server_stop(&server);
}

/* Servers that send whole files only: within the bound that is fine. */
static void check_whole(conic_context *context) {
  const char *const modes[] = {"whole", "unlengthy", "endless"};
  for (size_t i = 0; i < sizeof modes / sizeof modes[0]; i++) {
    http_server server;
    conic_ranges_options options = quick();
    http_server_start(&server, bytes, N_BYTES, 1 << 30);
    options.most_whole_bytes = N_BYTES - 1;
    CHECK(!open_mode(context, &server, modes[i], &options, CONIC_ERROR_IO));
    CHECK(strstr(files_message, "no ranges"));
    options.most_whole_bytes = N_BYTES;
    conic_ranges *ranges = open_mode(context, &server, modes[i], &options, i < 2 ? CONIC_OK : CONIC_ERROR_IO);
    if (ranges) {
      int n_before = atomic_load(&server.n_requests);
      CHECK(conic_ranges_size(ranges) == N_BYTES && take_all(ranges, 9).n_good == N_RANGES);
      CHECK(atomic_load(&server.n_requests) == n_before);
    }
    conic_ranges_close(ranges);
    http_server_stop(&server);
  }
}

/* Of a whole file, what has come in time is used, and no more is waited for. */
static void check_half(conic_context *context) {
  http_server server;
  conic_ranges_options options = quick();
  http_server_start(&server, bytes, N_BYTES, 0);
  options.stall_seconds = 1000.0;
  options.until_s = conic_seconds_now() + 0.5;
  conic_ranges *ranges = open_mode(context, &server, "half", &options, CONIC_OK);
  CHECK(ranges && conic_ranges_size(ranges) == N_BYTES);
  outcome o = take_all(ranges, 10);
  CHECK(o.n_good > N_RANGES / 4 && o.n_given_up > N_RANGES / 4 && o.n_wrong == 0 && strstr(o.reason, "time is up"));
  conic_ranges_close(ranges);
  http_server_stop(&server);
}

/* One answer that stalls holds up nothing: what it lacks is asked for again. */
static void check_laggard(conic_context *context) {
  http_server server;
  conic_ranges_options options = quick();
  http_server_start(&server, bytes, N_BYTES, 0);
  server.link_bytes_a_second = 600000;
  options.stall_seconds = 1000.0;
  conic_ranges *ranges = open_mode(context, &server, "laggard", &options, CONIC_OK);
  CHECK(take_all(ranges, 12).n_good == N_RANGES);
  conic_ranges_close(ranges);
  http_server_stop(&server);
}

/* Over a slow link, what is wanted first comes first, and is there as soon as its own bytes are. */
static void check_slow(conic_context *context) {
  enum { N = 20, N_EACH = 5000 };
  http_server server;
  conic_ranges_options options = quick();
  conic_range_answer answer;
  http_server_start(&server, bytes, N_BYTES, 0);
  server.link_bytes_a_second = 125000;
  conic_ranges *ranges = open_mode(context, &server, "link", &options, CONIC_OK);
  double start = conic_seconds_now(), first_s = 0.0;
  for (uint32_t i = 0; i < N; i++) { /* the first wanted lies last */
    conic_range range = {.offset = N_BYTES - 2 * (i + 1) * N_EACH, .n_bytes = N_EACH, .priority = i, .id = i};
    CHECK_OK(conic_ranges_request(ranges, &range));
  }
  for (uint32_t n = 0; conic_ranges_pending(ranges) > 0;) {
    if (!conic_ranges_next(ranges, 1.0, &answer))
      continue;
    CHECK(answer.status == CONIC_OK && answer.id < n + 8 && n < answer.id + 8);
    first_s = n++ ? first_s : conic_seconds_now() - start;
    conic_ranges_release(ranges, &answer);
  }
  CHECK(first_s < 0.5 * (conic_seconds_now() - start));
  conic_ranges_close(ranges);
  http_server_stop(&server);
}

/* Servers that never answer well: an error, and the right one. */
static void check_hopeless(conic_context *context) {
  const struct {
    const char *mode;
    conic_status status;
    const char *words;
  } cases[] = {{"404", CONIC_ERROR_INPUT, "404"},
               {"500", CONIC_ERROR_IO, "500"},
               {"short", CONIC_ERROR_IO, "remaining"},
               {"less", CONIC_ERROR_INPUT, "another range"},
               {"shifted", CONIC_ERROR_INPUT, "another range"},
               {"unsaid", CONIC_ERROR_INPUT, "which range"},
               {"redirect", CONIC_ERROR_INPUT, "redirect"},
               {"elsewhere", CONIC_ERROR_INPUT, "rotocol"},
               {"headers", CONIC_ERROR_INPUT, "headers"},
               {"header", CONIC_ERROR_INPUT, "headers"},
               {"more", CONIC_ERROR_INPUT, "more than"},
               {"packed", CONIC_ERROR_INPUT, "compressed"},
               {"garbage", CONIC_ERROR_INPUT, "no answer"},
               {"stalled", CONIC_ERROR_IO, ""},
               {"silent", CONIC_ERROR_IO, ""},
               {"dead", CONIC_ERROR_IO, ""}};
  conic_ranges_options options = quick();
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    http_server server;
    http_server_start(&server, bytes, N_BYTES, 0);
    CHECK(!open_mode(context, &server, cases[i].mode, &options, cases[i].status));
    if (cases[i].status == CONIC_ERROR_INPUT && strcmp(cases[i].mode, "redirect") != 0)
      CHECK(atomic_load(&server.n_requests) <= 2); /* what is wrong is asked for once again */
    if (!strstr(files_message, cases[i].words)) {
      fprintf(stderr, "%s: %s\n", cases[i].mode, files_message);
      check_failures++;
    }
    http_server_stop(&server);
  }
}

/* Servers that turn bad after a good start. What they still send well is right; the rest is given up, and so is soon
 * all that waits. */
static void check_turning(conic_context *context) {
  const struct {
    const char *mode;
    int is_fatal; /* all is given up, */
    int is_wrong; /* and not for want of answers */
  } cases[] = {{"500", 1, 0},     {"404", 1, 1},    {"short", 1, 0},   {"less", 1, 1},    {"more", 1, 1},
               {"shifted", 1, 1}, {"unsaid", 1, 1}, {"changed", 1, 1}, {"headers", 1, 1}, {"garbage", 1, 1},
               {"forgets", 1, 1}, {"dead", 1, 0},   {"stalled", 1, 0}, {"trickle", 1, 0}, {"flaky", 0, 0}};
  conic_ranges_options options = quick();
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    http_server server;
    http_server_start(&server, bytes, N_BYTES, 1);
    options.n_retries = cases[i].is_fatal ? 2 : 10;
    conic_ranges *ranges = open_mode(context, &server, cases[i].mode, &options, CONIC_OK);
    outcome o = take_all(ranges, 11 + i);
    CHECK(o.n_good + o.n_given_up == N_RANGES && o.n_wrong == (cases[i].is_wrong ? o.n_given_up : 0));
    if (cases[i].is_fatal ? o.n_given_up < N_RANGES * 9 / 10 || !o.reason[0] : o.n_given_up > 0) {
      fprintf(stderr, "%s: %zu good, %zu given up: %s\n", cases[i].mode, o.n_good, o.n_given_up, o.reason);
      check_failures++;
    }
    conic_ranges_close(ranges);
    http_server_stop(&server);
  }
}

/* A server that does not answer, or drop by drop: opening ends when the time is up, whatever the other patience. */
static void check_hurried(conic_context *context) {
  const char *const modes[] = {"silent", "stalled", "drops", "500"};
  for (size_t i = 0; i < sizeof modes / sizeof modes[0]; i++) {
    http_server server;
    conic_ranges_options options = quick();
    http_server_start(&server, bytes, N_BYTES, 0);
    options.stall_seconds = options.pause_seconds = 3.0; /* longer than it is to take */
    options.until_s = conic_seconds_now() + 0.2;
    CHECK(!open_mode(context, &server, modes[i], &options, CONIC_ERROR_IO) && strstr(files_message, "in time"));
    http_server_stop(&server);
  }
}

static void check_nobody(conic_context *context) {
  http_server server;
  conic_ranges_options options = quick();
  http_server_start(&server, bytes, N_BYTES, 0);
  http_server_stop(&server); /* its port is free now */
  CHECK(!open_mode(context, &server, "good", &options, CONIC_ERROR_IO));
}

int main(void) {
  conic_context *context = files_context();
  uint64_t state = 1;
  bytes = malloc(N_BYTES);
  if (!bytes)
    return 1;
  for (size_t i = 0; i < N_BYTES; i++)
    bytes[i] = (unsigned char)(random_unit(&state) * 256.0);
  setenv("no_proxy", "127.0.0.1", 1);
  check_file(context);
  check_order(context);
  if (has_feature("CURL")) {
    check_good_server(context);
    check_whole(context);
    check_half(context);
    check_laggard(context);
    check_slow(context);
    check_hopeless(context);
    check_turning(context);
    check_hurried(context);
    check_nobody(context);
  } else {
    conic_ranges_options options = quick();
    conic_ranges *ranges;
    CHECK(conic_ranges_open(context, "http://127.0.0.1/x", &options, &ranges) == CONIC_ERROR_UNSUPPORTED);
    fprintf(stderr, "skipped: web servers, without libcurl\n");
  }
  free(bytes);
  conic_context_destroy(context);
  rmdir(files_folder);
  return check_result();
}
