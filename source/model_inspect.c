/* The contents of a file of points, of a mesh or of Gaussians, and what of it cannot be drawn. */

#include "core/base/vectors.h"
#include "core/formats/model_read.h"
#include "core/splats/clip.h"
#include "gaussians/scene/gaussian_set.h"
#include "source/reach.h"
#include "source/source_kind.h"

/* --- the values that points have by name --- */

enum { MOST_TOLD = 64, BATCH = 1 << 16 };

typedef struct value_range {
  double minimum, maximum;
  uint64_t n;
} value_range;

static conic_status widen_values(void *cookie, const conic_splats *batch) {
  value_range *range = cookie;
  const conic_point_values *values = batch->values;
  for (size_t i = 0; values && i < batch->count; i++) {
    double value = values->value[values->scalar][i];
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
  conic_status status = conic_model_open(context, path, &input, &kind);
  if (status != CONIC_OK)
    return status;
  status = conic_model_read_kind(&input, kind, &options, &delivery, &model);
  conic_model_release(context, &model);
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

static conic_status tell_values(conic_context *context, const char *path, const conic_model *model, int is_checked,
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
      CONIC_ADD_FACTS(facts, conic_facts_range(i == 0, field->name, range.minimum, range.maximum));
  }
  CONIC_ADD_FACTS(facts, CONIC_END);
  return status;
}

/* --- points and meshes --- */

static int is_finite(float value) {
  return value - value == 0.0f;
}

static int is_finite_vector(float *const vector[3], size_t i) {
  return is_finite(vector[0][i]) && is_finite(vector[1][i]) && is_finite(vector[2][i]);
}

static int is_direction(float *const vector[3], size_t i) {
  return is_finite_vector(vector, i) && (vector[0][i] != 0.0f || vector[1][i] != 0.0f || vector[2][i] != 0.0f);
}

typedef int value_test(float *const vector[3], size_t i);

/* How many of an array's vectors fail the test; 0 for a missing array. */
static size_t count_wrong(const conic_splats *points, float *const vector[3], value_test *is_sound) {
  size_t n_wrong = 0;
  for (size_t i = 0; vector[0] && i < points->count; i++)
    n_wrong += !is_sound(vector, i);
  return n_wrong;
}

static void tell_defects(const conic_splats *points, conic_facts *facts) {
  size_t axes = 0, opacities = 0, clips = 0;
  for (size_t i = 0; points->tangent_u[0] && i < points->count; i++)
    axes += !is_direction(points->tangent_u, i) || !is_direction(points->tangent_v, i);
  for (size_t i = 0; points->opacity && i < points->count; i++)
    opacities += !(is_finite(points->opacity[i]) && points->opacity[i] >= 0.0f);
  for (size_t i = 0; i < points->n_clips; i++)
    for (int k = 0; k < points->clips[i].n_lines; k++)
      clips += !conic_clip_is_line(points->clips[i].lines[k]);
  CONIC_ADD_FACTS(facts, CONIC_OBJECT("defects"));
  CONIC_ADD_FACTS(
      facts,
      CONIC_DEFECT("positions", count_wrong(points, points->position, is_finite_vector),
                   "positions that are not finite"),
      CONIC_DEFECT("axes", axes, "axes that are zero or not finite"),
      CONIC_DEFECT("normals", count_wrong(points, points->normal, is_direction), "normals that are zero or not finite"),
      CONIC_DEFECT("colors", count_wrong(points, points->color, is_finite_vector), "colours that are not finite"),
      CONIC_DEFECT("opacities", opacities, "opacities that are negative or not finite"),
      CONIC_DEFECT("clips", clips, "clip lines that are not finite or have no direction"), CONIC_END);
}

static void tell_fields(unsigned fields, conic_facts *facts) {
  static const char *const names[] = {"axes",      "normals",    "colors",
                                      "opacities", "clip lines", "dots"}; /* in the order of the bits */
  char text[96] = "positions";
  size_t length = sizeof "positions" - 1;
  CONIC_ADD_FACTS(facts, CONIC_ARRAY("fields"));
  for (int i = 0; i < 6; i++)
    if (fields & 1u << i) {
      CONIC_ADD_FACTS(facts, conic_fact_text(CONIC_FACT_TEXT, NULL, "%s", names[i]));
      length += (size_t)snprintf(text + length, sizeof text - length, ", %s", names[i]);
    }
  CONIC_ADD_FACTS(facts, CONIC_END, CONIC_LINE("fields", "%s", text));
}

/* Which way is up, as a picture has it: where the file does not say it, what is drawn is looked at, in a context of its
 * own, as all messages of the file were told. It takes too long of more points than these. */
enum { MOST_LOOKED_AT = 400000 };

static void tell_up(conic_context *context, const char *path, const conic_model *model, conic_facts *facts) {
  const int is_said = conic_dot(model->up, model->up) > 0.0;
  conic_source_options opening;
  conic_context_options quiet;
  conic_context *own = NULL;
  conic_source *source = NULL;
  if (is_said)
    conic_facts_add_up(facts, model->up, CONIC_UP_KIND);
  if (is_said || strcmp(path, "-") == 0 || (!model->n_triangles && model->points.count > MOST_LOOKED_AT))
    return;
  conic_source_options_init(&opening);
  opening.as = CONIC_AS_AUTO;
  conic_context_options_init(&quiet);
  quiet.threads = conic_context_threads(context);
  if (conic_context_create(&quiet, &own) == CONIC_OK &&
      conic_source_open(own, &path, 1, &opening, &source) == CONIC_OK && conic_source_stand(source) == CONIC_OK)
    conic_facts_add_up(facts, conic_source_measure(source)->up, conic_source_measure(source)->up_basis);
  conic_source_close(source);
  conic_context_destroy(own);
}

/* What decides a picture and shows in no number. */
static conic_status tell_meanings(conic_context *context, const char *path, const conic_model *model,
                                  conic_facts *facts) {
  static const char *const colors[][2] = {
      [CONIC_COLORS_NONE] = {"none", ""},
      [CONIC_COLORS_DISPLAY] = {"display", "fractions of 1, sRGB-encoded; --colors linear says otherwise"},
      [CONIC_COLORS_LINEAR] = {"linear", "fractions of 1, linear"},
      [CONIC_COLORS_CODES] = {"codes", "codes, sRGB-encoded"},
      [CONIC_COLORS_TRAINED] = {"trained", "harmonics of Gaussians"}};
  const int is_metric = model->kind == CONIC_MODEL_GLTF || model->kind == CONIC_MODEL_GLB ||
                        model->kind == CONIC_MODEL_E57 || model->kind == CONIC_MODEL_PTX;
  conic_georeference reference;
  conic_status status = conic_georeference_read(context, path, &reference);
  if (status != CONIC_OK)
    return status;
  CONIC_ADD_FACTS(facts, conic_fact_text(CONIC_FACT_TEXT, "colors", "%s", colors[model->colors_are][0]));
  if (model->colors_are)
    CONIC_ADD_FACTS(facts, CONIC_LINE("colours", "%s", colors[model->colors_are][1]));
  if (is_metric)
    CONIC_ADD_FACTS(facts, conic_fact_text(CONIC_FACT_TEXT, "unit", "m"), CONIC_LINE("unit", "metres, by the format"));
  conic_facts_add_system(facts, &reference);
  if (model->n_unmeasured)
    CONIC_ADD_FACTS(
        facts, CONIC_COUNT("unmeasured", model->n_unmeasured),
        CONIC_LINE("left out", "%llu points that were not measured", (unsigned long long)model->n_unmeasured));
  conic_georeference_release(context, &reference);
  return CONIC_OK;
}

conic_status conic_model_inspect(conic_context *context, const char *path, int is_checked, conic_facts *facts) {
  conic_model model;
  double low[3], high[3];
  conic_status status = conic_model_read(context, path, NULL, &model);
  if (status != CONIC_OK)
    return status;
  CONIC_ADD_FACTS(facts, conic_fact_text(CONIC_FACT_TEXT, "kind", "%s", conic_model_kind_name(model.kind)),
                  CONIC_COUNT("points", model.points.count), CONIC_LINE("points", "%zu", model.points.count));
  if (model.n_triangles)
    CONIC_ADD_FACTS(facts, CONIC_COUNT("triangles", model.n_triangles),
                    CONIC_LINE("triangles", "%zu", model.n_triangles));
  tell_fields(conic_splats_fields(&model.points), facts);
  if (conic_splats_bounds(&model.points, low, high) &&
      conic_leave_far_points(context, path, &model.points, low, high) == CONIC_OK) {
    conic_facts_add_bounds(facts, low, high);
    tell_up(context, path, &model, facts);
  }
  status = tell_meanings(context, path, &model, facts);
  if (is_checked)
    tell_defects(&model.points, facts);
  if (status == CONIC_OK)
    status = tell_values(context, path, &model, is_checked, facts);
  conic_model_release(context, &model);
  return status;
}

/* --- Gaussian scenes --- */

static void tell_wrong_gaussians(const conic_gaussians *gaussians, conic_facts *facts) {
  conic_gaussians_defects found;
  conic_gaussians_find_defects(gaussians, &found);
  CONIC_ADD_FACTS(facts, CONIC_OBJECT("defects"),
                  CONIC_DEFECT("positions", found.positions, "means that are not finite"),
                  CONIC_DEFECT("scales", found.scales, "scales that are negative or not finite"),
                  CONIC_DEFECT("rotations", found.rotations, "rotations that are zero or not finite"),
                  CONIC_DEFECT("opacities", found.opacities, "opacities that are not within 0 to 1"),
                  CONIC_DEFECT("harmonics", found.harmonics, "harmonics that are not finite"), CONIC_END);
}

conic_status conic_gaussians_inspect(conic_context *context, const char *path, int is_checked, conic_facts *facts) {
  conic_gaussians gaussians;
  double low[3], high[3], up[3];
  conic_status status = conic_gaussians_read(context, path, NULL, &gaussians);
  if (status != CONIC_OK)
    return status;
  int is_2d = gaussians.scale[2] == NULL;
  conic_gaussians_find_up(&gaussians, up);
  CONIC_ADD_FACTS(facts, conic_fact_text(CONIC_FACT_TEXT, "kind", "%s", conic_gaussian_kind_name(gaussians.kind)),
                  CONIC_COUNT("gaussians", gaussians.count), CONIC_COUNT("sh_degree", gaussians.sh_degree),
                  CONIC_TRUTH("2d", is_2d), CONIC_TRUTH("antialiased", gaussians.is_antialiased),
                  conic_fact_text(CONIC_FACT_TEXT, "frame", "%s", gaussians.frame),
                  CONIC_LINE("gaussians", "%zu, %s, harmonics of degree %d%s", gaussians.count, is_2d ? "2D" : "3D",
                             gaussians.sh_degree, gaussians.is_antialiased ? ", trained antialiased" : ""),
                  CONIC_LINE("frame", "%s", gaussians.frame));
  conic_facts_add_up(facts, up, CONIC_UP_KIND);
  if (conic_gaussians_bounds(&gaussians, low, high))
    conic_facts_add_bounds(facts, low, high);
  if (is_checked)
    tell_wrong_gaussians(&gaussians, facts);
  conic_gaussians_release(context, &gaussians);
  return CONIC_OK;
}
