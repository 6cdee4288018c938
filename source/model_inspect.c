/* The contents of a file of points or of a mesh, and what of it cannot be drawn. */
#include <stdio.h>

#include "conic/model.h"
#include "core/splats/clip.h"
#include "source/reach.h"
#include "source/source_kind.h"

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
  const char *why = conic_why_out_of_reach(points);
  size_t axes = 0, opacities = 0, clips = 0;
  for (size_t i = 0; points->tangent_u[0] && i < points->count; i++)
    axes += !is_direction(points->tangent_u, i) || !is_direction(points->tangent_v, i);
  for (size_t i = 0; points->opacity && i < points->count; i++)
    opacities += !(is_finite(points->opacity[i]) && points->opacity[i] >= 0.0f);
  for (size_t i = 0; i < points->n_clips; i++)
    for (int k = 0; k < points->clips[i].n_lines; k++)
      clips += !conic_clip_is_line(points->clips[i].lines[k]);
  CONIC_ADD_FACTS(facts, CONIC_OBJECT("defects"));
  if (why)
    CONIC_ADD_FACTS(facts, conic_fact_text(CONIC_FACT_FAULT, "extent", "%s", why));
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
  if (conic_splats_bounds(&model.points, low, high))
    conic_facts_add_bounds(facts, low, high);
  if (is_checked)
    tell_defects(&model.points, facts);
  status = conic_model_tell_fields(context, path, &model, is_checked, facts);
  conic_model_release(context, &model);
  return status;
}
