#include "core/base/vectors.h"
#include "core/splats/columns.h"
#include "lod/octree/octree_fit.h"
#include "raster/project/projected.h"

/* Squares of what is farther out overflow a float. */
static const float farthest = 1e15f;

static const size_t chunk_splats = 16384;

static float absolute(float x) {
  return x < 0.0f ? -x : x;
}

/* Whether the renderer could draw the splat from some side (docs/reference/picture.md, "Skipped"). */
static int is_drawable(const conic_splats *splats, size_t i) {
  float sum = 0.0f, u[3], v[3], uu = 0.0f, vv = 0.0f, nn = 0.0f;
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = splats->tangent_u[axis][i];
    v[axis] = splats->tangent_v[axis][i];
    sum += splats->position[axis][i] * 0.0f;
    uu += u[axis] * u[axis];
    vv += v[axis] * v[axis];
    if (splats->color[axis] && !(absolute(splats->color[axis][i]) <= CONIC_GREATEST_COLOR))
      return 0;
  }
  if (splats->opacity && !(absolute(splats->opacity[i]) <= CONIC_GREATEST_OPACITY))
    return 0;
  float u_length = sqrtf(uu), v_length = sqrtf(vv);
  for (int axis = 0; axis < 3; axis++) {
    int next = (axis + 1) % 3, last = (axis + 2) % 3;
    float n = u[next] / u_length * (v[last] / v_length) - u[last] / u_length * (v[next] / v_length);
    nn += n * n;
  }
  return sum == 0.0f && nn > 0.0f && nn * 0.0f == 0.0f;
}

/* Whether a splat that can be drawn is within what the bounds can hold. */
static int is_in_reach(const conic_splats *splats, size_t i) {
  for (int axis = 0; axis < 3; axis++)
    if (!(absolute(splats->position[axis][i]) < farthest && absolute(splats->tangent_u[axis][i]) < farthest &&
          absolute(splats->tangent_v[axis][i]) < farthest))
      return 0;
  return 1;
}

enum { KIND_DRAWN, KIND_UNDRAWN, KIND_FAR };

typedef struct sorting_out {
  const conic_splats *splats;
  uint8_t *kinds;
} sorting_out;

static void kind_chunk(void *data, size_t i_chunk) {
  const sorting_out *s = data;
  size_t begin = i_chunk * chunk_splats,
         end = begin + chunk_splats < s->splats->count ? begin + chunk_splats : s->splats->count;
  for (size_t i = begin; i < end; i++)
    s->kinds[i] = !is_drawable(s->splats, i) ? KIND_UNDRAWN : is_in_reach(s->splats, i) ? KIND_DRAWN : KIND_FAR;
}

/* Those that can be drawn first, each kind in its order. */
static conic_status list_by_kind(conic_octree *octree, const uint8_t *kinds) {
  size_t n = octree->n_points, n_last = n;
  for (size_t i = 0; i < n; i++)
    if (kinds[i] == KIND_FAR)
      return conic_fail(octree->context, CONIC_ERROR_INPUT, "octree: splat %zu is farther out, or larger, than 1e15",
                        i);
    else if (kinds[i] == KIND_DRAWN)
      octree->index[octree->n_leaves++] = (uint32_t)i;
  for (size_t i = n; i-- > 0 && n_last > octree->n_leaves;)
    if (kinds[i] == KIND_UNDRAWN)
      octree->index[--n_last] = (uint32_t)i;
  return octree->n_leaves
             ? CONIC_OK
             : conic_fail(octree->context, CONIC_ERROR_INPUT, "octree: there is no splat that can be drawn");
}

static conic_status sort_out(conic_octree *octree, const conic_splats *splats) {
  conic_context *context = octree->context;
  sorting_out s = {splats, conic_memory_allocate(context, splats->count, sizeof *s.kinds)};
  conic_status status = CONIC_ERROR_MEMORY;
  octree->index = octree->owned_index = conic_memory_allocate(context, splats->count, sizeof *octree->index);
  if (s.kinds && octree->index) {
    conic_parallel_for(context, (splats->count + chunk_splats - 1) / chunk_splats, kind_chunk, &s);
    status = list_by_kind(octree, s.kinds);
  }
  conic_memory_release(context, s.kinds);
  return status;
}

