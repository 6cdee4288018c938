/* What the tests of triangles share: sets filled by hand, and pictures of them beside splats. */
#pragma once

#include "tests/support/fixture.h"

static inline conic_triangles triangles_make(fixture *f, size_t count, size_t n_vertices, unsigned fields) {
  conic_triangles triangles;
  if (conic_triangles_allocate(f->context, count, n_vertices, fields, &triangles) != CONIC_OK)
    exit(1);
  return triangles;
}

static inline void triangles_vertex(conic_triangles *t, size_t i, double x, double y, double z) {
  t->position[0][i] = (float)x;
  t->position[1][i] = (float)y;
  t->position[2][i] = (float)z;
}

static inline void triangles_corner(conic_triangles *t, size_t i, uint32_t a, uint32_t b, uint32_t c) {
  t->corners[i][0] = a;
  t->corners[i][1] = b;
  t->corners[i][2] = c;
}

/* A closed grid of n × m vertices around a torus, or a sphere where `tube` is 0; both wound counter-clockwise from
 * outside. */
static inline conic_triangles triangles_torus(fixture *f, int n, int m, double tube) {
  conic_triangles t = triangles_make(f, 2 * (size_t)n * (size_t)m, (size_t)n * (size_t)m, 0);
  for (int i = 0; i < n; i++)
    for (int j = 0; j < m; j++) {
      double a = 6.283185307179586 * i / n, b = 6.283185307179586 * j / m, r = 1.0 + tube * cos(b);
      uint32_t here = (uint32_t)(i * m + j), right = (uint32_t)((i + 1) % n * m + j);
      uint32_t up = (uint32_t)(i * m + (j + 1) % m), both = (uint32_t)((i + 1) % n * m + (j + 1) % m);
      triangles_vertex(&t, here, r * cos(a), tube * sin(b), -r * sin(a));
      triangles_corner(&t, (size_t)here * 2, here, right, both);
      triangles_corner(&t, (size_t)here * 2 + 1, here, both, up);
    }
  return t;
}

/* Draws the fixture's splats and the triangles. */
static inline conic_status triangles_render(fixture *f, const conic_triangles *triangles, int samples) {
  const conic_drawing drawing = {f->splats.count ? &f->splats : NULL, triangles};
  conic_image_release(f->context, &f->image);
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, ALL_PLANES, &f->image));
  conic_status status = conic_render_drawing(f->context, f->renderer, &drawing, &f->camera, &f->options, samples,
                                             &f->image, &f->statistics);
  const conic_render_statistics *s = &f->statistics;
  CHECK(status != CONIC_OK || s->triangles_in == s->triangles_culled + s->triangles_skipped + s->triangles_drawn);
  return status;
}

/* A camera that sees the ball of radius 1.5 around the origin from direction i of the 26 to a cube's faces, edges and
 * corners. */
static inline void triangles_camera(fixture *f, int i, int size) {
  conic_framing framing;
  const double low[3] = {-0.9, -0.9, -0.9}, high[3] = {0.9, 0.9, 0.9};
  static const double elevations[5] = {-90, -45, 0, 45, 90};
  int level = i == 0 ? 0 : i == 25 ? 4 : 1 + (i - 1) / 8;
  conic_framing_init(&framing);
  framing.width = framing.height = size;
  framing.azimuth_deg = i == 0 || i == 25 ? 0.0 : (i - 1) % 8 * 45.0;
  framing.elevation_deg = elevations[level];
  CHECK_OK(conic_camera_frame(f->context, &framing, low, high, &f->camera));
}

static inline conic_texture *triangles_make_texture(fixture *f) {
  conic_image image;
  conic_texture *texture;
  CHECK_OK(conic_image_allocate(f->context, 37, 20, 1u << CONIC_PLANE_RGBA, &image));
  float *rgba = image.planes[CONIC_PLANE_RGBA];
  for (int i = 0; i < 37 * 20; i++)
    for (int channel = 0; channel < 4; channel++)
      rgba[4 * i + channel] = channel == 3 ? 1.0f : (float)((i * 7 + channel * 5) % 11) / 11.0f;
  CHECK_OK(conic_texture_create(f->context, &image, CONIC_WRAP_REPEAT, &texture));
  conic_image_release(f->context, &image);
  return texture;
}

/* Triangles of all sizes around and behind the camera, with colours, normals and a texture. */
static inline conic_triangles triangles_wild(fixture *f, size_t count) {
  conic_triangles t = triangles_make(f, count, 3 * count, 7);
  uint64_t state = 3;
  for (size_t i = 0; i < count; i++) {
    double size = pow(10.0, -3.0 * fixture_random(&state)), center[3];
    for (int axis = 0; axis < 3; axis++)
      center[axis] = 4.0 * (fixture_random(&state) - 0.5) + (axis == 2 ? 1.5 : 0.0);
    for (size_t k = 3 * i; k < 3 * i + 3; k++) {
      for (int axis = 0; axis < 3; axis++) {
        t.position[axis][k] = (float)(center[axis] + size * (fixture_random(&state) - 0.5));
        t.color[axis][k] = (float)fixture_random(&state);
        t.normal[axis][k] = (float)(fixture_random(&state) - 0.5);
      }
      for (int axis = 0; axis < 2; axis++)
        t.texture_coordinate[axis][k] = (float)(8.0 * fixture_random(&state) - 4.0);
    }
    triangles_corner(&t, i, (uint32_t)(3 * i), (uint32_t)(3 * i + 1), (uint32_t)(3 * i + 2));
  }
  t.position[0][5] = NAN;
  CHECK_OK(conic_triangles_texture(f->context, &t, triangles_make_texture(f)));
  return t;
}

/* A torus of splats in the midst of the wild triangles. */
static inline void triangles_torus_of_splats(fixture *f, size_t count) {
  fixture_scene(f, CONIC_SCENE_TORUS, count);
  f->splats.origin[2] = 1.5;
}
