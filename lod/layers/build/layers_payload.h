/* What of the samples goes into a layered cloud beside place, normal, colour and size: ellipses, opacities, clip lines,
 * values by name; and the table of attributes that says so. */
#ifndef CONIC_LAYERS_PAYLOAD_H
#define CONIC_LAYERS_PAYLOAD_H

#include "conic/splats.h"
#include "core/coloring/value_limits.h"
#include "core/splats/point_values.h"
#include "lod/layers/format/layers_axes.h"

typedef struct conic_layers_payload {
  conic_context *context;
  conic_layers_schema schema;
  float cutoff;
  int axes, opacity, dot, clip; /* attributes; 0: it has none of it */
  uint64_t n_translucent, n_dots, n_clips;
  float shortest, longest; /* axes or outlines: of those that have one */
  size_t n_values;
  uint32_t value[CONIC_MOST_POINT_VALUES];       /* attributes */
  const double *column[CONIC_MOST_POINT_VALUES]; /* of the batch; null: it has none */
  size_t n_column;                               /* so many of each */
  double low[CONIC_MOST_POINT_VALUES], high[CONIC_MOST_POINT_VALUES];
  conic_value_sample *seen[CONIC_MOST_POINT_VALUES];
  size_t i_clip; /* of the batch, the next record */
} conic_layers_payload;

/* What the first batch has is what all samples get. Errors: MEMORY. */
conic_status conic_layers_payload_begin(conic_context *context, const conic_splats *batch, int is_full, float cutoff,
                                        conic_layers_payload *payload);
void conic_layers_payload_end(conic_layers_payload *payload);

/* Looks for the values in another batch. */
void conic_layers_payload_turn_to(conic_layers_payload *payload, const conic_splats *batch);

/* The clip lines of splat i of the batch, or null; splats come in their order. */
const conic_clip *conic_layers_payload_clip(conic_layers_payload *payload, const conic_splats *batch, size_t i);

/* Fills the bytes behind the head of a record from splat i of the batch; splats come in their order. */
void conic_layers_payload_take(conic_layers_payload *payload, const conic_splats *batch, size_t i, void *extra);

/* The values of splat i as the batch has them, n_values of them. */
void conic_layers_payload_row(const conic_layers_payload *payload, size_t i, double *row);

/* Now that all have come: the table of attributes, without those that no sample has. `spacing` is what lengths that are
 * not known yet will be about. */
void conic_layers_payload_settle(conic_layers_payload *payload, double spacing);

#endif
