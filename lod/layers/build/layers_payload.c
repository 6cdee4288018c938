/* What of a sample goes into the cloud beside place, normal, colour and size. */

#include "lod/layers/build/layers_raws.h"

/* How many of a length's 23 bits of fraction are kept. */
enum { AXES_KEPT = 12, MOST_OF_SIZE = 4, FRACTION_BITS = 23 };

static void add_dots(conic_layers_payload *p) {
  if (conic_layers_schema_add(&p->schema, CONIC_LAYERS_DOT, "dot", 0))
    p->dot = (int)p->schema.n - 1;
}

static conic_status add_values(conic_layers_payload *p, const conic_point_values *values) {
  for (size_t k = 0; values && k < values->n; k++) {
    const conic_model_field *field = &values->field[k];
    int type = field->type ? conic_layers_number_of(field->type) : -1;
    conic_layers_attribute *added = conic_layers_schema_add(&p->schema, CONIC_LAYERS_VALUE, field->name,
                                                            type < 0 ? CONIC_LAYERS_DOUBLE : (unsigned)type);
    if (!added)
      break;
    p->seen[p->n_values] = conic_memory_allocate_zeroed(p->context, 1, sizeof **p->seen);
    if (!p->seen[p->n_values])
      return CONIC_ERROR_MEMORY;
    p->value[p->n_values++] = p->schema.n - 1;
  }
  return CONIC_OK;
}

conic_status conic_layers_payload_begin(conic_context *context, const conic_splats *batch, int is_full, float cutoff,
                                        conic_layers_payload *payload) {
  conic_layers_schema *schema = &payload->schema;
  memset(payload, 0, sizeof *payload);
  payload->context = context;
  payload->cutoff = cutoff;
  conic_layers_facts_init(&payload->facts);
  conic_layers_schema_add(schema, CONIC_LAYERS_POSITION, "position", 0);
  conic_layers_schema_add(schema, is_full ? CONIC_LAYERS_AXES : CONIC_LAYERS_NORMAL, is_full ? "axes" : "normal", 0);
  if (batch->color[0])
    conic_layers_schema_add(schema, CONIC_LAYERS_COLOR, "color", 0);
  if (!is_full) {
    conic_layers_schema_add(schema, CONIC_LAYERS_SIZE, "size", 0);
  } else {
    payload->axes = 1;
    payload->opacity = (int)schema->n;
    conic_layers_schema_add(schema, CONIC_LAYERS_OPACITY, "opacity", 0);
    payload->clip = (int)schema->n;
    conic_layers_schema_add(schema, CONIC_LAYERS_CLIP, "clip", 0);
    add_dots(payload);
  }
  conic_status status = add_values(payload, batch->values);
  if (!is_full) /* last in a record, so that records are shorter where there are none */
    add_dots(payload);
  return status;
}

void conic_layers_payload_end(conic_layers_payload *payload) {
  for (size_t k = 0; k < payload->n_values; k++)
    conic_memory_release(payload->context, payload->seen[k]);
  payload->n_values = 0;
}

void conic_layers_payload_turn_to(conic_layers_payload *payload, const conic_splats *batch) {
  const conic_point_values *values = batch->values;
  payload->i_clip = 0;
  for (size_t k = 0; k < payload->n_values; k++) {
    payload->column[k] = NULL;
    payload->n_column = values ? values->count : 0;
    for (size_t i = 0; values && i < values->n && !payload->column[k]; i++)
      if (strcmp(values->field[i].name, payload->schema.list[payload->value[k]].name) == 0)
        payload->column[k] = values->value[i];
  }
}

static void *bytes_in_record(const conic_layers_payload *p, uint32_t i, void *extra) {
  return (unsigned char *)extra + (p->schema.at[i] - sizeof(conic_layers_sample));
}

static void take_ellipse(conic_layers_payload *p, const conic_splats *batch, size_t i, void *extra) {
  conic_layers_axes axes = {{0.0f, 0.0f}, {0, 0}, 0};
  float u[3], v[3];
  for (int axis = 0; axis < 3 && batch->tangent_u[0]; axis++) {
    u[axis] = batch->tangent_u[axis][i];
    v[axis] = batch->tangent_v[axis][i];
  }
  if (batch->tangent_u[0] && conic_layers_code_axes(u, v, &axes)) {
    for (int k = 0; k < 2; k++) {
      axes.length[k] = conic_layers_axis_length(axes.length[k]);
      p->facts.shortest = axes.length[k] < p->facts.shortest ? axes.length[k] : p->facts.shortest;
      p->facts.longest = axes.length[k] > p->facts.longest ? axes.length[k] : p->facts.longest;
    }
  }
  memcpy(bytes_in_record(p, (uint32_t)p->axes, extra), &axes, sizeof axes);
}

const conic_clip *conic_layers_payload_clip(conic_layers_payload *payload, const conic_splats *batch, size_t i) {
  size_t *at = &payload->i_clip;
  while (*at < batch->n_clips && batch->clips[*at].splat < i)
    ++*at;
  return *at < batch->n_clips && batch->clips[*at].splat == i ? &batch->clips[*at] : NULL;
}

