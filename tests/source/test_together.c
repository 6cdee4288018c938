/* Gaussians among surfaces: by closed forms, by the oracle, and to the bit by every way of drawing them. */
#include "conic/gaussian_gradient.h"
#include "conic/gaussian_judge.h"
#include "conic/loan.h"
#include "conic/shot.h"
#include "core/base/color.h"
#include "core/lanes/instruction_sets.h"
#include "gaussians/draw/surfaces_join.h"
#include "source/source_kind.h"
#include "source/surfaces_among.h"
#include "tests/support/files.h"

enum { SIDE = 48, PIXELS = SIDE * SIDE, MIDDLE = SIDE / 2 * SIDE + SIDE / 2 };

static const unsigned planes = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_NORMAL |
                               1u << CONIC_PLANE_COUNT | 1u << CONIC_PLANE_ID | 1u << CONIC_PLANE_TRANSPARENCY |
                               1u << CONIC_PLANE_MEDIAN_Z | 1u << CONIC_PLANE_INVERSE_Z | 1u << CONIC_PLANE_LAST;

/* Balls of one deviation along the z axis, whose colours are display values. */
static conic_gaussians balls(conic_context *context, size_t n, double first_z, double step, float opacity) {
  conic_gaussians set;
  CHECK_OK(conic_gaussians_allocate(context, n, 0, 0, &set));
  for (size_t i = 0; i < n; i++) {
    for (int axis = 0; axis < 3; axis++) {
      set.position[axis][i] = axis == 2 ? (float)(first_z + step * (double)i) : 0.0f;
      set.scale[axis][i] = 0.3f;
      set.sh[3 * i + (size_t)axis] = (float)((0.2 + 0.25 * axis - 0.5) / 0.28209479177387814);
    }
    for (int k = 0; k < 4; k++)
      set.rotation[k][i] = k == 0;
    set.opacity[i] = opacity;
  }
  return set;
}

/* A wide square at z + slope·x, grey as linear light. */
static conic_triangles wall(conic_context *context, double z, double slope, float grey) {
  static const uint32_t corners[2][3] = {{0, 2, 1}, {1, 2, 3}};
  conic_triangles set;
  CHECK_OK(conic_triangles_allocate(context, 2, 4, CONIC_TRIANGLES_COLORS, &set));
  memcpy(set.corners, corners, sizeof corners);
  for (size_t i = 0; i < 4; i++) {
    const float x = i & 1 ? 9.0f : -9.0f, y = i & 2 ? 9.0f : -9.0f;
    const float at[3] = {x, y, (float)(z + slope * (double)x)};
    for (int axis = 0; axis < 3; axis++) {
      set.position[axis][i] = at[axis];
      set.color[axis][i] = grey;
    }
  }
  return set;
}

static conic_source *open_scene(conic_context *context, const char *const *names, size_t n, const char *place) {
  conic_gaussian_options composited;
  conic_source_options options;
  conic_source *source;
  conic_gaussian_options_init(&composited);
  conic_source_options_init(&options);
  options.gaussians = &composited;
  options.as = CONIC_AS_AUTO;
  options.place = place;
  CHECK_OK(conic_source_open(context, names, n, &options, &source));
  return source;
}

static conic_source *open_both(conic_context *context, const char *const names[2], conic_gaussians *gaussians,
                               conic_triangles *set) {
  conic_take_back_loans(context);
  CHECK_OK(conic_lend(context, names[0], gaussians));
  CHECK_OK(conic_lend(context, names[1], set));
  return open_scene(context, names, 2, NULL);
}

static conic_shot shot_of(conic_gaussian_profile profile) {
  conic_shot shot;
  conic_shot_init(&shot);
  shot.camera = (conic_camera){.width = SIDE, .height = SIDE, .cx = 0.5 * SIDE, .cy = 0.5 * SIDE, .fx = 40, .fy = 40};
  for (int axis = 0; axis < 3; axis++)
    shot.camera.cam_from_world[axis][axis] = 1.0;
  shot.render.shading = CONIC_SHADE_NONE;
  shot.gaussians.profile = profile;
  shot.planes = planes;
  return shot;
}

static void light_from_beside(conic_shot *shot) {
  shot->render.shading = CONIC_SHADE_LAMBERT;
  shot->render.lighting.is_given = shot->render.lighting.n_lights = 1;
  shot->render.lighting.lights[0] =
      (conic_light){.frame = CONIC_LIGHT_WORLD, .direction = {-2, 0, -1}, .color = {1, 1, 1}};
}

