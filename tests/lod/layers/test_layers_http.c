/* Layered point clouds from web servers: from a good one the same picture as from the file; from hostile ones an error
 * or, where that is allowed, a coarser picture; never a wrong one, and never a hang. */
#include "lod/layers/draw/layers_scene.h"
#include "tests/support/files.h"
#include "tests/support/http_server.h"
#include "tests/support/image_fixture.h"
#include "tests/support/layers_frame.h"

static unsigned char *bytes;
static size_t n_bytes;
static layers_frame local; /* has drawn the file */

static conic_layers_access quick(void) {
  conic_layers_access access;
  conic_layers_access_init(&access);
  access.connect_seconds = 2.0;
  access.stall_seconds = 0.3;
  access.n_retries = 2;
  access.pause_seconds = 0.01;
  return access;
}

static layers_frame open_mode(const http_server *server, const char *mode, const conic_layers_access *access) {
  char url[128];
  snprintf(url, sizeof url, "http://127.0.0.1:%d/%s/m.lpc", server->port, mode);
  return layers_open(2, url, access);
}

static void expect_same(layers_frame *frame, const char *mode) {
  CHECK(frame->status == CONIC_OK);
  if (frame->status == CONIC_OK && layers_draw(frame) == CONIC_OK &&
      layers_same_picture(&frame->f.image, &local.f.image))
    return;
  fprintf(stderr, "%s: not the picture of the file\n", mode);
  check_failures++;
}

/* Also where the server fails now and then, knows no ranges, or there is little memory. */
static void check_good(void) {
  const struct {
    const char *mode;
    int n_retries, n_good;
    uint64_t memory_bytes;
  } cases[] = {{"good", 2, 1 << 30, (uint64_t)512 << 20}, {"good", 2, 1 << 30, (uint64_t)1 << 20},
               {"flaky", 12, 1, (uint64_t)512 << 20},     {"mended", 1, 0, (uint64_t)512 << 20},
               {"whole", 2, 0, (uint64_t)512 << 20},      {"unlengthy", 2, 0, (uint64_t)512 << 20}};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    http_server server;
    conic_layers_access access = quick();
    access.n_retries = cases[i].n_retries;
    access.pause_seconds = 0.001;
    access.memory_bytes = cases[i].memory_bytes;
    http_server_start(&server, bytes, n_bytes, cases[i].n_good);
    layers_frame frame = open_mode(&server, cases[i].mode, &access);
    expect_same(&frame, cases[i].mode);
    if (i == 0) {
      fprintf(stderr, "%llu of %zu bytes in %d requests\n", (unsigned long long)frame.drawn.n_bytes_received, n_bytes,
              atomic_load(&server.n_requests));
      CHECK(frame.drawn.n_bytes_received > n_bytes / 4 && atomic_load(&server.n_requests) < 120);
      expect_same(&frame, "warm");
      CHECK(frame.drawn.n_bytes_received == 0);
    }
    layers_close(&frame);
    http_server_stop(&server);
  }
}

static void check_bad_start(void) {
  const char *const modes[] = {"404", "500", "garbage", "damaged", "shifted", "dead", "endless"};
  for (size_t i = 0; i < sizeof modes / sizeof modes[0]; i++) {
    http_server server;
    conic_layers_access access = quick();
    access.memory_bytes = (uint64_t)4 << 20;
    http_server_start(&server, bytes, n_bytes, 0);
    layers_frame frame = open_mode(&server, modes[i], &access);
    int is_late = strcmp(modes[i], "500") == 0 || strcmp(modes[i], "dead") == 0 || strcmp(modes[i], "endless") == 0;
    CHECK(frame.status == (is_late ? CONIC_ERROR_IO : CONIC_ERROR_INPUT));
    CHECK(!frame.layers);
    layers_close(&frame);
    http_server_stop(&server);
  }
}

/* What is drawn for want of clouds is coarser, without holes larger than a sample, and says so. */
static void check_coarser(layers_frame *frame, const char *mode) {
  conic_difference difference;
  CHECK_OK(conic_image_compare(local.f.context, &local.f.image, &frame->f.image, &difference));
  CHECK(frame->drawn.n_clouds_missing > 0 && frame->drawn.n_places_coarser > 0);
  CHECK(frame->f.statistics.splats_in < local.f.statistics.splats_in);
  if ((double)difference.largest_hole > layers_disc_pixels(&local)) {
    fprintf(stderr, "%s: a hole of %zu pixels\n", mode, difference.largest_hole);
    check_failures++;
  }
}

/* The first answers bring header, index and some clouds; then it turns bad. What does not come may be drawn coarser;
 * what is wrong, only where damage is tolerated. */
static void check_turning(void) {
  const char *const late[] = {"500", "short", "dead", "stalled"};
  const char *const wrong[] = {"shifted", "changed", "forgets", "damaged", "more", "headers"};
  enum { N_LATE = sizeof late / sizeof late[0], N_ALL = N_LATE + sizeof wrong / sizeof wrong[0] };
  for (size_t i = 0; i < N_ALL; i++) {
    int is_late = i < N_LATE;
    const char *mode = is_late ? late[i] : wrong[i - N_LATE];
    conic_status refused = is_late ? CONIC_ERROR_IO : CONIC_ERROR_INPUT;
    http_server server;
    conic_layers_access access = quick();
    access.n_connections = 1; /* so that it is known what the first answers bring */
    http_server_start(&server, bytes, n_bytes, 3);
    layers_frame frame = open_mode(&server, mode, &access);
    CHECK(frame.status == CONIC_OK && layers_draw(&frame) == refused);
    frame.draw.may_be_coarser = 1;
    CHECK(layers_draw(&frame) == (is_late ? CONIC_OK : CONIC_ERROR_INPUT));
    frame.draw.tolerates_damage = 1;
    CHECK(layers_draw(&frame) == CONIC_OK);
    CHECK(frame.drawn.n_clouds_damaged == (is_late ? 0 : frame.drawn.n_clouds_missing));
    check_coarser(&frame, mode);
    layers_close(&frame);
    http_server_stop(&server);
  }
}

