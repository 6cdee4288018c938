/* What the peers in C share: splats and camera as `run` gives them, times, and the picture. */
#pragma once

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct peer_splat {
  float position[3], normal[3], radius;
  unsigned char color[3];
} peer_splat;

typedef struct peer_camera {
  int width, height;
  double f[2], c[2], world_to_camera[3][4];
} peer_camera;

static void fail_peer(const char *what) {
  fprintf(stderr, "%s\n", what);
  exit(1);
}

static double spent_ms(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

static peer_splat *read_splats(const char *path, unsigned *n) {
  enum { BYTES = 31 };
  char line[256];
  FILE *file = fopen(path, "rb");
  *n = 0;
  while (file && fgets(line, sizeof line, file) && strcmp(line, "end_header\n") != 0)
    sscanf(line, "element vertex %u", n);
  peer_splat *splats = *n ? calloc(*n, sizeof *splats) : NULL;
  for (unsigned i = 0; splats && i < *n; i++) {
    unsigned char bytes[BYTES];
    if (fread(bytes, sizeof bytes, 1, file) != 1)
      fail_peer("the splats end too soon");
    memcpy(&splats[i], bytes, 28);
    memcpy(splats[i].color, bytes + 28, 3);
  }
  if (file)
    fclose(file);
  return splats;
}

static void read_peer_camera(const char *text, peer_camera *to) {
  double *rows = &to->world_to_camera[0][0];
  int n = 0;
  if (sscanf(text, "%d %d %lf %lf %lf %lf%n", &to->width, &to->height, &to->f[0], &to->f[1], &to->c[0], &to->c[1],
             &n) != 6)
    fail_peer("the camera is not understood");
  for (int i = 0; i < 12; i++) {
    int m = 0;
    if (sscanf(text + n, "%lf%n", &rows[i], &m) != 1)
      fail_peer("the camera is not understood");
    n += m;
  }
}

static int compare_ms(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Linear floats, the lowest row first. */
static void write_peer_picture(const char *path, const peer_camera *c, const float *rgb) {
  FILE *out = fopen(path, "wb");
  if (!out)
    fail_peer("the picture cannot be written");
  fprintf(out, "PF\n%d %d\n-1.0\n", c->width, c->height);
  fwrite(rgb, 3 * sizeof *rgb, (size_t)c->width * (size_t)c->height, out);
  fclose(out);
}

static void fill_linear(float linear_of[256]) {
  for (int i = 0; i < 256; i++)
    linear_of[i] = i <= 10 ? (float)i / 255.0f / 12.92f : powf(((float)i / 255.0f + 0.055f) / 1.055f, 2.4f);
}
