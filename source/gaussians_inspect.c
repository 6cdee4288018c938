/* The contents of a Gaussian scene, and the Gaussians that cannot be drawn. */
#include "conic/gaussians.h"
#include "source/source_kind.h"

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
  double low[3], high[3];
  conic_status status = conic_gaussians_read(context, path, NULL, &gaussians);
  if (status != CONIC_OK)
    return status;
  int is_2d = gaussians.scale[2] == NULL;
  CONIC_ADD_FACTS(facts, conic_fact_text(CONIC_FACT_TEXT, "kind", "%s", conic_gaussian_kind_name(gaussians.kind)),
                  CONIC_COUNT("gaussians", gaussians.count), CONIC_COUNT("sh_degree", gaussians.sh_degree),
                  CONIC_TRUTH("2d", is_2d), CONIC_TRUTH("antialiased", gaussians.is_antialiased),
                  conic_fact_text(CONIC_FACT_TEXT, "frame", "%s", gaussians.frame),
                  CONIC_LINE("gaussians", "%zu, %s, harmonics of degree %d%s", gaussians.count, is_2d ? "2D" : "3D",
                             gaussians.sh_degree, gaussians.is_antialiased ? ", trained antialiased" : ""),
                  CONIC_LINE("frame", "%s", gaussians.frame));
  if (conic_gaussians_bounds(&gaussians, low, high))
    conic_facts_add_bounds(facts, low, high);
  if (is_checked)
    tell_wrong_gaussians(&gaussians, facts);
  conic_gaussians_release(context, &gaussians);
  return CONIC_OK;
}
