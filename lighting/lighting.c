/* Takes from a drawn picture the light that does not arrive. */

#include "core/base/color.h"
#include "core/image/image_common.h"
#include "core/image/view_arguments.h"
#include "lighting/light_work.h"
#include "raster/tiles/lights.h"

/* --- lights with a direction --- */

typedef struct receiving {
  conic_light_work *l;
  const conic_light_map *map;
} receiving;

static void receive_light(void *data, size_t i_item) {
  const receiving *r = data;
  float facing[CONIC_RECEIVED_TOGETHER];
  size_t begin = i_item * CONIC_RECEIVED_TOGETHER, end = begin + CONIC_RECEIVED_TOGETHER;
  end = end < r->l->receivers.count ? end : r->l->receivers.count;
  r->l->room.loops.receive(r->map, &r->l->receivers, begin, end, 1, r->l->visible + begin, facing);
}

typedef struct shaded_pixels {
  const float *colors, *coverage; /* 3 and 1 a pixel */
} shaded_pixels;

/* Shades the row's pixels from begin to before end by the lights of l->finish; coverage 0: nothing is shown. */
static shaded_pixels shade_row(const conic_light_work *l, size_t y, size_t begin, size_t end, int i_thread) {
  const size_t width = (size_t)l->image->width, first = conic_light_pixel(l, 0, y);
  float *coverage = l->rows + 4 * width * (size_t)i_thread, *colors = coverage + width;
  const conic_shaded_row row = {.finish = &l->finish,
                                .rays = &l->spread.rays,
                                .albedo = (const float *)l->image->planes[CONIC_PLANE_ALBEDO] + 3 * first,
                                .normal = (const float *)l->image->planes[CONIC_PLANE_NORMAL] + 3 * first,
                                .coverage = coverage,
                                .y = y};
  for (size_t x = begin; x < end; x++)
    coverage[x] = conic_light_coverage(l, first + x);
  l->room.loops.shade(&row, begin, end, colors);
  return (shaded_pixels){colors, coverage + begin};
}

static void hide_row(void *data, size_t y, int i_thread) {
  const conic_light_work *l = data;
  const float *filled = l->spread.filled + conic_light_pixel(l, 0, y);
  size_t begin = 0, end = (size_t)l->image->width;
  for (; end > 0 && !(1.0f - filled[end - 1] > 0.0f); end--)
    ;
  for (; begin < end && !(1.0f - filled[begin] > 0.0f); begin++)
    ;
  if (begin == end)
    return;
  const shaded_pixels s = shade_row(l, y, begin, end, i_thread);
  float *hidden = l->hidden + 3 * conic_light_pixel(l, begin, y);
  for (size_t i = 0; i < end - begin; i++) {
    float part = 1.0f - filled[begin + i];
    for (size_t c = 0; c < 3 && part > 0.0f && s.coverage[i] > 0.0f; c++)
      hidden[3 * i + c] += part * s.colors[3 * i + c];
  }
}

/* Adds the hidden part of the given lights: pixels get only l->spread.filled of their light. */
static void hide_lights(conic_light_work *l, const conic_finish_lights *lights) {
  if (!l->hidden)
    return;
  l->finish.lights = lights;
  conic_parallel_for(l->context, (size_t)l->image->height, hide_row, l);
}

static int is_any_hidden(const float hidden[3]) {
  return (hidden[0] > 0.0f) | (hidden[1] > 0.0f) | (hidden[2] > 0.0f);
}

/* Takes the hidden part of what all lights make of a pixel. It multiplies by a part, and does not subtract a
 * difference: where normals cancel, the picture is darker than its planes tell (conic_shade). In one sample, a
 * direction's hidden light may be more than the whole; the mean of all is not. */
static void take_row(void *data, size_t y, int i_thread) {
  const conic_light_work *l = data;
  const float *hidden = l->hidden + 3 * conic_light_pixel(l, 0, y);
  float *rgba = (float *)l->image->planes[CONIC_PLANE_RGBA] + 4 * conic_light_pixel(l, 0, y);
  size_t begin = 0, end = (size_t)l->image->width;
  for (; end > 0 && !is_any_hidden(hidden + 3 * (end - 1)); end--)
    ;
  for (; begin < end && !is_any_hidden(hidden + 3 * begin); begin++)
    ;
  if (begin == end)
    return;
  const shaded_pixels s = shade_row(l, y, begin, end, i_thread);
  for (size_t x = begin; x < end; x++) {
    const float *shaded = s.colors + 3 * (x - begin), *dark = hidden + 3 * x;
    if (!is_any_hidden(dark) || !(s.coverage[x - begin] > 0.0f))
      continue;
    for (int c = 0; c < 3; c++) {
      int is_left = l->options->is_sample ? shaded[c] > 0.0f : dark[c] < shaded[c];
      rgba[4 * x + (size_t)c] *= is_left ? 1.0f - dark[c] / shaded[c] : shaded[c] > 0.0f ? 0.0f : 1.0f;
    }
  }
}

