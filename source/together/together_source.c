/* Several inputs of which some are Gaussian scenes: these are one scene, and all others surfaces among it
 * (docs/reference/together.md). */
#include <string.h>

#include "core/base/loan_find.h"
#include "core/splats/near.h"
#include "gaussians/scene/gaussian_set.h"
#include "lod/blends/levels_read.h"
#include "source/moved_drawing.h"
#include "source/together/gaussians_source.h"

/* --- scenes --- */

/* Sets of one number of scales, and of one meaning of colours. */
static conic_status check_alike(conic_context *context, const conic_gaussians *first, const conic_gaussians *set,
                                const char *path) {
  int is_flat = !set->scale[2];
  if (is_flat == !first->scale[2] && set->is_linear == first->is_linear)
    return CONIC_OK;
  return conic_fail(context, CONIC_ERROR_INPUT,
                    "%s: 2D and 3D Gaussians, and scenes of linear and of display colours, are not drawn together",
                    path);
}

/* One scene after the other, measured from the first one's origin: as their files would be, put together. */
static conic_status join_scenes(conic_context *context, const conic_gaussians *sets, size_t n, conic_gaussians *all) {
  size_t count = 0, first = 0;
  int degree = 0;
  for (size_t i = 0; i < n; i++) {
    count += sets[i].count;
    degree = sets[i].sh_degree > degree ? sets[i].sh_degree : degree;
  }
  if (count > CONIC_MOST_GAUSSIANS)
    return conic_fail(context, CONIC_ERROR_INPUT, "the scenes have more than %d Gaussians together",
                      CONIC_MOST_GAUSSIANS);
  conic_status status =
      conic_gaussians_allocate(context, count, degree, conic_gaussians_fields(&sets[0]) & CONIC_GAUSSIANS_2D, all);
  if (status != CONIC_OK)
    return status;
  memcpy(all->origin, sets[0].origin, sizeof all->origin);
  memcpy(all->frame, sets[0].frame, sizeof all->frame);
  memcpy(all->up, sets[0].up, sizeof all->up);
  all->is_linear = sets[0].is_linear;
  for (size_t i = 0; i < n; first += sets[i++].count) {
    conic_gaussians_put(&sets[i], all, first);
    for (int axis = 0; axis < 3 && memcmp(sets[i].origin, all->origin, sizeof all->origin) != 0; axis++)
      for (size_t k = 0; k < sets[i].count; k++)
        all->position[axis][first + k] = (float)(conic_gaussians_mean(&sets[i], axis, k) - all->origin[axis]);
  }
  return CONIC_OK;
}

/* Reads a scene, or takes one that is lent under the name. */
static conic_status read_scene(conic_context *context, const char *path, conic_gaussians *gaussians, int *is_lent) {
  const conic_gaussians *lent = conic_loan_find(context, path, "gaussians");
  *is_lent = lent != NULL;
  if (!lent)
    return conic_levels_is_file(path) ? conic_levels_read(context, path, gaussians)
                                      : conic_gaussians_read(context, path, NULL, gaussians);
  conic_status status = conic_gaussians_check(context, lent, path);
  if (status == CONIC_OK)
    *gaussians = *lent;
  return status;
}

/* Puts a scene where it is to stand, in a frame whose letters say where x, y and z point; one that is lent is copied
 * for it. Errors: MEMORY, ARGUMENT (the frames mirror each other). */
static conic_status place_scene(conic_context *context, const conic_place *place, const char *frame,
                                conic_gaussians *set, int *is_lent) {
  const conic_gaussians given = *set;
  if (!place->is_moved && strcmp(given.frame, frame) == 0)
    return CONIC_OK;
  conic_status status = *is_lent ? join_scenes(context, &given, 1, set) : CONIC_OK;
  *is_lent = 0;
  if (status == CONIC_OK)
    status = conic_gaussians_turn(context, set, frame);
  if (status != CONIC_OK || !place->is_moved)
    return status;
  double up[3];
  conic_gaussians_find_up(set, up);
  for (int axis = 0; axis < 3; axis++) /* which its frame does not say any more */
    set->up[axis] = (float)up[axis];
  conic_gaussians_rotate(context, set, place->rotation);
  conic_gaussians_shift(set, place->scale, place->shift);
  return CONIC_OK;
}

static conic_status choose_levels_among(conic_source *source, const conic_camera *camera);

