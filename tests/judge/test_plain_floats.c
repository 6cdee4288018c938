/* The bounds of what floats make of Gaussian scenes are never violated: whatever the plain renderer's compiler, device
 * and author do, no pixel of its pictures is wrong. Each evaluation is a picture of a random scene, drawn by an
 * arithmetic that fuses, orders and approximates by chance.
 *
 * test_plain_floats SOURCE [COUNT [FIRST]]: a campaign of so many evaluations, from this one on (scripts/plain-floats).
 */
#include "conic/gaussian_judge.h"
#include "tests/judge/plain_conic.h"
#include "tests/judge/plain_gaussians.h"
#include "tests/support/check.h"

enum { SIDE = 16, N_PROFILES = 9, MOST_TOLD = 40 };

static const conic_gaussian_profile profiles[N_PROFILES] = {
    CONIC_PROFILE_INRIA_2023, CONIC_PROFILE_GSPLAT_1_5,    CONIC_PROFILE_GSPLAT_1_5_AA,
    CONIC_PROFILE_GSPLAT_1_6, CONIC_PROFILE_GSPLAT_1_6_AA, CONIC_PROFILE_KHR_2026,
    CONIC_PROFILE_2DGS_2024,  CONIC_PROFILE_2DGS_GSPLAT,   CONIC_PROFILE_EXACT};

/* What the evaluations of a profile came to. */
typedef struct plain_tally {
  size_t evaluations, pixels[CONIC_N_GAUSSIAN_CLASSES], wide, violated;
  double widest;
} plain_tally;

typedef struct plain_evaluation {
  uint64_t seed;
  plain_floats chance; /* of the scene, not of the arithmetic */
  conic_gaussian_profile profile;
  conic_float_kind kind;
  conic_gaussians scene;
  conic_camera camera;
  plain_settings settings;
} plain_evaluation;

static double unit_by_chance(plain_evaluation *e) {
  return plain_chance(&e->chance, 1u << 24) * 0x1p-24;
}

static double between(plain_evaluation *e, double low, double high) {
  return low + (high - low) * unit_by_chance(e);
}

/* A quaternion of length 1, as files have it to the last bit of each number. */
static void turn_by_chance(plain_evaluation *e, double q[4]) {
  double length = 0.0;
  while (!(length > 0.01)) {
    length = 0.0;
    for (int k = 0; k < 4; k++) {
      q[k] = between(e, -1.0, 1.0);
      length += q[k] * q[k];
    }
  }
  for (int k = 0; k < 4; k++)
    q[k] /= sqrt(length);
}

/* Manners of scenes: like trained ones, needles, crowds that hide each other, at the near plane, in pairs of one depth
 * and opacities at the limits, far from the origin, small on the screen, a few that fill the picture, opaque and faint,
 * and a window far beside the middle of a large picture. */
enum { TRAINED, NEEDLES, CROWD, NEAR, PAIRS, FAR, SMALL, WALLS, WINDOW, N_MANNERS };

