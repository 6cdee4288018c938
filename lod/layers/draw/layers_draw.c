#include <limits.h>

#include "core/image/image_common.h"
#include "core/image/view_arguments.h"
#include "lod/layers/draw/layers_octree.h"
#include "lod/layers/draw/layers_picture.h"
#include "lod/layers/draw/layers_spill.h"

/* Where fewer surfaces than this lie behind each other, finding out what is hidden takes longer than drawing it. */
static const double deep = 4.0;

struct conic_layers_picture {
  conic_layers *layers;
  conic_renderer *renderer;
  conic_camera camera;
  conic_render_options render; /* near_z and splat_length given */
  conic_layers_draw_options options;
  conic_layers_view view;
  conic_layers_cut cut;
  conic_layers_set *set; /* the layers', so that its memory is kept from picture to picture */
  unsigned char *needed; /* a cloud */
  uint32_t *held;        /* clouds that are kept until the picture is drawn */
  conic_layers_loading holding;
  uint32_t *chosen;          /* a place of the cut: those of a window, */
  unsigned char *is_counted; /* and whether what becomes of its splats is the window's to count */
  uint64_t pages_damaged;    /* of an octree's hierarchy */
  conic_layers_drawn drawn;
  uint64_t n_root; /* as in a cut */
  double until_s;  /* nothing is read later; infinite: it takes as long as it takes */
};

CONIC_DEFINE_OPTIONS(conic_layers_draw_options, .samples = 1)

