#include "gaussians/scene/made_gaussians.h"

#include "core/base/random.h"
#include "core/base/trigonometry.h"
#include "core/base/vectors.h"
#include "gaussians/scene/gaussian_set.h"

enum { MADE_RUN = 4096, N_BALLS = 7 };

/* What random numbers are for; harmonics take those from HARMONIC on. */
enum { WHICH, PLACE, DEPTH = PLACE + 8, SIZE = DEPTH + 3, SPIN = SIZE + 3, OPACITY = SPIN + 2, HARMONIC = OPACITY + 2 };

/* Centres and radii; y points down, and the floor is at 0.8. */
static const double balls[N_BALLS][4] = {{0.0, 0.25, 0.0, 0.55},   {-0.8, 0.5, 0.3, 0.3},  {0.75, 0.45, 0.4, 0.35},
                                         {0.25, 0.65, -0.7, 0.15}, {-0.4, 0.6, -0.6, 0.2}, {0.6, 0.7, -0.4, 0.1},
                                         {-0.2, -0.55, 0.1, 0.2}};

static const double floor_y = 0.8, floor_edge = 3.0;

/* Half of all lie on balls, and a few nowhere. */
static const double ball_share = 0.5, surface_share = 0.95;

typedef struct made_scene {
  conic_gaussians *set;
  uint64_t seed;
  double ball_area, ball_spacing, floor_spacing; /* the first over 4π, and how far Gaussians are apart */
} made_scene;

/* Where a Gaussian lies, what is the normal there, and how far its neighbours are. */
typedef struct made_place {
  double at[3], normal[3], spacing;
} made_place;

static double number(const made_scene *scene, size_t i, uint64_t dimension) {
  return conic_random_uniform(scene->seed, i, dimension);
}

/* Even on the unit sphere, by Marsaglia's disc; the eighth try is as good as any. */
static void point_on_sphere(const made_scene *scene, size_t i, double p[3]) {
  double x = 0.0, y = 0.0, square = 1.0;
  for (uint64_t k = 0; k < 8 && square >= 1.0; k += 2) {
    x = 2.0 * number(scene, i, PLACE + k) - 1.0;
    y = 2.0 * number(scene, i, PLACE + k + 1) - 1.0;
    square = x * x + y * y;
  }
  square = square < 1.0 ? square : 0.0;
  double root = 2.0 * sqrt(1.0 - square);
  p[0] = x * root;
  p[1] = y * root;
  p[2] = 1.0 - 2.0 * square;
  conic_normalize(p);
}

/* The ball that has this part of all balls' area before it. */
static const double *choose_ball(const made_scene *scene, double part) {
  double area = 0.0;
  int ball = 0;
  for (; ball < N_BALLS - 1; ball++) {
    area += balls[ball][3] * balls[ball][3];
    if (part * scene->ball_area < area)
      break;
  }
  return balls[ball];
}

static made_place choose_place(const made_scene *scene, size_t i) {
  static const double nowhere[4] = {0.0, 0.0, 0.0, 1.5};
  made_place place = {.normal = {0.0, -1.0, 0.0}, .spacing = scene->floor_spacing};
  double which = number(scene, i, WHICH);
  if (which >= ball_share && which < surface_share) {
    place.at[0] = floor_edge * (2.0 * number(scene, i, PLACE) - 1.0);
    place.at[1] = floor_y;
    place.at[2] = floor_edge * (2.0 * number(scene, i, PLACE + 1) - 1.0);
    return place;
  }
  const double *ball = which < ball_share ? choose_ball(scene, which / ball_share) : nowhere;
  double radius = which < ball_share ? ball[3] : ball[3] * number(scene, i, DEPTH);
  place.spacing = scene->ball_spacing;
  point_on_sphere(scene, i, place.normal);
  for (int axis = 0; axis < 3; axis++)
    place.at[axis] = ball[axis] + radius * place.normal[axis];
  return place;
}

