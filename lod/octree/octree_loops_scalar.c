/* The octree's loops in plain C: the reference. They look at boxes as the lanes do, where that saves most of the
 * work, but keep no lists of what is near, unless these are full. */

#include "core/base/vectors.h"
#include "core/splats/float_vectors.h"
#include "lod/octree/octree_measure_body.h"
#include "lod/octree/outline_corners.h"

/* A box about a sample, a node or a point: center, half. */
typedef struct reach_box {
  float center[3], half[3];
} reach_box;

/* The node's disc: its unit axes, the lengths of its half axes, the gap between its samples. */
typedef struct flat_node {
  const conic_node_disc *disc;
  float u[3], v[3], major, minor, gap;
} flat_node;

static int reaches_into(float *const center[3], float *const half[3], size_t i, const reach_box *box) {
  int is_in = 1;
  for (int axis = 0; axis < 3; axis++)
    is_in &= half[axis][i] + box->half[axis] >= fabsf(center[axis][i] - box->center[axis]);
  return is_in;
}

/* How far disc k, seen along the node's normal, lets the sample at (x, y) of its plane count as off it: along the line
 * to its centre, from its outline; inside, it is known from how much larger the disc could be. */
static float error_of_sample(const flat_node *node, const conic_discs *discs, size_t k, float x, float y) {
  float apart[3], u[3], v[3];
  for (int axis = 0; axis < 3; axis++) {
    apart[axis] = discs->center[axis][k] - node->disc->center[axis];
    u[axis] = discs->u[axis][k];
    v[axis] = discs->v[axis][k];
  }
  float ux = conic_float_dot(u, node->u), uy = conic_float_dot(u, node->v), vx = conic_float_dot(v, node->u),
        vy = conic_float_dot(v, node->v);
  float determinant = ux * vy - uy * vx, sum = (ux * ux + uy * uy) + (vx * vx + vy * vy);
  float root = sqrtf(sum), scale = 1.0f / determinant, area = fabsf(determinant);
  int is_flat = sum * 1e-3f < area; /* one seen from its edge counts by its centre */
  float point = 1.0f / (root * 1e-3f + 1e-30f);
  const float inverse[4] = {is_flat ? vy * scale : point, is_flat ? -vx * scale : 0.0f, is_flat ? -uy * scale : 0.0f,
                            is_flat ? ux * scale : point};
  float uz = is_flat ? conic_float_dot(u, node->disc->n) : 0.0f,
        vz = is_flat ? conic_float_dot(v, node->disc->n) : 0.0f;
  float slope_x = uz * inverse[0] + vz * inverse[2], slope_y = uz * inverse[1] + vz * inverse[3];
  float lift = sqrtf(slope_x * slope_x + slope_y * slope_y) * node->gap, minor = is_flat ? area / root : 0.0f;

  float dx = x - conic_float_dot(apart, node->u), dy = y - conic_float_dot(apart, node->v);
  float a = dx * inverse[0] + dy * inverse[1], b = dx * inverse[2] + dy * inverse[3];
  float out = sqrtf(a * a + b * b), inside = 1.0f / (out > 1.0f ? out : 1.0f), beyond = 1.0f - inside;
  float outside2 = (dx * dx + dy * dy) * (beyond * beyond);
  float z = inside * (a * uz + b * vz) + conic_float_dot(apart, node->disc->n), distance = sqrtf(outside2 + z * z);
  float within = (1.0f - out > 0.0f ? 1.0f - out : 0.0f) * minor, rest = node->gap - within;
  float around = (distance + (rest > 0.0f ? rest : 0.0f)) + (out < 1.0f ? lift : 0.0f);
  float weighted = distance * CONIC_COVER_WEIGHT;
  return (weighted > around ? weighted : around) + discs->error[k];
}

