/* The raster a pixel a work-item, 16 × 16 of them a group: for GPUs. raster/tile_kernels_scalar.c and raster/resolve.c
 * in the same order of arithmetic. */

/* All that a work-item knows of its pixel. */
typedef struct gather_pixel {
  int x, y;
  uint tile;
  uint block, column, row; /* its block in the image; its tile's column and row of blocks that that is */
  uint lane;               /* its place in the block, column by column */
  int is_inside;
} gather_pixel;

static gather_pixel gather_pixel_of(const conic_device_frame *frame) {
  gather_pixel p;
  p.x = (int)get_global_id(0);
  p.y = (int)get_global_id(1);
  p.tile = (uint)(p.y >> CONIC_DEVICE_TILE_BITS) * (uint)frame->n_tiles_x + (uint)(p.x >> CONIC_DEVICE_TILE_BITS);
  p.block = (uint)(p.y / 4) * (uint)frame->n_blocks_x + (uint)(p.x / 4);
  p.column = (uint)(p.x % CONIC_DEVICE_TILE) / 4;
  p.row = (uint)(p.y % CONIC_DEVICE_TILE) / 4;
  p.lane = (uint)(p.x % 4 * 4 + p.y % 4);
  p.is_inside = p.x < frame->width && p.y < frame->height;
  return p;
}

static int gather_meets(uint blocks, const gather_pixel *p) {
  return p->column >= (blocks & 15) && p->column <= (blocks >> 4 & 15) && p->row >= (blocks >> 8 & 15) &&
         p->row <= blocks >> 12;
}

/* conic_fragment_at, with the records in global memory. */
static int gather_fragment(const conic_view *view, const conic_footprint *footprint, uint i_footprint,
                           __global const conic_ray *rays, __global const conic_clip_record *clips,
                           const gather_pixel *p, conic_fragment *fragment) {
  float dx = conic_row_dx(footprint, p->x), dy = conic_row_dy(footprint, p->y);
  if (conic_is_clipped(footprint)) {
    conic_clip_record clip = clips[i_footprint];
    if (!conic_clip_keeps(&clip, dx, dy))
      return 0;
  }
  if (footprint->s3 == 0.0f) {
    conic_ray ray = rays[footprint->i_ray];
    if (conic_is_laplace(footprint))
      return conic_laplace_fragment(view, footprint, &ray, dx, dy, fragment);
    return conic_ray_fragment(view, footprint, &ray, dx, dy, fragment);
  }
  conic_row row = conic_row_begin(footprint, dy);
  fragment->q = conic_row_q(footprint, &row, dx);
  fragment->iz = conic_row_iz(footprint, &row, dx);
  fragment->plane_iz = row.plane_offset + footprint->plane_dx * dx;
  fragment->scale = 1.0f;
  return fragment->q < view->support;
}

static float seen_iz_of(const conic_fragment *fragment) {
  return fragment->plane_iz > fragment->iz ? fragment->plane_iz : fragment->iz;
}

static float offset_iz_of(const conic_footprint *footprint, const conic_fragment *fragment) {
  return footprint->nearness * (fragment->plane_iz < fragment->iz ? fragment->plane_iz : fragment->iz);
}

/* The names that every kernel here has for what it reads. */
#define GATHER_RECORDS                                                                                                 \
  __constant conic_view *frame_view, __constant conic_device_frame *frame_constants, __global const ulong *tile_begin, \
      __global const conic_device_reference *references, __global const conic_footprint *footprints,                   \
      __global const conic_surface *surfaces, __global const conic_ray *rays, __global const conic_clip_record *clips