typedef struct gathering {
  const uint32_t *index;
  const float *from;
  float *to;
  size_t n;
} gathering;

static void gather_chunk(void *data, size_t i_chunk) {
  const gathering *g = data;
  size_t begin = i_chunk * chunk_splats, end = begin + chunk_splats < g->n ? begin + chunk_splats : g->n;
  for (size_t i = begin; i < end; i++)
    g->to[i] = g->from[g->index[i]];
}

/* Brings an array into the order of the index; null stays null. */
static conic_status gather_floats(const conic_octree *octree, float **array) {
  gathering g = {.index = octree->index, .from = *array, .n = octree->n_points};
  if (!*array)
    return CONIC_OK;
  g.to = conic_memory_allocate(octree->context, g.n, sizeof *g.to);
  if (!g.to)
    return CONIC_ERROR_MEMORY;
  conic_parallel_for(octree->context, (g.n + chunk_splats - 1) / chunk_splats, gather_chunk, &g);
  conic_memory_release(octree->context, *array);
  *array = g.to;
  return CONIC_OK;
}

static conic_status gather_rest(conic_octree *octree) {
  conic_status status = CONIC_OK;
  conic_splats *leaves = &octree->owned;
  for (int axis = 0; axis < 3; axis++) {
    float **arrays[] = {&leaves->tangent_u[axis], &leaves->tangent_v[axis], &leaves->color[axis]};
    for (int i = 0; i < 3 && status == CONIC_OK; i++)
      status = gather_floats(octree, arrays[i]);
  }
  if (status == CONIC_OK)
    status = gather_floats(octree, &leaves->opacity);
  return status == CONIC_OK ? gather_floats(octree, &leaves->dot) : status;
}

/* The structure, and the splats in its order. */
static conic_status split(conic_octree *octree) {
  conic_context *context = octree->context;
  conic_splats *leaves = &octree->owned;
  conic_split work = {.index = octree->index, .n = octree->n_leaves};
  conic_status status = CONIC_OK;
  for (int axis = 0; axis < 3 && status == CONIC_OK && octree->n_leaves < octree->n_points; axis++)
    status = gather_floats(octree, &leaves->position[axis]);
  memcpy(work.position, leaves->position, sizeof work.position);
  work.children = conic_memory_allocate(context, octree->n_leaves, 1);
  if (!work.children)
    return CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = conic_octree_split(context, &work);
  if (status == CONIC_OK) {
    octree->n_nodes = work.n_nodes;
    octree->owned_codes = conic_memory_allocate(context, work.n_nodes, CONIC_NODE_BYTES);
    octree->codes = octree->owned_codes;
    status = octree->codes ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  for (size_t i = 0; i < work.n_nodes && status == CONIC_OK; i++)
    conic_code_children(work.children[i] & 15, work.children[i] >> 4, octree->codes + i * CONIC_NODE_BYTES);
  conic_memory_release(context, work.children);
  return status == CONIC_OK ? gather_rest(octree) : status;
}

/* What the scales go by, of some of the leaves. */
typedef struct leaf_range {
  float low[3], high[3], color;
  double longest2; /* of the sums of both axes' squares */
} leaf_range;

typedef struct ranging {
  const conic_octree *octree;
  leaf_range *chunks;
} ranging;

static void range_chunk(void *data, size_t i_chunk) {
  const ranging *r = data;
  const conic_splats *leaves = &r->octree->leaves;
  size_t begin = i_chunk * chunk_splats,
         end = begin + chunk_splats < r->octree->n_leaves ? begin + chunk_splats : r->octree->n_leaves;
  leaf_range range = {.color = 1.0f};
  for (int axis = 0; axis < 3; axis++) {
    const float *positions = leaves->position[axis], *colors = leaves->color[axis];
    float low = positions[begin], high = low;
    for (size_t i = begin; i < end; i++)
      CONIC_WIDEN(low, high, positions[i], positions[i]);
    for (size_t i = begin; i < end && colors; i++)
      range.color = colors[i] > range.color ? colors[i] : range.color;
    range.low[axis] = low;
    range.high[axis] = high;
  }
  for (size_t i = begin; i < end; i++) {
    double sum = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      double u = (double)leaves->tangent_u[axis][i], v = (double)leaves->tangent_v[axis][i];
      sum += u * u + v * v;
    }
    range.longest2 = sum > range.longest2 ? sum : range.longest2;
  }
  r->chunks[i_chunk] = range;
}

