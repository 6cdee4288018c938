/* Each mistake that the tests' own renderers can make is named first, and a picture without one is never accused.
 *
 * As a campaign (scripts/judge-campaign): test_diagnosis SOURCE scenes COUNT FIRST [FILE.ply], made scenes by chance;
 * test_diagnosis SOURCE SCENE.ply CAMERA.json PROFILE [8-bit | pairs [STEP]], all mistakes or each STEP-th pair. */
#include <time.h>

#include "conic/diagnosis.h"
#include "gaussians/scene/made_gaussians.h"
#include "tests/judge/plain_conic.h"
#include "tests/judge/plain_gaussians.h"
#include "tests/judge/plain_surfels.h"
#include "tests/support/check.h"
#include "tests/support/files.h"

/* A scene as both have it. */
typedef struct diagnosed_world {
  conic_context *context;
  conic_gaussians scene;
  conic_camera camera;
  plain_scene plain; /* of no mistake */
  plain_camera plain_camera;
  const char *scene_path;
  conic_gaussian_profile profile;
  float near; /* of the renderer; 0: the profile's */
  int tells;
} diagnosed_world;

/* What came of a picture. */
typedef struct diagnosed_picture {
  size_t n_wrong;
  conic_diagnosis found[CONIC_MOST_DIAGNOSES];
  int n_found;
  double seconds;
} diagnosed_picture;

static const unsigned diagnosed = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_TRANSPARENCY;

static double cpu_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* What codes of 8 bits stand for; the image becomes the least, and the caller releases the greatest. */
static conic_image quantise(conic_context *context, conic_image *image) {
  const size_t n = (size_t)image->width * (size_t)image->height;
  conic_image greatest;
  CHECK_OK(conic_image_allocate(context, image->width, image->height, conic_image_planes(image), &greatest));
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    if (image->planes[plane])
      memcpy(greatest.planes[plane], image->planes[plane],
             n * (size_t)conic_plane_describe((conic_plane)plane)->n_channels * sizeof(float));
  float *low = image->planes[CONIC_PLANE_RGBA], *high = greatest.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < 4 * n; i++) {
    const float code = floorf(fminf(fmaxf(low[i], 0.0f), 1.0f) * 255.0f + 0.5f);
    if (i % 4 == 3)
      continue;
    low[i] = code > 0.0f ? (code - 0.50001f) / 255.0f : -INFINITY;
    high[i] = code < 255.0f ? (code + 0.50001f) / 255.0f : INFINITY;
  }
  return greatest;
}

static diagnosed_picture diagnose(const diagnosed_world *w, unsigned faults, int is_8_bit) {
  diagnosed_picture p = {.n_found = 0};
  const unsigned reading = 1u << PLAIN_F_REST_INTERLEAVED | 1u << PLAIN_QUATERNION_XYZW | 1u << PLAIN_SCALE_LINEAR |
                           1u << PLAIN_OPACITY_LINEAR | 1u << PLAIN_QUATERNION_NOT_NORMALISED;
  plain_profile profile = *plain_profile_find(conic_gaussian_profile_name(w->profile));
  const plain_settings settings = {.profile = &profile, .faults = faults};
  profile.near = w->near > 0.0f ? w->near : profile.near;
  plain_scene scene = faults & reading ? plain_scene_read(w->scene_path, faults) : w->plain;
  plain_picture picture = plain_picture_allocate(w->camera.width, w->camera.height);
  plain_gaussians_draw(&scene, &w->plain_camera, &settings, &picture);
  conic_image image = image_of_plain(w->context, &picture, diagnosed);
  conic_image greatest = {.width = 0};
  if (is_8_bit)
    greatest = quantise(w->context, &image);
  conic_gaussian_options options;
  conic_gaussian_judging judging;
  conic_gaussian_verdict verdict;
  conic_float_model model;
  const size_t n = (size_t)image.width * (size_t)image.height;
  uint8_t *classes = malloc(n);
  float *ranges = calloc(n, sizeof *ranges);
  conic_gaussian_options_init(&options);
  conic_gaussian_judging_init(&judging);
  conic_float_model_init(&model, CONIC_FLOATS_STRICT);
  options.profile = w->profile;
  options.ignores_center = 1;
  judging.model = &model;
  judging.n_pixels = n > 40000 ? 10000 : 0;
  judging.greatest = is_8_bit ? &greatest : NULL;
  judging.ranges = ranges;
  memset(classes, CONIC_N_PIXEL_CLASSES, n);
  CHECK_OK(conic_gaussian_judge(w->context, &w->scene, &w->camera, &options, &judging, &image, classes, &verdict));
  for (size_t i = 0; i < n; i++)
    p.n_wrong += classes[i] == CONIC_PIXEL_WRONG;
  const double start = cpu_seconds();
  CHECK_OK(conic_gaussian_diagnose(w->context, &w->scene, &w->camera, &options, &judging, &image, classes, p.found,
                                   CONIC_MOST_DIAGNOSES, &p.n_found));
  p.seconds = cpu_seconds() - start;
  free(classes);
  free(ranges);
  conic_image_release(w->context, &image);
  conic_image_release(w->context, &greatest);
  plain_picture_release(&picture);
  if (scene.mean != w->plain.mean)
    plain_scene_release(&scene);
  return p;
}

