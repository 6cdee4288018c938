/* Colours of a row's pixels by their planes, with the bits of conic_shade, in plain C that compilers put in lanes. */
#include <math.h>

#include "lighting/light_map.h"
#include "raster/tiles/light_terms.h"

enum { SHADED_TOGETHER = 256 };

typedef struct shaded_run {
  float viewer[3][SHADED_TOGETHER], lit[3][SHADED_TOGETHER], glossy[3][SHADED_TOGETHER];
} shaded_run;

/* conic_pixel_viewer of a pinhole. */
static void look_back(const conic_shaded_row *row, size_t begin, size_t n, shaded_run *run) {
  const conic_camera camera = *row->rays->camera;
  const double(*m)[4] = camera.cam_from_world;
  const double down = ((double)row->y + 0.5 - camera.cy) / camera.fy;
  float *restrict x = run->viewer[0], *restrict y = run->viewer[1], *restrict z = run->viewer[2];
  for (size_t i = 0; i < n; i++) {
    double right = ((double)(int)(begin + i) + 0.5 - camera.cx) / camera.fx, world[3];
    for (int axis = 0; axis < 3; axis++)
      world[axis] = -((m[0][axis] * right + m[1][axis] * down) + m[2][axis]);
    double length = sqrt((world[0] * world[0] + world[1] * world[1]) + world[2] * world[2]);
    int is_good = (length > 0.0) & (length - length == 0.0);
    x[i] = (float)(is_good ? world[0] / length : 0.0);
    y[i] = (float)(is_good ? world[1] / length : 0.0);
    z[i] = (float)(is_good ? world[2] / length : 0.0);
  }
}

static void look_back_bent(const conic_shaded_row *row, size_t begin, size_t n, shaded_run *run) {
  for (size_t i = 0; i < n; i++) {
    float viewer[3];
    conic_pixel_viewer(row->rays, begin + i, row->y, viewer);
    for (int axis = 0; axis < 3; axis++)
      run->viewer[axis][i] = viewer[axis];
  }
}

static void add_to_run(const conic_shaded_row *row, int i_light, size_t begin, size_t n, shaded_run *run) {
  const conic_finish_light light = row->finish->lights->lights[i_light];
  const float *normals = row->normal + 3 * begin;
  const int is_phong = row->finish->options->shading == CONIC_SHADE_PHONG;
  shaded_run *restrict r = run;
  for (size_t i = 0; i < n; i++) {
    float normal[3], viewer[3], lit[3], glossy[3];
    for (int axis = 0; axis < 3; axis++) {
      normal[axis] = normals[3 * i + (size_t)axis];
      viewer[axis] = r->viewer[axis][i];
      lit[axis] = r->lit[axis][i];
      glossy[axis] = r->glossy[axis][i];
    }
    conic_light_add(&light, is_phong, normal, normal, viewer, lit, glossy);
    for (int axis = 0; axis < 3; axis++) {
      r->lit[axis][i] = lit[axis];
      r->glossy[axis][i] = glossy[axis];
    }
  }
}

static void begin_run(const conic_shaded_row *row, size_t begin, size_t n, shaded_run *run) {
  const conic_finish_lights lights = *row->finish->lights;
  const float *normals = row->normal + 3 * begin;
  shaded_run *restrict r = run;
  for (size_t i = 0; i < n; i++) {
    float normal[3] = {normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]}, lit[3];
    conic_light_from_around(&lights, normal, lit);
    for (int axis = 0; axis < 3; axis++) {
      r->lit[axis][i] = lit[axis];
      r->glossy[axis][i] = 0.0f;
    }
  }
}

static void end_run(const conic_shaded_row *row, size_t begin, size_t n, const shaded_run *r, float *restrict shaded) {
  const float *albedo = row->albedo + 3 * begin, *coverage = row->coverage + begin;
  const int is_plain = row->finish->options->shading == CONIC_SHADE_NONE;
  for (size_t i = 0; i < n; i++)
    for (size_t c = 0; c < 3; c++) {
      float own = albedo[3 * i + c] / coverage[i];
      shaded[3 * i + c] = is_plain ? own : own * r->lit[c][i] + r->glossy[c][i];
    }
}

static void shade(const conic_shaded_row *row, size_t begin, size_t end, float *shaded) {
  shaded_run run;
  const int n_lights = row->finish->lights->n_lights;
  for (size_t first = begin; first < end; first += SHADED_TOGETHER) {
    const size_t n = end - first < SHADED_TOGETHER ? end - first : SHADED_TOGETHER;
    if (n_lights > 0) /* what is from all around looks alike from everywhere */
      (row->rays->is_pinhole ? look_back : look_back_bent)(row, first, n, &run);
    begin_run(row, first, n, &run);
    for (int i = 0; i < n_lights; i++)
      add_to_run(row, i, first, n, &run);
    end_run(row, first, n, &run, shaded + 3 * (first - begin));
  }
}
