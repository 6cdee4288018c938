/* What octree_view.h says of measuring: plain C, which compilers put in lanes. */
#include <math.h>

#include "lod/octree/octree_loops.h"

/* A displacement by e of what is at X changes its projection by no more than f·e·|X|/z²: the greatest factor of the
 * projection's derivative is f·|X|/z². All that a node is about, from its leaves' discs to its own, lies in its sphere,
 * and so does the way from the one to the other. */
static inline void measure_errors(const conic_octree *octree, const conic_octree_view *view, size_t begin,
                                  float *pixels) {
  const float *x = octree->center[0] + begin, *y = octree->center[1] + begin, *z = octree->center[2] + begin;
  const float *radius = octree->radius + begin, *error = octree->error + begin;
  const conic_octree_view v = *view;
  for (int i = 0; i < CONIC_OCTREE_GROUP; i++) {
    float cx = ((v.rotation[0][0] * x[i] + v.rotation[0][1] * y[i]) + v.rotation[0][2] * z[i]) + v.translation[0];
    float cy = ((v.rotation[1][0] * x[i] + v.rotation[1][1] * y[i]) + v.rotation[1][2] * z[i]) + v.translation[1];
    float cz = ((v.rotation[2][0] * x[i] + v.rotation[2][1] * y[i]) + v.rotation[2][2] * z[i]) + v.translation[2];
    float r = radius[i] + (v.slack * ((fabsf(x[i]) + fabsf(y[i])) + fabsf(z[i])) + v.slack_offset);
    float distance = sqrtf((cx * cx + cy * cy) + cz * cz) + r, front = cz - r;
    float size = v.focal_px * error[i] * distance / (front * front);
    float left = v.side[0][0] * cx + v.side[0][2] * cz, right = v.side[1][0] * cx + v.side[1][2] * cz;
    float top = v.side[2][1] * cy + v.side[2][2] * cz, bottom = v.side[3][1] * cy + v.side[3][2] * cz;
    float least = left < right ? left : right;
    least = top < least ? top : least;
    least = bottom < least ? bottom : least;
    float before = cz - v.near_z;
    least = before < least ? before : least;
    size = front > v.near_z ? size : HUGE_VALF;
    pixels[i] = least < -r ? -1.0f : size;
  }
}

/* How a node is turned to the viewer, on the way from the eye to its middle. */
typedef struct node_turn {
  float along, distance; /* the way: its part along the normal, its length */
  float r;               /* the sphere's radius */
  float cos_c, sin_c;    /* of θ, half the cone's opening */
} node_turn;

/* Whether all leaves face away: where the angle between the way and the axis, θ, and α, half the angle under which the
 * sphere is seen, are less than a right angle together. */
static inline int all_face_away(const node_turn *t) {
  float sin_a = t->r / t->distance, cos_a2 = 1.0f - sin_a * sin_a, cos_a = sqrtf(cos_a2 > 0.0f ? cos_a2 : 0.0f);
  float cos_both = cos_a * t->cos_c - sin_a * t->sin_c, sin_both = sin_a * t->cos_c + cos_a * t->sin_c;
  float least = t->cos_c < cos_both ? t->cos_c : cos_both; /* all of these must be above 0 */
  least = cos_a2 < least ? cos_a2 : least;
  float beyond = t->along - t->distance * (sin_both + 1e-5f);
  least = beyond < least ? beyond : least;
  return least > 0.0f;
}

/* No place of a leaf is seen under a greater cosine to its normal, from either side. On the way to the node's middle
 * that is the cosine of γ - θ, where γ is the angle to the axis (Confetti §6.2). A leaf's plane passes the middle
 * within half the error, and the sphere's radius times the sine of θ; no place is nearer than the sphere. */
static inline float greatest_cosine(const node_turn *t, float error) {
  float cos_g = fabsf(t->along) / t->distance, sin_g2 = 1.0f - cos_g * cos_g;
  float sin_g = sqrtf(sin_g2 > 0.0f ? sin_g2 : 0.0f), between = cos_g * t->cos_c + sin_g * t->sin_c;
  float high = t->distance * between + (t->r * t->sin_c + 0.5f * error), near = t->distance - t->r;
  return cos_g < t->cos_c && high < near ? high / near : 1.0f;
}

/* How much of its error a node counts by that is seen under no greater cosine: its root, for then it is off by as large
 * an area as one that is seen from the front. Where the error is more than the size of the disc asks for, something
 * sticks out, which shows at its full length; this is let go last of all. Where normals differ, the disc is bent, and
 * from the side the bend shows. */
static inline float weight_of_tilt(float cosine, float root, float excess, float sin_c) {
  const float strong = CONIC_COVER_WEIGHT * CONIC_COVER_WEIGHT, bent = 16.0f * sin_c;
  float early = root * excess, late = cosine * strong, weight = early < late ? early : late;
  weight = weight > root ? weight : root;
  weight = bent > weight ? bent : weight;
  return weight < 1.0f ? weight : 1.0f;
}

/* With --cull back, nodes whose leaves all face away are out of sight. Where some may face away and others not, a part
 * of what the node shows is culled, and what is left may be at its other end. So its error is its diameter, and
 * somewhat more by the root, as outlines are there. */
static inline void weigh_by_tilt(const conic_octree *octree, const conic_octree_view *view, size_t begin,
                                 float *pixels) {
  const float *x = octree->center[0] + begin, *y = octree->center[1] + begin, *z = octree->center[2] + begin;
  const float *nx = octree->normal[0] + begin, *ny = octree->normal[1] + begin, *nz = octree->normal[2] + begin;
  const float *radius = octree->radius + begin, *cone = octree->cone + begin, *error = octree->error + begin;
  const float *excess = octree->excess + begin, least = 1.0f / CONIC_COVER_WEIGHT;
  const conic_octree_view v = *view;
  for (int i = 0; i < CONIC_OCTREE_GROUP; i++) {
    float dx = x[i] - v.eye[0], dy = y[i] - v.eye[1], dz = z[i] - v.eye[2], sin_c2 = 1.0f - cone[i] * cone[i];
    node_turn turn = {.along = (dx * nx[i] + dy * ny[i]) + dz * nz[i],
                      .distance = sqrtf((dx * dx + dy * dy) + dz * dz),
                      .r = radius[i] + (v.slack * ((fabsf(x[i]) + fabsf(y[i])) + fabsf(z[i])) + v.slack_offset),
                      .cos_c = cone[i],
                      .sin_c = sqrtf(sin_c2 > 0.0f ? sin_c2 : 0.0f)};
    float cosine = greatest_cosine(&turn, error[i]), root = sqrtf(cosine);
    root = root > least ? root : least;
    float tilted = pixels[i] * weight_of_tilt(cosine, root, excess[i], turn.sin_c);
    float culled = sqrtf(root) * sqrtf(sqrtf(root)), whole = pixels[i] * (culled * (2.0f * radius[i] / error[i]));
    int is_mixed = v.cull_back & (turn.along > -turn.distance * turn.sin_c);
    int is_away = v.cull_back & all_face_away(&turn);
    float size = is_mixed ? whole : tilted;
    size = pixels[i] > 0.0f ? size : pixels[i];
    pixels[i] = is_away ? -1.0f : size;
  }
}

static void measure(const conic_octree *octree, const conic_octree_view *view, size_t begin, size_t n, float *pixels) {
  for (size_t k = 0; k < n; k += CONIC_OCTREE_GROUP) {
    measure_errors(octree, view, begin + k, pixels + k);
    weigh_by_tilt(octree, view, begin + k, pixels + k);
  }
}
