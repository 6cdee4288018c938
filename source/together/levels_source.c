/* A Gaussian scene in levels: each picture takes what it shows of it, and that is drawn as any scene is. */
#include <inttypes.h>

#include "source/together/gaussians_source.h"

static int takes_levels(const char *path, const conic_source_options *options) {
  return options->gaussians && !options->place && conic_levels_is_file(path);
}

static conic_status open_levels(conic_source *source, const char *const *paths, size_t n_paths,
                                const conic_source_options *options) {
  conic_status status = conic_together_open(source, paths, n_paths, options);
  if (status != CONIC_OK)
    return status;
  const conic_levels_header *h = &((const conic_gaussians_source *)source)->inputs->levels->header;
  memcpy(source->scale.minimum, h->low, sizeof h->low);
  memcpy(source->scale.maximum, h->high, sizeof h->high);
  source->scale.n_splats = h->n;
  return CONIC_OK;
}

static conic_status tell_levels_file(conic_source *source, conic_facts *facts) {
  conic_gaussians_source *g = (conic_gaussians_source *)source;
  g->inputs = conic_memory_allocate_zeroed(source->context, 1, sizeof *g->inputs);
  if (!g->inputs)
    return CONIC_ERROR_MEMORY;
  g->n_inputs = 1;
  conic_status status = conic_levels_open(source->context, source->name, NULL, &g->inputs->levels);
  if (status != CONIC_OK)
    return status;
  const conic_levels *l = g->inputs->levels;
  const conic_levels_header *h = &l->header;
  const uint64_t n_bytes = conic_ranges_size(l->ranges);
  CONIC_ADD_FACTS(facts, CONIC_COUNT("gaussians", h->n), CONIC_COUNT("gaussians_merged", h->n_merged),
                  CONIC_COUNT("sh_degree", h->sh_degree), CONIC_COUNT("clouds", l->shape.n_clouds),
                  CONIC_COUNT("levels", (uint64_t)l->shape.n_levels), CONIC_COUNT("cloud_size", h->cloud_size),
                  conic_fact_text(CONIC_FACT_TEXT, "frame", "%s", h->frame),
                  CONIC_LINE("gaussians", "%" PRIu64 ", 3D, harmonics of degree %u; %" PRIu64 " merged", h->n,
                             (unsigned)h->sh_degree, h->n_merged),
                  CONIC_LINE("clouds", "%u in %d levels, %u Gaussians asked for, %.1f bytes each",
                             (unsigned)l->shape.n_clouds, l->shape.n_levels, (unsigned)h->cloud_size,
                             (double)n_bytes / (double)h->n),
                  CONIC_LINE("frame", "%s", h->frame));
  conic_facts_add_bounds(facts, h->low, h->high);
  return CONIC_OK;
}

static conic_status tell_levels_defects(conic_source *source, conic_facts *facts) {
  uint64_t n_damaged, n_unbounded;
  conic_status status =
      conic_levels_check(((conic_gaussians_source *)source)->inputs->levels, &n_damaged, &n_unbounded);
  if (status == CONIC_OK)
    CONIC_ADD_FACTS(facts, CONIC_DEFECT("clouds", n_damaged, "clouds that are damaged"),
                    CONIC_DEFECT("bounds", n_unbounded, "clouds whose bounds are above those of what stands for them"));
  return status;
}

const conic_source_kind conic_source_kind_levels = {
    .size = sizeof(conic_gaussians_source),
    .abilities = CONIC_SOURCE_COMPOSITES | CONIC_SOURCE_CHOOSES | CONIC_SOURCE_STREAMS,
    .company = CONIC_SOURCE_SINGLE,
    .takes = takes_levels,
    .open = open_levels,
    .close = conic_gaussians_source_close,
    .draw = conic_gaussians_source_draw,
    .windowing = &conic_gaussians_windowing,
    .tell_rest = conic_gaussians_source_tell,
    .is_file = conic_levels_is_file,
    .name = "lpc",
    .tell_file = tell_levels_file,
    .tell_defects = tell_levels_defects,
};
