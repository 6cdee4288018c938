/* The raster a tile a work-item, a block's 16 pixels a vector: for CPUs. The same operations in the same order in every lane
 * as coverage.h, raster/resolve.c and raster/shade.c have; what does not concern a lane is masked by selection. */

/* So many references ahead records are called for. */
#define LANES_AHEAD 12

#define N_TILE_BLOCKS 16 /* of a tile: 4 × 4 */

typedef float16 lanes;

/* A lane's column and row in its block. */
#define LANE_COLUMNS ((lanes)(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3))
#define LANE_ROWS ((lanes)(0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3))

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
  return clip->is_or ? first | second : first & second;
}

/* conic_ray_fragment */
static void lanes_ray_fragment(const conic_view *view, __global const conic_footprint *footprint, __global const conic_ray *ray, lanes dx,
                               lanes dy, lanes_fragment *fragment) {
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
  lanes along = u * s_uv - v * s_uu;
  fragment->q = u * u / s_uu + along * along / (s_uu * determinant);
  fragment->iz = lanes_clamp_iz(footprint, iz);
  fragment->plane_iz = iz;
  fragment->scale = 1.0f / sqrt(determinant);
  fragment->is_covered = is_covered & (fragment->q < view->support);
}

/* conic_fragment_at, for the block whose first pixel has column x. `clip` is only read where there are clip lines. */
static void lanes_fragment_at(const conic_view *view, __global const conic_footprint *footprint, __global const conic_ray *ray,
                              __global const conic_clip_record *clip, const lanes_row *row, int x, lanes_fragment *fragment) {
  lanes dx = (((float)x + LANE_COLUMNS) - footprint->x) + footprint->dx0;
  if (footprint->s3 == 0.0f) {
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

/* conic_exp_negative */
static lanes lanes_exp_negative(lanes x) {
  x = x > -80.0f ? x : -80.0f;
  int16 k = convert_int16(x * 0x1.715476p+0f - 0.5f);
  lanes k_float = convert_float16(k);
  lanes r = (x - k_float * 0x1.63p-1f) + k_float * 0x1.bd0106p-13f;
  lanes p = 0x1.6a23cap-10f;
  p = p * r + 0x1.123a20p-7f;
  p = p * r + 0x1.5558f2p-5f;
  p = p * r + 0x1.555492p-3f;
  p = p * r + 0x1.fffffcp-2f;
  p = (p * (r * r) + r) + 1.0f;
  return as_float16(as_int16(p) + k * (1 << 23));
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
static lanes lanes_final_weight(const conic_view *view, __global const conic_footprint *footprint, lanes q, lanes scale) {
  lanes weight = (footprint->amplitude * scale) * lanes_kernel_value(&view->kernel, q);
  return weight > CONIC_LEAST_WEIGHT ? weight : CONIC_LEAST_WEIGHT;
}

/* --- a tile --- */

typedef struct lanes_tile {
  uint index;
  int x, y; /* its first pixel */
  uint first_block;
  int is_at_border; /* pixels of it are outside of the image */
  int width, height;
} lanes_tile;

static lanes_tile lanes_tile_of(const conic_device_frame *frame) {
  lanes_tile t;
  t.index = (uint)get_global_id(0);
  t.x = (int)(t.index % (uint)frame->n_tiles_x) * CONIC_DEVICE_TILE;
  t.y = (int)(t.index / (uint)frame->n_tiles_x) * CONIC_DEVICE_TILE;
  t.first_block = (uint)(t.y / 4) * (uint)frame->n_blocks_x + (uint)(t.x / 4);
  t.is_at_border = t.x + CONIC_DEVICE_TILE > frame->width || t.y + CONIC_DEVICE_TILE > frame->height;
  t.width = frame->width;
  t.height = frame->height;
  return t;
}

/* Where block (column, row) of the tile lies in memory that is [block] of the whole image. */
static ulong lanes_block(const lanes_tile *t, const conic_device_frame *frame, uint block) {
  return t->first_block + (ulong)(block / 4) * (ulong)frame->n_blocks_x + block % 4;
}

static int16 lanes_inside(const lanes_tile *t, int x, int y) {
  return ((float)x + LANE_COLUMNS < (float)t->width) & ((float)y + LANE_ROWS < (float)t->height);
}

static uint lanes_sum(int16 ones) {
  int8 a = ones.lo + ones.hi;
  int4 b = a.lo + a.hi;
  int2 c = b.lo + b.hi;
  return (uint)(c.x + c.y);
}

/* A reference's splat. */
typedef struct lanes_splat {
  uint index;
  __global const conic_footprint *footprint;
  __global const conic_ray *ray;          /* of a ray */
  __global const conic_clip_record *clip; /* of one with clip lines */
  uint column_begin, column_last, row_begin, row_last; /* of the tile's blocks */
} lanes_splat;

static void lanes_fetch(__global const conic_device_reference *reference, __global const conic_footprint *footprints,
                        __global const conic_ray *rays, __global const conic_clip_record *clips, lanes_splat *splat) {
  uint blocks = reference->blocks;
  splat->index = reference->footprint;
  splat->footprint = &footprints[splat->index];
  splat->ray = splat->footprint->s3 == 0.0f ? &rays[splat->footprint->i_ray] : 0;
  splat->clip = &clips[splat->index];
  splat->column_begin = blocks & 15;
  splat->column_last = blocks >> 4 & 15;
  splat->row_begin = blocks >> 8 & 15;
  splat->row_last = blocks >> 12;
}

/* Whether any lane is -1. */
static int lanes_any(int16 mask) {
  int8 a = mask.lo | mask.hi;
  int4 b = a.lo | a.hi;
  long2 c = as_long2(b);
  return (c.x | c.y) != 0;
}

/* Its fragments in block (column, row) of the tile; 0 where it covers none of its pixels. */
static int lanes_cover(const conic_view *view, const lanes_tile *t, const lanes_splat *splat, const lanes_row *row,
                       uint column, uint i_row, lanes_fragment *fragment) {
  int x = t->x + 4 * (int)column;
  lanes_fragment_at(view, splat->footprint, splat->ray, splat->clip, row, x, fragment);
  if (t->is_at_border)
    fragment->is_covered &= lanes_inside(t, x, t->y + 4 * (int)i_row);
  return lanes_any(fragment->is_covered);
}

/* What each pass reads of a splat. */
#define LANES_CALL_FOOTPRINT(splat) CONIC_FETCH_AHEAD(&footprints[splat])
#define LANES_CALL_BOTH(splat)                                                                                         \
  {                                                                                                                    \
    uint called = splat;                                                                                               \
    CONIC_FETCH_AHEAD(&footprints[called]);                                                                            \
    CONIC_FETCH_AHEAD(&surfaces[called]);                                                                              \
  }

/* Goes through the tile's splats in order and, of each, through the blocks that it covers. The body sees `splat`,
 * `fragment`, `block`, `column` and `i_row`. */
#define LANES_FOR_FRAGMENTS(LANES_CALL, body)                                                                                  \
  for (ulong i = tile_begin[t.index]; i < tile_begin[t.index + 1]; i++) {                                              \
    lanes_splat splat;                                                                                                 \
    LANES_CALL(references[min(i + LANES_AHEAD, tile_begin[t.index + 1] - 1)].footprint);                                                                 \
    lanes_fetch(&references[i], footprints, rays, clips, &splat);                                                      \
    for (uint i_row = splat.row_begin; i_row <= splat.row_last; i_row++) {                                             \
      lanes_row row = lanes_row_begin(splat.footprint, t.y + 4 * (int)i_row);                                         \
      for (uint column = splat.column_begin; column <= splat.column_last; column++) {                                  \
        uint block = 4 * i_row + column;                                                                               \
        lanes_fragment fragment;                                                                                       \
        if (lanes_cover(&view, &t, &splat, &row, column, i_row, &fragment)) {                                          \
          body                                                                                                         \
        }                                                                                                              \
      }                                                                                                                \
    }                                                                                                                  \
  }

/* Pass 1 */
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void lanes_visibility(GATHER_RECORDS,
                                                                              __global lanes *thresholds,
                                                                              __global uint *n_fragments) {
  conic_view view = *frame_view;
  conic_device_frame frame = *frame_constants;
  lanes_tile t = lanes_tile_of(&frame);
  lanes threshold[N_TILE_BLOCKS];
  int16 found = 0;
  for (uint block = 0; block < N_TILE_BLOCKS; block++)
    threshold[block] = frame.is_first ? (lanes)0.0f : thresholds[lanes_block(&t, &frame, block)];
  LANES_FOR_FRAGMENTS(LANES_CALL_FOOTPRINT, {
    lanes offset_iz = lanes_offset_iz(splat.footprint, &fragment);
    threshold[block] = (fragment.is_covered & (offset_iz > threshold[block])) ? offset_iz : threshold[block];
    found -= fragment.is_covered;
  })
  for (uint block = 0; block < N_TILE_BLOCKS; block++)
    thresholds[lanes_block(&t, &frame, block)] = threshold[block];
  n_fragments[t.index] = lanes_sum(found);
}

/* The sums of a block, by CONIC_SUM_WEIGHT …; and whose fragment was the heaviest or nearest of this part. */
typedef struct lanes_sums {
  lanes values[CONIC_N_SUMS];
  int16 taken; /* -1: none */
} lanes_sums;

static void lanes_blend(const conic_view *view, __global const conic_footprint *footprint, __global const conic_surface *surface,
                        uint i_footprint, const lanes_fragment *fragment, int16 is_visible, lanes_sums *s) {
  lanes weight = lanes_final_weight(view, footprint, fragment->q, fragment->scale);
  weight = is_visible ? weight : 0.0f; /* what a finite colour makes of that adds nothing, not even a sign */
  s->values[CONIC_SUM_WEIGHT] += weight;
  for (int axis = 0; axis < 3; axis++) {
    s->values[CONIC_SUM_COLOR + axis] += weight * surface->color[axis];
    s->values[CONIC_SUM_NORMAL + axis] += weight * surface->normal[axis];
  }
  int16 is_heaviest = s->values[CONIC_SUM_HEAVIEST_WEIGHT] < weight;
  s->values[CONIC_SUM_HEAVIEST_WEIGHT] = is_heaviest ? weight : s->values[CONIC_SUM_HEAVIEST_WEIGHT];
  s->taken = is_heaviest ? (int16)(int)i_footprint : s->taken;
}

static void lanes_count(__global const conic_surface *surface, const lanes_fragment *fragment, int16 is_visible, lanes_sums *s) {
  int16 is_nearest = is_visible & (s->values[CONIC_SUM_NEAREST_IZ] < fragment->iz);
  s->values[CONIC_SUM_COUNT] = as_float16(as_int16(s->values[CONIC_SUM_COUNT]) - is_visible);
  s->values[CONIC_SUM_NEAREST_IZ] = is_nearest ? fragment->iz : s->values[CONIC_SUM_NEAREST_IZ];
  s->values[CONIC_SUM_ID] =
      as_float16(is_nearest ? (int16)(int)surface->index : as_int16(s->values[CONIC_SUM_ID]));
}

/* The mean of a block's normals, and its length. */
static lanes lanes_mean_normal(const lanes_sums *s, lanes mean[3]) {
  lanes part = 1.0f / s->values[CONIC_SUM_WEIGHT];
  for (int axis = 0; axis < 3; axis++)
    mean[axis] = s->values[CONIC_SUM_NORMAL + axis] * part;
  return sqrt((mean[0] * mean[0] + mean[1] * mean[1]) + mean[2] * mean[2]);
}

/* conic_plane_z of the splats taken, in the lanes that have one. */
static lanes lanes_plane_z(__global const conic_footprint *footprints, int16 taken, int x, int y) {
  lanes fields[16];
  for (int lane = 0; lane < 16; lane++) {
    int i_footprint = ((const int *)&taken)[lane];
    __global const float *from = (__global const float *)&footprints[i_footprint < 0 ? 0 : i_footprint];
    for (int field = 0; field < 16; field++)
      ((float *)&fields[field])[lane] = from[field];
  }
  lanes dx = (((float)x + LANE_COLUMNS) - fields[0]) + fields[2], dy = (((float)y + LANE_ROWS) - fields[1]) + fields[3];
  lanes iz = (fields[7] + fields[11] * dy) + fields[10] * dx;
  iz = iz > fields[12] ? iz : fields[12];
  iz = iz < fields[13] ? iz : fields[13];
  return 1.0f / iz;
}

/* What of each pixel's heaviest splat the picture shows beside the sums. Its normal only where the sum has no direction,
 * unless another part of the splats follows. */
static void lanes_keep_heaviest(const conic_device_frame *frame, __global const conic_footprint *footprints,
                                __global const conic_surface *surfaces, int x, int y, lanes_sums *s) {
  int keeps_all = !frame->is_last || frame->keeps_sums;
  int16 is_taken = s->taken >= 0;
  lanes mean[3];
  if (!lanes_any(is_taken))
    return;
  if (keeps_all || frame->planes & 1 << CONIC_PLANE_Z)
    s->values[CONIC_SUM_Z] = is_taken ? lanes_plane_z(footprints, s->taken, x, y) : s->values[CONIC_SUM_Z];
  int16 needs_normal = keeps_all ? is_taken : is_taken & ~(lanes_mean_normal(s, mean) > 0.0f);
  if (!lanes_any(needs_normal))
    return;
  for (int lane = 0; lane < 16; lane++)
    for (int axis = 0; axis < 3 && ((const int *)&needs_normal)[lane]; axis++)
      ((float *)&s->values[CONIC_SUM_HEAVIEST_NORMAL + axis])[lane] =
          surfaces[((const int *)&s->taken)[lane]].normal[axis];
}

static void lanes_begin_sums(const conic_device_frame *frame, const lanes_tile *t, __global const lanes *sums,
                             lanes_sums *of_blocks) {
  for (uint block = 0; block < N_TILE_BLOCKS; block++) {
    __global const lanes *from = sums + lanes_block(t, frame, block) * CONIC_N_SUMS;
    for (int i = 0; i < CONIC_N_SUMS; i++)
      of_blocks[block].values[i] = frame->is_first ? (lanes)0.0f : from[i];
    of_blocks[block].taken = -1;
  }
}

/* --- pass 3 --- */

/* A block's finished pixels. */
typedef struct lanes_pixels {
  lanes rgba[4], normal[3], albedo[3];
} lanes_pixels;

static lanes lanes_dot(const lanes a[3], const lanes b[3]) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

static lanes lanes_at_least_zero(lanes x) {
  return x > 0.0f ? x : 0.0f;
}

static lanes lanes_gloss(lanes x) {
  for (int i = 0; i < 5; i++)
    x *= x;
  return x;
}

/* conic_shade */
static void lanes_shade(const conic_device_frame *frame, const lanes albedo[3], const lanes normal[3],
                        const lanes mean_normal[3], const lanes viewer[3], lanes shaded[3]) {
  lanes light[3], glossy = 0.0f;
  for (int i = 0; i < 3; i++)
    shaded[i] = albedo[i];
  if (frame->shading == CONIC_SHADE_NONE)
    return;
  for (int i = 0; i < 3; i++)
    light[i] = frame->has_light ? (lanes)frame->light[i] : viewer[i];
  lanes towards_light = lanes_dot(normal, light);
  lanes lit = CONIC_AMBIENT + CONIC_DIFFUSE * lanes_at_least_zero(lanes_dot(mean_normal, light));
  if (frame->shading == CONIC_SHADE_PHONG) {
    lanes reflected[3];
    for (int i = 0; i < 3; i++)
      reflected[i] = 2.0f * towards_light * normal[i] - light[i];
    glossy = CONIC_SPECULAR * lanes_gloss(lanes_at_least_zero(lanes_dot(reflected, viewer))) *
             lanes_dot(mean_normal, mean_normal);
    glossy = towards_light > 0.0f ? glossy : 0.0f;
  }
  for (int i = 0; i < 3; i++)
    shaded[i] = albedo[i] * lit + glossy;
}

/* finish_covered and finish_uncovered; dx and dy are the pixels' directions. */
static void lanes_finish_pixels(const conic_device_frame *frame, const lanes_sums *s, lanes dx, lanes dy,
                                lanes_pixels *p) {
  lanes weight = s->values[CONIC_SUM_WEIGHT], part = 1.0f / weight, mean[3], viewer[3], shaded[3];
  int16 is_covered = weight > 0.0f;
  for (int axis = 0; axis < 3; axis++)
    p->albedo[axis] = s->values[CONIC_SUM_COLOR + axis] * part;
  lanes norm = lanes_mean_normal(s, mean), scale = 1.0f / norm;
  for (int axis = 0; axis < 3; axis++)
    p->normal[axis] = norm > 0.0f ? mean[axis] * scale : s->values[CONIC_SUM_HEAVIEST_NORMAL + axis];
  lanes towards = -1.0f / sqrt((dx * dx + dy * dy) + 1.0f);
  for (int i = 0; i < 3; i++) {
    const float *m = frame->world_from_cam[i];
    viewer[i] = ((m[0] * dx + m[1] * dy) + m[2]) * towards;
  }
  lanes_shade(frame, p->albedo, p->normal, mean, viewer, shaded);
  for (int axis = 0; axis < 3; axis++) {
    p->rgba[axis] = is_covered ? shaded[axis] * frame->exposure : frame->background[axis];
    p->albedo[axis] = is_covered ? p->albedo[axis] : 0.0f;
    p->normal[axis] = is_covered ? p->normal[axis] : 0.0f;
  }
  p->rgba[3] = is_covered ? 1.0f : frame->background[3];
}

/* Writes a block's channels pixel by pixel, as far as they are in the image. */
static void lanes_store_pixels(const conic_device_frame *frame, const lanes *channels, int n_channels, int x, int y,
                               __global float *plane) {
  for (int lane = 0; lane < 16; lane++) {
    int px = x + lane / 4, py = y + lane % 4;
    if (px >= frame->width || py >= frame->height)
      continue;
    ulong at = (ulong)py * (ulong)frame->width + (ulong)px;
    for (int channel = 0; channel < n_channels; channel++)
      plane[at * (ulong)n_channels + (ulong)channel] = ((const float *)&channels[channel])[lane];
  }
}

/* One row of a block's four. */
static float4 lanes_pick_row(lanes values, int row) {
  return row == 0 ? values.s048c : row == 1 ? values.s159d : row == 2 ? values.s26ae : values.s37bf;
}

static void lanes_store_row(const lanes *channels, int n_channels, int row, __global float *to) {
  float4 a = lanes_pick_row(channels[0], row);
  if (n_channels == 1) {
    vstore4(a, 0, to);
    return;
  }
  float4 b = lanes_pick_row(channels[1], row), c = lanes_pick_row(channels[2], row);
  if (n_channels == 3) {
    vstore8((float8)(a.x, b.x, c.x, a.y, b.y, c.y, a.z, b.z), 0, to);
    vstore4((float4)(c.z, a.w, b.w, c.w), 0, to + 8);
    return;
  }
  float4 d = lanes_pick_row(channels[3], row);
  vstore16((float16)(a.x, b.x, c.x, d.x, a.y, b.y, c.y, d.y, a.z, b.z, c.z, d.z, a.w, b.w, c.w, d.w), 0, to);
}

/* A block's channels to a plane that the image has. */
static void lanes_store(const conic_device_frame *frame, int plane, const lanes *channels, int n_channels, int x, int y,
                        __global float *to) {
  if (!(frame->planes & 1 << plane))
    return;
  if (x + 4 > frame->width || y + 4 > frame->height) {
    lanes_store_pixels(frame, channels, n_channels, x, y, to);
    return;
  }
  __global float *corner = to + ((ulong)y * (ulong)frame->width + (ulong)x) * (ulong)n_channels;
  ulong stride = (ulong)frame->width * (ulong)n_channels;
  lanes_store_row(channels, n_channels, 0, corner);
  lanes_store_row(channels, n_channels, 1, corner + stride);
  lanes_store_row(channels, n_channels, 2, corner + 2 * stride);
  lanes_store_row(channels, n_channels, 3, corner + 3 * stride);
}

/* Pass 3 of a block; returns how many of its pixels are covered. */
static uint lanes_resolve(const conic_device_frame *frame, const lanes_sums *s, int x, int y, PIXEL_PLANES) {
  lanes_pixels p;
  lanes weight = s->values[CONIC_SUM_WEIGHT];
  int16 is_covered = weight > 0.0f;
  if (lanes_any(is_covered)) {
    float4 dx = vload4(0, columns + x), dy = vload4(0, rows + y); /* there are some of all whole tiles */
    lanes_finish_pixels(frame, s, (lanes)(dx.xxxx, dx.yyyy, dx.zzzz, dx.wwww), (lanes)(dy, dy, dy, dy), &p);
  } else {
    for (int axis = 0; axis < 3; axis++)
      p.normal[axis] = p.albedo[axis] = 0.0f;
    for (int channel = 0; channel < 4; channel++)
      p.rgba[channel] = frame->background[channel];
  }
  lanes z = is_covered ? s->values[CONIC_SUM_Z] : 0.0f;
  lanes count = as_float16(is_covered ? as_int16(s->values[CONIC_SUM_COUNT]) : 0);
  lanes id = as_float16(is_covered ? as_int16(s->values[CONIC_SUM_ID]) : -1); /* CONIC_NO_ID */
  lanes_store(frame, CONIC_PLANE_RGBA, p.rgba, 4, x, y, rgba);
  lanes_store(frame, CONIC_PLANE_NORMAL, p.normal, 3, x, y, normal_plane);
  lanes_store(frame, CONIC_PLANE_ALBEDO, p.albedo, 3, x, y, albedo_plane);
  lanes_store(frame, CONIC_PLANE_WEIGHT, &weight, 1, x, y, weight_plane);
  lanes_store(frame, CONIC_PLANE_Z, &z, 1, x, y, z_plane);
  lanes_store(frame, CONIC_PLANE_COUNT, &count, 1, x, y, (__global float *)count_plane);
  lanes_store(frame, CONIC_PLANE_ID, &id, 1, x, y, (__global float *)id_plane);
  return lanes_sum(-is_covered);
}

/* Of a part of the splats: on with the sums, or the picture where it is the last. */
static void lanes_finish(const conic_device_frame *frame, const lanes_tile *t, const lanes_sums *of_blocks,
                         __global lanes *sums, PIXEL_PLANES) {
  uint covered = 0;
  for (uint block = 0; block < N_TILE_BLOCKS; block++) {
    const lanes_sums *s = &of_blocks[block];
    int x = t->x + 4 * (int)(block % 4), y = t->y + 4 * (int)(block / 4);
    if (!frame->is_last || frame->keeps_sums) {
      __global lanes *to = sums + lanes_block(t, frame, block) * CONIC_N_SUMS;
      for (int i = 0; i < CONIC_N_SUMS; i++)
        to[i] = s->values[i];
    }
    if (!frame->is_last || x >= frame->width || y >= frame->height)
      continue;
    covered += lanes_resolve(frame, s, x, y, PIXEL_PLANES_PASSED);
  }
  n_covered[t->index] = covered;
}

/* Pass 2 and, with the last part of the splats, pass 3. */
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void
lanes_accumulate(GATHER_RECORDS, __global const lanes *thresholds, __global lanes *sums, PIXEL_PLANES) {
  conic_view view = *frame_view;
  conic_device_frame frame = *frame_constants;
  lanes_tile t = lanes_tile_of(&frame);
  lanes threshold[N_TILE_BLOCKS];
  lanes_sums of_blocks[N_TILE_BLOCKS];
  int keeps_indices = (frame.planes & (1 << CONIC_PLANE_COUNT | 1 << CONIC_PLANE_ID)) != 0;
  for (uint block = 0; block < N_TILE_BLOCKS; block++)
    threshold[block] = thresholds[lanes_block(&t, &frame, block)];
  lanes_begin_sums(&frame, &t, sums, of_blocks);
  LANES_FOR_FRAGMENTS(LANES_CALL_BOTH, {
    int16 is_visible = fragment.is_covered & (lanes_seen_iz(&fragment) >= threshold[block]);
    if (lanes_any(is_visible)) {
      __global const conic_surface *surface = &surfaces[splat.index];
      lanes_blend(&view, splat.footprint, surface, splat.index, &fragment, is_visible, &of_blocks[block]);
      if (keeps_indices)
        lanes_count(surface, &fragment, is_visible, &of_blocks[block]);
    }
  })
  for (uint block = 0; block < N_TILE_BLOCKS; block++)
    lanes_keep_heaviest(&frame, footprints, surfaces, t.x + 4 * (int)(block % 4), t.y + 4 * (int)(block / 4),
                        &of_blocks[block]);
  lanes_finish(&frame, &t, of_blocks, sums, PIXEL_PLANES_PASSED);
}

/* The nearest splats' own sums, in place of those of what was nearest in the parts before. */
static void lanes_take_nearest(const conic_view *view, const conic_device_frame *frame, __global const conic_footprint *footprints,
                               __global const conic_surface *surfaces, const lanes *q, const lanes *scale, int x, int y,
                               lanes_sums *s) {
  for (int lane = 0; lane < 16; lane++) {
    int i_nearest = ((const int *)&s->taken)[lane], is_heaviest;
    if (i_nearest < 0)
      continue;
    conic_footprint footprint = footprints[i_nearest];
    conic_fragment nearest = {((const float *)q)[lane], 0.0f, 0.0f, ((const float *)scale)[lane]};
    gather_sums one = {0};
    gather_blend(view, &footprint, &surfaces[i_nearest], &nearest, &one, &is_heaviest);
    ((float *)&s->values[CONIC_SUM_WEIGHT])[lane] = one.weight;
    for (int axis = 0; axis < 3; axis++) {
      ((float *)&s->values[CONIC_SUM_COLOR + axis])[lane] = one.color[axis];
      ((float *)&s->values[CONIC_SUM_NORMAL + axis])[lane] = one.normal[axis];
    }
    ((float *)&s->values[CONIC_SUM_HEAVIEST_WEIGHT])[lane] = one.heaviest_weight;
    ((uint *)&s->values[CONIC_SUM_COUNT])[lane] = 1;
    ((uint *)&s->values[CONIC_SUM_ID])[lane] = surfaces[i_nearest].index;
  }
  lanes_keep_heaviest(frame, footprints, surfaces, x, y, s);
}

/* In place of both where the nearest splat wins alone. */
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void
lanes_nearest(GATHER_RECORDS, __global uint *n_fragments, __global lanes *sums, PIXEL_PLANES) {
  conic_view view = *frame_view;
  conic_device_frame frame = *frame_constants;
  lanes_tile t = lanes_tile_of(&frame);
  lanes q[N_TILE_BLOCKS], scale[N_TILE_BLOCKS];
  lanes_sums of_blocks[N_TILE_BLOCKS];
  int16 found = 0;
  lanes_begin_sums(&frame, &t, sums, of_blocks);
  LANES_FOR_FRAGMENTS(LANES_CALL_FOOTPRINT, {
    lanes_sums *s = &of_blocks[block];
    int16 is_nearest = fragment.is_covered & (s->values[CONIC_SUM_NEAREST_IZ] < fragment.iz);
    s->values[CONIC_SUM_NEAREST_IZ] = is_nearest ? fragment.iz : s->values[CONIC_SUM_NEAREST_IZ];
    q[block] = is_nearest ? fragment.q : q[block];
    scale[block] = is_nearest ? fragment.scale : scale[block];
    s->taken = is_nearest ? (int16)(int)splat.index : s->taken;
    found -= fragment.is_covered;
  })
  n_fragments[t.index] = lanes_sum(found);
  for (uint block = 0; block < N_TILE_BLOCKS; block++)
    lanes_take_nearest(&view, &frame, footprints, surfaces, &q[block], &scale[block], t.x + 4 * (int)(block % 4),
                       t.y + 4 * (int)(block / 4), &of_blocks[block]);
  lanes_finish(&frame, &t, of_blocks, sums, PIXEL_PLANES_PASSED);
}
