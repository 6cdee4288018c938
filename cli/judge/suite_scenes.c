/* The suite's scenes, and the table of them. */
#include "cli/judge/suite_scenes.h"

#include "core/base/random.h"
#include "core/splats/gaussian_profile.h"
#include "gaussians/scene/gaussian_set.h"
#include "gaussians/scene/made_gaussians.h"

/* --- few Gaussians --- */

/* A Gaussian as it is written below; its colour is that of degree 0, as displayed. */
typedef struct suite_one {
  double mean[3], scale[3], rotation[4], opacity, color[3];
} suite_one;

/* Every scene's axes are the camera's: x right, y down, z forward. AHEAD cameras are 4 before the origin, where a pixel
 * is 1/8 wide; the picture's middle is a corner of four pixels. */
#define ROUND(size) .scale = {size, size, size}, .rotation = {1.0, 0.0, 0.0, 0.0}

static void put_one(conic_gaussians *set, size_t i, const suite_one *one) {
  for (int axis = 0; axis < 3; axis++) {
    set->position[axis][i] = (float)one->mean[axis];
    if (set->scale[axis])
      set->scale[axis][i] = (float)one->scale[axis];
    conic_gaussians_put_harmonic(set, i, (size_t)axis, (float)((one->color[axis] - 0.5) / CONIC_SH_CONSTANT));
  }
  for (int k = 0; k < 4; k++)
    set->rotation[k][i] = (float)one->rotation[k];
  set->opacity[i] = (float)one->opacity;
}

/* Harmonics above degree 0: all of them, each different. */
static void put_all_degrees(conic_gaussians *set, size_t i) {
  size_t n = conic_harmonics_of_degree(set->sh_degree);
  for (size_t k = 3; k < n; k++)
    conic_gaussians_put_harmonic(set, i, k, (float)(0.4 * conic_random_uniform(5, i, k) - 0.2));
}

static conic_status put_few(conic_context *context, const suite_one *few, size_t n, int sh_degree, unsigned fields,
                            conic_gaussians *set) {
  conic_status status = conic_gaussians_allocate(context, n, sh_degree, fields, set);
  for (size_t i = 0; status == CONIC_OK && i < n; i++) {
    put_one(set, i, &few[i]);
    put_all_degrees(set, i);
  }
  return status;
}

#define COUNT(few) (sizeof(few) / sizeof *(few))

static conic_status make_ball(conic_context *context, conic_gaussians *gaussians) {
  static const suite_one few[] = {{.mean = {0.1, -0.05, 0.0}, ROUND(0.4), .opacity = 0.75, .color = {0.9, 0.6, 0.2}}};
  return put_few(context, few, COUNT(few), 0, 0, gaussians);
}

static conic_status make_ellipse(conic_context *context, conic_gaussians *gaussians) {
  static const suite_one few[] = {{.mean = {-0.4, 0.2, 0.3},
                                   .scale = {0.9, 0.35, 0.12},
                                   .rotation = {0.8, 0.3, -0.4, 0.2},
                                   .opacity = 0.8,
                                   .color = {0.2, 0.7, 0.9}}};
  return put_few(context, few, COUNT(few), 0, 0, gaussians);
}

static conic_status make_solid(conic_context *context, conic_gaussians *gaussians) {
  static const suite_one few[] = {
      {.mean = {0.0625, 0.0625, 0.0}, ROUND(0.5), .opacity = 0.9999, .color = {1.3, -0.2, 0.5}}};
  return put_few(context, few, COUNT(few), 0, 0, gaussians);
}

static conic_status make_harmonics(conic_context *context, conic_gaussians *gaussians) {
  static const suite_one few[] = {{.mean = {0.1, -0.2, 0.1},
                                   .scale = {0.6, 0.4, 0.3},
                                   .rotation = {0.9, -0.2, 0.3, 0.1},
                                   .opacity = 0.9,
                                   .color = {0.6, 0.6, 0.6}}};
  return put_few(context, few, COUNT(few), 3, 0, gaussians);
}

static conic_status make_disc(conic_context *context, conic_gaussians *gaussians) {
  static const suite_one few[] = {{.mean = {0.2, 0.1, 0.0},
                                   .scale = {0.8, 0.4},
                                   .rotation = {0.8, 0.5, 0.2, -0.2},
                                   .opacity = 0.85,
                                   .color = {0.8, 0.3, 0.4}}};
  return put_few(context, few, COUNT(few), 0, CONIC_GAUSSIANS_2D, gaussians);
}

static conic_status make_overlap(conic_context *context, conic_gaussians *gaussians) {
  static const suite_one few[] = {
      {.mean = {0.3, 0.0, 0.5}, ROUND(0.5), .opacity = 0.9, .color = {0.9, 0.1, 0.1}},
      {.mean = {-0.3, 0.1, -0.5}, ROUND(0.4), .opacity = 0.6, .color = {0.1, 0.9, 0.1}},
      {.mean = {0.0, -0.2, 1.5}, ROUND(0.9), .opacity = 0.95, .color = {0.1, 0.2, 0.9}},
      {.mean = {0.1, 0.3, 0.0}, ROUND(0.3), .opacity = 0.8, .color = {0.9, 0.9, 0.2}},
      /* Of the next two, the first is nearer by z and farther by distance. */
      {.mean = {-1.9, 0.0, 0.0}, ROUND(0.4), .opacity = 0.7, .color = {0.9, 0.5, 0.1}},
      {.mean = {-1.3, 0.1, 0.15}, ROUND(0.4), .opacity = 0.7, .color = {0.1, 0.5, 0.9}},
  };
  return put_few(context, few, COUNT(few), 0, 0, gaussians);
}

