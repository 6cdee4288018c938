/* Set-up in lanes: project_splat (raster/project/project_splats.c) for a group of splats at once, with the same
 * operations in the same order. What is not usual (near the camera, not finite) is left to the plain text. C and
 * OpenCL C share this text. Who includes it has the words of core/lanes, the columns POSITION … OPACITY, and `batch`
 * of n splats' `columns` and `index`, with batch_column(batch, column, at) and batch_index(batch, at): the values of
 * the group that begins at place `at`.
 */

/* Lets the last splat stand in the spare lanes of its group too; returns where that ends. */
static size_t fill_last_group(batch *last) {
  size_t end = (last->n + CONIC_LANES - 1) / CONIC_LANES * CONIC_LANES;
  for (size_t spare = last->n; spare < end; spare++) {
    last->index[spare] = last->index[last->n - 1];
    for (int column = 0; column < N_COLUMNS; column++)
      last->columns[column][spare] = last->columns[column][last->n - 1];
  }
  return end;
}

/* A group's splats in camera space. */
typedef struct group_splats {
  doubles p[3], inverse_z;
  lanes tu[3], tv[3];
  lanes inverse_z_float, x, y; /* p_x/p_z, p_y/p_z */
  lanes reach_z, reach, nearest, farthest;
  lanes ux, uy, uz, vx, vy, vz; /* sheared to the centre, over p_z, in pixels */
  lanes area;
  lanes_mask usual; /* finite, and wholly before near */
  lanes_mask behind;
} group_splats;

CONIC_INLINE void load_columns(const batch *from, int column, size_t at, lanes result[3]) {
  for (int axis = 0; axis < 3; axis++)
    result[axis] = batch_column(from, column + axis, at);
}

CONIC_INLINE void rotate_lanes(const float m[3][3], const lanes v[3], lanes result[3]) {
  for (int row = 0; row < 3; row++)
    result[row] = (m[row][0] * v[0] + m[row][1] * v[1]) + m[row][2] * v[2];
}

CONIC_INLINE void move_centers(const conic_view *view, const lanes position[3], group_splats *g) {
  for (int half = 0; half < 2; half++) {
    wide x = half_of(position[0], half), y = half_of(position[1], half), z = half_of(position[2], half);
    for (int row = 0; row < 3; row++) {
      const double *m = view->rotation[row];
      g->p[row].half[half] = ((m[0] * x + m[1] * y) + m[2] * z) + view->translation[row];
    }
  }
}

/* Which lanes are wholly before near, and the measures relative to p_z. */
CONIC_INLINE void classify(const conic_view *view, group_splats *g) {
  doubles x, y, reach, nearest, farthest, before, ahead, zero;
  g->reach_z = view->cutoff * lanes_sqrt(g->tu[2] * g->tu[2] + g->tv[2] * g->tv[2]);
  for (int half = 0; half < 2; half++) {
    wide z = g->p[2].half[half], r = half_of(g->reach_z, half), inverse = 1.0 / z;
    g->inverse_z.half[half] = inverse;
    zero.half[half] = (((g->p[0].half[half] + g->p[1].half[half]) + z) + r) * 0.0;
    before.half[half] = z - r;
    ahead.half[half] = z + r;
    reach.half[half] = r * inverse;
    nearest.half[half] = (z - r) * inverse;
    farthest.half[half] = (z + r) * inverse;
    x.half[half] = g->p[0].half[half] * inverse;
    y.half[half] = g->p[1].half[half] * inverse;
  }
  g->reach = lanes_narrow(&reach);
  g->nearest = lanes_narrow(&nearest);
  g->farthest = lanes_narrow(&farthest);
  g->inverse_z_float = lanes_narrow(&g->inverse_z);
  g->x = lanes_narrow(&x);
  g->y = lanes_narrow(&y);
  lanes_mask finite = lanes_greater_double(&zero, -1.0);
  g->usual = finite & lanes_greater_double(&before, view->near_z);
  g->behind = finite & lanes_not(lanes_greater_double(&ahead, view->near_z));
}

