#include "core/base/eigen.h"
#include "core/base/vectors.h"
#include "core/estimate/neighbourhood.h"

static void guess_normal(conic_neighbourhood *neighbourhood, size_t slot) {
  conic_covariance covariance = conic_covariance_about(neighbourhood, slot);
  double matrix[6], values[3], vectors[3][3];
  conic_covariance_add(&covariance, neighbourhood, conic_neighbourhood_of(neighbourhood, slot),
                       neighbourhood->n_neighbours);
  conic_covariance_matrix(&covariance, matrix);
  conic_eigen3(matrix, values, vectors);
  for (int axis = 0; axis < 3; axis++)
    neighbourhood->normals[slot][axis] = (float)vectors[2][axis];
}

static void guess_slots(void *data, size_t begin, size_t end) {
  conic_neighbourhood *neighbourhood = data;
  for (size_t slot = begin; slot < end; slot++)
    if (neighbourhood->flags[slot] & CONIC_SLOT_GUESSED)
      guess_normal(neighbourhood, slot);
}

conic_status conic_normals_guess(conic_context *context, conic_neighbourhood *neighbourhood, double from, double to) {
  const conic_team_column column = {neighbourhood->normals, sizeof *neighbourhood->normals};
  return conic_slots_share(context, neighbourhood->tree.n_slots, guess_slots, neighbourhood, from, to, &column, 1);
}

/* How two neighbours' normals belong together. The other one is mirrored in the plane half way between the points, as
 * if both lay on one arc; that follows the surface across sharp edges and thin walls alike. 1 or -1: surely with the
 * same or with opposite signs; 0: unknown. */
static double agreement(const conic_neighbourhood *neighbourhood, size_t a, size_t b) {
  const float *na = neighbourhood->normals[a], *nb = neighbourhood->normals[b];
  double cosine = 0.0, a_along = 0.0, b_along = 0.0, length2 = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double d = (double)neighbourhood->tree.position[axis][b] - (double)neighbourhood->tree.position[axis][a];
    cosine += (double)na[axis] * (double)nb[axis];
    a_along += d * (double)na[axis];
    b_along += d * (double)nb[axis];
    length2 += d * d;
  }
  return length2 > 0.0 ? cosine - 2.0 * (a_along / length2) * b_along : cosine;
}

/* A slot has links to its first LINKS neighbours, which are sorted by doubt in steps of 1/STEPS. */
enum { LINKS = 8, STEPS = 65535, LINKS_A_REPORT = 1 << 18 };

/* Two slots; the higher one comes first where they belong together with opposite signs. */
typedef struct normal_link {
  uint32_t ends[2];
} normal_link;

typedef struct linking {
  conic_neighbourhood *neighbourhood;
  size_t n_links;               /* of each slot */
  uint16_t *doubt;              /* of each link */
  uint8_t *opposite, *left_out; /* of each slot, bits of its links: whether signs are opposite; which links join
                                   nothing */
  uint32_t *parent; /* of each slot, in the forest of connected parts; the last stands for all given normals */
  uint8_t *flip;    /* whether a slot's sign is opposite to its parent's */
} linking;

static void doubt_slots(void *data, size_t begin, size_t end) {
  const linking *l = data;
  for (size_t slot = begin; slot < end; slot++) {
    if (!(l->neighbourhood->flags[slot] & CONIC_SLOT_GUESSED))
      continue;
    const uint32_t *list = conic_neighbourhood_of(l->neighbourhood, slot);
    unsigned opposite = 0, left_out = 0;
    for (size_t i = 0; i < l->n_links; i++) {
      const float *normal = l->neighbourhood->normals[list[i]];
      double agreed = agreement(l->neighbourhood, slot, list[i]), trust = fabs(agreed);
      l->doubt[slot * LINKS + i] = (uint16_t)(trust < 1.0 ? (1.0 - trust) * (double)STEPS : 0.0);
      opposite |= (unsigned)(agreed < 0.0) << i;
      left_out |= (unsigned)(normal[0] == 0.0f && normal[1] == 0.0f && normal[2] == 0.0f) << i;
    }
    l->opposite[slot] = (uint8_t)opposite;
    l->left_out[slot] = (uint8_t)left_out;
  }
}

