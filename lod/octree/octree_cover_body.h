/* What octree_cover.h says, in lanes. Whatever these are, discs are taken block by block in one order, so that all give
 * the same. */
#include <math.h>
#include <string.h>

#include "core/lanes/lanes.h"
#include "core/splats/float_vectors.h"
#include "lod/octree/octree_loops.h"

/* A disc seen along the node's normal: an ellipse, and what takes it to the unit circle. */
enum {
  AT_X,
  AT_Y,
  AT_Z,
  AT_INVERSE, /* four */
  AT_UZ = AT_INVERSE + 4,
  AT_VZ,    /* how far its half axes rise over the plane */
  AT_MINOR, /* its shorter half axis, or less */
  AT_LIFT,  /* how much it rises over the gap, at most */
  AT_ERROR, /* its own */
  N_NUMBERS
};
enum { CHUNK = CONIC_DISC_BLOCK * CONIC_DISC_BLOCK };
_Static_assert((int)N_NUMBERS == (int)CONIC_FLAT_NUMBERS, "there is room for what discs are as a node sees them");
_Static_assert(CONIC_DISC_BLOCK % CONIC_LANES == 0, "lanes are parts of blocks");
_Static_assert(CONIC_DISC_SAMPLES % CONIC_LANES == 0, "samples are whole lanes");

/* The error that no disc has lowered: of no real distance, but a number, so that boxes of the padding stay out of it.
 */
static const float unknown = 1e30f;

typedef float flat_block[N_NUMBERS][CONIC_DISC_BLOCK];

/* What of the node's disc is how far from the discs that were looked at. */
typedef struct cover {
  const conic_node_disc *node;
  float u[3], v[3]; /* unit */
  float gap;        /* between the samples */
  float enough;     /* no smaller error matters */
  float x[CONIC_DISC_SAMPLES], y[CONIC_DISC_SAMPLES], nearest[CONIC_DISC_SAMPLES];
} cover;

typedef struct middle_box {
  float center[3], half[3];
} middle_box;

/* A sample, and the disc that is the nearest to it of those looked at. */
typedef struct search {
  float x, y, nearest, center[3];
  const flat_block *block;
  unsigned lane;
} search;

static void begin_cover(const conic_disc_samples *samples, cover *c) {
  float major = conic_float_unit(c->node->u, c->u), minor = conic_float_unit(c->node->v, c->v);
  c->gap = (float)CONIC_DISC_GAP * (major > minor ? major : minor);
  for (int i = 0; i < CONIC_DISC_SAMPLES; i += CONIC_LANES) {
    lanes_store(c->x + i, lanes_load(samples->x + i) * major);
    lanes_store(c->y + i, lanes_load(samples->y + i) * minor);
    lanes_store(c->nearest + i, lanes_of(unknown));
  }
}

/* The least of all lanes. */
CONIC_INLINE float least_of(lanes values) {
#if defined(__AVX512F__)
  return _mm512_reduce_min_ps((__m512)values);
#elif defined(__SSE2__)
#if defined(__AVX2__)
  __m128 four = _mm_min_ps(_mm256_castps256_ps128((__m256)values), _mm256_extractf128_ps((__m256)values, 1));
#else
  __m128 four = (__m128)values;
#endif
  __m128 two = _mm_min_ps(four, _mm_movehl_ps(four, four));
  return _mm_cvtss_f32(_mm_min_ss(two, _mm_shuffle_ps(two, two, 1)));
#else
  float first = values[0] < values[1] ? values[0] : values[1], last = values[2] < values[3] ? values[2] : values[3];
  return first < last ? first : last;
#endif
}

CONIC_INLINE float greatest_of(lanes values) {
  return -least_of(-values);
}

static search begin_search(const cover *c, int i) {
  search s = {.x = c->x[i], .y = c->y[i], .nearest = c->nearest[i]};
  for (int axis = 0; axis < 3; axis++)
    s.center[axis] = c->node->center[axis] + (s.x * c->u[axis] + s.y * c->v[axis]);
  return s;
}

/* Outside of it no disc can lower the sample's error any more. */
CONIC_INLINE middle_box box_of_sample(const search *s) {
  float half = s->nearest * (1.0f / CONIC_COVER_WEIGHT);
  return (middle_box){{s->center[0], s->center[1], s->center[2]}, {half, half, half}};
}

/* Which of as many boxes as there are lanes reach into the box. */
CONIC_INLINE lanes_mask reach_into(float *const center[3], float *const half[3], size_t first, const middle_box *box) {
  lanes x = lanes_absolute(lanes_load(center[0] + first) - box->center[0]);
  lanes y = lanes_absolute(lanes_load(center[1] + first) - box->center[1]);
  lanes z = lanes_absolute(lanes_load(center[2] + first) - box->center[2]);
  return lanes_at_least(lanes_load(half[0] + first) + box->half[0], x) &
         lanes_at_least(lanes_load(half[1] + first) + box->half[1], y) &
         lanes_at_least(lanes_load(half[2] + first) + box->half[2], z);
}