CONIC_INLINE void shear(const conic_view *view, group_splats *g) {
  float fx = (float)view->fx, fy = (float)view->fy;
  g->uz = g->tu[2] * g->inverse_z_float;
  g->vz = g->tv[2] * g->inverse_z_float;
  g->ux = fx * (g->tu[0] * g->inverse_z_float - g->x * g->uz);
  g->uy = fy * (g->tu[1] * g->inverse_z_float - g->y * g->uz);
  g->vx = fx * (g->tv[0] * g->inverse_z_float - g->x * g->vz);
  g->vy = fy * (g->tv[1] * g->inverse_z_float - g->y * g->vz);
  g->area = g->ux * g->vy - g->uy * g->vx;
}

CONIC_INLINE void look_at(const conic_view *view, const lanes position[3], const lanes tu[3], const lanes tv[3],
                          group_splats *g) {
  move_centers(view, position, g);
  rotate_lanes(view->rotation_float, tu, g->tu);
  rotate_lanes(view->rotation_float, tv, g->tv);
  classify(view, g);
  shear(view, g);
}

/* Which splats surely face away, by their plane and the eye in the world: cheaper than the camera's own decision,
 * area > 0, which is p·(t_u × t_v) over p_z³, and which falls the same way for what is far enough from edge-on, from
 * the eye, from 90° off the axis and from the ends of float's range. What is not sure stays. */
CONIC_INLINE lanes_mask surely_faces_away(const conic_view *view, const lanes position[3], const lanes u[3],
                                          const lanes v[3]) {
  const float least_sine = 1e-3f, least_cosine = 1e-2f, least_size = 1e-15f, greatest_size = 1e6f;
  lanes p[3];
  for (int axis = 0; axis < 3; axis++)
    p[axis] = position[axis] - view->eye[axis];
  lanes distance = lanes_absolute(p[0]) + lanes_absolute(p[1]) + lanes_absolute(p[2]);
  lanes u_size = lanes_absolute(u[0]) + lanes_absolute(u[1]) + lanes_absolute(u[2]);
  lanes v_size = lanes_absolute(v[0]) + lanes_absolute(v[1]) + lanes_absolute(v[2]);
  lanes depth =
      view->rotation_float[2][0] * p[0] + view->rotation_float[2][1] * p[1] + view->rotation_float[2][2] * p[2];
  lanes along =
      p[0] * (u[1] * v[2] - u[2] * v[1]) + p[1] * (u[2] * v[0] - u[0] * v[2]) + p[2] * (u[0] * v[1] - u[1] * v[0]);
  lanes_mask sure = lanes_less(lanes_of(view->nearest_sure), distance) & lanes_less(distance, lanes_of(1e15f)) &
                    lanes_less(least_cosine * distance, depth);
  sure &= lanes_less(least_size * distance, lanes_min(u_size, v_size)) &
          lanes_less(lanes_max(u_size, v_size), greatest_size * distance);
  return sure & lanes_less(least_sine * (distance * (u_size * v_size)), along);
}

/* The screen's side of a group. */
typedef struct group_screen {
  lanes bx, by, inverse_w, rxx, rxy, ryy, root, vxx, vyy, determinant;
  lanes_mask by_ray, box_is_exact; /* exact: not a hair wider, since not only the pixel's own q decides in it */
  lanes shift[2], half_width[2], center[2], fraction[2];
  int_lanes begin[2], end[2];
} group_screen;

/* dual_conic of project.c; a cutoff of 0 with w = 1 gives the Jacobian at the centre. */
CONIC_INLINE void dual_conic_lanes(const group_splats *g, float cutoff, lanes w, group_screen *s) {
  lanes inverse_w = 1.0f / w;
  float cutoff_squared = cutoff * cutoff;
  lanes tilt = cutoff_squared * (inverse_w * inverse_w);
  s->bx = g->ux * g->uz + g->vx * g->vz;
  s->by = g->uy * g->uz + g->vy * g->vz;
  s->rxx = (g->ux * g->ux + g->vx * g->vx) * inverse_w + tilt * (s->bx * s->bx);
  s->rxy = (g->ux * g->uy + g->vx * g->vy) * inverse_w + tilt * (s->bx * s->by);
  s->ryy = (g->uy * g->uy + g->vy * g->vy) * inverse_w + tilt * (s->by * s->by);
  s->root = lanes_absolute(g->area) * (inverse_w * lanes_sqrt(inverse_w));
  s->shift[0] = -(cutoff_squared * inverse_w) * s->bx;
  s->shift[1] = -(cutoff_squared * inverse_w) * s->by;
  s->inverse_w = inverse_w;
}

