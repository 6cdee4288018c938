/* Projection in lanes: conic_project_one (raster/project.c) for a group of splats at once, with the same operations in
 * the same order. What is not usual (near the camera, drawn by ray, not finite) is left to conic_project_one itself.
 * Included by tile_kernels_body.h. What is in double, or converts, is written as plain loops over the group. */
#include <math.h>

#include "raster/projected.h"

/* What a lane turned out to be. */
enum { GROUP_USUAL, GROUP_CULLED, GROUP_SKIPPED, GROUP_UNUSUAL };

typedef struct group {
  const conic_view *view;
  const conic_splats *splats;
  size_t first;
  int32_t state[CONIC_LANES];
  double p[3][CONIC_LANES], inverse_z[CONIC_LANES];
  float inverse_z_float[CONIC_LANES], x[CONIC_LANES], y[CONIC_LANES]; /* p_x/p_z, p_y/p_z */
  float reach[CONIC_LANES], nearest[CONIC_LANES], farthest[CONIC_LANES], distance[CONIC_LANES];
  lanes tu[3], tv[3];           /* camera space */
  lanes ux, uy, uz, vx, vy, vz; /* sheared to the centre, over p_z, in pixels */
  lanes area, bx, by, inverse_w, rxx, rxy, ryy, root, vxx, vyy, determinant;
  float shift[2][CONIC_LANES], half[2][CONIC_LANES];
  int32_t begin[2][CONIC_LANES], end[2][CONIC_LANES], center[2][CONIC_LANES];
  float fraction[2][CONIC_LANES];
  lanes normal[3], longer;
} group;

CONIC_INLINE lanes load3(const float *const v[3], size_t i, int axis) {
  return lanes_load(v[axis] + i);
}

CONIC_INLINE void rotate_lanes(const float m[3][3], const float *const v[3], size_t i, lanes result[3]) {
  for (int row = 0; row < 3; row++)
    result[row] = (m[row][0] * load3(v, i, 0) + m[row][1] * load3(v, i, 1)) + m[row][2] * load3(v, i, 2);
}

CONIC_INLINE void move_centers(group *g) {
  const conic_view *view = g->view;
  const float *x = g->splats->position[0] + g->first, *y = g->splats->position[1] + g->first;
  const float *z = g->splats->position[2] + g->first;
  for (int row = 0; row < 3; row++) {
    const double *m = view->rotation[row];
    for (int l = 0; l < CONIC_LANES; l++)
      g->p[row][l] = ((m[0] * (double)x[l] + m[1] * (double)y[l]) + m[2] * (double)z[l]) + view->translation[row];
  }
}

/* Which lanes are wholly before near, and their measures relative to p_z. */
CONIC_INLINE void classify(group *g) {
  const conic_view *view = g->view;
  float reach_z[CONIC_LANES];
  double near_z = view->near_z;
  lanes_store(reach_z, view->cutoff * lanes_sqrt(g->tu[2] * g->tu[2] + g->tv[2] * g->tv[2]));
  for (int l = 0; l < CONIC_LANES; l++) {
    double x = g->p[0][l], y = g->p[1][l], z = g->p[2][l], r = (double)reach_z[l], inverse = 1.0 / z;
    int is_finite = (x + y + z + r) * 0.0 == 0.0, is_ahead = z + r > near_z, is_before = z - r > near_z;
    g->state[l] = is_before ? GROUP_USUAL : GROUP_UNUSUAL;
    g->state[l] = is_ahead ? g->state[l] : GROUP_CULLED;
    g->state[l] = is_finite ? g->state[l] : GROUP_SKIPPED;
    g->inverse_z[l] = inverse;
    g->reach[l] = (float)(r * inverse);
    g->nearest[l] = (float)((z - r) * inverse);
    g->farthest[l] = (float)((z + r) * inverse);
    g->inverse_z_float[l] = (float)inverse;
    g->x[l] = (float)(x * inverse);
    g->y[l] = (float)(y * inverse);
    g->distance[l] = (float)sqrt((x * x + y * y) + z * z);
  }
}

