#include "lod/octree/octree_nodes.h"

#include "core/base/rank.h"
#include "core/base/vectors.h"
#include "core/splats/near.h"

static const size_t chunk_nodes = 4096;

CONIC_DEFINE_OPTIONS(conic_octree_options, .cutoff = 1.5f)

void conic_octree_destroy(conic_octree *octree) {
  if (!octree)
    return;
  conic_context *context = octree->context;
  conic_splats_release(context, &octree->owned);
  conic_memory_release_these(context, octree->owned_index, octree->owned_clips, octree->clip_of_point,
                             octree->owned_codes, octree->owned_leaf_codes, octree->drawn, octree->drawn_leaves,
                             octree->center[0], octree->center[1], octree->center[2], octree->radius, octree->error,
                             octree->cone, octree->normal[0], octree->normal[1], octree->normal[2], octree->excess,
                             octree->end, octree->first_leaf);
  conic_mapping_close(context, &octree->mapping);
  conic_memory_release(context, octree);
}

conic_status conic_octree_index_clips(conic_octree *octree) {
  if (octree->n_clips == 0)
    return CONIC_OK;
  octree->clip_of_point = conic_memory_allocate(octree->context, octree->n_points, sizeof *octree->clip_of_point);
  if (!octree->clip_of_point)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < octree->n_points; i++)
    octree->clip_of_point[i] = CONIC_NO_CLIP;
  for (size_t i = 0; i < octree->n_clips; i++)
    octree->clip_of_point[octree->clips[i].splat] = (uint32_t)i;
  return CONIC_OK;
}

/* The nodes on the way from the root to the one that is looked at. */
typedef struct open_node {
  uint32_t i_node;
  int n_left; /* inner children that are still to come */
} open_node;

/* The nodes that are complete get their end. Returns how many stay open. */
static int close_nodes(conic_octree *octree, open_node *path, int depth, size_t next) {
  while (depth > 0 && path[depth - 1].n_left == 0) {
    octree->end[path[--depth].i_node] = (uint32_t)next;
    if (depth > 0)
      path[depth - 1].n_left--;
  }
  return depth;
}

static const char *lay_out_codes(conic_octree *octree) {
  open_node path[CONIC_OCTREE_DEPTH];
  size_t i_leaf = 0;
  int depth = 0;
  octree->n_levels = 0;
  for (size_t i = 0; i < octree->n_nodes; i++) {
    const uint8_t *code = octree->codes + i * CONIC_NODE_BYTES;
    int n_direct = conic_code_n_direct(code), n_inner = conic_code_n_inner(code);
    if (i > 0 && depth == 0)
      return "nodes that hang on none";
    if (n_direct + n_inner < 2 || n_direct + n_inner > CONIC_NODE_FANOUT)
      return "a node with other than 2 to 8 children";
    if (depth == CONIC_OCTREE_DEPTH)
      return "more than 128 levels";
    if ((size_t)n_direct > octree->n_leaves - i_leaf)
      return "nodes with more leaves than there are";
    octree->first_leaf[i] = (uint32_t)i_leaf;
    i_leaf += (size_t)n_direct;
    path[depth++] = (open_node){(uint32_t)i, n_inner};
    octree->n_levels = depth > octree->n_levels ? depth : octree->n_levels;
    depth = close_nodes(octree, path, depth, i + 1);
  }
  octree->first_leaf[octree->n_nodes] = (uint32_t)i_leaf;
  if (depth > 0)
    return "nodes that lack children";
  if (octree->n_nodes ? i_leaf != octree->n_leaves : octree->n_leaves > 1)
    return "leaves that hang on no node";
  return NULL;
}