/* The error of the sample at (x, y), or what is `enough`, over all discs that can lower it below `nearest`. */
static float lower_sample(const flat_node *node, const conic_discs *discs, const conic_near_discs *near, float x,
                          float y, float nearest, float enough) {
  size_t n = near->is_full ? near->blocks.count : (discs->count + CONIC_DISC_BLOCK - 1) / CONIC_DISC_BLOCK;
  reach_box box;
  for (int axis = 0; axis < 3; axis++)
    box.center[axis] = node->disc->center[axis] + (x * node->u[axis] + y * node->v[axis]);
  for (size_t i = 0; i < n && nearest > enough; i++) {
    size_t block = near->is_full ? near->blocks.block[i] : i;
    box.half[0] = box.half[1] = box.half[2] = nearest * (1.0f / CONIC_COVER_WEIGHT);
    if (!reaches_into(discs->block_center, discs->block_half, block, &box))
      continue;
    for (size_t k = block * CONIC_DISC_BLOCK; k < (block + 1) * CONIC_DISC_BLOCK; k++) {
      float error = reaches_into(discs->center, discs->half, k, &box) ? error_of_sample(node, discs, k, x, y) : nearest;
      nearest = error < nearest ? error : nearest;
    }
  }
  return nearest;
}

/* First the node's own discs lower all samples' errors; then of the worst, one by one, all that can. */
static float plain_cover(const conic_disc_samples *samples, const conic_discs *discs, size_t begin, size_t end,
                         conic_near_discs *near, const conic_node_disc *disc) {
  float x[CONIC_DISC_SAMPLES], y[CONIC_DISC_SAMPLES], nearest[CONIC_DISC_SAMPLES], enough = disc->enough;
  flat_node node = {.disc = disc};
  node.major = conic_float_unit(disc->u, node.u);
  node.minor = conic_float_unit(disc->v, node.v);
  node.gap = (float)CONIC_DISC_GAP * (node.major > node.minor ? node.major : node.minor);
  for (int i = 0; i < CONIC_DISC_SAMPLES; i++) {
    x[i] = samples->x[i] * node.major;
    y[i] = samples->y[i] * node.minor;
    nearest[i] = 1e30f;
    for (size_t k = begin; k < end && nearest[i] > enough; k++) {
      float error = error_of_sample(&node, discs, k, x[i], y[i]);
      nearest[i] = error < nearest[i] ? error : nearest[i];
    }
  }
  for (;;) {
    int worst = 0;
    for (int i = 1; i < CONIC_DISC_SAMPLES; i++)
      worst = nearest[i] > nearest[worst] ? i : worst;
    if (!(nearest[worst] > enough))
      return enough;
    nearest[worst] = lower_sample(&node, discs, near, x[worst], y[worst], nearest[worst], enough);
    enough = nearest[worst] > enough ? nearest[worst] : enough;
  }
}

/* From block `first` on, and then those before, until the list is full. */
static void plain_list_near(const conic_discs *discs, size_t first, conic_near_discs *near) {
  const size_t n_blocks = (discs->count + CONIC_DISC_BLOCK - 1) / CONIC_DISC_BLOCK;
  conic_block_list *list = &near->blocks;
  reach_box box;
  memcpy(box.center, near->center, sizeof box.center);
  memcpy(box.half, near->half, sizeof box.half);
  list->count = 0;
  near->is_full = 0;
  for (size_t i = 0; i < n_blocks && !near->is_full; i++) {
    size_t block = first + i < n_blocks ? first + i : first + i - n_blocks;
    if (!reaches_into(discs->block_center, discs->block_half, block, &box))
      continue;
    near->is_full = !conic_near_has_room(near);
    if (near->is_full)
      break;
    for (int axis = 0; axis < 3; axis++) {
      list->center[axis][list->count] = discs->block_center[axis][block];
      list->half[axis][list->count] = discs->block_half[axis][block];
    }
    list->block[list->count++] = (uint32_t)block;
  }
  for (size_t i = list->count; i % CONIC_DISC_BLOCK != 0; i++) /* boxes in which nothing is, to make whole blocks */
    for (int axis = 0; axis < 3; axis++) {
      list->center[axis][i] = HUGE_VALF;
      list->half[axis][i] = 0.0f;
    }
}

static void plain_find_near(const conic_discs *discs, conic_near_discs *near) {
  plain_list_near(discs, 0, near);
  if (near->is_full)
    plain_list_near(discs, near->begin / CONIC_DISC_BLOCK / CONIC_DISC_BLOCK * CONIC_DISC_BLOCK, near);
}

/* A leaf in a node's frame. */
typedef struct framed_leaf {
  double p[3], u[3], v[3]; /* from the node's position */
} framed_leaf;

/* Whether (a + b)² ≤ (1 + 1/8) a² + (1 + 8) b² is no more than c². */
static int is_held(double a2, double b2, double c) {
  return a2 * 1.125 + b2 * 9.0 <= c * c;
}

static double raised(double value, double by) {
  return by > value ? by : value;
}

