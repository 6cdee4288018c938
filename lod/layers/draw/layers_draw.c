#include "conic/layers_draw.h"

#include <math.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/options.h"
#include "core/image/image_common.h"
#include "core/image/view_arguments.h"
#include "lod/layers/draw/layers_bands.h"
#include "lod/layers/draw/layers_hidden.h"
#include "lod/layers/draw/layers_octree.h"

/* Where fewer surfaces than this lie behind each other, finding out what is hidden takes longer than drawing it. */
static const double deep = 4.0;

typedef struct layers_drawing {
  conic_layers *layers;
  const conic_camera *camera;
  conic_render_options render; /* near_z and splat_length given */
  const conic_layers_draw_options *options;
  conic_layers_view view;
  conic_layers_cut cut;
  conic_layers_set *set; /* the layers', so that its memory is kept from picture to picture */
  unsigned char *needed; /* a cloud */
  uint32_t *held;        /* clouds that are kept until the picture is drawn */
  conic_layers_loading holding;
  uint64_t pages_damaged; /* of an octree's hierarchy */
  conic_layers_drawn drawn;
  uint64_t n_root; /* as in a cut */
  conic_transparency transparency;
} layers_drawing;

void conic_layers_draw_options_init_sized(conic_layers_draw_options *options, size_t size) {
  static const conic_layers_draw_options own = {.size = sizeof own, .samples = 1};
  conic_options_give(options, size, &own);
}

static const char *what_of_draw_is_wrong(const conic_camera *camera, const conic_render_options *render,
                                         const conic_layers_draw_options *options, const conic_image *image) {
  if (!image || image->width != camera->width || image->height != camera->height)
    return "the image and the camera differ in size";
  if (!(options->error_px >= 0.0) || (options->error_px > 0.0 && options->budget))
    return "the error must not be below 0, nor stand beside a budget";
  if (options->samples < 1 || options->samples > CONIC_MAX_SAMPLES ||
      camera->width > CONIC_IMAGE_MAX_SIZE / options->samples ||
      camera->height > CONIC_IMAGE_MAX_SIZE / options->samples)
    return "there are too few or too many samples a pixel";
  if (render->tile < 8 || render->tile > 64)
    return "the tile is 8, 16, 32 or 64";
  return NULL;
}

static conic_status choose_clouds(layers_drawing *d, const unsigned char *is_in) {
  conic_layers_wish wish = {
      .error_px = d->drawn.error_px, .most_levels = d->options->most_levels, .is_in = is_in, .n_root = d->n_root};
  return conic_layers_find_cut(d->layers, &d->view, &wish, &d->cut);
}

static conic_status choose_first(layers_drawing *d) {
  d->drawn.error_px = d->options->error_px;
  if (d->options->budget)
    d->n_root =
        conic_layers_fit_budget(d->layers, &d->view, d->options->most_levels, d->options->budget, &d->drawn.error_px);
  return choose_clouds(d, NULL);
}

/* Reads what the cut needs, as far as there is time and room, and makes it coarser where something is missing. */
static conic_status make_do(layers_drawing *d, double until_s) {
  conic_layers *layers = d->layers;
  size_t n = 0;
  conic_layers_needed(layers, &d->cut, CONIC_PLACE_SHOWN, d->needed);
  for (uint32_t i = 0; i < layers->header.n_clouds; i++)
    if (d->needed[i])
      d->held[n++] = i;
  if (n == 0)
    return CONIC_OK;
  d->holding = (conic_layers_loading){
      .clouds = d->held, .until_s = until_s, .may_miss = 1, .tolerates_damage = d->options->tolerates_damage};
  d->holding.n = conic_layers_store_fit(layers, d->held, n, conic_layers_cache_bytes(layers));
  conic_status status = conic_layers_store_load(layers, &d->holding);
  if (status != CONIC_OK) {
    d->holding.n = 0;
    return status;
  }
  d->drawn.n_clouds_damaged = d->holding.n_damaged + d->pages_damaged;
  if (!conic_layers_has_cloud(layers, 0))
    return conic_fail(layers->context, d->holding.n_damaged > 0 ? CONIC_ERROR_INPUT : CONIC_ERROR_IO,
                      "%s: not even the coarsest cloud could be read%s", layers->name,
                      d->options->seconds > 0.0 ? " in time" : "");
  for (uint32_t i = 0; i < layers->header.n_clouds; i++) {
    int is_in = conic_layers_has_cloud(layers, i) && !conic_layers_octree_is_page(layers, i);
    d->drawn.n_clouds_missing += d->needed[i] && !is_in;
    d->needed[i] = (unsigned char)(is_in || (!d->needed[i] && !conic_layers_octree_is_page(layers, i)));
  }
  return choose_clouds(d, d->needed);
}

