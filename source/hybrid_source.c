/* Hybrid models: a .chy, or a model built from a mesh. */

#include "source/mesh_input.h"
#include "source/source_kind.h"

typedef struct hybrid_source {
  conic_source base;
  conic_hybrid *hybrid;
  conic_hybrid_info info;
  conic_hybrid_selection selection;
  int is_opened; /* from a .chy, not built */
} hybrid_source;

static int is_hybrid_name(const char *path) {
  return conic_hybrid_is_url(path) || conic_hybrid_is_file(path);
}

static int takes_hybrid(const char *path, const conic_source_options *options) {
  return options->as == CONIC_AS_HYBRID || is_hybrid_name(path);
}

static conic_status measure_hybrid(hybrid_source *h) {
  conic_source_scale *scale = &h->base.scale;
  conic_status status = conic_hybrid_describe(h->hybrid, &h->info);
  memcpy(scale->minimum, h->info.minimum, sizeof scale->minimum);
  memcpy(scale->maximum, h->info.maximum, sizeof scale->maximum);
  scale->near_z = h->info.near_z;
  scale->splat_length = h->info.splat_length;
  scale->n_splats = h->info.n_surfels;
  scale->n_triangles = h->info.n_triangles;
  scale->has_colors = h->info.has_colors != 0;
  return status;
}

static conic_status build_hybrid(hybrid_source *h, const char *path, const conic_source_options *options) {
  conic_hybrid_input input;
  conic_hybrid_options building;
  const conic_hybrid_reading reading = {options->texture_path, options->coloring, options->is_smooth,
                                        options->crease_deg,   options->cutoff,   options->n_neighbours,
                                        options->colors_are};
  conic_status status = conic_hybrid_input_read(h->base.context, path, &reading, &input);
  h->base.no_traits |= input.has_fractions ? 0u : (unsigned)CONIC_TRAIT_FRACTIONS;
  if (status == CONIC_OK)
    status = conic_source_color(&h->base, options, input.is_points ? &input.splats : NULL,
                                input.is_points ? NULL : &input.mesh);
  if (status != CONIC_OK) {
    conic_hybrid_input_release(h->base.context, &input);
    return status;
  }
  double start = conic_seconds_now();
  conic_hybrid_options_init(&building);
  building.cutoff = options->cutoff;
  status = conic_hybrid_input_build(h->base.context, &input, &building, &h->hybrid, NULL);
  h->base.scale.estimate_seconds = conic_seconds_now() - start;
  return status;
}

static conic_status open_hybrid(conic_source *source, const char *const *paths, size_t n_paths,
                                const conic_source_options *options) {
  hybrid_source *h = (hybrid_source *)source;
  (void)n_paths;
  h->is_opened = is_hybrid_name(paths[0]);
  source->scale.follows_cutoff = !h->is_opened;
  if (h->is_opened && conic_coloring_is_asked(options))
    return conic_coloring_refuse(source->context, paths[0], options);
  conic_status status = h->is_opened ? conic_hybrid_open(source->context, paths[0], options->access, &h->hybrid)
                                     : build_hybrid(h, paths[0], options);
  return status == CONIC_OK ? measure_hybrid(h) : status;
}

conic_status conic_source_of_hybrid(conic_context *context, conic_hybrid *hybrid, conic_source **source) {
  conic_status status = conic_source_create(context, &conic_source_kind_hybrid, "hybrid", source);
  if (status != CONIC_OK) {
    conic_hybrid_destroy(hybrid);
    return status;
  }
  ((hybrid_source *)*source)->hybrid = hybrid;
  return conic_source_finish(measure_hybrid((hybrid_source *)*source), source);
}

static void close_hybrid(conic_source *source) {
  hybrid_source *h = (hybrid_source *)source;
  conic_hybrid_selection_release(source->context, &h->selection);
  conic_hybrid_destroy(h->hybrid);
}

static conic_status choose_from_hybrid(conic_source *source, const conic_camera *camera,
                                       const conic_render_options *render, const conic_source_view *view) {
  hybrid_source *h = (hybrid_source *)source;
  conic_hybrid_view wanted;
  conic_hybrid_view_init(&wanted);
  wanted.error_px = view->error_px;
  wanted.only_kind = view->only_kind;
  wanted.budget = view->budget;
  wanted.color_error = view->color_error;
  conic_status status = conic_hybrid_select(h->hybrid, camera, render, &wanted, &h->selection);
  source->choice.drawing = (conic_drawing){&h->selection.splats, &h->selection.triangles};
  source->choice.error_px = h->selection.error_px;
  source->choice.color_error = h->selection.color_error;
  source->choice.n_culled = h->selection.n_culled;
  return status;
}

static void name_hybrid_image(const conic_source *source, conic_image *image) {
  if (image->planes[CONIC_PLANE_CLUSTER])
    conic_hybrid_name(&((const hybrid_source *)source)->selection, image);
}

static const char *name_hybrid_splat(const conic_source *source, uint32_t splat, uint32_t *number) {
  *number = ((const hybrid_source *)source)->selection.splat_cluster[splat];
  return "cluster";
}

