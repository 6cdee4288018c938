/* Splats and triangles in memory: from any number of files, or from a caller's arrays. */

#include "core/base/context_struct.h"
#include "core/base/loan_find.h"
#include "core/estimate/estimate.h"
#include "core/formats/model_read.h"
#include "core/splats/columns.h"
#include "core/splats/degrees.h"
#include "core/splats/near.h"
#include "core/splats/repairs_log.h"
#include "core/splats/splats_gather.h"
#include "lod/mesh/mesh.h"
#include "source/facing.h"
#include "source/input_places.h"
#include "source/lean_drawing.h"
#include "source/mesh_input.h"
#include "source/moved_drawing.h"
#include "source/reach.h"

typedef struct drawing_source {
  conic_source base;
  conic_splats splats;
  int is_lent;      /* the splats are a caller's … */
  float *unstrided; /* … except for copies, in here, of arrays with strides */
  conic_triangles triangles;
  conic_repairs repairs; /* the sum over all inputs */
  size_t *ends;          /* of each input: where its splats, triangles, vertices and normals end */
  size_t n_inputs;       /* the vertices and the normals */
  conic_facing facing;
  int has_moved;                   /* something has moved, so that there is room for: */
  conic_splats moved;              /* the splats in their present places, with places and axes of its own */
  conic_triangles moved_triangles; /* the triangles in their present places, with places and normals of its own */
  conic_lean_drawing lean;         /* for pictures with an error or a budget */
} drawing_source;

static int takes_drawing(const char *path, const conic_source_options *options) {
  (void)path, (void)options;
  return 1;
}

static conic_status append_to_drawing(drawing_source *d, conic_splats *more) {
  conic_status status = CONIC_OK;
  if (d->splats.count == 0) { /* the first input's arrays are taken over without a copy */
    conic_splats_release(d->base.context, &d->splats);
    d->splats = *more;
    memset(more, 0, sizeof *more);
  } else
    status = conic_splats_append(d->base.context, &d->splats, more);
  conic_splats_release(d->base.context, more);
  return status;
}

/* A model's faces become triangles. */
static conic_status take_triangles(drawing_source *d, const char *path, const conic_source_options *options,
                                   conic_model *model) {
  conic_context *context = d->base.context;
  conic_triangles triangles;
  conic_status status = conic_triangles_take(context, model, &triangles);
  if (status == CONIC_OK)
    status = conic_mesh_check(context, path, &triangles);
  if (!triangles.normal[0])
    d->base.traits |= CONIC_TRAIT_EDGES;
  if (status == CONIC_OK && !options->is_smooth)
    status = conic_mesh_round(context, 0, options->crease_deg, &triangles);
  if (status == CONIC_OK)
    status = conic_triangles_append(context, &d->triangles, &triangles);
  conic_triangles_release(context, &triangles);
  return status;
}

/* Turns ground in degrees into ground in metres, before distances between points matter. */
static void project_degrees(conic_context *context, const char *path, conic_splats *points) {
  double middle[2];
  if (points->tangent_u[0] || !conic_points_are_degrees(points))
    return;
  conic_points_take_metres(points, middle);
  conic_log(context, CONIC_LOG_WARNING,
            "%s: x and y are degrees of longitude and latitude: drawn in metres about %.6f, %.6f", path, middle[0],
            middle[1]);
}

static void add_repairs(conic_repairs *to, const conic_repairs *more) {
  to->nan += more->nan;
  to->zero += more->zero;
  to->duplicate += more->duplicate;
  to->isolated += more->isolated;
  to->failed += more->failed;
  to->clip += more->clip;
}

/* Takes every second point, third …, so that there are no more than `most`. */
static conic_status thin_points(conic_context *context, uint64_t most, conic_splats *points) {
  size_t stride = (size_t)((points->count + most - 1) / most), n = (points->count + stride - 1) / stride;
  uint32_t *kept = conic_memory_allocate(context, n, sizeof *kept);
  conic_splats some;
  if (!kept)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n; i++)
    kept[i] = (uint32_t)(i * stride);
  conic_status status = conic_splats_gather(context, points, kept, n, &some);
  conic_memory_release(context, kept);
  if (status != CONIC_OK)
    return status;
  conic_splats_release(context, points);
  *points = some;
  return CONIC_OK;
}