/* From back to front, so that the file's order is the wrong way round. */
static conic_status make_faint(conic_context *context, conic_gaussians *gaussians) {
  static const double opacities[] = {0.99, 0.8, 0.003, 0.9, 0.95, 0.02, 0.97, 0.5, 0.005, 0.9, 0.3, 0.1};
  enum { N = sizeof opacities / sizeof *opacities };
  suite_one few[N];
  for (int i = 0; i < N; i++)
    few[i] = (suite_one){.mean = {0.11 * (i % 4) - 0.2, 0.07 * (i % 3) - 0.1, 2.0 - 0.25 * i},
                         ROUND(0.3 + 0.04 * (i % 5)),
                         .opacity = opacities[i],
                         .color = {0.1 + 0.8 * (i % 2), 0.1 + 0.4 * (i % 3), 0.9 - 0.2 * (i % 4)}};
  return put_few(context, few, N, 0, 0, gaussians);
}

/* Six Gaussians around the origin, of degree 2. */
static conic_status make_ring(conic_context *context, conic_gaussians *gaussians) {
  static const double places[6][2] = {{0.9, 0.0}, {0.45, 0.7}, {-0.45, 0.7}, {-0.9, 0.0}, {-0.45, -0.7}, {0.45, -0.7}};
  suite_one few[6];
  for (int i = 0; i < 6; i++)
    few[i] = (suite_one){.mean = {places[i][0], 0.2 * (i % 2), places[i][1]},
                         .scale = {0.45, 0.2, 0.08},
                         .rotation = {0.7, 0.1 * i, 0.5 - 0.15 * i, 0.2},
                         .opacity = 0.35 + 0.1 * i,
                         .color = {0.2 + 0.1 * i, 0.8 - 0.1 * i, 0.5}};
  return put_few(context, few, 6, 2, 0, gaussians);
}

static conic_status make_discs(conic_context *context, conic_gaussians *gaussians) {
  suite_one few[5];
  for (int i = 0; i < 5; i++)
    few[i] = (suite_one){.mean = {0.35 * i - 0.8, 0.1 * (i % 3) - 0.1, 0.5 - 0.2 * i},
                         .scale = {0.6, 0.35},
                         .rotation = {0.8, 0.15 * i - 0.3, 0.4 - 0.1 * i, 0.1 * i},
                         .opacity = 0.9 - 0.12 * i,
                         .color = {0.9 - 0.2 * i, 0.2 + 0.15 * i, 0.3 + 0.1 * (i % 2)}};
  return put_few(context, few, 5, 0, CONIC_GAUSSIANS_2D, gaussians);
}

static conic_status make_extremes(conic_context *context, conic_gaussians *gaussians) {
  static const suite_one few[] = {
      {.mean = {0.0, 0.0, 60.0}, ROUND(50.0), .opacity = 0.7, .color = {0.2, 0.3, 0.6}},
      {.mean = {-900.0, 300.0, 10000.0}, ROUND(500.0), .opacity = 0.9, .color = {0.9, 0.8, 0.1}},
      {.mean = {0.3, -0.4, 0.2},
       .scale = {2.0, 0.002, 0.002},
       .rotation = {0.9, 0.1, 0.2, 0.4},
       .opacity = 0.95,
       .color = {0.9, 0.2, 0.2}},
      {.mean = {-0.5, 0.3, 0.0},
       .scale = {1.2, 0.9, 1e-5},
       .rotation = {0.7, 0.6, -0.2, 0.3},
       .opacity = 0.6,
       .color = {0.2, 0.9, 0.4}},
      {.mean = {0.8, 0.5, -0.5}, ROUND(1e-4), .opacity = 0.99, .color = {0.9, 0.9, 0.9}},
      {.mean = {-0.9, -0.6, -0.3}, ROUND(0.02), .opacity = 0.99, .color = {0.1, 0.9, 0.9}},
      {.mean = {1.1, -0.2, -1.0},
       .scale = {0.001, 0.7, 0.001},
       .rotation = {0.6, 0.1, 0.1, -0.7},
       .opacity = 0.9,
       .color = {0.9, 0.4, 0.9}},
  };
  return put_few(context, few, COUNT(few), 0, 0, gaussians);
}

/* One at every third pixel in both directions. The opacity is off 1/255 by −8 to 8 parts in ten million and, at the
 * ends, by a hundredth. */
static conic_status make_least(conic_context *context, conic_gaussians *gaussians) {
  enum { COLUMNS = 11, ROWS = 5, N = COLUMNS * ROWS };
  suite_one few[N];
  for (int i = 0; i < N; i++) {
    int column = i % COLUMNS, row = i / COLUMNS, step = column - COLUMNS / 2, up = row - ROWS / 2;
    double off = column == 0 ? -1e-2 : column == COLUMNS - 1 ? 1e-2 : 2e-7 * step;
    few[i] = (suite_one){.mean = {(3 * step + 0.5) / 8.0, (3 * up + 0.5) / 8.0, 0.0},
                         ROUND(0.02 + 0.02 * row),
                         .opacity = (1.0 + off) / 255.0,
                         .color = {40.0, 20.0, 10.0}};
  }
  return put_few(context, few, N, 0, 0, gaussians);
}