/* is_coarse of project.c. */
CONIC_INLINE lanes_mask are_coarse(const conic_view *view, const group_splats *g, const group_screen *s) {
  float h = view->prefilter;
  lanes square = s->root * s->root;
  lanes determinant = (square + h * (s->rxx + s->ryy)) + h * h, inverse = 1.0f / determinant;
  lanes along = view->cutoff * g->reach;
  lanes moved = (along * along) * square + h * (s->shift[0] * s->shift[0] + s->shift[1] * s->shift[1]);
  return lanes_less(lanes_of(view->auto_limit), (square * inverse) * (moved * inverse));
}

/* Where the ray formula is due: neither edge-on nor tiny. */
CONIC_INLINE lanes_mask want_ray(const conic_view *view, const group_splats *g, const group_screen *s) {
  lanes_mask wants =
      view->method == CONIC_METHOD_AUTO ? are_coarse(view, g, s) : lanes_at_least(g->reach, lanes_of(0.25f));
  if (view->method != CONIC_METHOD_RAY && !lanes_any(wants))
    return wants;
  lanes trace = s->rxx + s->ryy, difference = s->rxx - s->ryy;
  lanes spread = lanes_sqrt(difference * difference + 4.0f * (s->rxy * s->rxy));
  lanes smaller = 2.0f * (s->root * s->root) / (trace + spread);
  lanes_mask thick = lanes_at_least(smaller, lanes_of(view->thin));
  return view->method == CONIC_METHOD_RAY ? thick : thick & wants;
}

CONIC_INLINE void widen(const conic_view *view, group_screen *s) {
  float h = view->prefilter;
  s->vxx = s->rxx + h;
  s->vyy = s->ryy + h;
  s->determinant = (s->root * s->root + h * (s->rxx + s->ryy)) + h * h;
  s->half_width[0] = view->cutoff * lanes_sqrt(s->vxx);
  s->half_width[1] = view->cutoff * lanes_sqrt(s->vyy);
  if (!lanes_any(s->by_ray))
    return;
  lanes outline[2] = {view->cutoff * lanes_sqrt(s->rxx) + view->growth_px,
                      view->cutoff * lanes_sqrt(s->ryy) + view->growth_px};
  for (int axis = 0; axis < 2; axis++)
    s->half_width[axis] = lanes_select(s->by_ray, outline[axis], s->half_width[axis]);
}

/* The footprint's reference and box along one axis, as pixel_range of project.c; an empty box has its begin not before
 * its end. A ray's reference is the projected p, a variance's its own centre. */
CONIC_INLINE void place(const group_splats *g, int axis, double principal, double focal, int size, group_screen *s) {
  doubles center, low, high, fraction;
  wide zero = wide_of(0.0), limit = wide_of((double)size);
  lanes to_reference = lanes_select(s->by_ray, lanes_of(0.0f), s->shift[axis]);
  /* In double a factor of 1.0001: not as float times 1 and a float's 1.0001. */
  lanes is_exact = lanes_keep(s->box_is_exact, lanes_of(1.0f));
  for (int half = 0; half < 2; half++) {
    wide exact = half_of(is_exact, half), half_width = half_of(s->half_width[axis], half);
    wide reach = half_width * (1.0001 - exact * (1.0001 - 1.0)) + (0.01 - exact * 0.01);
    wide p = principal + focal * (g->p[axis].half[half] * g->inverse_z.half[half]);
    wide middle = p + half_of(s->shift[axis], half), reference = p + half_of(to_reference, half);
    low.half[half] = wide_min(wide_max(middle - reach + 0.5, zero), limit);
    high.half[half] = wide_max(wide_min(middle + reach + 0.5, limit), zero);
    center.half[half] = wide_min(wide_max(reference, wide_of(-1e9)), wide_of(1e9));
  }
  s->begin[axis] = lanes_truncate(&low);
  s->end[axis] = lanes_truncate(&high);
  s->center[axis] = lanes_of_ints(lanes_truncate(&center));
  for (int half = 0; half < 2; half++)
    fraction.half[half] = (half_of(s->center[axis], half) + 0.5) - center.half[half];
  s->fraction[axis] = lanes_narrow(&fraction);
}