static void join_ranges(const leaf_range *more, leaf_range *range) {
  for (int axis = 0; axis < 3; axis++)
    CONIC_WIDEN(range->low[axis], range->high[axis], more->low[axis], more->high[axis]);
  range->color = more->color > range->color ? more->color : range->color;
  range->longest2 = more->longest2 > range->longest2 ? more->longest2 : range->longest2;
}

static conic_status find_leaf_range(const conic_octree *octree, leaf_range *range) {
  size_t n_chunks = (octree->n_leaves + chunk_splats - 1) / chunk_splats;
  ranging r = {octree, conic_memory_allocate(octree->context, n_chunks, sizeof *r.chunks)};
  if (!r.chunks)
    return CONIC_ERROR_MEMORY;
  conic_parallel_for(octree->context, n_chunks, range_chunk, &r);
  *range = r.chunks[0];
  for (size_t i = 1; i < n_chunks; i++)
    join_ranges(&r.chunks[i], range);
  conic_memory_release(octree->context, r.chunks);
  return CONIC_OK;
}

/* The scales of the codes: what nothing in the octree exceeds. */
static conic_status choose_scale(conic_octree *octree, double cutoff) {
  double diagonal2 = 0.0, length = 1.0;
  leaf_range range;
  conic_status status = find_leaf_range(octree, &range);
  if (status != CONIC_OK)
    return status;
  for (int axis = 0; axis < 3; axis++) {
    double extent = (double)range.high[axis] - (double)range.low[axis];
    diagonal2 += extent * extent;
  }
  /* The ellipse of a node reaches ten times as far as its leaves at most (least_ratio in octree_fit.c). */
  double wanted = 16.0 * (sqrt(diagonal2) + 2.0 * cutoff * sqrt(range.longest2)) / (cutoff < 1.0 ? cutoff : 1.0);
  while (length < wanted)
    length *= 2.0;
  while (length * 0.5 >= wanted)
    length *= 0.5;
  conic_code_scale_init(length, cutoff, range.color, &octree->scale);
  return CONIC_OK;
}

/* Rounds the leaves to what the codes of a quantised file give, and leaves out what cannot be drawn. */
static conic_status quantize(conic_octree *octree) {
  conic_context *context = octree->context;
  conic_splats *leaves = &octree->owned, before = {0};
  conic_status status = CONIC_OK;
  if (octree->n_points / (CONIC_OCTREE_MOST_LEFT_OUT + 1) > octree->n_leaves)
    return conic_fail(context, CONIC_ERROR_INPUT, "octree: too few of the splats can be drawn for a quantised file");
  leaves->count = octree->n_leaves;
  size_t n_bytes = conic_leaf_codes_bytes(leaves->count, leaves->color[0] != NULL, leaves->opacity != NULL);
  octree->is_quantized = 1;
  octree->owned_leaf_codes = conic_memory_allocate(context, n_bytes, 1);
  if (!octree->owned_leaf_codes)
    return CONIC_ERROR_MEMORY;
  octree->leaf_codes = octree->owned_leaf_codes;
  status = conic_splats_allocate(context, leaves->count, octree->n_clips ? CONIC_SPLATS_TANGENTS : 0u, &before);
  if (status != CONIC_OK)
    return status;
  for (int axis = 0; axis < 3; axis++) {
    memcpy(before.position[axis], leaves->position[axis], leaves->count * sizeof(float));
    if (octree->n_clips) {
      memcpy(before.tangent_u[axis], leaves->tangent_u[axis], leaves->count * sizeof(float));
      memcpy(before.tangent_v[axis], leaves->tangent_v[axis], leaves->count * sizeof(float));
    }
  }
  conic_leaf_encode(context, &octree->scale, leaves, octree->owned_leaf_codes);
  conic_leaf_decode(context, &octree->scale, octree->leaf_codes, leaves);
  conic_octree_move_clips(octree, &before, leaves);
  double greatest2 = 0.0;
  for (size_t i = 0; i < leaves->count; i++) {
    double moved2 = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      double moved = (double)leaves->position[axis][i] - (double)before.position[axis][i];
      moved2 += moved * moved;
    }
    greatest2 = moved2 > greatest2 ? moved2 : greatest2;
  }
  octree->position_error = sqrt(greatest2);
  octree->leaves = *leaves;
  conic_splats_release(context, &before);
  return CONIC_OK;
}

