#include <unistd.h>

#include "core/formats/model_read.h"
#include "core/formats/readers.h"

/* State between the reader and the receiver, for colours whose scale only the whole file tells. */
typedef struct streaming {
  conic_context *context;
  const conic_read_options *options;
  conic_model_kind kind;
  conic_batch_receiver *receive;
  void *cookie;
  conic_raw_range range;
  conic_raw_scale scale;
  const conic_points_range *part; /* null: all points */
  uint64_t n_wanted;
} streaming;

static conic_status see_colors(void *cookie, const conic_splats *batch) {
  streaming *s = cookie;
  conic_raw_colors_see(batch, &s->range);
  return CONIC_OK;
}

/* The batch belongs to the reader, and its colours may be changed. */
static conic_status decode_batch(void *cookie, const conic_splats *batch) {
  streaming *s = cookie;
  conic_splats decoded = *batch;
  for (int channel = 0; channel < 3 && decoded.color[channel]; channel++)
    if (s->scale.table)
      conic_raw_colors_apply(&s->scale, decoded.color[channel], decoded.count);
    else
      decoded.color[channel] = NULL;
  return s->receive(s->cookie, &decoded);
}

/* Reads from where the input is, and hands batches to `receive`. */
static conic_status pass(streaming *s, conic_input *input, conic_batch_receiver *receive, void *cookie) {
  conic_delivery delivery = {.receive = receive,
                             .cookie = cookie,
                             .batch = CONIC_PART_STEP,
                             .is_survey = receive == see_colors,
                             .is_again = receive == decode_batch,
                             .range = s->part,
                             .n_wanted = &s->n_wanted};
  conic_model model = {0};
  conic_status status = conic_model_read_kind(input, s->kind, s->options, &delivery, &model);
  conic_model_release(s->context, &model);
  return status;
}

static conic_status read_whole_stream(streaming *s, conic_input *input) {
  conic_model model = {0};
  conic_status status = conic_model_read_kind(input, s->kind, s->options, NULL, &model);
  if (status == CONIC_OK)
    status = s->receive(s->cookie, &model.points);
  conic_model_release(s->context, &model);
  return status;
}

/* A first pass finds the scale of the colours, a second hands over the points. */
static conic_status pass_twice(streaming *s, conic_input *input, const char *path, unsigned raw_kind) {
  conic_input again;
  if (s->kind == CONIC_MODEL_XYZ || s->kind == CONIC_MODEL_PCD)
    raw_kind = conic_raw_kind_of(s->options->colors_are);
  conic_status status = pass(s, input, see_colors, s);
  if (status == CONIC_OK)
    status = conic_raw_colors_scale(s->context, &s->range, raw_kind, &s->scale);
  if (status == CONIC_OK)
    status = conic_model_open(s->context, path, &again, &s->kind);
  if (status != CONIC_OK)
    return status;
  status = pass(s, &again, decode_batch, s);
  conic_input_close(&again);
  return status;
}

conic_status conic_mesh_stream(conic_context *context, const char *path, conic_batch_receiver *receive,
                               conic_status (*receive_faces)(void *cookie, const uint32_t (*corners)[3], size_t n),
                               void *cookie) {
  const conic_delivery delivery = {
      .receive = receive, .cookie = cookie, .batch = CONIC_PART_STEP, .receive_faces = receive_faces};
  conic_read_options options;
  conic_input input;
  conic_model model = {0};
  conic_model_kind kind;
  conic_read_options_init(&options);
  conic_status status = conic_model_open(context, path, &input, &kind);
  if (status != CONIC_OK)
    return status;
  if (kind != CONIC_MODEL_PLY)
    status = conic_fail(context, CONIC_ERROR_INPUT, "%s: only of a PLY faces are read some at a time", path);
  if (status == CONIC_OK)
    status = conic_model_read_kind(&input, kind, &options, &delivery, &model);
  conic_input_close(&input);
  conic_model_release(context, &model);
  return status;
}

static conic_status stream_lent(streaming *s, const char *name) {
  conic_model model = {0};
  conic_status status = conic_model_copy_lent(s->context, name, s->options, &model);
  if (status == CONIC_OK)
    status = s->receive(s->cookie, &model.points);
  conic_model_release(s->context, &model);
  return status;
}