static conic_image draw(conic_context *context, conic_source *source, const conic_shot *shot) {
  conic_image image;
  conic_renderer *renderer;
  CHECK_OK(conic_renderer_create(context, &renderer));
  CHECK_OK(conic_image_allocate(context, shot->camera.width, shot->camera.height, shot->planes, &image));
  CHECK_OK(conic_shot_draw(source, renderer, shot, &image, NULL));
  conic_renderer_destroy(renderer);
  return image;
}

static conic_image draw_surfaces(conic_context *context, conic_source *source, const conic_shot *shot, unsigned among) {
  conic_render_options render = shot->render;
  conic_image image;
  conic_renderer *renderer;
  conic_source_settle(source, &render);
  CHECK_OK(conic_renderer_create(context, &renderer));
  CHECK_OK(conic_source_draw_surfaces(source, renderer, &shot->camera, &render, &shot->view, among, &image));
  conic_renderer_destroy(renderer);
  return image;
}

static const float *pixel_of(const conic_image *image, size_t i) {
  return (const float *)image->planes[CONIC_PLANE_RGBA] + 4 * i;
}

static int is_same(const conic_image *a, const conic_image *b) {
  int same = 1;
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (a->planes[i] && i != CONIC_PLANE_POSITION)
      same &= memcmp(a->planes[i], b->planes[i],
                     (size_t)PIXELS * 4 * (size_t)conic_plane_describe((conic_plane)i)->n_channels) == 0;
  return same;
}

/* A ball at z = 2 of opacity 0.8 with a wall behind it, before it, and through its middle. */
static void check_walls(conic_context *context, const char *const names[2]) {
  const double wall_z[] = {3.0, 1.0, 2.0, 2.0 - 1e-3, 2.0 + 1e-3};
  const int hides[] = {0, 1, 0, 1, 0};
  const float grey = 0.18f;
  const double shown = conic_srgb_encode(0.18);
  for (size_t k = 0; k < sizeof wall_z / sizeof *wall_z; k++) {
    conic_triangles set = wall(context, wall_z[k], 0.0, grey);
    CHECK_OK(conic_lend(context, names[1], &set));
    conic_source *source = open_scene(context, names, 2, NULL);
    const conic_shot shot = shot_of(CONIC_PROFILE_EXACT);
    conic_image image = draw(context, source, &shot);
    /* The pixel's centre is half a pixel off the axis: q = |c|²/|g|² there. */
    const double off = 0.5 / 40.0, square = 2.0 * off * off, q = 4.0 * square / (1.0 + square) / 0.09;
    const double alpha = hides[k] ? 0.0 : 0.8 * exp(-0.5 * q);
    for (int c = 0; c < 3; c++)
      CHECK_NEAR(pixel_of(&image, MIDDLE)[c], alpha * (0.2 + 0.25 * c) + (1.0 - alpha) * shown, 1e-5);
    CHECK(pixel_of(&image, MIDDLE)[3] == 1.0f && image.is_display);
    CHECK_NEAR(((const float *)image.planes[CONIC_PLANE_Z])[MIDDLE],
               alpha * 2.0 / (1.0 + square) + (1.0 - alpha) * wall_z[k], 1e-5);
    CHECK((((const uint32_t *)image.planes[CONIC_PLANE_ID])[MIDDLE] > 0u) == hides[k]);
    CHECK(((const uint32_t *)image.planes[CONIC_PLANE_LAST])[MIDDLE] >= 1u);
    CHECK(((const uint32_t *)image.planes[CONIC_PLANE_COUNT])[MIDDLE] == (hides[k] ? 1u : 2u));
    CHECK(conic_source_input_of(source, 0) == 0 && conic_source_input_of(source, 1) == 1);
    conic_image_release(context, &image);
    conic_source_close(source);
    conic_triangles_release(context, &set);
  }
}

