/* What all sources share: which kind takes which input, the box and the camera, and the steps around a kind's own
 * functions. */

#include "core/base/vectors.h"
#include "source/carried.h"
#include "source/reach.h"
#include "source/surfaces_among.h"

/* Every kind, in the order in which they are asked; the last takes all remaining inputs. */
static const conic_source_kind *const kinds[] = {
    &conic_source_kind_levels, &conic_source_kind_level_scenes,   &conic_source_kind_gaussians,
    &conic_source_kind_scenes, &conic_source_kind_level_together, &conic_source_kind_together,
    &conic_source_kind_layers, &conic_source_kind_hybrid,         &conic_source_kind_patches,
    &conic_source_kind_octree, &conic_source_kind_drawing};
enum { N_KINDS = sizeof kinds / sizeof kinds[0] };

CONIC_DEFINE_OPTIONS(conic_source_options, .cutoff = 1.5f, .n_neighbours = 20)

CONIC_DEFINE_OPTIONS(conic_source_view, .only_kind = -1, .samples = 1, .color_error = 2.0)

/* --- kinds --- */

static int takes_inputs(const conic_source_kind *kind, const char *const *paths, size_t n,
                        const conic_source_options *options) {
  const size_t wanted = kind->company == CONIC_SOURCE_ALIKE ? n : 1;
  size_t n_taken = 0;
  size_t n_wanted = 0;
  if (kind->company == CONIC_SOURCE_SINGLE && n != 1)
    return 0;
  while (kind->wants && n_wanted < n && !kind->wants(paths[n_wanted]))
    n_wanted++;
  if (kind->wants && n_wanted == n)
    return 0;
  for (size_t i = 0; i < n && n_taken < wanted; i++)
    n_taken += (size_t)(kind->takes(paths[i], options) != 0);
  return n_taken == wanted;
}

const conic_source_kind *conic_source_kind_find(const char *const *paths, size_t n,
                                                const conic_source_options *options) {
  int i = 0;
  while (i < N_KINDS - 1 && !takes_inputs(kinds[i], paths, n, options))
    i++;
  return kinds[i];
}

const conic_source_kind *conic_source_kind_of_file(const char *path) {
  for (int i = 0; i < N_KINDS; i++)
    if (kinds[i]->is_file && kinds[i]->is_file(path))
      return kinds[i];
  return NULL;
}

unsigned conic_source_abilities(const char *const *paths, size_t n_paths, const conic_source_options *options) {
  conic_source_options own;
  conic_source_options_init(&own);
  conic_options_take(&own, options);
  return conic_source_kind_find(paths, n_paths, &own)->abilities;
}

/* --- opening and closing --- */

conic_status conic_source_create(conic_context *context, const conic_source_kind *kind, const char *name,
                                 conic_source **source) {
  conic_source *s = conic_memory_allocate_zeroed(context, kind->size + strlen(name) + 1, 1);
  *source = s;
  if (!s)
    return CONIC_ERROR_MEMORY;
  s->kind = kind;
  s->context = context;
  s->name = memcpy((char *)s + kind->size, name, strlen(name) + 1);
  s->scale.abilities = kind->abilities;
  s->scale.up[1] = 1.0;
  s->scale.epsilon = -1.0;
  return CONIC_OK;
}

conic_status conic_source_finish(conic_status status, conic_source **source) {
  if (status == CONIC_OK)
    return CONIC_OK;
  conic_source_close(*source);
  *source = NULL;
  return status;
}

conic_status conic_source_open_kind(conic_context *context, const conic_source_kind *kind, const char *const *paths,
                                    size_t n_paths, const conic_source_options *options, conic_source **source) {
  double start = conic_seconds_now();
  conic_status status = conic_source_create(context, kind, paths[0], source);
  if (status != CONIC_OK)
    return status;
  status = kind->open(*source, paths, n_paths, options);
  (*source)->scale.read_seconds = conic_seconds_now() - start - (*source)->scale.estimate_seconds;
  return conic_source_finish(status, source);
}

