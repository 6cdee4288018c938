/* How far a node's disc reaches past what it stands for. */
#include <math.h>

#include "core/trigonometry.h"
#include "lod/octree_fit.h"

void conic_disc_samples_init(conic_disc_samples *samples) {
  /* Rings, turned against each other; found by search, the gap is held by a test. */
  static const struct {
    int n;
    double radius, turn;
  } rings[] = {{3, 0.1131, 0.904}, {9, 0.3853, 0.171}, {14, 0.6305, 0.463}, {22, 0.8878, 0.533}};
  int n = 0;
  for (int ring = 0; ring < 4; ring++)
    for (int i = 0; i < rings[ring].n; i++) {
      double angle = 2.0 * CONIC_PI * ((double)i + rings[ring].turn) / (double)rings[ring].n;
      samples->x[n] = (float)(rings[ring].radius * conic_cos(angle));
      samples->y[n++] = (float)(rings[ring].radius * conic_sin(angle));
    }
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* A disc seen along the frame's normal: an ellipse, and what takes it to the unit circle. */
typedef struct flat_disc {
  float x, y;
  float inverse[4]; /* zero where it is seen from its edge: then it counts by its centre */
  float height2;    /* the square of how far it is off the plane at most */
  float error;
} flat_disc;

static flat_disc flatten(const conic_node_frame *frame, const conic_octree_disc *disc) {
  double apart[3], ux = dot(disc->u, frame->u), uy = dot(disc->u, frame->v);
  double vx = dot(disc->v, frame->u), vy = dot(disc->v, frame->v), determinant = ux * vy - uy * vx;
  double uz = dot(disc->u, frame->n), vz = dot(disc->v, frame->n);
  for (int axis = 0; axis < 3; axis++)
    apart[axis] = disc->center[axis] - frame->position[axis];
  double height = fabs(dot(apart, frame->n)) + sqrt(uz * uz + vz * vz);
  flat_disc flat = {.x = (float)dot(apart, frame->u), .y = (float)dot(apart, frame->v), .error = (float)disc->error};
  flat.height2 = (float)(height * height);
  if (fabs(determinant) > 1e-6 * (ux * ux + uy * uy + vx * vx + vy * vy)) {
    flat.inverse[0] = (float)(vy / determinant);
    flat.inverse[1] = (float)(-vx / determinant);
    flat.inverse[2] = (float)(-uy / determinant);
    flat.inverse[3] = (float)(ux / determinant);
  }
  return flat;
}

/* Lowers each sample's distance to that of this disc: along the line to its centre, to its outline; and from the plane.
 */
static void approach(const flat_disc *disc, const float *x, const float *y, float *nearest) {
  int is_edge_on = disc->inverse[0] == 0.0f && disc->inverse[1] == 0.0f;
  for (int i = 0; i < CONIC_DISC_SAMPLES; i++) {
    float dx = x[i] - disc->x, dy = y[i] - disc->y;
    float a = disc->inverse[0] * dx + disc->inverse[1] * dy, b = disc->inverse[2] * dx + disc->inverse[3] * dy;
    float outside = is_edge_on ? 1.0f : 1.0f - 1.0f / sqrtf(a * a + b * b); /* of the way to the centre */
    outside = outside > 0.0f ? outside : 0.0f;
    float distance = sqrtf((dx * dx + dy * dy) * (outside * outside) + disc->height2) + disc->error;
    nearest[i] = distance < nearest[i] ? distance : nearest[i];
  }
}

double conic_octree_overshoot(const conic_disc_samples *samples, const conic_node_frame *frame, double reach,
                              const conic_octree_disc *discs, int n_discs) {
  float x[CONIC_DISC_SAMPLES], y[CONIC_DISC_SAMPLES], nearest[CONIC_DISC_SAMPLES], greatest = 0.0f;
  for (int i = 0; i < CONIC_DISC_SAMPLES; i++) {
    x[i] = (float)reach * samples->x[i];
    y[i] = (float)(reach * frame->ratio) * samples->y[i];
    nearest[i] = HUGE_VALF;
  }
  for (int i = 0; i < n_discs; i++) {
    flat_disc flat = flatten(frame, &discs[i]);
    approach(&flat, x, y, nearest);
  }
  for (int i = 0; i < CONIC_DISC_SAMPLES; i++)
    greatest = nearest[i] > greatest ? nearest[i] : greatest;
  /* The distance from a point changes no faster than the point moves; a hair more for the floats. */
  return ((double)greatest + CONIC_DISC_GAP * reach) * (1.0 + 1e-5);
}