static void tell_diagnosis(const char *planted, const char *second, const diagnosed_picture *p) {
  printf("%-26s %-26s %6zu wrong %6.2f s:", planted, second, p->n_wrong, p->seconds);
  for (int k = 0; k < p->n_found && k < 4; k++)
    printf(" %s%s%s%s %.6f (%u righted, %u spoilt)", p->found[k].is_nearest ? "nearest " : "", p->found[k].name,
           p->found[k].with ? "+" : "", p->found[k].with ? p->found[k].with : "", p->found[k].share,
           p->found[k].righted, p->found[k].spoilt);
  printf("\n");
  fflush(stdout);
}

/* How often what was planted was found. */
typedef struct diagnosis_tally {
  size_t tried, seen, named, accused;
  size_t nearest; /* came first, but only as what is nearest */
} diagnosis_tally;

/* Returns whether the mistake was named first; a picture that is right has none. No name is wrong: of two, one is it.
 */
static int try_fault(const diagnosed_world *w, plain_fault fault, int is_8_bit, diagnosis_tally *counts) {
  const diagnosed_picture p = diagnose(w, 1u << fault, is_8_bit);
  const conic_diagnosis *first = p.n_found ? &p.found[0] : NULL;
  const int is_it = first && strcmp(first->name, plain_fault_names[fault]) == 0;
  const int is_named = is_it && !first->with && !first->is_nearest;
  CHECK(!first || first->is_nearest || is_it || (first->with && strcmp(first->with, plain_fault_names[fault]) == 0));
  if (!p.n_wrong) {
    CHECK(p.n_found == 0);
    return 1;
  }
  counts->seen++;
  counts->nearest += (size_t)(is_it && !first->with && first->is_nearest);
  if (!is_named || w->tells)
    tell_diagnosis(plain_fault_names[fault], is_named ? "" : "NOT NAMED FIRST", &p);
  return is_named;
}

static void open_world(diagnosed_world *w) {
  w->plain = plain_scene_read(w->scene_path, 0);
  w->plain_camera = plain_camera_of(&w->camera);
}

static void close_world(diagnosed_world *w) {
  plain_scene_release(&w->plain);
  conic_gaussians_release(w->context, &w->scene);
}

/* From before the scene, off the middle. */
static conic_camera made_camera(int size, int is_off) {
  conic_camera c = {.width = size, .height = size, .fx = size * 1.1, .fy = size * 1.1};
  c.cx = size * (is_off ? 0.47 : 0.5);
  c.cy = size * (is_off ? 0.52 : 0.5);
  const double rows[3][4] = {{0.8, 0.0, 0.6, 0.1}, {0.12, 0.98, -0.16, 0.2}, {-0.588, 0.2, 0.784, 3.3}};
  memcpy(c.cam_from_world, rows, sizeof rows);
  return c;
}