/* Pass 1: every pixel's threshold, and how many fragments there are. */
__kernel void gather_visibility(GATHER_RECORDS, __global float *thresholds, __global uint *n_fragments) {
  conic_view view = *frame_view;
  conic_device_frame frame = *frame_constants;
  gather_pixel p = gather_pixel_of(&frame);
  uint at = p.block * 16 + p.lane, n_covered = 0;
  float threshold = frame.is_first ? 0.0f : thresholds[at];
  if (!p.is_inside)
    return;
  for (ulong i = tile_begin[p.tile]; i < tile_begin[p.tile + 1]; i++) {
    conic_device_reference reference = references[i];
    if (!gather_meets(reference.blocks, &p))
      continue;
    conic_footprint footprint = footprints[reference.footprint];
    conic_fragment fragment;
    if (!gather_fragment(&view, &footprint, reference.footprint, rays, clips, &p, &fragment))
      continue;
    float offset_iz = offset_iz_of(&footprint, &fragment);
    threshold = offset_iz > threshold ? offset_iz : threshold;
    n_covered++;
  }
  thresholds[at] = threshold;
  if (n_covered)
    atomic_add(&n_fragments[p.tile], n_covered);
}

/* The sums of a pixel; in a single pass, of its nearest splat. */
typedef struct gather_sums {
  float weight, color[3], normal[3], heaviest_weight, nearest_iz, heaviest_normal[3], z;
  uint id, count;
} gather_sums;

static gather_sums gather_load(__global const float *sums, const gather_pixel *p) {
  __global const float *from = sums + (ulong)p->block * 16 * CONIC_N_SUMS + p->lane;
  gather_sums s;
  s.weight = from[16 * CONIC_SUM_WEIGHT];
  for (int axis = 0; axis < 3; axis++) {
    s.color[axis] = from[16 * (CONIC_SUM_COLOR + axis)];
    s.normal[axis] = from[16 * (CONIC_SUM_NORMAL + axis)];
    s.heaviest_normal[axis] = from[16 * (CONIC_SUM_HEAVIEST_NORMAL + axis)];
  }
  s.heaviest_weight = from[16 * CONIC_SUM_HEAVIEST_WEIGHT];
  s.nearest_iz = from[16 * CONIC_SUM_NEAREST_IZ];
  s.z = from[16 * CONIC_SUM_Z];
  s.id = as_uint(from[16 * CONIC_SUM_ID]);
  s.count = as_uint(from[16 * CONIC_SUM_COUNT]);
  return s;
}

static void gather_store(const gather_sums *s, __global float *sums, const gather_pixel *p) {
  __global float *to = sums + (ulong)p->block * 16 * CONIC_N_SUMS + p->lane;
  to[16 * CONIC_SUM_WEIGHT] = s->weight;
  for (int axis = 0; axis < 3; axis++) {
    to[16 * (CONIC_SUM_COLOR + axis)] = s->color[axis];
    to[16 * (CONIC_SUM_NORMAL + axis)] = s->normal[axis];
    to[16 * (CONIC_SUM_HEAVIEST_NORMAL + axis)] = s->heaviest_normal[axis];
  }
  to[16 * CONIC_SUM_HEAVIEST_WEIGHT] = s->heaviest_weight;
  to[16 * CONIC_SUM_NEAREST_IZ] = s->nearest_iz;
  to[16 * CONIC_SUM_Z] = s->z;
  to[16 * CONIC_SUM_ID] = as_float(s->id);
  to[16 * CONIC_SUM_COUNT] = as_float(s->count);
}

/* The surface of a record, without what else of it there is in memory. */
static void gather_blend(const conic_view *view, const conic_footprint *footprint,
                         __global const conic_surface *surface, const conic_fragment *fragment, gather_sums *s,
                         int *is_heaviest) {
  float weight = conic_final_weight(view, footprint, fragment->q, fragment->scale);
  s->weight += weight;
  for (int axis = 0; axis < 3; axis++) {
    s->color[axis] += weight * surface->color[axis];
    s->normal[axis] += weight * surface->normal[axis];
  }
  *is_heaviest = s->heaviest_weight < weight;
  if (*is_heaviest)
    s->heaviest_weight = weight;
}

/* conic_plane_z */
static float gather_plane_z(const conic_footprint *footprint, const gather_pixel *p) {
  float dx = conic_row_dx(footprint, p->x), dy = conic_row_dy(footprint, p->y);
  float iz = (footprint->iz0 + footprint->plane_dy * dy) + footprint->plane_dx * dx;
  return 1.0f / conic_clamp_iz(footprint, iz);
}