conic_status conic_octree_lay_out(conic_octree *octree, const char **wrong) {
  *wrong = NULL;
  if (conic_memory_allocate_these(octree->context, CONIC_ROOM(octree->end, octree->n_nodes),
                                  CONIC_ROOM(octree->first_leaf, octree->n_nodes + 1)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  *wrong = lay_out_codes(octree);
  return CONIC_OK;
}

/* The square of how many times the error is what the size of the disc alone makes it, 1 at least: a quarter of the
 * major axis, or what lies between the places that were looked at, and a step of the code. */
static float excess_of(const conic_code_scale *scale, const conic_node *node) {
  const float *u = node->tangent_u;
  float length = sqrtf((u[0] * u[0] + u[1] * u[1]) + u[2] * u[2]);
  float times = node->error / (0.28f * (float)scale->cutoff * length);
  return times > 1.0f ? times * times : 1.0f;
}

static void decode_chunk(void *data, size_t i_chunk) {
  conic_octree *octree = data;
  size_t begin = i_chunk * chunk_nodes,
         end = begin + chunk_nodes < octree->n_nodes ? begin + chunk_nodes : octree->n_nodes;
  for (size_t i = begin; i < end; i++) {
    conic_node node;
    double first[3];
    conic_vector_at(octree->leaves.position, octree->first_leaf[i], first);
    conic_code_decode(&octree->scale, first, octree->codes + i * CONIC_NODE_BYTES, &node);
    conic_drawn_node *drawn = &octree->drawn[i];
    memset(drawn, 0, sizeof *drawn);
    memcpy(drawn->position, node.position, sizeof drawn->position);
    memcpy(drawn->tangent_u, node.tangent_u, sizeof drawn->tangent_u);
    memcpy(drawn->tangent_v, node.tangent_v, sizeof drawn->tangent_v);
    memcpy(drawn->color, node.color, sizeof drawn->color);
    drawn->opacity = node.opacity;
    drawn->id = (uint32_t)(octree->n_points + i);
    for (int axis = 0; axis < 3; axis++) {
      octree->center[axis][i] = node.position[axis];
      octree->normal[axis][i] = node.normal[axis];
    }
    octree->radius[i] = node.radius;
    octree->error[i] = node.error;
    octree->cone[i] = node.cone;
    octree->excess[i] = excess_of(&octree->scale, &node);
  }
}

static conic_status allocate_decoded(conic_octree *octree) {
  conic_context *context = octree->context;
  float **arrays[] = {&octree->center[0], &octree->center[1], &octree->center[2], &octree->radius,    &octree->error,
                      &octree->cone,      &octree->normal[0], &octree->normal[1], &octree->normal[2], &octree->excess};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
    conic_memory_release(context, *arrays[i]); /* of an attempt that failed */
    *arrays[i] = conic_memory_allocate(context, octree->n_nodes + CONIC_OCTREE_GROUP, sizeof(float));
    if (!*arrays[i])
      return CONIC_ERROR_MEMORY;
    conic_memory_prefer_large_pages(context, *arrays[i], octree->n_nodes * sizeof(float));
    memset(*arrays[i] + octree->n_nodes, 0, CONIC_OCTREE_GROUP * sizeof(float));
  }
  octree->drawn = conic_memory_allocate(context, octree->n_nodes, sizeof *octree->drawn);
  if (!octree->drawn)
    return CONIC_ERROR_MEMORY;
  conic_memory_prefer_large_pages(context, octree->drawn, octree->n_nodes * sizeof *octree->drawn);
  return CONIC_OK;
}

conic_status conic_octree_decode(conic_octree *octree) {
  if (octree->drawn)
    return CONIC_OK;
  conic_status status = allocate_decoded(octree);
  if (status == CONIC_OK)
    conic_parallel_for(octree->context, (octree->n_nodes + chunk_nodes - 1) / chunk_nodes, decode_chunk, octree);
  return status;
}

static void copy_chunk(void *data, size_t i_chunk) {
  conic_octree *octree = data;
  const conic_splats *leaves = &octree->leaves;
  size_t begin = i_chunk * chunk_nodes, end = begin + chunk_nodes;
  for (size_t i = begin; i < end && i < octree->n_leaves; i++) {
    conic_drawn_node drawn = {.opacity = leaves->opacity ? leaves->opacity[i] : 1.0f,
                              .id = octree->index[i],
                              .dot = leaves->dot ? leaves->dot[i] : 0.0f};
    for (int axis = 0; axis < 3; axis++) {
      drawn.position[axis] = leaves->position[axis][i];
      drawn.tangent_u[axis] = leaves->tangent_u[axis][i];
      drawn.tangent_v[axis] = leaves->tangent_v[axis][i];
      drawn.color[axis] = leaves->color[axis] ? leaves->color[axis][i] : 1.0f;
    }
    octree->drawn_leaves[i] = drawn;
  }
}

conic_status conic_octree_decode_all(conic_octree *octree) {
  conic_status status = conic_octree_decode(octree);
  if (status != CONIC_OK || octree->drawn_leaves)
    return status;
  octree->drawn_leaves = conic_memory_allocate(octree->context, octree->n_leaves, sizeof *octree->drawn_leaves);
  if (!octree->drawn_leaves)
    return CONIC_ERROR_MEMORY;
  conic_memory_prefer_large_pages(octree->context, octree->drawn_leaves,
                                  octree->n_leaves * sizeof *octree->drawn_leaves);
  conic_parallel_for(octree->context, (octree->n_leaves + chunk_nodes - 1) / chunk_nodes, copy_chunk, octree);
  return CONIC_OK;
}

double conic_octree_dot_radius(const conic_octree *octree, size_t i_leaf) {
  double u[3], v[3];
  if (!octree->leaves.dot || octree->leaves.dot[i_leaf] == 0.0f)
    return 0.0;
  conic_vector_at(octree->leaves.tangent_u, i_leaf, u);
  conic_vector_at(octree->leaves.tangent_v, i_leaf, v);
  return octree->scale.cutoff * fmax(conic_length(u), conic_length(v));
}

/* Least, median, greatest. */
static void find_quantiles(const float *values, size_t n, double quantiles[3]) {
  const size_t ranks[3] = {0, (n - 1) / 2, n - 1};
  for (int i = 0; i < 3; i++)
    quantiles[i] = n ? (double)conic_float_of_rank(values, n, ranks[i]) : 0.0;
}

typedef struct node_spreads {
  const conic_octree *octree;
  float *radii, *cones;
} node_spreads;

static void spread_chunk(void *data, size_t i_chunk) {
  const node_spreads *spreads = data;
  const conic_octree *octree = spreads->octree;
  size_t begin = i_chunk * chunk_nodes,
         end = begin + chunk_nodes < octree->n_nodes ? begin + chunk_nodes : octree->n_nodes;
  for (size_t i = begin; i < end; i++) {
    const uint8_t *code = octree->codes + i * CONIC_NODE_BYTES;
    spreads->radii[i] = conic_code_radius_of(&octree->scale, code);
    spreads->cones[i] = conic_code_cone_of(code);
  }
}

/* Of all radii and cones, straight from the codes. */
static conic_status find_spreads(const conic_octree *octree, conic_octree_info *info) {
  size_t n = octree->n_nodes;
  float *radii = conic_memory_allocate(octree->context, n, sizeof *radii);
  float *cones = conic_memory_allocate(octree->context, n, sizeof *cones);
  conic_status status = radii && cones ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    node_spreads spreads = {octree, radii, cones};
    conic_parallel_for(octree->context, (n + chunk_nodes - 1) / chunk_nodes, spread_chunk, &spreads);
    find_quantiles(radii, n, info->radius);
    find_quantiles(cones, n, info->cone);
  }
  conic_memory_release_these(octree->context, radii, cones);
  return status;
}