/* Two piles of four with alphas of 0.9, and two of 0.99 behind one another; the last one is bright. */
static conic_status make_end(conic_context *context, conic_gaussians *gaussians) {
  enum { DEEP = 6, N = 3 * DEEP };
  static const double opacities[3][DEEP] = {
      {0.9, 0.9, 0.9, 0.9, 0.9, 0.9}, {0.9, 0.9, 0.9, 0.9000001, 0.99, 0.99}, {0.99, 0.99, 0.99, 0.5, 0.5, 0.5}};
  suite_one few[N];
  for (int i = 0; i < N; i++) {
    int pile = i / DEEP, depth = i % DEEP;
    double z = 4.0 + 0.25 * depth;
    few[i] = (suite_one){.mean = {(9 * (pile - 1) + 0.5) / 32.0 * z, 0.5 / 32.0 * z, z - 4.0},
                         ROUND(0.5),
                         .opacity = opacities[pile][depth],
                         .color = {0.2, 0.2, 0.2}};
    few[i].color[depth % 3] = depth > 2 ? 300.0 : 1.0;
  }
  return put_few(context, few, N, 0, 0, gaussians);
}

/* Depths of exactly 4 in floats: there 2⁻²¹ is a float's step, and 2⁻²³ a quarter of it. */
static conic_status make_ties(conic_context *context, conic_gaussians *gaussians) {
  static const suite_one few[] = {
      {.mean = {-1.25, 0.0, 0.0}, ROUND(0.3), .opacity = 0.8, .color = {0.9, 0.1, 0.1}},
      {.mean = {-1.25, 0.0, 0.0}, ROUND(0.3), .opacity = 0.8, .color = {0.1, 0.9, 0.1}},
      {.mean = {-1.25, 0.0, 0.0}, ROUND(0.2), .opacity = 0.8, .color = {0.1, 0.1, 0.9}},
      {.mean = {-0.125, 0.0, 0x1p-21}, ROUND(0.3), .opacity = 0.7, .color = {0.9, 0.1, 0.9}},
      {.mean = {0.125, 0.0, 0.0}, ROUND(0.3), .opacity = 0.7, .color = {0.1, 0.9, 0.9}},
      {.mean = {1.125, 0.0, 0x1p-23}, ROUND(0.3), .opacity = 0.7, .color = {0.9, 0.9, 0.1}},
      {.mean = {1.375, 0.0, 0.0}, ROUND(0.3), .opacity = 0.7, .color = {0.2, 0.3, 0.9}},
  };
  return put_few(context, few, COUNT(few), 0, 0, gaussians);
}

static conic_status make_quaternions(conic_context *context, conic_gaussians *gaussians) {
  static const double lengths[] = {0.01, 0.5, 1.00001, 7.0, 1000.0};
  suite_one few[5];
  for (int i = 0; i < 5; i++)
    few[i] = (suite_one){.mean = {0.7 * i - 1.4, 0.2 * (i % 2) - 0.1, 0.1 * i},
                         .scale = {0.6, 0.15, 0.1},
                         .rotation = {0.8 * lengths[i], 0.2 * lengths[i], -0.4 * lengths[i], 0.4 * lengths[i]},
                         .opacity = 0.8,
                         .color = {0.9 - 0.15 * i, 0.3 + 0.1 * i, 0.5}};
  return put_few(context, few, 5, 0, 0, gaussians);
}

/* Every second record lacks something. */
static conic_status make_broken(conic_context *context, conic_gaussians *gaussians) {
  suite_one few[16];
  for (int i = 0; i < 16; i++)
    few[i] = (suite_one){.mean = {0.25 * i - 1.9, 0.15 * (i % 4) - 0.2, 0.1 * (i % 3)},
                         .scale = {0.3, 0.2, 0.1},
                         .rotation = {0.9, 0.1, 0.2, 0.3},
                         .opacity = 0.7,
                         .color = {0.5 + 0.4 * (i % 2), 0.8 - 0.05 * i, 0.3}};
  conic_status status = put_few(context, few, 16, 0, 0, gaussians);
  if (status != CONIC_OK)
    return status;
  const float none = conic_float_of_bits(0x7fc00000), endless = conic_float_of_bits(0x7f800000);
  gaussians->position[0][1] = none;
  gaussians->position[2][3] = endless;
  gaussians->scale[1][5] = none;
  gaussians->rotation[2][7] = none;
  gaussians->opacity[9] = none;
  gaussians->sh[3 * 11 + 1] = none;
  for (int k = 0; k < 4; k++)
    gaussians->rotation[k][13] = 0.0f;
  gaussians->position[1][15] = -endless;
  return CONIC_OK;
}

static conic_status make_far_away(conic_context *context, conic_gaussians *gaussians) {
  conic_status status = make_overlap(context, gaussians);
  static const float offset[3] = {600.0f, -350.0f, 900.0f};
  for (size_t i = 0; status == CONIC_OK && i < gaussians->count; i++)
    for (int axis = 0; axis < 3; axis++)
      gaussians->position[axis][i] += offset[axis];
  return status;
}

/* The camera is at the origin, so that a float's z is the mean's. */
static conic_status make_near(conic_context *context, conic_gaussians *gaussians) {
  static const float near[2] = {0.2f, 0.01f};
  suite_one few[10];
  for (int i = 0; i < 10; i++) {
    float z = near[i / 5];
    static const int steps[] = {-1000, -1, 0, 1, 1000};
    z = conic_float_of_bits(conic_bits_of_float(z) + (uint32_t)steps[i % 5]);
    few[i] = (suite_one){
        .mean = {(6 * (i % 5) - 11.5) / 32.0 * (double)z, (i < 5 ? -4.5 : 4.5) / 32.0 * (double)z, (double)z},
        ROUND(1.5 / 32.0 * (double)z),
        .opacity = 0.6,
        .color = {0.9 - 0.2 * (i % 5), 0.4, 0.1 + 0.2 * (i % 5)}};
  }
  return put_few(context, few, 10, 0, 0, gaussians);
}