/* What of the heaviest splat the picture shows beside the sums. */
static void gather_keep_heaviest(uint i_heaviest, __global const conic_footprint *footprints,
                                 __global const conic_surface *surfaces, const gather_pixel *p, gather_sums *s) {
  conic_footprint footprint = footprints[i_heaviest];
  s->z = gather_plane_z(&footprint, p);
  for (int axis = 0; axis < 3; axis++)
    s->heaviest_normal[axis] = surfaces[i_heaviest].normal[axis];
}

/* The image's planes. */
#define PIXEL_PLANES                                                                                                   \
  __global const float *columns, __global const float *rows, __global float *rgba, __global float *z_plane,            \
      __global float *normal_plane, __global float *albedo_plane, __global float *weight_plane,                        \
      __global uint *count_plane, __global uint *id_plane, __global uint *n_covered

static void viewer_at(const conic_device_frame *frame, float dx, float dy, float viewer[3]) {
  float scale = -1.0f / sqrtf((dx * dx + dy * dy) + 1.0f);
  for (int i = 0; i < 3; i++) {
    const float *m = frame->world_from_cam[i];
    viewer[i] = ((m[0] * dx + m[1] * dy) + m[2]) * scale;
  }
}

static void normal_of_sum(const gather_sums *s, float mean[3], float normal[3]) {
  float part = 1.0f / s->weight;
  for (int axis = 0; axis < 3; axis++)
    mean[axis] = s->normal[axis] * part;
  float norm = sqrtf((mean[0] * mean[0] + mean[1] * mean[1]) + mean[2] * mean[2]);
  float scale = 1.0f / norm;
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = norm > 0.0f ? mean[axis] * scale : s->heaviest_normal[axis];
}

/* The finish that the shared shading reads. */
static void finish_of(const conic_device_frame *frame, conic_render_options *options, conic_finish *finish) {
  options->shading = (conic_shading)frame->shading;
  options->has_light = frame->has_light;
  finish->options = options;
  for (int i = 0; i < 3; i++)
    finish->light[i] = frame->light[i];
}

static void gather_resolve_pixel(const conic_device_frame *frame, const gather_pixel *p, const gather_sums *s,
                                 PIXEL_PLANES) {
  ulong at = (ulong)p->y * (ulong)frame->width + (ulong)p->x;
  int is_covered = s->weight > 0.0f, planes = frame->planes;
  float color[4], normal[3] = {0, 0, 0}, albedo[3] = {0, 0, 0};
  for (int channel = 0; channel < 4; channel++)
    color[channel] = frame->background[channel];
  if (is_covered) {
    conic_render_options options;
    conic_finish finish;
    float viewer[3], mean_normal[3], shaded[3];
    for (int axis = 0; axis < 3; axis++)
      albedo[axis] = s->color[axis] * (1.0f / s->weight);
    normal_of_sum(s, mean_normal, normal);
    viewer_at(frame, columns[p->x], rows[p->y], viewer);
    finish_of(frame, &options, &finish);
    conic_shade(&finish, albedo, normal, mean_normal, viewer, shaded);
    for (int axis = 0; axis < 3; axis++)
      color[axis] = shaded[axis] * frame->exposure;
    color[3] = 1.0f;
    atomic_add(&n_covered[p->tile], 1u);
  }
  for (int channel = 0; channel < 4 && planes & 1 << CONIC_PLANE_RGBA; channel++)
    rgba[at * 4 + channel] = color[channel];
  for (int axis = 0; axis < 3 && planes & 1 << CONIC_PLANE_NORMAL; axis++)
    normal_plane[at * 3 + axis] = normal[axis];
  for (int axis = 0; axis < 3 && planes & 1 << CONIC_PLANE_ALBEDO; axis++)
    albedo_plane[at * 3 + axis] = albedo[axis];
  if (planes & 1 << CONIC_PLANE_WEIGHT)
    weight_plane[at] = s->weight;
  if (planes & 1 << CONIC_PLANE_Z)
    z_plane[at] = is_covered ? s->z : 0.0f;
  if (planes & 1 << CONIC_PLANE_COUNT)
    count_plane[at] = s->count;
  if (planes & 1 << CONIC_PLANE_ID)
    id_plane[at] = is_covered ? s->id : CONIC_NO_ID;
}

