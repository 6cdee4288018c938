#include "source/lean_drawing.h"

#include "core/image/viewpoint.h"
#include "lod/hybrid/build/hybrid_build.h"
#include "lod/planner/plan.h"

/* What is chosen for one picture. */
typedef struct lean_choosing {
  conic_source *source;
  const conic_drawing *all;
  const conic_splats *unturned;
  const conic_camera *camera;
  const conic_render_options *render;
  conic_lean_drawing *lean;
  conic_drawing drawing;
  const uint32_t *ids;
  size_t n_culled;
  double reached_px; /* the greatest error of what is chosen */
  conic_status status;
} lean_choosing;

/* --- making --- */

static conic_status read_octree(conic_context *context, const char *path, void **octree) {
  return conic_octree_read(context, path, (conic_octree **)octree);
}

static conic_status read_levels(conic_context *context, const char *path, void **hybrid) {
  return conic_hybrid_read(context, path, (conic_hybrid **)hybrid);
}

static conic_status write_octree(void *octree, const char *path) {
  return conic_octree_write(octree, path);
}

static conic_status write_levels(void *hybrid, const char *path) {
  return conic_hybrid_write(hybrid, path);
}

/* What the cache has of a set; *kept stays null where there is nothing, or no cache. */
static conic_status find_kept(const lean_choosing *c, const conic_drawing *of, const char *ending,
                              conic_lean_cache_reader *read, char path[CONIC_LEAN_CACHE_PATH], void **kept) {
  conic_context *context = c->source->context;
  if (!c->lean->cache)
    return CONIC_OK;
  conic_status status = conic_lean_cache_path(context, c->lean->cache, of, c->render->kernel.cutoff, ending, path);
  if (status == CONIC_OK)
    status = conic_lean_cache_read(context, path, read, kept);
  c->lean->is_from_cache |= *kept != NULL;
  return status;
}

static conic_status need_octree(const lean_choosing *c) {
  conic_lean_drawing *lean = c->lean;
  conic_context *context = c->source->context;
  conic_octree_options options;
  conic_splats copy = {0};
  if (lean->octree && lean->cutoff == c->render->kernel.cutoff)
    return CONIC_OK;
  double start = conic_seconds_now();
  conic_selection_release(context, &lean->nodes);
  conic_octree_destroy(lean->octree);
  lean->octree = NULL;
  lean->cutoff = c->render->kernel.cutoff;
  conic_octree_options_init(&options);
  options.cutoff = lean->cutoff;
  memcpy(copy.origin, c->unturned->origin, sizeof copy.origin);
  const conic_drawing splats = {.splats = c->unturned};
  char path[CONIC_LEAN_CACHE_PATH];
  void *kept = NULL;
  conic_status status = find_kept(c, &splats, "cot", read_octree, path, &kept);
  lean->octree = kept;
  if (status == CONIC_OK && !kept)
    status = conic_splats_append(context, &copy, c->unturned);
  if (status == CONIC_OK && !kept)
    status = conic_octree_build(context, &copy, &options, &lean->octree);
  if (status == CONIC_OK && !kept && lean->cache)
    status = conic_lean_cache_write(context, lean->cache, path, write_octree, lean->octree);
  lean->build_seconds += conic_seconds_now() - start;
  return status;
}

/* The length that is so many pixels wherever the mesh is; 0: it reaches the near distance. */
static double find_most_error(const lean_choosing *c, double error_px) {
  double low[3], high[3], place[3], p[3], extent[3];
  conic_viewpoint from;
  conic_triangles_bounds(c->all->triangles, low, high);
  conic_viewpoint_init(&from, c->camera, low, 0.0);
  for (int axis = 0; axis < 3; axis++) {
    extent[axis] = high[axis] - low[axis];
    place[axis] = 0.5 * extent[axis];
  }
  conic_viewpoint_move(&from, place, p);
  double focal_px = c->camera->fx > c->camera->fy ? c->camera->fx : c->camera->fy;
  return conic_viewpoint_length_of(p, 0.5 * conic_length(extent), c->render->near_z, focal_px, error_px);
}