/* A made scene whose file's quaternions are of any length, and where something stands before the near plane. */
static void make_world(conic_context *context, uint64_t seed, conic_gaussian_profile profile, const char *path,
                       diagnosed_world *w) {
  conic_gaussians made;
  conic_gaussians_write_options options;
  *w = (diagnosed_world){.context = context, .scene_path = path, .profile = profile};
  CHECK_OK(conic_gaussians_make(context, 80, 3, seed, &made));
  for (size_t i = 0; i < made.count; i++) {
    for (int k = 0; k < 4; k++)
      made.rotation[k][i] *= 0.6f + 0.1f * (float)(i % 9);
    for (int k = 0; k < 3; k++)
      made.scale[k][i] *= i % 4 ? 2.0f : 5.0f;
    made.opacity[i] = i % 4 ? made.opacity[i] : 0.9999f;
  }
  w->camera = made_camera(16, profile != CONIC_PROFILE_INRIA_2023 && profile != CONIC_PROFILE_2DGS_2024);
  for (size_t i = 0; i < 3; i++) { /* 0.1 before the eye */
    const double p[3] = {0.01 * (double)i - w->camera.cam_from_world[0][3], -w->camera.cam_from_world[1][3],
                         0.1 - w->camera.cam_from_world[2][3]};
    for (int axis = 0; axis < 3; axis++) {
      made.position[axis][i] = 0.0f;
      for (int row = 0; row < 3; row++)
        made.position[axis][i] += (float)(w->camera.cam_from_world[row][axis] * p[row]);
      made.scale[axis][i] = 0.01f;
    }
    made.opacity[i] = 0.6f;
  }
  conic_gaussians_write_options_init(&options);
  CHECK_OK(conic_gaussians_write(context, path, &made, &options));
  conic_gaussians_release(context, &made);
  CHECK_OK(conic_gaussians_read(context, path, NULL, &w->scene));
  open_world(w);
}

static int is_of_gaussians(plain_fault fault) {
  return fault < PLAIN_AFFINE;
}

/* A near plane that nobody lists. */
static void test_any_near(diagnosed_world *w) {
  w->near = 2.87f;
  const diagnosed_picture p = diagnose(w, 0, 0);
  if (w->tells)
    tell_diagnosis("any near", "", &p);
  CHECK(p.n_wrong > 0 && p.n_found > 0 && !p.found[0].is_nearest && strcmp(p.found[0].name, "near") == 0 &&
        p.found[0].share > 0.99);
  w->near = 0.0f;
}

static void test_pair(diagnosed_world *w) {
  const diagnosed_picture p = diagnose(w, 1u << PLAIN_HALF_PIXEL | 1u << PLAIN_SRGB_DECODED, 0);
  CHECK(p.n_found == 2 && !p.found[0].is_nearest && strcmp(p.found[0].with, p.found[1].name) == 0 &&
        strcmp(p.found[1].with, p.found[0].name) == 0);
  CHECK(p.found[0].share > 0.99 && p.found[0].share == p.found[1].share);
  CHECK(strcmp(p.found[0].name, "half-pixel") == 0 || strcmp(p.found[1].name, "half-pixel") == 0);
  CHECK(strcmp(p.found[0].name, "srgb-decoded") == 0 || strcmp(p.found[1].name, "srgb-decoded") == 0);
}