static const char *what_of_draw_is_wrong(const conic_camera *camera, const conic_render_options *render,
                                         const conic_layers_draw_options *options) {
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

/* What is late is drawn as what is above it, whose clouds are there in any case; stand-ins would have to be read. */
static conic_layers_wish wish_of(const conic_layers_picture *d) {
  const conic_layers_draw_options *o = &d->options;
  int is_coarse = (o->budget || o->error_px > 0.0) && !o->may_be_coarser && !o->only_samples;
  return (conic_layers_wish){.error_px = d->drawn.error_px,
                             .most_levels = o->most_levels,
                             .n_root = d->n_root,
                             .may_stand_in = is_coarse && conic_layers_has_stand_ins(d->layers),
                             .prefers_stand_ins = o->budget > 0};
}

static conic_status choose_clouds(conic_layers_picture *d, const unsigned char *is_in) {
  conic_layers_wish wish = wish_of(d);
  wish.is_in = is_in;
  return conic_layers_find_cut(d->layers, &d->view, &wish, &d->cut);
}

static conic_status choose_first(conic_layers_picture *d) {
  const conic_layers_draw_options *options = &d->options;
  conic_status status = CONIC_OK;
  d->drawn.error_px = options->error_px;
  const conic_layers_wish wish = wish_of(d);
  if (options->budget)
    status = conic_layers_fit_budget(d->layers, &d->view, &wish, options->budget, &d->drawn.error_px, &d->n_root);
  return status == CONIC_OK ? choose_clouds(d, NULL) : status;
}

/* Ranks the clouds that are needed where time may run out: first what makes the largest errors on the screen smaller.
 * Errors that differ by less than a third count as one, so that neighbours in the file are asked for together;
 * but a place is only finer once all of its children are there. */
static conic_status rank_clouds(const conic_layers_picture *d, uint64_t **ranks) {
  const conic_layers *layers = d->layers;
  *ranks = conic_memory_allocate_zeroed(layers->context, layers->header.n_clouds, sizeof **ranks);
  for (uint32_t i = 1; i < layers->header.n_clouds && *ranks; i++) {
    uint32_t above = layers->entries[i].parent;
    conic_layers_sight sight;
    if (!d->needed[i])
      continue;
    conic_layers_look(&d->view, &layers->entries[above], &sight);
    uint64_t exponent = conic_bits_of_double(sight.error_px) >> 51, rank = (4094 - exponent) << 32 | above;
    (*ranks)[i] = rank > (*ranks)[above] ? rank : (*ranks)[above];
  }
  return *ranks ? CONIC_OK : CONIC_ERROR_MEMORY;
}

/* Reads what the cut needs, as far as there is time and room, and makes it coarser where something is missing. */
static conic_status make_do(conic_layers_picture *d) {
  conic_layers *layers = d->layers;
  size_t n = 0;
  conic_layers_needed(layers, &d->cut, CONIC_PLACE_SHOWN, d->needed);
  for (uint32_t i = 0; i < layers->header.n_clouds; i++)
    if (d->needed[i])
      d->held[n++] = i;
  if (n == 0)
    return CONIC_OK;
  d->holding = (conic_layers_loading){
      .clouds = d->held, .until_s = d->until_s, .may_miss = 1, .tolerates_damage = d->options.tolerates_damage};
  d->holding.n = conic_layers_store_fit(layers, d->held, n, conic_layers_cache_bytes(layers));
  uint64_t *ranks = NULL;
  conic_status status = layers->is_remote && d->until_s < HUGE_VAL ? rank_clouds(d, &ranks) : CONIC_OK;
  d->holding.ranks = ranks;
  if (status == CONIC_OK)
    status = conic_layers_store_load(layers, &d->holding);
  conic_memory_release(layers->context, ranks);
  if (status != CONIC_OK) {
    d->holding.n = 0;
    return status;
  }
  d->drawn.n_clouds_damaged = d->holding.n_damaged + d->pages_damaged;
  if (!conic_layers_has_cloud(layers, 0))
    return conic_fail(layers->context, d->holding.n_damaged > 0 ? CONIC_ERROR_INPUT : CONIC_ERROR_IO,
                      "%s: not even the coarsest cloud could be read%s", layers->name,
                      d->options.seconds > 0.0 ? " in time" : "");
  for (uint32_t i = 0; i < layers->header.n_clouds; i++) {
    int is_in = conic_layers_has_cloud(layers, i) && !conic_layers_octree_is_page(layers, i);
    d->drawn.n_clouds_missing += d->needed[i] && !is_in;
    d->needed[i] = (unsigned char)(is_in || (!d->needed[i] && !conic_layers_octree_is_page(layers, i)));
  }
  return choose_clouds(d, d->needed);
}

/* What is late is no error, and still not what was asked for. */
static void tell_of_missing(const conic_layers_picture *d) {
  unsigned long long n_late = d->drawn.n_clouds_missing - d->drawn.n_clouds_damaged;
  if (n_late)
    conic_log(d->layers->context, CONIC_LOG_WARNING, "%s: %llu clouds are missing%s: %llu places are drawn coarser",
              d->layers->name, n_late, d->options.seconds > 0.0 ? " when the time is up" : "",
              (unsigned long long)d->cut.n_coarser);
}

static int wants_hiding(const conic_layers_picture *d) {
  if (d->options.transparency || d->options.samples > 1 || d->options.occlusion == CONIC_OCCLUSION_OFF || d->cut.n < 2)
    return 0;
  return d->options.occlusion == CONIC_OCCLUSION_ON ||
         conic_layers_depth_complexity(d->layers, &d->view, &d->cut) >= deep;
}

static void count_up(conic_layers_picture *d, const conic_render_statistics *statistics) {
  conic_layers_drawn *drawn = &d->drawn;
  uint64_t n_splats = 0;
  drawn->n_places = d->cut.n;
  drawn->n_places_coarser = d->options.may_be_coarser ? d->cut.n_coarser : 0;
  drawn->missing_error_px = d->options.may_be_coarser ? d->cut.coarser_px : 0.0;
  for (size_t i = 0; i < d->cut.n; i++) {
    const conic_layers_place *place = &d->cut.places[i];
    drawn->n_places_hidden += place->state == CONIC_PLACE_HIDDEN;
    drawn->n_places_grazing += place->state == CONIC_PLACE_GRAZING;
    n_splats += place->n_splats;
  }
  drawn->n_clouds_grazing = conic_layers_needed(d->layers, &d->cut, CONIC_PLACE_SHOWN, d->needed);
  drawn->n_clouds = conic_layers_needed(d->layers, &d->cut, CONIC_PLACE_GRAZING, d->needed);
  drawn->n_clouds_grazing = drawn->n_clouds - drawn->n_clouds_grazing;
  n_splats -= drawn->n_splats_turned;
  drawn->n_splats_left = n_splats > statistics->splats_in ? n_splats - statistics->splats_in : 0;
  for (uint32_t i = 0; i < conic_layers_all(d->layers); i++)
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

/* What the next picture will show, as far as one knows: one level more of a picture that comes level by level, or what
 * the camera sees if it goes on as it came. 0: nobody knows. */
static int guess_next(const conic_layers_picture *d, conic_layers_view *view, conic_layers_wish *wish) {
  const conic_layers *layers = d->layers;
  conic_camera camera;
  *wish = wish_of(d);
  *view = d->view;
  if (d->options.may_be_coarser)
    return wish->most_levels++ > 0 && conic_seconds_now() < d->until_s;
  if (layers->last_camera.width != d->camera.width || memcmp(&layers->last_camera, &d->camera, sizeof d->camera) == 0)
    return 0;
  move_camera_on(&layers->last_camera, &d->camera, &camera);
  conic_layers_view_init(&layers->header, &camera, &d->render, d->render.near_z, view);
  return 1;
}

/* Asks for what the next picture will want. What fails here is seen there. */
static void look_ahead(void *data) {
  conic_layers_picture *d = data;
  conic_layers *layers = d->layers;
  conic_layers_wish wish;
  conic_layers_view view;
  conic_layers_cut cut = {0};
  size_t n = 0;
  if (!layers->is_remote || !guess_next(d, &view, &wish))
    return;
  uint32_t *clouds = conic_memory_allocate(layers->context, conic_layers_all(layers), sizeof *clouds);
  if (clouds && conic_layers_find_cut(layers, &view, &wish, &cut) == CONIC_OK) {
    conic_layers_needed(layers, &cut, CONIC_PLACE_SHOWN, d->needed);
    for (uint32_t i = 0; i < conic_layers_all(layers); i++)
      if (d->needed[i] && layers->entries[i].n_samples > 0)
        clouds[n++] = i;
    if (n > 0)
      (void)conic_layers_store_ask_ahead(layers, clouds, n);
  }
  conic_memory_release(layers->context, clouds);
  conic_layers_cut_release(layers->context, &cut);
}

/* --- a picture --- */

/* What of a hierarchy is drawn is measured as it is read. */
static conic_status measure_needed(conic_layers_picture *d) {
  return d->layers->octree ? conic_layers_octree_measure(d->layers, d->needed) : CONIC_OK;
}

static conic_status choose_for_picture(conic_layers_picture *d) {
  conic_status status = choose_first(d);
  if (status == CONIC_OK && d->options.may_be_coarser)
    status = make_do(d);
  if (status != CONIC_OK)
    return status;
  tell_of_missing(d);
  if (!wants_hiding(d))
    return CONIC_OK;
  conic_layers_needed(d->layers, &d->cut, CONIC_PLACE_SHOWN, d->needed);
  status = measure_needed(d);
  return status == CONIC_OK
             ? conic_layers_hide(d->layers, d->renderer, &d->view, &d->camera, &d->render, HUGE_VAL, &d->cut, d->set)
             : status;
}

static uint64_t bytes_of_picture(const conic_image *image) {
  return conic_planes_pixel_bytes(conic_image_planes(image)) * (uint64_t)conic_image_pixels(image);
}

static conic_status look_at_picture(conic_layers_picture *d) {
  conic_layers *layers = d->layers;
  conic_layers_scale scale;
  conic_layers_measure(layers, d->render.kernel.cutoff, &scale);
  if (!(d->render.near_z > 0.0))
    d->render.near_z = scale.near_z;
  if (!(d->render.splat_length > 0.0))
    d->render.splat_length = scale.splat_length;
  if (conic_layers_schema_find(&layers->header.schema, CONIC_LAYERS_OPACITY) < 0)
    d->options.transparency = CONIC_TRANSPARENCY_NONE;
  conic_layers_view_init(&layers->header, &d->camera, &d->render, d->render.near_z, &d->view);
  if (!d->view.cull_back || layers->facings)
    return CONIC_OK;
  layers->facings = conic_memory_allocate(layers->context, 1, sizeof *layers->facings);
  if (!layers->facings)
    return CONIC_ERROR_MEMORY;
  conic_layers_facings_init(layers->facings);
  return CONIC_OK;
}

/* What of a hierarchy the picture needs. Its pages take half of the time at most. */
static conic_status expand_layers(conic_layers_picture *d) {
  const conic_layers_draw_options *o = &d->options;
  conic_layers_expansion expansion = {.error_px = o->error_px,
                                      .budget = o->budget,
                                      .most_levels = o->most_levels,
                                      .until_s = d->until_s - (d->until_s < HUGE_VAL ? 0.5 * o->seconds : 0.0),
                                      .may_miss = o->may_be_coarser,
                                      .tolerates_damage = o->may_be_coarser && o->tolerates_damage};
  if (!d->layers->octree)
    return CONIC_OK;
  conic_status status = conic_layers_octree_expand(d->layers, &d->view, &expansion);
  d->pages_damaged = expansion.n_damaged;
  return status;
}

void conic_layers_picture_end(conic_layers_picture *d) {
  if (!d)
    return;
  conic_context *context = d->layers->context;
  conic_layers_store_unpin(d->layers, &d->holding);
  conic_layers_cut_release(context, &d->cut);
  conic_memory_release_these(context, d->needed, d->held, d->chosen, d->is_counted, d);
}

static conic_status begin_choosing(conic_layers_picture *d) {
  conic_layers *layers = d->layers;
  conic_status status = look_at_picture(d);
  if (status == CONIC_OK)
    status = expand_layers(d);
  if (status != CONIC_OK)
    return status;
  d->needed = conic_memory_allocate(layers->context, conic_layers_all(layers), sizeof *d->needed);
  d->held = conic_memory_allocate(layers->context, conic_layers_all(layers), sizeof *d->held);
  status = d->needed && d->held ? choose_for_picture(d) : CONIC_ERROR_MEMORY;
  if (status != CONIC_OK)
    return status;
  return conic_memory_allocate_these(layers->context, CONIC_ROOM(d->chosen, d->cut.n),
                                     CONIC_ROOM(d->is_counted, d->cut.n));
}

conic_status conic_layers_picture_begin(conic_layers *layers, conic_renderer *renderer, const conic_camera *camera,
                                        const conic_render_options *given, const conic_layers_draw_options *wanted,
                                        uint64_t image_bytes, conic_layers_picture **picture) {
  conic_context *context = layers->context;
  conic_render_options render;
  conic_layers_draw_options options;
  *picture = NULL;
  conic_status status = conic_view_arguments_take(context, "layers", camera, given, &render);
  if (status != CONIC_OK)
    return status;
  conic_layers_draw_options_init(&options);
  const char *wrong = conic_options_take(&options, wanted) ? what_of_draw_is_wrong(camera, &render, &options)
                                                           : "the options were not initialised";
  if (wrong)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "layers: %s", wrong);
  if (!layers->set)
    layers->set = conic_memory_allocate_zeroed(context, 1, sizeof *layers->set);
  conic_layers_picture *d = layers->set ? conic_memory_allocate_zeroed(context, 1, sizeof *d) : NULL;
  if (!d)
    return CONIC_ERROR_MEMORY;
  d->layers = layers;
  d->renderer = renderer;
  d->camera = *camera;
  d->render = render;
  d->options = options;
  d->until_s = options.may_be_coarser && options.seconds > 0.0 ? conic_seconds_now() + options.seconds : HUGE_VAL;
  d->set = layers->set;
  layers->picture_bytes = image_bytes + sizeof(float) * (uint64_t)camera->width * (uint64_t)camera->height;
  status = begin_choosing(d);
  if (status == CONIC_OK)
    *picture = d;
  else
    conic_layers_picture_end(d);
  return status;
}

static int is_in_window(const conic_window *window, int x, int y) {
  return x >= window->x_begin && x < window->x_end && y >= window->y_begin && y < window->y_end;
}

/* What lies above a place is given only to the first node there, so those of one place go together. */
static size_t choose_places(conic_layers_picture *d, const conic_window *window) {
  const conic_layers_place *places = d->cut.places;
  const conic_layers_entry *entries = d->layers->entries;
  size_t n = 0;
  for (size_t i = 0, end; i < d->cut.n; i = end) {
    int is_in = 0;
    for (end = i; end < d->cut.n && conic_layers_is_same_place(&entries[places[i].node], &entries[places[end].node]);
         end++) {
      const conic_window *pixels = &places[end].sight.pixels;
      conic_window in = conic_window_meet(pixels, window);
      is_in |= in.x_begin < in.x_end && in.y_begin < in.y_end;
      d->is_counted[end] = (unsigned char)is_in_window(window, pixels->x_begin, pixels->y_begin);
    }
    for (size_t k = i; k < end && is_in; k++)
      d->chosen[n++] = (uint32_t)k;
  }
  return n;
}

static uint64_t count_received(const conic_layers *layers) {
  return conic_ranges_received(layers->ranges) + conic_layers_octree_received(layers);
}

conic_status conic_layers_picture_draw(conic_layers_picture *d, const conic_window *window, uint64_t other_bytes,
                                       conic_image *image, conic_render_statistics *statistics,
                                       conic_layers_tally *tally) {
  conic_layers *layers = d->layers;
  if (!image || image->width != window->x_end - window->x_begin || image->height != window->y_end - window->y_begin)
    return conic_fail(layers->context, CONIC_ERROR_ARGUMENT, "layers: the image and the camera differ in size");
  uint64_t n_read = layers->store.n_read;
  int n_bands, is_whole = image->width == d->camera.width && image->height == d->camera.height;
  size_t n_chosen = choose_places(d, window);
  layers->picture_bytes = bytes_of_picture(image) + other_bytes;
  memset(d->needed, 0, conic_layers_all(layers));
  for (size_t k = 0; k < n_chosen; k++)
    conic_layers_mark_needed(layers, &d->cut.places[d->chosen[k]], d->needed);
  conic_status status = measure_needed(d);
  if (status != CONIC_OK)
    return status;
  conic_layers_band_drawing bands = {.layers = layers,
                                     .renderer = d->renderer,
                                     .camera = &d->camera,
                                     .render = &d->render,
                                     .cut = &d->cut,
                                     .view = &d->view,
                                     .samples = d->options.samples,
                                     .transparency = d->options.transparency,
                                     .chance = d->options.chance,
                                     .window = *window,
                                     .chosen = d->chosen,
                                     .n_chosen = n_chosen,
                                     .is_counted = is_whole ? NULL : d->is_counted,
                                     .image = image,
                                     .set = d->set,
                                     .is_gathered = is_whole ? look_ahead : NULL,
                                     .data = d,
                                     .n_turned = &tally->n_turned};
  status = conic_layers_draw_bands(&bands, statistics, &n_bands);
  tally->n_clouds_read += layers->store.n_read - n_read;
  tally->n_bands += (uint64_t)n_bands;
  tally->n_bytes_received += count_received(layers) - layers->n_told;
  layers->n_told = count_received(layers);
  return status;
}

/* The first window that ends below the row. */
static size_t find_window_at(const conic_window *list, size_t n, int row) {
  size_t first = 0;
  while (n > 0) {
    size_t half = n / 2;
    if (list[first + half].y_end <= row) {
      first += half + 1;
      n -= half + 1;
    } else
      n = half;
  }
  return first;
}

/* Each place's splats are spread over its pixels. */
void conic_layers_picture_weigh(const conic_layers_picture *d, const conic_window *list, size_t n, double *weights) {
  for (size_t i = 0; i < d->cut.n; i++) {
    const conic_window *pixels = &d->cut.places[i].sight.pixels;
    double area = (double)(pixels->x_end - pixels->x_begin) * (double)(pixels->y_end - pixels->y_begin);
    double weight = conic_layers_place_weight(&d->cut.places[i]) / area;
    for (size_t k = find_window_at(list, n, pixels->y_begin); k < n && list[k].y_begin < pixels->y_end; k++) {
      conic_window in = conic_window_meet(pixels, &list[k]);
      if (in.x_begin < in.x_end && in.y_begin < in.y_end)
        weights[k] += weight * (double)(in.x_end - in.x_begin) * (double)(in.y_end - in.y_begin);
    }
  }
}

void conic_layers_picture_tell(conic_layers_picture *d, const conic_render_statistics *statistics,
                               const conic_layers_tally *tally, conic_layers_drawn *drawn) {
  d->drawn.n_splats_turned = tally->n_turned;
  count_up(d, statistics);
  d->drawn.n_bands = tally->n_bands < INT_MAX ? (int)tally->n_bands : INT_MAX;
  d->drawn.n_clouds_culled = d->layers->header.n_clouds - d->drawn.n_clouds;
  d->drawn.n_clouds_read = tally->n_clouds_read;
  d->drawn.n_bytes_received = tally->n_bytes_received;
  *drawn = d->drawn;
}

conic_status conic_layers_draw(conic_layers *layers, conic_renderer *renderer, const conic_camera *camera,
                               const conic_render_options *render, const conic_layers_draw_options *options,
                               conic_image *image, conic_render_statistics *statistics, conic_layers_drawn *drawn) {
  conic_render_statistics counted;
  conic_layers_drawn told;
  conic_layers_picture *d;
  double start = conic_seconds_now();
  uint64_t n_read = layers->store.n_read;
  conic_status status =
      conic_layers_picture_begin(layers, renderer, camera, render, options, image ? bytes_of_picture(image) : 0, &d);
  if (status != CONIC_OK)
    return status;
  conic_layers_tally tally = {.n_clouds_read = layers->store.n_read - n_read};
  const conic_window whole = {0, camera->width, 0, camera->height};
  status = conic_layers_picture_draw(d, &whole, 0, image, &counted, &tally);
  if (status == CONIC_OK) {
    layers->last_camera = *camera;
    counted.ms.lod = 1e3 * (conic_seconds_now() - start) - counted.ms.frame;
    counted.ms.frame += counted.ms.lod;
    conic_layers_picture_tell(d, &counted, &tally, drawn ? drawn : &told);
    if (statistics)
      *statistics = counted;
  }
  conic_layers_picture_end(d);
  return status;
}
