/* Clouds asked for ahead: along a path, what a picture wants has been asked for while the one before was drawn; and
 * whatever the camera does, pictures are those of the file. */
#include "lod/layers/draw/layers_scene.h"
#include "tests/support/files.h"
#include "tests/support/http_server.h"
#include "tests/support/image_fixture.h"
#include "tests/support/layers_frame.h"

enum { N_FRAMES = 10 };

typedef struct path_drawing {
  layers_frame far, local;
  uint64_t n_read, n_ahead; /* of the last picture */
} path_drawing;

/* Near, so that each picture shows a part. */
static void aim(layers_frame *frame, double azimuth_deg) {
  conic_framing framing;
  conic_layers_scale scale;
  conic_layers_measure(frame->layers, 1.5f, &scale);
  conic_framing_init(&framing);
  framing.width = 200;
  framing.height = 160;
  framing.zoom = 4.0;
  framing.azimuth_deg = azimuth_deg;
  CHECK_OK(conic_camera_frame(frame->f.context, &framing, scale.minimum, scale.maximum, &frame->f.camera));
}

static void draw_far_and_near(path_drawing *p, double azimuth_deg) {
  uint64_t n_ahead = p->far.layers->store.n_ahead;
  aim(&p->far, azimuth_deg);
  aim(&p->local, azimuth_deg);
  CHECK_OK(layers_draw(&p->far));
  CHECK_OK(layers_draw(&p->local));
  CHECK(layers_same_picture(&p->far.f.image, &p->local.f.image));
  p->n_read = p->far.drawn.n_clouds_read;
  p->n_ahead = p->far.layers->store.n_ahead - n_ahead;
}

int main(void) {
  const char *path = files_path("ahead.lpc");
  http_server server;
  char url[128];
  if (!has_feature("zstd") || !has_feature("CURL")) {
    fprintf(stderr, "skipped: this build is without zstd or libcurl\n");
    return 77;
  }
  conic_context *context = files_context();
  layers_build(context, path, 64);
  size_t n_bytes;
  unsigned char *bytes = read_bytes(path, &n_bytes);
  http_server_start(&server, bytes, n_bytes, 1 << 30);
  snprintf(url, sizeof url, "http://127.0.0.1:%d/link/m.lpc", server.port);
  path_drawing p = {.far = layers_open(2, url, NULL), .local = layers_open(2, path, NULL)};
  p.far.draw.occlusion = p.local.draw.occlusion = CONIC_OCCLUSION_OFF;
  long long start_us = http_now_us();
  uint64_t n_received = 0, n_late = 0, n_read = 0;
  for (int i = 0; i < N_FRAMES; i++) {
    draw_far_and_near(&p, 12.0 * i);
    n_received += p.far.drawn.n_bytes_received;
    n_read += i > 1 ? p.n_read : 0;
    n_late += i > 1 ? p.n_read - p.n_ahead : 0;
  }
  CHECK(n_read > 20 && n_late == 0); /* two pictures show where a path goes */
  fprintf(stderr, "%d pictures in %.0f ms, %.0f of transfer alone\n", N_FRAMES,
          (double)(http_now_us() - start_us) / 1e3, (double)n_received * 8e-5);
  draw_far_and_near(&p, 240.0); /* elsewhere, while something else is under way */
  draw_far_and_near(&p, 5.0);
  CHECK(p.far.layers->store.n_asked < p.far.layers->header.n_clouds);
  layers_close(&p.far);
  layers_close(&p.local);
  http_server_stop(&server);
  free(bytes);
  remove(path);
  rmdir(files_folder);
  conic_context_destroy(context);
  return check_result();
}