static void raise_reach(const framed_leaf *leaf, double cutoff, const conic_node_frame *frame, double before,
                        conic_leaf_reach *reach) {
  const double across = 1.0 / frame->ratio;
  double x = conic_dot(leaf->p, frame->u), y = conic_dot(leaf->p, frame->v) * across;
  double ux = conic_dot(leaf->u, frame->u), uy = conic_dot(leaf->u, frame->v) * across;
  double vx = conic_dot(leaf->v, frame->u), vy = conic_dot(leaf->v, frame->v) * across;
  double square = x * x + y * y, greatest2 = 0.0;
  if (is_held(square, cutoff * cutoff * (ux * ux + uy * uy + vx * vx + vy * vy), before))
    return;
  for (int k = 0; k < CONIC_OUTLINE_CORNERS; k++) {
    double a = cutoff * (conic_corners_x[k] * ux + conic_corners_y[k] * vx);
    double b = cutoff * (conic_corners_x[k] * uy + conic_corners_y[k] * vy);
    greatest2 = raised(greatest2, square + (a * a + b * b) + 2.0 * fabs(a * x + b * y));
  }
  reach->reach = raised(reach->reach, sqrt(greatest2));
}

static void raise_radius(const framed_leaf *leaf, double cutoff, double before, conic_leaf_reach *reach) {
  double square = conic_dot(leaf->p, leaf->p), uu = conic_dot(leaf->u, leaf->u);
  double vv = conic_dot(leaf->v, leaf->v), uv = conic_dot(leaf->u, leaf->v);
  if (is_held(square, cutoff * cutoff * (uu + vv), before))
    return;
  double longest2 = 0.5 * (uu + vv + sqrt((uu - vv) * (uu - vv) + 4.0 * uv * uv));
  reach->radius = raised(reach->radius, sqrt(square) + cutoff * sqrt(longest2));
}

static void raise_height(const framed_leaf *leaf, double cutoff, const double n[3], double before,
                         conic_leaf_reach *reach) {
  double z = conic_dot(leaf->p, n), uz = conic_dot(leaf->u, n), vz = conic_dot(leaf->v, n);
  double square = cutoff * cutoff * (uz * uz + vz * vz);
  if (!is_held(z * z, square, before))
    reach->height = raised(reach->height, fabs(z) + sqrt(square));
}

static void lower_cosine(const framed_leaf *leaf, const double n[3], double before, conic_leaf_reach *reach) {
  double normal[3];
  conic_cross(leaf->u, leaf->v, normal);
  double along = conic_dot(normal, n), square = conic_dot(normal, normal);
  if (along > 0.0 && along * along > square * (before * fabs(before)))
    return;
  double cosine = along / sqrt(square);
  reach->cosine = cosine < reach->cosine ? cosine : reach->cosine;
}

static void plain_add_reach(const conic_splats *leaves, size_t begin, size_t end, double cutoff,
                            const conic_node_frame *frame, conic_leaf_reach *reach) {
  conic_leaf_reach before = *reach;
  for (size_t i = begin; i < end; i++) {
    framed_leaf leaf;
    if ((i - begin) % CONIC_REACH_BATCH == 0)
      before = *reach;
    for (int axis = 0; axis < 3; axis++) {
      leaf.p[axis] = (double)leaves->position[axis][i] - frame->position[axis];
      leaf.u[axis] = (double)leaves->tangent_u[axis][i];
      leaf.v[axis] = (double)leaves->tangent_v[axis][i];
    }
    raise_reach(&leaf, cutoff, frame, before.reach, reach);
    raise_radius(&leaf, cutoff, before.radius, reach);
    raise_height(&leaf, cutoff, frame->n, before.height, reach);
    lower_cosine(&leaf, frame->n, before.cosine, reach);
  }
}

/* Raises, for each ratio, the square of the greatest extent by what a leaf's outline has. */
static void widen_extents(const double flat[3][2], double cutoff, const float across2[CONIC_N_RATIOS],
                          float greatest[CONIC_N_RATIOS]) {
  for (int corner = 0; corner < 2 * CONIC_OUTLINE_CORNERS; corner++) {
    double cx = conic_corners_x[corner / 2], cy = conic_corners_y[corner / 2];
    double dx = cutoff * (cx * flat[1][0] + cy * flat[2][0]), dy = cutoff * (cx * flat[1][1] + cy * flat[2][1]);
    double x = corner % 2 ? flat[0][0] - dx : flat[0][0] + dx, y = corner % 2 ? flat[0][1] - dy : flat[0][1] + dy;
    float x2 = (float)(x * x), y2 = (float)(y * y);
    for (int k = 0; k < CONIC_N_RATIOS; k++) {
      float extent = x2 + y2 * across2[k];
      greatest[k] = extent > greatest[k] ? extent : greatest[k];
    }
  }
}