/* world_normal of project.c. Returns 0, but NaN where the normal is not finite. */
CONIC_INLINE lanes world_normals(const lanes tu[3], const lanes tv[3], lanes area, lanes normal[3], lanes *longer) {
  lanes u[3], v[3];
  lanes u_length = lanes_sqrt((tu[0] * tu[0] + tu[1] * tu[1]) + tu[2] * tu[2]);
  lanes v_length = lanes_sqrt((tv[0] * tv[0] + tv[1] * tv[1]) + tv[2] * tv[2]);
  *longer = lanes_max(u_length, v_length);
  lanes u_scale = 1.0f / u_length, v_scale = 1.0f / v_length;
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = tu[axis] * u_scale;
    v[axis] = tv[axis] * v_scale;
  }
  lanes n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  lanes scale = 1.0f / lanes_sqrt((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]);
  lanes_mask away = lanes_less(lanes_of(0.0f), area);
  lanes sign = lanes_select(away, lanes_of(-1.0f), lanes_of(1.0f));
  lanes not_finite = lanes_of(0.0f);
  for (int axis = 0; axis < 3; axis++) {
    normal[axis] = sign * (n[axis] * scale);
    not_finite += normal[axis] * 0.0f;
  }
  return not_finite;
}

CONIC_INLINE lanes finite_or_zero(lanes value) {
  return lanes_keep(lanes_at_least(value * 0.0f, lanes_of(0.0f)), value);
}

/* The finished records of a group, field by field as they lie in memory. */
typedef struct records {
  lanes footprint[16], surface[8], ray[12];
} records;

/* is_wide of project.c; laplace's have s2 = 1 and s3 = 0, which no other splat has. */
CONIC_INLINE lanes_mask are_wide(const conic_view *view, const group_splats *g, const group_screen *s,
                                 const records *r) {
  lanes slope = lanes_sqrt(r->footprint[10] * r->footprint[10] + r->footprint[11] * r->footprint[11]);
  lanes across_x = (s->half_width[0] + lanes_absolute(s->shift[0])) * (1.0f / (float)view->fx);
  lanes across_y = (s->half_width[1] + lanes_absolute(s->shift[1])) * (1.0f / (float)view->fy);
  lanes change = (g->reach + slope * view->growth_px * lanes_narrow(&g->p[2])) +
                 ((lanes_absolute(g->x) * across_x + lanes_absolute(g->y) * across_y) +
                  0.5f * (across_x * across_x + across_y * across_y));
  lanes_mask is_so = lanes_not(lanes_at_least(lanes_of(CONIC_NARROW_CHANGE), change));
  if (view->method == CONIC_METHOD_AUTO)
    is_so |= s->by_ray & lanes_less(lanes_of(0.0f), r->footprint[5]);
  return is_so;
}

CONIC_INLINE void set_nearness(const conic_view *view, const group_splats *g, const group_screen *s, lanes longer,
                               records *r) {
  doubles distance;
  r->footprint[14] = lanes_of(0.0f);
  if (!view->needs_nearness)
    return;
  for (int half = 0; half < 2; half++) {
    wide x = g->p[0].half[half], y = g->p[1].half[half], z = g->p[2].half[half];
    distance.half[half] = wide_sqrt((x * x + y * y) + z * z);
  }
  lanes epsilon = lanes_min(view->epsilon_scale * (view->cutoff * longer), lanes_of(view->epsilon_cap));
  lanes from_eye = lanes_narrow(&distance);
  r->footprint[14] = lanes_keep(lanes_less(lanes_of(0.0f), from_eye), 1.0f / (1.0f + epsilon / from_eye));
  lanes_mask is_wide =
      are_wide(view, g, s, r) & lanes_less(lanes_of(0.0f), epsilon) & lanes_less(epsilon, lanes_of(HUGE_VALF));
  r->footprint[14] = lanes_select(is_wide, -epsilon, r->footprint[14]);
}