/* A pane that stops half of the light, before the ball: what is behind it shows in the mean of samples. */
static void check_pane(conic_context *context, const char *ball) {
  char material[160], pane[160];
  snprintf(material, sizeof material, "%s", files_write("pane.mtl", "newmtl pane\nKd 0.18 0.18 0.18\nd 0.5\n"));
  snprintf(
      pane, sizeof pane, "%s",
      files_write("pane.obj", "mtllib pane.mtl\nusemtl pane\nv -9 -9 1\nv 9 -9 1\nv 9 9 1\nv -9 9 1\nf 1 4 3 2\n"));
  const char *const names[] = {ball, pane};
  conic_image image;
  conic_renderer *renderer;
  conic_shot shot = shot_of(CONIC_PROFILE_EXACT);
  conic_source *source = open_scene(context, names, 2, NULL);
  shot.view.transparency = CONIC_TRANSPARENCY_LAYERS;
  shot.planes = 1u << CONIC_PLANE_RGBA;
  CHECK_OK(conic_renderer_create(context, &renderer));
  CHECK_OK(conic_image_allocate(context, SIDE, SIDE, shot.planes, &image));
  CHECK(conic_shot_draw(source, renderer, &shot, &image, NULL) == CONIC_ERROR_ARGUMENT); /* no samples */
  shot.n_samples = 64;
  CHECK_OK(conic_shot_draw(source, renderer, &shot, &image, NULL));
  for (int c = 0; c < 3; c++)
    CHECK_NEAR(pixel_of(&image, MIDDLE)[c], 0.5 * conic_srgb_encode(0.18) + 0.5 * 0.8 * (0.2 + 0.25 * c), 0.02);
  CHECK_NEAR(pixel_of(&image, MIDDLE)[3], 0.9, 0.02);
  conic_image_release(context, &image);
  conic_renderer_destroy(renderer);
  conic_source_close(source);
  CHECK(unlink(pane) == 0 && unlink(material) == 0);
}

/* All profiles, and several samples a pixel, as the oracle has them; and the same bits by every instruction set. */
static void check_oracle(conic_context *context, conic_source *source, conic_gaussian_profile profile, int samples) {
  conic_shot shot = shot_of(profile);
  conic_gaussian_judging judging;
  conic_gaussian_verdict verdict;
  shot.view.samples = samples;
  conic_image image = draw(context, source, &shot), surfaces = draw_surfaces(context, source, &shot, planes);
  const conic_gaussians *gaussians = conic_source_gaussians(source);
  const conic_gaussian_surfaces given = {&surfaces, 0, (uint32_t)gaussians->count};
  conic_gaussian_judging_init(&judging);
  judging.samples = samples;
  judging.surfaces = &given;
  CHECK_OK(conic_gaussian_judge(context, gaussians, &shot.camera, &shot.gaussians, &judging, &image, NULL, &verdict));
  printf("%-14s %d x %d: %zu equal, %zu rounded, %zu explained, %zu wrong\n", conic_gaussian_profile_name(profile),
         samples, samples, verdict.pixels[CONIC_PIXEL_EQUAL], verdict.pixels[CONIC_PIXEL_ROUNDED],
         verdict.pixels[CONIC_PIXEL_EXPLAINED], verdict.pixels[CONIC_PIXEL_WRONG]);
  CHECK(verdict.pass && verdict.judged_pixels == PIXELS);
  ((float *)surfaces.planes[CONIC_PLANE_Z])[0] *= 0.5f; /* which is seen */
  ((float *)image.planes[CONIC_PLANE_RGBA])[4 * MIDDLE] += 0.01f;
  CHECK_OK(conic_gaussian_judge(context, gaussians, &shot.camera, &shot.gaussians, &judging, &image, NULL, &verdict));
  CHECK(verdict.pixels[CONIC_PIXEL_WRONG] == 2);
  ((float *)image.planes[CONIC_PLANE_RGBA])[4 * MIDDLE] -= 0.01f;
  for (int isa = CONIC_ISA_SCALAR; isa < CONIC_N_ISAS; isa++)
    if (conic_isa_is_here((conic_isa)isa)) {
      shot.render.isa = (conic_isa)isa;
      conic_image other = draw(context, source, &shot);
      memcpy((float *)other.planes[CONIC_PLANE_RGBA] + 4 * MIDDLE, pixel_of(&image, MIDDLE), sizeof(float));
      CHECK(is_same(&image, &other));
      conic_image_release(context, &other);
    }
  shot.planes = 1u << CONIC_PLANE_RGBA; /* alone it has the same bits, too */
  conic_image alone = draw(context, source, &shot);
  CHECK(memcmp(alone.planes[CONIC_PLANE_RGBA], image.planes[CONIC_PLANE_RGBA], sizeof(float) * 4 * MIDDLE) == 0);
  conic_image_release(context, &alone);
  conic_image_release(context, &image);
  conic_image_release(context, &surfaces);
}

