/* What of a triangle lies before near and within the guard band.
 *
 * Each edge is cut by itself, from its ends in an order of their own, so that the triangles on its two sides get the
 * same new corner, bit for bit. */

#include "raster/triangles/triangle_frame.h"

/* Whether a comes before b, by their places alone. */
static int is_first(const conic_clip_corner *a, const conic_clip_corner *b) {
  for (int axis = 0; axis < 3; axis++)
    if (a->p[axis] != b->p[axis])
      return a->p[axis] < b->p[axis];
  return 1;
}

static conic_clip_corner cut(const conic_view *view, int i_plane, const conic_clip_corner *a,
                             const conic_clip_corner *b) {
  const conic_clip_corner *first = is_first(a, b) ? a : b, *last = first == a ? b : a;
  double from = conic_triangle_inside(view, i_plane, first->p), to = conic_triangle_inside(view, i_plane, last->p),
         t = from / (from - to);
  conic_clip_corner corner;
  for (int axis = 0; axis < 3; axis++)
    corner.p[axis] = first->p[axis] + t * (last->p[axis] - first->p[axis]);
  if (i_plane == 0)
    corner.p[2] = view->near_z;
  for (int i = 0; i < 2; i++)
    corner.at[i] = first->at[i] + t * (last->at[i] - first->at[i]);
  return corner;
}

static int clip_by(const conic_view *view, int i_plane, const conic_clip_corner *from, int n, conic_clip_corner *to) {
  int n_kept = 0;
  for (int i = 0; i < n; i++) {
    const conic_clip_corner *a = &from[i], *b = &from[(i + 1) % n];
    int a_is_in = conic_triangle_inside(view, i_plane, a->p) >= 0.0,
        b_is_in = conic_triangle_inside(view, i_plane, b->p) >= 0.0;
    if (a_is_in)
      to[n_kept++] = *a;
    if (a_is_in != b_is_in)
      to[n_kept++] = cut(view, i_plane, a, b);
  }
  return n_kept;
}

int conic_triangle_clip(const conic_triangle_frame *frame, size_t i, conic_clip_corner corners[CONIC_CLIPPED_CORNERS]) {
  conic_clip_corner other[CONIC_CLIPPED_CORNERS + 1];
  int n = 3;
  for (int k = 0; k < 3; k++) {
    conic_triangle_to_camera(frame, frame->triangles->corners[i][k], corners[k].p);
    corners[k].at[0] = k == 1 ? 1.0 : 0.0;
    corners[k].at[1] = k == 2 ? 1.0 : 0.0;
  }
  for (int i_plane = 0; i_plane < CONIC_TRIANGLE_PLANES && n; i_plane++) {
    n = clip_by(frame->view, i_plane, corners, n, other);
    n = n < 3 ? 0 : n;
    memcpy(corners, other, (size_t)n * sizeof *corners);
  }
  return n;
}