static conic_status make_aside(conic_context *context, conic_gaussians *gaussians) {
  static const suite_one few[] = {
      {.mean = {-5.0, 0.0, 0.0}, ROUND(2.0), .opacity = 0.9, .color = {0.9, 0.2, 0.2}},
      {.mean = {5.5, 1.0, 1.0},
       .scale = {2.5, 1.0, 0.5},
       .rotation = {0.8, 0.3, 0.3, 0.2},
       .opacity = 0.8,
       .color = {0.2, 0.9, 0.2}},
      {.mean = {0.0, 6.0, -1.0}, ROUND(2.5), .opacity = 0.7, .color = {0.2, 0.3, 0.9}},
      {.mean = {3.0, -4.0, -2.0}, ROUND(1.2), .opacity = 0.7, .color = {0.9, 0.9, 0.3}},
      {.mean = {-3.0, -3.0, -3.0}, ROUND(1.0), .opacity = 0.5, .color = {0.5, 0.9, 0.9}},
  };
  return put_few(context, few, COUNT(few), 0, 0, gaussians);
}

/* Turned about y by nearly a quarter of a turn, each by another remainder. */
static conic_status make_edge_on(conic_context *context, conic_gaussians *gaussians) {
  static const double missing[] = {0.0, 1e-6, 1e-3, 0.03, 0.2};
  suite_one few[5];
  for (int i = 0; i < 5; i++)
    few[i] = (suite_one){.mean = {0.8 * i - 1.6, 0.1 * (i % 2), 0.2 * (i % 3)},
                         .scale = {0.5, 0.5},
                         .rotation = {1.0, 0.0, 1.0 - missing[i], 0.0},
                         .opacity = 0.8,
                         .color = {0.9, 0.8 - 0.15 * i, 0.1 + 0.2 * i}};
  return put_few(context, few, 5, 0, CONIC_GAUSSIANS_2D, gaussians);
}

/* --- many Gaussians --- */

static conic_status make_trained(conic_context *context, conic_gaussians *gaussians) {
  return conic_gaussians_make(context, 300, 3, 1, gaussians);
}

static conic_status make_crowd(conic_context *context, conic_gaussians *gaussians) {
  return conic_gaussians_make(context, 4000, 1, 2, gaussians);
}

/* The room without its third axis. */
static conic_status make_flat_room(conic_context *context, conic_gaussians *gaussians) {
  conic_gaussians solid;
  conic_status status = conic_gaussians_make(context, 300, 1, 3, &solid);
  if (status == CONIC_OK)
    status = conic_gaussians_allocate(context, solid.count, solid.sh_degree, CONIC_GAUSSIANS_2D, gaussians);
  if (status == CONIC_OK) {
    const size_t n = solid.count * sizeof(float);
    for (int axis = 0; axis < 3; axis++)
      memcpy(gaussians->position[axis], solid.position[axis], n);
    for (int axis = 0; axis < 2; axis++)
      memcpy(gaussians->scale[axis], solid.scale[axis], n);
    for (int k = 0; k < 4; k++)
      memcpy(gaussians->rotation[k], solid.rotation[k], n);
    memcpy(gaussians->opacity, solid.opacity, n);
    memcpy(gaussians->sh, solid.sh, n * conic_harmonics_of_degree(solid.sh_degree));
  }
  conic_gaussians_release(context, &solid);
  return status;
}

/* The k-th number by chance of Gaussian i, from −1 to 1. */
static double by_chance(size_t i, uint64_t k) {
  return 2.0 * conic_random_uniform(7, i, k) - 1.0;
}

static conic_status make_by_recipe(conic_context *context, const suite_recipe *r, conic_gaussians *gaussians) {
  enum { PLACE, SIZE = 3, SPIN = 6, OPACITY = 10, COLOR = 11, BANDS = 14 };
  int degree = 0;
  for (int l = 1; l <= 3; l++)
    degree = r->bands >> l & 1 ? l : degree;
  conic_status status = conic_gaussians_allocate(context, r->n, degree, 0, gaussians);
  for (size_t i = 0; status == CONIC_OK && i < r->n; i++) {
    suite_one one = {.opacity = r->opacity[0] + (r->opacity[1] - r->opacity[0]) * 0.5 * (by_chance(i, OPACITY) + 1.0)};
    int is_turned = r->rotation[0] == 0.0 && r->rotation[3] == 0.0;
    for (int k = 0; k < 4; k++)
      one.rotation[k] = is_turned ? by_chance(i, SPIN + (uint64_t)k) : r->rotation[k];
    for (int axis = 0; axis < 3; axis++) {
      one.mean[axis] = r->place[axis] + r->spread[axis] * by_chance(i, PLACE + (uint64_t)axis);
      one.scale[axis] = r->size[axis] * (is_turned ? 1.0 + 0.5 * by_chance(i, SIZE + (uint64_t)axis) : 1.0);
      one.color[axis] =
          (r->brightness > 0.0 ? r->brightness : 1.0) * (0.5 + 0.45 * by_chance(i, COLOR + (uint64_t)axis));
    }
    put_one(gaussians, i, &one);
    for (size_t k = 3; k < conic_harmonics_of_degree(degree); k++) {
      const int l = k < 12 ? 1 : k < 27 ? 2 : 3;
      conic_gaussians_put_harmonic(gaussians, i, k, r->bands >> l & 1 ? (float)(0.4 * by_chance(i, BANDS + k)) : 0.0f);
    }
  }
  return status;
}