/* Which of a block's discs do, or, with blocks' boxes, which of a chunk's blocks. */
CONIC_INLINE unsigned find_in_block(float *const center[3], float *const half[3], size_t block, const middle_box *box) {
  unsigned bits = 0;
  for (unsigned part = 0; part < CONIC_DISC_BLOCK; part += CONIC_LANES)
    bits |= lanes_bits(reach_into(center, half, block * CONIC_DISC_BLOCK + part, box)) << part;
  return bits;
}

CONIC_INLINE lanes dot_lanes(const lanes a[3], const float b[3]) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

/* Flattens as many discs as there are lanes. */
CONIC_INLINE void flatten_lanes(const cover *c, const conic_discs *discs, size_t first, float *flat) {
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
  lanes inverse[4] = {vy * scale, lanes_keep(is_flat, -vx * scale), lanes_keep(is_flat, -uy * scale), ux * scale};
  if (lanes_any(lanes_not(is_flat))) {
    lanes point = 1.0f / (root * 1e-3f + 1e-30f);
    inverse[0] = lanes_select(is_flat, inverse[0], point);
    inverse[3] = lanes_select(is_flat, inverse[3], point);
  }
  uz = lanes_keep(is_flat, uz);
  vz = lanes_keep(is_flat, vz);
  lanes minor = lanes_keep(is_flat, area / root);
  /* The plane's slope: z changes by (uz, vz)·inverse as (x, y) does. */
  lanes slope_x = uz * inverse[0] + vz * inverse[2], slope_y = uz * inverse[1] + vz * inverse[3];
  lanes lift = lanes_sqrt(slope_x * slope_x + slope_y * slope_y) * c->gap;
  const lanes numbers[N_NUMBERS] = {[AT_X] = dot_lanes(apart, c->u),
                                    [AT_Y] = dot_lanes(apart, c->v),
                                    [AT_Z] = dot_lanes(apart, node->n),
                                    [AT_INVERSE] = inverse[0],
                                    [AT_INVERSE + 1] = inverse[1],
                                    [AT_INVERSE + 2] = inverse[2],
                                    [AT_INVERSE + 3] = inverse[3],
                                    [AT_UZ] = uz,
                                    [AT_VZ] = vz,
                                    [AT_MINOR] = minor,
                                    [AT_LIFT] = lift,
                                    [AT_ERROR] = lanes_load(discs->error + first)};
  for (int k = 0; k < N_NUMBERS; k++)
    lanes_store(flat + (ptrdiff_t)k * CONIC_DISC_BLOCK, numbers[k]);
}

static void flatten(const cover *c, const conic_discs *discs, size_t block, flat_block flat) {
  for (size_t part = 0; part < CONIC_DISC_BLOCK; part += CONIC_LANES)
    flatten_lanes(c, discs, block * CONIC_DISC_BLOCK + part, &flat[0][part]);
}

/* How far (dx, dy) from the middle of a disc, a sample counts as off it. Along the line to its centre, from its
 * outline; inside, where that is below 0, it is known from how much larger the disc could be. */
CONIC_INLINE lanes count_error(lanes dx, lanes dy, const lanes disc[N_NUMBERS], float gap) {
  const lanes one = lanes_of(1.0f), none = lanes_of(0.0f);
  lanes a = dx * disc[AT_INVERSE] + dy * disc[AT_INVERSE + 1],
        b = dx * disc[AT_INVERSE + 2] + dy * disc[AT_INVERSE + 3];
  lanes out = lanes_sqrt(a * a + b * b), inside = one / lanes_max(out, one), beyond = one - inside;
  lanes outside2 = (dx * dx + dy * dy) * (beyond * beyond);
  lanes z = inside * (a * disc[AT_UZ] + b * disc[AT_VZ]) + disc[AT_Z], distance = lanes_sqrt(outside2 + z * z);
  lanes rest = lanes_max(gap - lanes_max(one - out, none) * disc[AT_MINOR], none);
  lanes around = (distance + rest) + lanes_keep(lanes_less(out, one), disc[AT_LIFT]);
  return lanes_max(distance * CONIC_COVER_WEIGHT, around) + disc[AT_ERROR];
}