/* A slope through a row of balls; and leaning discs, one of which comes before a wall behind the centres of others
 * whose part there is behind it. */
static void check_profiles(conic_context *context, const char *const names[2], int are_leaning) {
  conic_gaussians row = are_leaning ? balls(context, 9, 1.8, 0.0, 0.95f) : balls(context, 7, 1.2, 0.3, 0.6f);
  conic_triangles set = wall(context, 2.0, are_leaning ? 0.0 : 0.4, 0.5f);
  for (size_t i = 0; are_leaning && i < 8; i++) {
    row.position[0][i] = -0.3f;
    row.rotation[0][i] = 0.9063f;
    row.rotation[2][i] = 0.4226f;
    row.scale[0][i] = row.scale[1][i] = 1.0f;
  }
  if (are_leaning)
    row.position[2][8] = 1.95f;
  conic_source *source = open_both(context, names, &row, &set);
  for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++)
    if (!are_leaning || profile == CONIC_PROFILE_2DGS_2024)
      check_oracle(context, source, (conic_gaussian_profile)profile, profile == CONIC_PROFILE_EXACT ? 2 : 1);
  conic_source_close(source);
  conic_triangles_release(context, &set);
  conic_gaussians_release(context, &row);
}

/* Two scenes are one with all their Gaussians; a place is as if the file had it. */
static void check_scenes(conic_context *context) {
  const char *const names[] = {"memory:gaussians:a", "memory:gaussians:b"}, *const all_names[] = {"memory:gaussians:c"};
  conic_gaussians a = balls(context, 3, 1.5, 0.5, 0.5f), b = balls(context, 4, 1.75, 0.5, 0.5f),
                  all = balls(context, 7, 0.0, 0.0, 0.5f), moved = balls(context, 3, 1.5, 0.5, 0.5f);
  const conic_shot shot = shot_of(CONIC_PROFILE_GSPLAT_1_6);
  memcpy(b.frame, "rub", 4); /* which is turned, y and z, into the first one's */
  for (size_t i = 0; i < 4; i++)
    b.position[2][i] *= -1.0f;
  for (size_t i = 0; i < 3; i++)
    moved.position[2][i] = a.position[2][i] - 0.25f;
  for (size_t i = 0; i < 7; i++)
    all.position[2][i] = i < 3 ? a.position[2][i] : -b.position[2][i - 3];
  conic_take_back_loans(context);
  CHECK_OK(conic_lend(context, names[0], &a));
  CHECK_OK(conic_lend(context, names[1], &b));
  CHECK_OK(conic_lend(context, all_names[0], &all));
  CHECK_OK(conic_lend(context, "memory:gaussians:moved", &moved));
  conic_source *both = open_scene(context, names, 2, NULL), *one = open_scene(context, all_names, 1, NULL);
  conic_image of_both = draw(context, both, &shot), of_one = draw(context, one, &shot);
  CHECK(is_same(&of_both, &of_one));
  CHECK(conic_source_input_of(both, 2) == 0 && conic_source_input_of(both, 3) == 1);
  conic_source_close(both);
  conic_image_release(context, &of_both);
  const char *const as_moved[] = {"memory:gaussians:moved", "memory:gaussians:b"};
  both = open_scene(context, names, 2, "0:0,0,-0.25");
  conic_source *other = open_scene(context, as_moved, 2, NULL);
  of_both = draw(context, both, &shot);
  conic_image of_other = draw(context, other, &shot);
  CHECK(is_same(&of_both, &of_other));
  conic_source *none;
  conic_source_options options;
  conic_source_options_init(&options);
  options.gaussians = &shot.gaussians;
  const char *const wrong[] = {"2:0,0,1", "0:1,2",     "0:1,2,3;0:1,2,3",           "0:1,0,0,0,0,2,0,0,0,0,1,0",
                               "x",       "0:1,2,nan", "0:-1,0,0,0,0,1,0,0,0,0,1,0"};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    options.place = wrong[i];
    CHECK(conic_source_open(context, names, 2, &options, &none) == CONIC_ERROR_ARGUMENT);
  }
  conic_source_close(both);
  conic_source_close(one);
  conic_source_close(other);
  conic_image_release(context, &of_both);
  conic_image_release(context, &of_one);
  conic_image_release(context, &of_other);
  conic_gaussians_release(context, &a);
  conic_gaussians_release(context, &b);
  conic_gaussians_release(context, &all);
  conic_gaussians_release(context, &moved);
}