static void add_shadow(conic_light_work *l, float luminance) {
  float *shadow = l->image->planes[CONIC_PLANE_SHADOW];
  for (size_t i = 0; i < conic_image_pixels(l->image) && shadow; i++)
    shadow[i] += luminance * l->spread.filled[i];
}

static conic_status cast_shadow(conic_light_work *l, const conic_finish_light *light) {
  conic_light_map map;
  receiving work = {l, &map};
  double direction[3] = {(double)light->towards[0], (double)light->towards[1], (double)light->towards[2]};
  float luminance = conic_light_luminance(light->diffuse);
  size_t n_items = (l->receivers.count + CONIC_RECEIVED_TOGETHER - 1) / CONIC_RECEIVED_TOGETHER;
  conic_status status = n_items ? conic_map_room_draw(&l->room, direction, &map) : CONIC_OK;
  if (status != CONIC_OK)
    return status;
  conic_parallel_for(l->context, n_items, receive_light, &work);
  conic_edge_spread_fill(&l->spread, l->visible, 1.0f);
  l->one = (conic_finish_lights){.n_lights = 1, .lights[0] = *light};
  hide_lights(l, &l->one);
  add_shadow(l, luminance);
  l->power += (double)luminance;
  return CONIC_OK;
}

static conic_status cast_shadows(conic_light_work *l) {
  conic_status status = CONIC_OK;
  for (int i = 0; i < l->lights.n_lights && l->options->has_shadows && status == CONIC_OK; i++)
    if (!l->lights.lights[i].is_head) /* a head light lights exactly what the viewer sees */
      status = cast_shadow(l, &l->lights.lights[i]);
  return status;
}

/* Divides the arriving power by the whole. */
static void divide_shadow(conic_light_work *l) {
  float *shadow = l->image->planes[CONIC_PLANE_SHADOW];
  for (size_t i = 0; shadow && i < conic_image_pixels(l->image); i++) {
    float power = (float)l->power + (l->lamp_power ? l->lamp_power[i] : 0.0f);
    shadow[i] = power > 0.0f ? shadow[i] / power : 1.0f;
  }
}

/* --- light from all around --- */

/* The lights' sky in one direction, as a factor of a white sky's light. */
static void light_of_sky(const void *cookie, const double direction[3], double light[3]) {
  const conic_finish_lights *lights = cookie;
  double up = 0.0;
  for (int axis = 0; axis < 3; axis++)
    up += direction[axis] * (double)lights->up[axis];
  for (int c = 0; c < 3; c++)
    light[c] *= (double)lights->ambient[c] + (up > 0.0 ? (double)lights->slope[c] : -(double)lights->slope[c]);
}

/* Turns the sums of one colour into what a white surface reflects at each pixel. */
static void reflect_sky(conic_light_work *l, size_t c) {
  const conic_sky_sums *sums = &l->sums;
  float n = (float)l->options->n_directions, white = 4.0f; /* of each direction's light (conic_sky_direction) */
  int is_sample = l->options->is_sample != 0;
  float *const *normal = l->receivers.normal;
  conic_sky_rest rest;
  if (is_sample && !sums->takes_hidden)
    conic_sky_rest_without(l->options->sky, l->options->first_direction, &rest);
  for (size_t i = 0; i < l->receivers.count; i++) {
    float whole = sums->takes_hidden && !is_sample ? white * sums->facing[i] : n;
    l->visible[i] = whole > 0.0f ? sums->color[c][i] / whole : 0.0f;
    if (is_sample && !sums->takes_hidden)
      l->visible[i] += conic_sky_rest_at(&rest, c, (const float[3]){normal[0][i], normal[1][i], normal[2][i]});
  }
  conic_edge_spread_fill(&l->spread, l->visible, is_sample && sums->takes_hidden ? 0.0f : 1.0f);
}

/* Colours that the sky's light is spread for: from the first one to before the end. */
typedef struct sky_hiding {
  const conic_light_work *l;
  size_t first, end;
} sky_hiding;

static void hide_sky_row(void *data, size_t y) {
  const sky_hiding *work = data;
  const conic_light_work *l = work->l;
  const float *albedo = l->image->planes[CONIC_PLANE_ALBEDO];
  for (size_t x = 0; x < (size_t)l->image->width; x++) {
    size_t i = conic_light_pixel(l, x, y);
    float part = l->spread.filled[i];
    for (size_t c = work->first; part != 0.0f && c < work->end; c++)
      if (albedo[3 * i + c] > 0.0f)
        l->hidden[3 * i + c] += albedo[3 * i + c] / conic_light_coverage(l, i) * part;
  }
}