/* The sets of the inputs that are scenes, as one list; those of levels are handed over. */
static conic_status join_inputs(conic_gaussians_source *g, conic_gaussians *all) {
  conic_gaussians *sets = conic_memory_allocate(g->base.context, g->n_inputs, sizeof *sets);
  conic_among_input *one = NULL; /* in levels, and the last */
  size_t n = 0, count = 0;
  conic_status status = CONIC_OK;
  if (!sets)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < g->n_inputs; i++) {
    if (!g->inputs[i].is_gaussian)
      continue;
    g->inputs[i].first_id = (uint32_t)count;
    count += g->inputs[i].set.count;
    sets[n++] = g->inputs[i].set;
    one = g->inputs[i].levels ? &g->inputs[i] : NULL;
  }
  if (n == 1 && one) { /* large scenes are not copied */
    *all = one->set;
    memset(&one->set, 0, sizeof one->set);
  } else
    status = join_scenes(g->base.context, sets, n, all);
  for (size_t i = 0; i < g->n_inputs; i++)
    if (g->inputs[i].levels)
      conic_gaussians_release(g->base.context, &g->inputs[i].set);
  conic_memory_release(g->base.context, sets);
  return status;
}

static const conic_among_input *first_scene(const conic_gaussians_source *g) {
  const conic_among_input *first = g->inputs;
  while (!first->is_gaussian)
    first++;
  return first;
}

/* The frame of all scenes, which is the first one's. */
static const char *frame_of_all(const conic_gaussians_source *g) {
  const conic_among_input *first = first_scene(g);
  return first->levels ? first->levels->header.frame : first->set.frame;
}

/* Puts what was chosen of a scene in levels where it stands. */
static conic_status put_scene(conic_gaussians_source *g, conic_among_input *input, const conic_levels_scene *scene) {
  conic_gaussians_release(g->base.context, &input->set);
  input->set = scene->set;
  input->cut = scene->cut;
  return place_scene(g->base.context, &input->place, frame_of_all(g), &input->set, &input->is_lent);
}

static conic_status open_input(conic_gaussians_source *g, conic_among_input *input, const char *path,
                               const conic_source_options *options) {
  conic_context *context = g->base.context;
  if (!conic_levels_is_file(path) || conic_loan_find(context, path, "gaussians")) {
    conic_status status = read_scene(context, path, &input->set, &input->is_lent);
    return status == CONIC_OK ? place_scene(context, &input->place, frame_of_all(g), &input->set, &input->is_lent)
                              : status;
  }
  conic_status status = conic_levels_open(context, path, options->access, &input->levels);
  if (status != CONIC_OK)
    return status;
  const conic_levels_wish wish = {.part = options->is_whole || input->levels->header.n <= CONIC_LEVELS_MOST_WHOLE
                                              ? CONIC_LEVELS_ALL
                                              : CONIC_LEVELS_ROOT};
  conic_levels_scene scene = {.levels = input->levels};
  g->base.choice.is_all &= wish.part == CONIC_LEVELS_ALL;
  status = conic_levels_choose(&scene, 1, &wish);
  return status == CONIC_OK ? put_scene(g, input, &scene) : status;
}

static void release_sets(conic_gaussians_source *g) {
  for (size_t i = 0; i < g->n_inputs; i++)
    if (!g->inputs[i].is_lent)
      conic_gaussians_release(g->base.context, &g->inputs[i].set);
}

/* Reads the inputs that are scenes. */
static conic_status read_scenes(conic_gaussians_source *g, const char *const *paths,
                                const conic_source_options *options) {
  conic_context *context = g->base.context;
  conic_status status = CONIC_OK;
  int has_levels = 0;
  g->base.choice.is_all = 1;
  for (size_t i = 0; i < g->n_inputs && status == CONIC_OK; i++) {
    if (!g->inputs[i].is_gaussian)
      continue;
    status = open_input(g, &g->inputs[i], paths[i], options);
    if (status == CONIC_OK)
      status = check_alike(context, &first_scene(g)->set, &g->inputs[i].set, paths[i]);
    has_levels |= g->inputs[i].levels != NULL;
  }
  if (status == CONIC_OK)
    status = join_inputs(g, &g->gaussians);
  if (!has_levels)
    release_sets(g);
  g->choose = has_levels ? choose_levels_among : NULL;
  return status;
}

/* --- surfaces --- */

