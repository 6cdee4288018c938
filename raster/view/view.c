#include "raster/view/view.h"

#include "core/base/base.h"
#include "raster/view/method.h"

static int kernel_makes_sense(const conic_kernel *kernel) {
  if (!(kernel->cutoff >= 0.25f && kernel->cutoff <= 5.0f))
    return 0;
  if (conic_kernel_traits(kernel) & CONIC_HAS_PARAMETERS)
    return kernel->a > 0.0f && kernel->a < 1e6f && kernel->b > 0.0f && kernel->b < 1e6f && kernel->n >= 1 &&
           kernel->n <= 16;
  return conic_kernel_type_name(kernel->type) != NULL;
}

static const char *what_of_camera_is_wrong(const conic_splats *splats, const conic_render_options *options) {
  if (!splats->position[0] || !splats->tangent_u[0] || !splats->tangent_v[0])
    return "the splats have no tangent axes";
  if (splats->count > UINT32_MAX - 1)
    return "there are more than 4,294,967,294 splats";
  if (!kernel_makes_sense(&options->kernel))
    return "the kernel's cutoff or parameters are out of range";
  if (!(options->prefilter >= 0.0f && options->prefilter <= 1e4f))
    return "the prefilter is out of range (0 to 10000)";
  if (options->passes != 1 && options->passes != 3 && options->passes != CONIC_PASS_OF_HIDING)
    return "there are 3 passes or 1, or that of hiding";
  if (options->tile < 8 || options->tile > 64 || (options->tile & (options->tile - 1)))
    return "the tile is not 8, 16, 32 or 64";
  if (!conic_method_name(options->method))
    return "the method is unknown";
  if (!(options->near_z >= 0.0) || !(options->epsilon < 1e30) || !(fabs(options->exposure) <= 100.0))
    return "near, epsilon or exposure is out of range";
  for (int i = 0; i < 3; i++)
    if (options->has_background && !(fabsf(options->background[i]) <= 1e18f))
      return "the background is out of range";
  return NULL;
}

static int has_profile(const conic_render_options *options) {
  return !(conic_kernel_traits(&options->kernel) & CONIC_IS_GAUSSIAN) && options->prefilter > 0.0f &&
         !conic_method_is_dot(options->method);
}

/* Half a pixel a standard deviation; for `auto`, whose other formulas follow thin splats further, an eighth, and of
 * kernels that have a profile, which conic puts off by more, a 256th (docs/reference/picture.md, Auto). */
static float thin_variance(const conic_render_options *options) {
  float h = options->prefilter;
  if (options->method != CONIC_METHOD_AUTO)
    return 0.25f;
  return (h > 1.0f ? h : 1.0f) / (has_profile(options) ? 65536.0f : 64.0f);
}

/* The eye, and from where on float tells which side of it a plane is on (raster/loops/project_body.h). */
static void place_eye(conic_view *view) {
  const double(*m)[3] = (const double(*)[3])view->rotation;
  double reach = 0.0, farthest_from_rotation = 0.0;
  for (int i = 0; i < 3; i++) {
    double eye = 0.0;
    for (int j = 0; j < 3; j++) {
      double dot = (m[i][0] * m[j][0] + m[i][1] * m[j][1]) + m[i][2] * m[j][2];
      farthest_from_rotation = fmax(farthest_from_rotation, fabs(dot - (i == j)));
      eye -= m[j][i] * view->translation[j];
    }
    view->eye[i] = (float)eye;
    reach += fabs(eye);
  }
  int is_usual = farthest_from_rotation < 1e-5 && view->fx > 0.1 && view->fy > 0.1 && view->fx < 1e6 && view->fy < 1e6;
  view->nearest_sure = is_usual ? (float)fmax(1e-3 * reach, 1e-15) : HUGE_VALF;
}

/* Whatever ends at its rim and is flat before it is right where its outline is. */
static float auto_limit(const conic_kernel *kernel) {
  const unsigned traits = conic_kernel_traits(kernel);
  float steepness =
      traits & CONIC_IS_GAUSSIAN ? CONIC_AUTO_STEEPNESS : CONIC_AUTO_BY_SLOPE * (float)conic_profile_slope(kernel);
  return traits & CONIC_IS_FLAT ? HUGE_VALF : (CONIC_AUTO_ERROR / steepness) * (CONIC_AUTO_ERROR / steepness);
}

conic_status conic_view_init(conic_context *context, const conic_splats *splats, const conic_camera *camera,
                             const conic_render_options *options, double near_z, double splat_length,
                             conic_view *view) {
  const char *wrong = what_of_camera_is_wrong(splats, options);
  if (wrong)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s", wrong);
  memset(view, 0, sizeof *view);
  view->width = camera->width;
  view->height = camera->height;
  for (int i = 0; i < 3; i++) {
    const double *row = camera->cam_from_world[i];
    for (int j = 0; j < 3; j++) {
      view->rotation[i][j] = row[j];
      view->rotation_float[i][j] = (float)row[j];
    }
    view->translation[i] =
        ((row[0] * splats->origin[0] + row[1] * splats->origin[1]) + row[2] * splats->origin[2]) + row[3];
  }
  view->fx = camera->fx;
  view->fy = camera->fy;
  view->focal_px = (float)sqrt(camera->fx * camera->fy);
  view->cx = camera->cx;
  view->cy = camera->cy;
  view->near_z = near_z;
  view->method = options->method;
  view->kernel = options->kernel;
  view->cutoff = options->kernel.cutoff;
  view->support = conic_kernel_support(&options->kernel);
  view->prefilter = options->prefilter;
  view->growth_px = view->cutoff * sqrtf(view->prefilter);
  view->cull_back = options->cull_back;
  place_eye(view);
  view->thin = thin_variance(options);
  view->auto_limit = auto_limit(&view->kernel);
  if (options->epsilon >= 0.0) {
    view->epsilon_scale = HUGE_VALF;
    view->epsilon_cap = (float)options->epsilon;
  } else {
    view->epsilon_scale = CONIC_EPSILON_C;
    view->epsilon_cap = 4.0f * CONIC_EPSILON_C * view->cutoff * (float)splat_length;
  }
  view->needs_nearness = view->needs_slope = 1;
  return has_profile(options) ? conic_profile_make(context, &view->kernel, &view->profile) : CONIC_OK;
}