static void test_made(conic_context *context) {
  static const conic_gaussian_profile profiles[] = {CONIC_PROFILE_GSPLAT_1_5, CONIC_PROFILE_INRIA_2023,
                                                    CONIC_PROFILE_2DGS_GSPLAT};
  char path[160];
  snprintf(path, sizeof path, "%s", files_path("scene.ply"));
  for (size_t k = 0; k < sizeof profiles / sizeof *profiles; k++) {
    diagnosed_world w;
    size_t n_named = 0, n_tried = 0;
    diagnosis_tally counts = {0};
    make_world(context, 7 + k, profiles[k], path, &w);
    w.tells = getenv("DIAGNOSIS_TELLS") != NULL;
    const diagnosed_picture right = diagnose(&w, 0, 0);
    CHECK(right.n_wrong == 0 && right.n_found == 0);
    for (plain_fault fault = 0; is_of_gaussians(fault); fault++, n_tried++)
      n_named += (size_t)try_fault(&w, fault, 0, &counts);
    printf("%s: %zu of %zu mistakes are seen, %zu not named\n", conic_gaussian_profile_name(profiles[k]), counts.seen,
           n_tried, n_tried - n_named);
    /* Where discs end is in doubt along whole edges of tiles. There, a tenth to a fifth of the difference stays with
     * three of the mistakes, which are too much for a name: they come first, as what is nearest. */
    CHECK(n_named + counts.nearest == n_tried);
    CHECK(counts.nearest <= (profiles[k] == CONIC_PROFILE_2DGS_GSPLAT ? 3 : 0));
    test_any_near(&w);
    test_pair(&w);
    close_world(&w);
    remove(path);
  }
}

/* Surface splats on a bent strip that is seen from near and under a slant, some from behind; the same for both. */
static conic_splats make_surfels(conic_context *context, plain_surfels *plain) {
  enum { ACROSS = 14, ALONG = 20 };
  conic_splats s;
  CHECK_OK(conic_splats_allocate(context, ACROSS * ALONG, CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS, &s));
  *plain = (plain_surfels){.count = s.count,
                           .center = calloc(s.count, 3 * sizeof(float)),
                           .axes = {calloc(s.count, 3 * sizeof(float)), calloc(s.count, 3 * sizeof(float))},
                           .color = calloc(s.count, 3 * sizeof(float))};
  for (size_t i = 0; i < s.count; i++) {
    const float x = (float)(i % ACROSS) - 6.5f, t = 0.32f * (float)(i / ACROSS);
    const float p[3] = {0.16f * x, 0.9f * sinf(t), 0.9f * cosf(t)}, u[3] = {0.1f, 0.02f, 0.0f};
    const float v[3] = {0.0f, 0.12f * cosf(t), -0.12f * sinf(t)};
    const float color[3] = {i % 2 ? 0.8f : 0.1f, i % 3 ? 0.3f : 0.9f, i % 5 ? 0.2f : 0.7f};
    for (int k = 0; k < 3; k++) {
      plain->center[3 * i + (size_t)k] = s.position[k][i] = p[k];
      plain->axes[0][3 * i + (size_t)k] = s.tangent_u[k][i] = u[k];
      plain->axes[1][3 * i + (size_t)k] = s.tangent_v[k][i] = v[k];
      plain->color[3 * i + (size_t)k] = s.color[k][i] = color[k];
    }
  }
  return s;
}

typedef struct diagnosed_surfels {
  conic_context *context;
  conic_splats splats;
  plain_surfels plain;
  conic_camera camera;
  conic_render_options options;
} diagnosed_surfels;

static diagnosed_picture diagnose_surfels(const diagnosed_surfels *w, unsigned faults) {
  diagnosed_picture p = {.n_found = 0};
  const plain_camera camera = plain_camera_of(&w->camera);
  const plain_surfel_settings settings = {.cutoff = 1.5f, .prefilter = 1.0f, .faults = faults};
  const conic_drawing drawing = {.splats = &w->splats};
  plain_surfels plain = w->plain;
  plain_picture picture = plain_picture_allocate(w->camera.width, w->camera.height);
  conic_reference reference;
  conic_oracle_judgement judgement;
  if (plain_has(faults, PLAIN_RADIUS_AS_SIGMA)) /* a scene of radii */
    for (size_t i = 0; i < 6 * plain.count; i++)
      plain.axes[i / (3 * plain.count)][i % (3 * plain.count)] *= 1.5f;
  plain_surfels_draw(&plain, &camera, &settings, &picture);
  if (plain_has(faults, PLAIN_RADIUS_AS_SIGMA))
    for (size_t i = 0; i < 6 * plain.count; i++)
      plain.axes[i / (3 * plain.count)][i % (3 * plain.count)] /= 1.5f;
  conic_image image = image_of_plain(w->context, &picture, diagnosed);
  const size_t n = (size_t)image.width * (size_t)image.height;
  uint8_t *classes = malloc(n);
  CHECK_OK(
      conic_oracle_render_drawing(w->context, &drawing, &w->camera, &w->options, CONIC_ORACLE_METHOD, 1, &reference));
  CHECK_OK(conic_oracle_judge(w->context, &reference, NULL, &image, classes, &judgement));
  p.n_wrong = judgement.pixels[CONIC_PIXEL_WRONG];
  CHECK_OK(conic_drawing_diagnose(w->context, &drawing, &w->camera, &w->options, 1, NULL, &image, classes, p.found,
                                  CONIC_MOST_DIAGNOSES, &p.n_found));
  free(classes);
  conic_reference_release(w->context, &reference);
  conic_image_release(w->context, &image);
  plain_picture_release(&picture);
  return p;
}