conic_status cli_suite_make(conic_context *context, const suite_scene *scene, conic_gaussians *gaussians) {
  return scene->make ? scene->make(context, gaussians) : make_by_recipe(context, &scene->recipe, gaussians);
}

/* --- the table --- */

#define BLURRED (SUITE_OF_ELLIPSES | SUITE_OF_RAYS)
#define SOLIDS (BLURRED | SUITE_OF_FAINTER_ELLIPSES)
#define DISCS (SUITE_OF_DISCS | SUITE_OF_RAYS)

/* How a scene is seen: small pictures that are not square, and whose sides are no multiples of a tile. */
#define SMALL .width = 36, .height = 20, .center = {18.0, 10.0}
#define TINY .width = 20, .height = 12, .center = {10.0, 6.0}
#define LARGE .width = 640, .height = 360, .center = {320.0, 180.0}, .step = 15
#define MIDDLE .width = 44, .height = 30, .center = {22.0, 15.0}
#define AHEAD .rotation = {1.0, 0.0, 0.0, 0.0}, .eye = {0.0, 0.0, -4.0}, .focal = {32.0, 32.0}
#define AT_ORIGIN .rotation = {1.0, 0.0, 0.0, 0.0}, .focal = {32.0, 32.0}
#define AS_IT_IS .rotation = {1.0, 0.0, 0.0, 0.0}
#define OPAQUE .opacity = {0.3, 0.95}
#define EVERYWHERE .drawn_by = (SOLIDS | SUITE_OF_DISCS)
#define FREE_CENTER .drawn_by = (SOLIDS | SUITE_OF_DISCS | SUITE_WITH_CENTER)
#define STAGE(name) .stage = CONIC_GAUSSIAN_STAGE_##name
#define TURNED .rotation = {8.0, 2.0, -1.0, 1.0}, .eye = {-1.125, -1.75, -3.5}, .focal = {36.0, 36.0}