/* Opens the other inputs as one source. */
static conic_status open_surfaces(conic_gaussians_source *g, const char *const *paths,
                                  const conic_source_options *options) {
  conic_context *context = g->base.context;
  const char **others = conic_memory_allocate_zeroed(context, g->n_inputs, sizeof *others);
  int *is_other = conic_memory_allocate_zeroed(context, g->n_inputs, sizeof *is_other);
  conic_source_options own = *options;
  conic_status status = others && is_other ? CONIC_OK : CONIC_ERROR_MEMORY;
  size_t n = 0;
  char *place = NULL;
  own.gaussians = NULL;
  for (size_t i = 0; status == CONIC_OK && i < g->n_inputs; i++)
    if (!g->inputs[i].is_gaussian) {
      g->inputs[i].first_id = (uint32_t)n;
      is_other[i] = 1;
      others[n++] = paths[i];
    }
  if (status == CONIC_OK)
    status = conic_places_part(context, options->place, is_other, g->n_inputs, &place);
  own.place = place;
  if (status == CONIC_OK && n > 0)
    status = conic_source_open(context, others, n, &own, &g->surfaces);
  conic_memory_release_these(context, (void *)others, is_other, place);
  return status;
}

/* The scale of both: the first input says which way is up. */
static void join_scales(conic_gaussians_source *g) {
  conic_source_scale *scale = &g->base.scale;
  const conic_source_scale *other = conic_source_measure(g->surfaces);
  for (int axis = 0; axis < 3; axis++) {
    scale->minimum[axis] = fmin(scale->minimum[axis], other->minimum[axis]);
    scale->maximum[axis] = fmax(scale->maximum[axis], other->maximum[axis]);
  }
  if (!g->inputs[0].is_gaussian) {
    memcpy(scale->up, other->up, sizeof scale->up);
    scale->up_basis = other->up_basis;
  }
  scale->near_z = conic_near_of_box(scale->minimum, scale->maximum);
  scale->splat_length = other->splat_length;
  scale->epsilon = other->epsilon;
  scale->spacing = other->spacing;
  scale->n_splats += other->n_splats;
  scale->n_triangles = other->n_triangles;
  scale->follows_cutoff = other->follows_cutoff;
  scale->estimate_seconds = other->estimate_seconds;
  g->base.traits = g->surfaces->traits;
  g->base.no_traits = g->surfaces->no_traits;
  g->base.coloring = g->surfaces->coloring;
}

conic_status conic_together_open(conic_source *source, const char *const *paths, size_t n_paths,
                                 const conic_source_options *options) {
  conic_gaussians_source *g = (conic_gaussians_source *)source;
  g->options = *options->gaussians;
  g->n_inputs = n_paths;
  g->inputs = conic_memory_allocate_zeroed(source->context, n_paths, sizeof *g->inputs);
  if (!g->inputs)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n_paths; i++)
    g->inputs[i].is_gaussian = conic_gaussians_source_takes(paths[i], options);
  conic_place *places = conic_memory_allocate(source->context, n_paths, sizeof *places);
  conic_status status =
      places ? conic_places_read(source->context, options->place, n_paths, places) : CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n_paths && status == CONIC_OK; i++)
    g->inputs[i].place = places[i];
  conic_memory_release(source->context, places);
  if (status == CONIC_OK)
    status = read_scenes(g, paths, options);
  if (status == CONIC_OK)
    status = conic_gaussians_source_measure(g);
  if (status == CONIC_OK)
    status = open_surfaces(g, paths, options);
  if (status == CONIC_OK && g->surfaces)
    join_scales(g);
  return status;
}

/* The last input whose Gaussians begin before the id has it; ids behind all Gaussians are the surfaces'. */
static size_t find_input(const conic_source *source, uint32_t id) {
  const conic_gaussians_source *g = (const conic_gaussians_source *)source;
  const int is_gaussian = !g->surfaces || id < g->gaussians.count;
  const size_t number = is_gaussian ? 0 : conic_source_input_of(g->surfaces, id - (uint32_t)g->gaussians.count);
  size_t found = 0;
  for (size_t i = 0; i < g->n_inputs; i++)
    if (g->inputs[i].is_gaussian == is_gaussian && g->inputs[i].first_id <= (is_gaussian ? id : number))
      found = i;
  return found;
}

static conic_status open_scene(conic_source *source, const char *const *paths, size_t n_paths,
                               const conic_source_options *options) {
  conic_gaussians_source *g = (conic_gaussians_source *)source;
  conic_place place;
  g->options = *options->gaussians;
  conic_status status = conic_places_read(source->context, options->place, n_paths, &place);
  if (status == CONIC_OK)
    status = read_scene(source->context, paths[0], &g->gaussians, &g->is_lent);
  if (status == CONIC_OK)
    status = place_scene(source->context, &place, g->gaussians.frame, &g->gaussians, &g->is_lent);
  return status == CONIC_OK ? conic_gaussians_source_measure(g) : status;
}

