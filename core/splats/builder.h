/* A model that grows while it is read. */
#pragma once

#include "core/splats/point_values.h"

/* Some of a file's points in a row, counted as they stand there, wanted or not: from `first` to before `end`. */
typedef struct conic_points_range {
  uint64_t first, end;
} conic_points_range;

/* Where a file's points go that are not kept: see conic_model_stream. All kinds of points but PLY deliver
 * colours as they stand in the file. */
typedef struct conic_delivery {
  conic_batch_receiver *receive;
  void *cookie;
  size_t batch;                    /* points that are handed over at a time */
  int is_survey;                   /* all points are looked at, wanted or not */
  int is_again;                    /* the file has been read before: what can be told of it has been */
  const conic_points_range *range; /* which points go there, of a PLY or LAS; null: all */
  uint64_t *n_wanted;              /* counts those that are wanted; or null */
  /* A PLY's triangles, some at a time; or null: they are passed over. */
  conic_status (*receive_faces)(void *cookie, const uint32_t (*corners)[3], size_t n);
} conic_delivery;

typedef struct conic_builder {
  conic_context *context;
  const conic_delivery *delivery; /* null: the points are kept */
  uint64_t n_delivered;           /* no longer in the model */
  conic_model *model;             /* points.count says how many points have been filled in */
  size_t point_capacity, triangle_capacity, clip_capacity, field_capacity;
  int is_origin_set;
} conic_builder;

/* The most points a model can have: indices are 32 bits and the largest stands for none. */
#define CONIC_MAX_POINTS UINT64_C(0xFFFFFFFE)

/* Starts with an empty model whose points have the optional arrays of `fields`. What has been built is released by
 * conic_model_release. Errors: MEMORY. */
conic_status conic_builder_begin(conic_context *context, conic_model *model, unsigned fields,
                                 const conic_delivery *delivery, conic_builder *builder);

/* Hands the points over, where they are not kept and are enough for a batch, or all the same if `is_last`; then there
 * are none. Those that are not wanted are left out before, or, of points that are kept, at the last. Errors: the
 * receiver's. */
conic_status conic_builder_deliver(conic_builder *builder, int is_last);

/* Points that have been built, delivered or not. */
static inline uint64_t conic_builder_points(const conic_builder *builder) {
  return builder->n_delivered + builder->model->points.count;
}

/* Room for `count` points in all; grows at least by half, so that many small steps cost little. Errors: MEMORY. */
conic_status conic_builder_reserve_points(conic_builder *builder, size_t count);

/* Room for exactly `count` points, or more where there is more. Errors: MEMORY. */
conic_status conic_builder_reserve_points_exactly(conic_builder *builder, size_t count);

/* Puts the next point there, which the caller counts. Where the first finite one lies far out, as in map coordinates,
 * which have digits that a float has not, it becomes the origin. */
void conic_builder_store_position(conic_builder *builder, const double position[3]);

/* What the reader has to fill, where values are asked for: so many columns, of each the field, and its place for the
 * next point. A field below 0 is not the reader's. */
static inline size_t conic_builder_columns(const conic_builder *builder) {
  return builder->model->points.values ? builder->model->points.values->n_columns : 0;
}
static inline int conic_builder_column_field(const conic_builder *builder, size_t column) {
  return builder->model->points.values->source[column];
}
static inline double *conic_builder_column(const conic_builder *builder, size_t column) {
  return builder->model->points.values->value[column] + builder->model->points.count;
}

/* Gives the points another optional array (clip lines are none), filled with white, 1 or zero for those that there are.
 * Errors: MEMORY. */
conic_status conic_builder_add_field(conic_builder *builder, conic_splats_field field);

/* Appends a record of clip lines; they come in the order of their splats. Errors: MEMORY. */
conic_status conic_builder_add_clip(conic_builder *builder, const conic_clip *clip);

/* Errors: MEMORY. */
conic_status conic_builder_add_triangle(conic_builder *builder, uint32_t a, uint32_t b, uint32_t c);