/* Sorts the links of the guessed slots by doubt, stably, into `order`, n · LINKS at most. Returns how many. */
static size_t sort_links(const linking *l, size_t *starts, normal_link *order) {
  size_t n_slots = l->neighbourhood->tree.n_slots;
  for (size_t slot = 0; slot < n_slots; slot++)
    for (size_t i = 0; i < l->n_links && l->neighbourhood->flags[slot] & CONIC_SLOT_GUESSED; i++)
      starts[l->doubt[slot * LINKS + i] + 1] += !(l->left_out[slot] >> i & 1);
  for (size_t step = 0; step <= STEPS; step++)
    starts[step + 1] += starts[step];
  size_t n = starts[STEPS + 1];
  for (size_t slot = 0; slot < n_slots; slot++) {
    if (!(l->neighbourhood->flags[slot] & CONIC_SLOT_GUESSED))
      continue;
    const uint32_t *list = conic_neighbourhood_of(l->neighbourhood, slot);
    for (size_t i = 0; i < l->n_links; i++) {
      uint32_t a = (uint32_t)slot, b = list[i];
      int is_opposite = l->opposite[slot] >> i & 1;
      if (!(l->left_out[slot] >> i & 1))
        order[starts[l->doubt[slot * LINKS + i]]++] =
            (a > b) == is_opposite ? (normal_link){{a, b}} : (normal_link){{b, a}};
    }
  }
  return n;
}

/* The root of the slot's connected part; *flip says whether the signs are opposite. Shortens the path. */
static uint32_t find_root(linking *l, uint32_t slot, unsigned *flip) {
  uint32_t root = slot;
  unsigned whole = 0;
  for (; l->parent[root] != root; root = l->parent[root])
    whole ^= l->flip[root];
  *flip = whole;
  while (l->parent[slot] != root && slot != root) {
    uint32_t next = l->parent[slot];
    unsigned rest = whole ^ l->flip[slot];
    l->parent[slot] = root;
    l->flip[slot] = (uint8_t)whole;
    whole = rest;
    slot = next;
  }
  return root;
}

/* Joins the connected parts of two slots, so that their signs are as wanted. The given normals stay the root, else the
 * lower slot becomes it. */
static void join_parts(linking *l, uint32_t a, uint32_t b, unsigned is_opposite) {
  unsigned flip_a, flip_b;
  uint32_t root_a = find_root(l, a, &flip_a), root_b = find_root(l, b, &flip_b);
  uint32_t given = (uint32_t)l->neighbourhood->tree.n_slots;
  if (root_a == root_b)
    return;
  uint32_t root = root_a == given || (root_b != given && root_a < root_b) ? root_a : root_b;
  uint32_t other = root == root_a ? root_b : root_a;
  l->parent[other] = root;
  l->flip[other] = (uint8_t)(flip_a ^ flip_b ^ is_opposite);
}

static conic_status join_links(conic_context *context, linking *l, const normal_link *order, size_t n) {
  const conic_neighbourhood *neighbourhood = l->neighbourhood;
  for (size_t slot = 0; slot <= neighbourhood->tree.n_slots; slot++) {
    int is_given = slot == neighbourhood->tree.n_slots || !(neighbourhood->flags[slot] & CONIC_SLOT_GUESSED);
    l->parent[slot] = (uint32_t)(is_given ? neighbourhood->tree.n_slots : slot);
    l->flip[slot] = 0;
  }
  for (size_t i = 0; i < n; i++) {
    conic_status status = i % LINKS_A_REPORT == 0 ? conic_progress(context, "estimate", 0.55) : CONIC_OK;
    if (status != CONIC_OK)
      return status;
    join_parts(l, order[i].ends[0], order[i].ends[1], order[i].ends[0] > order[i].ends[1]);
  }
  return CONIC_OK;
}

static void turn(conic_neighbourhood *neighbourhood, size_t slot) {
  for (int axis = 0; axis < 3; axis++)
    neighbourhood->normals[slot][axis] = -neighbourhood->normals[slot][axis];
}

/* Seen flatter than this, a plane may be tilted either way. */
static const double least_facing = 0.2;