/* What is late is no error, and still not what was asked for. */
static void tell_of_missing(const layers_drawing *d) {
  unsigned long long n_late = d->drawn.n_clouds_missing - d->drawn.n_clouds_damaged;
  if (n_late)
    conic_log(d->layers->context, CONIC_LOG_WARNING, "%s: %llu clouds are missing%s: %llu places are drawn coarser",
              d->layers->name, n_late, d->options->seconds > 0.0 ? " when the time is up" : "",
              (unsigned long long)d->cut.n_coarser);
}

static int wants_hiding(const layers_drawing *d) {
  if (d->transparency || d->options->samples > 1 || d->options->occlusion == CONIC_OCCLUSION_OFF || d->cut.n < 2)
    return 0;
  return d->options->occlusion == CONIC_OCCLUSION_ON ||
         conic_layers_depth_complexity(d->layers, &d->view, &d->cut) >= deep;
}

static void count_up(layers_drawing *d, const conic_render_statistics *statistics) {
  conic_layers_drawn *drawn = &d->drawn;
  uint64_t n_splats = 0;
  drawn->n_places = d->cut.n;
  drawn->n_places_coarser = d->options->may_be_coarser ? d->cut.n_coarser : 0;
  drawn->missing_error_px = d->options->may_be_coarser ? d->cut.coarser_px : 0.0;
  for (size_t i = 0; i < d->cut.n; i++) {
    const conic_layers_place *place = &d->cut.places[i];
    drawn->n_places_hidden += place->state == CONIC_PLACE_HIDDEN;
    drawn->n_places_grazing += place->state == CONIC_PLACE_GRAZING;
    n_splats += d->layers->entries[place->node].n_drawn;
  }
  drawn->n_clouds_grazing = conic_layers_needed(d->layers, &d->cut, CONIC_PLACE_SHOWN, d->needed);
  drawn->n_clouds = conic_layers_needed(d->layers, &d->cut, CONIC_PLACE_GRAZING, d->needed);
  drawn->n_clouds_grazing = drawn->n_clouds - drawn->n_clouds_grazing;
  n_splats -= drawn->n_splats_turned;
  drawn->n_splats_left = n_splats > statistics->splats_in ? n_splats - statistics->splats_in : 0;
  for (uint32_t i = 0; i < d->layers->header.n_clouds; i++)
    if (d->needed[i] && d->layers->entries[i].n_samples > 0 && d->layers->entries[i].level >= drawn->n_levels)
      drawn->n_levels = d->layers->entries[i].level + 1;
}

/* Where the camera will be if it goes on as it came: the motion from the picture before, done once more. */
static void move_camera_on(const conic_camera *before, const conic_camera *now, conic_camera *next) {
  double motion[3][4];
  *next = *now;
  for (int i = 0; i < 3; i++) {
    motion[i][3] = now->cam_from_world[i][3];
    for (int k = 0; k < 3; k++) {
      motion[i][k] = 0.0;
      for (int axis = 0; axis < 3; axis++)
        motion[i][k] += now->cam_from_world[i][axis] * before->cam_from_world[k][axis];
      motion[i][3] -= motion[i][k] * before->cam_from_world[k][3];
    }
  }
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 4; k++) {
      next->cam_from_world[i][k] = k == 3 ? motion[i][3] : 0.0;
      for (int axis = 0; axis < 3; axis++)
        next->cam_from_world[i][k] += motion[i][axis] * now->cam_from_world[axis][k];
    }
}