/* --- levels --- */

/* The camera as the file of an input sees it; lengths there may be others, and pixels are not. */
static conic_camera camera_of(const conic_gaussians_source *g, const conic_among_input *input,
                              const conic_camera *camera) {
  conic_camera own = *camera;
  const conic_place *place = &input->place;
  double turn[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  const double scale = place->is_moved ? place->scale : 1.0;
  conic_gaussians_find_turn(input->levels->header.frame, frame_of_all(g), turn);
  for (int row = 0; row < 3; row++) {
    const double *from = camera->cam_from_world[row];
    double placed[3] = {from[0], from[1], from[2]}, shift = from[3];
    for (int axis = 0; axis < 3 && place->is_moved; axis++) {
      placed[axis] =
          from[0] * place->rotation[0][axis] + from[1] * place->rotation[1][axis] + from[2] * place->rotation[2][axis];
      shift += from[axis] * place->shift[axis];
    }
    for (int axis = 0; axis < 3; axis++)
      own.cam_from_world[row][axis] = placed[0] * turn[0][axis] + placed[1] * turn[1][axis] + placed[2] * turn[2][axis];
    own.cam_from_world[row][3] = shift / scale;
  }
  return own;
}

/* What scenes without levels leave of a budget. */
static conic_status share_budget(const conic_gaussians_source *g, uint64_t *budget) {
  uint64_t others = 0;
  for (size_t i = 0; i < g->n_inputs; i++)
    others += g->inputs[i].levels ? 0 : g->inputs[i].set.count;
  if (*budget && others >= *budget)
    return conic_fail(g->base.context, CONIC_ERROR_INPUT,
                      "%s: the scenes without levels have %llu Gaussians, and the budget is %llu", g->base.name,
                      (unsigned long long)others, (unsigned long long)*budget);
  *budget -= *budget ? others : 0;
  return CONIC_OK;
}

/* Takes of the scenes in levels what is wished, and makes one list of all scenes. */
static conic_status take_scenes(conic_gaussians_source *g, conic_levels_scene *scenes, size_t n,
                                const conic_levels_wish *wish, conic_gaussians *all) {
  conic_status status = conic_levels_choose(scenes, n, wish);
  for (size_t i = 0, k = 0; i < g->n_inputs; i++) {
    if (!g->inputs[i].levels)
      continue;
    if (status == CONIC_OK)
      status = put_scene(g, &g->inputs[i], &scenes[k]);
    else
      conic_gaussians_release(g->base.context, &scenes[k].set);
    memset(&scenes[k++].set, 0, sizeof scenes->set);
  }
  return status == CONIC_OK ? join_inputs(g, all) : status;
}

/* Takes what a picture shows. Of pinholes a small picture of less says first what is hidden. */
static conic_status take_seen(conic_gaussians_source *g, const conic_camera *camera, conic_levels_wish *wish,
                              conic_levels_scene *scenes, size_t n) {
  conic_context *context = g->base.context;
  conic_levels_veil veil = {.depths = NULL};
  conic_status status = CONIC_OK;
  uint64_t n_all = 0;
  for (size_t i = 0; i < n; i++)
    n_all += scenes[i].levels->header.n;
  const int is_all = wish->error == 0.0 && !wish->budget && n_all <= conic_levels_most(scenes, n);
  conic_gaussians_release(context, &g->gaussians);
  if (!is_all && camera->kind == CONIC_CAMERA_PERSPECTIVE && camera->lens == CONIC_LENS_NONE) {
    const conic_levels_wish coarse = conic_levels_coarser(wish, scenes, n, &g->options);
    status = take_scenes(g, scenes, n, &coarse, &g->gaussians);
    if (status == CONIC_OK)
      status = conic_levels_find_veil(context, &g->gaussians, camera, &g->options, &veil);
    conic_gaussians_release(context, &g->gaussians);
  }
  wish->veil = veil.depths ? &veil : NULL;
  if (status == CONIC_OK)
    status = take_scenes(g, scenes, n, wish, &g->gaussians);
  conic_memory_release(context, veil.depths);
  return status;
}

static conic_status choose_levels_among(conic_source *source, const conic_camera *camera) {
  conic_gaussians_source *g = (conic_gaussians_source *)source;
  conic_levels_wish wish = conic_gaussians_source_wish(g);
  size_t n = 0;
  if (source->choice.is_all && wish.error == 0.0 && !wish.budget)
    return CONIC_OK;
  if (g->rest.count)
    return conic_fail(source->context, CONIC_ERROR_UNSUPPORTED, "%s: what moves is drawn whole: not by an error",
                      source->name);
  conic_levels_scene *scenes = conic_memory_allocate_zeroed(source->context, g->n_inputs, sizeof *scenes);
  for (size_t i = 0; i < g->n_inputs && scenes; i++) {
    const conic_among_input *input = &g->inputs[i];
    if (input->levels)
      scenes[n++] = (conic_levels_scene){.levels = input->levels,
                                         .camera = camera_of(g, input, camera),
                                         .unit = input->place.is_moved ? input->place.scale : 1.0};
  }
  conic_status status = scenes ? share_budget(g, &wish.budget) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = take_seen(g, camera, &wish, scenes, n);
  if (status == CONIC_OK) {
    const conic_levels_cut *cut = &scenes->cut; /* its error is that of all */
    source->choice = (conic_source_choice){.error_px = cut->error, .is_all = cut->is_all};
    if (cut->is_short && wish.error == 0.0) /* else the program says so */
      conic_log(source->context, CONIC_LOG_WARNING,
                "%s: drawn by an error of %.3g, as no more than %llu Gaussians fit into the memory that it may take",
                source->name, cut->error, (unsigned long long)conic_levels_most(scenes, n));
  }
  conic_memory_release(source->context, scenes);
  return status;
}

/* --- what moves --- */

/* Moves a scene as the pose of input i says. */
static conic_status pose_scene(conic_gaussians_source *g, size_t i, const conic_source_pose *pose, conic_gaussians *set,
                               int *is_lent) {
  conic_context *context = g->base.context;
  conic_place place = {.is_moved = 0};
  if (pose->shapes[0] || pose->shapes[1])
    return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "%s: the Gaussians of input %zu have one shape", g->base.name,
                      i);
  memcpy(place.matrix, pose->world_from_rest, sizeof place.matrix);
  const char *fault = conic_pose_is_at_rest(pose) ? NULL : conic_place_find_parts(&place);
  return fault ? conic_fail(context, CONIC_ERROR_UNSUPPORTED, "%s: input %zu: %s", g->base.name, i, fault)
               : place_scene(context, &place, set->frame, set, is_lent);
}

