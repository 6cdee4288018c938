/* Pictures of Gaussians with surfaces among them: pixels are explained, mistakes are named, and shares add up. */
#include "conic/diagnosis.h"
#include "core/base/color.h"
#include "tests/support/check.h"

enum { SIDE = 40, PIXELS = SIDE * SIDE, N_BALLS = 60, MOST_FOUND = 4 };

static const float linear_grey = 0.2f, wall_z = 2.0f;

/* Balls in a row of depths, half of them before z = 2, all over the picture. */
static conic_gaussians make_balls(conic_context *context) {
  conic_gaussians set;
  CHECK_OK(conic_gaussians_allocate(context, N_BALLS, 0, 0, &set));
  for (size_t i = 0; i < N_BALLS; i++) {
    set.position[0][i] = 0.13f * (float)(i * 7 % 11) - 0.65f;
    set.position[1][i] = 0.13f * (float)(i * 5 % 13) - 0.78f;
    set.position[2][i] = 1.51f + (float)i / N_BALLS;
    for (size_t k = 0; k < 3; k++) {
      set.scale[k][i] = 0.12f;
      set.sh[3 * i + k] = (float)((i * (k + 3)) % 7) * 0.25f - 0.75f;
    }
    for (int k = 0; k < 4; k++)
      set.rotation[k][i] = k == 0;
    set.opacity[i] = 0.6f;
  }
  return set;
}

/* A wall at z = 2, but for the columns on the left. */
static conic_image make_wall(conic_context *context) {
  conic_image image;
  CHECK_OK(conic_image_allocate(context, SIDE, SIDE,
                                1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_ID, &image));
  for (size_t i = 0; i < PIXELS; i++) {
    const int is_there = i % SIDE >= SIDE / 4;
    for (size_t c = 0; c < 4; c++)
      ((float *)image.planes[CONIC_PLANE_RGBA])[4 * i + c] = !is_there ? 0.0f : c < 3 ? linear_grey : 1.0f;
    ((float *)image.planes[CONIC_PLANE_Z])[i] = is_there ? wall_z : 0.0f;
    ((uint32_t *)image.planes[CONIC_PLANE_ID])[i] = is_there ? (uint32_t)(i / PIXELS * 2) : CONIC_NO_ID;
  }
  return image;
}

static conic_camera make_camera(void) {
  conic_camera camera = {.width = SIDE, .height = SIDE, .cx = 0.5 * SIDE, .cy = 0.5 * SIDE, .fx = 40, .fy = 40};
  for (int axis = 0; axis < 3; axis++)
    camera.cam_from_world[axis][axis] = 1.0;
  return camera;
}

/* The picture of somebody to whom Gaussians end at this depth, and surfaces have that colour. */
static conic_image draw_by(conic_context *context, const conic_gaussians *balls, const conic_image *wall,
                           float hiding_z, float shown) {
  const conic_camera camera = make_camera();
  conic_gaussian_options options;
  conic_image image;
  static float rgb[3 * PIXELS], T[PIXELS], z[PIXELS];
  conic_gaussian_planes planes = {.width = SIDE, .height = SIDE, .rgb = rgb, .transparency = T, .surface_z = z};
  const float *of_wall = wall->planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < PIXELS; i++)
    z[i] = of_wall[4 * i + 3] > 0.0f ? hiding_z : 0.0f;
  conic_gaussian_options_init(&options);
  options.profile = CONIC_PROFILE_GSPLAT_1_6;
  CHECK_OK(conic_gaussians_render(context, balls, &camera, &options, &planes, NULL));
  CHECK_OK(conic_image_allocate(context, SIDE, SIDE, 1u << CONIC_PLANE_RGBA, &image));
  float *rgba = image.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < PIXELS; i++) {
    const float A = of_wall[4 * i + 3];
    for (size_t c = 0; c < 3; c++)
      rgba[4 * i + c] = rgb[3 * i + c] + T[i] * A * shown;
    rgba[4 * i + 3] = 1.0f - T[i] * (1.0f - A);
  }
  return image;
}

/* Judges a picture; a wrong one has this name. */
static void check_named(conic_context *context, const conic_gaussians *balls, const conic_image *wall, float hiding_z,
                        float shown, const char *name) {
  static uint8_t classes[PIXELS];
  static float ranges[PIXELS];
  const conic_gaussian_surfaces surfaces = {wall, 0, N_BALLS};
  const conic_camera camera = make_camera();
  conic_image image = draw_by(context, balls, wall, hiding_z, shown);
  conic_gaussian_options options;
  conic_gaussian_judging judging;
  conic_gaussian_verdict verdict;
  conic_diagnosis found[MOST_FOUND];
  int n = 0;
  conic_gaussian_options_init(&options);
  conic_gaussian_judging_init(&judging);
  options.profile = CONIC_PROFILE_GSPLAT_1_6;
  judging.surfaces = &surfaces;
  judging.ranges = ranges;
  CHECK_OK(conic_gaussian_judge(context, balls, &camera, &options, &judging, &image, classes, &verdict));
  CHECK(verdict.pass == !name);
  CHECK_OK(
      conic_gaussian_diagnose(context, balls, &camera, &options, &judging, &image, classes, found, MOST_FOUND, &n));
  printf("%s: %zu wrong, %s\n", name ? name : "right", verdict.pixels[CONIC_PIXEL_WRONG], n ? found[0].name : "-");
  CHECK(name ? n > 0 && !found[0].is_nearest && strcmp(found[0].name, name) == 0 : n == 0);
  conic_image_release(context, &image);
}

