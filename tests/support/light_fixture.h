/* What the tests of lighting share: meshes, a caster that draws them, and light worked out by rays. */
#pragma once

#include "tests/support/fixture.h"
#include "tests/support/ray_mesh.h"

static const double light_pi = 3.14159265358979323846;

/* Draws a drawing's depth, for conic_casters. */
typedef struct light_drawer {
  conic_context *context;
  conic_renderer *renderer;
  const conic_drawing *drawing;
  conic_render_options options;
  double splat_length; /* of the drawing's splats, if it has any */
  int n_maps;
} light_drawer;

static inline conic_status light_draw(void *cookie, const conic_camera *camera, double near_z, conic_image *depth) {
  light_drawer *d = cookie;
  conic_render_options options = d->options;
  options.near_z = near_z;
  options.passes = CONIC_PASS_OF_HIDING;
  options.splat_length = CONIC_MAP_LENGTHS * d->splat_length;
  d->n_maps++;
  return conic_render_drawing(d->context, d->renderer, d->drawing, camera, &options, 1, depth, NULL);
}

static inline conic_casters light_casters(light_drawer *drawer, double epsilon) {
  conic_casters casters = {.draw = light_draw, .cookie = drawer, .epsilon = epsilon, .epsilon_is_drawn = 1};
  if (drawer->drawing->splats)
    CHECK_OK(conic_splats_length(drawer->context, drawer->drawing->splats, &drawer->splat_length));
  conic_drawing_bounds(drawer->drawing, casters.minimum, casters.maximum);
  return casters;
}

/* A mesh that is filled triangle by triangle, without vertices in common. */
static inline void light_triangle(conic_triangles *t, const double a[3], const double b[3], const double c[3]) {
  const double *corners[3] = {a, b, c};
  for (uint32_t corner = 0; corner < 3; corner++) {
    uint32_t vertex = (uint32_t)(3 * t->count) + corner;
    for (int axis = 0; axis < 3; axis++)
      t->position[axis][vertex] = (float)corners[corner][axis];
    t->corners[t->count][corner] = vertex;
  }
  t->count++;
}

static inline void light_quad(conic_triangles *t, const double a[3], const double b[3], const double c[3],
                              const double d[3]) {
  light_triangle(t, a, b, c);
  light_triangle(t, a, c, d);
}

static inline conic_triangles light_mesh(conic_context *context, size_t most) {
  conic_triangles t;
  if (conic_triangles_allocate(context, most, 3 * most, 0, &t) != CONIC_OK)
    exit(1);
  t.count = 0;
  return t;
}

/* The six sides of a box. */
static inline void light_box(conic_triangles *t, const double low[3], const double high[3]) {
  for (int side = 0; side < 6; side++) {
    int axis = side / 2, i = (axis + 1) % 3, j = (axis + 2) % 3;
    double p[4][3];
    for (int corner = 0; corner < 4; corner++) {
      int right = corner == 1 || corner == 2, top = corner >= 2;
      p[corner][axis] = side % 2 ? high[axis] : low[axis];
      p[corner][i] = right ? high[i] : low[i];
      p[corner][j] = top ? high[j] : low[j];
    }
    light_quad(t, p[0], side % 2 ? p[1] : p[3], p[2], side % 2 ? p[3] : p[1]);
  }
}

/* y = f(x, z) over a square of edge 2·half about the origin, of n × n cells. */
static inline void light_field(conic_triangles *t, int n, double half, double (*height)(double x, double z)) {
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      double p[4][3];
      for (int corner = 0; corner < 4; corner++) {
        p[corner][0] = half * (2.0 * (i + (corner == 1 || corner == 2)) / n - 1.0);
        p[corner][2] = half * (2.0 * (j + (corner >= 2)) / n - 1.0);
        p[corner][1] = height(p[corner][0], p[corner][2]);
      }
      light_quad(t, p[0], p[3], p[2], p[1]);
    }
}

static inline double light_flat(double x, double z) {
  (void)x;
  (void)z;
  return 0.0;
}

/* A cube of edge 1 on a square of edge 6. */
static inline conic_triangles light_cube_on_plane(conic_context *context) {
  conic_triangles t = light_mesh(context, 2 * 100 + 12);
  light_field(&t, 10, 3.0, light_flat);
  light_box(&t, (const double[3]){-0.5, 0.0, -0.5}, (const double[3]){0.5, 1.0, 0.5});
  return t;
}

/* n × m quads about the origin. */
static inline void light_ball(conic_triangles *t, int n, int m) {
  for (int i = 0; i < n; i++)
    for (int j = 0; j < m; j++) {
      double p[4][3];
      for (int corner = 0; corner < 4; corner++) {
        double a = 2.0 * light_pi * (i + (corner == 1 || corner == 2)) / n, b = light_pi * (j + (corner >= 2)) / m;
        p[corner][0] = sin(b) * cos(a);
        p[corner][1] = cos(b);
        p[corner][2] = -sin(b) * sin(a);
      }
      light_quad(t, p[0], p[3], p[2], p[1]);
    }
}

