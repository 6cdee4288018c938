/* The leaves of a quantised octree: 12 bytes each, 3 more with colours, 1 more with opacities, and 24 for each block of
 * 64 leaves. A block's leaves share a box in which their positions are counted. Neighbours in the order of the tree are
 * neighbours in space, so the boxes are small. */
#include "lod/octree/octree_code.h"

#include "core/base/base.h"
#include "core/base/byte_order.h"
#include "core/base/vectors.h"
#include "core/splats/ellipse.h"

/* Where in a leaf's bytes: */
enum { AT_POSITION = 0, AT_NORMAL = 5, AT_DIRECTION = 8, AT_LENGTH = 9, AT_RATIO = 11, AT_REST = 12 };

/* Of each coordinate; three are 5 bytes. */
enum { POSITION_BITS = 13, POSITION_STEPS = (1 << POSITION_BITS) - 1 };

enum { BLOCKS_A_TASK = 64 };

static size_t leaf_code_bytes(int has_colors, int has_opacities) {
  return AT_REST + (has_colors ? 3u : 0u) + (has_opacities ? 1u : 0u);
}

static size_t count_blocks(size_t n_leaves) {
  return (n_leaves + CONIC_LEAF_BLOCK - 1) / CONIC_LEAF_BLOCK;
}

size_t conic_leaf_codes_bytes(size_t n_leaves, int has_colors, int has_opacities) {
  return count_blocks(n_leaves) * CONIC_LEAF_BLOCK_BYTES + n_leaves * leaf_code_bytes(has_colors, has_opacities);
}

/* The box of a block: its low corner and the steps of its positions, as little-endian floats. */
typedef struct leaf_box {
  float low[3], step[3];
} leaf_box;

static leaf_box find_leaf_box(const conic_splats *leaves, size_t begin, size_t end) {
  leaf_box box;
  for (int axis = 0; axis < 3; axis++) {
    const float *x = leaves->position[axis];
    float low = x[begin], high = x[begin];
    for (size_t i = begin; i < end; i++)
      CONIC_WIDEN(low, high, x[i], x[i]);
    box.low[axis] = low;
    box.step[axis] = (float)(((double)high - (double)low) / POSITION_STEPS * (1.0 + 1e-6));
  }
  return box;
}

static void encode_position(const leaf_box *box, const conic_splats *leaves, size_t i, unsigned char *code) {
  uint64_t bits = 0;
  for (int axis = 0; axis < 3; axis++) {
    double from_low = (double)leaves->position[axis][i] - (double)box->low[axis];
    double steps = box->step[axis] > 0.0f ? floor(from_low / (double)box->step[axis] + 0.5) : 0.0;
    bits |= (uint64_t)(steps < POSITION_STEPS ? steps : POSITION_STEPS) << POSITION_BITS * axis;
  }
  conic_store_bits(code + AT_POSITION, 5, bits);
}

static void encode_axes(const conic_code_scale *scale, const conic_splats *leaves, size_t i, unsigned char *code) {
  double u[3], v[3], normal[3], uu = 0.0, vv = 0.0, basis_u[3], basis_v[3], decoded[3], x = 0.0, y = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = (double)leaves->tangent_u[axis][i];
    v[axis] = (double)leaves->tangent_v[axis][i];
    uu += u[axis] * u[axis];
    vv += v[axis] * v[axis];
  }
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = u[(axis + 1) % 3] * v[(axis + 2) % 3] - u[(axis + 2) % 3] * v[(axis + 1) % 3];
  conic_code_normal(normal, code + AT_NORMAL);
  conic_code_normal_of(code + AT_NORMAL, decoded);
  conic_tangent_basis(decoded, basis_u, basis_v);
  const double *major = uu >= vv ? u : v;
  for (int axis = 0; axis < 3; axis++) {
    x += major[axis] * basis_u[axis];
    y += major[axis] * basis_v[axis];
  }
  double longer = sqrt(uu >= vv ? uu : vv), shorter = sqrt(uu >= vv ? vv : uu);
  uint16_t length = conic_code_length(scale, scale->length, longer);
  int ratio = (int)ceil(shorter / longer * 255.0);
  code[AT_DIRECTION] = conic_code_direction(x, y);
  conic_store_bits(code + AT_LENGTH, 2, length);
  code[AT_RATIO] = (unsigned char)(ratio < 1 ? 1 : ratio > 255 ? 255 : ratio);
}