/* What a pixel of the wall is of, and one beside it. */
static void check_listing(conic_context *context, const conic_gaussians *balls, const conic_image *wall) {
  const conic_gaussian_surfaces surfaces = {wall, 0, N_BALLS};
  const conic_camera camera = make_camera();
  conic_gaussian_options options;
  conic_gaussian_listing listing;
  conic_gaussian_options_init(&options);
  options.profile = CONIC_PROFILE_GSPLAT_1_6;
  for (int x = 2; x < SIDE; x += SIDE / 2) {
    double weight = 0.0;
    size_t n_behind = 0;
    CHECK_OK(conic_gaussian_explain(context, balls, &camera, &options, NULL, &surfaces, x, 20, &listing));
    for (size_t i = 0; i < listing.n; i++) {
      const conic_gaussian_entry *e = &listing.entries[i];
      CHECK(e->part == CONIC_PART_FAINT || e->part == CONIC_PART_OUTSIDE ||
            (e->part == CONIC_PART_BEHIND) == (listing.has_surface && e->z >= (double)wall_z));
      n_behind += e->part == CONIC_PART_BEHIND;
      weight += e->weight;
    }
    CHECK(listing.has_surface == (x >= SIDE / 4) && (n_behind > 0) == listing.has_surface);
    if (listing.has_surface) {
      CHECK_NEAR(weight + listing.surface_weight, 1.0, 1e-12);
      CHECK_NEAR(listing.surface_color[0], conic_srgb_encode((double)linear_grey), 1e-7);
      CHECK(listing.surface_z == (double)wall_z && listing.surface_id == N_BALLS);
    }
    conic_gaussian_listing_release(context, &listing);
  }
  CHECK(conic_gaussian_explain(context, balls, &camera, &options, NULL,
                               &(conic_gaussian_surfaces){&(conic_image){.width = 1}, 0, 0}, 1, 1,
                               &listing) == CONIC_ERROR_ARGUMENT);
}

static size_t name_by_parity(const void *cookie, uint32_t id) {
  const uint32_t *n_balls = cookie;
  return id >= *n_balls ? 2 : id % 2;
}

/* Even and odd balls, and the wall, have the light between them. */
static void check_shares(conic_context *context, const conic_gaussians *balls, const conic_image *wall) {
  static float shares[3 * PIXELS], coarse[3 * PIXELS / 4];
  const uint32_t n_balls = N_BALLS;
  const conic_camera camera = make_camera();
  conic_gaussian_options options;
  conic_image image = draw_by(context, balls, wall, wall_z, 0.0f);
  conic_gaussian_options_init(&options);
  options.profile = CONIC_PROFILE_GSPLAT_1_6;
  CHECK_OK(
      conic_gaussians_find_shares(context, balls, &camera, &options, wall, 1, 3, name_by_parity, &n_balls, shares));
  CHECK_OK(
      conic_gaussians_find_shares(context, balls, &camera, &options, wall, 2, 3, name_by_parity, &n_balls, coarse));
  const float *rgba = image.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < PIXELS; i++) {
    const float *s = shares + 3 * i;
    CHECK_NEAR((double)(s[0] + s[1] + s[2]), (double)rgba[4 * i + 3], 1e-6);
    CHECK((s[2] > 0.0f) == (i % SIDE >= SIDE / 4) && s[0] >= 0.0f && s[1] >= 0.0f);
  }
  for (size_t i = 0; i < PIXELS / 4; i++)
    for (size_t k = 0; k < 3; k++) {
      const float *s = shares + 3 * (2 * (i / (SIDE / 2)) * SIDE + 2 * (i % (SIDE / 2))) + k;
      CHECK_NEAR((double)coarse[3 * i + k],
                 0.25 * (double)(s[0] + s[3] + s[(size_t)3 * SIDE] + s[(size_t)3 * SIDE + 3]), 1e-6);
    }
  CHECK(conic_gaussians_find_shares(context, balls, &camera, &options, wall, 3, 3, name_by_parity, &n_balls, shares) ==
        CONIC_ERROR_ARGUMENT);
  conic_image_release(context, &image);
}

int main(void) {
  conic_context *context;
  CHECK_OK(conic_context_create(NULL, &context));
  conic_gaussians balls = make_balls(context);
  conic_image wall = make_wall(context);
  const float shown = (float)conic_srgb_encode((double)linear_grey);
  check_named(context, &balls, &wall, wall_z, shown, NULL);
  check_named(context, &balls, &wall, INFINITY, shown, "surfaces-behind");
  check_named(context, &balls, &wall, 0.01f, shown, "surfaces-before");
  check_named(context, &balls, &wall, wall_z, linear_grey, "surfaces-linear");
  check_listing(context, &balls, &wall);
  check_shares(context, &balls, &wall);
  conic_image_release(context, &wall);
  conic_gaussians_release(context, &balls);
  conic_context_destroy(context);
  return check_result();
}
