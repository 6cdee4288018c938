/* Where a pixel is a work-item: what it has added up, and pass 3 (raster/loops/resolve.c). */

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

/* The image's planes. */
#define PIXEL_PLANES                                                                                                   \
  __global const float *columns, __global const float *rows, __global float *rgba, __global float *z_plane,            \
      __global float *normal_plane, __global float *albedo_plane, __global float *weight_plane,                        \
      __global uint *count_plane, __global uint *id_plane, __global uint *n_covered

/* The finish that the shared shading reads. */
static void finish_of(const conic_device_frame *frame, conic_render_options *options, conic_finish *finish) {
  options->shading = (conic_shading)frame->shading;
  finish->options = options;
  finish->lights = &frame->lights;
  finish->exposure = frame->exposure;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      finish->world_from_cam[i][j] = frame->world_from_cam[i][j];
  for (int channel = 0; channel < 4; channel++)
    finish->background[channel] = frame->background[channel];
}

static void gather_resolve_pixel(const conic_device_frame *frame, const gather_pixel *p, const gather_sums *s,
                                 PIXEL_PLANES) {
  ulong at = (ulong)p->y * (ulong)frame->width + (ulong)p->x;
  int is_covered = s->weight > 0.0f, planes = frame->planes;
  conic_render_options options;
  conic_finish finish;
  conic_finished_pixel pixel;
  finish_of(frame, &options, &finish);
  if (is_covered) {
    conic_finish_covered(&finish, s->weight, s->color, s->normal, s->heaviest_normal, columns[p->x], rows[p->y],
                         &pixel);
    atomic_add(&n_covered[p->tile], 1u);
  } else
    conic_finish_uncovered(&finish, &pixel);
  for (int channel = 0; channel < 4 && planes & 1 << CONIC_PLANE_RGBA; channel++)
    rgba[at * 4 + channel] = pixel.rgba[channel];
  for (int axis = 0; axis < 3 && planes & 1 << CONIC_PLANE_NORMAL; axis++)
    normal_plane[at * 3 + axis] = pixel.normal[axis];
  for (int axis = 0; axis < 3 && planes & 1 << CONIC_PLANE_ALBEDO; axis++)
    albedo_plane[at * 3 + axis] = pixel.albedo[axis];
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