/* Hides the part of the lights' sky and ground that does not arrive. */
static void hide_sky(conic_light_work *l) {
  const size_t n = conic_is_grey(l->lights.ambient) && conic_is_grey(l->lights.slope) ? 3 : 1;
  for (size_t c = 0; c < 3; c += n) {
    sky_hiding work = {l, c, c + n};
    reflect_sky(l, c);
    conic_parallel_for(l->context, (size_t)l->image->height, hide_sky_row, &work);
  }
}

/* Adds the arriving light of a sky that the picture was drawn without. */
static void add_sky(conic_light_work *l) {
  const float *albedo = l->image->planes[CONIC_PLANE_ALBEDO];
  float *rgba = l->image->planes[CONIC_PLANE_RGBA];
  for (size_t c = 0; c < 3; c++) {
    reflect_sky(l, c);
    for (size_t i = 0; i < conic_image_pixels(l->image); i++)
      if (albedo[3 * i + c] > 0.0f)
        rgba[4 * i + c] += l->finish.exposure * albedo[3 * i + c] * l->spread.filled[i];
  }
}

/* The arriving part: of a sample's one direction, its share of the mean. */
static float arriving_part(const conic_light_work *l, size_t i) {
  const conic_sky_sums *sums = &l->sums;
  if (!l->options->is_sample)
    return conic_sky_sums_share(sums, i);
  /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): there are sums of every pixel */
  return sums->takes_hidden ? 1.0f - 4.0f * (sums->facing[i] - sums->visible[i]) : 4.0f * sums->visible[i];
}

static conic_status gather_sky(conic_light_work *l) {
  float *ao = l->image->planes[CONIC_PLANE_AO];
  int has_colors = l->hidden != NULL;
  size_t n = l->receivers.count;
  l->sums_block = conic_memory_allocate_zeroed(l->context, n, (has_colors ? 5 : 2) * sizeof *l->sums_block);
  conic_status status = conic_map_room_agree(&l->room, l->sums_block ? CONIC_OK : CONIC_ERROR_MEMORY);
  if (status != CONIC_OK)
    return status;
  l->sums = (conic_sky_sums){.facing = l->sums_block, .visible = l->sums_block + n, .takes_hidden = !l->options->sky};
  for (size_t c = 0; c < 3 && has_colors; c++)
    l->sums.color[c] = l->sums_block + (2 + c) * n;
  status = conic_sky_sums_add(&l->room, l->options, l->options->sky ? NULL : light_of_sky, &l->lights, &l->sums);
  if (status != CONIC_OK)
    return status;
  if (has_colors && l->sums.takes_hidden)
    hide_sky(l);
  if (!ao)
    return CONIC_OK;
  for (size_t i = 0; i < n; i++)
    l->visible[i] = arriving_part(l, i);
  conic_edge_spread_fill(&l->spread, l->visible, 1.0f);
  memcpy(ao, l->spread.filled, conic_image_pixels(l->image) * sizeof *ao);
  return CONIC_OK;
}

/* --- what surfaces mirror --- */

static void mirror_row(void *data, size_t y) {
  const conic_light_work *l = data;
  const float part = (float)l->options->reflectance;
  for (size_t x = 0; x < (size_t)l->image->width; x++) {
    size_t pixel = conic_light_pixel(l, x, y);
    const float *n = (const float *)l->image->planes[CONIC_PLANE_NORMAL] + 3 * pixel;
    float *rgba = (float *)l->image->planes[CONIC_PLANE_RGBA] + 4 * pixel, towards[3], mirrored[3], color[3];
    if (!(((const float *)l->image->planes[CONIC_PLANE_Z])[pixel] > 0.0f))
      continue;
    conic_pixel_viewer(&l->spread.rays, x, y, towards);
    float twice = 2.0f * ((n[0] * towards[0] + n[1] * towards[1]) + n[2] * towards[2]);
    for (int c = 0; c < 3; c++)
      mirrored[c] = twice * n[c] - towards[c];
    conic_sky_look(l->options->sky, mirrored, color);
    for (int c = 0; c < 3; c++)
      rgba[c] += part * (conic_light_coverage(l, pixel) * l->finish.exposure * color[c] - rgba[c]);
  }
}

/* --- all of it --- */

static void finish_colors(conic_light_work *l) {
  l->finish.lights = &l->lights;
  conic_parallel_for(l->context, (size_t)l->image->height, take_row, l);
  if (l->options->n_directions > 0 && !l->sums.takes_hidden)
    add_sky(l);
}