/* From the third axis to the normal by the shortest way, after a turn about the third. */
static void turn_to_normal(const made_scene *scene, size_t i, const double n[3]) {
  double c = number(scene, i, SPIN) + 1e-3, s = number(scene, i, SPIN + 1), w = 1.0 + n[2];
  if (w < 1e-6) { /* the other way round */
    scene->set->rotation[0][i] = 0.0f;
    scene->set->rotation[1][i] = 1.0f;
    scene->set->rotation[2][i] = scene->set->rotation[3][i] = 0.0f;
    return;
  }
  const double q[4] = {w * c, -n[1] * c + n[0] * s, n[0] * c + n[1] * s, w * s};
  double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (int k = 0; k < 4; k++)
    scene->set->rotation[k][i] = (float)(q[k] / length);
}

/* Floaters and a third of the others are faint. */
static void put_shape(const made_scene *scene, size_t i, const made_place *place) {
  conic_gaussians *set = scene->set;
  double size = 0.7 * place->spacing / (1.0 - 0.85 * number(scene, i, SIZE)); /* few are large */
  double faint = number(scene, i, OPACITY), strength = number(scene, i, OPACITY + 1);
  int is_floater = number(scene, i, WHICH) >= surface_share;
  double thin = is_floater ? 1.0 : 0.05 + 0.25 * number(scene, i, SIZE + 2);
  set->scale[0][i] = (float)size;
  set->scale[1][i] = (float)(size * (0.3 + 0.7 * number(scene, i, SIZE + 1)));
  set->scale[2][i] = (float)(size * thin);
  set->opacity[i] = (float)(is_floater || faint < 0.33 ? 0.02 + 0.3 * strength : 0.5 + 0.49 * strength);
}

static void color_by_place(const made_scene *scene, size_t i, const made_place *place) {
  conic_gaussians *set = scene->set;
  size_t at = 0;
  double x = floor(place->at[0] * 4.0), z = floor(place->at[2] * 4.0), checker = x + z - 2.0 * floor(0.5 * (x + z));
  for (int degree = 0; degree <= set->sh_degree; degree++)
    for (int k = 0; k < 3 * (2 * degree + 1); k++, at++) {
      double spread = 2.0 * number(scene, i, HARMONIC + at) - 1.0, channel = 0.25 * (k % 3) - 0.25;
      double value = degree ? 0.1 * spread / (degree * degree) : (0.5 * checker - 0.2 + channel + 0.3 * spread) / 0.564;
      conic_gaussians_put_harmonic(set, i, at, (float)value);
    }
}

static void make_run(void *data, size_t i_run) {
  const made_scene *scene = data;
  for (size_t i = i_run * MADE_RUN; i < (i_run + 1) * MADE_RUN && i < scene->set->count; i++) {
    made_place place = choose_place(scene, i);
    double off = 0.2 * place.spacing * conic_random_gaussian(scene->seed, i, DEPTH);
    for (int axis = 0; axis < 3; axis++)
      scene->set->position[axis][i] = (float)(place.at[axis] + off * place.normal[axis]);
    turn_to_normal(scene, i, place.normal);
    put_shape(scene, i, &place);
    color_by_place(scene, i, &place);
  }
}

conic_status conic_gaussians_make(conic_context *context, size_t count, int sh_degree, uint64_t seed,
                                  conic_gaussians *gaussians) {
  made_scene scene = {.set = gaussians, .seed = seed};
  if (count < 1 || count > CONIC_MOST_GAUSSIANS)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "gaussians: no scene has so many");
  conic_status status = conic_gaussians_allocate(context, count, sh_degree, 0, gaussians);
  for (int ball = 0; ball < N_BALLS; ball++)
    scene.ball_area += balls[ball][3] * balls[ball][3];
  scene.ball_spacing = sqrt(4.0 * CONIC_PI * scene.ball_area / (ball_share * (double)count));
  scene.floor_spacing = sqrt(4.0 * floor_edge * floor_edge / ((surface_share - ball_share) * (double)count));
  if (status == CONIC_OK)
    conic_parallel_for(context, (count + MADE_RUN - 1) / MADE_RUN, make_run, &scene);
  return status;
}
