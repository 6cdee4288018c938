/* A random scene in which every mistake of a renderer shows: harmonics of degree 3, quaternions of any length, opaque
 * and faint ones, near and far ones, large and small ones, in no order, before a camera that is not centred. */
#include <math.h>
#include <string.h>

#include "tests/judge/plain_floats.h"
#include "tests/judge/plain_scene.h"

enum { N_REST = 45, N_COLUMNS = 3 + 3 + 3 + N_REST + 1 + 3 + 4 };

static float plain_between(plain_floats *f, double low, double high) {
  return (float)(low + (high - low) * plain_chance(f, 1u << 24) * 0x1p-24);
}

static void plain_write_header(FILE *file, size_t n) {
  fprintf(file, "ply\nformat binary_little_endian 1.0\nelement vertex %zu\n", n);
  for (int k = 0; k < 6; k++)
    fprintf(file, "property float %s%c\n", k < 3 ? "" : "n", "xyz"[k % 3]);
  for (int k = 0; k < 3; k++)
    fprintf(file, "property float f_dc_%d\n", k);
  for (int k = 0; k < N_REST; k++)
    fprintf(file, "property float f_rest_%d\n", k);
  fprintf(file, "property float opacity\n");
  for (int k = 0; k < 3; k++)
    fprintf(file, "property float scale_%d\n", k);
  for (int k = 0; k < 4; k++)
    fprintf(file, "property float rot_%d\n", k);
  fprintf(file, "end_header\n");
}

/* The camera stands at the origin and looks along z, or nearly so; one in twelve is close to it. One in
 * sixteen is large and opaque. */
static void plain_random_row(plain_floats *f, float row[N_COLUMNS]) {
  const int is_near = plain_chance(f, 12) == 0, is_wall = !is_near && plain_chance(f, 16) == 0;
  int at = 0;
  for (int k = 0; k < 3; k++)
    row[at++] = is_near ? (k < 2 ? plain_between(f, -0.04, 0.04) : plain_between(f, 0.05, 0.25))
                        : plain_between(f, -1.6, 1.6) + (k == 2 ? 3.0f : 0.0f);
  for (int k = 0; k < 3; k++)
    row[at++] = 0.0f;
  for (int k = 0; k < 3; k++)
    row[at++] = plain_between(f, -1.2, 1.8);
  for (int k = 0; k < N_REST; k++)
    row[at++] = plain_between(f, -0.2, 0.2);
  row[at++] = is_near ? plain_between(f, -3.0, -1.0) : is_wall ? 12.0f : plain_between(f, -3.0, 3.0);
  const float size = is_near ? -4.8f : is_wall ? -1.0f : plain_between(f, -4.5, -1.5);
  for (int k = 0; k < 3; k++)
    row[at++] = size + plain_between(f, -1.0, 0.6);
  const float length = plain_between(f, 0.6, 1.7);
  for (int k = 0; k < 4; k++)
    row[at++] = length * plain_between(f, -1.0, 1.0);
}

void plain_random_write(unsigned long long seed, size_t n, const char *scene, const char *camera) {
  plain_floats chance = {.state = seed * 1000003u + 1u};
  float row[N_COLUMNS];
  FILE *file = fopen(scene, "wb");
  if (!file)
    plain_give_up(scene, "cannot be written");
  plain_write_header(file, n);
  for (size_t i = 0; i < n; i++) {
    plain_random_row(&chance, row);
    fwrite(row, sizeof *row, N_COLUMNS, file);
  }
  if (fclose(file) != 0 || !(file = fopen(camera, "wb")))
    plain_give_up(camera, "cannot be written");
  const double turn = 0.1 * (double)plain_between(&chance, -1.0, 1.0), c = cos(turn), s = sin(turn);
  fprintf(
      file,
      "{\"width\": 64, \"height\": 56, \"fx\": 56.5, \"fy\": 57.25, \"cx\": 29.75, \"cy\": 30.5, \"world_to_camera\": "
      "[[%.17g, 0, %.17g, 0], [0, 1, 0, 0], [%.17g, 0, %.17g, 0.03125], [0, 0, 0, 1]]}\n",
      c, s, -s, c);
  if (fclose(file) != 0)
    plain_give_up(camera, "cannot be written");
}
