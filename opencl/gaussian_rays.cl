/* Gaussians along the rays of a tile, a block a vector: what gaussian_rays_lanes.h does in lanes of C, with lists that
 * are put in order as they grow. */

/* Of a list, in the order along each ray: where Gaussians meet it, how (0: they do not), and which. */
typedef struct ray_lists {
  __global float *z, *alpha;
  __global uint *which, *blocks; /* of entries: the blocks that each may cover, as bits */
} ray_lists;

/* Entry n of the lists. They are nearly in order, so that it is near its place; what is equally far stays behind. */
static void insert_along_rays(const ray_lists *to, size_t n, lanes z, lanes alpha, index_lanes which) {
  for (; n > 0; n--) {
    const lanes z_before = vload16(n - 1, to->z), alpha_before = vload16(n - 1, to->alpha);
    const index_lanes which_before = vload16(n - 1, to->which);
    const lanes_mask is_nearer = lanes_less(z, z_before);
    if (!lanes_any(is_nearer))
      break;
    vstore16(is_nearer ? z_before : z, n, to->z);
    vstore16(is_nearer ? alpha_before : alpha, n, to->alpha);
    vstore16(is_nearer ? which_before : which, n, to->which);
    z = is_nearer ? z : z_before;
    alpha = is_nearer ? alpha : alpha_before;
    which = is_nearer ? which : which_before;
  }
  vstore16(z, n, to->z);
  vstore16(alpha, n, to->alpha);
  vstore16(which, n, to->which);
}

/* Fills the lists of a block; returns how long they are. */
static size_t meet_block(const scene *s, const ray_lists *to, uint block) {
  const conic_gaussian_list *list = s->list;
  const places at = places_at(block * CONIC_GAUSSIAN_BLOCK_PIXELS);
  size_t n = 0;
  for (size_t i = 0; i < list->n; i++) {
    if (!(to->blocks[i] >> block & 1))
      continue;
    const uint footprint = list->entries[i];
    const gaussian_record r = record_of(s->tile, &list->footprints[footprint]);
    const meeting_lanes m = meet_lanes(&list->rays[footprint], at.column + r.x, at.row + r.y);
    const lanes alpha = lanes_alpha(s, &r, m.half_q);
    const lanes_mask covered = within_box(&r, at) & lanes_less(lanes_of(0.0f), m.z) &
                               lanes_at_least(m.half_q, lanes_of(0.0f)) & lanes_at_least(alpha, s->least);
    if (lanes_any(covered))
      insert_along_rays(to, n++, lanes_select(covered, m.z, lanes_of(r.z)), lanes_keep(covered, alpha),
                        lanes_of_index(footprint));
  }
  return n;
}

/* What each lane's own Gaussian looks like. */
static void look_at_each(const conic_gaussian_list *list, index_lanes which, int wants, response *to) {
  for (int lane = 0; lane < CONIC_LANES; lane++) {
    const uint footprint = ((const uint *)&which)[lane];
    for (int k = 0; k < 3; k++) {
      ((float *)&to->color[k])[lane] = list->footprints[footprint].color[k];
      if (wants)
        ((float *)&to->normal[k])[lane] = list->normals ? list->normals[footprint][k] : 0.0f;
    }
    ((uint *)&to->index)[lane] = list->footprints[footprint].index;
  }
}

/* What they all look like where they are one. */
static void look_at_one(const conic_gaussian_list *list, uint footprint, int wants, response *to) {
  for (int k = 0; k < 3; k++)
    to->color[k] = lanes_of(list->footprints[footprint].color[k]);
  if (wants)
    add_planes_of_footprint(list, footprint, to);
}

static void composite_block(const scene *s, const ray_lists *lists, size_t n, uint block, int wants) {
  const size_t at = block * CONIC_GAUSSIAN_BLOCK_PIXELS;
  pixels p = take_pixels(s, 0xffff, at, wants);
  for (size_t i = 0; i < n && lanes_any(p.goes_on); i++) {
    const index_lanes which = vload16(i, lists->which);
    response to;
    to.alpha = vload16(i, lists->alpha);
    to.covered = lanes_less(lanes_of(0.0f), to.alpha);
    to.z = vload16(i, lists->z);
    if (!lanes_any(to.covered & p.goes_on))
      continue;
    if (lanes_any(which != which.s0))
      look_at_each(s->list, which, wants, &to);
    else
      look_at_one(s->list, which.s0, wants, &to);
    composite_lanes(s, &to, &p, wants);
  }
  put_pixels(s->tile, &p, at, wants);
}

static void composite_rays_by_blocks(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  const scene s = scene_of(list, tile);
  ray_lists lists;
  lists.z = (__global float *)list->room;
  lists.alpha = lists.z + CONIC_LANES * list->n;
  lists.which = (__global uint *)(lists.alpha + CONIC_LANES * list->n);
  lists.blocks = lists.which + CONIC_LANES * list->n;
  for (size_t i = 0; i < list->n; i++) {
    __global const conic_gaussian_footprint *f = footprint_of_entry(list, i);
    const gaussian_record r = record_of(tile, f);
    lists.blocks[i] = blocks_of_box(tile, f) & blocks_of_ellipse(&r, f->half_reach);
  }
  for (uint block = 0; block < CONIC_GAUSSIAN_BLOCKS; block++) {
    const size_t n = meet_block(&s, &lists, block);
    if (list->wants)
      composite_block(&s, &lists, n, block, CONIC_GAUSSIAN_ALL);
    else
      composite_block(&s, &lists, n, block, CONIC_GAUSSIAN_COLORS);
  }
}
