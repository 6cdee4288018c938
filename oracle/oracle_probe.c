/* One splat alone: what its formula and the exact kernel give at chosen places. */

#include "core/image/view_arguments.h"
#include "oracle/oracle_splat.h"

static oracle_formula formula_of(const oracle_view *view, const int is_so[ORACLE_N_QUESTIONS]) {
  static const oracle_formula formulas[CONIC_N_METHODS] = {[CONIC_METHOD_CONIC] = ORACLE_CONIC,
                                                           [CONIC_METHOD_RAY] = ORACLE_RAY,
                                                           [CONIC_METHOD_AFFINE] = ORACLE_AFFINE,
                                                           [CONIC_METHOD_DISC] = ORACLE_DISC,
                                                           [CONIC_METHOD_POINT] = ORACLE_POINT};
  if (view->method == CONIC_METHOD_AUTO)
    return conic_oracle_choose(view, is_so);
  return formulas[view->method];
}

conic_status conic_oracle_probe(conic_context *context, const conic_oracle_splat *splat, const conic_camera *camera,
                                const conic_render_options *given, const double (*places)[2], size_t n,
                                conic_oracle_sample *samples) {
  conic_render_options options;
  conic_status status = conic_view_arguments_take(context, "the oracle", camera, given, &options);
  if (status != CONIC_OK)
    return status;
  oracle_view view = conic_oracle_view(camera, &options, options.near_z, CONIC_FLOATS_OWN);
  oracle_placed placed;
  double answers[ORACLE_N_QUESTIONS];
  int is_so[ORACLE_N_QUESTIONS];
  oracle_shape shape;
  oracle_exact exact;
  memcpy(placed.p, splat->center, sizeof placed.p);
  memcpy(placed.tu, splat->tangent_u, sizeof placed.tu);
  memcpy(placed.tv, splat->tangent_v, sizeof placed.tv);
  conic_oracle_ask(&view, &placed, answers);
  conic_oracle_answer(answers, is_so);
  if (is_so[ORACLE_IS_BEHIND] || is_so[ORACLE_REACHES_NEAR] || is_so[ORACLE_HAS_NO_PLANE] ||
      !conic_oracle_shape(&view, &placed, formula_of(&view, is_so), &shape))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "the splat has no footprint of its own on the screen");
  conic_oracle_exact(&view, &placed, &exact);
  status = conic_oracle_profile_create(context, &view);
  if (status != CONIC_OK)
    return status;
  for (size_t i = 0; i < n; i++) {
    conic_oracle_sample *sample = &samples[i];
    double values[ORACLE_N_VALUES];
    conic_oracle_evaluate(&view, &shape, places[i][0], places[i][1], values);
    sample->covers = conic_oracle_covers(values);
    sample->q = view.support - values[ORACLE_MARGIN_Q];
    sample->weight = values[ORACLE_WEIGHT];
    sample->exact = conic_oracle_exact_weight(&view, &exact, places[i][0], places[i][1], &sample->quadrature);
    sample->inverse_depth = values[ORACLE_IZ];
    sample->plane_inverse_depth = values[ORACLE_IZ_PLANE];
  }
  conic_oracle_profile_release(context, &view);
  return CONIC_OK;
}