/* Gives the points axes where they have none. */
static conic_status take_points(drawing_source *d, const char *path, const conic_source_options *options,
                                conic_model *model) {
  conic_context *context = d->base.context;
  conic_estimate_options estimate;
  conic_repairs repairs;
  conic_estimate_options_init(&estimate);
  if (options->projects_degrees && model->n_triangles == 0)
    project_degrees(context, path, &model->points);
  if (!model->points.tangent_u[0] && !model->n_triangles)
    d->base.traits |= CONIC_TRAIT_RAW;
  d->base.scale.follows_cutoff |= !model->points.tangent_u[0] || model->follows_cutoff;
  estimate.cutoff = options->cutoff;
  estimate.n_neighbours = options->n_neighbours;
  estimate.finds_dots = options->finds_dots;
  estimate.stays_at_mesh = 1;
  if (model->n_triangles && !model->points.tangent_u[0])
    d->base.tolerance = conic_mesh_tolerance(d->base.context, &model->points);
  conic_status status = CONIC_OK;
  if (options->most_raw && model->points.count > options->most_raw && !model->points.tangent_u[0] &&
      !model->n_triangles)
    status = thin_points(context, options->most_raw, &model->points);
  if (status == CONIC_OK)
    status = conic_model_to_splats(context, &estimate, model, &repairs);
  if (status != CONIC_OK)
    return status;
  conic_repairs_log(context, path, &repairs);
  add_repairs(&d->repairs, &repairs);
  return append_to_drawing(d, &model->points);
}

/* As fits: the file's faces, and the points beside them. */
static conic_status take_as_fits(drawing_source *d, const char *path, const conic_source_options *options,
                                 conic_model *model) {
  conic_context *context = d->base.context;
  conic_model loose = {0};
  if (model->n_triangles &&
      !conic_has_face(model->points.position, (const uint32_t(*)[3])model->triangles, model->n_triangles)) {
    conic_log(context, CONIC_LOG_WARNING, "%s: no face has three finite corners at three places; the points are drawn",
              path);
    model->n_triangles = 0;
  }
  if (model->n_triangles == 0)
    return take_points(d, path, options, model);
  conic_status status = conic_mesh_gather_loose(context, model, &loose.points);
  if (status == CONIC_OK)
    status = take_triangles(d, path, options, model);
  if (status == CONIC_OK && loose.points.count)
    status = take_points(d, path, options, &loose);
  conic_model_release(context, &loose);
  return status;
}

/* `up` is the model's, where its file or its kind says so. */
static conic_status read_model(drawing_source *d, const char *path, const conic_source_options *options, double up[3]) {
  conic_context *context = d->base.context;
  conic_read_options reading;
  conic_model model;
  double low[3], high[3];
  conic_read_options_init(&reading);
  reading.cutoff = options->cutoff;
  reading.columns = options->columns;
  reading.keeps_faces = options->as == CONIC_AS_MESH || options->as == CONIC_AS_AUTO;
  conic_coloring_read(options->coloring, &reading);
  reading.where = options->where;
  reading.keeps_alpha = options->keeps_alpha;
  reading.colors_are = options->colors_are;
  conic_status status = conic_gaussians_read_model(context, path, &reading, &model);
  if (status != CONIC_OK)
    return status;
  double start = conic_seconds_now();
  d->base.traits |= (model.n_triangles ? CONIC_TRAIT_FACES : 0) |
                    (model.kind == CONIC_MODEL_XYZ ? CONIC_TRAIT_TEXT : 0) |
                    (conic_model_has_fractions(&model) ? CONIC_TRAIT_FRACTIONS : 0);
  memcpy(up, model.up, sizeof model.up);
  if (!model.points.count && options->where)
    status = conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot be drawn: no point passes --where", path);
  else
    status = conic_leave_far_points(context, path, &model.points, low, high);
  if (status == CONIC_OK && options->as == CONIC_AS_AUTO)
    status = take_as_fits(d, path, options, &model);
  else if (status == CONIC_OK && reading.keeps_faces && model.n_triangles)
    status = take_triangles(d, path, options, &model);
  else if (status == CONIC_OK)
    status = take_points(d, path, options, &model);
  conic_model_release(context, &model);
  d->base.scale.estimate_seconds += conic_seconds_now() - start;
  return status;
}