/* Lowers each sample's error to what this disc gives, but where all are near enough. */
static void approach(const flat_block *block, unsigned lane, cover *c) {
  const lanes enough = lanes_of(c->enough);
  lanes disc[N_NUMBERS];
  for (int k = 0; k < N_NUMBERS; k++)
    disc[k] = lanes_of((*block)[k][lane]);
  for (int i = 0; i < CONIC_DISC_SAMPLES; i += CONIC_LANES) {
    lanes nearest = lanes_load(c->nearest + i);
    if (!lanes_any(lanes_less(enough, nearest)))
      continue;
    lanes dx = lanes_load(c->x + i) - disc[AT_X], dy = lanes_load(c->y + i) - disc[AT_Y];
    lanes_store(c->nearest + i, lanes_min(count_error(dx, dy, disc, c->gap), nearest));
  }
}

/* Lowers one sample's error to what the discs of a block give that reach into its box. `flat` is where what the block
 * looks like is kept; whether it is there yet is handed in and returned. */
CONIC_INLINE int approach_block(const cover *c, const conic_discs *discs, size_t block, float (*flat)[CONIC_DISC_BLOCK],
                                int is_flat, search *s) {
  const middle_box box = box_of_sample(s);
  for (unsigned part = 0; part < CONIC_DISC_BLOCK; part += CONIC_LANES) {
    lanes_mask is_in = reach_into(discs->center, discs->half, block * CONIC_DISC_BLOCK + part, &box);
    lanes disc[N_NUMBERS];
    if (!lanes_any(is_in))
      continue;
    if (!is_flat)
      flatten(c, discs, block, flat);
    is_flat = 1;
    for (int k = 0; k < N_NUMBERS; k++)
      disc[k] = lanes_load(flat[k] + part);
    lanes error = count_error(s->x - disc[AT_X], s->y - disc[AT_Y], disc, c->gap);
    error = lanes_select(is_in, lanes_min(error, lanes_of(unknown)), lanes_of(unknown));
    float least = least_of(error);
    if (least < s->nearest) {
      s->nearest = least;
      s->block = (const flat_block *)flat;
      s->lane = part + (unsigned)__builtin_ctz(lanes_bits(lanes_at_least(lanes_of(least), error)));
    }
  }
  return is_flat;
}

/* Searches the blocks nearby. */
CONIC_INLINE void search_near(const cover *c, const conic_discs *discs, conic_near_discs *near, search *s) {
  const conic_block_list *list = &near->blocks;
  for (size_t chunk = 0; chunk * CONIC_DISC_BLOCK < list->count && s->nearest > c->enough; chunk++) {
    const middle_box box = box_of_sample(s);
    unsigned blocks = find_in_block(list->center, list->half, chunk, &box), are_flat = near->are_flat[chunk];
    for (; blocks && s->nearest > c->enough; blocks &= blocks - 1) {
      unsigned k = (unsigned)__builtin_ctz(blocks);
      size_t i = chunk * CONIC_DISC_BLOCK + k;
      are_flat |= (unsigned)approach_block(c, discs, list->block[i], near->flat[i], (int)(are_flat >> k & 1), s) << k;
    }
    near->are_flat[chunk] = (uint16_t)are_flat;
  }
}

/* Searches all discs; what they look like is soon forgotten. */
static void search_all(const cover *c, const conic_discs *discs, search *s) {
  flat_block flat;
  for (size_t chunk = 0; chunk * CHUNK < discs->count; chunk++) {
    const middle_box box = box_of_sample(s);
    unsigned blocks = find_in_block(discs->block_center, discs->block_half, chunk, &box);
    for (; blocks && s->nearest > c->enough; blocks &= blocks - 1)
      approach_block(c, discs, chunk * CONIC_DISC_BLOCK + (size_t)__builtin_ctz(blocks), flat, 0, s);
  }
  s->block = NULL;
}

/* Whether all that matters to the sample is among the near discs. */
static int is_all_near(const conic_near_discs *near, const search *s) {
  const middle_box box = box_of_sample(s);
  int is_near = 1;
  for (int axis = 0; axis < 3; axis++)
    is_near &= fabsf(box.center[axis] - near->center[axis]) + box.half[axis] <= near->half[axis];
  return is_near;
}

/* The sample that is farthest off as far as is known. */
static int find_worst(const cover *c) {
  lanes greatest = lanes_load(c->nearest);
  for (int i = CONIC_LANES; i < CONIC_DISC_SAMPLES; i += CONIC_LANES)
    greatest = lanes_max(lanes_load(c->nearest + i), greatest);
  lanes worst = lanes_of(greatest_of(greatest));
  for (int i = 0; i < CONIC_DISC_SAMPLES; i += CONIC_LANES) {
    unsigned bits = lanes_bits(lanes_at_least(lanes_load(c->nearest + i), worst));
    if (bits)
      return i + __builtin_ctz(bits);
  }
  return 0;
}