const suite_scene cli_suite_scenes[] = {
    {"ball", "one round Gaussian: the size of its picture, the falloff, the dilation", 1, SMALL, AHEAD,
     .drawn_by = SOLIDS | SUITE_OF_DISCS, .make = make_ball},
    {"ellipse", "one Gaussian of three sizes, turned: the rotation, the order of the quaternion, the projection", 1,
     SMALL, AHEAD, .drawn_by = SOLIDS | SUITE_OF_DISCS, .formats = SUITE_SPZ | SUITE_GLB, .make = make_ellipse},
    {"solid", "one Gaussian of opacity 0.9999, of which a colour is below 0: the largest alpha, the clamp at 0", 1,
     SMALL, AHEAD, .stage = CONIC_GAUSSIAN_STAGE_ALPHA, .drawn_by = SOLIDS | SUITE_OF_DISCS, .make = make_solid},
    {"harmonics", "one Gaussian of degree 3: every harmonic, and the order of f_rest", 1, SMALL, TURNED,
     .stage = CONIC_GAUSSIAN_STAGE_COLOR, .drawn_by = SOLIDS | SUITE_OF_DISCS, .formats = SUITE_GLB,
     .make = make_harmonics},
    {"disc", "one 2D Gaussian, tilted", 1, SMALL, AHEAD, .drawn_by = DISCS, .make = make_disc},

    {"overlap", "balls that cover one another, and stand in the file in another order than in depth", 2, SMALL, AHEAD,
     .stage = CONIC_GAUSSIAN_STAGE_SORT, .drawn_by = SOLIDS | SUITE_OF_DISCS, .formats = SUITE_SPZ,
     .make = make_overlap},
    {"faint", "a pile of opacities from under 1/255 to 0.99: what is left out, and where compositing ends", 2, SMALL,
     AHEAD, .stage = CONIC_GAUSSIAN_STAGE_ALPHA, .drawn_by = SOLIDS | SUITE_OF_DISCS, .make = make_faint},
    {"off-center", "a principal point off the middle, and two focal lengths", 2, 36, 20, .focal = {40.0, 30.0},
     .center = {14.25, 12.75}, .rotation = {8.0, 2.0, -1.0, 1.0}, .eye = {-1.125, -1.75, -3.5},
     .drawn_by = SOLIDS | SUITE_WITH_CENTER, .make = make_ring},
    {"background", "harmonics of degree 2 before a coloured background", 2, SMALL, TURNED,
     .background = {0.9f, 0.5f, 0.2f}, .stage = CONIC_GAUSSIAN_STAGE_BLENDING, .drawn_by = BLURRED | SUITE_OF_DISCS,
     .make = make_ring},
    {"discs", "2D Gaussians that cover one another", 2, SMALL, AHEAD, .stage = CONIC_GAUSSIAN_STAGE_SORT,
     .drawn_by = DISCS, .make = make_discs},

    {"room", "300 Gaussians of degree 3, as they are trained", 3, MIDDLE, TURNED, .drawn_by = SOLIDS,
     .formats = SUITE_GLB, .make = make_trained},
    {"room-of-discs", "300 2D Gaussians", 3, MIDDLE, TURNED, .drawn_by = DISCS, .make = make_flat_room},

    /* Without a near plane, Gaussians next to the eye have no useful bounds. */
    {"crowd", "4000 Gaussians about the eye: the near plane, what is behind, and the borders", 4, MIDDLE,
     .rotation = {8.0, 2.0, -1.0, 1.0}, .eye = {-0.75, -0.75, -1.75}, .focal = {30.0, 30.0},
     .stage = CONIC_GAUSSIAN_STAGE_SORT, .drawn_by = SOLIDS | SUITE_WITH_NEAR, .make = make_crowd},
    {"extremes", "huge ones, needles, plates, specks below a pixel, and what is 10,000 away", 4, MIDDLE, AHEAD,
     .drawn_by = SOLIDS, .make = make_extremes},

    {"least", "opacities about 1/255, each over a pixel's centre", 5, SMALL, AHEAD, .stage = CONIC_GAUSSIAN_STAGE_ALPHA,
     .drawn_by = SOLIDS, .make = make_least},
    {"end", "piles by which T comes to about 1e-4", 5, SMALL, AHEAD, .stage = CONIC_GAUSSIAN_STAGE_BLENDING,
     .drawn_by = BLURRED, .make = make_end},
    {"ties", "equal depths, and depths apart by less than a float tells", 5, SMALL, AHEAD,
     .stage = CONIC_GAUSSIAN_STAGE_SORT, .drawn_by = SOLIDS | SUITE_OF_DISCS, .make = make_ties},
    {"quaternions", "quaternions of lengths from 0.01 to 1000", 5, SMALL, AHEAD, .drawn_by = SOLIDS | SUITE_OF_DISCS,
     .make = make_quaternions},
    {"broken", "records with NaN, with infinity or without a rotation, which are left out, among sound ones", 5, SMALL,
     AHEAD, .drawn_by = BLURRED, .make = make_broken},
    {"far-away", "a scene and its camera 1,100 from the origin, where floats are coarse", 5, SMALL,
     .rotation = {1.0, 0.0, 0.0, 0.0}, .focal = {32.0, 32.0}, .eye = {600.0, -350.0, 896.0},
     .drawn_by = BLURRED | SUITE_OF_DISCS, .make = make_far_away},
    {"near", "means at the near planes 0.2 and 0.01, before and behind them", 5, SMALL, AT_ORIGIN, .drawn_by = SOLIDS,
     .make = make_near},
    {"aside", "large ones beside the picture, whose slopes are clamped", 5, SMALL, AHEAD, .drawn_by = SOLIDS,
     .make = make_aside},
    {"edge-on", "2D Gaussians seen from the edge, and nearly", 5, SMALL, AHEAD, .drawn_by = DISCS,
     .make = make_edge_on},

    {"band-1", "harmonics of degree 1 alone", 1, TINY, AHEAD, EVERYWHERE, STAGE(COLOR),
     .recipe = {1, .size = {0.5, 0.4, 0.3}, .opacity = {0.9, 0.9}, .bands = 2}},
    {"band-2", "harmonics of degree 2 alone", 1, TINY, TURNED, EVERYWHERE, STAGE(COLOR),
     .recipe = {2, .spread = {0.3, 0.2, 0.2}, .size = {0.5, 0.4, 0.3}, .opacity = {0.9, 0.9}, .bands = 4}},
    {"band-3", "harmonics of degree 3 alone", 1, TINY, TURNED, EVERYWHERE, STAGE(COLOR),
     .recipe = {2, .spread = {0.3, 0.2, 0.2}, .size = {0.5, 0.4, 0.3}, .opacity = {0.9, 0.9}, .bands = 8}},
    {"turned-x", "one Gaussian turned about x", 1, TINY, AHEAD, EVERYWHERE,
     .recipe = {1, {0.2, 0.1, 0.0}, .size = {0.6, 0.3, 0.1}, .rotation = {0.9, 0.4, 0.0, 0.0}, OPAQUE}},
    {"turned-y", "one Gaussian turned about y", 1, TINY, AHEAD, EVERYWHERE,
     .recipe = {1, {0.2, 0.1, 0.0}, .size = {0.6, 0.3, 0.1}, .rotation = {0.9, 0.0, 0.4, 0.0}, OPAQUE}},
    {"turned-z", "one Gaussian turned about z", 1, TINY, AHEAD, EVERYWHERE,
     .recipe = {1, {0.2, 0.1, 0.0}, .size = {0.6, 0.3, 0.1}, .rotation = {0.9, 0.0, 0.0, 0.4}, OPAQUE}},
    {"needle", "one Gaussian a thousand times as long as thick", 1, TINY, AHEAD, EVERYWHERE,
     .recipe = {1, .size = {1.5, 0.0015, 0.0015}, OPAQUE}},
    {"plate", "one Gaussian without thickness", 1, TINY, AHEAD, EVERYWHERE,
     .recipe = {1, .size = {0.6, 0.4, 1e-12}, OPAQUE}},
    {"point", "Gaussians without size", 1, TINY, AHEAD, EVERYWHERE,
     .recipe = {9, .spread = {1.0, 0.6, 0.5}, .size = {1e-12, 1e-12, 1e-12}, .opacity = {0.9, 0.99}}},
    {"empty", "Gaussians behind the eye alone: the background", 1, TINY, AHEAD, EVERYWHERE,
     .background = {0.25f, 0.5f, 0.75f}, .recipe = {3, {0.0, 0.0, -8.0}, {1.0, 1.0, 1.0}, {0.3, 0.2, 0.1}, OPAQUE}},

    {"most", "opacities from 0.98 to 1: the largest alpha", 2, TINY, AHEAD, EVERYWHERE, STAGE(ALPHA),
     .recipe = {12, .spread = {1.2, 0.7, 0.5}, .size = {0.15, 0.1, 0.1}, .opacity = {0.98, 0.99999}}},
    {"bright", "colours above 1, which nothing limits", 2, TINY, AHEAD, EVERYWHERE, STAGE(COLOR),
     .recipe = {6, .spread = {0.8, 0.5, 0.5}, .size = {0.4, 0.3, 0.2}, OPAQUE, .brightness = 6.0}},
    {"rolled", "a camera that lies on its side", 2, TINY, .rotation = {1.0, 0.0, 0.0, 1.0}, .eye = {0.0, 0.0, -4.0},
     .focal = {32.0, 32.0}, EVERYWHERE,
     .recipe = {6, .spread = {0.8, 0.5, 0.5}, .size = {0.5, 0.2, 0.1}, OPAQUE, .bands = 2}},
    {"upside-down", "a camera that looks back, upside down", 2, TINY, .rotation = {0.0, 1.0, 0.0, 0.0},
     .eye = {0.0, 0.0, 4.0}, .focal = {32.0, 32.0}, EVERYWHERE,
     .recipe = {6, .spread = {0.8, 0.5, 0.5}, .size = {0.5, 0.2, 0.1}, OPAQUE, .bands = 2}},
    {"one-pixel", "a picture of one pixel", 2, 1, 1, .center = {0.5, 0.5}, AHEAD, EVERYWHERE,
     .recipe = {6, .spread = {0.1, 0.1, 0.5}, .size = {0.1, 0.1, 0.1}, OPAQUE}},
    {"column", "a picture of 5 x 35 pixels", 2, 5, 35, .center = {2.5, 17.5}, AHEAD, EVERYWHERE,
     .recipe = {12, .spread = {0.5, 2.2, 0.5}, .size = {0.3, 0.2, 0.1}, OPAQUE}},
    {"two-tiles", "a picture of 32 x 16 pixels, two tiles and no more", 2, 32, 16, .center = {16.0, 8.0}, AHEAD,
     EVERYWHERE, .recipe = {12, .spread = {2.2, 1.2, 0.5}, .size = {0.3, 0.2, 0.1}, OPAQUE}},
    {"zoomed", "a long focal length, from afar", 2, TINY, AS_IT_IS, .eye = {0.0, 0.0, -60.0}, .focal = {480.0, 480.0},
     EVERYWHERE, .recipe = {8, .spread = {1.0, 0.6, 0.5}, .size = {0.3, 0.2, 0.1}, OPAQUE}},
    {"wide", "a focal length of 6 pixels", 2, TINY, AS_IT_IS, .eye = {0.0, 0.0, -2.0}, .focal = {6.0, 6.0}, EVERYWHERE,
     .recipe = {8, .spread = {2.5, 1.5, 0.5}, .size = {0.4, 0.3, 0.2}, OPAQUE}},
    {"cropped", "a cut-out: the principal point is beside the picture", 2, 20, 12, .center = {-9.0, 21.0}, AHEAD,
     FREE_CENTER, .recipe = {10, {2.4, -1.9, 0.0}, {1.2, 0.8, 0.8}, {0.5, 0.3, 0.2}, OPAQUE}},

    {"needles", "long thin ones in all directions", 4, TINY, AHEAD, EVERYWHERE,
     .recipe = {60, .spread = {1.2, 0.7, 0.7}, .size = {0.9, 0.004, 0.004}, OPAQUE}},

    {"saturated", "so many that T comes to its end everywhere", 5, TINY, AHEAD, EVERYWHERE, STAGE(BLENDING),
     .recipe = {300, .spread = {1.4, 0.9, 0.8}, .size = {0.6, 0.5, 0.4}, .opacity = {0.2, 0.99}}},
    {"tied", "two hundred of the same depth", 5, TINY, AHEAD, EVERYWHERE, STAGE(SORT),
     .recipe = {200, .spread = {1.2, 0.7, 0.0}, .size = {0.3, 0.2, 0.1}, OPAQUE}},
    {"clamped", "large ones beside an off-centre camera's picture: about which place slopes are clamped", 5, 20, 12,
     .center = {3.0, 10.5}, AHEAD, FREE_CENTER,
     .recipe = {24, {1.5, -1.0, -1.5}, {6.0, 4.0, 1.2}, {1.6, 0.8, 0.5}, .opacity = {0.3, 0.6}}},
    {"straddling", "beside the eye and behind it", 5, TINY, AT_ORIGIN,
     .drawn_by = SUITE_OF_ELLIPSES | SUITE_OF_FAINTER_ELLIPSES | SUITE_OF_DISCS | SUITE_WITH_NEAR,
     .recipe = {40, .spread = {1.5, 1.0, 2.0}, .size = {0.2, 0.1, 0.1}, OPAQUE}},

    {"vast", "640 x 360 pixels, 920 tiles", 7, LARGE, AS_IT_IS, .eye = {0.0, 0.0, -4.0}, .focal = {500.0, 500.0},
     EVERYWHERE | SUITE_WITH_TILES, STAGE(SORT),
     .recipe = {1500, .spread = {2.8, 1.6, 1.5}, .size = {0.12, 0.06, 0.06}, OPAQUE, .bands = 2}},
    {"cover", "a few that cover hundreds of tiles each", 7, LARGE, AS_IT_IS, .eye = {0.0, 0.0, -4.0},
     .focal = {500.0, 500.0}, EVERYWHERE | SUITE_WITH_TILES, STAGE(SORT),
     .recipe = {7, .spread = {1.5, 1.0, 1.0}, .size = {1.2, 0.6, 0.4}, .opacity = {0.3, 0.8}}},
    {"vast-off-center", "640 x 360 pixels of an off-centre camera", 7, 640, 360, .center = {95.0, 300.0}, .step = 15,
     AS_IT_IS, .eye = {0.0, 0.0, -4.0}, .focal = {450.0, 480.0}, FREE_CENTER | SUITE_WITH_TILES,
     .recipe = {150, {2.0, -0.8, -1.0}, {5.0, 3.5, 2.0}, {0.5, 0.25, 0.2}, .opacity = {0.2, 0.6}}},
    {"crowded-pixel", "10,000 on one pixel", 7, TINY, AHEAD, EVERYWHERE, STAGE(BLENDING),
     .recipe = {10000, {0.06, 0.06, 0.0}, {0.03, 0.03, 0.5}, {0.01, 0.01, 0.01}, .opacity = {0.003, 0.01}}},
    {"crowded-tile", "300,000 in one tile", 7, 16, 16, .center = {8.0, 8.0}, AHEAD,
     .drawn_by = SUITE_OF_ELLIPSES | SUITE_WITH_TILES, STAGE(SORT),
     .recipe = {300000, .spread = {0.9, 0.9, 1.0}, .size = {0.04, 0.02, 0.02}, .opacity = {0.00395, 0.0045}}},

    {"splat", "one surface splat, tilted", 6, SMALL, AHEAD, .drawn_by = SUITE_OF_SURFELS,
     .make_splats = cli_suite_make_splat},
    {"sheet", "splats of one surface, which are blended and normalised", 6, SMALL, AHEAD, .drawn_by = SUITE_OF_SURFELS,
     .make_splats = cli_suite_make_sheet},
    {"corner", "two surfaces: which splats hide, and which are blended", 6, SMALL, AHEAD, .drawn_by = SUITE_OF_SURFELS,
     .make_splats = cli_suite_make_corner},
    {"steep", "a floor seen from near, where perspective is strong within a splat", 6, SMALL, AHEAD,
     .drawn_by = SUITE_OF_SURFELS, .make_splats = cli_suite_make_steep},
};

