/* Whether a splat covers a block's 16 pixels, with what weight, and how deep: in every lane the same operations in the
 * same order as raster/tiles/coverage.h and core/splats/kernel.h have. What does not concern a lane is masked by selection. */

typedef struct lanes_fragment {
  lanes q, iz, plane_iz, scale;
  int16 is_covered;
} lanes_fragment;

/* A splat on one row of blocks. */
typedef struct lanes_row {
  lanes dy, q_offset, q_rest, iz_offset, plane_offset;
} lanes_row;

static lanes lanes_clamp_iz(__global const conic_footprint *footprint, lanes iz) {
  iz = iz > footprint->iz_far ? iz : footprint->iz_far;
  return iz < footprint->iz_near ? iz : footprint->iz_near;
}

static lanes_row lanes_row_begin(__global const conic_footprint *footprint, int y) {
  lanes_row row;
  row.dy = (((float)y + LANE_ROWS) - footprint->y) + footprint->dy0;
  lanes minor = footprint->s3 * row.dy;
  row.q_offset = footprint->s2 * row.dy;
  row.q_rest = minor * minor;
  row.iz_offset = footprint->iz0 + footprint->iz_dy * row.dy;
  row.plane_offset = footprint->iz0 + footprint->plane_dy * row.dy;
  return row;
}

static int16 lanes_clip_keeps(__global const conic_clip_record *clip, lanes dx, lanes dy) {
  int16 first = (clip->d0[0] + clip->by_y[0] * dy) + clip->by_x[0] * dx >= 0.0f;
  int16 second = (clip->d0[1] + clip->by_y[1] * dy) + clip->by_x[1] * dx >= 0.0f;
  int16 within = (dx >= clip->dx_low) & (dx <= clip->dx_high) & (dy >= clip->dy_low) & (dy <= clip->dy_high);
  return (clip->is_or ? first | second : first & second) & within;
}

/* conic_ray_fragment */
static void lanes_ray_fragment(const conic_view *view, __global const conic_footprint *footprint,
                               __global const conic_ray *ray, lanes dx, lanes dy, lanes_fragment *fragment) {
  lanes iz = (footprint->iz0 + footprint->iz_dy * dy) + footprint->iz_dx * dx;
  int16 is_covered = (iz > 0.0f) & (iz >= ray->iz_low) & (iz <= ray->iz_high) & (dx >= ray->dx_low) &
                     (dx <= ray->dx_high) & (dy >= ray->dy_low) & (dy <= ray->dy_high);
  lanes r = 1.0f / iz;
  lanes u = ((ray->u0 + ray->u_dy * dy) + ray->u_dx * dx) * r;
  lanes v = ((ray->v0 + ray->v_dy * dy) + ray->v_dx * dx) * r;
  lanes u_x = (ray->u_dx - u * footprint->iz_dx) * r, u_y = (ray->u_dy - u * footprint->iz_dy) * r;
  lanes v_x = (ray->v_dx - v * footprint->iz_dx) * r, v_y = (ray->v_dy - v * footprint->iz_dy) * r;
  float h = view->prefilter;
  lanes s_uu = 1.0f + h * (u_x * u_x + u_y * u_y);
  lanes s_vv = 1.0f + h * (v_x * v_x + v_y * v_y);
  lanes s_uv = h * (u_x * v_x + u_y * v_y);
  lanes area = u_x * v_y - u_y * v_x;
  lanes determinant = (s_uu + s_vv - 1.0f) + (h * area) * (h * area);
  lanes along = u * s_uv - v * s_uu, inverse = 1.0f / (s_uu * determinant);
  fragment->q = ((u * u) * determinant + along * along) * inverse;
  fragment->iz = lanes_clamp_iz(footprint, iz);
  fragment->plane_iz = iz;
  fragment->scale = sqrt(s_uu * inverse);
  fragment->is_covered = is_covered & (fragment->q < view->support);
}