conic_status conic_source_open(conic_context *context, const char *const *paths, size_t n_paths,
                               const conic_source_options *options, conic_source **source) {
  conic_source_options own;
  conic_source_options_init(&own);
  *source = NULL;
  if ((options && !conic_options_take(&own, options)) || n_paths == 0)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "source: no input, or the options were not initialised");
  const conic_source_kind *kind = conic_source_kind_find(paths, n_paths, &own);
  if (kind->company == CONIC_SOURCE_ALONE && n_paths != 1) {
    size_t i = 0;
    while (i < n_paths - 1 && conic_source_kind_find(&paths[i], 1, &own) != kind)
      i++;
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: a hybrid is drawn without other surfaces", paths[i]);
  }
  if (conic_coloring_is_asked(&own) &&
      (kind == &conic_source_kind_octree ||
       (kind == &conic_source_kind_layers &&
        (strcmp(own.coloring->by, "height") == 0 || strcmp(own.coloring->by, "normal") == 0))))
    return conic_coloring_refuse(context, paths[0], &own);
  if (own.place && !(kind->abilities & CONIC_SOURCE_COMPOSITES) && kind != &conic_source_kind_drawing)
    return conic_fail(context, CONIC_ERROR_INPUT,
                      "%s: only Gaussian scenes, and points and meshes that are read whole, "
                      "have a place of their own",
                      paths[0]);
  if (own.where && kind != &conic_source_kind_layers && kind != &conic_source_kind_drawing)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: points are chosen of files of points and of .lpc alone",
                      paths[0]);
  return conic_source_open_kind(context, kind, paths, n_paths, &own, source);
}

void conic_source_close(conic_source *source) {
  if (!source)
    return;
  source->kind->close(source);
  conic_splats_release(source->context, &source->outline);
  conic_memory_release(source->context, source);
}

/* --- measuring --- */

conic_status conic_source_draw_boxes(conic_source *source, const conic_camera *camera, int level,
                                     const conic_image *image, conic_image *map) {
  memset(map, 0, sizeof *map);
  return source->kind->draw_boxes
             ? source->kind->draw_boxes(source, camera, level, image, map)
             : conic_fail(source->context, CONIC_ERROR_ARGUMENT, "boxes: the source has no levels");
}

const conic_source_scale *conic_source_measure(const conic_source *source) {
  return &source->scale;
}

conic_status conic_source_spacing(conic_source *source, double *spacing) {
  *spacing = source->scale.spacing;
  if (*spacing > 0.0)
    return CONIC_OK;
  if (!source->kind->find_spacing)
    return conic_fail(source->context, CONIC_ERROR_ARGUMENT, "%s: it has no spacing", source->name);
  return source->kind->find_spacing(source, spacing);
}

conic_status conic_source_frame(const conic_source *source, const conic_framing *framing, conic_camera *camera) {
  const conic_source_scale *scale = &source->scale;
  conic_framing defaults;
  conic_framing_init(&defaults);
  memcpy(defaults.up, scale->up, sizeof defaults.up);
  if (!conic_is_in_reach(scale->minimum, scale->maximum))
    return conic_fail(source->context, CONIC_ERROR_INPUT, "%s: cannot be drawn: a point is farther out than 1e20",
                      source->name);
  return conic_camera_frame(source->context, framing ? framing : &defaults, scale->minimum, scale->maximum, camera);
}

void conic_source_settle(const conic_source *source, conic_render_options *render) {
  const conic_source_scale *scale = &source->scale;
  if (render->near_z == 0.0)
    render->near_z = scale->near_z;
  if (render->splat_length == 0.0)
    render->splat_length = scale->splat_length;
  if (render->epsilon < 0.0)
    render->epsilon = scale->epsilon;
}

/* --- poses --- */

void conic_source_pose_init(conic_source_pose *pose) {
  memset(pose, 0, sizeof *pose);
  for (int axis = 0; axis < 3; axis++)
    pose->world_from_rest[axis][axis] = 1.0;
}

/* NaN fails every test here. */
static int is_pose(const conic_source_pose *pose) {
  double across[3];
  const double(*m)[4] = (const double(*)[4])pose->world_from_rest;
  for (int row = 0; row < 3; row++)
    for (int column = 0; column < 4; column++)
      if (!(m[row][column] > -1e20 && m[row][column] < 1e20))
        return 0;
  conic_cross(m[0], m[1], across);
  return conic_dot(across, m[2]) > 0.0 && pose->part >= 0.0 && pose->part <= 1.0;
}

conic_status conic_source_move(conic_source *source, const conic_source_pose *poses, size_t n_poses) {
  for (size_t i = 0; poses && i < n_poses; i++)
    if (!is_pose(&poses[i]))
      return conic_fail(source->context, CONIC_ERROR_ARGUMENT,
                        "%s: the pose of input %zu mirrors it, makes it flat or is not finite", source->name, i);
  return source->kind->move ? source->kind->move(source, poses, n_poses) : conic_carried_move(source, poses, n_poses);
}