static void test_surfels(conic_context *context) {
  static const plain_fault faults[] = {PLAIN_AFFINE,           PLAIN_NO_AMPLITUDE, PLAIN_EPSILON_IN_Z,
                                       PLAIN_RADIUS_AS_SIGMA,  PLAIN_BACK_FACES,   PLAIN_NO_NORMALISATION,
                                       PLAIN_HALF_PIXEL,       PLAIN_MIRRORED_X,   PLAIN_MIRRORED_Y,
                                       PLAIN_CENTRE_IGNORED,   PLAIN_SRGB_DECODED, PLAIN_SRGB_ENCODED,
                                       PLAIN_BACKGROUND_WHITE, PLAIN_NEAR};
  diagnosed_surfels w = {.context = context, .camera = made_camera(40, 1)};
  w.splats = make_surfels(context, &w.plain);
  w.camera.fx = w.camera.fy = 28.0;
  w.camera.cam_from_world[2][3] = 2.6;
  conic_render_options_init(&w.options);
  w.options.method = CONIC_METHOD_CONIC;
  w.options.shading = CONIC_SHADE_NONE;
  const diagnosed_picture right = diagnose_surfels(&w, 0);
  CHECK(right.n_wrong == 0 && right.n_found == 0);
  for (size_t k = 0; k < sizeof faults / sizeof *faults; k++) {
    const diagnosed_picture p = diagnose_surfels(&w, 1u << faults[k]);
    int is_named =
        p.n_found > 0 && !p.found[0].is_nearest && strcmp(p.found[0].name, plain_fault_names[faults[k]]) == 0;
    if (!is_named || getenv("DIAGNOSIS_TELLS"))
      tell_diagnosis(plain_fault_names[faults[k]], is_named ? "" : "NOT NAMED FIRST", &p);
    CHECK(is_named);
  }
  plain_surfels_release(&w.plain);
  conic_splats_release(context, &w.splats);
}

static int names_both(const diagnosed_picture *p, int a, int b) {
  int is_a = 0, is_b = 0;
  for (int k = 0; k < p->n_found && k < 2 && !p->found[k].is_nearest; k++) {
    is_a |= strcmp(p->found[k].name, plain_fault_names[a]) == 0;
    is_b |= strcmp(p->found[k].name, plain_fault_names[b]) == 0;
  }
  return is_a && is_b;
}

static void try_pair(const diagnosed_world *w, int a, int b, diagnosis_tally *tally) {
  const diagnosed_picture pair = diagnose(w, 1u << a | 1u << b, 0);
  /* Only where each is seen beside the other: the picture is that of neither alone. */
  const diagnosed_picture one = diagnose(w, 1u << a, 0), other = diagnose(w, 1u << b, 0);
  const int is_seen = one.n_wrong > 0 && other.n_wrong > 0, is_named = names_both(&pair, a, b);
  tally->tried++;
  tally->seen += (size_t)is_seen;
  tally->named += (size_t)(is_seen && is_named);
  if (w->tells && is_seen && !is_named)
    tell_diagnosis(plain_fault_names[a], plain_fault_names[b], &pair);
}