static void encode_rest(const conic_code_scale *scale, const conic_splats *leaves, size_t i, unsigned char *code) {
  unsigned char *rest = code + AT_REST;
  for (int axis = 0; axis < 3 && leaves->color[0]; axis++)
    *rest++ = conic_code_srgb(scale, leaves->color[axis][i] / scale->color);
  if (leaves->opacity)
    *rest = conic_code_factor(scale, (double)leaves->opacity[i]);
}

static void decode_leaf(const conic_code_scale *scale, const leaf_box *box, const unsigned char *code,
                        conic_splats *leaves, size_t i) {
  double normal[3], u[3], v[3], direction[2];
  const unsigned char *rest = code + AT_REST;
  uint64_t bits = conic_load_bits(code + AT_POSITION, 5);
  conic_code_normal_of(code + AT_NORMAL, normal);
  conic_tangent_basis(normal, u, v);
  conic_code_direction_of(code[AT_DIRECTION], direction);
  double longer = conic_code_length_of(scale, scale->length, conic_load_16(code + AT_LENGTH));
  double shorter = longer * (double)code[AT_RATIO] / 255.0;
  for (int axis = 0; axis < 3; axis++) {
    double steps = (double)(bits >> POSITION_BITS * axis & POSITION_STEPS);
    leaves->position[axis][i] = (float)((double)box->low[axis] + (double)box->step[axis] * steps);
    leaves->tangent_u[axis][i] = (float)(longer * (direction[0] * u[axis] + direction[1] * v[axis]));
    leaves->tangent_v[axis][i] = (float)(shorter * (direction[0] * v[axis] - direction[1] * u[axis]));
    if (leaves->color[0])
      leaves->color[axis][i] = scale->color * scale->colors[*rest++];
  }
  if (leaves->opacity)
    leaves->opacity[i] = conic_code_factor_of(scale, *rest);
}

typedef struct leaf_job {
  const conic_code_scale *scale;
  conic_splats *leaves;
  unsigned char *codes;
  int is_encoding;
} leaf_job;

static void code_block(const leaf_job *job, size_t i_block) {
  conic_splats *leaves = job->leaves;
  size_t begin = i_block * CONIC_LEAF_BLOCK, end = begin + CONIC_LEAF_BLOCK;
  size_t n_bytes = leaf_code_bytes(leaves->color[0] != NULL, leaves->opacity != NULL);
  unsigned char *head = job->codes + i_block * CONIC_LEAF_BLOCK_BYTES;
  unsigned char *code = job->codes + count_blocks(leaves->count) * CONIC_LEAF_BLOCK_BYTES + begin * n_bytes;
  leaf_box box;
  end = end < leaves->count ? end : leaves->count;
  if (job->is_encoding) {
    box = find_leaf_box(leaves, begin, end);
    for (int axis = 0; axis < 3; axis++) {
      conic_store_float(head + (size_t)axis * 4, box.low[axis]);
      conic_store_float(head + 12 + (size_t)axis * 4, box.step[axis]);
    }
  } else {
    for (int axis = 0; axis < 3; axis++) {
      box.low[axis] = conic_load_float(head + (size_t)axis * 4);
      box.step[axis] = conic_load_float(head + 12 + (size_t)axis * 4);
    }
  }
  for (size_t i = begin; i < end; i++, code += n_bytes) {
    if (job->is_encoding) {
      encode_position(&box, leaves, i, code);
      encode_axes(job->scale, leaves, i, code);
      encode_rest(job->scale, leaves, i, code);
    } else
      decode_leaf(job->scale, &box, code, leaves, i);
  }
}

static void code_task(void *data, size_t i_task) {
  const leaf_job *job = data;
  size_t begin = i_task * BLOCKS_A_TASK, end = begin + BLOCKS_A_TASK, n_blocks = count_blocks(job->leaves->count);
  for (size_t i = begin; i < end && i < n_blocks; i++)
    code_block(job, i);
}

static void run_job(conic_context *context, leaf_job *job) {
  conic_parallel_for(context, (count_blocks(job->leaves->count) + BLOCKS_A_TASK - 1) / BLOCKS_A_TASK, code_task, job);
}

void conic_leaf_encode(conic_context *context, const conic_code_scale *scale, const conic_splats *leaves,
                       unsigned char *codes) {
  conic_splats arrays = *leaves;
  leaf_job job = {scale, &arrays, NULL, 1};
  job.codes = codes;
  run_job(context, &job);
}

void conic_leaf_decode(conic_context *context, const conic_code_scale *scale, const unsigned char *codes,
                       conic_splats *leaves) {
  leaf_job job = {scale, leaves, NULL, 0};
  memcpy(&job.codes, &codes, sizeof codes); /* only read */
  run_job(context, &job);
}