void conic_source_box(const conic_source *source, double minimum[3], double maximum[3]) {
  memcpy(minimum, source->is_moved ? source->moved_minimum : source->scale.minimum, 3 * sizeof *minimum);
  memcpy(maximum, source->is_moved ? source->moved_maximum : source->scale.maximum, 3 * sizeof *maximum);
}

/* --- pictures --- */

const conic_source_choice *conic_source_chosen(const conic_source *source) {
  return &source->choice;
}

/* Transparency needs surfaces that keep their opacities. */
static conic_status check_opacities(conic_source *source) {
  const unsigned abilities = source->scale.abilities;
  const char *fault = (abilities & CONIC_SOURCE_COMPOSITES && !conic_source_surfaces(source))
                          ? "a Gaussian scene is composited by its opacities already"
                      : abilities & CONIC_SOURCE_CLUSTERS ? "a hybrid keeps no opacities; draw what it was made of"
                                                          : NULL;
  return fault ? conic_fail(source->context, CONIC_ERROR_UNSUPPORTED, "%s: no transparency: %s", source->name, fault)
               : CONIC_OK;
}

static conic_status settle_picture(conic_source *source, const conic_camera *camera, const conic_render_options *render,
                                   const conic_source_view *view, conic_source_picture *picture) {
  picture->camera = *camera;
  picture->is_carried = source->is_moved && !source->kind->move;
  conic_render_options_init(&picture->render);
  conic_source_view_init(&source->view);
  if (!conic_options_take(&picture->render, render) || (view && !conic_options_take(&source->view, view)))
    return conic_fail(source->context, CONIC_ERROR_ARGUMENT, "source: the options were not initialised");
  conic_source_settle(source, &picture->render);
  if (picture->is_carried)
    conic_carried_look(source, &picture->camera, &picture->render, &picture->camera, &picture->render);
  return CONIC_OK;
}

conic_status conic_source_begin_picture(conic_source *source, const conic_camera *camera,
                                        const conic_render_options *render, const conic_source_view *view,
                                        conic_source_picture *picture) {
  conic_status status = settle_picture(source, camera, render, view, picture);
  return status == CONIC_OK && source->view.transparency ? check_opacities(source) : status;
}

conic_status conic_source_choose_settled(conic_source *source, const conic_camera *camera,
                                         const conic_render_options *render) {
  static const conic_splats no_splats;
  static const conic_triangles no_triangles;
  if (!source->kind->choose)
    return source->kind->draw ? conic_fail(source->context, CONIC_ERROR_UNSUPPORTED,
                                           "%s: it is drawn as it is read, and hands nothing over", source->name)
                              : CONIC_OK;
  source->choice = (conic_source_choice){.drawing = {&no_splats, &no_triangles}};
  return source->kind->choose(source, camera, render, &source->view);
}

conic_status conic_source_choose(conic_source *source, const conic_camera *camera, const conic_render_options *render,
                                 const conic_source_view *view) {
  conic_source_picture picture;
  conic_status status = settle_picture(source, camera, render, view, &picture);
  return status == CONIC_OK ? conic_source_choose_settled(source, &picture.camera, &picture.render) : status;
}

/* Draws for kinds that do not draw themselves. */
static conic_status draw_from_choice(conic_source *source, conic_renderer *renderer, conic_source_picture *picture,
                                     conic_image *image, conic_render_statistics *statistics) {
  const conic_source_kind *kind = source->kind;
  const conic_source_choice *choice = &source->choice;
  const conic_source_view *view = &source->view;
  double start = conic_seconds_now();
  conic_status status = conic_source_choose_settled(source, &picture->camera, &picture->render);
  int is_chosen = kind->choose && (!choice->is_all || choice->drawing.splats->dot);
  double ms = is_chosen ? 1e3 * (conic_seconds_now() - start) : 0.0;
  if (choice->is_all && !picture->render.splats_version)
    picture->render.splats_version = source->splats_version;
  if (status == CONIC_OK && view->transparency)
    status = conic_render_transparent(source->context, renderer, &choice->drawing, &picture->camera, &picture->render,
                                      view->transparency, view->chance, view->samples, image, statistics);
  else if (status == CONIC_OK)
    status = conic_render_drawing(source->context, renderer, &choice->drawing, &picture->camera, &picture->render,
                                  view->samples, image, statistics);
  if (status != CONIC_OK)
    return status;
  conic_source_name_image(source, image);
  if (statistics) {
    statistics->ms.lod = ms;
    statistics->ms.frame += ms;
  }
  return CONIC_OK;
}