/* Light from beside the eye comes through a ball of opacity 0.8 to the wall behind it. */
static void check_shadow(conic_context *context, const char *const names[2]) {
  conic_gaussians ball = balls(context, 1, 2.0, 0.0, 0.8f);
  conic_triangles set = wall(context, 3.0, 0.0, 0.5f);
  ball.position[0][0] = -2.0f;
  conic_source *source = open_both(context, names, &ball, &set);
  conic_shot shot = shot_of(CONIC_PROFILE_EXACT);
  light_from_beside(&shot);
  conic_image plain = draw(context, source, &shot);
  shot.light.has_shadows = 1;
  conic_image shadowed = draw(context, source, &shot);
  for (size_t k = 0; k < 24;
       k += 4) { /* the ray from the wall to the light, and how far it is from the ball's middle */
    const double x = 3.0 * ((double)k + 0.5) / 40.0, y = 3.0 * 0.5 / 40.0, q = (x * x + y * y - 0.8 * x * x) / 0.09;
    const double part = conic_srgb_decode((double)pixel_of(&shadowed, MIDDLE + k)[0]) /
                        conic_srgb_decode((double)pixel_of(&plain, MIDDLE + k)[0]);
    CHECK_NEAR(part, 1.0 - 0.8 * exp(-0.5 * q), 0.006);
  }
  shot.catchers = 2; /* the wall, of which the shadow is left */
  shot.planes = 1u << CONIC_PLANE_RGBA;
  conic_image caught = draw(context, source, &shot);
  const double part = conic_srgb_decode((double)pixel_of(&shadowed, MIDDLE)[0]) /
                      conic_srgb_decode((double)pixel_of(&plain, MIDDLE)[0]);
  CHECK_NEAR(pixel_of(&caught, MIDDLE)[3], 1.0 - part, 1e-5);
  CHECK(pixel_of(&caught, MIDDLE)[0] == 0.0f);
  shot.catchers = 0;
  shot.holdouts = 2;
  conic_image held = draw(context, source, &shot);
  CHECK(pixel_of(&held, MIDDLE)[3] == 0.0f && pixel_of(&held, MIDDLE)[0] == 0.0f);
  conic_image_release(context, &caught);
  conic_image_release(context, &held);
  conic_image_release(context, &plain);
  conic_image_release(context, &shadowed);
  conic_source_close(source);
  conic_triangles_release(context, &set);
  conic_gaussians_release(context, &ball);
}

/* What moves is where --place would have it, shadows and all; and it comes back. */
static void check_motion(conic_context *context, const char *const names[2]) {
  static const char *const places[] = {"0:0.25,0,0.5", "1:0,0,0.5", "0:0.25,0,0.5;1:0,0,0.5"};
  conic_gaussians ball = balls(context, 3, 1.5, 0.5, 0.8f);
  conic_triangles set = wall(context, 3.0, 0.1, 0.5f);
  conic_shot shot = shot_of(CONIC_PROFILE_GSPLAT_1_6);
  conic_source *source = open_both(context, names, &ball, &set);
  shot.light.has_shadows = 1;
  conic_image at_rest = draw(context, source, &shot);
  for (size_t i = 0; i < 3; i++) {
    conic_source *placed = open_scene(context, names, 2, places[i]);
    conic_source_pose poses[2];
    double minimum[3], maximum[3];
    for (size_t k = 0; k < 2; k++) {
      conic_source_pose_init(&poses[k]);
      if (k == i || i == 2) {
        poses[k].world_from_rest[0][3] = k ? 0.0 : 0.25;
        poses[k].world_from_rest[2][3] = 0.5;
      }
    }
    CHECK_OK(conic_source_move(source, poses, 2));
    conic_image moved = draw(context, source, &shot), right = draw(context, placed, &shot);
    CHECK(is_same(&moved, &right) && !is_same(&moved, &at_rest));
    conic_source_box(source, minimum, maximum);
    CHECK(memcmp(minimum, conic_source_measure(placed)->minimum, sizeof minimum) == 0 &&
          memcmp(maximum, conic_source_measure(placed)->maximum, sizeof maximum) == 0);
    conic_image_release(context, &moved);
    conic_image_release(context, &right);
    conic_source_close(placed);
    poses[0].world_from_rest[0][0] = 2.0; /* which stretches */
    CHECK(conic_source_move(source, poses, 2) == CONIC_ERROR_UNSUPPORTED);
    CHECK(conic_source_move(source, poses, 1) == CONIC_ERROR_ARGUMENT);
  }
  CHECK_OK(conic_source_move(source, NULL, 0));
  conic_image again = draw(context, source, &shot);
  CHECK(is_same(&again, &at_rest));
  conic_image_release(context, &again);
  conic_image_release(context, &at_rest);
  conic_source_close(source);
  conic_triangles_release(context, &set);
  conic_gaussians_release(context, &ball);
}

