/* Vertices on the screen, in plain C; triangle_body.h does the same in lanes. */
#include "raster/triangles/triangle_frame.h"

static double bounded(double value, double most) {
  value = value > -most ? value : -most;
  return value < most ? value : most;
}

/* To the nearest 1/256 px; halves up. What is added makes it positive, so that cutting off rounds down. */
static int32_t snapped(double px) {
  const double shift = 67108864.0; /* 2²⁶ */
  return (int32_t)(px * (double)CONIC_SUBPIXELS + (shift + 0.5)) - (int32_t)shift;
}

conic_screen_vertex conic_triangle_place(const conic_triangle_frame *frame, const double p[3]) {
  const conic_view *view = frame->view;
  const double guard = (double)CONIC_GUARD_PX;
  conic_screen_vertex vertex = {0, 0, 0.0f, 0};
  double iz = 1.0 / p[2], x = view->fx * p[0] * iz + view->cx, y = view->fy * p[1] * iz + view->cy;
  if (!(p[0] * 0.0 == 0.0 && p[1] * 0.0 == 0.0 && p[2] * 0.0 == 0.0)) {
    vertex.outside = CONIC_VERTEX_BAD;
    return vertex;
  }
  if (!(conic_triangle_inside(view, 0, p) >= 0.0)) {
    vertex.outside = CONIC_VERTEX_NEAR;
    return vertex;
  }
  for (int i_plane = 1; i_plane < CONIC_TRIANGLE_PLANES; i_plane++)
    if (!(conic_triangle_inside(view, i_plane, p) >= 0.0))
      vertex.outside |= (uint32_t)CONIC_VERTEX_NEAR << i_plane;
  if (!(iz >= CONIC_LEAST_IZ && iz <= CONIC_GREATEST_IZ))
    vertex.outside = CONIC_VERTEX_BAD;
  vertex.x = snapped(bounded(x, guard));
  vertex.y = snapped(bounded(y, guard));
  vertex.iz = vertex.outside == CONIC_VERTEX_BAD ? 0.0f : (float)iz;
  return vertex;
}

void conic_triangle_to_camera(const conic_triangle_frame *frame, uint32_t vertex, double p[3]) {
  const conic_triangles *t = frame->triangles;
  for (int row = 0; row < 3; row++) {
    const double *m = frame->view->rotation[row];
    p[row] = ((m[0] * (double)t->position[0][vertex] + m[1] * (double)t->position[1][vertex]) +
              m[2] * (double)t->position[2][vertex]) +
             frame->translation[row];
  }
}

void conic_triangle_vertices(const conic_triangle_frame *frame, size_t begin, size_t end,
                             conic_screen_vertex *vertices) {
  for (size_t i = begin; i < end; i++) {
    double p[3];
    conic_triangle_to_camera(frame, (uint32_t)i, p);
    vertices[i] = conic_triangle_place(frame, p);
  }
}