const int cli_n_suite_scenes = sizeof cli_suite_scenes / sizeof *cli_suite_scenes;

const char *cli_suite_level_about(int level) {
  static const char *const about[SUITE_LEVELS] = {"one Gaussian: its shape and colour",
                                                  "a few: overlap, order, opacity, camera, background",
                                                  "hundreds, as they are trained",
                                                  "thousands, and extreme sizes and places",
                                                  "adversarial: decisions on the edge, ties, broken records",
                                                  "surface splats, opaque, by the method conic",
                                                  "large pictures, and crowds in a pixel or a tile"};
  return about[level - 1];
}

static int draws(const suite_scene *scene, int profile) {
  if (profile == SUITE_SURFACE)
    return scene->drawn_by & SUITE_OF_SURFELS;
  const conic_profile_row *row = conic_profile_row_of((conic_gaussian_profile)profile);
  const int is_fainter = row->compensation_least >= 0.0 && row->dilation > 0.0;
  const int lacks_tiles =
      row->shape == CONIC_SHAPE_ELLIPSE && row->coverage != CONIC_COVERAGE_TILES && !row->is_beyond_stop;
  const unsigned of = row->shape == CONIC_SHAPE_RAY    ? SUITE_OF_RAYS
                      : row->shape == CONIC_SHAPE_DISC ? SUITE_OF_DISCS
                      : is_fainter                     ? SUITE_OF_FAINTER_ELLIPSES
                                                       : SUITE_OF_ELLIPSES;
  return scene->drawn_by & of && !(scene->drawn_by & SUITE_WITH_TILES && lacks_tiles) &&
         !(scene->drawn_by & SUITE_WITH_CENTER && row->takes_middle) &&
         !(scene->drawn_by & SUITE_WITH_NEAR && row->shape == CONIC_SHAPE_ELLIPSE && !(row->near_z > 0.0));
}