CONIC_INLINE void shear(group *g) {
  float fx = (float)g->view->fx, fy = (float)g->view->fy;
  lanes inverse_z = lanes_load(g->inverse_z_float), x = lanes_load(g->x), y = lanes_load(g->y);
  g->uz = g->tu[2] * inverse_z;
  g->vz = g->tv[2] * inverse_z;
  g->ux = fx * (g->tu[0] * inverse_z - x * g->uz);
  g->uy = fy * (g->tu[1] * inverse_z - y * g->uz);
  g->vx = fx * (g->tv[0] * inverse_z - x * g->vz);
  g->vy = fy * (g->tv[1] * inverse_z - y * g->vz);
  g->area = g->ux * g->vy - g->uy * g->vx;
}

/* Lanes that are still usual, and in which the mask holds (`held` 1) or does not (0), become `state`. Returns whether
 * any is usual afterwards. */
CONIC_INLINE int move_state(group *g, lanes_mask mask, int held, int32_t state) {
  float marks[CONIC_LANES];
  int n_usual = 0;
  lanes_store(marks, lanes_keep(mask, lanes_of(1.0f)));
  for (int l = 0; l < CONIC_LANES; l++) {
    g->state[l] = g->state[l] == GROUP_USUAL && (marks[l] != 0.0f) == held ? state : g->state[l];
    n_usual += g->state[l] == GROUP_USUAL;
  }
  return n_usual;
}

CONIC_INLINE lanes absolute(lanes value) {
  return (lanes)((int_lanes)value & 0x7fffffff);
}

/* dual_conic of project.c; a cutoff of 0 with w = 1 gives the Jacobian at the centre. */
CONIC_INLINE void dual_conic_lanes(group *g, float cutoff, lanes w) {
  lanes inverse_w = 1.0f / w;
  float cutoff_squared = cutoff * cutoff;
  lanes tilt = cutoff_squared * (inverse_w * inverse_w);
  g->bx = g->ux * g->uz + g->vx * g->vz;
  g->by = g->uy * g->uz + g->vy * g->vz;
  g->rxx = (g->ux * g->ux + g->vx * g->vx) * inverse_w + tilt * (g->bx * g->bx);
  g->rxy = (g->ux * g->uy + g->vx * g->vy) * inverse_w + tilt * (g->bx * g->by);
  g->ryy = (g->uy * g->uy + g->vy * g->vy) * inverse_w + tilt * (g->by * g->by);
  g->root = absolute(g->area) * (inverse_w * lanes_sqrt(inverse_w));
  lanes_store(g->shift[0], -(cutoff_squared * inverse_w) * g->bx);
  lanes_store(g->shift[1], -(cutoff_squared * inverse_w) * g->by);
  g->inverse_w = inverse_w;
}

/* Where the ray formula may be due; conic_project_one decides. */
CONIC_INLINE lanes_mask wants_ray(const group *g) {
  lanes trace = g->rxx + g->ryy, difference = g->rxx - g->ryy;
  lanes spread = lanes_sqrt(difference * difference + 4.0f * (g->rxy * g->rxy));
  lanes smaller = 2.0f * (g->root * g->root) / (trace + spread);
  lanes_mask thick = lanes_at_least(smaller, lanes_of(0.25f));
  if (g->view->method == CONIC_METHOD_RAY)
    return thick;
  return thick & lanes_at_least(lanes_load(g->reach), lanes_of(0.25f));
}

CONIC_INLINE void widen(group *g) {
  float h = g->view->prefilter;
  g->vxx = g->rxx + h;
  g->vyy = g->ryy + h;
  g->determinant = (g->root * g->root + h * (g->rxx + g->ryy)) + h * h;
  lanes_store(g->half[0], g->view->cutoff * lanes_sqrt(g->vxx));
  lanes_store(g->half[1], g->view->cutoff * lanes_sqrt(g->vyy));
}

CONIC_INLINE double greater_of(double a, double b) {
  return a > b ? a : b;
}

