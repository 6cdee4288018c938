/* What a source that streams looks like from all around: small pictures of it, from six sides, become splats again.
 * Coarse parts are enough for them, so little is read. */
#include "source/source_samples.h"

#include "core/base/vectors.h"

enum { SIDE = 96, N_VIEWS = 6 };

/* Azimuth and elevation in degrees. */
static const double directions[N_VIEWS][2] = {{0, 0}, {90, 0}, {180, 0}, {270, 0}, {0, 90}, {0, -90}};

/* In pixels of the small pictures. */
static const double sample_error_px = 1.0;

/* Adds a disc of a pixel's size on the surface: at the depth z, with the normal n, seen at (dx, dy). */
static void add_disc(conic_splats *samples, const conic_camera *camera, double dx, double dy, double z,
                     const float normal[3]) {
  double seen[3] = {dx * z, dy * z, z}, place[3] = {0.0, 0.0, 0.0}, ray[3] = {0.0, 0.0, 0.0}, n[3], u[3], v[3];
  static const double least_cosine = 0.1;
  size_t at = samples->count++;
  for (int row = 0; row < 3; row++)
    for (int axis = 0; axis < 3; axis++) {
      const double *m = camera->cam_from_world[row];
      place[axis] += m[axis] * (seen[row] - m[3]);
      ray[axis] += m[axis] * seen[row];
    }
  for (int axis = 0; axis < 3; axis++)
    n[axis] = (double)normal[axis];
  double cosine = fabs(conic_dot(n, ray)) / conic_length(ray), radius = 0.5 * z / camera->fx;
  int least = fabs(n[0]) < fabs(n[1]) ? 0 : 1;
  double axis_apart[3] = {0.0, 0.0, 0.0};
  axis_apart[fabs(n[2]) < fabs(n[least]) ? 2 : least] = 1.0;
  conic_cross(axis_apart, n, u);
  conic_normalize(u);
  conic_cross(n, u, v);
  for (int axis = 0; axis < 3; axis++) {
    samples->position[axis][at] = (float)(place[axis] - samples->origin[axis]);
    samples->tangent_u[axis][at] = (float)(u[axis] * radius);
    samples->tangent_v[axis][at] = (float)(v[axis] * radius / (cosine > least_cosine ? cosine : least_cosine));
  }
}

static void add_picture(conic_splats *samples, const conic_camera *camera, const conic_image *image) {
  const float *z = image->planes[CONIC_PLANE_Z], *normal = image->planes[CONIC_PLANE_NORMAL];
  const uint32_t *id = image->planes[CONIC_PLANE_ID];
  for (int i = 0; i < SIDE * SIDE; i++) {
    const int row = i / SIDE;
    double dx = (i % SIDE + 0.5 - camera->cx) / camera->fx, dy = (row + 0.5 - camera->cy) / camera->fy;
    if (id[i] != CONIC_NO_ID)
      add_disc(samples, camera, dx, dy, (double)z[i], normal + 3 * (size_t)i);
  }
}

void conic_source_limit_samples(conic_source *source, double seconds) {
  source->samples_until = conic_seconds_now() + seconds;
}

/* Draws the sides from `begin` to before `end`. */
static conic_status draw_around(conic_source *source, conic_renderer *renderer, conic_image *image, int begin, int end,
                                conic_splats *samples) {
  conic_render_options render;
  conic_source_view view;
  conic_framing framing;
  conic_status status = CONIC_OK;
  conic_render_options_init(&render);
  conic_source_view_init(&view);
  conic_framing_init(&framing);
  framing.width = framing.height = SIDE;
  render.cull_back = 1; /* so that normals are the surface's own, and open surfaces are seen to be open */
  render.shading = CONIC_SHADE_NONE;
  view.error_px = sample_error_px;
  source->only_samples = 1;
  view.may_be_coarser = source->samples_until > 0.0;
  for (int i = begin; i < end && status == CONIC_OK; i++) {
    conic_camera camera;
    if (view.may_be_coarser)
      view.seconds = fmax(source->samples_until - conic_seconds_now(), 1e-3); /* 0 would be no limit */
    framing.azimuth_deg = directions[i][0];
    framing.elevation_deg = directions[i][1];
    status = conic_source_frame(source, &framing, &camera);
    if (status == CONIC_OK)
      status = conic_source_draw(source, renderer, &camera, &render, &view, image, NULL);
    if (status == CONIC_OK)
      add_picture(samples, &camera, image);
  }
  source->only_samples = 0;
  return status;
}

static conic_status sample_sides(conic_source *source, int begin, int end, conic_splats *samples) {
  conic_context *context = source->context;
  conic_renderer *renderer = NULL;
  conic_image image = {0};
  conic_status status = conic_splats_allocate(context, (size_t)N_VIEWS * SIDE * SIDE, CONIC_SPLATS_TANGENTS, samples);
  if (status != CONIC_OK)
    return status;
  samples->count = 0;
  for (int axis = 0; axis < 3; axis++)
    samples->origin[axis] = 0.5 * source->scale.minimum[axis] + 0.5 * source->scale.maximum[axis];
  status = conic_renderer_create(context, &renderer);
  if (status == CONIC_OK)
    status = conic_image_allocate(context, SIDE, SIDE,
                                  1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_NORMAL | 1u << CONIC_PLANE_ID, &image);
  if (status == CONIC_OK)
    status = draw_around(source, renderer, &image, begin, end, samples);
  conic_image_release(context, &image);
  conic_renderer_destroy(renderer);
  if (status != CONIC_OK)
    conic_splats_release(context, samples);
  return status;
}

conic_status conic_source_take_samples(conic_source *source, conic_splats *samples) {
  return sample_sides(source, 0, N_VIEWS, samples);
}

/* Replaces this process's samples by those of all processes, in the order of the sides. */
static void collect_samples(const conic_team *team, conic_splats *samples) {
  size_t n_bytes = 0;
  for (int k = 0; k < 9; k++) {
    float *const *arrays = k < 3 ? samples->position : k < 6 ? samples->tangent_u : samples->tangent_v;
    n_bytes = conic_team_collect(team, arrays[k % 3], samples->count * sizeof(float), arrays[k % 3]);
  }
  samples->count = n_bytes / sizeof(float);
}

conic_status conic_source_share_samples(conic_source *source, const conic_team *team, conic_status status) {
  if (!team)
    return status;
  int is_wanted = status == CONIC_OK && source->kind->draw && source->outline.count == 0,
      begin = N_VIEWS * team->index / team->count, end = N_VIEWS * (team->index + 1) / team->count;
  conic_splats samples;
  conic_status own = is_wanted ? sample_sides(source, begin, end, &samples) : status;
  status = conic_team_agree(team, own);
  if (!is_wanted || own != CONIC_OK)
    return status;
  if (status != CONIC_OK) {
    conic_splats_release(source->context, &samples);
    return status;
  }
  collect_samples(team, &samples);
  conic_splats_release(source->context, &source->outline);
  source->outline = samples;
  return CONIC_OK;
}