/* Asks for what the next picture will want, if the camera goes on as it came. What fails here is seen there. */
static void look_ahead(void *data) {
  layers_drawing *d = data;
  conic_layers *layers = d->layers;
  conic_layers_wish wish = {.error_px = d->drawn.error_px, .most_levels = d->options->most_levels};
  conic_layers_view view;
  conic_layers_cut cut = {0};
  conic_camera camera;
  size_t n = 0;
  if (!layers->is_remote || layers->last_camera.width != d->camera->width ||
      memcmp(&layers->last_camera, d->camera, sizeof *d->camera) == 0)
    return;
  move_camera_on(&layers->last_camera, d->camera, &camera);
  conic_layers_view_init(&layers->header, &camera, &d->render, d->render.near_z, &view);
  if (conic_layers_find_cut(layers, &view, &wish, &cut) == CONIC_OK) {
    conic_layers_needed(layers, &cut, CONIC_PLACE_SHOWN, d->needed);
    for (uint32_t i = 0; i < layers->header.n_clouds; i++)
      if (d->needed[i] && layers->entries[i].n_samples > 0)
        d->held[n++] = i;
    if (n > 0)
      (void)conic_layers_store_ask_ahead(layers, d->held, n);
  }
  conic_layers_cut_release(layers->context, &cut);
}

static conic_status draw_layers(layers_drawing *d, conic_renderer *renderer, conic_image *image,
                                conic_render_statistics *statistics) {
  double start = conic_seconds_now();
  conic_status status = choose_first(d);
  if (status == CONIC_OK && d->options->may_be_coarser)
    status = make_do(d, d->options->seconds > 0.0 ? start + d->options->seconds : HUGE_VAL);
  if (status == CONIC_OK)
    tell_of_missing(d);
  if (status == CONIC_OK && d->layers->octree) {
    conic_layers_needed(d->layers, &d->cut, CONIC_PLACE_SHOWN, d->needed);
    status = conic_layers_octree_measure(d->layers, d->needed);
  }
  if (status == CONIC_OK && wants_hiding(d))
    status = conic_layers_hide(d->layers, renderer, &d->view, d->camera, &d->render, HUGE_VAL, &d->cut, d->set);
  if (status != CONIC_OK)
    return status;
  conic_layers_band_drawing bands = {.layers = d->layers,
                                     .renderer = renderer,
                                     .camera = d->camera,
                                     .render = &d->render,
                                     .cut = &d->cut,
                                     .view = &d->view,
                                     .samples = d->options->samples,
                                     .transparency = d->transparency,
                                     .chance = d->options->chance,
                                     .image = image,
                                     .set = d->set,
                                     .is_gathered = d->options->may_be_coarser ? NULL : look_ahead,
                                     .data = d,
                                     .n_turned = &d->drawn.n_splats_turned};
  status = conic_layers_draw_bands(&bands, statistics, &d->drawn.n_bands);
  if (status != CONIC_OK)
    return status;
  count_up(d, statistics);
  statistics->ms.lod = 1e3 * (conic_seconds_now() - start) - statistics->ms.frame;
  statistics->ms.frame += statistics->ms.lod;
  return CONIC_OK;
}

/* All planes have four bytes a value; and how far what is drawn hides is known for each pixel. */
static uint64_t bytes_of_picture(const conic_image *image) {
  uint64_t n_values = 1;
  for (int i = 0; i < CONIC_MAX_PLANES; i++)
    n_values += image->planes[i] ? (uint64_t)conic_plane_describe((conic_plane)i)->n_channels : 0;
  return n_values * sizeof(float) * (uint64_t)image->width * (uint64_t)image->height;
}