static double seconds_now(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* A server that would take for ever, and a deadline. */
static void check_deadline(void) {
  http_server server;
  conic_layers_access access = quick();
  access.n_connections = 1;
  access.stall_seconds = 1000.0;
  http_server_start(&server, bytes, n_bytes, 1 << 30);
  layers_frame frame = open_mode(&server, "trickle", &access);
  frame.draw.error_px = 20.0; /* the coarsest clouds still come well */
  frame.draw.only_samples = 1;
  CHECK(frame.status == CONIC_OK && layers_draw(&frame) == CONIC_OK);
  atomic_store(&server.n_good, 0);
  frame.draw.error_px = 0.0;
  frame.draw.may_be_coarser = 1;
  frame.draw.seconds = 0.4;
  double start = seconds_now();
  CHECK(frame.status == CONIC_OK && layers_draw(&frame) == CONIC_OK);
  CHECK(seconds_now() - start < 60.0); /* and not a thousand */
  check_coarser(&frame, "trickle");
  layers_close(&frame);
  http_server_stop(&server);
}

/* Of what came, nothing lacks what lies above it, but for what was still on its way; nor was more received than that.
 */
static void check_coarse_first(const layers_frame *frame, uint64_t n_received) {
  const conic_layers *layers = frame->layers;
  enum { A_REQUEST = 125000 / 4 };
  uint64_t n_used = 0, n_vain = 0;
  for (uint32_t i = 0; i < layers->header.n_clouds; i++) {
    n_used += layers->store.slots[i].cloud ? layers->entries[i].n_bytes : 0;
    if (layers->store.slots[i].cloud && !conic_layers_has_cloud(layers, layers->entries[i].parent))
      n_vain += layers->entries[i].n_bytes;
  }
  fprintf(stderr, "%llu of %llu bytes are used, %llu in vain; at most %.1f pixels coarser\n",
          (unsigned long long)n_used, (unsigned long long)n_received, (unsigned long long)n_vain,
          frame->drawn.missing_error_px);
  CHECK(n_vain < A_REQUEST && n_used + 2 * A_REQUEST > n_received);
}

/* A link of 1 Mbit/s: each time gives what could be had by then, and the whole is the file's picture. */
static void check_slow(void) {
  http_server server;
  conic_layers_access access = quick();
  access.stall_seconds = 15.0;
  http_server_start(&server, bytes, n_bytes, 0);
  server.link_bytes_a_second = 125000;
  layers_frame frame = open_mode(&server, "link", &access);
  uint64_t n_opening = conic_ranges_received(frame.layers->ranges);
  double coarser_px = HUGE_VAL;
  frame.draw.may_be_coarser = 1;
  frame.draw.seconds = 0.7;
  for (int i = 0; i < 2; i++) {
    CHECK(layers_draw(&frame) == CONIC_OK);
    check_coarse_first(&frame, conic_ranges_received(frame.layers->ranges) - n_opening);
    CHECK(frame.drawn.missing_error_px < coarser_px);
    check_coarser(&frame, "slow");
    coarser_px = 0.8 * frame.drawn.missing_error_px;
  }
  frame.draw.seconds = 0.0;
  expect_same(&frame, "slow");
  layers_close(&frame);
  http_server_stop(&server);
}

/* An index that is wrong behind the first answer. */
static void check_index(void) {
  http_server server;
  conic_layers_access access = quick();
  http_server_start(&server, bytes, n_bytes, 1);
  layers_frame frame = open_mode(&server, "damaged", &access);
  CHECK(frame.status == CONIC_ERROR_INPUT);
  layers_close(&frame);
  http_server_stop(&server);
  access.seconds = 0.2; /* or does not come: the time holds for it too, else the test does not end */
  access.stall_seconds = 1000.0;
  http_server_start(&server, bytes, n_bytes, 1);
  frame = open_mode(&server, "silent", &access);
  CHECK(frame.status == CONIC_ERROR_IO);
  layers_close(&frame);
  http_server_stop(&server);
}

int main(void) {
  conic_context *context = files_context();
  if (!has_feature("zstd") || !has_feature("CURL")) {
    fprintf(stderr, "skipped: this build is without zstd or libcurl\n");
    return 77;
  }
  const char *path = files_path("shells.lpc");
  setenv("no_proxy", "127.0.0.1", 1);
  layers_build(context, path, 64);
  bytes = read_bytes(path, &n_bytes);
  local = layers_open(2, path, NULL);
  CHECK(local.status == CONIC_OK && layers_draw(&local) == CONIC_OK);
  check_good();
  check_bad_start();
  check_turning();
  check_deadline();
  check_slow();
  check_index();
  layers_close(&local);
  free(bytes);
  remove(path);
  rmdir(files_folder);
  conic_context_destroy(context);
  return check_result();
}