static conic_status read_into_drawing(drawing_source *d, const char *path, const conic_source_options *options,
                                      double up[3]) {
  const conic_source_kind *special = conic_source_kind_of_file(path);
  conic_source *part;
  conic_splats splats;
  if (!special || !special->take_splats)
    return read_model(d, path, options, up);
  d->base.traits |= CONIC_TRAIT_RAW; /* sizes may be estimated */
  conic_read_options reading;
  conic_read_options_init(&reading);
  conic_coloring_read(options->coloring, &reading);
  int keeps_values = special == &conic_source_kind_layers;
  if (reading.field && !reading.field_is_optional && !keeps_values)
    return conic_coloring_refuse(d->base.context, path, options);
  if (options->where && !keeps_values)
    return conic_fail(d->base.context, CONIC_ERROR_INPUT, "%s: points are chosen of files of points and of .lpc alone",
                      path);
  conic_status status = conic_source_open_kind(d->base.context, special, &path, 1, options, &part);
  if (status != CONIC_OK)
    return status;
  status = special->take_splats(part, &splats);
  d->base.scale.follows_cutoff |= part->scale.follows_cutoff;
  conic_source_close(part);
  return status == CONIC_OK ? append_to_drawing(d, &splats) : status;
}

/* Applies the options for triangles. */
static conic_status dress(drawing_source *d, const conic_source_options *options) {
  conic_context *context = d->base.context;
  conic_status status = CONIC_OK;
  if (options->as == CONIC_AS_MESH && d->triangles.count == 0)
    conic_log(context, CONIC_LOG_INFO, "%s: there are no faces to draw as a mesh; the points are drawn", d->base.name);
  if (d->triangles.count == 0 && options->texture_path)
    conic_log(context, CONIC_LOG_INFO, "%s: there are no faces for the texture to lie on", d->base.name);
  if (d->triangles.count == 0)
    return CONIC_OK;
  if (options->is_smooth)
    status = conic_triangles_smooth(context, &d->triangles);
  return status == CONIC_OK && options->texture_path
             ? conic_mesh_lay_texture(context, options->texture_path, &d->triangles)
             : status;
}

static conic_status choose_in_drawing(conic_source *source, const conic_camera *camera,
                                      const conic_render_options *render, const conic_source_view *view) {
  drawing_source *d = (drawing_source *)source;
  const conic_splats *splats = source->is_moved ? &d->moved : &d->splats;
  const conic_triangles *triangles = source->is_moved ? &d->moved_triangles : &d->triangles;
  conic_drawing all = {splats, triangles};
  conic_status status = conic_facing_turn(source->context, &d->facing, camera, &all.splats);
  source->choice.drawing = all;
  source->choice.is_all = 1;
  if (status != CONIC_OK || !(view->error_px > 0.0 || view->budget))
    return status;
  return conic_lean_choose(source, &all, splats, camera, render, &d->lean);
}

/* The range of all splats, vertices and normals that an input has. */
static conic_drawing_range range_of_input(const drawing_source *d, size_t i) {
  const size_t *vertices = d->ends + 2 * d->n_inputs,
               *normals = d->triangles.normal_corners ? vertices + d->n_inputs : vertices;
  int is_first = i == 0, has_normals = d->triangles.normal[0] != NULL;
  return (conic_drawing_range){{is_first ? 0 : d->ends[i - 1], d->ends[i]},
                               {is_first ? 0 : vertices[i - 1], vertices[i]},
                               {is_first || !has_normals ? 0 : normals[i - 1], has_normals ? normals[i] : 0}};
}

static conic_status check_pose_shapes(const drawing_source *d, const conic_source_pose *poses) {
  for (size_t i = 0; i < d->n_inputs; i++) {
    const conic_drawing_range range = range_of_input(d, i);
    for (int k = 0; k < 2; k++)
      if (poses[i].shapes[k] && (poses[i].shapes[k]->kind != &conic_source_kind_drawing ||
                                 !conic_moved_fits(&range, &poses[i].shapes[k]->choice.drawing)))
        return conic_fail(d->base.context, CONIC_ERROR_ARGUMENT,
                          "%s: as a shape of input %zu, it has another number of splats, corners or normals",
                          poses[i].shapes[k]->name, i);
  }
  return CONIC_OK;
}