conic_status conic_model_stream(conic_context *context, const char *path, const conic_read_options *options,
                                conic_batch_receiver *receive, void *cookie) {
  conic_read_options settings;
  conic_input input;
  streaming s = {.context = context, .options = &settings, .receive = receive, .cookie = cookie};
  conic_status status = conic_read_options_check(context, path, options, &settings);
  if (status == CONIC_OK && conic_model_is_lent(context, path))
    return stream_lent(&s, path);
  if (status == CONIC_OK)
    status = conic_model_open(context, path, &input, &s.kind);
  if (status != CONIC_OK)
    return status;
  int is_pipe = input.descriptor == STDIN_FILENO || !input.has_size;
  conic_model_shape shape = {0};
  if (s.kind == CONIC_MODEL_PLY && !is_pipe)
    status = conic_model_look(context, path, options, &shape);
  if (status == CONIC_OK && s.kind == CONIC_MODEL_PLY && !shape.needs_survey)
    status = pass(&s, &input, receive, cookie);
  else if (status == CONIC_OK && (s.kind == CONIC_MODEL_OBJ || s.kind >= CONIC_MODEL_STL || is_pipe))
    status = read_whole_stream(&s, &input);
  else if (status == CONIC_OK)
    status = pass_twice(&s, &input, path, shape.raw_kind);
  conic_input_close(&input);
  conic_memory_release(context, s.scale.table);
  return status;
}

/* --- in parts --- */

conic_status conic_model_look(conic_context *context, const char *path, const conic_read_options *options,
                              conic_model_shape *shape) {
  conic_read_options settings;
  conic_input input;
  conic_model_kind kind;
  *shape = (conic_model_shape){.can_part = 0};
  conic_status status = conic_read_options_check(context, path, options, &settings);
  if (status == CONIC_OK && conic_model_is_lent(context, path))
    return CONIC_OK;
  if (status == CONIC_OK)
    status = conic_model_open(context, path, &input, &kind);
  if (status != CONIC_OK)
    return status;
  if (input.has_size && input.descriptor != STDIN_FILENO && kind == CONIC_MODEL_PLY)
    status = conic_ply_look(&input, &settings, shape);
  else if (input.has_size && input.descriptor != STDIN_FILENO && kind == CONIC_MODEL_LAS)
    status = conic_las_look(&input, shape);
  conic_input_close(&input);
  return status;
}

static conic_status pass_over_part(streaming *s, const char *path, conic_batch_receiver *receive, void *cookie) {
  conic_input input;
  conic_status status = conic_model_open(s->context, path, &input, &s->kind);
  if (status != CONIC_OK)
    return status;
  status = pass(s, &input, receive, cookie);
  conic_input_close(&input);
  return status;
}

conic_status conic_model_survey_part(conic_context *context, const char *path, const conic_read_options *options,
                                     const conic_points_range *range, conic_model_survey *survey) {
  conic_read_options settings;
  streaming s = {.context = context, .options = &settings, .part = range};
  conic_status status = conic_read_options_check(context, path, options, &settings);
  if (status == CONIC_OK)
    status = pass_over_part(&s, path, see_colors, &s);
  const conic_model_survey found = {s.n_wanted, s.range};
  conic_model_survey_add(survey, &found);
  return status;
}

void conic_model_survey_add(conic_model_survey *survey, const conic_model_survey *other) {
  survey->n_wanted += other->n_wanted;
  conic_raw_colors_unite(&survey->colors, &other->colors);
}

conic_status conic_model_stream_part(conic_context *context, const char *path, const conic_read_options *options,
                                     const conic_points_range *range, const conic_model_survey *survey,
                                     conic_batch_receiver *receive, void *cookie) {
  conic_read_options settings;
  conic_model_shape shape;
  streaming s = {.context = context, .options = &settings, .receive = receive, .cookie = cookie, .part = range};
  conic_status status = conic_model_look(context, path, options, &shape);
  if (status == CONIC_OK)
    status = conic_read_options_check(context, path, options, &settings);
  if (status == CONIC_OK && shape.needs_survey)
    status = conic_raw_colors_scale(context, &survey->colors, shape.raw_kind, &s.scale);
  if (status == CONIC_OK)
    status =
        shape.needs_survey ? pass_over_part(&s, path, decode_batch, &s) : pass_over_part(&s, path, receive, cookie);
  conic_memory_release(context, s.scale.table);
  return status;
}