static void find_octree_box(const conic_octree *octree, double low[3], double high[3]) {
  for (int axis = 0; axis < 3; axis++) {
    low[axis] = octree->leaves.origin[axis] + (double)octree->low[axis];
    high[axis] = octree->leaves.origin[axis] + (double)octree->high[axis];
  }
}

double conic_octree_near(const conic_octree *octree) {
  double low[3], high[3];
  find_octree_box(octree, low, high);
  return conic_near_of_box(low, high);
}

conic_status conic_octree_describe(const conic_octree *octree, conic_octree_info *info) {
  memset(info, 0, sizeof *info);
  info->n_points = octree->n_points;
  info->n_leaves = octree->n_leaves;
  info->n_nodes = octree->n_nodes;
  info->n_levels = octree->n_levels;
  info->is_quantized = octree->is_quantized;
  info->cutoff = (float)octree->scale.cutoff;
  info->splat_length = octree->splat_length;
  info->position_error = octree->position_error;
  info->n_bytes = conic_octree_file_bytes(octree);
  find_octree_box(octree, info->minimum, info->maximum);
  info->near_z = conic_octree_near(octree);
  return find_spreads(octree, info);
}

/* A splat that cannot be drawn. */
static void blank(conic_splats *splats, size_t i) {
  for (int axis = 0; axis < 3; axis++) {
    splats->position[axis][i] = splats->tangent_u[axis][i] = splats->tangent_v[axis][i] = NAN;
    if (splats->color[axis])
      splats->color[axis][i] = 0.0f;
  }
  if (splats->opacity)
    splats->opacity[i] = 0.0f;
  if (splats->dot)
    splats->dot[i] = 0.0f;
}