/* A vector along and across the direction `major` in u, v. */
static void turn_flat(const double value[3], const double u[3], const double v[3], const double major[2],
                      double flat[2]) {
  double along_u = 0.0, along_v = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    along_u += value[axis] * u[axis];
    along_v += value[axis] * v[axis];
  }
  flat[0] = major[0] * along_u + major[1] * along_v;
  flat[1] = major[0] * along_v - major[1] * along_u;
}

static double plain_choose_ratio(const conic_splats *leaves, size_t begin, size_t end, double cutoff,
                                 const double place[3], const double u[3], const double v[3],
                                 const conic_ellipse *shape, double least_ratio) {
  double best = shape->ratio, ratios[CONIC_N_RATIOS];
  float across2[CONIC_N_RATIOS], greatest[CONIC_N_RATIOS] = {0.0f}, best_area = HUGE_VALF;
  for (int k = 0; k < CONIC_N_RATIOS; k++) {
    double ratio = conic_ratio_factors[k] * shape->ratio;
    ratios[k] = ratio > 1.0 ? 1.0 : ratio < least_ratio ? least_ratio : ratio;
    across2[k] = (float)(1.0 / (ratios[k] * ratios[k]));
  }
  for (size_t i = begin; i < end; i++) {
    double vectors[3][3], flat[3][2];
    for (int axis = 0; axis < 3; axis++) {
      vectors[0][axis] = (double)leaves->position[axis][i] - place[axis];
      vectors[1][axis] = (double)leaves->tangent_u[axis][i];
      vectors[2][axis] = (double)leaves->tangent_v[axis][i];
    }
    for (int part = 0; part < 3; part++)
      turn_flat(vectors[part], u, v, shape->major, flat[part]);
    widen_extents((const double(*)[2])flat, cutoff, across2, greatest);
  }
  for (int k = 0; k < CONIC_N_RATIOS; k++) {
    float area = greatest[k] * (float)ratios[k];
    if (area < best_area) {
      best_area = area;
      best = ratios[k];
    }
  }
  return best;
}

/* Whether the eye sees the back of the node. */
static int is_away(const conic_drawn_node *node, const float eye[3]) {
  float along = 0.0f;
  for (int axis = 0; axis < 3; axis++) {
    int next = (axis + 1) % 3, last = (axis + 2) % 3;
    float normal = node->tangent_u[next] * node->tangent_v[last] - node->tangent_u[last] * node->tangent_v[next];
    along += (node->position[axis] - eye[axis]) * normal;
  }
  return along > 0.0f;
}

static void plain_put(const conic_octree *octree, const uint32_t *sources, size_t n, const float *eye,
                      const conic_splats *to, uint32_t *ids, size_t place) {
  for (size_t k = 0; k < n; k++) {
    int is_node = (sources[k] & CONIC_NODE_BIT) != 0;
    const conic_drawn_node *from = &(is_node ? octree->drawn : octree->drawn_leaves)[sources[k] & ~CONIC_NODE_BIT];
    int is_turned = eye && is_node && is_away(from, eye);
    for (int axis = 0; axis < 3; axis++) {
      to->position[axis][place + k] = from->position[axis];
      to->tangent_u[axis][place + k] = from->tangent_u[axis];
      to->tangent_v[axis][place + k] = is_turned ? -from->tangent_v[axis] : from->tangent_v[axis];
      if (to->color[axis])
        to->color[axis][place + k] = from->color[axis];
    }
    if (to->opacity)
      to->opacity[place + k] = from->opacity;
    if (to->dot)
      to->dot[place + k] = from->dot;
    ids[place + k] = from->id;
  }
}

CONIC_DEFINE_LOOPS(conic_octree_loops)

void conic_octree_loops_scalar(conic_octree_loops *loops) {
  *loops = (conic_octree_loops){plain_cover, plain_find_near, plain_add_reach, plain_choose_ratio, measure, plain_put};
}
