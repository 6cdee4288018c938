/* What octree_cover.h says, in lanes: COVER is the function's name. */
#include <math.h>
#include <string.h>

#include "lod/octree_kernels.h"
#include "raster/lanes.h"

/* A disc seen along the node's normal: an ellipse, and what takes it to the unit circle. */
enum {
  AT_X,
  AT_Y,
  AT_Z,
  AT_INVERSE, /* four */
  AT_UZ = AT_INVERSE + 4,
  AT_VZ, /* how far its half axes rise over the plane */
  AT_MINOR, /* its shorter half axis, or less */
  AT_LIFT, /* how much it rises over the gap, at most */
  AT_ERROR, /* its own */
  N_NUMBERS
};
enum { CHUNK = CONIC_DISC_BLOCK * CONIC_DISC_BLOCK };
_Static_assert(CONIC_DISC_BLOCK % CONIC_LANES == 0, "lanes are parts of blocks");

/* A block of discs, number by number, as many at a time as there are lanes. */
typedef struct flat_block {
  float numbers[CONIC_DISC_BLOCK / CONIC_LANES][N_NUMBERS][CONIC_LANES];
} flat_block;

/* What the node's disc still lacks cover at. */
typedef struct cover {
  const conic_discs *discs;
  const conic_node_disc *node;
  float u[3], v[3]; /* unit */
  float gap;        /* between the samples */
  float enough;     /* no smaller error matters */
  int n_samples;    /* those that are not near enough, and copies of the last to make up a whole block */
  float x[CONIC_DISC_SAMPLES], y[CONIC_DISC_SAMPLES], nearest[CONIC_DISC_SAMPLES];
} cover;

typedef struct middle_box {
  float center[3], half[3];
} middle_box;

static float dot(const float a[3], const float b[3]) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

/* Unit vector; returns the length it had. */
static float normalize(const float a[3], float unit[3]) {
  float length = sqrtf(dot(a, a)), scale = length > 0.0f ? 1.0f / length : 0.0f;
  for (int axis = 0; axis < 3; axis++)
    unit[axis] = a[axis] * scale;
  return length;
}

static void begin_cover(const conic_disc_samples *samples, cover *c) {
  float major = normalize(c->node->u, c->u), minor = normalize(c->node->v, c->v);
  c->gap = (float)CONIC_DISC_GAP * (major > minor ? major : minor);
  for (int i = 0; i < CONIC_DISC_SAMPLES; i += CONIC_LANES) {
    lanes_store(c->x + i, lanes_load(samples->x + i) * major);
    lanes_store(c->y + i, lanes_load(samples->y + i) * minor);
    lanes_store(c->nearest + i, lanes_of(HUGE_VALF));
  }
  c->n_samples = CONIC_DISC_SAMPLES;
}

static middle_box box_of_node(const conic_node_disc *node) {
  middle_box box;
  for (int axis = 0; axis < 3; axis++) {
    box.center[axis] = node->center[axis];
    box.half[axis] = sqrtf(node->u[axis] * node->u[axis] + node->v[axis] * node->v[axis]) +
                     node->enough * (1.0f / CONIC_COVER_WEIGHT);
  }
  return box;
}

/* Outside of it no disc can lower the sample's error any more. */
static middle_box box_of_sample(const cover *c, int i) {
  middle_box box;
  for (int axis = 0; axis < 3; axis++) {
    box.center[axis] = c->node->center[axis] + (c->x[i] * c->u[axis] + c->y[i] * c->v[axis]);
    box.half[axis] = c->nearest[i] * (1.0f / CONIC_COVER_WEIGHT);
  }
  return box;
}

/* Which of as many boxes as there are lanes reach into the box. */
CONIC_INLINE unsigned find_in_box(float *const center[3], float *const half[3], size_t first, const middle_box *box) {
  lanes x = lanes_absolute(lanes_load(center[0] + first) - box->center[0]);
  lanes y = lanes_absolute(lanes_load(center[1] + first) - box->center[1]);
  lanes z = lanes_absolute(lanes_load(center[2] + first) - box->center[2]);
  return lanes_bits(lanes_at_least(lanes_load(half[0] + first) + box->half[0], x) &
                    lanes_at_least(lanes_load(half[1] + first) + box->half[1], y) &
                    lanes_at_least(lanes_load(half[2] + first) + box->half[2], z));
}

/* Which discs of a block do. */
static unsigned find_in_block(const conic_discs *discs, size_t block, const middle_box *box) {
  unsigned bits = 0;
  for (unsigned part = 0; part < CONIC_DISC_BLOCK; part += CONIC_LANES)
    bits |= find_in_box(discs->center, discs->half, block * CONIC_DISC_BLOCK + part, box) << part;
  return bits;
}

