/* The table of the suite's scenes. The scenes of few Gaussians are in suite_few.c. */
#include "cli/judge/suite_scenes.h"

#include <string.h>

#include "cli/judge/suite_few.h"
#include "cli/judge/suite_surfels.h"
#include "gaussians/scene/gaussian_set.h"
#include "gaussians/scene/made_gaussians.h"

/* A profile's bit, and groups of profiles that draw the same scenes. */
#define BIT(profile) (1u << CONIC_PROFILE_##profile)
#define BLURRED (BIT(INRIA_2023) | BIT(GSPLAT_1_5) | BIT(GSPLAT_1_6))
#define ANTIALIASED (BIT(GSPLAT_1_5_AA) | BIT(GSPLAT_1_6_AA))
#define OTHERS (BIT(KHR_2026) | BIT(EXACT))
#define SOLIDS (BLURRED | ANTIALIASED | OTHERS)
#define DISCS (BIT(2DGS_2024) | BIT(2DGS_GSPLAT) | BIT(EXACT))

/* How a scene is seen: small pictures that are not square, and whose sides are no multiples of a tile. */
#define SMALL .width = 36, .height = 20, .center = {18.0, 10.0}
#define MIDDLE .width = 50, .height = 38, .center = {25.0, 19.0}
#define AHEAD .rotation = {1.0, 0.0, 0.0, 0.0}, .eye = {0.0, 0.0, -4.0}, .focal = {32.0, 32.0}
#define AT_ORIGIN .rotation = {1.0, 0.0, 0.0, 0.0}, .focal = {32.0, 32.0}
#define TURNED .rotation = {8.0, 2.0, -1.0, 1.0}, .eye = {-1.125, -1.75, -3.5}, .focal = {36.0, 36.0}

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

