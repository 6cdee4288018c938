/* Solids of solids, against their formulas: whatever lies on the true surface is drawn, and nothing beyond the seam. */
#include "conic/csg.h"
#include "conic/scene.h"
#include "tests/support/check.h"
#include "tests/support/sanitized.h"

static const double cutoff = 1.5;

/* A ball of radius 1, or a cube of edge 1. */
typedef struct shape {
  conic_scene_type type;
  double center[3];
} shape;

/* How far a point is outside, less than 0 within. */
static double height_above(const shape *s, const double p[3]) {
  double d[3], most = -1e30, sum = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    d[axis] = p[axis] - s->center[axis];
    sum += d[axis] * d[axis];
    most = fmax(most, fabs(d[axis]) - 0.5);
  }
  return s->type == CONIC_SCENE_SPHERE ? sqrt(sum) - 1.0 : most;
}

static conic_splats sample(conic_context *context, const shape *s, size_t count) {
  conic_scene_options options;
  conic_scene *scene;
  conic_splats splats;
  conic_scene_options_init(&options);
  options.type = s->type;
  options.count = count;
  memcpy(options.offset, s->center, sizeof options.offset);
  CHECK_OK(conic_scene_create(context, &options, &scene));
  CHECK_OK(conic_splats_allocate(context, count, conic_scene_fields(s->type), &splats));
  CHECK_OK(conic_scene_sample(scene, 0, count, &splats));
  conic_scene_destroy(scene);
  return splats;
}

static int keeps(const conic_clip *clip, double u, double v) {
  int kept[2] = {1, 1};
  for (int k = 0; k < clip->n_lines; k++)
    kept[k] = (double)clip->lines[k][0] * u + (double)clip->lines[k][1] * v + (double)clip->lines[k][2] >= -1e-5;
  return clip->n_lines == 2 && clip->operation == CONIC_CLIP_OR ? kept[0] || kept[1] : kept[0] && kept[1];
}

static void place_of(const conic_splats *splats, size_t i, double u, double v, double p[3]) {
  for (int axis = 0; axis < 3; axis++)
    p[axis] = splats->origin[axis] + (double)splats->position[axis][i] + u * (double)splats->tangent_u[axis][i] +
              v * (double)splats->tangent_v[axis][i];
}

/* Each splat's own lines. */
static conic_clip *list_clips(const conic_splats *splats) {
  conic_clip *clips = calloc(splats->count, sizeof *clips);
  for (size_t k = 0; k < splats->n_clips; k++)
    clips[splats->clips[k].splat] = splats->clips[k];
  return clips;
}

static int is_covered(const conic_splats *splats, const conic_clip *clips, const double p[3]) {
  for (size_t i = 0; i < splats->count; i++) {
    double d[3], u = 0.0, v = 0.0, uu = 0.0, vv = 0.0, foot[3], off = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      const double tu = (double)splats->tangent_u[axis][i], tv = (double)splats->tangent_v[axis][i];
      d[axis] = p[axis] - splats->origin[axis] - (double)splats->position[axis][i];
      u += d[axis] * tu;
      v += d[axis] * tv;
      uu += tu * tu;
      vv += tv * tv;
    }
    u /= uu;
    v /= vv;
    place_of(splats, i, u, v, foot);
    for (int axis = 0; axis < 3; axis++)
      off += (foot[axis] - p[axis]) * (foot[axis] - p[axis]);
    if (u * u + v * v <= cutoff * cutoff && off < 4e-4 && keeps(&clips[i], u, v))
      return 1;
  }
  return 0;
}

/* Whether a place of that height above the other solid is on the surface of the result. */
static int belongs(conic_csg_operation operation, int of_second, double height) {
  int wants_inside = operation == CONIC_CSG_INTERSECTION || (operation == CONIC_CSG_DIFFERENCE && of_second);
  return (height < 0.0) == wants_inside;
}

/* What is drawn beyond the seam: by no more than a plane leaves a ball, half the square of the way along it, here of an
 * outline's radius and half the distance between discs. */
static double farthest_beyond(const conic_splats *result, size_t n_first, const conic_clip *clips,
                              const shape shapes[2], conic_csg_operation operation) {
  double farthest = 0.0;
  for (size_t i = 0; i < result->count; i++)
    for (int k = 0; k < 169; k++) {
      double u = (k % 13 - 6) / 6.0 * cutoff, v = (k / 13 - 6) / 6.0 * cutoff,
             p[3]; /* NOLINT(bugprone-integer-division) */
      if (u * u + v * v > cutoff * cutoff || !keeps(&clips[i], u, v))
        continue;
      place_of(result, i, u, v, p);
      double height = height_above(&shapes[i < n_first], p);
      if (!belongs(operation, i >= n_first, height))
        farthest = fmax(farthest, fabs(height));
    }
  return farthest;
}