/* For this picture alone, or once. */
static conic_status need_levels(const lean_choosing *c, double error_px) {
  const double slack = 1.25; /* spheres about the mesh differ */
  conic_lean_drawing *lean = c->lean;
  conic_hybrid_options options;
  double most_error = lean->is_alone ? slack * find_most_error(c, error_px) : 0.0;
  if (lean->levels && !lean->is_alone && !lean->are_levels_cut)
    return CONIC_OK;
  double start = conic_seconds_now();
  conic_hybrid_selection_release(c->source->context, &lean->triangles);
  conic_hybrid_destroy(lean->levels);
  lean->levels = NULL;
  lean->are_levels_cut = lean->is_alone;
  if (lean->is_alone && !(most_error > 0.0))
    return CONIC_OK;
  conic_hybrid_options_init(&options);
  options.cutoff = c->render->kernel.cutoff;
  const conic_drawing triangles = {.triangles = c->all->triangles};
  char path[CONIC_LEAN_CACHE_PATH];
  void *kept = NULL;
  const int may_keep = lean->cache && !lean->is_alone;
  conic_status status = may_keep ? find_kept(c, &triangles, "chy", read_levels, path, &kept) : CONIC_OK;
  lean->levels = kept;
  if (status == CONIC_OK && !kept)
    status = conic_hybrid_build_lent(c->source->context, c->all->triangles, &options, most_error, &lean->levels);
  if (status == CONIC_OK && !kept && may_keep)
    status = conic_lean_cache_write(c->source->context, lean->cache, path, write_levels, lean->levels);
  lean->build_seconds += conic_seconds_now() - start;
  return status;
}

/* --- choosing --- */

static void raise_reached(lean_choosing *c, double error_px) {
  c->reached_px = error_px > c->reached_px ? error_px : c->reached_px;
}

static conic_status choose_cells(lean_choosing *c, double error_px) {
  conic_lean_drawing *lean = c->lean;
  double start = conic_seconds_now();
  conic_screen_cells_release(c->source->context, &lean->cells);
  conic_status status =
      conic_screen_cells_find(c->source->context, c->all->splats, c->camera, c->render, error_px, &lean->cells);
  lean->build_seconds += conic_seconds_now() - start;
  if (status != CONIC_OK || !lean->cells.n_joined)
    return status;
  c->drawing.splats = &lean->cells.splats;
  c->ids = lean->cells.ids;
  c->n_culled += lean->cells.n_culled;
  raise_reached(c, error_px);
  return CONIC_OK;
}

static conic_status choose_nodes(lean_choosing *c, double error_px, uint64_t budget) {
  conic_lean_drawing *lean = c->lean;
  conic_selection_options options;
  conic_selection_options_init(&options);
  options.error_px = error_px;
  options.budget = budget;
  conic_status status = need_octree(c);
  if (status == CONIC_OK)
    status = conic_octree_select(lean->octree, c->camera, c->render, &options, &lean->nodes);
  if (status != CONIC_OK || (!budget && !lean->nodes.n_inner))
    return status;
  c->drawing.splats = &lean->nodes.splats;
  c->ids = lean->nodes.ids;
  c->n_culled += lean->nodes.n_culled;
  raise_reached(c, lean->nodes.error_px);
  return CONIC_OK;
}

/* Where clusters of several levels meet, triangles may be off by so many times what the model states
 * (docs/reference/hybrid.md). */
static const double fitted_share = 1.2;

