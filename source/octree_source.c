/* Octrees: from a .cot, the nodes that the error or the budget asks for; without either, its leaves. */

#include "core/base/context_struct.h"
#include "core/base/trigonometry.h"
#include "lod/octree/octree_nodes.h"
#include "source/facing.h"
#include "source/source_kind.h"

typedef struct octree_source {
  conic_source base;
  conic_octree *octree;
  conic_octree_info info;
  conic_selection selection;
  conic_splats leaves; /* empty until all of them are needed */
  conic_facing facing; /* those */
} octree_source;

static int takes_octree(const char *path, const conic_source_options *options) {
  return !options->is_whole && conic_octree_is_file(path);
}

static conic_status measure_octree(octree_source *o) {
  conic_source_scale *scale = &o->base.scale;
  conic_status status = conic_octree_describe(o->octree, &o->info);
  o->base.splats_version = conic_context_next_version(o->base.context);
  memcpy(scale->minimum, o->info.minimum, sizeof scale->minimum);
  memcpy(scale->maximum, o->info.maximum, sizeof scale->maximum);
  scale->near_z = o->info.near_z;
  scale->splat_length = o->info.splat_length;
  scale->n_splats = o->info.n_points;
  scale->has_colors = o->octree->leaves.color[0] != NULL;
  return status;
}

static conic_status open_octree(conic_source *source, const char *const *paths, size_t n_paths,
                                const conic_source_options *options) {
  octree_source *o = (octree_source *)source;
  (void)n_paths, (void)options;
  conic_status status = conic_octree_read(source->context, paths[0], &o->octree);
  return status == CONIC_OK ? measure_octree(o) : status;
}

conic_status conic_source_of_octree(conic_context *context, conic_octree *octree, conic_source **source) {
  conic_status status = conic_source_create(context, &conic_source_kind_octree, "octree", source);
  if (status != CONIC_OK) {
    conic_octree_destroy(octree);
    return status;
  }
  ((octree_source *)*source)->octree = octree;
  return conic_source_finish(measure_octree((octree_source *)*source), source);
}

const conic_octree *conic_source_octree(const conic_source *source) {
  return source->kind == &conic_source_kind_octree ? ((const octree_source *)source)->octree : NULL;
}

static conic_status draw_octree_boxes(conic_source *source, const conic_camera *camera, int level,
                                      const conic_image *image, conic_image *map) {
  return conic_octree_draw_boxes(((octree_source *)source)->octree, camera, level, image, map);
}

static void close_octree(conic_source *source) {
  octree_source *o = (octree_source *)source;
  conic_selection_release(source->context, &o->selection);
  conic_facing_end(source->context, &o->facing);
  conic_splats_release(source->context, &o->leaves);
  conic_octree_destroy(o->octree);
}

static conic_status need_leaves(octree_source *o) {
  if (o->leaves.count)
    return CONIC_OK;
  conic_status status = conic_octree_leaves(o->octree, &o->leaves);
  if (status == CONIC_OK)
    status = conic_facing_begin(o->base.context, &o->leaves, &o->facing);
  if (o->facing.n_dots)
    o->base.splats_version = 0;
  if (status != CONIC_OK) {
    conic_facing_end(o->base.context, &o->facing);
    conic_splats_release(o->base.context, &o->leaves);
  }
  return status;
}

static conic_status find_octree_spacing(conic_source *source, double *spacing) {
  octree_source *o = (octree_source *)source;
  conic_status status = need_leaves(o);
  return status == CONIC_OK ? conic_splats_spacing(source->context, &o->leaves, spacing) : status;
}

/* The opacities of nodes tell how much their leaves weigh, not how much light they let through. */
static conic_status settle_transparency(octree_source *o) {
  conic_status status = need_leaves(o);
  const conic_drawing leaves = {.splats = &o->leaves};
  if (status == CONIC_OK && conic_drawing_is_transparent(&leaves))
    return conic_fail(o->base.context, CONIC_ERROR_UNSUPPORTED,
                      "%s: the nodes of an octree keep no opacities: transparency is of all its points, without an "
                      "error or a budget",
                      o->base.name);
  o->base.view.transparency = CONIC_TRANSPARENCY_NONE;
  return status;
}

static conic_status choose_from_octree(conic_source *source, const conic_camera *camera,
                                       const conic_render_options *render, const conic_source_view *view) {
  octree_source *o = (octree_source *)source;
  conic_source_choice *choice = &source->choice;
  conic_selection_options options;
  conic_selection_options_init(&options);
  options.error_px = view->error_px;
  options.budget = view->budget;
  choice->is_all = view->error_px == 0.0 && view->budget == 0;
  choice->drawing.splats = choice->is_all ? &o->leaves : &o->selection.splats;
  conic_status status = choice->is_all ? need_leaves(o) : CONIC_OK;
  if (choice->is_all && status == CONIC_OK)
    return conic_facing_turn(source->context, &o->facing, camera, &choice->drawing.splats);
  if (view->transparency && status == CONIC_OK)
    status = settle_transparency(o);
  if (status != CONIC_OK)
    return status;
  status = conic_octree_select(o->octree, camera, render, &options, &o->selection);
  choice->ids = o->selection.ids;
  choice->error_px = o->selection.error_px;
  choice->n_culled = o->selection.n_culled;
  return status;
}

static void name_octree_image(const conic_source *source, conic_image *image) {
  conic_selection_name(&((const octree_source *)source)->selection, image);
}

static const char *name_octree_splat(const conic_source *source, uint32_t splat, uint32_t *number) {
  const octree_source *o = (const octree_source *)source;
  uint32_t id = o->selection.ids[splat], n_points = (uint32_t)o->info.n_points;
  *number = id < n_points ? id : id - n_points;
  return id < n_points ? "point" : "node";
}