/* What surfaces alone have: light and colour come through what is left, and from Gaussians none is hidden. */
static void check_own_planes(conic_context *context, const char *const names[2]) {
  float rgb[3] = {0, 0, 0}, T = 0.25f;
  conic_image surfaces;
  conic_gaussian_planes joined = {.width = 1, .height = 1, .rgb = rgb, .transparency = &T};
  CHECK_OK(conic_image_allocate(context, 1, 1, CONIC_SURFACES_PLANES | 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z,
                                &surfaces));
  float *albedo = surfaces.planes[CONIC_PLANE_ALBEDO], *weight = surfaces.planes[CONIC_PLANE_WEIGHT],
        *ao = surfaces.planes[CONIC_PLANE_AO], *shadow = surfaces.planes[CONIC_PLANE_SHADOW];
  albedo[2] = ao[0] = 0.5f;
  weight[0] = 2.0f;
  conic_surfaces_join(context, &surfaces, NULL, 1, 1, &joined);
  CHECK(albedo[2] == 0.125f && albedo[0] == 0.0f && weight[0] == 0.5f && ao[0] == 0.875f && shadow[0] == 0.75f);
  conic_image_release(context, &surfaces);
  /* One ball before a wall, which has the shadow of another one. */
  conic_gaussians pair = balls(context, 2, 2.0, 0.0, 0.8f);
  conic_triangles set = wall(context, 3.0, 0.0, 0.5f);
  pair.position[0][0] = -2.0f;
  conic_source *source = open_both(context, names, &pair, &set);
  conic_shot shot = shot_of(CONIC_PROFILE_EXACT);
  light_from_beside(&shot);
  shot.light.has_shadows = 1;
  shot.light.n_directions = 4;
  shot.planes = CONIC_SURFACES_PLANES | 1u << CONIC_PLANE_TRANSPARENCY;
  for (int samples = 1; samples < 3; samples++) {
    shot.view.samples = samples;
    conic_image image = draw(context, source, &shot);
    double light = 0.0, left = 0.0; /* means over the pixel's samples */
    for (int i = 0; i < samples * samples; i++) {
      const double part = 0.5 / (double)samples, x = part * (1 + 2 * (i % samples)) / 40.0,
                   y = part * (1 + 2 * (i / samples)) / 40.0, square = x * x + y * y;
      const double hidden = 0.8 * exp(-4.5 * (square - 0.8 * x * x) / 0.09),
                   part_left = 1.0 - 0.8 * exp(-2.0 * square / (1.0 + square) / 0.09);
      light += (1.0 - part_left * hidden) / (double)(samples * samples);
      left += part_left / (double)(samples * samples);
    }
    CHECK_NEAR(((const float *)image.planes[CONIC_PLANE_SHADOW])[MIDDLE], light, 0.006);
    CHECK_NEAR(((const float *)image.planes[CONIC_PLANE_ALBEDO])[3 * MIDDLE], 0.5 * left, 1e-5);
    CHECK_NEAR(((const float *)image.planes[CONIC_PLANE_WEIGHT])[MIDDLE], left, 1e-5);
    const float share = ((const float *)image.planes[CONIC_PLANE_AO])[MIDDLE];
    CHECK(share >= 1.0 - left - 1e-3 && share <= 1.0f);
    conic_image_release(context, &image);
  }
  conic_source_close(source);
  conic_triangles_release(context, &set);
  conic_gaussians_release(context, &pair);
}