/* Lane by lane, by the shared text: such splats are few. */
static void lanes_laplace_fragment(const conic_view *view, __global const conic_footprint *footprint,
                                   __global const conic_ray *ray, lanes dx, lanes dy, lanes_fragment *fragment) {
  conic_footprint own_footprint = *footprint;
  conic_ray own_ray = *ray;
  for (int lane = 0; lane < 16; lane++) {
    conic_fragment at = {0, 0, 0, 0};
    int is_covered = conic_laplace_fragment(view, &own_footprint, &own_ray, ((const float *)&dx)[lane],
                                            ((const float *)&dy)[lane], &at);
    ((float *)&fragment->q)[lane] = at.q;
    ((float *)&fragment->iz)[lane] = at.iz;
    ((float *)&fragment->plane_iz)[lane] = at.plane_iz;
    ((float *)&fragment->scale)[lane] = at.scale;
    ((int *)&fragment->is_covered)[lane] = is_covered ? -1 : 0;
  }
}

/* conic_fragment_at, for the block whose first pixel has column x. `clip` is only read where there are clip lines. */
static void lanes_fragment_at(const conic_view *view, __global const conic_footprint *footprint,
                              __global const conic_ray *ray, __global const conic_clip_record *clip,
                              const lanes_row *row, int x, lanes_fragment *fragment) {
  lanes dx = (((float)x + LANE_COLUMNS) - footprint->x) + footprint->dx0;
  if (footprint->s3 == 0.0f) {
    if (footprint->s2 != 0.0f) /* conic_is_laplace */
      lanes_laplace_fragment(view, footprint, ray, dx, row->dy, fragment);
    else
      lanes_ray_fragment(view, footprint, ray, dx, row->dy, fragment);
  } else {
    lanes major = footprint->s1 * dx + row->q_offset;
    fragment->q = major * major + row->q_rest;
    fragment->iz = lanes_clamp_iz(footprint, row->iz_offset + footprint->iz_dx * dx);
    fragment->plane_iz = row->plane_offset + footprint->plane_dx * dx;
    fragment->scale = 1.0f;
    fragment->is_covered = fragment->q < view->support;
  }
  if (signbit(footprint->s3))
    fragment->is_covered &= lanes_clip_keeps(clip, dx, row->dy);
}

static lanes lanes_seen_iz(const lanes_fragment *fragment) {
  return fragment->plane_iz > fragment->iz ? fragment->plane_iz : fragment->iz;
}

static lanes lanes_offset_iz(__global const conic_footprint *footprint, const lanes_fragment *fragment) {
  return footprint->nearness * (fragment->plane_iz < fragment->iz ? fragment->plane_iz : fragment->iz);
}

/* conic_gauss_narrow */
static lanes lanes_gauss_narrow(lanes q) {
  lanes t = q - 1.125f, t2 = t * t, t4 = t2 * t2;
  lanes a = 0x1.23ba94p-1f + -0x1.23ba94p-2f * t, b = 0x1.23ba98p-4f + -0x1.84f89ap-7f * t;
  lanes c = 0x1.84f19cp-10f + -0x1.373c6ep-13f * t, d = 0x1.a3885cp-17f + -0x1.d6063cp-21f * t;
  return (a + t2 * b) + t4 * (c + t2 * d);
}

/* conic_kernel_confetti */
static lanes lanes_kernel_confetti(const conic_kernel *kernel, lanes q) {
  lanes r = sqrt(q) / kernel->b, power = r;
  for (int i = 1; i < kernel->n; i++)
    power *= r;
  lanes rest = 1.0f - power, value = lanes_exp_negative(-kernel->a * power / rest);
  return rest > 0.0f ? value : 0.0f;
}

static lanes lanes_kernel_value(const conic_kernel *kernel, lanes q) {
  switch (kernel->type) {
  case CONIC_KERNEL_CONFETTI:
    return lanes_kernel_confetti(kernel, q);
  case CONIC_KERNEL_HAT:
    return 1.0f - sqrt(q) / kernel->cutoff;
  case CONIC_KERNEL_BOX:
    return 1.0f;
  default:
    return conic_kernel_is_narrow(kernel) ? lanes_gauss_narrow(q) : lanes_exp_negative(-0.5f * q);
  }
}

/* conic_final_weight */
static lanes lanes_final_weight(const conic_view *view, __global const conic_footprint *footprint, lanes q,
                                lanes scale) {
  lanes weight = (footprint->amplitude * scale) * lanes_kernel_value(&view->kernel, q);
  return weight > CONIC_LEAST_WEIGHT ? weight : CONIC_LEAST_WEIGHT;
}