/* Which blocks of a chunk do: of as many blocks as a block has discs. */
static unsigned find_in_chunk(const conic_discs *discs, size_t chunk, const middle_box *box) {
  unsigned bits = 0;
  for (unsigned part = 0; part < CONIC_DISC_BLOCK; part += CONIC_LANES)
    bits |= find_in_box(discs->block_center, discs->block_half, chunk * CONIC_DISC_BLOCK + part, box) << part;
  return bits;
}

CONIC_INLINE lanes dot_lanes(const lanes a[3], const float b[3]) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

/* Flattens as many discs as there are lanes. */
static void flatten_lanes(const cover *c, size_t first, float flat[N_NUMBERS][CONIC_LANES]) {
  const conic_discs *discs = c->discs;
  const conic_node_disc *node = c->node;
  lanes apart[3], disc_u[3], disc_v[3];
  for (int axis = 0; axis < 3; axis++) {
    apart[axis] = lanes_load(discs->center[axis] + first) - node->center[axis];
    disc_u[axis] = lanes_load(discs->u[axis] + first);
    disc_v[axis] = lanes_load(discs->v[axis] + first);
  }
  lanes ux = dot_lanes(disc_u, c->u), uy = dot_lanes(disc_u, c->v), uz = dot_lanes(disc_u, node->n);
  lanes vx = dot_lanes(disc_v, c->u), vy = dot_lanes(disc_v, c->v), vz = dot_lanes(disc_v, node->n);
  lanes determinant = ux * vy - uy * vx, sum = (ux * ux + uy * uy) + (vx * vx + vy * vy);
  lanes root = lanes_sqrt(sum), scale = 1.0f / determinant, area = lanes_absolute(determinant);
  /* One seen from its edge counts by its centre. */
  lanes_mask is_flat = lanes_less(sum * 1e-3f, area);
  lanes point = 1.0f / (root * 1e-3f + 1e-30f);
  lanes inverse[4] = {lanes_select(is_flat, vy * scale, point), lanes_keep(is_flat, -vx * scale),
                      lanes_keep(is_flat, -uy * scale), lanes_select(is_flat, ux * scale, point)};
  uz = lanes_keep(is_flat, uz);
  vz = lanes_keep(is_flat, vz);
  lanes minor = lanes_keep(is_flat, area / root);
  /* The plane's slope: z changes by (uz, vz)·inverse as (x, y) does. */
  lanes slope_x = uz * inverse[0] + vz * inverse[2], slope_y = uz * inverse[1] + vz * inverse[3];
  lanes lift = lanes_sqrt(slope_x * slope_x + slope_y * slope_y) * c->gap;
  const lanes numbers[N_NUMBERS] = {
      [AT_X] = dot_lanes(apart, c->u), [AT_Y] = dot_lanes(apart, c->v), [AT_Z] = dot_lanes(apart, node->n),
      [AT_INVERSE] = inverse[0],       [AT_INVERSE + 1] = inverse[1],   [AT_INVERSE + 2] = inverse[2],
      [AT_INVERSE + 3] = inverse[3],   [AT_UZ] = uz,                    [AT_VZ] = vz,
      [AT_MINOR] = minor,              [AT_LIFT] = lift,                [AT_ERROR] = lanes_load(discs->error + first)};
  for (int k = 0; k < N_NUMBERS; k++)
    lanes_store(flat[k], numbers[k]);
}

/* Lowers each sample's error to what this disc gives. Along the line to its centre, from its outline; inside, where
 * that is below 0, it is known from how much larger the disc could be. */
static void approach(float disc[N_NUMBERS][CONIC_LANES], unsigned lane, cover *c) {
  const lanes one = lanes_of(1.0f), none = lanes_of(0.0f);
  lanes minor = lanes_of(disc[AT_MINOR][lane]), lift = lanes_of(disc[AT_LIFT][lane]);
  lanes error = lanes_of(disc[AT_ERROR][lane]), z_middle = lanes_of(disc[AT_Z][lane]);
  lanes x = lanes_of(disc[AT_X][lane]), y = lanes_of(disc[AT_Y][lane]);
  lanes uz = lanes_of(disc[AT_UZ][lane]), vz = lanes_of(disc[AT_VZ][lane]);
  lanes ax = lanes_of(disc[AT_INVERSE][lane]), ay = lanes_of(disc[AT_INVERSE + 1][lane]);
  lanes bx = lanes_of(disc[AT_INVERSE + 2][lane]), by = lanes_of(disc[AT_INVERSE + 3][lane]);
  for (int i = 0; i < c->n_samples; i += CONIC_LANES) {
    lanes dx = lanes_load(c->x + i) - x, dy = lanes_load(c->y + i) - y;
    lanes a = dx * ax + dy * ay, b = dx * bx + dy * by;
    lanes out = lanes_sqrt(a * a + b * b), inside = one / lanes_max(out, one), beyond = one - inside;
    lanes outside2 = (dx * dx + dy * dy) * (beyond * beyond);
    lanes z = inside * (a * uz + b * vz) + z_middle, distance = lanes_sqrt(outside2 + z * z);
    lanes rest = lanes_max(c->gap - lanes_max(one - out, none) * minor, none);
    lanes around = (distance + rest) + lanes_keep(lanes_less(out, one), lift);
    lanes counted = lanes_max(distance * CONIC_COVER_WEIGHT, around) + error;
    lanes_store(c->nearest + i, lanes_min(counted, lanes_load(c->nearest + i)));
  }
}