/* All triangles stay where none of the simpler levels keeps the error, or all of these are needed. */
static conic_status choose_levels(lean_choosing *c, double error_px, uint64_t budget) {
  conic_lean_drawing *lean = c->lean;
  const double share = lean->is_alone ? 1.0 : fitted_share;
  conic_hybrid_view view;
  conic_hybrid_view_init(&view);
  view.error_px = budget ? 0.0 : error_px / share;
  view.budget = budget;
  view.only_kind = CONIC_HYBRID_TRIANGLES;
  view.color_error = c->source->view.color_error;
  conic_status status = need_levels(c, error_px);
  if (status != CONIC_OK || !lean->levels)
    return status;
  status = conic_hybrid_select(lean->levels, c->camera, c->render, &view, &lean->triangles);
  const conic_hybrid_selection *chosen = &lean->triangles;
  if (status != CONIC_OK || (!budget && !(chosen->error_px > 0.0 && share * chosen->error_px <= error_px)))
    return status;
  c->drawing.triangles = &lean->triangles.triangles;
  c->n_culled += chosen->n_culled;
  raise_reached(c, share * chosen->error_px);
  return CONIC_OK;
}

/* For an error; or, of splats or triangles alone, for a budget. */
static conic_status choose_parts(lean_choosing *c, double error_px, uint64_t budget) {
  conic_status status = CONIC_OK;
  c->drawing = *c->all;
  c->ids = NULL;
  c->n_culled = 0;
  c->reached_px = 0.0;
  if (c->all->splats->count)
    status = c->lean->is_cut ? choose_cells(c, error_px) : choose_nodes(c, error_px, budget);
  if (status == CONIC_OK && c->all->triangles->count && !c->source->is_moved)
    status = choose_levels(c, error_px, budget);
  return status;
}

static uint64_t count_parts(void *data, double error_px, double *reached_px) {
  lean_choosing *c = data;
  if (c->status == CONIC_OK)
    c->status = choose_parts(c, error_px, 0);
  *reached_px = c->reached_px > 0.0 ? c->reached_px : error_px;
  return c->drawing.splats->count + c->drawing.triangles->count;
}

static conic_status choose_for_budget(lean_choosing *c, uint64_t budget) {
  double error_px;
  if (!c->lean->is_cut && (!c->all->splats->count || !c->all->triangles->count) && !c->source->is_moved)
    return choose_parts(c, 0.0, budget);
  if (!conic_plan_fit(count_parts, c, budget, 0.0, &error_px) && c->status == CONIC_OK)
    return conic_fail(c->source->context, CONIC_ERROR_ARGUMENT, "%s: no choice of so few splats and triangles",
                      c->source->name);
  return c->status == CONIC_OK ? choose_parts(c, error_px, 0) : c->status;
}

/* What stands for several has no opacity that tells how much light it lets through. */
static conic_status settle_transparency(conic_source *source, const conic_drawing *all) {
  if (source->view.transparency && conic_drawing_is_transparent(all))
    return conic_fail(source->context, CONIC_ERROR_UNSUPPORTED,
                      "%s: what an error or a budget leaves keeps no opacities: transparency is of all there is",
                      source->name);
  source->view.transparency = CONIC_TRANSPARENCY_NONE;
  return CONIC_OK;
}

static void tell_choice(const lean_choosing *c) {
  conic_log(c->source->context, CONIC_LOG_INFO,
            "%s: %zu of %zu splats%s and %zu of %zu triangles keep %.3g pixels; building took %.0f ms", c->source->name,
            c->drawing.splats->count, c->all->splats->count, c->lean->is_cut ? ", by cells," : "",
            c->drawing.triangles->count, c->all->triangles->count, c->reached_px, 1e3 * c->lean->build_seconds);
}

