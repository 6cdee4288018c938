#include "source/top/top_view.h"

#include "core/splats/columns.h"
#include "raster/frame/statistics.h"
#include "source/source_kind.h"
#include "source/top/top_lift.h"

/* --- meshes --- */

/* Zero before the first use; the memory is kept for more of the same triangles. */
typedef struct top_mesh {
  conic_triangles triangles; /* its positions and corners are its own, everything else belongs to the lifted
                                triangles */
  uint32_t (*corners[3])[3]; /* of positions, normals and texture coordinates */
  uint32_t *material;
} top_mesh;

static void top_mesh_release(conic_context *context, top_mesh *mesh) {
  for (int i = 0; i < 3; i++)
    conic_memory_release_these(context, mesh->triangles.position[i], mesh->corners[i]);
  conic_memory_release(context, mesh->material);
  memset(mesh, 0, sizeof *mesh);
}

/* Makes room for all triangles, once. */
static conic_status begin_mesh(conic_context *context, const conic_triangles *from, top_mesh *mesh) {
  conic_triangles *to = &mesh->triangles;
  uint32_t(*const wanted[3])[3] = {from->corners, from->normal_corners, from->texture_corners};
  int is_whole = 1;
  if (mesh->corners[0])
    return CONIC_OK;
  *to = *from;
  memset(to->origin, 0, sizeof to->origin);
  to->strides.position = 0;
  to->cluster = NULL;
  for (int i = 0; i < 3; i++) {
    to->position[i] = conic_memory_allocate_zeroed(context, from->n_vertices, sizeof(float));
    mesh->corners[i] = wanted[i] ? conic_memory_allocate(context, from->count, sizeof **wanted) : NULL;
    is_whole &= to->position[i] && (mesh->corners[i] || !wanted[i]);
  }
  mesh->material = from->material ? conic_memory_allocate(context, from->count, sizeof *from->material) : NULL;
  to->corners = mesh->corners[0];
  to->normal_corners = mesh->corners[1];
  to->texture_corners = mesh->corners[2];
  to->material = mesh->material;
  return is_whole && (mesh->material || !from->material) ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static void place_vertex(const conic_top_place *place, const conic_triangles *from, size_t i, double p[3]) {
  for (int axis = 0; axis < 3; axis++)
    p[axis] = from->origin[axis] + (double)conic_column_at(from->position[axis], from->strides.position, i) -
              place->origin[axis];
}

/* Whether a triangle may show; triangles that are not finite do not. */
static int reaches_in(const conic_top_place *place, const double corner[3][3]) {
  const double low[3] = {place->low[0], place->low[1], place->heights[0] - place->origin[2]};
  const double high[3] = {place->high[0], place->high[1], place->heights[1] - place->origin[2]};
  for (int axis = 0; axis < 3; axis++) {
    const double a = corner[0][axis], b = corner[1][axis], c = corner[2][axis];
    if (!(a >= low[axis] || b >= low[axis] || c >= low[axis]) ||
        !(a <= high[axis] || b <= high[axis] || c <= high[axis]) || !(a + b + c - (a + b + c) == 0.0))
      return 0;
  }
  return 1;
}

static void lift_vertex(const conic_top_place *place, const double p[3], conic_triangles *to, size_t i) {
  double share = (place->distance - p[2]) / place->distance;
  to->position[0][i] = (float)(p[0] * share);
  to->position[1][i] = (float)(p[1] * share);
  to->position[2][i] = (float)p[2];
}

/* Fills the mesh with the triangles whose boxes reach into the place. Errors: MEMORY. */
static conic_status top_mesh_lift(conic_context *context, const conic_top_place *place, const conic_triangles *from,
                                  top_mesh *mesh) {
  conic_triangles *to = &mesh->triangles;
  conic_status status = begin_mesh(context, from, mesh);
  to->count = 0;
  for (size_t i = 0; i < from->count && status == CONIC_OK; i++) {
    double corner[3][3];
    for (int k = 0; k < 3; k++)
      place_vertex(place, from, from->corners[i][k], corner[k]);
    if (!reaches_in(place, (const double(*)[3])corner))
      continue;
    for (int k = 0; k < 3; k++)
      lift_vertex(place, corner[k], to, from->corners[i][k]);
    memcpy(to->corners[to->count], from->corners[i], sizeof *to->corners);
    if (to->normal_corners)
      memcpy(to->normal_corners[to->count], from->normal_corners[i], sizeof *to->corners);
    if (to->texture_corners)
      memcpy(to->texture_corners[to->count], from->texture_corners[i], sizeof *to->corners);
    if (to->material)
      to->material[to->count] = from->material[i];
    to->count++;
  }
  return status;
}

/* --- views --- */

enum { BLOCK = CONIC_TOP_BLOCK, LEAST_TILE = 8 };

struct conic_top_view {
  conic_source *source;
  conic_renderer *renderer;
  conic_context *context;
  conic_render_options render;
  double pixel, error, distance, top_z, heights[2];
  int samples;
  const conic_splats *splats;       /* all of the source's; null: it gathers splats */
  const conic_triangles *triangles; /* null: none */
  conic_top_bins bins;
  conic_top_set set;
  top_mesh mesh;
};

/* The current block. */
typedef struct top_block {
  conic_top_view *top;
  conic_top_place place;
  conic_camera camera;
  conic_image *image;
  conic_render_statistics *sum;
} top_block;

conic_status conic_source_georeference(const conic_source *source, conic_georeference *reference) {
  return source->kind->find_georeference ? source->kind->find_georeference(source, reference)
                                         : conic_georeference_read(source->context, source->name, reference);
}

/* The camera's height. At this height the normals, which lifting turns a little, turn by at most 1/256 at a block's
 * border, and floats still tell depths well apart. Within a large triangle, heights are off by the square of its height
 * over four times this. */
static double choose_distance(const conic_source_scale *scale, double pixel) {
  double relief = scale->maximum[2] - scale->minimum[2], across = 0.5 * BLOCK * pixel;
  return fmax((scale->n_triangles ? 512.0 : 64.0) * relief, 256.0 * across);
}

static conic_status take_source(conic_top_view *top) {
  const conic_source *source = top->source;
  if (source->kind->list_all) {
    const conic_drawing all = source->kind->list_all(source);
    top->splats = all.splats;
    top->triangles = all.triangles && all.triangles->count ? all.triangles : NULL;
    return conic_top_bins_make(
        top->context, top->splats, top->render.kernel.cutoff,
        fmax(BLOCK * top->pixel, 4.0 * (double)top->render.kernel.cutoff * source->scale.splat_length), &top->bins);
  }
  return source->kind->gather ? CONIC_OK
                              : conic_fail(top->context, CONIC_ERROR_UNSUPPORTED,
                                           "%s: from above, only points, splats and triangles are drawn", source->name);
}

conic_status conic_top_view_open(conic_source *source, conic_renderer *renderer, const conic_top_options *options,
                                 conic_top_view **top) {
  conic_context *context = source->context;
  conic_top_view *t = *top = NULL;
  if (!(options->pixel > 0.0) || !(options->pixel < 1e15) || options->samples < 1)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "a pixel of the ground has a size, and a sample");
  t = conic_memory_allocate_zeroed(context, 1, sizeof *t);
  if (!t)
    return CONIC_ERROR_MEMORY;
  t->source = source;
  t->renderer = renderer;
  t->context = context;
  t->pixel = options->pixel;
  t->error = options->error_px * options->pixel;
  t->samples = options->samples;
  memcpy(t->heights, options->heights, sizeof t->heights);
  t->distance = choose_distance(&source->scale, options->pixel);
  t->top_z = source->scale.maximum[2];
  conic_render_options_init(&t->render);
  conic_status status = conic_options_take(&t->render, options->render)
                            ? CONIC_OK
                            : conic_fail(context, CONIC_ERROR_ARGUMENT, "the options were not initialised");
  conic_source_settle(source, &t->render);
  t->render.near_z = 0.5 * t->distance;
  if (status == CONIC_OK)
    status = take_source(t);
  if (status == CONIC_OK)
    *top = t;
  else
    conic_top_view_close(t);
  return status;
}