/* NOLINTNEXTLINE(readability-non-const-parameter): other kinds count */
static void tell_hybrid_primitives(const conic_source *source, conic_facts *facts, uint64_t *n_splats) {
  const conic_hybrid_selection *selection = &((const hybrid_source *)source)->selection;
  (void)n_splats;
  CONIC_ADD_FACTS(facts, CONIC_COUNT("triangle_patches", selection->n_clusters[CONIC_HYBRID_TRIANGLES]),
                  CONIC_COUNT("surfel_patches", selection->n_clusters[CONIC_HYBRID_SURFELS]),
                  CONIC_COUNT("simpler_patches", selection->n_simpler),
                  CONIC_COUNT("joined_patches", selection->n_joined), CONIC_COUNT("nodes", selection->n_nodes),
                  CONIC_COUNT("points", selection->n_points));
}

static void tell_hybrid_rest(const conic_source *source, conic_facts *facts) {
  const hybrid_source *h = (const hybrid_source *)source;
  const conic_hybrid_selection *selection = &h->selection;
  if (h->is_opened)
    CONIC_ADD_FACTS(facts, CONIC_OBJECT("chunks"), CONIC_COUNT("drawn", selection->n_chunks),
                    CONIC_COUNT("read", selection->n_chunks_read), CONIC_COUNT("bytes_read", selection->n_bytes_read),
                    CONIC_COUNT("bytes_received", selection->n_bytes_received),
                    CONIC_COUNT("bytes_kept", selection->n_bytes_kept), CONIC_END);
}

static conic_status tell_hybrid_file(conic_source *source, conic_facts *facts) {
  hybrid_source *h = (hybrid_source *)source;
  const conic_hybrid_info *info = &h->info;
  conic_status status = conic_hybrid_is_url(source->name)
                            ? conic_hybrid_open(source->context, source->name, NULL, &h->hybrid)
                            : conic_hybrid_read(source->context, source->name, &h->hybrid);
  if (status == CONIC_OK)
    status = measure_hybrid(h);
  if (status != CONIC_OK)
    return status;
  CONIC_ADD_FACTS(
      facts, CONIC_COUNT("triangles", info->n_triangles), CONIC_COUNT("surfels", info->n_surfels),
      CONIC_COUNT("clusters", info->n_clusters), CONIC_COUNT("surfel_clusters", info->n_surfel_clusters),
      CONIC_COUNT("nodes", info->n_nodes), CONIC_COUNT("levels", info->n_levels),
      CONIC_COUNT("node_levels", info->n_node_levels), CONIC_COUNT("all_triangles", info->n_all_triangles),
      CONIC_COUNT("all_surfels", info->n_all_surfels), CONIC_COUNT("vertices", info->n_vertices),
      CONIC_COUNT("textures", info->n_textures), CONIC_NUMBER("cutoff", info->cutoff),
      CONIC_NUMBER("splat_length", info->splat_length), CONIC_NUMBER("near", info->near_z),
      CONIC_LINE("patches", "%zu: %zu of triangles, %zu of surfels", info->n_clusters,
                 info->n_clusters - info->n_surfel_clusters, info->n_surfel_clusters),
      CONIC_LINE("triangles", "%zu, %zu in all levels", info->n_triangles, info->n_all_triangles),
      CONIC_LINE("surfels", "%zu, %zu in all levels", info->n_surfels, info->n_all_surfels),
      CONIC_LINE("levels", "%zu, %.1f a patch", info->n_levels, (double)info->n_levels / (double)info->n_clusters),
      CONIC_LINE("nodes", "%zu with %zu levels", info->n_nodes, info->n_node_levels),
      CONIC_LINE("vertices", "%zu", info->n_vertices));
  if (info->n_textures)
    CONIC_ADD_FACTS(facts, CONIC_LINE("textures", "%zu", info->n_textures));
  CONIC_ADD_FACTS(facts, CONIC_LINE("cutoff", "%g", (double)info->cutoff));
  conic_facts_add_bounds(facts, info->minimum, info->maximum);
  return CONIC_OK;
}

static conic_status tell_hybrid_defects(conic_source *source, conic_facts *facts) {
  conic_hybrid_defects broken;
  conic_status status = conic_hybrid_check(((hybrid_source *)source)->hybrid, &broken);
  if (status == CONIC_OK)
    CONIC_ADD_FACTS(facts, CONIC_DEFECT("values", broken.values, "numbers that are not finite"),
                    CONIC_DEFECT("spheres", broken.spheres, "spheres that do not hold their patch"),
                    CONIC_DEFECT("cones", broken.cones, "cones that do not hold their patch's normals"),
                    CONIC_DEFECT("levels", broken.levels, "patches whose levels are out of order"));
  return status;
}

const conic_source_kind conic_source_kind_hybrid = {
    .size = sizeof(hybrid_source),
    .abilities = CONIC_SOURCE_CHOOSES | CONIC_SOURCE_CLUSTERS | CONIC_SOURCE_READS_PARTS,
    .company = CONIC_SOURCE_ALONE,
    .takes = takes_hybrid,
    .open = open_hybrid,
    .close = close_hybrid,
    .choose = choose_from_hybrid,
    .windowing = &conic_source_windowing_choice,
    .name_image = name_hybrid_image,
    .name_splat = name_hybrid_splat,
    .tell_primitives = tell_hybrid_primitives,
    .tell_rest = tell_hybrid_rest,
    .is_file = is_hybrid_name,
    .name = "chy",
    .tell_file = tell_hybrid_file,
    .tell_defects = tell_hybrid_defects,
};