conic_status conic_source_draw(conic_source *source, conic_renderer *renderer, const conic_camera *camera,
                               const conic_render_options *render, const conic_source_view *view, conic_image *image,
                               conic_render_statistics *statistics) {
  const conic_source_kind *kind = source->kind;
  conic_source_picture picture;
  conic_status status = conic_source_begin_picture(source, camera, render, view, &picture);
  if (status == CONIC_OK)
    status = kind->draw
                 ? kind->draw(source, renderer, &picture.camera, &picture.render, &source->view, image, statistics)
                 : draw_from_choice(source, renderer, &picture, image, statistics);
  if (status == CONIC_OK && picture.is_carried)
    conic_carried_turn(source, image);
  return status;
}

const char *conic_source_name_splat(const conic_source *source, uint32_t splat, uint32_t *number) {
  return source->kind->name_splat && !source->choice.is_all ? source->kind->name_splat(source, splat, number) : NULL;
}

size_t conic_source_input_of(const conic_source *source, uint32_t id) {
  return source->kind->input_of ? source->kind->input_of(source, id) : 0;
}

void conic_source_name_image(const conic_source *source, conic_image *image) {
  if (source->kind->name_image && !source->choice.is_all)
    source->kind->name_image(source, image);
}

/* --- statistics --- */

static conic_status begin_facts(conic_context *context, conic_facts **facts) {
  *facts = conic_memory_allocate_zeroed(context, 1, sizeof **facts);
  if (!*facts)
    return CONIC_ERROR_MEMORY;
  (*facts)->context = context;
  return CONIC_OK;
}

conic_status conic_source_describe(const conic_source *source, const conic_render_statistics *statistics,
                                   conic_facts **facts) {
  const conic_source_kind *kind = source->kind;
  const conic_source_choice *choice = &source->choice;
  conic_status status = begin_facts(source->context, facts);
  if (status != CONIC_OK)
    return status;
  CONIC_ADD_FACTS(*facts, CONIC_OBJECT("primitives"), CONIC_COUNT("splats", statistics->splats_drawn));
  if (statistics->triangles_in)
    CONIC_ADD_FACTS(*facts, CONIC_COUNT("triangles", statistics->triangles_drawn));
  if (kind->tell_primitives && !choice->is_all)
    kind->tell_primitives(source, *facts, &(*facts)->list[1].count);
  CONIC_ADD_FACTS(*facts, CONIC_END, CONIC_COUNT("clouds_culled", choice->n_culled));
  if ((kind->abilities & CONIC_SOURCE_CHOOSES || source->view.error_px > 0.0 || source->view.budget) && !choice->is_all)
    CONIC_ADD_FACTS(*facts, CONIC_NUMBER("error_px", choice->error_px));
  if (kind->abilities & CONIC_SOURCE_CLUSTERS && !choice->is_all)
    CONIC_ADD_FACTS(*facts, CONIC_NUMBER("color_error", choice->color_error));
  if (kind->tell_rest)
    kind->tell_rest(source, *facts);
  return CONIC_OK;
}

static conic_status inspect_as(conic_context *context, const conic_source_kind *kind, const char *path, int is_checked,
                               conic_facts *facts) {
  conic_source *source;
  conic_status status = conic_source_create(context, kind, path, &source);
  if (status != CONIC_OK)
    return status;
  CONIC_ADD_FACTS(facts,
                  conic_fact_text(CONIC_FACT_TEXT, "kind", "%s", kind->name_file ? kind->name_file(path) : kind->name));
  status = kind->tell_file(source, facts);
  if (status == CONIC_OK && is_checked) {
    CONIC_ADD_FACTS(facts, CONIC_OBJECT("defects"));
    status = kind->tell_defects(source, facts);
    CONIC_ADD_FACTS(facts, CONIC_END);
  }
  conic_source_close(source);
  return status;
}

conic_status conic_source_inspect(conic_context *context, const char *path, int is_checked, conic_facts **facts) {
  const conic_source_kind *kind = conic_source_kind_of_file(path);
  conic_status status = begin_facts(context, facts);
  if (status == CONIC_OK)
    status = kind                                     ? inspect_as(context, kind, path, is_checked, *facts)
             : conic_gaussians_is_file(context, path) ? conic_gaussians_inspect(context, path, is_checked, *facts)
                                                      : conic_model_inspect(context, path, is_checked, *facts);
  if (status == CONIC_OK)
    return CONIC_OK;
  conic_facts_destroy(*facts);
  *facts = NULL;
  return status;
}
