/* A Gaussian scene in levels: each picture takes what it shows of it, and that is drawn as any scene is. */
#include <inttypes.h>

#include "source/together/gaussians_source.h"

typedef struct levels_source {
  conic_gaussians_source g;
  conic_levels *levels;
  conic_levels_cut cut;
} levels_source;

static int takes_levels(const char *path, const conic_source_options *options) {
  return options->gaussians && !options->place && conic_levels_is_file(path);
}

static conic_status choose_levels(levels_source *s, const conic_levels_wish *wish) {
  conic_gaussians *set = &s->g.gaussians;
  if (s->cut.is_all && wish->error == 0.0 && !wish->budget)
    return CONIC_OK;
  conic_gaussians_release(s->g.base.context, set);
  conic_status status = conic_levels_choose_seen(s->levels, wish, &s->g.options, set, &s->cut);
  s->g.base.choice = (conic_source_choice){.error_px = s->cut.error, .is_all = s->cut.is_all};
  if (status == CONIC_OK && s->cut.is_short && wish->error == 0.0) /* else the program says so */
    conic_log(s->g.base.context, CONIC_LOG_WARNING,
              "%s: drawn by an error of %.3g, as no more than %" PRIu64
              " Gaussians fit into the memory that it may take",
              s->g.base.name, s->cut.error, conic_levels_most(s->levels));
  return status;
}

static conic_status choose_for_picture(conic_source *source, const conic_camera *camera) {
  levels_source *s = (levels_source *)source;
  const conic_levels_wish wish = conic_gaussians_source_wish(&s->g, camera);
  return choose_levels(s, &wish);
}

static conic_status open_levels(conic_source *source, const char *const *paths, size_t n_paths,
                                const conic_source_options *options) {
  levels_source *s = (levels_source *)source;
  (void)n_paths;
  s->g.options = *options->gaussians;
  s->g.choose = choose_for_picture;
  conic_status status = conic_levels_open(source->context, paths[0], options->access, &s->levels);
  if (status != CONIC_OK)
    return status;
  const conic_levels_header *h = &s->levels->header;
  const conic_levels_wish wish = {.part = options->is_whole || h->n <= CONIC_LEVELS_MOST_WHOLE ? CONIC_LEVELS_ALL
                                                                                               : CONIC_LEVELS_ROOT};
  status = choose_levels(s, &wish);
  if (status == CONIC_OK)
    status = conic_gaussians_source_measure(&s->g);
  memcpy(source->scale.minimum, h->low, sizeof h->low);
  memcpy(source->scale.maximum, h->high, sizeof h->high);
  source->scale.n_splats = h->n;
  return status;
}

static void close_levels(conic_source *source) {
  conic_levels_close(((levels_source *)source)->levels);
  conic_gaussians_source_close(source);
}

static void tell_levels_rest(const conic_source *source, conic_facts *facts) {
  const levels_source *s = (const levels_source *)source;
  conic_gaussians_source_tell(source, facts);
  const conic_among_input input = {.levels = s->levels, .cut = s->cut};
  conic_levels_tell(&input, 1, facts);
}

static conic_status tell_levels_file(conic_source *source, conic_facts *facts) {
  levels_source *s = (levels_source *)source;
  conic_status status = conic_levels_open(source->context, source->name, NULL, &s->levels);
  if (status != CONIC_OK)
    return status;
  const conic_levels_header *h = &s->levels->header;
  const uint64_t n_bytes = conic_ranges_size(s->levels->ranges);
  CONIC_ADD_FACTS(facts, CONIC_COUNT("gaussians", h->n), CONIC_COUNT("gaussians_merged", h->n_merged),
                  CONIC_COUNT("sh_degree", h->sh_degree), CONIC_COUNT("clouds", s->levels->shape.n_clouds),
                  CONIC_COUNT("levels", (uint64_t)s->levels->shape.n_levels), CONIC_COUNT("cloud_size", h->cloud_size),
                  conic_fact_text(CONIC_FACT_TEXT, "frame", "%s", h->frame),
                  CONIC_LINE("gaussians", "%" PRIu64 ", 3D, harmonics of degree %u; %" PRIu64 " merged", h->n,
                             (unsigned)h->sh_degree, h->n_merged),
                  CONIC_LINE("clouds", "%u in %d levels, %u Gaussians asked for, %.1f bytes each",
                             (unsigned)s->levels->shape.n_clouds, s->levels->shape.n_levels, (unsigned)h->cloud_size,
                             (double)n_bytes / (double)h->n),
                  CONIC_LINE("frame", "%s", h->frame));
  conic_facts_add_bounds(facts, h->low, h->high);
  return CONIC_OK;
}

static conic_status tell_levels_defects(conic_source *source, conic_facts *facts) {
  uint64_t n_damaged, n_unbounded;
  conic_status status = conic_levels_check(((levels_source *)source)->levels, &n_damaged, &n_unbounded);
  if (status == CONIC_OK)
    CONIC_ADD_FACTS(facts, CONIC_DEFECT("clouds", n_damaged, "clouds that are damaged"),
                    CONIC_DEFECT("bounds", n_unbounded, "clouds whose bounds are above those of what stands for them"));
  return status;
}

const conic_source_kind conic_source_kind_levels = {
    .size = sizeof(levels_source),
    .abilities = CONIC_SOURCE_COMPOSITES | CONIC_SOURCE_CHOOSES | CONIC_SOURCE_STREAMS,
    .company = CONIC_SOURCE_SINGLE,
    .takes = takes_levels,
    .open = open_levels,
    .close = close_levels,
    .draw = conic_gaussians_source_draw,
    .windowing = &conic_gaussians_windowing,
    .tell_rest = tell_levels_rest,
    .is_file = conic_levels_is_file,
    .name = "lpc",
    .tell_file = tell_levels_file,
    .tell_defects = tell_levels_defects,
};