const suite_scene cli_suite_scenes[] = {
    {"ball", "one round Gaussian: the size of its picture, the falloff, the dilation", 1, SMALL, AHEAD,
     .profiles = SOLIDS, .make = cli_suite_ball},
    {"ellipse", "one Gaussian of three sizes, turned: the rotation, the order of the quaternion, the projection", 1,
     SMALL, AHEAD, .profiles = SOLIDS, .formats = SUITE_SPZ | SUITE_GLB, .make = cli_suite_ellipse},
    {"solid", "one Gaussian of opacity 0.9999, of which a colour is below 0: the largest alpha, the clamp at 0", 1,
     SMALL, AHEAD, .profiles = SOLIDS, .make = cli_suite_solid},
    {"harmonics", "one Gaussian of degree 3: every harmonic, and the order of f_rest", 1, SMALL, TURNED,
     .profiles = SOLIDS, .formats = SUITE_GLB, .make = cli_suite_harmonics},
    {"disc", "one 2D Gaussian, tilted", 1, SMALL, AHEAD, .profiles = DISCS, .make = cli_suite_disc},

    {"overlap", "balls that cover one another, and stand in the file in another order than in depth", 2, SMALL, AHEAD,
     .profiles = SOLIDS, .formats = SUITE_SPZ, .make = cli_suite_overlap},
    {"faint", "a pile of opacities from under 1/255 to 0.99: what is left out, and where compositing ends", 2, SMALL,
     AHEAD, .profiles = SOLIDS, .make = cli_suite_faint},
    {"off-center", "a principal point off the middle, and two focal lengths", 2, 36, 20, .focal = {40.0, 30.0},
     .center = {14.25, 12.75}, .rotation = {8.0, 2.0, -1.0, 1.0}, .eye = {-1.125, -1.75, -3.5},
     .profiles = SOLIDS & ~BIT(INRIA_2023), .make = cli_suite_ring},
    {"background", "harmonics of degree 2 before a coloured background", 2, SMALL, TURNED,
     .background = {0.9f, 0.5f, 0.2f}, .profiles = BLURRED | OTHERS, .make = cli_suite_ring},
    {"discs", "2D Gaussians that cover one another", 2, SMALL, AHEAD, .profiles = DISCS, .make = cli_suite_discs},

    {"room", "300 Gaussians of degree 3, as they are trained", 3, MIDDLE, TURNED, .profiles = SOLIDS,
     .formats = SUITE_GLB, .make = make_trained},
    {"room-of-discs", "300 2D Gaussians", 3, MIDDLE, TURNED, .profiles = DISCS, .make = make_flat_room},

    /* khr-2026 has no near plane, so Gaussians next to the eye have no useful bounds. */
    {"crowd", "4000 Gaussians about the eye: the near plane, what is behind, and the borders", 4, MIDDLE,
     .rotation = {8.0, 2.0, -1.0, 1.0}, .eye = {-0.75, -0.75, -1.75}, .focal = {30.0, 30.0},
     .profiles = SOLIDS & ~BIT(KHR_2026), .make = make_crowd},
    {"extremes", "huge ones, needles, plates, specks below a pixel, and what is 10,000 away", 4, MIDDLE, AHEAD,
     .profiles = SOLIDS, .make = cli_suite_extremes},

    {"least", "opacities about 1/255, each over a pixel's centre", 5, SMALL, AHEAD, .profiles = BLURRED | OTHERS,
     .make = cli_suite_least},
    {"end", "piles by which T comes to about 1e-4", 5, SMALL, AHEAD, .profiles = BLURRED | OTHERS,
     .make = cli_suite_end},
    {"ties", "equal depths, and depths apart by less than a float tells", 5, SMALL, AHEAD, .profiles = BLURRED | OTHERS,
     .make = cli_suite_ties},
    {"quaternions", "quaternions of lengths from 0.01 to 1000", 5, SMALL, AHEAD, .profiles = BLURRED | OTHERS,
     .make = cli_suite_quaternions},
    {"broken", "records with NaN, with infinity or without a rotation, which are left out, among sound ones", 5, SMALL,
     AHEAD, .profiles = BLURRED | OTHERS, .make = cli_suite_broken},
    {"far-away", "a scene and its camera 1,100 from the origin, where floats are coarse", 5, SMALL,
     .rotation = {1.0, 0.0, 0.0, 0.0}, .focal = {32.0, 32.0}, .eye = {600.0, -350.0, 896.0},
     .profiles = BLURRED | OTHERS, .make = cli_suite_far_away},
    {"near", "means at the near planes 0.2 and 0.01, before and behind them", 5, SMALL, AT_ORIGIN,
     .profiles = BLURRED | OTHERS, .make = cli_suite_near},
    {"aside", "large ones beside the picture, whose slopes are clamped", 5, SMALL, AHEAD, .profiles = BLURRED | OTHERS,
     .make = cli_suite_aside},
    {"edge-on", "2D Gaussians seen from the edge, and nearly", 5, SMALL, AHEAD, .profiles = DISCS,
     .make = cli_suite_edge_on},

    {"splat", "one surface splat, tilted", 6, SMALL, AHEAD, .profiles = 1u << SUITE_SURFACE,
     .make_splats = cli_suite_splat},
    {"sheet", "splats of one surface, which are blended and normalised", 6, SMALL, AHEAD,
     .profiles = 1u << SUITE_SURFACE, .make_splats = cli_suite_sheet},
    {"corner", "two surfaces: which splats hide, and which are blended", 6, SMALL, AHEAD,
     .profiles = 1u << SUITE_SURFACE, .make_splats = cli_suite_corner},
    {"steep", "a floor seen from near, where perspective is strong within a splat", 6, SMALL, AHEAD,
     .profiles = 1u << SUITE_SURFACE, .make_splats = cli_suite_steep},
};

const int cli_n_suite_scenes = sizeof cli_suite_scenes / sizeof *cli_suite_scenes;

const char *cli_suite_level_about(int level) {
  static const char *const about[SUITE_LEVELS] = {"one Gaussian: its shape and colour",
                                                  "a few: overlap, order, opacity, camera, background",
                                                  "hundreds, as they are trained",
                                                  "thousands, and extreme sizes and places",
                                                  "adversarial: decisions on the edge, ties, broken records",
                                                  "surface splats, opaque, by the method conic"};
  return about[level - 1];
}

const char *cli_suite_profile_name(int profile) {
  return profile == SUITE_SURFACE ? "surface" : conic_gaussian_profile_name((conic_gaussian_profile)profile);
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