CONIC_INLINE double lesser_of(double a, double b) {
  return a < b ? a : b;
}

/* The footprint's centre and box along one axis, as pixel_range of project.c; an empty box has its begin not before its
 * end. One thing a loop: that is how compilers vectorise them. */
CONIC_INLINE void place(group *g, int axis, double principal, double focal, int size) {
  double center[CONIC_LANES], low[CONIC_LANES], high[CONIC_LANES], limit = (double)size;
  for (int l = 0; l < CONIC_LANES; l++) {
    double reach = (double)g->half[axis][l] * 1.0001 + 0.01;
    center[l] = (principal + focal * (g->p[axis][l] * g->inverse_z[l])) + (double)g->shift[axis][l];
    low[l] = center[l] - reach + 0.5;
    high[l] = center[l] + reach + 0.5;
  }
  for (int l = 0; l < CONIC_LANES; l++)
    low[l] = lesser_of(greater_of(low[l], 0.0), limit);
  for (int l = 0; l < CONIC_LANES; l++)
    high[l] = greater_of(lesser_of(high[l], limit), 0.0);
  for (int l = 0; l < CONIC_LANES; l++)
    center[l] = lesser_of(greater_of(center[l], -1e9), 1e9);
  for (int l = 0; l < CONIC_LANES; l++) {
    g->begin[axis][l] = (int32_t)low[l];
    g->end[axis][l] = (int32_t)high[l];
    g->center[axis][l] = (int32_t)center[l];
  }
  for (int l = 0; l < CONIC_LANES; l++)
    g->fraction[axis][l] = (float)(((double)g->center[axis][l] + 0.5) - center[l]);
}

CONIC_INLINE void cull_off_screen(group *g) {
  for (int l = 0; l < CONIC_LANES; l++) {
    int is_off = g->begin[0][l] >= g->end[0][l] || g->begin[1][l] >= g->end[1][l];
    g->state[l] = g->state[l] == GROUP_USUAL && is_off ? GROUP_CULLED : g->state[l];
  }
}

/* world_normal of project.c. Returns 0, but NaN where the normal is not finite. */
CONIC_INLINE lanes world_normals(group *g) {
  lanes u[3], v[3];
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = load3((const float *const *)g->splats->tangent_u, g->first, axis);
    v[axis] = load3((const float *const *)g->splats->tangent_v, g->first, axis);
  }
  lanes u_length = lanes_sqrt((u[0] * u[0] + u[1] * u[1]) + u[2] * u[2]);
  lanes v_length = lanes_sqrt((v[0] * v[0] + v[1] * v[1]) + v[2] * v[2]);
  g->longer = lanes_max(u_length, v_length);
  lanes u_scale = 1.0f / u_length, v_scale = 1.0f / v_length;
  for (int axis = 0; axis < 3; axis++) {
    u[axis] *= u_scale;
    v[axis] *= v_scale;
  }
  lanes n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  lanes scale = 1.0f / lanes_sqrt((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]);
  lanes_mask away = lanes_less(lanes_of(0.0f), g->area);
  lanes sign = lanes_select(away, lanes_of(-1.0f), lanes_of(1.0f));
  lanes not_finite = lanes_of(0.0f);
  for (int axis = 0; axis < 3; axis++) {
    g->normal[axis] = sign * (n[axis] * scale);
    not_finite += g->normal[axis] * 0.0f;
  }
  return not_finite;
}

/* The finished records of a group, field by field. */
typedef struct records {
  float s1[CONIC_LANES], s2[CONIC_LANES], s3[CONIC_LANES];
  float iz0[CONIC_LANES], iz_dx[CONIC_LANES], iz_dy[CONIC_LANES], plane_dx[CONIC_LANES], plane_dy[CONIC_LANES];
  float iz_far[CONIC_LANES], iz_near[CONIC_LANES], nearness[CONIC_LANES], amplitude[CONIC_LANES];
  float color[3][CONIC_LANES], normal[3][CONIC_LANES];
} records;

