#include "lod/hybrid/draw/hybrid_offers.h"

#include "core/base/trigonometry.h"
#include "core/splats/ellipse.h"

/* What drawing takes, in nanoseconds of one core with what it takes to choose and to copy: a triangle, one more that
 * holds a pixel's centre, and a pixel of the cluster; a surfel, and a pixel of its outline
 * (docs/notes/hybrid-measured.md). */
static const double triangle_ns = 60.0, seen_triangle_ns = 90.0, triangle_pixel_ns = 5.3;
static const double surfel_ns = 37.0, surfel_pixel_ns = 1.8;

void conic_hybrid_camera_init(const conic_hybrid *hybrid, const conic_camera *camera,
                              const conic_render_options *render, conic_hybrid_camera *view) {
  double margin = (double)render->kernel.cutoff * sqrt((double)render->prefilter) + 1.0;
  memset(view, 0, sizeof *view);
  conic_viewpoint_init(&view->from, camera, hybrid->origin, margin);
  view->focal_px = camera->fx > camera->fy ? camera->fx : camera->fy;
  view->near_z = render->near_z;
  view->n_pixels = (double)camera->width * (double)camera->height;
  view->cull_back = render->cull_back;
  view->color_error = HUGE_VAL;
  view->margin_px2 = (double)render->prefilter * (double)render->kernel.cutoff * (double)render->kernel.cutoff;
}

/* Away is where the angle between the ray and the axis, half the angle under which the sphere is seen, and half the
 * cone's opening are less than a right angle together. */
static int faces_away(const conic_hybrid_camera *view, const conic_hybrid_bound *bound, double radius) {
  double ray[3], axis[3];
  for (int k = 0; k < 3; k++) {
    ray[k] = (double)bound->center[k] - view->from.eye[k];
    axis[k] = (double)bound->axis[k];
  }
  double distance = conic_length(ray), cone = (double)bound->cone;
  if (!(cone > 0.0) || !(radius < distance))
    return 0;
  double sin_a = radius / distance, cos_a = sqrt(1.0 - sin_a * sin_a),
         sin_c = sqrt(cone < 1.0 ? 1.0 - cone * cone : 0.0);
  double cos_both = cos_a * cone - sin_a * sin_c, sin_both = sin_a * cone + cos_a * sin_c;
  return cos_both > 0.0 && conic_dot(ray, axis) > distance * (sin_both + 1e-5);
}

int conic_hybrid_is_hidden(const conic_hybrid_camera *view, const conic_hybrid_bound *bound, double reach) {
  double at[3], radius = ((double)bound->radius + reach) * (1.0 + 1e-6);
  conic_viewpoint_move_floats(&view->from, bound->center, at);
  if (at[2] + radius < view->near_z || conic_viewpoint_misses(&view->from, at, radius))
    return 1;
  return view->cull_back && faces_away(view, bound, radius);
}

/* A cluster as the camera sees it. */
typedef struct sight {
  double z, distance; /* of its sphere's centre */
  double radius;
  double scale2, facing; /* pixels that a unit of area covers if it faces the camera, and how far it does */
} sight;

static sight look_at_bound(const conic_hybrid_camera *view, const conic_hybrid_bound *bound) {
  double at[3];
  conic_viewpoint_move_floats(&view->from, bound->center, at);
  return (sight){.z = at[2], .distance = conic_length(at), .radius = (double)bound->radius};
}

/* The most pixels that a displacement of one can be, anywhere in the sphere: the greatest factor of the projection's
 * derivative at X is f·|X|/z². Infinite where the sphere reaches the near plane. */
static double pixels_a_unit(const conic_hybrid_camera *view, const sight *seen, double reach) {
  double radius = (seen->radius + reach) * (1.0 + 1e-6), front = seen->z - radius;
  return front > view->near_z ? view->focal_px * (seen->distance + radius) / (front * front) : HUGE_VAL;
}

double conic_hybrid_pixels_a_unit(const conic_hybrid_camera *view, const conic_hybrid_bound *bound, double reach) {
  sight seen = look_at_bound(view, bound);
  return pixels_a_unit(view, &seen, reach);
}

/* In steps: less where what differs is smaller than a pixel. */
static double change_of(double pixels_a_unit, float change, float smear) {
  double smeared = smear > 0.0f ? (double)smear * pixels_a_unit : 0.0;
  return smeared < (double)change ? smeared : (double)change;
}

double conic_hybrid_change(const conic_hybrid_camera *view, const conic_hybrid_bound *bound,
                           const conic_hybrid_level *level) {
  return change_of(conic_hybrid_pixels_a_unit(view, bound, (double)level->reach), level->change, level->smear);
}

double conic_hybrid_point_change(const conic_hybrid_camera *view, const conic_hybrid_node *node) {
  return change_of(conic_hybrid_pixels_a_unit(view, &node->bound, 0.0), node->point.change, node->point.smear);
}

double conic_hybrid_error_px(const conic_hybrid_camera *view, const conic_hybrid_bound *bound,
                             const conic_hybrid_level *level) {
  sight seen = look_at_bound(view, bound);
  return level->error > 0.0f ? (double)level->error * pixels_a_unit(view, &seen, (double)level->reach) : 0.0;
}