conic_status conic_lean_choose(conic_source *source, const conic_drawing *all, const conic_splats *unturned,
                               const conic_camera *camera, const conic_render_options *render,
                               conic_lean_drawing *lean) {
  const conic_source_view *view = &source->view;
  lean_choosing c = {.source = source,
                     .all = all,
                     .unturned = unturned,
                     .camera = camera,
                     .render = render,
                     .lean = lean,
                     .drawing = *all};
  conic_status status = settle_transparency(source, all);
  lean->is_alone = view->is_alone && !view->budget;
  lean->is_cut = lean->is_alone || source->is_moved;
  const double built_before = lean->build_seconds;
  if (status == CONIC_OK && view->error_px > 0.0)
    status = choose_parts(&c, view->error_px, 0);
  else if (status == CONIC_OK && view->budget < all->splats->count + all->triangles->count)
    status = choose_for_budget(&c, view->budget);
  if (status != CONIC_OK)
    return status;
  if (lean->build_seconds > built_before)
    tell_choice(&c);
  conic_source_choice *choice = &source->choice;
  choice->drawing = c.drawing;
  choice->ids = c.ids;
  choice->n_culled = c.n_culled;
  choice->error_px = c.reached_px;
  lean->n_ids = all->splats->count;
  if (c.ids && !lean->is_cut) {
    conic_octree_info info;
    conic_octree_describe(lean->octree, &info);
    lean->n_ids += info.n_nodes;
  }
  choice->is_all = c.drawing.splats == all->splats && c.drawing.triangles == all->triangles;
  return CONIC_OK;
}

double conic_lean_saving(const conic_source *source, const conic_camera *camera, const conic_render_options *render) {
  enum { PART = 8, FEWEST = 1000 };
  const conic_splats *splats = source->choice.drawing.splats;
  conic_camera middle = *camera;
  conic_screen_cells cells;
  double saving = 1.0;
  if (source->kind != &conic_source_kind_drawing || !source->choice.is_all)
    return saving;
  middle.width = (camera->width + PART - 1) / PART;
  middle.height = (camera->height + PART - 1) / PART;
  middle.cx -= 0.5 * (camera->width - middle.width);
  middle.cy -= 0.5 * (camera->height - middle.height);
  if (conic_screen_cells_find(source->context, splats, &middle, render, 1.0, &cells) == CONIC_OK) {
    const size_t n_seen = splats->count - cells.n_culled;
    if (n_seen >= FEWEST)
      saving = (double)n_seen / (double)cells.splats.count;
  }
  conic_screen_cells_release(source->context, &cells);
  return saving;
}

/* --- what it is called --- */

void conic_lean_name(const conic_lean_drawing *lean, const conic_source_choice *choice, conic_image *image) {
  uint32_t *ids = image->planes[CONIC_PLANE_ID];
  const size_t n_splats = choice->drawing.splats->count, n = (size_t)image->width * (size_t)image->height;
  for (size_t i = 0; ids && i < n; i++)
    if (ids[i] < n_splats)
      ids[i] = choice->ids ? choice->ids[ids[i]] : ids[i];
    else if (ids[i] != CONIC_NO_ID)
      ids[i] += (uint32_t)(lean->n_ids - n_splats);
}

void conic_lean_tell(const conic_lean_drawing *lean, const conic_source_choice *choice, conic_facts *facts) {
  const int has_triangles = lean->levels && choice->drawing.triangles == &lean->triangles.triangles;
  CONIC_ADD_FACTS(facts, CONIC_OBJECT("lean"),
                  conic_fact_text(CONIC_FACT_TEXT, "splats", "%s",
                                  !choice->ids   ? "all"
                                  : lean->is_cut ? "cells"
                                                 : "octree"),
                  conic_fact_text(CONIC_FACT_TEXT, "triangles", "%s", has_triangles ? "levels" : "all"),
                  CONIC_NUMBER("ms", 1e3 * lean->build_seconds), CONIC_TRUTH("cached", lean->is_from_cache), CONIC_END);
}

void conic_lean_release(conic_context *context, conic_lean_drawing *lean) {
  conic_selection_release(context, &lean->nodes);
  conic_screen_cells_release(context, &lean->cells);
  conic_hybrid_selection_release(context, &lean->triangles);
  conic_octree_destroy(lean->octree);
  conic_hybrid_destroy(lean->levels);
  conic_memory_release(context, lean->cache);
  memset(lean, 0, sizeof *lean);
}