/* Places of both true surfaces that are covered although they do not belong, or the other way round. */
static size_t count_wrong(conic_context *context, const conic_splats *result, const conic_clip *clips,
                          const shape shapes[2], conic_csg_operation operation, double seam) {
  size_t n_wrong = 0;
  for (int of_second = 0; of_second < 2; of_second++) {
    conic_splats places = sample(context, &shapes[of_second], IS_SANITIZED ? 177 : 1777);
    for (size_t i = 0; i < places.count; i++) {
      double p[3];
      place_of(&places, i, 0.0, 0.0, p);
      double height = height_above(&shapes[!of_second], p);
      if (fabs(height) > seam)
        n_wrong += is_covered(result, clips, p) != belongs(operation, of_second, height);
    }
    conic_splats_release(context, &places);
  }
  return n_wrong;
}

static void try_pair(conic_context *context, const shape *a, const shape *b, double most_beyond) {
  static const char *const names[] = {"union", "intersection", "difference"};
  const shape shapes[2] = {*a, *b};
  conic_splats first = sample(context, a, 3000), second = sample(context, b, 2600), result;
  for (int operation = 0; operation < 3; operation++) {
    conic_csg_report report;
    CHECK_OK(
        conic_splats_csg(context, &first, &second, (conic_csg_operation)operation, (float)cutoff, &result, &report));
    conic_clip *clips = list_clips(&result);
    double beyond = farthest_beyond(&result, report.n_kept[0], clips, shapes, (conic_csg_operation)operation);
    size_t n_wrong = count_wrong(context, &result, clips, shapes, (conic_csg_operation)operation, 0.05);
    printf("%s: %zu + %zu splats, %zu clipped, %zu not; %.4f beyond the seam, %zu places wrong\n", names[operation],
           report.n_kept[0], report.n_kept[1], report.n_clipped, report.n_unclipped, beyond, n_wrong);
    CHECK(result.count == report.n_kept[0] + report.n_kept[1]);
    CHECK(report.n_clipped > 50);
    CHECK(beyond < most_beyond);
    CHECK(n_wrong == 0);
    free(clips);
    conic_splats_release(context, &result);
  }
  conic_splats_release(context, &first);
  conic_splats_release(context, &second);
}

/* What is turned over faces the other way: the sign of its normal along the direction from the centre. */
static void test_normals(conic_context *context) {
  const shape cube = {CONIC_SCENE_CUBE, {0, 0, 0}}, ball = {CONIC_SCENE_SPHERE, {1.2, 0, 0}};
  conic_splats a = sample(context, &cube, 2000), b = sample(context, &ball, 4000), result;
  conic_csg_report report;
  CHECK_OK(conic_splats_csg(context, &a, &b, CONIC_CSG_DIFFERENCE, (float)cutoff, &result, &report));
  CHECK(report.n_kept[1] > 100);
  for (size_t i = report.n_kept[0]; i < result.count; i++) {
    double along = 0.0, p[3];
    place_of(&result, i, 0.0, 0.0, p);
    for (int axis = 0; axis < 3; axis++) {
      int next = (axis + 1) % 3, last = (axis + 2) % 3;
      double normal = (double)result.tangent_u[next][i] * (double)result.tangent_v[last][i] -
                      (double)result.tangent_u[last][i] * (double)result.tangent_v[next][i];
      along += normal * (p[axis] - ball.center[axis]);
    }
    CHECK(along < 0.0);
  }
  conic_splats_release(context, &result);
  conic_splats bare = a;
  for (int axis = 0; axis < 3; axis++)
    bare.tangent_u[axis] = bare.tangent_v[axis] = NULL;
  bare.n_clips = 0;
  bare.clips = NULL;
  CHECK(conic_splats_csg(context, &bare, &b, CONIC_CSG_UNION, 1.5f, &result, NULL) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_splats_csg(context, &a, &b, (conic_csg_operation)3, 1.5f, &result, NULL) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_splats_csg(context, &a, &b, CONIC_CSG_UNION, 0.0f, &result, NULL) == CONIC_ERROR_ARGUMENT);
  CHECK(result.count == 0 && !result.position[0]);
  conic_splats_release(context, &a);
  conic_splats_release(context, &b);
}

int main(void) {
  conic_context *context = check_context(2);
  const shape ball = {CONIC_SCENE_SPHERE, {0, 0, 0}}, other_ball = {CONIC_SCENE_SPHERE, {0.8, 0.3, 0.5}};
  const shape cube = {CONIC_SCENE_CUBE, {0, 0, 0}}, other_cube = {CONIC_SCENE_CUBE, {0.63, 0.57, 0.6}};
  const shape biting_ball = {CONIC_SCENE_SPHERE, {0.9, 0.7, 0.8}}, far_cube = {CONIC_SCENE_CUBE, {1e6, 5e6, 0.25}};
  const shape ball_at_corners = {CONIC_SCENE_SPHERE, {0.5, 0.5, 0.5}};
  const shape far_ball = {CONIC_SCENE_SPHERE, {1e6 + 0.9, 5e6 + 0.7, 1.05}};
  try_pair(context, &cube, &biting_ball, 0.011);
  if (!IS_SANITIZED) {
    try_pair(context, &ball, &other_ball, 0.011);
    try_pair(context, &cube, &other_cube, 1e-5);
    try_pair(context, &cube, &ball_at_corners, 0.012);
    try_pair(context, &far_cube, &far_ball, 0.011);
  }
  test_normals(context);
  conic_context_destroy(context);
  return check_result();
}