/* Drops the samples that are near enough. */
static void compact(cover *c) {
  const float enough = c->enough;
  int n = 0;
  for (int i = 0; i < c->n_samples; i++) {
    c->x[n] = c->x[i];
    c->y[n] = c->y[i];
    c->nearest[n] = c->nearest[i];
    n += c->nearest[i] > enough;
  }
  for (; n % CONIC_DISC_BLOCK != 0; n++) {
    c->x[n] = c->x[n - 1];
    c->y[n] = c->y[n - 1];
    c->nearest[n] = c->nearest[n - 1];
  }
  c->n_samples = n;
}

/* Takes of a block the discs that reach into the box and were not taken. */
static void add_block(cover *c, const middle_box *box, size_t block) {
  unsigned char *taken = &c->discs->taken[block];
  unsigned bits = find_in_block(c->discs, block, box) & ~(unsigned)*taken;
  flat_block flat;
  *taken = (unsigned char)(*taken | bits);
  if (bits == 0)
    return;
  for (size_t part = 0; part < CONIC_DISC_BLOCK / CONIC_LANES; part++)
    flatten_lanes(c, block * CONIC_DISC_BLOCK + part * CONIC_LANES, flat.numbers[part]);
  for (; bits; bits &= bits - 1) {
    unsigned i = (unsigned)__builtin_ctz(bits);
    approach(flat.numbers[i / CONIC_LANES], i % CONIC_LANES, c);
  }
}

/* Takes the lane of the least value out of the bits. */
CONIC_INLINE unsigned take_least(const float values[CONIC_DISC_BLOCK], unsigned *bits) {
  unsigned least = (unsigned)__builtin_ctz(*bits);
  for (unsigned rest = *bits & (*bits - 1); rest; rest &= rest - 1) {
    unsigned i = (unsigned)__builtin_ctz(rest);
    least = values[i] < values[least] ? i : least;
  }
  *bits &= ~(1u << least);
  return least;
}

/* Takes of a chunk what may lower the error of sample i, the nearest first, while that is needed. */
static void add_chunk(cover *c, size_t chunk, int i_sample) {
  const size_t first = chunk * CONIC_DISC_BLOCK;
  middle_box box = box_of_sample(c, i_sample);
  unsigned bits = find_in_chunk(c->discs, chunk, &box);
  float apart2[CONIC_DISC_BLOCK];
  if (bits == 0)
    return;
  for (size_t i = 0; i < CONIC_DISC_BLOCK; i++) {
    float x = c->discs->block_center[0][first + i] - box.center[0];
    float y = c->discs->block_center[1][first + i] - box.center[1];
    float z = c->discs->block_center[2][first + i] - box.center[2];
    apart2[i] = x * x + y * y + z * z;
  }
  while (bits && c->nearest[i_sample] > c->enough) {
    add_block(c, &box, first + take_least(apart2, &bits));
    box = box_of_sample(c, i_sample);
  }
}

/* The same of all chunks, the nearest in the order of the hierarchy first. */
static void find_nearest(cover *c, size_t chunk, int i_sample) {
  size_t n = (c->discs->count + CHUNK - 1) / CHUNK, low = chunk, high = chunk;
  while ((low > 0 || high < n) && c->nearest[i_sample] > c->enough) {
    if (high < n)
      add_chunk(c, high++, i_sample);
    if (low > 0)
      add_chunk(c, --low, i_sample);
  }
}

/* The sample that is farthest off as far as is known. */
static int find_worst(const cover *c) {
  int worst = 0;
  for (int i = 1; i < c->n_samples; i++)
    worst = c->nearest[i] > c->nearest[worst] ? i : worst;
  return worst;
}

float COVER(const conic_disc_samples *samples, const conic_discs *discs, size_t begin, size_t end,
            const conic_node_disc *node) {
  cover c = {.discs = discs, .node = node, .enough = node->enough};
  middle_box box = box_of_node(node);
  begin_cover(samples, &c);
  memset(discs->taken, 0, (discs->count + CONIC_DISC_BLOCK - 1) / CONIC_DISC_BLOCK);
  for (size_t block = begin / CONIC_DISC_BLOCK; block * CONIC_DISC_BLOCK < end; block++)
    add_block(&c, &box, block);
  compact(&c);
  while (c.n_samples > 0) { /* once one is known for sure, others that are no worse need not be */
    int worst = find_worst(&c);
    find_nearest(&c, begin / CHUNK, worst);
    c.enough = c.nearest[worst] > c.enough ? c.nearest[worst] : c.enough;
    compact(&c);
  }
  return c.enough;
}