/* Returns 0, but NaN or less in lanes whose colour is not finite or out of range. */
CONIC_INLINE lanes set_surfaces(const batch *from, size_t at, const lanes normal[3], records *r) {
  lanes not_finite = lanes_of(0.0f);
  for (int axis = 0; axis < 3; axis++) {
    lanes color = batch_column(from, COLOR + axis, at);
    r->surface[axis] = color;
    r->surface[3 + axis] = normal[axis];
    not_finite += color * 0.0f;
    not_finite -= lanes_keep(lanes_less(lanes_of(CONIC_GREATEST_COLOR), lanes_absolute(color)), lanes_of(1.0f));
  }
  r->surface[6] = lanes_of_bits(batch_index(from, at));
  r->surface[7] = r->footprint[15];
  return not_finite;
}

/* project_ray_before_near of project.c: the ray's record, and what is other in the footprint's. Its i_ray is set when
 * it is written. */
CONIC_INLINE void set_rays(const group_splats *g, const group_screen *s, records *r, float growth_px,
                           float greatest_iz) {
  lanes zero = lanes_of(0.0f), scale = g->inverse_z_float / g->area;
  lanes plane_dx = r->footprint[10], plane_dy = r->footprint[11], far = r->footprint[12], near = r->footprint[13];
  const lanes of_ray[16] = {[7] = g->inverse_z_float, [8] = plane_dx, [9] = plane_dy, [15] = lanes_of(1.0f)};
  lanes widening = lanes_sqrt(plane_dx * plane_dx + plane_dy * plane_dy) * growth_px;
  lanes high = lanes_min(near + widening, lanes_of(greatest_iz));
  for (int field = 4; field < 16; field++)
    if (field < 10 || field == 15)
      r->footprint[field] = lanes_select(s->by_ray, of_ray[field], r->footprint[field]);
  r->ray[0] = r->ray[3] = zero;
  r->ray[1] = scale * g->vy;
  r->ray[2] = -(scale * g->vx);
  r->ray[4] = -(scale * g->uy);
  r->ray[5] = scale * g->ux;
  r->ray[6] = lanes_max((far - widening) - 0x1p-20f * far, zero);
  r->ray[7] = high + 0x1p-20f * near;
  for (int axis = 0; axis < 2; axis++) {
    r->ray[8 + 2 * axis] = (lanes_of_ints(s->begin[axis]) - s->center[axis]) + s->fraction[axis];
    r->ray[9 + 2 * axis] = (lanes_of_ints(s->end[axis] - 1) - s->center[axis]) + s->fraction[axis];
  }
}

/* is_steep and set_laplace of project.c. */
CONIC_INLINE void set_laplaces(const conic_view *view, const group_splats *g, const group_screen *s, records *r) {
  float h = view->prefilter;
  lanes rxx = g->ux * g->ux + g->vx * g->vx, rxy = g->ux * g->uy + g->vx * g->vy, ryy = g->uy * g->uy + g->vy * g->vy;
  lanes scale = h / ((g->area * g->area + h * (rxx + ryy)) + h * h);
  lanes nx = g->uz * g->vy - g->uy * g->vz, ny = g->ux * g->vz - g->vx * g->uz;
  float limit = CONIC_AUTO_CHANGE * CONIC_AUTO_CHANGE;
  lanes_mask steep = s->by_ray & lanes_less(limit * (g->area * g->area), h * (nx * nx + ny * ny));
  r->footprint[5] = lanes_select(steep, lanes_of(1.0f), r->footprint[5]);
  r->ray[0] = lanes_select(steep, scale * (ryy + h), r->ray[0]);
  r->ray[3] = lanes_select(steep, scale * (rxx + h), r->ray[3]);
  r->ray[6] = lanes_select(steep, -(scale * rxy), r->ray[6]);
}

/* Returns 0, but NaN where the ray's record is not finite. */
CONIC_INLINE lanes check_rays(const group_screen *s, const records *r) {
  lanes not_finite = lanes_of(0.0f);
  for (int field = 0; field < 8 && lanes_any(s->by_ray); field++)
    not_finite += lanes_keep(s->by_ray, r->ray[field] * 0.0f);
  return not_finite;
}