static conic_status move_drawing(conic_source *source, const conic_source_pose *poses, size_t n_poses) {
  drawing_source *d = (drawing_source *)source;
  const conic_drawing rest = {&d->splats, &d->triangles}, moved = {&d->moved, &d->moved_triangles};
  int is_still = 1;
  conic_status status = CONIC_OK;
  if (poses && n_poses != d->n_inputs)
    return conic_fail(source->context, CONIC_ERROR_ARGUMENT, "%s: %zu poses for %zu inputs", source->name, n_poses,
                      d->n_inputs);
  for (size_t i = 0; poses && i < n_poses; i++)
    is_still &= conic_pose_is_at_rest(&poses[i]);
  if (poses)
    status = check_pose_shapes(d, poses);
  if (status == CONIC_OK && is_still && source->is_moved) /* what was kept of it belongs to another picture */
    source->splats_version = d->is_lent || d->facing.n_dots ? 0 : conic_context_next_version(source->context);
  if (status != CONIC_OK || is_still) {
    source->is_moved &= status != CONIC_OK;
    return status;
  }
  if (!d->has_moved)
    status = conic_moved_begin(source->context, &rest, &d->moved, &d->moved_triangles);
  d->has_moved = 1;
  if (status != CONIC_OK) {
    conic_moved_end(source->context, &d->moved, &d->moved_triangles);
    d->has_moved = 0;
    return status;
  }
  for (size_t i = 0; i < n_poses; i++) {
    const conic_drawing_range range = range_of_input(d, i);
    conic_moved_put(source->context, &rest, &range, conic_pose_is_at_rest(&poses[i]) ? NULL : &poses[i], &d->moved,
                    &d->moved_triangles);
  }
  source->is_moved = 1;
  source->splats_version = d->facing.n_dots ? 0 : conic_context_next_version(source->context);
  conic_drawing_bounds(&moved, source->moved_minimum, source->moved_maximum);
  return CONIC_OK;
}

/* Puts the inputs where they are to stand, for good. */
static conic_status place_inputs(drawing_source *d, const char *text) {
  conic_context *context = d->base.context;
  const conic_drawing rest = {&d->splats, &d->triangles};
  conic_place *places = text ? conic_memory_allocate(context, d->n_inputs, sizeof *places) : NULL;
  if (!text || !places)
    return text ? CONIC_ERROR_MEMORY : CONIC_OK;
  conic_status status = conic_places_read(context, text, d->n_inputs, places);
  if (status == CONIC_OK)
    status = conic_moved_begin(context, &rest, &d->moved, &d->moved_triangles);
  for (size_t i = 0; i < d->n_inputs && status == CONIC_OK; i++) {
    const conic_drawing_range range = range_of_input(d, i);
    conic_source_pose pose;
    conic_source_pose_init(&pose);
    memcpy(pose.world_from_rest, places[i].matrix, sizeof pose.world_from_rest);
    conic_moved_put(context, &rest, &range, places[i].is_moved ? &pose : NULL, &d->moved, &d->moved_triangles);
  }
  if (status == CONIC_OK)
    conic_moved_swap(&d->splats, &d->triangles, &d->moved, &d->moved_triangles);
  conic_moved_end(context, &d->moved, &d->moved_triangles);
  conic_memory_release(context, places);
  return status;
}

static conic_status measure_drawing(drawing_source *d) {
  conic_source_scale *scale = &d->base.scale;
  double start = conic_seconds_now();
  conic_source_choice *choice = &d->base.choice;
  choice->drawing = (conic_drawing){&d->splats, &d->triangles};
  choice->is_all = 1;
  conic_drawing_bounds_by(d->base.context, &choice->drawing, scale->minimum, scale->maximum);
  scale->near_z = conic_near_of_box(scale->minimum, scale->maximum);
  scale->n_splats = d->splats.count;
  scale->n_triangles = d->triangles.count;
  scale->has_colors = d->splats.color[0] || d->triangles.color[0] || d->triangles.n_materials;
  conic_status status =
      d->splats.count ? conic_splats_length(d->base.context, &d->splats, &scale->splat_length) : CONIC_OK;
  if (status == CONIC_OK)
    status = conic_facing_begin(d->base.context, &d->splats, &d->facing);
  if (!d->is_lent && !d->facing.n_dots)
    d->base.splats_version = conic_context_next_version(d->base.context);
  scale->estimate_seconds += conic_seconds_now() - start;
  return status;
}