void conic_top_view_close(conic_top_view *top) {
  if (!top)
    return;
  conic_top_bins_release(top->context, &top->bins);
  conic_top_set_release(top->context, &top->set);
  top_mesh_release(top->context, &top->mesh);
  conic_memory_release(top->context, top);
}

/* The camera looks straight down from above the block's middle, with y up in the picture: the world's axes after half a
 * turn about x. */
static void place_camera(top_block *b) {
  conic_camera *camera = &b->camera;
  memset(camera, 0, sizeof *camera);
  camera->width = camera->height = BLOCK;
  camera->fx = camera->fy = b->top->distance / b->top->pixel;
  camera->cx = camera->cy = 0.5 * BLOCK;
  camera->cam_from_world[0][0] = 1.0;
  camera->cam_from_world[1][1] = camera->cam_from_world[2][2] = -1.0;
  camera->cam_from_world[2][3] = b->top->distance;
}

/* How many pixels the filter adds around a splat, and one for rounding. */
static double filter_pixels(const conic_render_options *render) {
  return 1.5 * (double)render->kernel.cutoff * sqrt((double)render->prefilter) + 2.0;
}

/* The ground in a window, and how far around it splats may be wanted. */
static void place_window(top_block *b, const conic_window *window) {
  double pixel = b->top->pixel, margin = filter_pixels(&b->top->render) * pixel;
  b->place.low[0] = (window->x_begin - 0.5 * BLOCK) * pixel - margin;
  b->place.high[0] = (window->x_end - 0.5 * BLOCK) * pixel + margin;
  b->place.low[1] = (0.5 * BLOCK - window->y_end) * pixel - margin;
  b->place.high[1] = (0.5 * BLOCK - window->y_begin) * pixel + margin;
}