static conic_status begin_drawing(layers_drawing *d, const conic_render_options *render, const conic_image *image) {
  conic_layers_scale scale;
  d->layers->picture_bytes = bytes_of_picture(image);
  conic_layers_measure(d->layers, render->kernel.cutoff, &scale);
  d->render = *render;
  if (!(d->render.near_z > 0.0))
    d->render.near_z = scale.near_z;
  if (!(d->render.splat_length > 0.0))
    d->render.splat_length = scale.splat_length;
  if (conic_layers_schema_find(&d->layers->header.schema, CONIC_LAYERS_OPACITY) >= 0)
    d->transparency = d->options->transparency;
  conic_layers_view_init(&d->layers->header, d->camera, &d->render, d->render.near_z, &d->view);
  if (!d->view.cull_back || d->layers->facings)
    return CONIC_OK;
  d->layers->facings = conic_memory_allocate(d->layers->context, 1, sizeof *d->layers->facings);
  if (!d->layers->facings)
    return CONIC_ERROR_MEMORY;
  conic_layers_facings_init(d->layers->facings);
  return CONIC_OK;
}

/* What of a hierarchy the picture needs. */
static conic_status expand_layers(layers_drawing *d) {
  const conic_layers_draw_options *o = d->options;
  conic_layers_expansion expansion = {
      .error_px = o->error_px,
      .budget = o->budget,
      .most_levels = o->most_levels,
      .until_s = o->may_be_coarser && o->seconds > 0.0 ? conic_seconds_now() + o->seconds : HUGE_VAL,
      .may_miss = o->may_be_coarser,
      .tolerates_damage = o->may_be_coarser && o->tolerates_damage};
  if (!d->layers->octree)
    return CONIC_OK;
  conic_status status = conic_layers_octree_expand(d->layers, &d->view, &expansion);
  d->pages_damaged = expansion.n_damaged;
  return status;
}

static void end_drawing(layers_drawing *d) {
  conic_context *context = d->layers->context;
  conic_layers_store_unpin(d->layers, &d->holding);
  conic_layers_cut_release(context, &d->cut);
  conic_memory_release(context, d->needed);
  conic_memory_release(context, d->held);
}

conic_status conic_layers_draw(conic_layers *layers, conic_renderer *renderer, const conic_camera *camera,
                               const conic_render_options *given, const conic_layers_draw_options *wanted,
                               conic_image *image, conic_render_statistics *statistics, conic_layers_drawn *drawn) {
  conic_render_statistics counted;
  conic_render_options render;
  conic_layers_draw_options options;
  conic_status status = conic_view_arguments_take(layers->context, "layers", camera, given, &render);
  if (status != CONIC_OK)
    return status;
  conic_layers_draw_options_init(&options);
  const char *wrong = conic_options_take(&options, wanted) ? what_of_draw_is_wrong(camera, &render, &options, image)
                                                           : "the options were not initialised";
  if (wrong)
    return conic_fail(layers->context, CONIC_ERROR_ARGUMENT, "layers: %s", wrong);
  if (!layers->set)
    layers->set = conic_memory_allocate_zeroed(layers->context, 1, sizeof *layers->set);
  if (!layers->set)
    return CONIC_ERROR_MEMORY;
  layers_drawing d = {.layers = layers, .camera = camera, .options = &options, .set = layers->set};
  uint64_t n_read = layers->store.n_read;
  status = begin_drawing(&d, &render, image);
  if (status == CONIC_OK)
    status = expand_layers(&d);
  if (status != CONIC_OK)
    return status;
  d.needed = conic_memory_allocate(layers->context, layers->header.n_clouds, sizeof *d.needed);
  d.held = conic_memory_allocate(layers->context, layers->header.n_clouds, sizeof *d.held);
  if (status == CONIC_OK)
    status = d.needed && d.held ? draw_layers(&d, renderer, image, &counted) : CONIC_ERROR_MEMORY;
  end_drawing(&d);
  if (status != CONIC_OK)
    return status;
  layers->last_camera = *camera;
  d.drawn.n_clouds_culled = layers->header.n_clouds - d.drawn.n_clouds;
  d.drawn.n_clouds_read = layers->store.n_read - n_read;
  d.drawn.n_bytes_received =
      conic_ranges_received(layers->ranges) + conic_layers_octree_received(layers) - layers->n_told;
  layers->n_told += d.drawn.n_bytes_received;
  if (statistics)
    *statistics = counted;
  if (drawn)
    *drawn = d.drawn;
  return CONIC_OK;
}