static void look_by_chance(plain_evaluation *e, int manner, double distance, const double at[3]) {
  double q[4], r[3][3];
  turn_by_chance(e, q);
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  const double rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                             {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                             {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  memcpy(r, rows, sizeof r);
  double focal = between(e, 0.5, 3.0) * SIDE;
  e->camera = (conic_camera){.width = SIDE, .height = SIDE, .fx = focal, .fy = focal * between(e, 0.9, 1.1)};
  int is_off =
      plain_chance(&e->chance, 2) && e->profile != CONIC_PROFILE_INRIA_2023 && e->profile != CONIC_PROFILE_2DGS_2024;
  e->camera.cx = SIDE * (is_off ? between(e, 0.3, 0.7) : 0.5);
  e->camera.cy = SIDE * (is_off ? between(e, 0.3, 0.7) : 0.5);
  double right = 0.0, down = 0.0;
  if (is_off && manner == WINDOW) {
    e->camera.fx = e->camera.fy = 1500.0;
    e->camera.cx = between(e, -1900.0, 1900.0);
    e->camera.cy = between(e, -1000.0, 1000.0);
    right = distance * (0.5 * SIDE - e->camera.cx) / e->camera.fx;
    down = distance * (0.5 * SIDE - e->camera.cy) / e->camera.fy;
  }
  for (int row = 0; row < 3; row++) {
    e->camera.cam_from_world[row][3] = row == 0 ? right : row == 1 ? down : distance;
    for (int axis = 0; axis < 3; axis++) {
      e->camera.cam_from_world[row][axis] = r[row][axis];
      e->camera.cam_from_world[row][3] -= r[row][axis] * at[axis];
    }
  }
}

static void scatter(plain_evaluation *e, int manner, const double at[3]) {
  static const float limits[6] = {1.0f, 0.99f, 0.999f, 1.0f / 255.0f, 0.5f, 0.0f};
  conic_gaussians *s = &e->scene;
  static const double sizes[N_MANNERS] = {-3.5, -3.5, -2.5, -3.5, -3.5, -3.5, -6.0, 2.0, -6.0};
  const double reach = manner == NEAR ? 0.3 : manner == WINDOW ? 0.03 : 1.2, fine = sizes[manner];
  for (size_t i = 0; i < s->count; i++) {
    double q[4], size = between(e, fine - 1.5, fine + 1.5);
    turn_by_chance(e, q);
    for (int k = 0; k < 4; k++)
      s->rotation[k][i] = (float)(q[k] * (plain_chance(&e->chance, 8) ? 1.0 : 3.0));
    for (int k = 0; k < 3; k++) {
      double apart = manner == NEEDLES ? (k == 0 ? 2.5 : -3.0) : between(e, -1.5, 0.5);
      s->position[k][i] = (float)(at[k] + between(e, -reach, reach));
      if (s->scale[k])
        s->scale[k][i] = (float)exp(size + apart);
    }
    s->opacity[i] = (float)(1.0 / (1.0 + exp(-between(e, -5.0, 6.0))));
    if (manner == PAIRS && i % 2)
      for (int k = 0; k < 3; k++)
        s->position[k][i] = s->position[k][i - 1];
    if (manner == WALLS)
      s->opacity[i] = (float)(plain_chance(&e->chance, 3) ? between(e, 0.0, 0.7) : 1.0);
    if (manner == PAIRS && i % 3)
      s->opacity[i] = limits[plain_chance(&e->chance, 6)];
    for (size_t k = 0, n = (size_t)((s->sh_degree + 1) * (s->sh_degree + 1)) * 3; k < n; k++)
      s->sh[i * n + k] = (float)(between(e, -1.0, 1.0) * (k < 3 ? 1.7 : 0.4));
  }
}

static void choose_manner(plain_evaluation *e) {
  plain_manner *m = &e->settings.manner;
  m->projects_covariance = (int)plain_chance(&e->chance, 3);
  m->sums_in_any_order = (int)plain_chance(&e->chance, 2);
  m->sums_weights = (int)plain_chance(&e->chance, 2);
  m->divides_by_alpha = (int)plain_chance(&e->chance, 2);
  m->subtracts_weights = (int)plain_chance(&e->chance, 2);
  m->divides_form = (int)plain_chance(&e->chance, 2);
  m->normalises_rotation = (int)plain_chance(&e->chance, 3);
}

static void choose_all(conic_context *context, plain_evaluation *e) {
  double at[3] = {0.0, 0.0, 0.0};
  int manner = (int)plain_chance(&e->chance, N_MANNERS);
  e->profile = profiles[plain_chance(&e->chance, N_PROFILES)];
  e->kind = plain_chance(&e->chance, 2) ? CONIC_FLOATS_FAST : CONIC_FLOATS_STRICT;
  for (int k = 0; k < 3 && manner == FAR; k++)
    at[k] = between(e, -50.0, 50.0);
  look_by_chance(e, manner, manner == NEAR ? 0.2 : between(e, 0.5, 4.0), at);
  int is_disc = e->profile == CONIC_PROFILE_2DGS_2024 || e->profile == CONIC_PROFILE_2DGS_GSPLAT;
  CHECK_OK(conic_gaussians_allocate(context,
                                    manner == CROWD   ? 60
                                    : manner == WALLS ? 2 + plain_chance(&e->chance, 2)
                                                      : 4 + plain_chance(&e->chance, 30),
                                    (int)plain_chance(&e->chance, 4), is_disc ? CONIC_GAUSSIANS_2D : 0, &e->scene));
  scatter(e, manner, at);
  e->settings.profile = plain_profile_find(conic_gaussian_profile_name(e->profile));
  for (int c = 0; c < 3; c++)
    e->settings.background[c] = plain_chance(&e->chance, 2) ? (float)unit_by_chance(e) : 0.0f;
  e->settings.floats = plain_floats_by_chance(e->seed * 7919 + 1, e->kind == CONIC_FLOATS_FAST);
  choose_manner(e);
}

/* The same scene as the plain renderer has it, activated by its own floats. */
static plain_scene plain_copy(plain_evaluation *e) {
  const conic_gaussians *from = &e->scene;
  const size_t n = from->count, n_sh = n * (size_t)((from->sh_degree + 1) * (from->sh_degree + 1)) * 3;
  plain_scene s = {.count = n, .sh_degree = from->sh_degree, .n_scales = from->scale[2] ? 3 : 2};
  s.mean = calloc(n, 3 * sizeof *s.mean);
  s.scale = calloc(n, 3 * sizeof *s.scale);
  s.rotation = calloc(n, 4 * sizeof *s.rotation);
  s.opacity = calloc(n, sizeof *s.opacity);
  s.sh = calloc(n_sh, sizeof *s.sh);
  for (size_t i = 0; i < n; i++) {
    for (size_t k = 0; k < 3; k++) {
      s.mean[3 * i + k] = from->position[k][i];
      s.scale[3 * i + k] = from->scale[k] ? plain_within_two_ulp(&e->chance, (double)from->scale[k][i]) : 0.0f;
    }
    for (size_t k = 0; k < 4; k++)
      s.rotation[4 * i + k] = from->rotation[k][i];
    s.opacity[i] = fmaxf(fminf(plain_within_two_ulp(&e->chance, (double)from->opacity[i]), 1.0f), 0.0f);
  }
  memcpy(s.sh, from->sh, n_sh * sizeof *s.sh);
  return s;
}

static const unsigned judged =
    1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_COUNT | 1u << CONIC_PLANE_TRANSPARENCY;

/* What the bounds have of the pixel that is farthest off. */
static void tell_pixel(conic_context *context, const plain_evaluation *e, const conic_gaussian_options *options,
                       const conic_float_model *model, int x, int y) {
  conic_gaussian_listing listing;
  CHECK_OK(conic_gaussian_explain(context, &e->scene, &e->camera, options, model, NULL, x, y, &listing));
  for (size_t k = 0; k < listing.n; k++) {
    const conic_gaussian_entry *g = &listing.entries[k];
    printf("  Gaussian %u, %s: q %.9g (%.9g to %.9g), alpha %.9g (%.9g to %.9g), z %.9g, doubts %x\n", g->index,
           conic_gaussian_part_name(g->part), g->q, g->q_low, g->q_high, g->alpha, g->alpha_low, g->alpha_high, g->z,
           g->doubts);
  }
  conic_gaussian_listing_release(context, &listing);
}

/* All that is needed to find out why. */
static void tell_violation(conic_context *context, const plain_evaluation *e, const conic_gaussian_options *options,
                           const conic_float_model *model, const conic_gaussian_verdict *v) {
  static size_t n_told;
  const plain_settings *s = &e->settings;
  if (n_told++ >= MOST_TOLD)
    return;
  printf("evaluation %llu: %s, floats %d (fused %d, shuffled %d, fast %d, exp %d), covariance %d, sums %d, alpha %d, "
         "depth %d, T %d, form %d, rotation %d: %zu wrong\n",
         (unsigned long long)e->seed, s->profile->name, (int)e->kind, s->floats.fused, s->floats.is_shuffled,
         s->floats.is_fast, (int)s->floats.exp, s->manner.projects_covariance, s->manner.sums_in_any_order,
         s->manner.sums_weights, s->manner.divides_by_alpha, s->manner.subtracts_weights, s->manner.divides_form,
         s->manner.normalises_rotation, v->pixels[CONIC_PIXEL_WRONG]);
  for (int k = 0; k < v->n_worst && k < 2; k++)
    printf("  pixel %d,%d %s[%d]: %.9g not in %.9g to %.9g\n", v->worst[k].x, v->worst[k].y,
           conic_plane_describe((conic_plane)v->worst[k].plane)->name, v->worst[k].channel, v->worst[k].found,
           v->worst[k].low, v->worst[k].high);
  tell_pixel(context, e, options, model, v->worst[0].x, v->worst[0].y);
}

static void evaluate(conic_context *context, uint64_t seed, plain_tally tallies[][N_PROFILES]) {
  plain_evaluation e = {.seed = seed, .chance = {.state = seed * 104729}};
  choose_all(context, &e);
  plain_scene scene = plain_copy(&e);
  const plain_camera camera = plain_camera_of(&e.camera);
  plain_picture picture = plain_picture_allocate(SIDE, SIDE);
  plain_gaussians_draw(&scene, &camera, &e.settings, &picture);
  conic_image image = image_of_plain(context, &picture, judged);
  conic_gaussian_options options;
  conic_gaussian_judging judging;
  conic_gaussian_verdict v;
  conic_float_model model;
  conic_gaussian_options_init(&options);
  conic_gaussian_judging_init(&judging);
  conic_float_model_init(&model, e.kind);
  options.profile = e.profile;
  memcpy(options.background, e.settings.background, sizeof options.background);
  judging.model = &model;
  CHECK_OK(conic_gaussian_judge(context, &e.scene, &e.camera, &options, &judging, &image, NULL, &v));
  int at = 0;
  while (profiles[at] != e.profile)
    at++;
  plain_tally *tally = &tallies[e.kind == CONIC_FLOATS_FAST][at];
  tally->evaluations++;
  tally->violated += v.pixels[CONIC_PIXEL_WRONG] > 0;
  tally->wide += v.wide_pixels;
  for (int k = 0; k < CONIC_N_GAUSSIAN_CLASSES; k++)
    tally->pixels[k] += v.pixels[k];
  if (v.pixels[CONIC_PIXEL_WRONG])
    tell_violation(context, &e, &options, &model, &v);
  conic_image_release(context, &image);
  conic_gaussians_release(context, &e.scene);
  plain_picture_release(&picture);
  plain_scene_release(&scene);
}

int main(int argc, char **argv) {
  const uint64_t n = argc > 2 ? strtoull(argv[2], NULL, 10) : 1200, first = argc > 3 ? strtoull(argv[3], NULL, 10) : 1;
  static plain_tally tallies[2][N_PROFILES];
  size_t n_violated = 0;
  conic_context *context = check_context(1);
  for (uint64_t seed = first; seed < first + n; seed++)
    evaluate(context, seed, tallies);
  for (int fast = 0; fast < 2; fast++)
    for (int k = 0; k < N_PROFILES; k++) {
      const plain_tally *t = &tallies[fast][k];
      printf(
          "%-6s %-14s %5zu evaluations: equal %7zu, rounded %7zu, explained %6zu, wrong %4zu; wide %zu; violated %zu\n",
          fast ? "fast" : "strict", conic_gaussian_profile_name(profiles[k]), t->evaluations,
          t->pixels[CONIC_PIXEL_EQUAL], t->pixels[CONIC_PIXEL_ROUNDED], t->pixels[CONIC_PIXEL_EXPLAINED],
          t->pixels[CONIC_PIXEL_WRONG], t->wide, t->violated);
      n_violated += t->violated;
    }
  CHECK(n_violated == 0);
  conic_context_destroy(context);
  return check_result();
}