/* NOLINTNEXTLINE(readability-non-const-parameter): other kinds count */
static void tell_octree_primitives(const conic_source *source, conic_facts *facts, uint64_t *n_splats) {
  const conic_selection *selection = &((const octree_source *)source)->selection;
  (void)n_splats;
  CONIC_ADD_FACTS(facts, CONIC_COUNT("leaves", selection->splats.count - selection->n_inner), /* leaves that are handed
                                                                                                 over */
                  CONIC_COUNT("inner_nodes", selection->n_inner));
}

/* --- files --- */

/* Half the opening of a cone from its cosine: twice the angle whose tangent is √((1 - c) / (1 + c)). */
static double cone_degrees(double cosine) {
  double low = 0.0, high = 0.5 * CONIC_PI, tangent_squared = fmax(1.0 - cosine, 0.0) / fmax(1.0 + cosine, 0.0);
  for (int i = 0; i < 60; i++) {
    double middle = 0.5 * (low + high), tangent = conic_tan(middle);
    if (tangent * tangent <= tangent_squared)
      low = middle;
    else
      high = middle;
  }
  return low > 0.0 ? (low + high) * (180.0 / CONIC_PI) : 0.0;
}

static void tell_three(conic_facts *facts, const char *key, const double sorted[3]) {
  CONIC_ADD_FACTS(facts, CONIC_OBJECT(key), CONIC_NUMBER("min", sorted[0]), CONIC_NUMBER("median", sorted[1]),
                  CONIC_NUMBER("max", sorted[2]), CONIC_END);
}

static conic_status tell_octree_file(conic_source *source, conic_facts *facts) {
  const char *const path = source->name;
  const conic_octree_info *info = &((octree_source *)source)->info;
  double cone[3];
  char missing[64] = "", moved[64] = "as they were";
  conic_status status = open_octree(source, &path, 1, NULL);
  if (status != CONIC_OK)
    return status;
  for (int i = 0; i < 3; i++)
    cone[i] = cone_degrees(info->cone[2 - i]);
  if (info->n_leaves < info->n_points)
    snprintf(missing, sizeof missing, " (%zu cannot be drawn)", info->n_points - info->n_leaves);
  if (info->is_quantized)
    snprintf(moved, sizeof moved, "quantised: moved by %.3g at most", info->position_error);
  CONIC_ADD_FACTS(facts, CONIC_COUNT("points", info->n_points), CONIC_COUNT("leaves", info->n_leaves),
                  CONIC_COUNT("nodes", info->n_nodes + info->n_leaves), CONIC_COUNT("inner_nodes", info->n_nodes),
                  CONIC_COUNT("levels", info->n_levels), CONIC_TRUTH("quantized", info->is_quantized),
                  CONIC_NUMBER("position_error", info->position_error), CONIC_NUMBER("cutoff", info->cutoff),
                  CONIC_NUMBER("splat_length", info->splat_length), CONIC_NUMBER("near", info->near_z),
                  CONIC_LINE("points", "%zu%s", info->n_points, missing),
                  CONIC_LINE("nodes", "%zu in %d levels, %.3f a point", info->n_nodes, info->n_levels,
                             (double)info->n_nodes / (double)info->n_points),
                  CONIC_LINE("leaves", "%s", moved), CONIC_LINE("cutoff", "%g", (double)info->cutoff));
  conic_facts_add_bounds(facts, info->minimum, info->maximum);
  tell_three(facts, "radius", info->radius);
  tell_three(facts, "cone_deg", cone);
  CONIC_ADD_FACTS(facts,
                  CONIC_LINE("radii", "%.3g to %.3g, median %.3g", info->radius[0], info->radius[2], info->radius[1]),
                  CONIC_LINE("cones", "%.1f° to %.1f°, median %.1f°", cone[0], cone[2], cone[1]));
  return CONIC_OK;
}

static conic_status tell_octree_defects(conic_source *source, conic_facts *facts) {
  conic_octree_defects broken;
  conic_status status = conic_octree_check(((octree_source *)source)->octree, &broken);
  if (status == CONIC_OK)
    CONIC_ADD_FACTS(facts, CONIC_DEFECT("ellipses", broken.ellipses, "nodes whose ellipse does not hold its leaves"),
                    CONIC_DEFECT("spheres", broken.spheres, "nodes whose sphere does not hold its leaves"),
                    CONIC_DEFECT("cones", broken.cones, "nodes whose cone does not hold its leaves' normals"),
                    CONIC_DEFECT("errors", broken.errors, "nodes that are farther from their leaves than they say"),
                    CONIC_DEFECT("splats", broken.splats, "leaves that cannot be drawn"));
  return status;
}

static conic_status take_octree_splats(conic_source *source, conic_splats *splats) {
  return conic_octree_leaves(((octree_source *)source)->octree, splats);
}

const conic_source_kind conic_source_kind_octree = {
    .size = sizeof(octree_source),
    .abilities = CONIC_SOURCE_CHOOSES,
    .company = CONIC_SOURCE_SINGLE,
    .takes = takes_octree,
    .open = open_octree,
    .close = close_octree,
    .find_spacing = find_octree_spacing,
    .choose = choose_from_octree,
    .windowing = &conic_source_windowing_choice,
    .draw_boxes = draw_octree_boxes,
    .name_image = name_octree_image,
    .name_splat = name_octree_splat,
    .tell_primitives = tell_octree_primitives,
    .is_file = conic_octree_is_file,
    .name = "cot",
    .tell_file = tell_octree_file,
    .tell_defects = tell_octree_defects,
    .take_splats = take_octree_splats,
};
