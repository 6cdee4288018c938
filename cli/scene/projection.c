#include "cli/scene/projection.h"

#include "core/base/trigonometry.h"
#include "core/base/vectors.h"

const char *const cli_projection_words[] = {"perspective", "fisheye", "orthographic", "panorama", "cube", NULL};

int cli_parse_eye(const char *text, void *eye) {
  return cli_parse_vector(text, eye);
}

static void stand_at(const double eye[3], conic_camera *camera) {
  for (int row = 0; row < 3; row++)
    camera->cam_from_world[row][3] = -conic_dot(camera->cam_from_world[row], eye);
}

/* Of a pinhole so far off that what it frames is what parallel rays do. */
static const double parallel_fov_deg = 0.5;

void cli_project_frame(const cli_render_job *job, conic_framing *framing) {
  if (job->projection == CONIC_CAMERA_ORTHOGRAPHIC)
    framing->fov_deg = parallel_fov_deg;
}

void cli_project(const cli_render_job *job, const conic_framing *framing, conic_camera *camera) {
  const conic_source_scale *scale = conic_source_measure(job->source);
  const double shorter = camera->width < camera->height ? camera->width : camera->height;
  double center[3], distance = camera->cam_from_world[2][3];
  for (int axis = 0; axis < 3; axis++) {
    center[axis] = 0.5 * scale->minimum[axis] + 0.5 * scale->maximum[axis];
    distance += camera->cam_from_world[2][axis] * center[axis];
  }
  camera->kind = (uint32_t)job->projection;
  if (job->projection == CONIC_CAMERA_ORTHOGRAPHIC) { /* as large as the pinhole draws what is at the centre */
    camera->fx = camera->fy = camera->fx / distance;
    camera->cam_from_world[2][3] +=
        0.5 * framing->zoom * shorter / (camera->fx * conic_tan(conic_radians(0.5 * framing->fov_deg))) - distance;
  } else if (job->projection == CONIC_CAMERA_FISHEYE)
    camera->fx = camera->fy = framing->zoom * shorter / conic_radians(framing->fov_deg);
  else if (job->projection == CONIC_CAMERA_EQUIRECTANGULAR) { /* all around, from amid the scene */
    camera->fx = camera->fy = framing->zoom * camera->width / (2.0 * CONIC_PI);
    stand_at(center, camera);
  } else if (job->projection == CONIC_CAMERA_CUBE) { /* likewise; the picture is as wide as one of its sides */
    camera->fx = camera->fy = camera->cx = camera->cy = 0.5 * camera->width;
    stand_at(center, camera);
  }
  if (job->is_eye_given)
    stand_at(job->eye, camera);
}
