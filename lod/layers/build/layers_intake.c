#include "lod/layers/build/layers_intake.h"

#include <math.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/real.h"
#include "core/base/vectors.h"

conic_status conic_layers_intake_begin(conic_context *context, const char *path, size_t memory_bytes, float cutoff,
                                       int is_full, const conic_team *team, conic_layers_intake *intake) {
  memset(intake, 0, sizeof *intake);
  intake->team = team;
  intake->context = context;
  intake->cutoff = cutoff;
  intake->is_full = is_full;
  intake->stride = 1;
  for (int axis = 0; axis < 3; axis++) {
    intake->low[axis] = HUGE_VAL;
    intake->high[axis] = -HUGE_VAL;
  }
  conic_code_scale_init(1.0, 1.0, 1.0f, &intake->scale);
  conic_spool_begin(context, path, memory_bytes, &intake->spool);
  conic_spool_begin(context, path, CONIC_SPOOL_SLAB, &intake->columns);
  return CONIC_OK;
}

conic_status conic_layers_intake_start(conic_layers_intake *intake, const conic_splats *batch) {
  conic_status status =
      conic_layers_payload_begin(intake->context, batch, intake->is_full, intake->cutoff, &intake->payload);
  intake->extra_bytes = intake->payload.schema.extra_bytes;
  intake->raw_bytes = (sizeof(conic_layers_raw) + intake->extra_bytes + 7) / 8 * 8;
  intake->pending = conic_memory_allocate(intake->context, CONIC_LAYERS_BLOCK, intake->raw_bytes);
  intake->has_started = 1;
  intake->has_colors = batch->color[0] != NULL;
  return status == CONIC_OK && !intake->pending ? CONIC_ERROR_MEMORY : status;
}

void conic_layers_intake_end(conic_layers_intake *intake) {
  if (!intake->context)
    return;
  conic_spool_end(&intake->spool);
  conic_spool_end(&intake->columns);
  conic_layers_payload_end(&intake->payload);
  conic_memory_release(intake->context, intake->pending);
  intake->pending = NULL;
}

static int is_finite(const float v[3]) {
  return v[0] - v[0] == 0.0f && v[1] - v[1] == 0.0f && v[2] - v[2] == 0.0f;
}

static void vector_at(float *const arrays[3], size_t i, float v[3]) {
  for (int axis = 0; axis < 3; axis++)
    v[axis] = arrays[axis][i];
}

/* Of a length that the square of neither overflows nor vanishes. */
static int is_direction(const float v[3]) {
  double length2 = (double)v[0] * (double)v[0] + (double)v[1] * (double)v[1] + (double)v[2] * (double)v[2];
  return length2 > 1e-60 && length2 < 1e60;
}

/* Of an ellipse's area, the share that its clip lines leave, counted at places in it. */
static double share_left(const conic_clip *clip, float cutoff) {
  enum { ACROSS = 6, SQUARE = 42 }; /* of a disc of radius 6.5 */
  int n = 0, n_left = 0;
  for (int i = -ACROSS; i <= ACROSS; i++)
    for (int k = -ACROSS; k <= ACROSS; k++) {
      int n_kept = 0;
      if (i * i + k * k > SQUARE)
        continue;
      for (int line = 0; line < clip->n_lines; line++) {
        const float *l = clip->lines[line];
        n_kept += !((l[0] * (float)i + l[1] * (float)k) * cutoff / ((float)ACROSS + 0.5f) + l[2] < 0.0f);
      }
      n++;
      n_left += n_kept >= (clip->operation == CONIC_CLIP_OR ? 1 : clip->n_lines);
    }
  return (double)n_left / (double)n;
}

/* The outline of the circle that stands for an ellipse: between one that holds all of it and one as large as what is
 * drawn of it, as near to the latter as leaves no slits, by experiment. A full payload has the ellipse, and a bound. */
static float outline_of(const conic_layers_intake *intake, double longer, double shorter, const conic_clip *clip) {
  double share = clip && !intake->is_full ? share_left(clip, intake->cutoff) : 1.0;
  double length = intake->is_full ? longer : (2.0 * longer + sqrt(longer * shorter * share)) / 3.0;
  return (float)(length * (double)intake->cutoff);
}

/* The normal and the outline of a splat with axes; whether it has them. */
static int take_axes(conic_layers_intake *intake, const conic_splats *batch, size_t i, conic_layers_raw *raw) {
  float u[3], v[3];
  vector_at(batch->tangent_u, i, u);
  vector_at(batch->tangent_v, i, v);
  if (!is_finite(u) || !is_finite(v) || !is_direction(u) || !is_direction(v))
    return 0;
  double a[3] = {(double)u[0], (double)u[1], (double)u[2]}, b[3] = {(double)v[0], (double)v[1], (double)v[2]}, cross[3];
  double length_a = conic_length(a), length_b = conic_length(b);
  conic_normalize(a);
  conic_normalize(b);
  conic_cross(a, b, cross);
  const float normal[3] = {(float)cross[0], (float)cross[1], (float)cross[2]};
  if (!is_direction(normal))
    return 0;
  conic_layers_code_normal(normal, raw->normal);
  float outline =
      outline_of(intake, length_a > length_b ? length_a : length_b, length_a > length_b ? length_b : length_a,
                 conic_layers_payload_clip(&intake->payload, batch, i));
  raw->size = conic_layers_code_size(outline);
  if (raw->size && !intake->is_full) {
    intake->payload.shortest = outline < intake->payload.shortest ? outline : intake->payload.shortest;
    intake->payload.longest = outline > intake->payload.longest ? outline : intake->payload.longest;
  }
  return 1;
}