static conic_status check_picture(conic_context *context, const conic_camera *camera, const conic_image *image) {
  conic_status status = conic_view_ray_check(context, "light", camera);
  if (status != CONIC_OK)
    return status;
  if (image->width != camera->width || image->height != camera->height || !image->planes[CONIC_PLANE_Z] ||
      !image->planes[CONIC_PLANE_NORMAL])
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "light: the picture has no planes Z and N of its camera's size");
  if (image->planes[CONIC_PLANE_RGBA] && !image->planes[CONIC_PLANE_ALBEDO])
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "light: the picture has rgba without albedo");
  return CONIC_OK;
}

static conic_status prepare_lighting(conic_light_work *l, const conic_casters *casters) {
  conic_image *image = l->image;
  l->finish.options = l->render;
  l->finish.exposure = conic_exposure_factor(l->render->exposure);
  conic_status status = conic_finish_lights_init(l->context, l->camera, l->render, &l->lights);
  if (status == CONIC_OK)
    status = conic_map_room_init(l->context, "light", casters, l->options, &l->room);
  if (status == CONIC_OK)
    status = conic_receivers_of_image(l->context, l->camera, l->options->samples, image, &l->receivers);
  if (status != CONIC_OK)
    return status;
  l->room.receivers = &l->receivers;
  l->room.texel = l->receivers.spacing / l->options->texels;
  l->visible = conic_memory_allocate(l->context, l->receivers.count, sizeof *l->visible);
  for (size_t i = 0; i < conic_image_pixels(image) && image->planes[CONIC_PLANE_AO]; i++)
    ((float *)image->planes[CONIC_PLANE_AO])[i] = 1.0f;
  if (image->planes[CONIC_PLANE_SHADOW])
    memset(image->planes[CONIC_PLANE_SHADOW], 0, conic_image_pixels(image) * sizeof(float));
  int has_colors = image->planes[CONIC_PLANE_RGBA] && l->render->shading != CONIC_SHADE_NONE;
  if (has_colors)
    status = conic_memory_allocate_these(
        l->context, CONIC_ZEROED(l->hidden, 3 * conic_image_pixels(image)),
        CONIC_ROOM(l->rows, 4 * (size_t)image->width * (size_t)conic_context_threads(l->context)));
  if (!l->visible || status != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  return conic_edge_spread_init(l->context, l->camera, image, &l->receivers, casters->epsilon, l->options->samples,
                                &l->spread);
}

conic_status conic_image_light_shared(conic_context *context, const conic_casters *casters, const conic_camera *camera,
                                      const conic_render_options *render, const conic_lighting_options *options,
                                      conic_light_sharing *sharing, conic_image *image) {
  conic_render_options own_render;
  conic_lighting_options own;
  conic_light_work l = {.context = context, .camera = camera, .render = &own_render, .options = &own, .image = image};
  conic_render_options_init(&own_render);
  conic_lighting_options_init(&own);
  if (!casters || !camera || !image || !conic_options_take(&own_render, render) || !conic_options_take(&own, options))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "light: an argument is null, or the options were not initialised");
  conic_status status = check_picture(context, camera, image);
  if (status != CONIC_OK)
    return status;
  status = prepare_lighting(&l, casters);
  l.room.sharing = sharing;
  status = conic_map_room_agree(&l.room, status);
  if (status == CONIC_OK && own.n_directions > 0)
    status = gather_sky(&l);
  if (status == CONIC_OK)
    status = cast_shadows(&l);
  if (status == CONIC_OK && l.hidden)
    finish_colors(&l);
  if (status == CONIC_OK && own.n_lamps > 0)
    status = conic_light_add_lamps(&l);
  if (status == CONIC_OK && l.hidden && own.sky && own.reflectance > 0.0)
    conic_parallel_for(context, (size_t)image->height, mirror_row, &l);
  if (status == CONIC_OK)
    divide_shadow(&l);
  conic_memory_release_these(context, l.lamp_power, l.rows, l.hidden, l.sums_block);
  conic_edge_spread_release(&l.spread);
  conic_memory_release(context, l.visible);
  conic_receivers_release(context, &l.receivers);
  conic_map_room_release(&l.room);
  return status;
}

conic_status conic_image_light(conic_context *context, const conic_casters *casters, const conic_camera *camera,
                               const conic_render_options *render, const conic_lighting_options *options,
                               conic_image *image) {
  return conic_image_light_shared(context, casters, camera, render, options, NULL, image);
}

conic_status conic_lighter_shade(void *cookie, uint64_t i_sample, const conic_camera *camera, conic_image *sample) {
  const conic_lighter *lighter = cookie;
  conic_lighting_options options;
  conic_lighting_options_init(&options);
  if (!conic_options_take(&options, lighter->options))
    return conic_fail(lighter->context, CONIC_ERROR_ARGUMENT, "light: the options were not initialised");
  options.first_direction = i_sample;
  options.n_directions = options.n_directions > 0;
  options.is_sample = 1;
  return conic_image_light(lighter->context, lighter->casters, camera, lighter->render, &options, sample);
}
