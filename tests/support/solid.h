/* Pictures of a cube, or of one that lacks an octant, against the solid itself: no holes, and nothing sticks out. */
#pragma once

#include "tests/support/fixture.h"

/* The part of the ray o + t·d, t > 0, that is in the box [low, high]³; 0 where none is. */
static inline int solid_box(const double o[3], const double d[3], double low, double high, double range[2]) {
  range[0] = 0.0;
  range[1] = 1e30;
  for (int axis = 0; axis < 3; axis++) {
    double a = (low - o[axis]) / d[axis], b = (high - o[axis]) / d[axis];
    range[0] = fmax(range[0], fmin(a, b));
    range[1] = fmin(range[1], fmax(a, b));
  }
  return range[0] < range[1];
}

/* Whether the ray through a place of the screen meets the solid. */
static inline int solid_is_hit(const conic_camera *camera, int lacks_octant, double x, double y) {
  const double ray[3] = {(x - camera->cx) / camera->fx, (y - camera->cy) / camera->fy, 1.0};
  double o[3] = {0, 0, 0}, d[3] = {0, 0, 0}, outer[2], inner[2];
  for (int axis = 0; axis < 3; axis++)
    for (int row = 0; row < 3; row++) {
      o[axis] -= camera->cam_from_world[row][axis] * camera->cam_from_world[row][3];
      d[axis] += camera->cam_from_world[row][axis] * ray[row];
    }
  if (!solid_box(o, d, -0.5, 0.5, outer))
    return 0;
  if (!lacks_octant || !solid_box(o, d, 0.0, 0.5, inner))
    return 1;
  return outer[0] < inner[0] - 1e-9 || inner[1] + 1e-9 < outer[1];
}

/* Whether one of the nine places `reach_px` around the pixel's centre meets the solid, or, asked for `all`, all do. */
static inline int solid_hits(const conic_camera *camera, int lacks_octant, int x, int y, double reach_px, int all) {
  int is_hit = all;
  for (int i = 0; i < 9 && is_hit == all; i++) /* the centre first, which tells most */
    is_hit = solid_is_hit(camera, lacks_octant, x + 0.5 + reach_px * ((i + 4) / 3 % 3 - 1),
                          y + 0.5 + reach_px * ((i + 1) % 3 - 1));
  return is_hit;
}

typedef struct solid_verdict {
  int n_covered, n_holes, n_outside;
} solid_verdict;

/* Holes are pixels that are not covered though the solid is there by more than `hole_px`, outside are those that are
 * covered though it is farther than `outside_px`. */
static inline solid_verdict solid_judge(const fixture *f, int lacks_octant, double hole_px, double outside_px) {
  solid_verdict verdict = {0, 0, 0};
  for (int y = 0; y < f->camera.height; y++)
    for (int x = 0; x < f->camera.width; x++) {
      int is_covered = fixture_index(f, CONIC_PLANE_ID, x, y) != CONIC_NO_ID;
      verdict.n_covered += is_covered;
      if (is_covered)
        verdict.n_outside += !solid_hits(&f->camera, lacks_octant, x, y, outside_px, 0);
      else
        verdict.n_holes += solid_hits(&f->camera, lacks_octant, x, y, hole_px, 1);
    }
  return verdict;
}

/* Looks at the cube from that direction. */
static inline void solid_look(fixture *f, double azimuth_deg, double elevation_deg, double zoom) {
  const double low[3] = {-0.5, -0.5, -0.5}, high[3] = {0.5, 0.5, 0.5};
  conic_framing framing;
  conic_framing_init(&framing);
  framing.width = 331;
  framing.height = 317;
  framing.azimuth_deg = azimuth_deg;
  framing.elevation_deg = elevation_deg;
  framing.zoom = zoom;
  CHECK_OK(conic_camera_frame(f->context, &framing, low, high, &f->camera));
}

/* Judges the splats from all sides. Where a face is nearly edge-on, its lines fall on its trace and clip little along
 * it: there splats may stick out by `edge_on_px`, as far as the prefilter widens them. */
static inline void solid_check(fixture *f, int lacks_octant, double hole_px, double outside_px, double edge_on_px) {
  static const double views[][3] = {{45, 35.26, 1}, {60, -40, 1}, {200, 70, 1}, {44, 34, 3.1},
                                    {30, 15, 1},    {0, 0, 1},    {10, 1, 1},   {90, 0, 1.7}};
  enum { N_STEEP = 4 };
  for (size_t i = 0; i < sizeof views / sizeof views[0]; i++) {
    solid_look(f, views[i][0], views[i][1], views[i][2]);
    fixture_render(f);
    double allowed_px = i < N_STEEP ? outside_px : edge_on_px;
    solid_verdict verdict = solid_judge(f, lacks_octant, hole_px, allowed_px);
    if (verdict.n_holes || verdict.n_outside || verdict.n_covered < 1000) {
      fprintf(stderr, "from %g, %g: %d covered, %d holes, %d outside\n", views[i][0], views[i][1], verdict.n_covered,
              verdict.n_holes, verdict.n_outside);
      check_failures++;
    }
  }
}