/* The direction of a normal, or of a sight; 0 where it has none. */
static int take_direction(float *const direction[3], size_t i, conic_layers_raw *raw) {
  float normal[3];
  vector_at(direction, i, normal);
  if (!is_finite(normal) || !is_direction(normal))
    return 0;
  conic_layers_code_normal(normal, raw->normal);
  return 1;
}

static void take_color(conic_layers_intake *intake, const conic_splats *batch, size_t i, conic_layers_raw *raw) {
  int is_bright = 0;
  for (int channel = 0; channel < 3; channel++) {
    float value = batch->color[channel][i];
    is_bright |= value > 1.0f;
    raw->color[channel] = conic_code_srgb(&intake->scale, value);
  }
  intake->n_bright += is_bright != 0;
}

static void remember_some(conic_layers_intake *intake, const double position[3]) {
  if (intake->n_samples % intake->stride)
    return;
  if (intake->n_some == CONIC_LAYERS_SOME) { /* every other, from now on */
    for (size_t i = 0; i < CONIC_LAYERS_SOME / 2; i++)
      memcpy(intake->some[i], intake->some[2 * i], sizeof intake->some[i]);
    intake->n_some /= 2;
    intake->stride *= 2;
    if (intake->n_samples % intake->stride)
      return;
  }
  memcpy(intake->some[intake->n_some++], position, 3 * sizeof *position);
}

/* One sample into `raw`; whether it can be used. */
static int take_sample(conic_layers_intake *intake, const conic_splats *batch, size_t i, conic_layers_raw *raw) {
  double position[3];
  memset(raw, 0, intake->raw_bytes);
  vector_at(batch->position, i, raw->position);
  for (int axis = 0; axis < 3; axis++)
    position[axis] = batch->origin[axis] + (double)raw->position[axis];
  if (!is_finite(raw->position) || !(fabs(position[0]) + fabs(position[1]) + fabs(position[2]) < 1e15)) {
    intake->n_nan++;
    return 0;
  }
  for (int axis = 0; axis < 3; axis++) {
    intake->low[axis] = position[axis] < intake->low[axis] ? position[axis] : intake->low[axis];
    intake->high[axis] = position[axis] > intake->high[axis] ? position[axis] : intake->high[axis];
  }
  int has_normal = batch->tangent_u[0] && take_axes(intake, batch, i, raw);
  if (!has_normal && batch->normal[0])
    has_normal = take_direction(batch->normal, i, raw);
  int is_seen = !has_normal && batch->sight[0] && take_direction(batch->sight, i, raw);
  raw->is_bare = has_normal ? 0 : is_seen ? CONIC_LAYERS_SEEN : CONIC_LAYERS_BARE;
  intake->n_bare += !has_normal;
  intake->n_unseen += !has_normal && !is_seen;
  if (batch->color[0])
    take_color(intake, batch, i, raw);
  conic_layers_payload_take(&intake->payload, batch, i, raw + 1);
  remember_some(intake, position);
  intake->n_samples++;
  intake->n_own++;
  return 1;
}

/* One sample, into what waits of a block. */
static conic_status take_one(conic_layers_intake *intake, const conic_splats *batch, size_t i,
                             conic_layers_block *block) {
  double row[CONIC_MOST_POINT_VALUES];
  unsigned char *raw = intake->pending + (size_t)block->count * intake->raw_bytes;
  if (!take_sample(intake, batch, i, (conic_layers_raw *)(void *)raw))
    return CONIC_OK;
  block->count++;
  if (!intake->team || intake->payload.n_values == 0)
    return CONIC_OK;
  conic_layers_payload_row(&intake->payload, i, row);
  return conic_spool_append(&intake->columns, row, intake->payload.n_values * sizeof *row);
}

conic_status conic_layers_intake_append(conic_layers_intake *intake, const conic_splats *batch) {
  conic_status begun = intake->has_started || batch->count == 0 ? CONIC_OK
                       : intake->team                           ? conic_layers_intake_meet(intake, batch, 0)
                                                                : conic_layers_intake_start(intake, batch);
  if (begun != CONIC_OK)
    return begun;
  if (intake->has_started && (batch->color[0] != NULL) != intake->has_colors)
    return conic_fail(intake->context, CONIC_ERROR_ARGUMENT, "%s: some samples have colours, others have none",
                      intake->spool.path);
  conic_layers_payload_turn_to(&intake->payload, batch);
  for (size_t first = 0; first < batch->count; first += CONIC_LAYERS_BLOCK) {
    size_t left = batch->count - first, end = first + (left < CONIC_LAYERS_BLOCK ? left : CONIC_LAYERS_BLOCK);
    conic_layers_block block = {.count = 0};
    memcpy(block.origin, batch->origin, sizeof block.origin);
    conic_status status = CONIC_OK;
    for (size_t i = first; i < end && status == CONIC_OK; i++)
      status = take_one(intake, batch, i, &block);
    intake->n_in += end - first;
    if (status == CONIC_OK)
      status = conic_spool_append(&intake->spool, &block, sizeof block);
    if (status == CONIC_OK)
      status = conic_spool_append(&intake->spool, intake->pending, (size_t)block.count * intake->raw_bytes);
    if (status != CONIC_OK)
      return status;
  }
  return CONIC_OK;
}

conic_status conic_layers_intake_read(const conic_layers_intake *intake, uint64_t *offset, conic_layers_block *block,
                                      unsigned char *samples, int *is_there) {
  *is_there = *offset < conic_spool_bytes(&intake->spool);
  if (!*is_there)
    return CONIC_OK;
  conic_status status = conic_spool_read(&intake->spool, *offset, block, sizeof *block);
  *offset += sizeof *block;
  if (status == CONIC_OK)
    status = conic_spool_read(&intake->spool, *offset, samples, (size_t)block->count * intake->raw_bytes);
  *offset += block->count * intake->raw_bytes;
  return status;
}