/* A wall through the place where a ball's response is greatest may be before it or behind. */
static void check_doubt(conic_context *context, const char *const names[2]) {
  const double off = 0.5 / 40.0, wall_z[] = {2.0 / (1.0 + 2.0 * off * off), 3.0};
  conic_gaussians ball = balls(context, 1, 2.0, 0.0, 0.8f);
  for (size_t k = 0; k < 2; k++) {
    conic_triangles set = wall(context, wall_z[k], 0.0, 0.5f);
    conic_source *source = open_both(context, names, &ball, &set);
    conic_shot shot = shot_of(CONIC_PROFILE_EXACT);
    shot.planes = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_DOUBT;
    conic_image image = draw(context, source, &shot);
    CHECK((((const uint32_t *)image.planes[CONIC_PLANE_DOUBT])[MIDDLE] > 0) == (k == 0));
    static double alpha[PIXELS];
    conic_gradient_options how;
    conic_gaussian_gradient g;
    alpha[MIDDLE] = 1.0;
    conic_image surfaces = draw_surfaces(context, source, &shot, 0);
    conic_gradient_options_init(&how);
    how.surfaces = &(conic_gaussian_surfaces){.image = &surfaces};
    const conic_gaussian_weights weights = {.width = SIDE, .height = SIDE, .alpha = alpha};
    CHECK_OK(conic_gaussian_gradient_find(context, &ball, &shot.camera, &shot.gaussians, &weights, &how, &g));
    CHECK((g.doubtful[CONIC_DOUBT_SURFACE] > 0) == (k == 0) && g.loss == 1.0);
    conic_gaussian_gradient_release(context, &g);
    conic_image_release(context, &surfaces);
    conic_image_release(context, &image);
    conic_source_close(source);
    conic_triangles_release(context, &set);
  }
  conic_gaussians_release(context, &ball);
}

/* Σ W·C of a picture, drawn in float. */
static double loss_of(conic_context *context, conic_source *source, const conic_shot *shot, const double *weights) {
  conic_image image = draw(context, source, shot);
  double sum = 0.0;
  for (size_t i = 0; i < PIXELS; i++) {
    for (size_t c = 0; c < 3; c++)
      sum += weights[5 * i + c] * (double)pixel_of(&image, i)[c];
    sum += weights[5 * i + 3] * (double)pixel_of(&image, i)[3];
    sum += weights[5 * i + 4] * (double)((const float *)image.planes[CONIC_PLANE_Z])[i];
  }
  conic_image_release(context, &image);
  return sum;
}

/* The derivative among surfaces is what pictures differ by. */
static void check_gradient(conic_context *context, const char *const names[2], conic_gaussian_profile profile) {
  static double weights[5 * PIXELS], rgb[3 * PIXELS], alpha[PIXELS], z[PIXELS];
  conic_gaussians row = balls(context, 7, 1.2, 0.3, 0.6f);
  conic_triangles set = wall(context, 2.0, 0.4, 0.5f);
  for (size_t i = 0; i < 2; i++) /* where there is no wall */
    set.position[1][i] = 0.1f;
  conic_source *source = open_both(context, names, &row, &set);
  conic_shot shot = shot_of(profile);
  for (size_t i = 0; i < PIXELS; i++) {
    for (size_t c = 0; c < 5; c++)
      weights[5 * i + c] = (double)(i * (7 + 4 * c) % 11) / 11.0 - 0.3;
    memcpy(rgb + 3 * i, weights + 5 * i, 3 * sizeof *rgb);
    alpha[i] = weights[5 * i + 3];
    z[i] = weights[5 * i + 4];
  }
  conic_image surfaces = draw_surfaces(context, source, &shot, 0);
  const conic_gaussian_surfaces given = {&surfaces, 0, 7};
  const conic_gaussian_weights w = {.width = SIDE, .height = SIDE, .rgb = rgb, .alpha = alpha, .z = z};
  conic_gradient_options how;
  conic_gaussian_gradient g;
  conic_gradient_options_init(&how);
  how.surfaces = &given;
  CHECK_OK(conic_gaussian_gradient_find(context, &row, &shot.camera, &shot.gaussians, &w, &how, &g));
  CHECK_NEAR(loss_of(context, source, &shot, weights), g.loss, 2e-3);
  /* Where a pixel is gained or lost on the way, the two sides differ by much: nothing is known then. */
  const float step = 1.0f / 1024.0f;
  size_t n_smooth = 0;
  for (size_t i = 0; i < 14; i++) {
    float *const number = i < 7 ? &row.opacity[i] : &row.sh[3 * (i - 7) + 1];
    const double found = i < 7 ? g.opacity[i] : g.sh[3 * (i - 7) + 1];
    const float at = *number;
    double losses[3];
    for (int k = 0; k < 3; k++) {
      *number = at + (float)(k - 1) * step;
      conic_source_close(source);
      source = open_scene(context, names, 2, NULL);
      losses[k] = loss_of(context, source, &shot, weights);
    }
    *number = at;
    if (fabs(losses[2] - 2.0 * losses[1] + losses[0]) > 0.05 * (double)step)
      continue;
    CHECK_NEAR((losses[2] - losses[0]) / (2.0 * (double)step), found, 0.02);
    n_smooth++;
  }
  CHECK(n_smooth >= 12);
  how.surfaces = &(conic_gaussian_surfaces){.image = &(conic_image){.width = 3, .height = 3}};
  conic_gaussian_gradient_release(context, &g);
  CHECK(conic_gaussian_gradient_find(context, &row, &shot.camera, &shot.gaussians, &w, &how, &g) ==
        CONIC_ERROR_ARGUMENT);
  conic_image_release(context, &surfaces);
  conic_source_close(source);
  conic_triangles_release(context, &set);
  conic_gaussians_release(context, &row);
}