void conic_normals_turn_to_sights(conic_neighbourhood *neighbourhood, float *const sight[3]) {
  for (size_t i = 0; i < neighbourhood->tree.n_points; i++) {
    double towards[3] = {(double)sight[0][i], (double)sight[1][i], (double)sight[2][i]}, cosine = 0.0;
    size_t slot = neighbourhood->tree.slot_of_point[i];
    if (slot == CONIC_NO_SLOT || !(neighbourhood->flags[slot] & CONIC_SLOT_GUESSED) || !conic_normalize(towards))
      continue;
    for (int axis = 0; axis < 3; axis++)
      cosine += towards[axis] * (double)neighbourhood->normals[slot][axis];
    if (!(fabs(cosine) >= least_facing))
      continue;
    if (cosine < 0.0)
      turn(neighbourhood, slot);
    neighbourhood->flags[slot] &= (uint8_t)~CONIC_SLOT_GUESSED;
  }
}

/* A connected part, at its root: the middle, and how much its normals point away from there. */
typedef struct connected_part {
  double middle[3];
  double count, outwards;
} connected_part;

/* Turns every guessed normal to its root's sign, and then whole parts that point inwards. The sum of n · (p - middle)
 * is three times the volume of a closed surface, so single points and their noise do not change its sign. */
static void settle_signs(linking *l, connected_part *parts) {
  conic_neighbourhood *neighbourhood = l->neighbourhood;
  size_t n_slots = neighbourhood->tree.n_slots;
  for (size_t slot = 0; slot < n_slots; slot++) {
    unsigned flip;
    connected_part *p = &parts[find_root(l, (uint32_t)slot, &flip)];
    if (flip)
      turn(neighbourhood, slot);
    for (int axis = 0; axis < 3; axis++)
      p->middle[axis] += (double)neighbourhood->tree.position[axis][slot];
    p->count += 1.0;
  }
  for (size_t slot = 0; slot < n_slots; slot++) {
    unsigned flip;
    connected_part *p = &parts[find_root(l, (uint32_t)slot, &flip)];
    for (int axis = 0; axis < 3; axis++)
      p->outwards += (double)neighbourhood->normals[slot][axis] *
                     ((double)neighbourhood->tree.position[axis][slot] - p->middle[axis] / p->count);
  }
  for (size_t slot = 0; slot < n_slots; slot++) {
    unsigned flip;
    uint32_t root = find_root(l, (uint32_t)slot, &flip);
    if (root != n_slots && parts[root].outwards < 0.0)
      turn(neighbourhood, slot);
  }
}

static conic_status orient_with(conic_context *context, linking *l, connected_part *parts, size_t *starts,
                                normal_link *order) {
  conic_status status = conic_slots_for(context, l->neighbourhood->tree.n_slots, doubt_slots, l, 0.5, 0.55);
  if (status == CONIC_OK)
    status = join_links(context, l, order, sort_links(l, starts, order));
  if (status == CONIC_OK)
    settle_signs(l, parts);
  return status;
}

conic_status conic_normals_orient(conic_context *context, conic_neighbourhood *neighbourhood) {
  size_t n_slots = neighbourhood->tree.n_slots;
  linking l = {neighbourhood, neighbourhood->n_neighbours < LINKS ? neighbourhood->n_neighbours : LINKS};
  connected_part *parts;
  size_t *starts;
  normal_link *order;
  conic_status status = conic_memory_allocate_these(
      context, CONIC_ROOM(l.doubt, LINKS * n_slots), CONIC_ROOM(l.opposite, n_slots), CONIC_ROOM(l.left_out, n_slots),
      CONIC_ROOM(l.parent, n_slots + 1), CONIC_ROOM(l.flip, n_slots + 1), CONIC_ZEROED(parts, n_slots + 1),
      CONIC_ZEROED(starts, STEPS + 2), CONIC_ROOM(order, LINKS * n_slots));
  if (status == CONIC_OK)
    status = orient_with(context, &l, parts, starts, order);
  conic_memory_release_these(context, order, starts, parts, l.flip, l.parent, l.left_out, l.opposite, l.doubt);
  return status;
}
