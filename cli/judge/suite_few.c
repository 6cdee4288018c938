#include "cli/judge/suite_few.h"

#include <math.h>

#include "core/base/random.h"
#include "core/base/real.h"
#include "gaussians/scene/gaussian_set.h"

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

conic_status cli_suite_ball(conic_context *context, conic_gaussians *gaussians) {
  static const suite_one few[] = {{.mean = {0.1, -0.05, 0.0}, ROUND(0.4), .opacity = 0.75, .color = {0.9, 0.6, 0.2}}};
  return put_few(context, few, COUNT(few), 0, 0, gaussians);
}

conic_status cli_suite_ellipse(conic_context *context, conic_gaussians *gaussians) {
  static const suite_one few[] = {{.mean = {-0.4, 0.2, 0.3},
                                   .scale = {0.9, 0.35, 0.12},
                                   .rotation = {0.8, 0.3, -0.4, 0.2},
                                   .opacity = 0.8,
                                   .color = {0.2, 0.7, 0.9}}};
  return put_few(context, few, COUNT(few), 0, 0, gaussians);
}

conic_status cli_suite_solid(conic_context *context, conic_gaussians *gaussians) {
  static const suite_one few[] = {
      {.mean = {0.0625, 0.0625, 0.0}, ROUND(0.5), .opacity = 0.9999, .color = {1.3, -0.2, 0.5}}};
  return put_few(context, few, COUNT(few), 0, 0, gaussians);
}

conic_status cli_suite_harmonics(conic_context *context, conic_gaussians *gaussians) {
  static const suite_one few[] = {{.mean = {0.1, -0.2, 0.1},
                                   .scale = {0.6, 0.4, 0.3},
                                   .rotation = {0.9, -0.2, 0.3, 0.1},
                                   .opacity = 0.9,
                                   .color = {0.6, 0.6, 0.6}}};
  return put_few(context, few, COUNT(few), 3, 0, gaussians);
}

conic_status cli_suite_disc(conic_context *context, conic_gaussians *gaussians) {
  static const suite_one few[] = {{.mean = {0.2, 0.1, 0.0},
                                   .scale = {0.8, 0.4},
                                   .rotation = {0.8, 0.5, 0.2, -0.2},
                                   .opacity = 0.85,
                                   .color = {0.8, 0.3, 0.4}}};
  return put_few(context, few, COUNT(few), 0, CONIC_GAUSSIANS_2D, gaussians);
}

conic_status cli_suite_overlap(conic_context *context, conic_gaussians *gaussians) {
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
conic_status cli_suite_faint(conic_context *context, conic_gaussians *gaussians) {
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
conic_status cli_suite_ring(conic_context *context, conic_gaussians *gaussians) {
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

conic_status cli_suite_discs(conic_context *context, conic_gaussians *gaussians) {
  suite_one few[5];
  for (int i = 0; i < 5; i++)
    few[i] = (suite_one){.mean = {0.35 * i - 0.8, 0.1 * (i % 3) - 0.1, 0.5 - 0.2 * i},
                         .scale = {0.6, 0.35},
                         .rotation = {0.8, 0.15 * i - 0.3, 0.4 - 0.1 * i, 0.1 * i},
                         .opacity = 0.9 - 0.12 * i,
                         .color = {0.9 - 0.2 * i, 0.2 + 0.15 * i, 0.3 + 0.1 * (i % 2)}};
  return put_few(context, few, 5, 0, CONIC_GAUSSIANS_2D, gaussians);
}

conic_status cli_suite_extremes(conic_context *context, conic_gaussians *gaussians) {
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
conic_status cli_suite_least(conic_context *context, conic_gaussians *gaussians) {
  enum { COLUMNS = 11, ROWS = 5, N = COLUMNS * ROWS };
  suite_one few[N];
  for (int i = 0; i < N; i++) {
    int column = i % COLUMNS, row = i / COLUMNS, step = column - COLUMNS / 2;
    double off = column == 0 ? -1e-2 : column == COLUMNS - 1 ? 1e-2 : 2e-7 * step;
    few[i] = (suite_one){.mean = {(3 * step + 0.5) / 8.0, (3 * (row - ROWS / 2) + 0.5) / 8.0, 0.0},
                         ROUND(0.02 + 0.02 * row),
                         .opacity = (1.0 + off) / 255.0,
                         .color = {40.0, 20.0, 10.0}};
  }
  return put_few(context, few, N, 0, 0, gaussians);
}

/* Two piles of four with alphas of 0.9, and two of 0.99 behind one another; the last one is bright. */
conic_status cli_suite_end(conic_context *context, conic_gaussians *gaussians) {
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
conic_status cli_suite_ties(conic_context *context, conic_gaussians *gaussians) {
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

conic_status cli_suite_quaternions(conic_context *context, conic_gaussians *gaussians) {
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
conic_status cli_suite_broken(conic_context *context, conic_gaussians *gaussians) {
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

conic_status cli_suite_far_away(conic_context *context, conic_gaussians *gaussians) {
  conic_status status = cli_suite_overlap(context, gaussians);
  static const float offset[3] = {600.0f, -350.0f, 900.0f};
  for (size_t i = 0; status == CONIC_OK && i < gaussians->count; i++)
    for (int axis = 0; axis < 3; axis++)
      gaussians->position[axis][i] += offset[axis];
  return status;
}

/* The camera is at the origin, so that a float's z is the mean's. */
conic_status cli_suite_near(conic_context *context, conic_gaussians *gaussians) {
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

conic_status cli_suite_aside(conic_context *context, conic_gaussians *gaussians) {
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
conic_status cli_suite_edge_on(conic_context *context, conic_gaussians *gaussians) {
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