/* set_slope of project.c, where it is due. */
CONIC_INLINE void set_slopes(const conic_view *view, const group_splats *g, const group_screen *s, records *r) {
  lanes inverse_z = g->inverse_z_float;
  lanes dx = finite_or_zero(-inverse_z * (g->uz * g->vy - g->uy * g->vz) / g->area);
  lanes dy = finite_or_zero(-inverse_z * (g->ux * g->vz - g->vx * g->uz) / g->area);
  r->footprint[10] = view->needs_slope ? dx : lanes_keep(s->by_ray, dx);
  r->footprint[11] = view->needs_slope ? dy : lanes_keep(s->by_ray, dy);
}

/* Everything but nearness and the surface; in the order of conic_footprint. Returns 0, but NaN in lanes with a field
 * that is not finite. */
CONIC_INLINE lanes set_footprints(const conic_view *view, const group_splats *g, const group_screen *s, records *r) {
  lanes inverse_z = g->inverse_z_float, not_finite = (s->fraction[0] + s->fraction[1]) * 0.0f;
  lanes factor = -inverse_z * (s->inverse_w * s->inverse_w), rgx = factor * s->bx, rgy = factor * s->by;
  r->footprint[0] = s->center[0];
  r->footprint[1] = s->center[1];
  r->footprint[2] = s->fraction[0];
  r->footprint[3] = s->fraction[1];
  r->footprint[4] = lanes_sqrt(s->vyy / s->determinant);
  r->footprint[5] = -(s->rxy / s->vyy) * r->footprint[4];
  r->footprint[6] = 1.0f / lanes_sqrt(s->vyy);
  r->footprint[7] = inverse_z * s->inverse_w;
  r->footprint[8] = (s->vyy * rgx - s->rxy * rgy) / s->determinant;
  r->footprint[9] = (s->vxx * rgy - s->rxy * rgx) / s->determinant;
  r->footprint[10] = r->footprint[11] = lanes_of(0.0f);
  if (view->needs_slope || lanes_any(s->by_ray))
    set_slopes(view, g, s, r);
  r->footprint[12] = inverse_z / g->farthest;
  r->footprint[13] = inverse_z / g->nearest;
  r->footprint[15] = s->root / lanes_sqrt(s->determinant);
  if (lanes_any(s->by_ray))
    set_rays(g, s, r, view->growth_px, (float)(1.0 / view->near_z));
  for (int field = 4; field < 14; field++)
    not_finite += r->footprint[field] * 0.0f;
  return not_finite;
}

/* project_dot of project.c, up to the box. */
CONIC_INLINE void measure_dots(const conic_view *view, const group_splats *g, group_screen *s) {
  lanes u_length = lanes_sqrt((g->tu[0] * g->tu[0] + g->tu[1] * g->tu[1]) + g->tu[2] * g->tu[2]);
  lanes v_length = lanes_sqrt((g->tv[0] * g->tv[0] + g->tv[1] * g->tv[1]) + g->tv[2] * g->tv[2]);
  lanes radius = view->cutoff * (lanes_max(u_length, v_length) * (view->focal_px * g->inverse_z_float));
  if (view->method == CONIC_METHOD_POINT)
    s->box_is_exact = lanes_at_least(lanes_of(0.0f), lanes_of(0.0f));
  s->half_width[0] = view->method == CONIC_METHOD_POINT ? lanes_of(0.5f) : lanes_max(radius, lanes_of(0.5f));
  s->half_width[1] = s->half_width[0];
  s->shift[0] = s->shift[1] = lanes_of(0.0f);
  s->determinant = lanes_of(1.0f);
}

