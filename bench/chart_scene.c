#include "bench/chart.h"

#include "core/base/color.h"
#include "core/base/trigonometry.h"

const cli_chart_scene cli_chart_scenes[CLI_N_CHART_SCENES] = {
    {"plane", CONIC_SCENE_PLANE, 10000, 20.0, 15.0, 1.6},
    {"sphere of large splats", CONIC_SCENE_SPHERE, 2000, 30.0, 15.0, 1.0},
    {"sphere of small splats", CONIC_SCENE_SPHERE, 50000, 30.0, 15.0, 1.0},
    {"torus", CONIC_SCENE_TORUS, 30000, 30.0, 40.0, 1.0},
};

/* Rays along an edge of a pixel, and how many standard deviations of its Gaussian are averaged over. */
enum { RAYS = 4, REACH = 3, N_WEIGHTS = 2 * RAYS * REACH, MARGINS = 2 * REACH, N_ROWS = 2 * N_WEIGHTS };

typedef struct ray {
  double from[3], direction[3]; /* world; direction of unit length */
} ray;

/* A sphere's parameter along the ray, or a negative number. */
static double hit_sphere(const ray *r) {
  double b = 0.0, c = -1.0;
  for (int i = 0; i < 3; i++) {
    b += r->from[i] * r->direction[i];
    c += r->from[i] * r->from[i];
  }
  return b * b >= c ? -b - sqrt(b * b - c) : -1.0;
}

static double hit_plane(const ray *r) {
  double t = r->direction[2] != 0.0 ? -r->from[2] / r->direction[2] : -1.0;
  double x = r->from[0] + t * r->direction[0], y = r->from[1] + t * r->direction[1];
  return fabs(x) < 0.5 && fabs(y) < 0.5 ? t : -1.0;
}

/* Steps as long as the distance to the surface allows. */
static double hit_torus(const ray *r) {
  double t = 0.0;
  for (int step = 0; step < 400 && t < 100.0; step++) {
    double p[3];
    for (int i = 0; i < 3; i++)
      p[i] = r->from[i] + t * r->direction[i];
    double outward = sqrt(p[0] * p[0] + p[2] * p[2]) - 1.0;
    double distance = sqrt(outward * outward + p[1] * p[1]) - 0.4;
    if (distance < 1e-9)
      return t;
    t += distance;
  }
  return -1.0;
}

/* The angle from `x` towards `y`, in turns from 0 to 1. */
static double turns_of(double y, double x) {
  double turns = atan2(y, x) / (2.0 * CONIC_PI);
  return turns < 0.0 ? turns + 1.0 : turns;
}

/* The checkers as core/scene_*.c lay them; 1 for the lighter colour. */
static int is_light(conic_scene_type type, const double p[3]) {
  if (type == CONIC_SCENE_PLANE)
    return ((int)((p[0] + 0.5) * 8.0) + (int)((p[1] + 0.5) * 8.0)) % 2;
  if (type == CONIC_SCENE_SPHERE)
    return ((int)(turns_of(p[0], p[2]) * 24.0) + (int)(acos(fmin(1.0, fmax(-1.0, p[1]))) / CONIC_PI * 12.0)) % 2;
  double outward = sqrt(p[0] * p[0] + p[2] * p[2]) - 1.0;
  return ((int)(turns_of(p[0], p[2]) * 32.0) + (int)(turns_of(p[1], outward) * 12.0)) % 2;
}

/* The surface's colour where the ray meets it; 0 where it does not. */
static int see(conic_scene_type type, const ray *r, const float table[256], float color[3]) {
  static const unsigned char codes[3][2][3] = {{{32, 32, 32}, {255, 255, 255}},
                                               {{0x1c, 0x5d, 0x6b}, {0xf4, 0xe9, 0xd3}},
                                               {{0xd8, 0x4f, 0x3c}, {0xf7, 0xec, 0xdc}}};
  double p[3], t = type == CONIC_SCENE_PLANE ? hit_plane(r) : type == CONIC_SCENE_SPHERE ? hit_sphere(r) : hit_torus(r);
  int which = type == CONIC_SCENE_PLANE ? 0 : type == CONIC_SCENE_SPHERE ? 1 : 2;
  if (t <= 0.0)
    return 0;
  for (int i = 0; i < 3; i++)
    p[i] = r->from[i] + t * r->direction[i];
  for (int c = 0; c < 3; c++)
    color[c] = table[codes[which][is_light(type, p)][c]];
  return 1;
}