CONIC_INLINE lanes finite_or_zero(lanes value) {
  return lanes_keep(lanes_at_least(value * 0.0f, lanes_of(0.0f)), value);
}

/* Everything of the records but places and boxes; returns 0, but NaN or less in lanes
 * with a field that is not finite or out of range. */
CONIC_INLINE lanes finish_records(group *g, records *r) {
  const conic_view *view = g->view;
  lanes inverse_z = lanes_load(g->inverse_z_float), not_finite = world_normals(g);
  lanes s1 = lanes_sqrt(g->vyy / g->determinant);
  lanes s2 = -(g->rxy / g->vyy) * s1, s3 = 1.0f / lanes_sqrt(g->vyy);
  lanes amplitude = g->root / lanes_sqrt(g->determinant);
  lanes factor = -inverse_z * (g->inverse_w * g->inverse_w), rgx = factor * g->bx, rgy = factor * g->by;
  lanes iz0 = inverse_z * g->inverse_w;
  lanes iz_dx = (g->vyy * rgx - g->rxy * rgy) / g->determinant;
  lanes iz_dy = (g->vxx * rgy - g->rxy * rgx) / g->determinant;
  lanes iz_far = inverse_z / lanes_load(g->farthest), iz_near = inverse_z / lanes_load(g->nearest);
  lanes plane_dx = finite_or_zero(-inverse_z * (g->uz * g->vy - g->uy * g->vz) / g->area);
  lanes plane_dy = finite_or_zero(-inverse_z * (g->ux * g->vz - g->vx * g->uz) / g->area);
  lanes epsilon = lanes_min(view->epsilon_scale * (view->cutoff * g->longer), lanes_of(view->epsilon_cap));
  lanes distance = lanes_load(g->distance);
  lanes nearness = lanes_keep(lanes_less(lanes_of(0.0f), distance), 1.0f / (1.0f + epsilon / distance));
  if (g->splats->opacity) {
    lanes opacity = lanes_load(g->splats->opacity + g->first);
    amplitude *= opacity;
    not_finite -= lanes_keep(lanes_less(lanes_of(CONIC_GREATEST_OPACITY), opacity), lanes_of(1.0f));
  }
  not_finite += (lanes_load(g->fraction[0]) + lanes_load(g->fraction[1])) * 0.0f;
  not_finite += s1 * 0.0f + s2 * 0.0f + s3 * 0.0f + iz0 * 0.0f + iz_dx * 0.0f + iz_dy * 0.0f;
  not_finite += iz_far * 0.0f + iz_near * 0.0f + nearness * 0.0f + amplitude * 0.0f;
  lanes_store(r->s1, s1);
  lanes_store(r->s2, s2);
  lanes_store(r->s3, s3);
  lanes_store(r->iz0, iz0);
  lanes_store(r->iz_dx, iz_dx);
  lanes_store(r->iz_dy, iz_dy);
  lanes_store(r->plane_dx, plane_dx);
  lanes_store(r->plane_dy, plane_dy);
  lanes_store(r->iz_far, iz_far);
  lanes_store(r->iz_near, iz_near);
  lanes_store(r->nearness, nearness);
  lanes_store(r->amplitude, amplitude);
  for (int axis = 0; axis < 3; axis++) {
    lanes color = g->splats->color[axis] ? lanes_load(g->splats->color[axis] + g->first) : lanes_of(1.0f);
    lanes_store(r->color[axis], color);
    lanes_store(r->normal[axis], g->normal[axis]);
    not_finite += color * 0.0f;
    not_finite -= lanes_keep(lanes_less(lanes_of(CONIC_GREATEST_COLOR), absolute(color)), lanes_of(1.0f));
  }
  return not_finite;
}