/* Lifts what shows in a window. *is_cut_short: there is more than may be gathered. */
static conic_status gather_top_block(top_block *b, int may_cut, int *is_cut_short) {
  conic_top_view *top = b->top;
  const conic_top_place *place = &b->place;
  conic_layers_region part;
  const conic_splats *splats = top->splats;
  conic_status status;
  size_t n;
  conic_layers_region_init(&part);
  for (int axis = 0; axis < 2; axis++) {
    part.low[axis] = place->origin[axis] + place->low[axis];
    part.high[axis] = place->origin[axis] + place->high[axis];
  }
  part.low[2] = top->heights[0];
  part.high[2] = top->heights[1];
  part.error = top->error;
  *is_cut_short = 0;
  if (splats) {
    status = conic_top_bins_find(top->context, &top->bins, part.low, part.high, &n);
    if (status == CONIC_OK)
      status = conic_top_lift(top->context, place, splats, top->bins.found, n, &top->set);
    return status == CONIC_OK && top->triangles ? top_mesh_lift(top->context, place, top->triangles, &top->mesh)
                                                : status;
  }
  status = top->source->kind->gather(top->source, &part, may_cut, &splats, is_cut_short);
  return status == CONIC_OK && !*is_cut_short
             ? conic_top_lift(top->context, place, splats, NULL, splats->count, &top->set)
             : status;
}

/* The picture's tile, or a smaller one that divides the window. */
static int tile_of(const conic_window *window, int tile) {
  while (tile > window->x_end - window->x_begin || tile > window->y_end - window->y_begin)
    tile /= 2;
  return tile;
}