/* Lent splats that need no repair are drawn where they are. */
static conic_status borrow_splats(drawing_source *d, const char *path, const conic_source_options *options) {
  conic_context *context = d->base.context;
  const conic_splats *lent = conic_loan_find(context, path, "splats");
  if (!lent || (options->coloring && (conic_coloring_is_asked(options) || !lent->color[0])))
    return CONIC_OK;
  conic_status status = conic_splats_enter(context, path, lent, &d->splats, &d->unstrided);
  if (status != CONIC_OK)
    return status;
  d->is_lent = conic_splats_need_no_repair(context, &d->splats);
  if (d->is_lent) {
    d->ends[0] = d->splats.count;
    return CONIC_OK;
  }
  conic_memory_release(context, d->unstrided);
  d->unstrided = NULL;
  memset(&d->splats, 0, sizeof d->splats);
  return CONIC_OK;
}

/* The arrays now end with this input. */
static void end_input(drawing_source *d, size_t i) {
  d->ends[i] = d->splats.count;
  d->ends[d->n_inputs + i] = d->triangles.count;
  d->ends[2 * d->n_inputs + i] = d->triangles.n_vertices;
  d->ends[3 * d->n_inputs + i] = conic_triangles_normals(&d->triangles);
}

static conic_status open_drawing(conic_source *source, const char *const *paths, size_t n_paths,
                                 const conic_source_options *options) {
  drawing_source *d = (drawing_source *)source;
  conic_source_scale *scale = &source->scale;
  double up[3] = {0.0, 0.0, 0.0};
  conic_status status = CONIC_OK;
  d->ends = conic_memory_allocate_zeroed(source->context, 4 * n_paths, sizeof *d->ends);
  if (!d->ends)
    return CONIC_ERROR_MEMORY;
  d->n_inputs = n_paths;
  if (options->cache) {
    d->lean.cache = conic_memory_copy_text(source->context, options->cache);
    if (!d->lean.cache)
      return CONIC_ERROR_MEMORY;
  }
  if (n_paths == 1 && !options->place)
    status = borrow_splats(d, paths[0], options);
  for (size_t i = 0; i < n_paths && status == CONIC_OK && !d->is_lent; i++) {
    double own[3] = {0.0, 0.0, 0.0};
    status = read_into_drawing(d, paths[i], options, own);
    end_input(d, i);
    for (int axis = 0; axis < 3; axis++) /* a direction that not all inputs state is unknown */
      up[axis] = i == 0 || up[axis] == own[axis] ? own[axis] : 0.0;
  }
  if (status == CONIC_OK)
    status = dress(d, options);
  if (status == CONIC_OK)
    status = place_inputs(d, options->place);
  if (up[0] != 0.0 || up[1] != 0.0 || up[2] != 0.0) {
    memcpy(scale->up, up, sizeof up);
    scale->up_basis = CONIC_UP_KIND;
  }
  if (status == CONIC_OK)
    status = conic_source_color(source, options, &d->splats, &d->triangles);
  if (status != CONIC_OK)
    return status;
  const conic_drawing all = {&d->splats, &d->triangles};
  source->traits |= conic_drawing_is_transparent(&all) ? CONIC_TRAIT_ALPHA : 0;
  source->no_traits = ~source->traits;
  return measure_drawing(d);
}

conic_status conic_source_of_drawing(conic_context *context, conic_splats *splats, conic_triangles *triangles,
                                     conic_source **source) {
  *source = NULL;
  conic_status status = conic_splats_check_own(context, "source", splats);
  if (status == CONIC_OK && triangles)
    status = conic_triangles_check_own(context, "source", triangles);
  if (status != CONIC_OK)
    return status;
  status = conic_source_create(context, &conic_source_kind_drawing, "drawing", source);
  if (status != CONIC_OK) {
    conic_splats_release(context, splats);
    if (triangles)
      conic_triangles_release(context, triangles);
    return status;
  }
  drawing_source *d = (drawing_source *)*source;
  d->splats = *splats;
  memset(splats, 0, sizeof *splats);
  if (triangles) {
    d->triangles = *triangles;
    memset(triangles, 0, sizeof *triangles);
  }
  d->ends = conic_memory_allocate(context, 4, sizeof *d->ends);
  if (!d->ends)
    return conic_source_finish(CONIC_ERROR_MEMORY, source);
  d->n_inputs = 1;
  end_input(d, 0);
  return conic_source_finish(measure_drawing(d), source);
}