static void take_clip_lines(conic_layers_payload *p, const conic_splats *batch, size_t i, void *extra) {
  conic_layers_lines lines = {0, {{0, 0}, {0, 0}}};
  const conic_clip *clip = conic_layers_payload_clip(p, batch, i);
  if (clip)
    conic_layers_code_lines(clip, &lines);
  p->facts.n_clips += lines.kind > 0;
  memcpy(bytes_in_record(p, (uint32_t)p->clip, extra), &lines, sizeof lines);
}

static double named_value(const conic_layers_payload *p, size_t k, size_t i) {
  return p->column[k] && i < p->n_column ? p->column[k][i] : (double)NAN;
}

void conic_layers_payload_row(const conic_layers_payload *payload, size_t i, double *row) {
  for (size_t k = 0; k < payload->n_values; k++)
    row[k] = named_value(payload, k, i);
}

static void take_named_values(conic_layers_payload *p, size_t i, void *extra) {
  for (size_t k = 0; k < p->n_values; k++) {
    double value = named_value(p, k, i);
    conic_layers_number_put(&p->schema.list[p->value[k]], value, bytes_in_record(p, p->value[k], extra));
    conic_value_sample_add(p->seen[k], value);
    if (value - value == 0.0) {
      p->facts.least[k] = value < p->facts.least[k] ? value : p->facts.least[k];
      p->facts.greatest[k] = value > p->facts.greatest[k] ? value : p->facts.greatest[k];
    }
  }
}

void conic_layers_payload_take(conic_layers_payload *payload, const conic_splats *batch, size_t i, void *extra) {
  if (payload->axes) {
    float opacity = batch->opacity ? batch->opacity[i] : 1.0f;
    opacity = opacity > 0.0f ? opacity < 1.0f ? opacity : 1.0f : 0.0f;
    unsigned code = (unsigned)(opacity * 65535.0f + 0.5f);
    const unsigned char bytes[2] = {(unsigned char)code, (unsigned char)(code >> 8)};
    take_ellipse(payload, batch, i, extra);
    take_clip_lines(payload, batch, i, extra);
    payload->facts.n_translucent += code != 65535;
    memcpy(bytes_in_record(payload, (uint32_t)payload->opacity, extra), bytes, sizeof bytes);
  }
  if (payload->dot) {
    uint8_t dot = batch->dot && batch->dot[i] != 0.0f;
    payload->facts.n_dots += dot;
    memcpy(bytes_in_record(payload, (uint32_t)payload->dot, extra), &dot, sizeof dot);
  }
  take_named_values(payload, i, extra);
}

/* The bits of a float, without those of its fraction that are dropped. */
static int64_t upper_bits(double length, unsigned n_kept) {
  return (int64_t)(conic_bits_of_float((float)length) >> (FRACTION_BITS - n_kept));
}

static void settle_sizes(double low, double high, conic_layers_attribute *sizes) {
  unsigned n_kept = MOST_OF_SIZE;
  while (n_kept > 0 && upper_bits(high, n_kept) - upper_bits(low, n_kept) > 254)
    n_kept--;
  sizes->type = (uint16_t)n_kept;
  sizes->offset = (double)upper_bits(low, n_kept);
  sizes->error = 0.5 / (double)(1u << n_kept);
}

static void settle_axes(double low, double high, float cutoff, conic_layers_attribute *axes) {
  int64_t first = upper_bits(low, AXES_KEPT), least = upper_bits(high, AXES_KEPT) - 65534;
  axes->offset = (double)(first > least ? first : least > 0 ? least : 0);
  axes->scale = (double)cutoff;
  axes->error = 0.5 / (double)(1 << AXES_KEPT);
}

void conic_layers_payload_settle(conic_layers_payload *payload, double spacing) {
  conic_layers_schema *schema = &payload->schema;
  const conic_layers_facts *facts = &payload->facts;
  double low = (double)facts->shortest < spacing / 16.0 ? (double)facts->shortest : spacing / 16.0;
  double high = (double)facts->longest > 16.0 * spacing ? (double)facts->longest : 16.0 * spacing;
  for (size_t k = 0; k < payload->n_values; k++) {
    conic_layers_attribute *value = &schema->list[payload->value[k]];
    if (facts->least[k] <= facts->greatest[k]) {
      value->low = facts->least[k];
      value->high = facts->greatest[k];
    }
    conic_value_sample_limits(payload->seen[k], &value->typical[0], &value->typical[1]);
  }
  for (uint32_t i = 0; i < schema->n; i++)
    if (schema->list[i].kind == CONIC_LAYERS_SIZE)
      settle_sizes(low, high, &schema->list[i]);
    else if (schema->list[i].kind == CONIC_LAYERS_AXES)
      settle_axes(low, high, payload->cutoff, &schema->list[i]);
  if (payload->dot && !facts->n_dots) { /* from the last to the first, so that numbers stay */
    conic_layers_schema_drop(schema, (uint32_t)payload->dot);
    schema->extra_bytes -= payload->axes ? 0 : 1;
    schema->sample_bytes = (uint32_t)conic_layers_stride(schema->extra_bytes);
  }
  if (payload->axes) {
    if (!facts->n_clips)
      conic_layers_schema_drop(schema, (uint32_t)payload->clip);
    if (!facts->n_translucent)
      conic_layers_schema_drop(schema, (uint32_t)payload->opacity);
  }
}
