/* The values that a file's points have by name, for conic info. */
#include <stdio.h>
#include <string.h>

#include "core/formats/model_read.h"
#include "source/source_kind.h"

enum { MOST_TOLD = 64, BATCH = 1 << 16 };

typedef struct value_range {
  double minimum, maximum;
  uint64_t n;
} value_range;

static conic_status widen_values(void *cookie, const conic_splats *batch) {
  value_range *range = cookie;
  for (size_t i = 0; batch->scalar && i < batch->count; i++) {
    double value = (double)batch->scalar[i];
    if (!(value - value == 0.0))
      continue;
    range->minimum = range->n == 0 || value < range->minimum ? value : range->minimum;
    range->maximum = range->n == 0 || value > range->maximum ? value : range->maximum;
    range->n++;
  }
  return CONIC_OK;
}

/* Reads the file once more for one field, without repeating its messages. */
static conic_status find_range(conic_context *context, const char *path, const char *name, value_range *range) {
  conic_read_options options;
  conic_delivery delivery = {.receive = widen_values, .cookie = range, .batch = BATCH, .is_again = 1};
  conic_model_kind kind = CONIC_MODEL_PLY;
  conic_model model;
  conic_input input;
  memset(range, 0, sizeof *range);
  conic_read_options_init(&options);
  options.field = name;
  options.field_is_optional = 1;
  conic_status status = conic_input_open(context, path, &input);
  if (status != CONIC_OK)
    return status;
  status = conic_model_find_kind(&input, path, &kind);
  if (status == CONIC_OK) {
    status = conic_model_read_kind(&input, kind, &options, &delivery, &model);
    conic_model_release(context, &model);
  }
  conic_input_close(&input);
  return status;
}

static void tell_names(const conic_model *model, conic_facts *facts) {
  char text[150] = "";
  size_t length = 0;
  for (size_t i = 0; i < model->n_fields && length < sizeof text; i++)
    length += (size_t)snprintf(text + length, sizeof text - length, "%s%s", i ? ", " : "", model->fields[i].name);
  CONIC_ADD_FACTS(facts, CONIC_LINE("values", "%s%s", text, length < sizeof text ? "" : " …"));
}

conic_status conic_model_tell_fields(conic_context *context, const char *path, const conic_model *model, int is_checked,
                                     conic_facts *facts) {
  int may_read_again = is_checked && strcmp(path, "-") != 0 && model->kind != CONIC_MODEL_OBJ;
  conic_status status = CONIC_OK;
  if (model->n_fields == 0)
    return CONIC_OK;
  if (!may_read_again)
    tell_names(model, facts);
  CONIC_ADD_FACTS(facts, CONIC_ARRAY("values"));
  for (size_t i = 0; i < model->n_fields && i < MOST_TOLD && status == CONIC_OK; i++) {
    const conic_model_field *field = &model->fields[i];
    value_range range = {.n = 0};
    if (may_read_again)
      status = find_range(context, path, field->name, &range);
    CONIC_ADD_FACTS(facts, CONIC_OBJECT(NULL), conic_fact_text(CONIC_FACT_TEXT, "name", "%s", field->name),
                    conic_fact_text(CONIC_FACT_TEXT, "type", "%s", field->type));
    if (range.n)
      CONIC_ADD_FACTS(facts, CONIC_NUMBER("minimum", range.minimum), CONIC_NUMBER("maximum", range.maximum));
    CONIC_ADD_FACTS(facts, CONIC_END);
    if (may_read_again && !range.n)
      CONIC_ADD_FACTS(facts, CONIC_LINE(i ? "" : "values", "%s: no number", field->name));
    if (range.n)
      CONIC_ADD_FACTS(facts,
                      CONIC_LINE(i ? "" : "values", "%s: %.7g to %.7g", field->name, range.minimum, range.maximum));
  }
  CONIC_ADD_FACTS(facts, CONIC_END);
  return status;
}