/* A made scene a seed: right, with a mistake by chance, and with two. */
static void try_scenes(conic_context *context, const char *path, uint64_t n, uint64_t first) {
  static const conic_gaussian_profile profiles[] = {CONIC_PROFILE_GSPLAT_1_5,    CONIC_PROFILE_GSPLAT_1_6,
                                                    CONIC_PROFILE_INRIA_2023,    CONIC_PROFILE_KHR_2026,
                                                    CONIC_PROFILE_GSPLAT_1_6_AA, CONIC_PROFILE_2DGS_GSPLAT};
  diagnosis_tally right = {0}, alone = {0}, pairs = {0};
  for (uint64_t seed = first; seed < first + n; seed++) {
    diagnosed_world w;
    plain_floats chance = {.state = seed * 7919};
    make_world(context, seed, profiles[seed % 6], path, &w);
    const diagnosed_picture none = diagnose(&w, 0, 0);
    const int a = (int)plain_chance(&chance, PLAIN_AFFINE), b = (int)plain_chance(&chance, PLAIN_AFFINE);
    right.tried++;
    right.seen += none.n_wrong > 0;
    right.accused += none.n_found > 0;
    w.tells = 1;
    const size_t before = alone.seen;
    const int is_named = try_fault(&w, (plain_fault)a, 0, &alone);
    alone.tried++;
    alone.named += (size_t)(is_named && alone.seen > before);
    if (a != b)
      try_pair(&w, a, b, &pairs);
    close_world(&w);
    remove(path);
  }
  printf("right: %zu scenes, %zu with wrong pixels, %zu accused\n", right.tried, right.seen, right.accused);
  printf("one mistake: %zu planted, %zu seen, %zu named first\n", alone.tried, alone.seen, alone.named);
  printf("two: %zu planted, %zu both seen, %zu both named\n", pairs.tried, pairs.seen, pairs.named);
}

static int find_profile(const char *name) {
  for (int k = 0; k < CONIC_N_GAUSSIAN_PROFILES; k++)
    if (strcmp(conic_gaussian_profile_name((conic_gaussian_profile)k), name) == 0)
      return k;
  return 0;
}

static void campaign(conic_context *context, int argc, char **argv) {
  const int is_8_bit = argc > 5 && strcmp(argv[5], "8-bit") == 0;
  const int has_pairs = argc > 5 && strcmp(argv[5], "pairs") == 0, step = argc > 6 ? atoi(argv[6]) : 1;
  diagnosed_world w = {.context = context, .scene_path = argv[2], .tells = 1};
  diagnosis_tally tally = {0};
  w.profile = (conic_gaussian_profile)find_profile(argv[4]);
  if (conic_gaussians_read(context, argv[2], NULL, &w.scene) != CONIC_OK ||
      conic_camera_read(context, argv[3], &w.camera) != CONIC_OK)
    exit(1);
  open_world(&w);
  for (plain_fault fault = 0; is_of_gaussians(fault) && !has_pairs; fault++, tally.tried++) {
    const size_t before = tally.seen;
    const int is_named = try_fault(&w, fault, is_8_bit, &tally);
    tally.named += (size_t)(is_named && tally.seen > before);
  }
  for (int pair = 0; has_pairs && pair < PLAIN_AFFINE * PLAIN_AFFINE; pair += step)
    if (pair / PLAIN_AFFINE < pair % PLAIN_AFFINE)
      try_pair(&w, pair / PLAIN_AFFINE, pair % PLAIN_AFFINE, &tally);
  printf("%zu planted, %zu seen, %zu named\n", tally.tried, tally.seen, tally.named);
  close_world(&w);
}

int main(int argc, char **argv) {
  if (argc > 4) {
    conic_context *context = check_context(2);
    if (strcmp(argv[2], "scenes") == 0)
      try_scenes(context, argc > 5 ? argv[5] : "/tmp/conic-campaign.ply", strtoull(argv[3], NULL, 10),
                 strtoull(argv[4], NULL, 10));
    else
      campaign(context, argc, argv);
    conic_context_destroy(context);
  } else {
    conic_context *context = files_context();
    test_made(context);
    test_surfels(context);
    files_end(context);
  }
  return check_result();
}
