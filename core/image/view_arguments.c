#include "core/image/view_arguments.h"

#include "core/base/base.h"

/* How far the rotation's rows may be from orthonormal: files are written with few digits. */
static const double rotation_tolerance = 1e-3;

CONIC_DEFINE_OPTIONS(conic_render_options, .method = CONIC_METHOD_AUTO,
                     .kernel = {.cutoff = 1.5f, .a = 4.0f, .b = 1.5f, .n = 5}, .prefilter = 1.0f, .epsilon = -1.0,
                     .passes = 3, .shading = CONIC_SHADE_PHONG, .tile = 64)

const char *conic_rotation_fault(const double rows[3][4]) {
  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) {
      double dot = rows[i][0] * rows[j][0] + rows[i][1] * rows[j][1] + rows[i][2] * rows[j][2];
      if (!(fabs(dot - (i == j ? 1.0 : 0.0)) < rotation_tolerance))
        return "is no rotation and translation: its rows are not orthonormal";
    }
  double determinant = rows[0][0] * (rows[1][1] * rows[2][2] - rows[1][2] * rows[2][1]) -
                       rows[0][1] * (rows[1][0] * rows[2][2] - rows[1][2] * rows[2][0]) +
                       rows[0][2] * (rows[1][0] * rows[2][1] - rows[1][1] * rows[2][0]);
  return determinant > 0.0 ? NULL : "mirrors";
}

static const char *find_number_fault(const conic_camera *c) {
  if (c->reserved_word)
    return "the camera's reserved words are not zero";
  if (c->shutter >= CONIC_N_SHUTTERS)
    return "there is no such shutter";
  for (int i = 0; i < 3; i++)
    if (!(fabs(c->turn[i]) <= 1.0 && fabs(c->shift[i]) < 1e30))
      return "the turn or the shift of the camera's shutter is out of range";
  if (c->shutter && (c->width < 2 || c->height < 2))
    return "a rolling shutter has two rows and columns or more";
  if (c->kind >= CONIC_N_CAMERA_KINDS || c->lens >= CONIC_N_LENSES)
    return "there is no such kind of camera, or no such lens";
  for (int i = 0; i < 8; i++)
    if (!(fabs(c->distortion[i]) < 1e12))
      return "the camera's distortion is out of range";
  if (c->width < 1 || c->width > 65535 || c->height < 1 || c->height > 65535)
    return "the camera's picture is 1 to 65535 pixels wide and high";
  if (c->kind == CONIC_CAMERA_CUBE && (c->height != 6 * c->width || c->lens))
    return "a cube is six times as high as wide, and has no lens";
  if (!(c->fx > 0.0 && c->fx < 1e12 && c->fy > 0.0 && c->fy < 1e12 && fabs(c->cx) < 1e12 && fabs(c->cy) < 1e12))
    return "the camera's focal lengths or centre are out of range";
  return NULL;
}

int conic_camera_is_wrong(const conic_camera *c, char wrong[CONIC_CAMERA_FAULT_ROOM]) {
  const char *number = find_number_fault(c), *matrix = number ? NULL : conic_rotation_fault(c->cam_from_world);
  for (int i = 0; i < 3 && !number && !matrix; i++)
    matrix = fabs(c->cam_from_world[i][3]) < 1e30 ? NULL : "has a translation that is out of range";
  snprintf(wrong, CONIC_CAMERA_FAULT_ROOM, "%s%s", number ? number : "the camera's cam_from_world ",
           matrix ? matrix : "");
  return number || matrix;
}

static conic_status check_any_shutter(conic_context *context, const char *who, const conic_camera *c) {
  char wrong[CONIC_CAMERA_FAULT_ROOM];
  return conic_camera_is_wrong(c, wrong) ? conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: %s", who, wrong) : CONIC_OK;
}

conic_status conic_view_camera_check(conic_context *context, const char *who, const conic_camera *c) {
  conic_status status = check_any_shutter(context, who, c);
  if (status == CONIC_OK && c->shutter)
    return conic_fail(
        context, CONIC_ERROR_ARGUMENT,
        "%s: the camera has a rolling shutter, by which Gaussians are drawn with --profile 3dgut-2025 alone", who);
  return status;
}

conic_status conic_view_pinhole_check(conic_context *context, const char *who, const conic_camera *c) {
  conic_status status = conic_view_camera_check(context, who, c);
  if (status != CONIC_OK || (c->kind == CONIC_CAMERA_PERSPECTIVE && c->lens == CONIC_LENS_NONE))
    return status;
  return conic_fail(
      context, CONIC_ERROR_ARGUMENT,
      "%s: the camera is %s%s, and this takes pinholes alone; render draws by it, Gaussians with --profile exact", who,
      conic_camera_kind_name((conic_camera_kind)c->kind), c->lens ? " with a lens that distorts" : "");
}

conic_status conic_view_ray_check(conic_context *context, const char *who, const conic_camera *c) {
  conic_status status = conic_view_camera_check(context, who, c);
  if (status == CONIC_OK && c->kind == CONIC_CAMERA_CUBE)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: a cube is drawn side by side, and this takes one camera",
                      who);
  if (status == CONIC_OK && c->lens &&
      (c->kind == CONIC_CAMERA_ORTHOGRAPHIC || c->kind == CONIC_CAMERA_EQUIRECTANGULAR))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: an orthographic or equirectangular camera has no lens", who);
  return status;
}

/* Of gsplat: pinholes with a lens of OpenCV, and fisheyes with its four numbers. */
static int is_of_gsplat(const conic_camera *c) {
  const int is_radial = c->lens == CONIC_LENS_NONE || c->lens == CONIC_LENS_RADIAL;
  return c->kind == CONIC_CAMERA_FISHEYE ? is_radial
                                         : c->kind == CONIC_CAMERA_PERSPECTIVE &&
                                               (c->lens == CONIC_LENS_OPENCV || (is_radial && c->distortion[3] == 0.0));
}

conic_status conic_view_profile_check(conic_context *context, const char *who, const conic_profile_row *rules,
                                      const conic_camera *camera) {
  if (rules->shape != CONIC_SHAPE_SOLID)
    return (rules->shape == CONIC_SHAPE_RAY ? conic_view_ray_check : conic_view_pinhole_check)(context, who, camera);
  conic_status status = check_any_shutter(context, who, camera);
  if (status != CONIC_OK || is_of_gsplat(camera))
    return status;
  return conic_fail(context, CONIC_ERROR_ARGUMENT,
                    "%s: %s takes pinholes, without a lens or with k1 to k6, p1 and p2 of OpenCV, and fisheyes with k1 "
                    "to k4; this camera is %s, its lens %s",
                    who, rules->name, conic_camera_kind_name((conic_camera_kind)camera->kind),
                    conic_lens_name((conic_lens)camera->lens));
}

conic_status conic_view_bounded_check(conic_context *context, const char *who, const conic_profile_row *rules,
                                      const conic_camera *camera) {
  return rules->shape == CONIC_SHAPE_SOLID ? conic_view_profile_check(context, who, rules, camera)
                                           : conic_view_pinhole_check(context, who, camera);
}

conic_status conic_view_arguments_take(conic_context *context, const char *who, const conic_camera *camera,
                                       const conic_render_options *options, conic_render_options *own) {
  conic_render_options_init(own);
  if (!camera || !conic_options_take(own, options))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: an argument is null, or the options were not initialised",
                      who);
  return conic_view_pinhole_check(context, who, camera);
}