static void release_column(void *data, size_t i) {
  drawing_source *d = data;
  conic_column columns[CONIC_SPLATS_COLUMNS];
  conic_splats_list_columns(&d->splats, columns);
  conic_memory_release(d->base.context, *columns[i].floats);
  *columns[i].floats = NULL;
}

/* The system takes 0.1 ms for each MiB that it gets back. */
static void release_splats(drawing_source *d) {
  enum { MANY = 1 << 20 };
  if (d->splats.count > MANY)
    conic_parallel_for(d->base.context, CONIC_SPLATS_COLUMNS, release_column, d);
  conic_splats_release(d->base.context, &d->splats);
}

static void close_drawing(conic_source *source) {
  drawing_source *d = (drawing_source *)source;
  conic_facing_end(source->context, &d->facing);
  if (d->has_moved)
    conic_moved_end(source->context, &d->moved, &d->moved_triangles);
  conic_lean_release(source->context, &d->lean);
  if (!d->is_lent)
    release_splats(d);
  conic_memory_release(source->context, d->unstrided);
  conic_triangles_release(source->context, &d->triangles);
  conic_memory_release(source->context, d->ends);
}

/* Inputs are appended in their order; the ids of triangles follow those of all splats. */
static size_t find_drawing_input(const conic_source *source, uint32_t id) {
  const drawing_source *d = (const drawing_source *)source;
  int is_triangle = id >= d->splats.count;
  size_t at = is_triangle ? id - d->splats.count : id, low = 0, high = d->n_inputs;
  const size_t *ends = d->ends + (is_triangle ? d->n_inputs : 0);
  while (low + 1 < high) {
    size_t middle = low + (high - low - 1) / 2;
    if (at < ends[middle])
      high = middle + 1;
    else
      low = middle + 1;
  }
  return low;
}

static conic_status find_drawing_spacing(conic_source *source, double *spacing) {
  return conic_splats_spacing(source->context, &((drawing_source *)source)->splats, spacing);
}

static conic_drawing list_drawing(const conic_source *source) {
  const drawing_source *d = (const drawing_source *)source;
  return (conic_drawing){&d->splats, &d->triangles};
}

void conic_facts_add_repairs(conic_facts *facts, const conic_repairs *repairs) {
  CONIC_ADD_FACTS(facts, CONIC_OBJECT("skipped"), CONIC_COUNT("nan", repairs->nan), CONIC_COUNT("zero", repairs->zero),
                  CONIC_COUNT("duplicate", repairs->duplicate), CONIC_COUNT("isolated", repairs->isolated),
                  CONIC_COUNT("failed", repairs->failed), CONIC_COUNT("clip", repairs->clip), CONIC_END);
}

static void tell_drawing_rest(const conic_source *source, conic_facts *facts) {
  const drawing_source *d = (const drawing_source *)source;
  if (d->facing.n_dots)
    CONIC_ADD_FACTS(facts, CONIC_COUNT("dots", d->facing.n_dots));
  conic_facts_add_repairs(facts, &d->repairs);
  if (source->view.error_px > 0.0 || source->view.budget)
    conic_lean_tell(&d->lean, &source->choice, facts);
}

static void name_drawing_image(const conic_source *source, conic_image *image) {
  conic_lean_name(&((const drawing_source *)source)->lean, &source->choice, image);
}

static const char *name_drawing_splat(const conic_source *source, uint32_t splat, uint32_t *number) {
  const drawing_source *d = (const drawing_source *)source;
  const size_t n_points = d->splats.count;
  const uint32_t id = source->choice.ids ? source->choice.ids[splat] : splat;
  *number = id < n_points ? id : id - (uint32_t)n_points;
  return id < n_points ? "point" : "node";
}

const conic_source_kind conic_source_kind_drawing = {
    .size = sizeof(drawing_source),
    .company = CONIC_SOURCE_MANY,
    .takes = takes_drawing,
    .open = open_drawing,
    .close = close_drawing,
    .find_spacing = find_drawing_spacing,
    .move = move_drawing,
    .choose = choose_in_drawing,
    .windowing = &conic_source_windowing_choice,
    .name_image = name_drawing_image,
    .name_splat = name_drawing_splat,
    .input_of = find_drawing_input,
    .tell_rest = tell_drawing_rest,
    .list_all = list_drawing,
};