#define PIXEL_PLANES_PASSED                                                                                            \
  columns, rows, rgba, z_plane, normal_plane, albedo_plane, weight_plane, count_plane, id_plane, n_covered

/* Of a part of the splats: on with the sums, or the picture where it is the last. */
static void gather_finish(const conic_device_frame *frame, const gather_pixel *p, const gather_sums *s,
                          __global float *sums, PIXEL_PLANES) {
  if (!frame->is_last || frame->keeps_sums)
    gather_store(s, sums, p);
  if (frame->is_last)
    gather_resolve_pixel(frame, p, s, PIXEL_PLANES_PASSED);
}

/* Pass 2 and, with the last part of the splats, pass 3. */
__kernel void gather_accumulate(GATHER_RECORDS, __global const float *thresholds, __global float *sums, PIXEL_PLANES) {
  conic_view view = *frame_view;
  conic_device_frame frame = *frame_constants;
  gather_pixel p = gather_pixel_of(&frame);
  gather_sums s = {0};
  if (!p.is_inside)
    return;
  if (!frame.is_first)
    s = gather_load(sums, &p);
  float threshold = thresholds[p.block * 16 + p.lane];
  uint i_heaviest = CONIC_NO_ID;
  for (ulong i = tile_begin[p.tile]; i < tile_begin[p.tile + 1]; i++) {
    conic_device_reference reference = references[i];
    if (!gather_meets(reference.blocks, &p))
      continue;
    conic_footprint footprint = footprints[reference.footprint];
    conic_fragment fragment;
    int is_heaviest;
    if (!gather_fragment(&view, &footprint, reference.footprint, rays, clips, &p, &fragment) ||
        !(seen_iz_of(&fragment) >= threshold))
      continue;
    gather_blend(&view, &footprint, &surfaces[reference.footprint], &fragment, &s, &is_heaviest);
    i_heaviest = is_heaviest ? reference.footprint : i_heaviest;
    s.count++;
    if (s.nearest_iz < fragment.iz) {
      s.nearest_iz = fragment.iz;
      s.id = surfaces[reference.footprint].index;
    }
  }
  if (i_heaviest != CONIC_NO_ID)
    gather_keep_heaviest(i_heaviest, footprints, surfaces, &p, &s);
  gather_finish(&frame, &p, &s, sums, PIXEL_PLANES_PASSED);
}

/* In place of both where the nearest splat wins alone. */
__kernel void gather_nearest(GATHER_RECORDS, __global uint *n_fragments, __global float *sums, PIXEL_PLANES) {
  conic_view view = *frame_view;
  conic_device_frame frame = *frame_constants;
  gather_pixel p = gather_pixel_of(&frame);
  gather_sums s = {0};
  if (!p.is_inside)
    return;
  if (!frame.is_first)
    s = gather_load(sums, &p);
  uint i_nearest = CONIC_NO_ID, found = 0;
  conic_fragment nearest = {0, 0, 0, 0};
  for (ulong i = tile_begin[p.tile]; i < tile_begin[p.tile + 1]; i++) {
    conic_device_reference reference = references[i];
    if (!gather_meets(reference.blocks, &p))
      continue;
    conic_footprint footprint = footprints[reference.footprint];
    conic_fragment fragment;
    if (!gather_fragment(&view, &footprint, reference.footprint, rays, clips, &p, &fragment))
      continue;
    found++;
    if (!(s.nearest_iz < fragment.iz))
      continue;
    s.nearest_iz = fragment.iz;
    nearest = fragment;
    i_nearest = reference.footprint;
  }
  if (found)
    atomic_add(&n_fragments[p.tile], found);
  if (i_nearest != CONIC_NO_ID) {
    gather_sums one = {0};
    int is_heaviest;
    conic_footprint footprint = footprints[i_nearest];
    one.nearest_iz = s.nearest_iz;
    gather_blend(&view, &footprint, &surfaces[i_nearest], &nearest, &one, &is_heaviest);
    gather_keep_heaviest(i_nearest, footprints, surfaces, &p, &one);
    one.id = surfaces[i_nearest].index;
    one.count = 1;
    s = one;
  }
  gather_finish(&frame, &p, &s, sums, PIXEL_PLANES_PASSED);
}