CONIC_INLINE void write_record(const group *g, const records *r, int l, conic_footprint *to, conic_box *box,
                               conic_surface *surface) {
  to->x = g->center[0][l];
  to->y = g->center[1][l];
  to->dx0 = g->fraction[0][l];
  to->dy0 = g->fraction[1][l];
  to->s1 = r->s1[l];
  to->s2 = r->s2[l];
  to->s3 = r->s3[l];
  to->iz0 = r->iz0[l];
  to->iz_dx = r->iz_dx[l];
  to->iz_dy = r->iz_dy[l];
  to->plane_dx = r->plane_dx[l];
  to->plane_dy = r->plane_dy[l];
  to->iz_far = r->iz_far[l];
  to->iz_near = r->iz_near[l];
  to->nearness = r->nearness[l];
  to->amplitude = r->amplitude[l];
  box->x_begin = (uint16_t)g->begin[0][l];
  box->x_end = (uint16_t)g->end[0][l];
  box->y_begin = (uint16_t)g->begin[1][l];
  box->y_end = (uint16_t)g->end[1][l];
  for (int axis = 0; axis < 3; axis++) {
    surface->color[axis] = r->color[axis][l];
    surface->normal[axis] = r->normal[axis][l];
  }
  surface->index = (uint32_t)(g->first + (size_t)l);
}

/* Decides what each lane is and fills its record where it is usual. */
CONIC_INLINE void set_up_group(group *g, records *r) {
  const conic_view *view = g->view;
  move_centers(g);
  rotate_lanes(view->rotation_float, (const float *const *)g->splats->tangent_u, g->first, g->tu);
  rotate_lanes(view->rotation_float, (const float *const *)g->splats->tangent_v, g->first, g->tv);
  classify(g);
  shear(g);
  lanes_mask away = lanes_less(lanes_of(0.0f), g->area);
  if (view->cull_back && !move_state(g, away, 1, GROUP_CULLED))
    return;
  if (view->method == CONIC_METHOD_AFFINE)
    dual_conic_lanes(g, 0.0f, lanes_of(1.0f));
  else {
    dual_conic_lanes(g, view->cutoff, lanes_load(g->nearest) * lanes_load(g->farthest));
    move_state(g, wants_ray(g), 1, GROUP_UNUSUAL);
  }
  widen(g);
  move_state(g, lanes_less(lanes_of(0.0f), g->determinant), 0, GROUP_SKIPPED);
  move_state(g, lanes_at_least(g->determinant * 0.0f, lanes_of(0.0f)), 0, GROUP_UNUSUAL);
  place(g, 0, view->cx, view->fx, view->width);
  place(g, 1, view->cy, view->fy, view->height);
  cull_off_screen(g);
  lanes not_finite = finish_records(g, r);
  move_state(g, lanes_at_least(not_finite, lanes_of(0.0f)), 0, GROUP_UNUSUAL);
}

CONIC_INLINE void take_group(const group *g, const records *r, conic_projected *projected, conic_chunk *chunk) {
  for (int l = 0; l < CONIC_LANES; l++) {
    size_t at = chunk->first + chunk->n_drawn;
    switch (g->state[l]) {
    case GROUP_USUAL:
      write_record(g, r, l, &projected->footprints[at], &projected->boxes[at], &projected->surfaces[at]);
      chunk->n_fallback += g->view->method == CONIC_METHOD_RAY;
      chunk->n_drawn++;
      break;
    case GROUP_CULLED:
      chunk->n_culled++;
      break;
    case GROUP_SKIPPED:
      chunk->n_skipped++;
      break;
    default:
      conic_project_one(g->view, g->splats, g->first + (size_t)l, projected, chunk);
    }
  }
}

static void project(const conic_view *view, const conic_splats *splats, size_t i_chunk, conic_projected *projected) {
  conic_chunk *chunk = &projected->chunks[i_chunk];
  size_t end = conic_chunk_begin(splats, i_chunk, projected);
  group g = {.view = view, .splats = splats, .first = chunk->first};
  records r;
  for (; g.first + CONIC_LANES <= end; g.first += CONIC_LANES) {
    set_up_group(&g, &r);
    take_group(&g, &r, projected, chunk);
  }
  for (size_t i = g.first; i < end; i++)
    conic_project_one(view, splats, i, projected, chunk);
}