/* And from the box on: what set_footprints does for ellipses and rays. */
CONIC_INLINE lanes set_dots(const conic_view *view, const group_splats *g, const group_screen *s, records *r) {
  lanes zero = lanes_of(0.0f), scale = view->cutoff / s->half_width[0], inverse_z = g->inverse_z_float;
  const lanes fields[16] = {s->center[0], s->center[1], s->fraction[0], s->fraction[1], scale, zero,
                            scale,        inverse_z,    zero,           zero,           zero,  zero,
                            inverse_z,    inverse_z,    zero,           lanes_of(1.0f)};
  lanes not_finite = ((s->fraction[0] + s->fraction[1]) * 0.0f + scale * 0.0f) + inverse_z * 0.0f;
  for (int field = 0; field < 16; field++)
    r->footprint[field] = fields[field];
  if (view->method == CONIC_METHOD_POINT)
    r->footprint[2] = r->footprint[3] = zero;
  return not_finite - lanes_keep(lanes_at_least(zero, scale), lanes_of(1.0f)); /* 0 would mean a ray */
}

/* What became of a group's lanes; what is in none is culled. */
typedef struct group_verdict {
  lanes_mask usual, unusual, skipped;
} group_verdict;

/* The footprints' sizes on the screen by the formula that is due. */
CONIC_INLINE void measure(const conic_view *view, const group_splats *g, lanes_mask usual, group_screen *s) {
  s->by_ray = s->box_is_exact = lanes_not(lanes_at_least(lanes_of(0.0f), lanes_of(0.0f)));
  if (conic_method_is_dot(view->method)) {
    measure_dots(view, g, s);
    return;
  }
  if (view->method == CONIC_METHOD_AFFINE)
    dual_conic_lanes(g, 0.0f, lanes_of(1.0f), s);
  else {
    dual_conic_lanes(g, view->cutoff, g->nearest * g->farthest, s);
    s->by_ray = s->box_is_exact = usual & want_ray(view, g, s);
  }
  widen(view, s);
}

/* Decides what each lane is and fills its record where it is usual. */
CONIC_INLINE group_verdict set_up_group(const conic_view *view, const batch *from, size_t at, group_screen *s,
                                        records *r) {
  group_splats g;
  group_verdict verdict;
  lanes position[3], tu[3], tv[3], normal[3], longer;
  load_columns(from, POSITION, at, position);
  load_columns(from, TANGENT_U, at, tu);
  load_columns(from, TANGENT_V, at, tv);
  look_at(view, position, tu, tv, &g);
  verdict.usual = g.usual;
  verdict.unusual = lanes_not(g.usual | g.behind);
  if (view->cull_back)
    verdict.usual &= lanes_not(lanes_less(lanes_of(0.0f), g.area));
  measure(view, &g, verdict.usual, s);
  lanes_mask has_area = s->by_ray | lanes_less(lanes_of(0.0f), s->determinant);
  verdict.skipped = verdict.usual & lanes_not(has_area);
  verdict.usual &= has_area;
  place(&g, 0, view->cx, view->fx, view->width, s);
  place(&g, 1, view->cy, view->fy, view->height, s);
  lanes_mask on_screen = lanes_less_int(s->begin[0], s->end[0]) & lanes_less_int(s->begin[1], s->end[1]);
  lanes_mask squares = s->by_ray | lanes_at_least(s->determinant * 0.0f, lanes_of(0.0f));
  lanes not_finite = world_normals(tu, tv, g.area, normal, &longer);
  if (conic_method_is_dot(view->method))
    not_finite += set_dots(view, &g, s, r);
  else
    not_finite += set_footprints(view, &g, s, r);
  if (view->method == CONIC_METHOD_AUTO && lanes_any(s->by_ray))
    set_laplaces(view, &g, s, r);
  set_nearness(view, &g, s, longer, r);
  lanes opacity = batch_column(from, OPACITY, at);
  r->footprint[15] *= opacity;
  not_finite -= lanes_keep(lanes_less(lanes_of(CONIC_GREATEST_OPACITY), opacity), lanes_of(1.0f));
  not_finite += r->footprint[14] * 0.0f + r->footprint[15] * 0.0f;
  not_finite += set_surfaces(from, at, normal, r) + check_rays(s, r);
  /* A determinant that float cannot hold is not culled by a box of float's; conic_project_one takes it on. */
  lanes_mask odd = verdict.usual & lanes_not(squares & lanes_at_least(not_finite, lanes_of(0.0f))) &
                   (on_screen | lanes_not(squares));
  verdict.unusual |= odd;
  verdict.usual &= on_screen & lanes_not(odd);
  s->by_ray &= verdict.usual;
  return verdict;
}