/* Discs about a ball. */
static inline conic_splats light_splats_on_ball(conic_context *context, size_t n) {
  conic_splats splats;
  if (conic_splats_allocate(context, n, CONIC_SPLATS_TANGENTS, &splats) != CONIC_OK)
    exit(1);
  double size = sqrt(4.0 * light_pi / (double)n);
  for (size_t i = 0; i < n; i++) {
    double y = 1.0 - 2.0 * ((double)i + 0.5) / (double)n, r = sqrt(1.0 - y * y), a = 2.399963229728653 * (double)i;
    double p[3] = {r * cos(a), y, r * sin(a)}, u[3] = {-sin(a), 0.0, cos(a)}, v[3];
    for (int axis = 0; axis < 3; axis++)
      v[axis] = p[(axis + 1) % 3] * u[(axis + 2) % 3] - p[(axis + 2) % 3] * u[(axis + 1) % 3];
    for (int axis = 0; axis < 3; axis++) {
      splats.position[axis][i] = (float)p[axis];
      splats.tangent_u[axis][i] = (float)(size * u[axis]);
      splats.tangent_v[axis][i] = (float)(size * v[axis]);
    }
  }
  return splats;
}

/* A picture of a drawing with depth, normals and what light makes of them. */
typedef struct light_picture {
  conic_camera camera;
  conic_image image;
} light_picture;

enum {
  LIGHT_PLANES = 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_NORMAL | 1u << CONIC_PLANE_AO | 1u << CONIC_PLANE_SHADOW
};

static inline light_picture light_take_picture(light_drawer *drawer, int size, double azimuth, double elevation,
                                               unsigned planes) {
  light_picture picture;
  conic_framing framing;
  conic_framing_init(&framing);
  framing.width = framing.height = size;
  framing.azimuth_deg = azimuth;
  framing.elevation_deg = elevation;
  CHECK_OK(conic_drawing_frame(drawer->context, drawer->drawing, 1.5f, &framing, 1, &picture.camera, NULL));
  CHECK_OK(conic_image_allocate(drawer->context, size, size, planes, &picture.image));
  CHECK_OK(conic_render_drawing(drawer->context, drawer->renderer, drawer->drawing, &picture.camera, &drawer->options,
                                1, &picture.image, NULL));
  return picture;
}

/* Where a pixel's surface is, and its normal; 0 where nothing is. */
static inline int light_place(const light_picture *picture, int x, int y, double place[3], double normal[3]) {
  const conic_camera *c = &picture->camera;
  size_t pixel = (size_t)y * (size_t)c->width + (size_t)x;
  double z = (double)((const float *)picture->image.planes[CONIC_PLANE_Z])[pixel];
  double from_cam[3] = {z * (x + 0.5 - c->cx) / c->fx, z * (y + 0.5 - c->cy) / c->fy, z};
  for (int axis = 0; axis < 3; axis++) {
    place[axis] = 0.0;
    for (int row = 0; row < 3; row++)
      place[axis] += c->cam_from_world[row][axis] * (from_cam[row] - c->cam_from_world[row][3]);
    normal[axis] = (double)((const float *)picture->image.planes[CONIC_PLANE_NORMAL])[3 * pixel + (size_t)axis];
  }
  return z > 0.0;
}

/* Whether no outline is near: a pixel there gets what its neighbours get. */
static inline int light_is_covered_about(const light_picture *picture, int x, int y) {
  int n = 0;
  for (int k = 0; k < 25; k++) {
    int i = x + k % 5 - 2, j = y + k / 5 - 2;
    size_t pixel = (size_t)j * (size_t)picture->camera.width + (size_t)i;
    n += i >= 0 && j >= 0 && i < picture->camera.width && j < picture->camera.height &&
         ((const float *)picture->image.planes[CONIC_PLANE_Z])[pixel] > 0.0f;
  }
  return n == 25;
}

/* Ambient occlusion by n × n rays, one in each part of the hemisphere that counts the same, from so far above the
 * place that it lies on no wrong side for want of digits. */
static inline double light_occlusion_by_rays(const ray_mesh *mesh, const double place[3], const double normal[3], int n,
                                             double lift) {
  double u[3], v[3], helper[3] = {0.0, 0.0, 0.0}, d[3], from[3];
  int n_free = 0;
  helper[fabs(normal[0]) < 0.5 ? 0 : 1] = 1.0;
  for (int axis = 0; axis < 3; axis++) {
    int i = (axis + 1) % 3, j = (axis + 2) % 3;
    u[axis] = helper[i] * normal[j] - helper[j] * normal[i];
  }
  double length = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
  for (int axis = 0; axis < 3; axis++)
    u[axis] /= length;
  for (int axis = 0; axis < 3; axis++) {
    int i = (axis + 1) % 3, j = (axis + 2) % 3;
    v[axis] = normal[i] * u[j] - normal[j] * u[i];
    from[axis] = place[axis] + lift * normal[axis];
  }
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      double square = (i + 0.5) / n, angle = 2.0 * light_pi * (j + 0.5) / n;
      double a = sqrt(square) * cos(angle), b = sqrt(square) * sin(angle), c = sqrt(1.0 - square);
      for (int axis = 0; axis < 3; axis++)
        d[axis] = a * u[axis] + b * v[axis] + c * normal[axis];
      n_free += !ray_is_blocked(mesh, from, d, HUGE_VAL);
    }
  return (double)n_free / (n * n);
}
