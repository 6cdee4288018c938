/* Points drawn as part of a smooth surface, by samples of the polynomials about them. */

#include "source/source_kind.h"

/* ε of a mesh's patches, in their distances from the vertices next to their own; and the most, in points' ε. */
static const double MESH_EPSILON = 16.0, MOST_EPSILON = 0.0625;

typedef struct patches_source {
  conic_source base;
  conic_source *points;
  conic_patches *patches;
  conic_patch_selection selection;
} patches_source;

static int takes_patches(const char *path, const conic_source_options *options) {
  (void)path;
  return options->as == CONIC_AS_PATCHES;
}

/* Patches through a mesh's vertices are as near to each other as they are to these, wherever the vertices lie. */
static void set_mesh_epsilon(patches_source *p) {
  conic_patches_report report;
  conic_patches_describe(p->patches, &report);
  double near = MESH_EPSILON * report.mesh_off, most = MOST_EPSILON * p->base.scale.epsilon;
  near = near < most ? near : most;
  near = near > p->points->tolerance ? near : p->points->tolerance;
  if (report.mesh_off >= 0.0 && near < p->base.scale.epsilon)
    p->base.scale.epsilon = near;
}

/* ε depends on the points, not on their samples. */
static conic_status lay_patches(patches_source *p, const conic_triangles *mesh, const conic_source_options *options) {
  const conic_splats *splats = conic_source_chosen(p->points)->drawing.splats;
  conic_patches_options laying;
  double spacing = 1.0;
  conic_status status = CONIC_OK;
  if (options->patches)
    laying = *options->patches;
  else
    conic_patches_options_init(&laying);
  laying.cutoff = options->cutoff;
  if (options->h_in_spacings && laying.surface.h > 0.0)
    status = conic_source_spacing(p->points, &spacing);
  laying.surface.h *= spacing;
  laying.mesh = mesh;
  p->base.scale.epsilon = (double)options->cutoff * p->base.scale.splat_length;
  if (status == CONIC_OK)
    status = conic_patches_create(p->base.context, splats, &laying, &p->patches);
  if (status == CONIC_OK)
    set_mesh_epsilon(p);
  return status;
}

static conic_status open_patches(conic_source *source, const char *const *paths, size_t n_paths,
                                 const conic_source_options *options) {
  patches_source *p = (patches_source *)source;
  conic_source_options whole = *options;
  whole.as = CONIC_AS_POINTS;
  whole.is_whole = 1;
  whole.finds_dots = 0; /* polynomials are laid through all points alike */
  conic_status status = conic_source_open(source->context, paths, n_paths, &whole, &p->points);
  if (status != CONIC_OK)
    return status;
  unsigned abilities = source->scale.abilities;
  source->scale = *conic_source_measure(p->points);
  source->scale.abilities = abilities;
  source->scale.follows_cutoff = 1;
  source->coloring = p->points->coloring;
  source->traits = p->points->traits;
  source->no_traits = p->points->no_traits;
  conic_source *mesh = NULL;
  if (p->points->tolerance > 0.0) { /* faces say how the surface goes on from vertex to vertex */
    whole.as = CONIC_AS_AUTO;
    whole.coloring = NULL;
    whole.texture_path = NULL;
    status = conic_source_open(source->context, paths, n_paths, &whole, &mesh);
  }
  double start = conic_seconds_now();
  if (status == CONIC_OK)
    status = lay_patches(p, mesh ? conic_source_chosen(mesh)->drawing.triangles : NULL, options);
  source->traits |= mesh ? mesh->traits & CONIC_TRAIT_EDGES : 0;
  source->no_traits &= ~source->traits;
  conic_source_close(mesh);
  source->scale.estimate_seconds += conic_seconds_now() - start;
  return status;
}

static void close_patches(conic_source *source) {
  patches_source *p = (patches_source *)source;
  conic_patches_destroy(p->patches);
  conic_source_close(p->points);
}

static conic_status find_patches_spacing(conic_source *source, double *spacing) {
  return conic_source_spacing(((patches_source *)source)->points, spacing);
}

static conic_status choose_from_patches(conic_source *source, const conic_camera *camera,
                                        const conic_render_options *render, const conic_source_view *view) {
  patches_source *p = (patches_source *)source;
  (void)view;
  conic_status status = conic_patches_select(p->patches, camera, render, &p->selection);
  source->choice.drawing.splats = &p->selection.splats;
  source->choice.ids = p->selection.points;
  return status;
}

static void name_patches_image(const conic_source *source, conic_image *image) {
  conic_patch_selection_name(&((const patches_source *)source)->selection, image);
}

static const char *name_patches_splat(const conic_source *source, uint32_t splat, uint32_t *number) {
  *number = ((const patches_source *)source)->selection.points[splat];
  return "point";
}

static size_t find_patches_input(const conic_source *source, uint32_t id) {
  return conic_source_input_of(((const patches_source *)source)->points, id);
}

/* Facts of what was handed over for drawing. */
static void tell_patches_primitives(const conic_source *source, conic_facts *facts, uint64_t *n_splats) {
  const conic_patch_selection *selection = &((const patches_source *)source)->selection;
  *n_splats = selection->n_splats;
  CONIC_ADD_FACTS(facts, CONIC_COUNT("patches", selection->n_patches), CONIC_COUNT("samples", selection->n_samples));
}

static void tell_patches_rest(const conic_source *source, conic_facts *facts) {
  const conic_source *points = ((const patches_source *)source)->points;
  if (points->kind->tell_rest)
    points->kind->tell_rest(points, facts);
}

const conic_source_kind conic_source_kind_patches = {
    .size = sizeof(patches_source),
    .company = CONIC_SOURCE_MANY,
    .takes = takes_patches,
    .open = open_patches,
    .close = close_patches,
    .find_spacing = find_patches_spacing,
    .choose = choose_from_patches,
    .windowing = &conic_source_windowing_choice,
    .name_image = name_patches_image,
    .name_splat = name_patches_splat,
    .input_of = find_patches_input,
    .tell_primitives = tell_patches_primitives,
    .tell_rest = tell_patches_rest,
};
