/* Ear clipping: as long as a corner and its two neighbours make a triangle that lies within the polygon, it is one of
 * the triangles, and the polygon goes on without the corner. */
#include "core/splats/polygon.h"

#include "core/base/vectors.h"
#include "core/splats/faces.h"

enum { MOST_CORNERS = 256 };

typedef struct polygon {
  uint32_t n;
  double at[MOST_CORNERS][2]; /* seen along its normal, so that it runs counter-clockwise */
} polygon;

/* Corner k of a fan. */
static uint32_t fan_corner(const uint32_t (*triangles)[3], uint32_t k) {
  return k < 2 ? triangles[0][k] : triangles[k - 2][2];
}

/* Twice the area of a triangle of corners. */
static double area_of_corners(const polygon *p, uint32_t a, uint32_t b, uint32_t c) {
  return (p->at[b][0] - p->at[a][0]) * (p->at[c][1] - p->at[a][1]) -
         (p->at[b][1] - p->at[a][1]) * (p->at[c][0] - p->at[a][0]);
}

/* Along the axis that its normal, the sum of the cross products about the outline, is nearest to. False: it has no
 * area, or corners that are not finite, or not there. */
static int lay_flat(const conic_model *model, const uint32_t (*triangles)[3], polygon *p) {
  double normal[3] = {0.0, 0.0, 0.0}, place[MOST_CORNERS][3], side[2][3], cross[3];
  int axis = 0;
  for (uint32_t k = 0; k < p->n; k++) {
    uint32_t vertex = fan_corner(triangles, k);
    for (int i = 0; i < 3; i++) {
      if (vertex >= model->points.count)
        return 0;
      place[k][i] = (double)model->points.position[i][vertex];
    }
  }
  for (uint32_t k = 1; k + 1 < p->n; k++) {
    conic_subtract(place[k], place[0], side[0]);
    conic_subtract(place[k + 1], place[0], side[1]);
    conic_cross(side[0], side[1], cross);
    for (int i = 0; i < 3; i++)
      normal[i] += cross[i];
  }
  for (int i = 1; i < 3; i++)
    if (fabs(normal[i]) > fabs(normal[axis]))
      axis = i;
  if (!(fabs(normal[axis]) > 0.0) || normal[axis] - normal[axis] != 0.0)
    return 0;
  int right = (axis + 1) % 3, up = (axis + 2) % 3;
  for (uint32_t k = 0; k < p->n; k++) {
    p->at[k][0] = normal[axis] > 0.0 ? place[k][right] : place[k][up];
    p->at[k][1] = normal[axis] > 0.0 ? place[k][up] : place[k][right];
  }
  return 1;
}

static int is_fan_inside(const polygon *p) {
  for (uint32_t k = 1; k + 1 < p->n; k++)
    if (area_of_corners(p, 0, k, k + 1) < 0.0)
      return 0;
  return 1;
}

static int is_same_corner(const polygon *p, uint32_t a, uint32_t b) {
  return p->at[a][0] == p->at[b][0] && p->at[a][1] == p->at[b][1];
}

/* Whether corner k of the corners left makes a triangle with its neighbours, and no other corner lies in it. */
static int is_ear(const polygon *p, const uint32_t *left, uint32_t n_left, uint32_t k) {
  uint32_t a = left[(k + n_left - 1) % n_left], b = left[k], c = left[(k + 1) % n_left];
  if (!(area_of_corners(p, a, b, c) > 0.0))
    return 0;
  for (uint32_t i = 0; i < n_left; i++) {
    uint32_t other = left[i];
    if (other == a || other == b || other == c || is_same_corner(p, other, a) || is_same_corner(p, other, b) ||
        is_same_corner(p, other, c))
      continue;
    if (area_of_corners(p, a, b, other) >= 0.0 && area_of_corners(p, b, c, other) >= 0.0 &&
        area_of_corners(p, c, a, other) >= 0.0)
      return 0;
  }
  return 1;
}

/* The polygon's triangles by corners, in ears; 0 where it cannot be done. */
static int clip_ears(const polygon *p, uint32_t (*ears)[3]) {
  uint32_t left[MOST_CORNERS], n_left = p->n, n = 0;
  for (uint32_t k = 0; k < n_left; k++)
    left[k] = k;
  while (n_left > 3) {
    uint32_t k = 0;
    while (k < n_left && !is_ear(p, left, n_left, k))
      k++;
    if (k == n_left)
      return 0;
    ears[n][0] = left[(k + n_left - 1) % n_left];
    ears[n][1] = left[k];
    ears[n++][2] = left[(k + 1) % n_left];
    memmove(left + k, left + k + 1, (n_left - k - 1) * sizeof *left);
    n_left--;
  }
  memcpy(ears[n], left, sizeof *ears);
  return 1;
}

/* Gives a fan's corners to other triangles. */
static void deal_corners(uint32_t (*triangles)[3], const uint32_t (*ears)[3], uint32_t n) {
  uint32_t corners[MOST_CORNERS];
  for (uint32_t k = 0; k < n; k++)
    corners[k] = fan_corner((const uint32_t(*)[3])triangles, k);
  for (uint32_t i = 0; i + 2 < n; i++)
    for (int k = 0; k < 3; k++)
      triangles[i][k] = corners[ears[i][k]];
}

void conic_polygon_settle(conic_model *model, size_t first) {
  size_t n = model->n_triangles - first + 2;
  uint32_t ears[MOST_CORNERS][3];
  if (n < 4 || n > MOST_CORNERS)
    return;
  polygon p = {.n = (uint32_t)n};
  if (!lay_flat(model, (const uint32_t(*)[3])model->triangles + first, &p) || is_fan_inside(&p) || !clip_ears(&p, ears))
    return;
  deal_corners(model->triangles + first, (const uint32_t(*)[3])ears, p.n);
  if (model->faces && model->faces->count == model->n_triangles) {
    deal_corners(model->faces->normal_corners + first, (const uint32_t(*)[3])ears, p.n);
    deal_corners(model->faces->texture_corners + first, (const uint32_t(*)[3])ears, p.n);
  }
}