static ray ray_at(const conic_camera *camera, double x, double y) {
  ray r;
  double d[3] = {(x - camera->cx) / camera->fx, (y - camera->cy) / camera->fy, 1.0};
  double length = sqrt(d[0] * d[0] + d[1] * d[1] + 1.0);
  for (int i = 0; i < 3; i++) {
    r.from[i] = r.direction[i] = 0.0;
    for (int j = 0; j < 3; j++) {
      r.direction[i] += camera->cam_from_world[j][i] * d[j] / length;
      r.from[i] -= camera->cam_from_world[j][i] * camera->cam_from_world[j][3];
    }
  }
  return r;
}

/* A row of rays, each its colour and 1 or 0: `n` of them, from REACH pixels left of the picture on. */
static void cast_row(const cli_chart_scene *scene, const conic_camera *camera, const float table[256], double y, int n,
                     float (*row)[4]) {
  for (int i = 0; i < n; i++) {
    ray r = ray_at(camera, ((double)i + 0.5) / RAYS - REACH, y);
    memset(row[i], 0, sizeof row[i]);
    row[i][3] = (float)see(scene->type, &r, table, row[i]);
  }
}

/* Adds `weight` of the row, filtered across, to the sums of the pixels. */
static void add_row(float (*row)[4], const double weights[N_WEIGHTS], double weight, int width, double (*sums)[4]) {
  for (int x = 0; x < width; x++)
    for (int k = 0; k < N_WEIGHTS; k++)
      for (int c = 0; c < 4; c++)
        sums[x][c] += weight * weights[k] * (double)row[x * RAYS + RAYS / 2 + k][c];
}

static void finish_row(const cli_chart_scene *scene, const conic_camera *camera, const float table[256], int y,
                       double (*sums)[4], float *rgba, unsigned char *is_inside) {
  for (int x = 0; x < camera->width; x++) {
    float color[3];
    ray center = ray_at(camera, x + 0.5, y + 0.5);
    is_inside[x] = sums[x][3] > 1.0 - 1e-9;
    if (!see(scene->type, &center, table, color))
      continue;
    for (int c = 0; c < 3; c++)
      rgba[4 * x + c] = (float)(sums[x][c] / sums[x][3]);
    rgba[4 * x + 3] = 1.0f;
  }
}

/* Rays lie on a grid that is RAYS times as fine; a pixel's are symmetric about its centre. The rows of rays that a
 * pixel needs are kept as they move down. */
static void fill_rows(const cli_chart_scene *scene, const conic_camera *camera, float (*rows)[4], double (*sums)[4],
                      conic_image *truth, unsigned char *is_inside) {
  float table[256];
  double weights[N_WEIGHTS], sum = 0.0;
  size_t n = (size_t)(camera->width + MARGINS) * RAYS;
  conic_srgb_decode_table(table);
  for (int k = 0; k < N_WEIGHTS; k++) {
    double x = ((double)k + 0.5) / RAYS - REACH;
    sum += weights[k] = exp(-0.5 * x * x);
  }
  for (int k = 0; k < N_WEIGHTS; k++)
    weights[k] /= sum;
  for (int i = 0, done = 0; i < camera->height; i++) {
    memset(sums, 0, (size_t)camera->width * sizeof *sums);
    for (; done < i * RAYS + RAYS / 2 + N_WEIGHTS; done++)
      cast_row(scene, camera, table, ((double)done + 0.5) / RAYS - REACH, (int)n, rows + (size_t)done % N_ROWS * n);
    for (int k = 0; k < N_WEIGHTS; k++)
      add_row(rows + (size_t)(i * RAYS + RAYS / 2 + k) % N_ROWS * n, weights, weights[k], camera->width, sums);
    finish_row(scene, camera, table, i, sums,
               (float *)truth->planes[CONIC_PLANE_RGBA] + (size_t)4 * (size_t)i * (size_t)camera->width,
               is_inside + (size_t)i * (size_t)camera->width);
  }
}

conic_status cli_chart_truth(conic_context *context, const cli_chart_scene *scene, const conic_camera *camera,
                             conic_image *truth, unsigned char *is_inside) {
  size_t n = ((size_t)camera->width + MARGINS) * RAYS;
  conic_status status = conic_image_allocate(context, camera->width, camera->height, 1u << CONIC_PLANE_RGBA, truth);
  if (status != CONIC_OK)
    return status;
  float(*rows)[4] = malloc(N_ROWS * n * sizeof *rows);
  double(*sums)[4] = malloc((size_t)camera->width * sizeof *sums);
  if (rows && sums)
    fill_rows(scene, camera, rows, sums, truth, is_inside);
  else {
    conic_image_release(context, truth);
    status = CONIC_ERROR_MEMORY;
  }
  free(rows);
  free(sums);
  return status;
}