/* The Gaussians of input i, which stay those of all. */
static conic_gaussians scene_of(const conic_gaussians_source *g, const conic_gaussians *all, size_t i) {
  const size_t first = g->inputs[i].first_id, n_harmonics = first * conic_harmonics_of_degree(all->sh_degree);
  conic_gaussians set = *all;
  float **columns[CONIC_MOST_GAUSSIAN_COLUMNS];
  size_t end = all->count;
  for (size_t k = g->n_inputs; k-- > i + 1;)
    end = g->inputs[k].is_gaussian ? g->inputs[k].first_id : end;
  for (int c = conic_gaussians_list_columns(&set, columns) - 1; c >= 0; c--)
    *columns[c] += first;
  set.sh = all->sh ? all->sh + n_harmonics : NULL;
  set.sh_half = all->sh_half ? all->sh_half + n_harmonics : NULL;
  set.count = end - first;
  return set;
}

/* All scenes in one list, each where its pose has it. */
static conic_status pose_scenes(conic_gaussians_source *g, const conic_source_pose *poses, conic_gaussians *moved) {
  conic_context *context = g->base.context;
  const conic_gaussians *rest = g->rest.count ? &g->rest : &g->gaussians;
  conic_gaussians *sets = conic_memory_allocate_zeroed(context, g->n_inputs, sizeof *sets);
  int *are_lent = conic_memory_allocate_zeroed(context, g->n_inputs, sizeof *are_lent);
  conic_status status = sets && are_lent ? CONIC_OK : CONIC_ERROR_MEMORY;
  size_t n = 0;
  for (size_t i = 0; i < g->n_inputs && status == CONIC_OK; i++) {
    if (!g->inputs[i].is_gaussian)
      continue;
    sets[n] = scene_of(g, rest, i);
    are_lent[n] = 1;
    status = pose_scene(g, i, &poses[i], &sets[n], &are_lent[n]);
    n++;
  }
  if (status == CONIC_OK)
    status = join_scenes(context, sets, n, moved);
  for (size_t i = 0; i < n; i++)
    if (!are_lent[i])
      conic_gaussians_release(context, &sets[i]);
  conic_memory_release_these(context, sets, are_lent);
  return status;
}