static middle_box box_of_node(const conic_node_disc *node, float error) {
  middle_box box;
  for (int axis = 0; axis < 3; axis++) {
    box.center[axis] = node->center[axis];
    box.half[axis] =
        sqrtf(node->u[axis] * node->u[axis] + node->v[axis] * node->v[axis]) + error * (1.0f / CONIC_COVER_WEIGHT);
  }
  return box;
}

/* Which places of a block are among begin … end, which reaches into it. */
static unsigned bits_of_own(size_t block, size_t begin, size_t end) {
  size_t first = block * CONIC_DISC_BLOCK, last = first + CONIC_DISC_BLOCK;
  unsigned bits = (1u << CONIC_DISC_BLOCK) - 1, before = begin > first ? (1u << (begin - first)) - 1 : 0;
  return (last > end ? bits >> (last - end) : bits) & ~before;
}

static void approach_all(const flat_block *block, unsigned bits, cover *c) {
  for (; bits; bits &= bits - 1)
    approach(block, (unsigned)__builtin_ctz(bits), c);
}

/* Lowers the errors by the node's own discs, and then by what is near in their blocks. */
static void approach_own(const conic_discs *discs, size_t begin, size_t end, cover *c) {
  middle_box box = box_of_node(c->node, c->enough);
  for (size_t block = begin / CONIC_DISC_BLOCK; block * CONIC_DISC_BLOCK < end; block++) {
    unsigned own = bits_of_own(block, begin, end);
    flat_block flat;
    flatten(c, discs, block, flat);
    approach_all((const flat_block *)&flat, own, c);
    approach_all((const flat_block *)&flat, find_in_block(discs->center, discs->half, block, &box) & ~own, c);
  }
}

static void begin_list(conic_block_list *list) {
  list->count = 0;
}

static void add_to_list(float *const center[3], float *const half[3], size_t i, uint32_t block,
                        conic_block_list *list) {
  for (int axis = 0; axis < 3; axis++) {
    list->center[axis][list->count] = center[axis][i];
    list->half[axis][list->count] = half[axis][i];
  }
  list->block[list->count++] = block;
}

/* Boxes in which nothing is, to make whole blocks. */
static void end_list(conic_block_list *list) {
  for (size_t i = list->count; i % CONIC_DISC_BLOCK != 0; i++)
    for (int axis = 0; axis < 3; axis++) {
      list->center[axis][i] = HUGE_VALF;
      list->half[axis][i] = 0.0f;
    }
}

static float find_cover(const conic_disc_samples *samples, const conic_discs *discs, size_t begin, size_t end,
                        conic_near_discs *near, const conic_node_disc *node) {
  cover c = {.node = node, .enough = node->enough};
  int is_begun = 0;
  begin_cover(samples, &c);
  approach_own(discs, begin, end, &c);
  for (;;) { /* once one is known for sure, others that are no worse need not be */
    int worst = find_worst(&c);
    if (!(c.nearest[worst] > c.enough))
      return c.enough;
    if (!is_begun) /* of no block it is known how this node sees it */
      memset(near->are_flat, 0,
             near->blocks.count / CONIC_DISC_BLOCK * sizeof *near->are_flat + sizeof *near->are_flat);
    is_begun = 1;
    search s = begin_search(&c, worst);
    search_near(&c, discs, near, &s);
    if (s.nearest > c.enough && !near->is_full && !is_all_near(near, &s))
      search_all(&c, discs, &s);
    c.nearest[worst] = s.nearest;
    c.enough = s.nearest > c.enough ? s.nearest : c.enough;
    if (s.block)
      approach(s.block, s.lane, &c);
  }
}

/* From chunk `first` on, and then those before, until the list is full. */
static void list_near(const conic_discs *discs, size_t first, conic_near_discs *near) {
  const size_t n_chunks = (discs->count + CHUNK - 1) / CHUNK;
  middle_box box;
  memcpy(box.center, near->center, sizeof box.center);
  memcpy(box.half, near->half, sizeof box.half);
  begin_list(&near->blocks);
  near->is_full = 0;
  for (size_t i = 0; i < n_chunks && !near->is_full; i++) {
    size_t chunk = first + i < n_chunks ? first + i : first + i - n_chunks;
    unsigned bits = find_in_block(discs->block_center, discs->block_half, chunk, &box);
    for (; bits; bits &= bits - 1) {
      size_t block = chunk * CONIC_DISC_BLOCK + (size_t)__builtin_ctz(bits);
      near->is_full = !conic_near_has_room(near);
      if (near->is_full)
        break;
      add_to_list(discs->block_center, discs->block_half, block, (uint32_t)block, &near->blocks);
    }
  }
  end_list(&near->blocks);
}

static void find_near(const conic_discs *discs, conic_near_discs *near) {
  list_near(discs, 0, near);
  if (near->is_full)
    list_near(discs, near->begin / CHUNK, near);
}