/* Windows have the bits of the whole, and their statistics add up to its. */
static void check_windows(conic_context *context, const char *const names[2]) {
  conic_gaussians row = balls(context, 7, 1.2, 0.3, 0.6f);
  conic_triangles set = wall(context, 2.0, 0.4, 0.5f);
  conic_source *source = open_both(context, names, &row, &set);
  conic_shot shot = shot_of(CONIC_PROFILE_INRIA_2023);
  conic_renderer *renderer;
  shot.camera.width = 200;
  shot.camera.cx = 100.0;
  shot.render.has_background = 1;
  shot.planes = (planes | CONIC_SURFACES_PLANES) & ~(1u << CONIC_PLANE_AO | 1u << CONIC_PLANE_SHADOW);
  CHECK_OK(conic_renderer_create(context, &renderer));
  for (int samples = 1; samples < 3; samples++) {
    conic_source_windows windows;
    conic_render_statistics statistics;
    size_t n_wrong = 0;
    shot.view.samples = samples;
    shot.render.tile = samples == 1 ? 16 : 64;
    conic_image whole = draw(context, source, &shot);
    CHECK_OK(
        conic_source_windows_begin(source, renderer, &shot.camera, &shot.render, &shot.view, shot.planes, &windows));
    CHECK(windows.step % 16 == 0 && windows.step < 200 && !windows.is_summed);
    for (int x = 0; x < 200; x += windows.step) {
      const conic_window window = {x, x + windows.step < 200 ? x + windows.step : 200, 0, SIDE};
      conic_image part;
      CHECK_OK(conic_image_allocate(context, window.x_end - x, SIDE, shot.planes, &part));
      CHECK_OK(conic_source_windows_draw(&windows, &window, &part, &statistics));
      CHECK(part.is_display && statistics.splats_in == 7 && statistics.triangles_in == 2);
      for (int i = 0; i < CONIC_N_PLANES; i++)
        for (size_t y = 0; part.planes[i] && y < SIDE; y++) {
          const size_t n = 4 * (size_t)conic_plane_describe((conic_plane)i)->n_channels;
          n_wrong += memcmp((const char *)part.planes[i] + n * y * (size_t)part.width,
                            (const char *)whole.planes[i] + n * (y * 200 + (size_t)x), n * (size_t)part.width) != 0;
        }
      conic_image_release(context, &part);
    }
    CHECK(n_wrong == 0);
    CHECK_OK(conic_source_windows_count(&windows, &statistics));
    conic_source_windows_end(&windows);
    conic_image_release(context, &whole);
  }
  conic_renderer_destroy(renderer);
  conic_source_close(source);
  conic_triangles_release(context, &set);
  conic_gaussians_release(context, &row);
}

int main(void) {
  const char *const names[] = {"memory:gaussians:ball", "memory:triangles:wall"};
  folder_make(files_folder);
  conic_context *context = check_context(2);
  conic_gaussians ball = balls(context, 1, 2.0, 0.0, 0.8f);
  CHECK_OK(conic_lend(context, names[0], &ball));
  check_walls(context, names);
  check_pane(context, names[0]);
  check_profiles(context, names, 0);
  check_profiles(context, names, 1);
  check_scenes(context);
  check_shadow(context, names);
  check_motion(context, names);
  check_own_planes(context, names);
  check_doubt(context, names);
  check_gradient(context, names, CONIC_PROFILE_EXACT);
  check_gradient(context, names, CONIC_PROFILE_GSPLAT_1_6);
  check_windows(context, names);
  conic_gaussians_release(context, &ball);
  files_end(context);
  return check_result();
}