/* Moves the surfaces by the poses that are of them; null: they rest. */
static conic_status pose_surfaces(conic_gaussians_source *g, const conic_source_pose *poses) {
  conic_context *context = g->base.context;
  conic_source_pose *own = poses ? conic_memory_allocate(context, g->n_inputs, sizeof *own) : NULL;
  size_t n = 0;
  if (poses && !own)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; own && i < g->n_inputs; i++)
    if (!g->inputs[i].is_gaussian)
      own[n++] = poses[i];
  conic_status status = conic_source_move(g->surfaces, own, n);
  conic_memory_release(context, own);
  return status;
}

static void join_boxes(conic_gaussians_source *g) {
  conic_source *source = &g->base;
  double minimum[3], maximum[3];
  conic_gaussians_bounds(&g->gaussians, source->moved_minimum, source->moved_maximum);
  if (!g->surfaces)
    return;
  conic_source_box(g->surfaces, minimum, maximum);
  for (int axis = 0; axis < 3; axis++) {
    source->moved_minimum[axis] = fmin(source->moved_minimum[axis], minimum[axis]);
    source->moved_maximum[axis] = fmax(source->moved_maximum[axis], maximum[axis]);
  }
}

static conic_status move_together(conic_source *source, const conic_source_pose *poses, size_t n_poses) {
  conic_gaussians_source *g = (conic_gaussians_source *)source;
  conic_gaussians moved = {.count = 0};
  int is_still = 1;
  if (poses && n_poses != g->n_inputs)
    return conic_fail(source->context, CONIC_ERROR_ARGUMENT, "%s: %zu poses for %zu inputs", source->name, n_poses,
                      g->n_inputs);
  for (size_t i = 0; poses && i < n_poses; i++)
    is_still &= !g->inputs[i].is_gaussian || conic_pose_is_at_rest(&poses[i]);
  conic_status status = is_still ? CONIC_OK : pose_scenes(g, poses, &moved);
  if (status == CONIC_OK && g->surfaces)
    status = pose_surfaces(g, poses);
  if (status != CONIC_OK) {
    conic_gaussians_release(source->context, &moved);
    return status;
  }
  if (g->rest.count || !is_still) { /* the set in use is one that moved, or it becomes the one at rest */
    if (g->rest.count)
      conic_gaussians_release(source->context, &g->gaussians);
    else
      g->rest = g->gaussians;
    g->gaussians = is_still ? g->rest : moved;
    if (is_still)
      memset(&g->rest, 0, sizeof g->rest);
  }
  source->is_moved = !is_still || (g->surfaces && g->surfaces->is_moved);
  join_boxes(g);
  return CONIC_OK;
}

#define KIND_OF_GAUSSIANS(its_abilities, its_company, its_open, its_input_of, its_move, its_wants)                     \
  {                                                                                                                    \
    .size = sizeof(conic_gaussians_source), .abilities = CONIC_SOURCE_COMPOSITES | (its_abilities),                    \
    .company = (its_company), .takes = conic_gaussians_source_takes, .wants = (its_wants), .open = (its_open),         \
    .close = conic_gaussians_source_close, .draw = conic_gaussians_source_draw,                                        \
    .windowing = &conic_gaussians_windowing, .input_of = (its_input_of), .move = (its_move),                           \
    .tell_rest = conic_gaussians_source_tell                                                                           \
  }
#define KIND_OF_MANY(its_abilities, its_company, its_wants)                                                            \
  KIND_OF_GAUSSIANS(its_abilities, its_company, conic_together_open, find_input, move_together, its_wants)

const conic_source_kind conic_source_kind_gaussians =
                            KIND_OF_GAUSSIANS(0, CONIC_SOURCE_SINGLE, open_scene, NULL, NULL, NULL),
                        conic_source_kind_scenes = KIND_OF_MANY(0, CONIC_SOURCE_ALIKE, NULL),
                        conic_source_kind_level_scenes =
                            KIND_OF_MANY(CONIC_SOURCE_CHOOSES, CONIC_SOURCE_ALIKE, conic_levels_is_file),
                        conic_source_kind_together = KIND_OF_MANY(CONIC_SOURCE_MIXES, CONIC_SOURCE_MANY, NULL),
                        conic_source_kind_level_together = KIND_OF_MANY(CONIC_SOURCE_MIXES | CONIC_SOURCE_CHOOSES,
                                                                        CONIC_SOURCE_MANY, conic_levels_is_file);