double conic_hybrid_node_error_px(const conic_hybrid *hybrid, const conic_hybrid_camera *view,
                                  const conic_hybrid_node *node, const conic_hybrid_level *level) {
  double most = 0.0, error = (double)level->error;
  if (level->kind == CONIC_HYBRID_SURFELS || !(error > 0.0))
    return conic_hybrid_error_px(view, &node->bound, level);
  for (uint32_t i = node->begin; i < node->end; i++) {
    const conic_hybrid_bound *bound = &hybrid->clusters[i].bound;
    double own = conic_hybrid_pixels_a_unit(view, bound, error);
    if (own > most && !conic_hybrid_is_hidden(view, bound, error))
      most = own;
  }
  return error * most;
}

/* The mean cosine of the faces to the camera: by the axis of their cone as far as that says anything, else half. */
static double facing_of(const conic_hybrid_camera *view, const conic_hybrid_bound *bound, const sight *seen) {
  double along = 0.0, cone = bound->cone > 0.0f ? (double)bound->cone : 0.0;
  for (int k = 0; k < 3; k++)
    along += ((double)bound->center[k] - view->from.eye[k]) * (double)bound->axis[k];
  return cone * (seen->distance > 0.0 ? fabs(along) / seen->distance : 1.0) + (1.0 - cone) * 0.5;
}

/* What reaches near, or behind the eye, covers no more than the picture. */
static double pixels_of(const conic_hybrid_camera *view, double area, const sight *seen) {
  double n_pixels = area * seen->scale2 * seen->facing;
  return n_pixels < view->n_pixels ? n_pixels : view->n_pixels;
}

static double cost_of_triangles(const conic_hybrid_camera *view, const conic_hybrid_cluster *cluster,
                                const conic_hybrid_level *level, const sight *seen) {
  double n = (double)level->count, n_pixels = pixels_of(view, (double)cluster->area, seen);
  double n_seen = n * n_pixels / (n_pixels + 2.0 * n); /* few of those that are smaller than a pixel */
  return n * triangle_ns + n_seen * seen_triangle_ns + n_pixels * triangle_pixel_ns;
}

/* Each takes the area of its ellipse, both axes being widened by the prefilter. */
static double cost_of_surfels(const conic_hybrid_camera *view, const conic_hybrid_level *level, const sight *seen) {
  double n = (double)level->count, facing = seen->facing, widening = view->margin_px2;
  double product = (double)level->cover / n * seen->scale2 * facing;
  double squares = (double)level->spread / n * seen->scale2 * 0.5 * (1.0 + facing * facing);
  double n_pixels = n * CONIC_PI * sqrt(product * product + widening * squares + widening * widening);
  double most = n * view->n_pixels; /* what reaches near covers no more */
  return n * surfel_ns + (n_pixels < most ? n_pixels : most) * surfel_pixel_ns;
}

/* With what it takes to know costs. */
static sight look_well_at(const conic_hybrid_camera *view, const conic_hybrid_bound *bound) {
  sight seen = look_at_bound(view, bound);
  double z = seen.z > view->near_z ? seen.z : view->near_z;
  seen.scale2 = view->focal_px * view->focal_px / (z * z);
  seen.facing = facing_of(view, bound, &seen);
  return seen;
}

double conic_hybrid_cost(const conic_hybrid_camera *view, const conic_hybrid_cluster *cluster,
                         const conic_hybrid_level *level) {
  sight seen = look_well_at(view, &cluster->bound);
  return level->kind == CONIC_HYBRID_TRIANGLES ? cost_of_triangles(view, cluster, level, &seen)
                                               : cost_of_surfels(view, level, &seen);
}

uint32_t conic_hybrid_finest(const conic_hybrid *hybrid, const conic_hybrid_cluster *cluster, int only_kind) {
  for (uint32_t k = 0; k < cluster->n_levels; k++)
    if (hybrid->levels[cluster->first_level + k].kind == (uint32_t)only_kind)
      return k;
  return 0;
}

/* --- nodes as points --- */

/* The way from the eye to the centre, and the radius of the disc there that hides the sphere: where the rays that touch
 * the sphere pass. Returns infinity where the eye is in the sphere. */
static double radius_of_disc(const conic_hybrid_camera *view, const conic_hybrid_node *node, double way[3],
                             double *distance) {
  double radius = (double)node->point.radius;
  for (int axis = 0; axis < 3; axis++)
    way[axis] = (double)node->bound.center[axis] - view->from.eye[axis];
  *distance = conic_length(way);
  return *distance > radius ? radius * *distance / sqrt(*distance * *distance - radius * radius) : HUGE_VAL;
}

double conic_hybrid_point_error_px(const conic_hybrid_camera *view, const conic_hybrid_node *node) {
  double way[3], distance, disc = radius_of_disc(view, node, way, &distance);
  if (!(node->point.radius > 0.0f) || !(disc < HUGE_VAL))
    return HUGE_VAL;
  /* the disc reaches out of the sphere by what it is larger */
  double out = disc - (double)node->point.radius;
  return ((double)node->point.error + out) * conic_hybrid_pixels_a_unit(view, &node->bound, out);
}

void conic_hybrid_point_splat(const conic_hybrid_camera *view, const conic_hybrid_node *node, double cutoff,
                              float values[12]) {
  double way[3], distance, u[3], v[3], sigma = radius_of_disc(view, node, way, &distance) / cutoff;
  for (int axis = 0; axis < 3; axis++)
    way[axis] /= -distance;
  conic_tangent_basis(way, u, v);
  for (int axis = 0; axis < 3; axis++) {
    values[axis] = node->bound.center[axis];
    values[3 + axis] = (float)(sigma * u[axis]);
    values[6 + axis] = (float)(sigma * v[axis]);
    values[9 + axis] = node->point.color[axis];
  }
}