typedef struct leaf_copy {
  const conic_octree *octree;
  conic_splats *splats;
} leaf_copy;

static void copy_leaves(void *data, size_t i_chunk) {
  const leaf_copy *copy = data;
  const conic_splats *from = &copy->octree->leaves;
  conic_splats *to = copy->splats;
  const uint32_t *index = copy->octree->index;
  size_t begin = i_chunk * chunk_nodes, end = begin + chunk_nodes < from->count ? begin + chunk_nodes : from->count;
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = begin; i < end; i++) {
      to->position[axis][index[i]] = from->position[axis][i];
      to->tangent_u[axis][index[i]] = from->tangent_u[axis][i];
      to->tangent_v[axis][index[i]] = from->tangent_v[axis][i];
      if (from->color[axis])
        to->color[axis][index[i]] = from->color[axis][i];
    }
  for (size_t i = begin; i < end && from->opacity; i++)
    to->opacity[index[i]] = from->opacity[i];
  for (size_t i = begin; i < end && from->dot; i++)
    to->dot[index[i]] = from->dot[i];
}

conic_status conic_octree_leaves(const conic_octree *octree, conic_splats *splats) {
  const conic_splats *leaves = &octree->leaves;
  leaf_copy copy = {octree, splats};
  unsigned fields = conic_splats_fields(leaves) | (octree->n_clips ? (unsigned)CONIC_SPLATS_CLIPS : 0u);
  conic_status status = conic_splats_allocate(octree->context, octree->n_points, fields, splats);
  if (status != CONIC_OK)
    return status;
  splats->n_clips = octree->n_clips;
  if (octree->n_clips)
    memcpy(splats->clips, octree->clips, octree->n_clips * sizeof *splats->clips);
  memcpy(splats->origin, leaves->origin, sizeof splats->origin);
  for (size_t i = 0; leaves->count < octree->n_points && i < octree->n_points; i++) /* those that are not kept */
    blank(splats, i);
  conic_parallel_for(octree->context, (leaves->count + chunk_nodes - 1) / chunk_nodes, copy_leaves, &copy);
  return CONIC_OK;
}

/* --- clip lines --- */

static double dot_at(float *const a[3], size_t i, float *const b[3], size_t k) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; axis++)
    sum += (double)a[axis][i] * (double)b[axis][k];
  return sum;
}

/* A line says where a·u + b·v + c is at least 0. In space that is a direction in the splat's plane and what it is at
 * the centre; both are looked at from the rounded splat's centre and along its axes. */
static void move_line(const conic_splats *before, const conic_splats *after, size_t i, float line[3]) {
  double uu = dot_at(before->tangent_u, i, before->tangent_u, i),
         vv = dot_at(before->tangent_v, i, before->tangent_v, i);
  double uv = dot_at(before->tangent_u, i, before->tangent_v, i), determinant = uu * vv - uv * uv;
  double along_u = ((double)line[0] * vv - (double)line[1] * uv) / determinant;
  double along_v = ((double)line[1] * uu - (double)line[0] * uv) / determinant;
  double moved[3] = {0.0, 0.0, (double)line[2]};
  for (int axis = 0; axis < 3; axis++) {
    double slope = along_u * (double)before->tangent_u[axis][i] + along_v * (double)before->tangent_v[axis][i];
    moved[0] += slope * (double)after->tangent_u[axis][i];
    moved[1] += slope * (double)after->tangent_v[axis][i];
    moved[2] += slope * ((double)after->position[axis][i] - (double)before->position[axis][i]);
  }
  for (int k = 0; k < 3; k++)
    line[k] = (float)moved[k];
}

void conic_octree_move_clips(conic_octree *octree, const conic_splats *before, const conic_splats *after) {
  for (size_t i = 0; octree->n_clips && i < octree->n_leaves; i++) {
    uint32_t i_clip = octree->clip_of_point[octree->index[i]];
    for (int k = 0; i_clip != CONIC_NO_CLIP && k < octree->clips[i_clip].n_lines; k++)
      move_line(before, after, i, octree->clips[i_clip].lines[k]);
  }
}
