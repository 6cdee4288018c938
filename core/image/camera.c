#include "core/image/framing.h"

#include "core/base/base.h"
#include "core/base/trigonometry.h"
#include "core/base/vectors.h"

CONIC_DEFINE_NAMES(conic_camera_kind_name, conic_camera_kind, CONIC_N_CAMERA_KINDS, "perspective", "fisheye",
                   "orthographic", "equirectangular", "cube")

CONIC_DEFINE_NAMES(conic_lens_name, conic_lens, CONIC_N_LENSES, "none", "radial", "opencv", "thin-prism", "fov",
                   "division", "eucm")

CONIC_DEFINE_OPTIONS(conic_framing, .width = 1024, .height = 1024, .azimuth_deg = 30.0, .elevation_deg = 15.0,
                     .fov_deg = 40.0, .zoom = 1.0, .up = {0.0, 1.0, 0.0})

static int framing_makes_sense(const conic_framing *framing) {
  double up_squared = 0.0;
  for (int i = 0; i < 3; i++)
    up_squared += framing->up[i] * framing->up[i];
  return framing->width >= 1 && framing->width <= 65535 && framing->height >= 1 && framing->height <= 65535 &&
         fabs(framing->azimuth_deg) < 1e6 && fabs(framing->elevation_deg) <= 90.0 && framing->fov_deg > 0.0 &&
         framing->fov_deg < 180.0 && framing->zoom > 0.0 && framing->zoom < 1e9 && up_squared > 1e-200 &&
         up_squared < 1e200;
}

conic_status conic_framing_take(conic_context *context, const conic_framing *given, conic_framing *own) {
  conic_framing_init(own);
  if (!conic_options_take(own, given) || !framing_makes_sense(own))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "the framing makes no sense");
  return CONIC_OK;
}

/* The smallest rotation that takes y to `up`, which is unit; at azimuth 0 the camera looks along the image of z. */
static void rotation_from_y(const double up[3], double rotation[3][3]) {
  double c = 1.0 + up[1];
  if (c < 1e-12) { /* straight down: half a turn around z */
    double half_turn[3][3] = {{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
    memcpy(rotation, half_turn, sizeof half_turn);
    return;
  }
  double x = up[0], z = up[2];
  double made[3][3] = {{1.0 - x * x / c, x, -x * z / c}, {-x, up[1], -z}, {-x * z / c, z, 1.0 - z * z / c}};
  memcpy(rotation, made, sizeof made);
}

static void rotate_vector(const double rotation[3][3], const double v[3], double result[3]) {
  for (int i = 0; i < 3; i++)
    result[i] = rotation[i][0] * v[0] + rotation[i][1] * v[1] + rotation[i][2] * v[2];
}

void conic_framing_rotation(const conic_framing *framing, double rows[3][3]) {
  double up[3], rotation[3][3], up_length = conic_length(framing->up);
  for (int i = 0; i < 3; i++)
    up[i] = framing->up[i] / up_length;
  rotation_from_y(up, rotation);

  double azimuth = conic_radians(framing->azimuth_deg), elevation = conic_radians(framing->elevation_deg);
  double sin_a = conic_sin(azimuth), cos_a = conic_cos(azimuth);
  double sin_e = conic_sin(elevation), cos_e = conic_cos(elevation);
  /* The camera's axes in a frame with y up; the camera's y points down, its z into the scene. */
  const double axes[3][3] = {
      {cos_a, 0.0, -sin_a}, {sin_a * sin_e, -cos_e, cos_a * sin_e}, {-sin_a * cos_e, -sin_e, -cos_a * cos_e}};
  for (int i = 0; i < 3; i++)
    rotate_vector((const double(*)[3])rotation, axes[i], rows[i]);
}

static int shorter_side(const conic_framing *framing) {
  return framing->width < framing->height ? framing->width : framing->height;
}

double conic_framing_tangent(const conic_framing *framing, double length) {
  return conic_tan(conic_radians(0.5 * framing->fov_deg)) * (length / (double)shorter_side(framing));
}

void conic_framing_camera(const conic_framing *framing, double rows[3][3], const double center[3], const double at[3],
                          conic_camera *camera) {
  double tan_half = conic_tan(conic_radians(0.5 * framing->fov_deg));
  memset(camera, 0, sizeof *camera);
  camera->width = framing->width;
  camera->height = framing->height;
  camera->fx = camera->fy = framing->zoom * 0.5 * (double)shorter_side(framing) / tan_half;
  camera->cx = 0.5 * (double)framing->width;
  camera->cy = 0.5 * (double)framing->height;
  for (int i = 0; i < 3; i++) {
    const double *row = rows[i];
    memcpy(camera->cam_from_world[i], row, sizeof rows[i]);
    camera->cam_from_world[i][3] = at[i] - (row[0] * center[0] + row[1] * center[1] + row[2] * center[2]);
  }
}

conic_status conic_camera_frame(conic_context *context, const conic_framing *given, const double minimum[3],
                                const double maximum[3], conic_camera *camera) {
  conic_framing framing;
  double rows[3][3], center[3], diagonal_squared = 0.0;
  if (!camera)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "the framing makes no sense");
  conic_status status = conic_framing_take(context, given, &framing);
  if (status != CONIC_OK)
    return status;
  conic_framing_rotation(&framing, rows);
  for (int i = 0; i < 3; i++) {
    center[i] = 0.5 * minimum[i] + 0.5 * maximum[i];
    diagonal_squared += (maximum[i] - minimum[i]) * (maximum[i] - minimum[i]);
  }
  double radius = 0.5 * sqrt(diagonal_squared);
  if (!(radius > 0.0))
    radius = 1.0;
  /* tangent of the angle of the sphere's radius */
  double tan_sphere = CONIC_FRAMING_PART * conic_tan(conic_radians(0.5 * framing.fov_deg));
  double distance = radius * sqrt(1.0 + tan_sphere * tan_sphere) / tan_sphere;
  conic_framing_camera(&framing, rows, center, (const double[3]){0.0, 0.0, distance}, camera);
  return CONIC_OK;
}