unsigned cli_suite_profiles(const suite_scene *scene) {
  unsigned profiles = scene->asset ? 1u << CONIC_PROFILE_KHR_2026 : 0;
  for (int p = 0; p < SUITE_PROFILES; p++)
    profiles |= draws(scene, p) ? 1u << p : 0;
  return profiles;
}

void cli_suite_camera(const suite_scene *scene, conic_camera *camera) {
  const double *q = scene->rotation;
  double s = 2.0 / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const double rotation[3][3] = {
      {1.0 - s * (q[2] * q[2] + q[3] * q[3]), s * (q[1] * q[2] - q[0] * q[3]), s * (q[1] * q[3] + q[0] * q[2])},
      {s * (q[1] * q[2] + q[0] * q[3]), 1.0 - s * (q[1] * q[1] + q[3] * q[3]), s * (q[2] * q[3] - q[0] * q[1])},
      {s * (q[1] * q[3] - q[0] * q[2]), s * (q[2] * q[3] + q[0] * q[1]), 1.0 - s * (q[1] * q[1] + q[2] * q[2])}};
  memset(camera, 0, sizeof *camera);
  camera->width = scene->width;
  camera->height = scene->height;
  camera->fx = scene->focal[0];
  camera->fy = scene->focal[1];
  camera->cx = scene->center[0];
  camera->cy = scene->center[1];
  for (int i = 0; i < 3; i++) {
    memcpy(camera->cam_from_world[i], rotation[i], sizeof rotation[i]);
    double at = rotation[i][0] * scene->eye[0] + rotation[i][1] * scene->eye[1] + rotation[i][2] * scene->eye[2];
    camera->cam_from_world[i][3] = at != 0.0 ? -at : 0.0;
  }
}