static conic_status draw_lifted(top_block *b, const conic_window *window) {
  conic_top_view *top = b->top;
  conic_splats *splats = &top->set.splats;
  conic_render_options render = top->render;
  conic_render_statistics one;
  conic_status status = CONIC_OK;
  render.tile = tile_of(window, render.tile);
  const conic_drawing drawing = {splats, top->triangles ? &top->mesh.triangles : NULL};
  if (splats->count == 0 && top->mesh.triangles.count == 0 && !top->render.has_background)
    return CONIC_OK; /* the planes are zero already */
  if (splats->dot)
    status = conic_splats_face(top->context, splats, &b->camera, splats->tangent_u, splats->tangent_v);
  if (status == CONIC_OK && top->samples == 1 && !top->triangles && conic_renderer_has_parts(top->renderer))
    status =
        conic_render_part(top->renderer, splats, &b->camera, &render, &(conic_part){.window = *window}, b->image, &one);
  else if (status == CONIC_OK)
    status = conic_render_drawing(top->context, top->renderer, &drawing, &b->camera, &top->render, top->samples,
                                  b->image, &one);
  if (status == CONIC_OK)
    conic_statistics_add(&one, b->sum);
  return status;
}

/* Divides a window in two; returns 0 if it is too small. */
static int part_window(const conic_window *window, conic_window *first, conic_window *second) {
  int width = window->x_end - window->x_begin, height = window->y_end - window->y_begin;
  *first = *second = *window;
  if (width > LEAST_TILE && width >= height)
    first->x_end = second->x_begin = window->x_begin + width / 2;
  else if (height > LEAST_TILE)
    first->y_end = second->y_begin = window->y_begin + height / 2;
  else
    return 0;
  return 1;
}

/* Draws a window, in parts if memory does not hold its contents. */
static conic_status draw_top_window(top_block *b, const conic_window *window) {
  conic_top_view *top = b->top;
  conic_window first = *window, second = *window;
  int may_part = top->samples == 1 && conic_renderer_has_parts(top->renderer) && part_window(window, &first, &second);
  int is_cut_short;
  place_window(b, window);
  conic_status status = gather_top_block(b, may_part, &is_cut_short);
  if (status != CONIC_OK || !is_cut_short)
    return status == CONIC_OK ? draw_lifted(b, window) : status;
  status = draw_top_window(b, &first);
  return status == CONIC_OK ? draw_top_window(b, &second) : status;
}

/* Turns depths below the camera into heights. */
static void take_heights(const top_block *b) {
  float *z = b->image->planes[CONIC_PLANE_Z];
  for (size_t i = 0; z && i < (size_t)BLOCK * BLOCK; i++)
    z[i] = z[i] > 0.0f ? (float)(b->top->top_z + (b->top->distance - (double)z[i])) : NAN;
}

static void clear_planes(conic_image *image) {
  for (int i = 0; i < CONIC_MAX_PLANES; i++)
    if (image->planes[i])
      memset(image->planes[i], 0,
             (size_t)BLOCK * BLOCK * sizeof(float) * (size_t)conic_plane_describe((conic_plane)i)->n_channels);
}

conic_status conic_top_view_draw(conic_top_view *top, int64_t column, int64_t row, conic_image *image,
                                 conic_render_statistics *sum) {
  const conic_window all = {0, BLOCK, 0, BLOCK};
  top_block b = {.top = top, .image = image, .sum = sum};
  b.place.origin[0] = ((double)column + 0.5) * BLOCK * top->pixel;
  b.place.origin[1] = -((double)row + 0.5) * BLOCK * top->pixel;
  b.place.origin[2] = top->top_z;
  b.place.distance = top->distance;
  b.place.cutoff = top->render.kernel.cutoff;
  memcpy(b.place.heights, top->heights, sizeof b.place.heights);
  place_camera(&b);
  clear_planes(image);
  conic_status status = draw_top_window(&b, &all);
  take_heights(&b);
  return status;
}