static conic_status lay_out_leaves(conic_octree *octree) {
  const char *wrong;
  conic_status status = conic_octree_lay_out(octree, &wrong);
  return wrong ? conic_fail(octree->context, CONIC_ERROR_ARGUMENT, "octree: %s", wrong) : status;
}

/* The measures of the whole set, as the renderer would take them. */
static conic_status measure_octree(conic_octree *octree, const conic_splats *splats) {
  conic_splats local = *splats;
  double low[3], high[3];
  memset(local.origin, 0, sizeof local.origin);
  conic_splats_bounds(&local, low, high);
  for (int axis = 0; axis < 3; axis++) {
    octree->low[axis] = (float)low[axis];
    octree->high[axis] = (float)high[axis];
  }
  return conic_splats_length(octree->context, splats, &octree->splat_length);
}

static conic_status build_octree(conic_octree *octree, const conic_octree_options *options) {
  conic_splats *leaves = &octree->owned;
  conic_status status = measure_octree(octree, leaves);
  if (status == CONIC_OK)
    status = sort_out(octree, leaves);
  if (status == CONIC_OK)
    status = split(octree);
  if (status != CONIC_OK)
    return status;
  status = conic_octree_index_clips(octree);
  if (status != CONIC_OK)
    return status;
  octree->leaves = *leaves;
  status = choose_scale(octree, (double)options->cutoff);
  if (status == CONIC_OK && options->quantize)
    status = quantize(octree);
  if (status == CONIC_OK)
    status = conic_octree_check_colors(octree);
  if (status == CONIC_OK)
    status = lay_out_leaves(octree);
  return status == CONIC_OK ? conic_octree_fit(octree) : status;
}

static const char *what_of_splats_is_wrong(const conic_splats *splats, const conic_octree_options *given,
                                           conic_octree_options *options) {
  conic_octree_options_init(options);
  if (!conic_options_take(options, given) || !(options->cutoff >= 0.25f && options->cutoff <= 5.0f))
    return "the options have no meaning";
  if (!splats->tangent_u[0])
    return "the splats have no tangent axes";
  if (splats->count > UINT32_MAX / 2) /* and inner nodes are numbered after them */
    return "there are more than 2,147,483,647 splats";
  return NULL;
}

conic_status conic_octree_build(conic_context *context, conic_splats *splats, const conic_octree_options *given,
                                conic_octree **octree) {
  conic_octree_options options;
  *octree = NULL;
  conic_status status = conic_splats_check_own(context, "octree", splats);
  if (status != CONIC_OK)
    return status;
  const char *wrong = what_of_splats_is_wrong(splats, given, &options);
  conic_octree *made = wrong ? NULL : conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made) {
    conic_splats_release(context, splats);
    return wrong ? conic_fail(context, CONIC_ERROR_ARGUMENT, "octree: %s", wrong) : CONIC_ERROR_MEMORY;
  }
  made->context = context;
  made->n_points = splats->count;
  conic_splats_repair_clips(splats);
  made->owned = *splats;
  memset(splats, 0, sizeof *splats);
  made->n_clips = made->owned.n_clips; /* they go by the index in the input, not by leaf */
  made->clips = made->owned_clips = made->owned.clips;
  made->owned.clips = NULL;
  made->owned.n_clips = 0;
  for (int axis = 0; axis < 3; axis++) { /* axes say it all */
    conic_memory_release(context, made->owned.normal[axis]);
    made->owned.normal[axis] = NULL;
  }
  if (!conic_splats_count_dots(&made->owned)) {
    conic_memory_release(context, made->owned.dot);
    made->owned.dot = NULL;
  }
  status = build_octree(made, &options);
  if (status == CONIC_OK)
    *octree = made;
  else
    conic_octree_destroy(made);
  return status;
}
