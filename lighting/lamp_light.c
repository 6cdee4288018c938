/* The light that a picture gets from lamps. */

#include "core/image/image_common.h"
#include "lighting/lamps.h"
#include "lighting/light_work.h"

typedef struct lamp_lighting {
  conic_light_work *l;
  float *depth; /* of each pixel; beside a surface its neighbours'; 0: nothing is near */
  double offset;
  conic_lamp_point point, middle; /* where the lamp shines from in this picture, and its middle */
} lamp_lighting;

/* Adds the lamp's unhidden light to the pixel's colour. */
static void add_color(const lamp_lighting *work, size_t x, size_t y, const double towards[3], float strength) {
  const conic_light_work *l = work->l;
  const conic_lamp *lamp = work->point.lamp;
  size_t pixel = conic_light_pixel(l, x, y);
  float *rgba = (float *)l->image->planes[CONIC_PLANE_RGBA] + 4 * pixel, shaded[3];
  conic_finish_lights lights = {.n_lights = 1};
  conic_finish finish = l->finish;
  finish.lights = &lights;
  for (int i = 0; i < 3; i++) {
    lights.lights[0].towards[i] = (float)towards[i];
    lights.lights[0].diffuse[i] = CONIC_DIFFUSE * lamp->color[i];
    lights.lights[0].specular[i] = CONIC_SPECULAR * lamp->color[i];
  }
  if (!conic_light_shade(l, &finish, x, y, shaded))
    return;
  float part = finish.exposure * conic_light_coverage(l, pixel) * strength * l->spread.filled[pixel];
  for (int c = 0; c < 3; c++)
    rgba[c] += part * shaded[c];
}

/* Adds the arriving part of the power from the lamp's middle. Each point of a sphere shines to one side; the mean over
 * its points is as much as the middle's. */
static void add_power(const lamp_lighting *work, size_t pixel, const double at[3], double strength) {
  const conic_light_work *l = work->l;
  const conic_lamp *lamp = work->point.lamp;
  float *shadow = l->image->planes[CONIC_PLANE_SHADOW];
  double towards[3], whole = conic_lamp_strength(&work->middle, at, towards);
  float luminance = conic_light_luminance(lamp->color) * CONIC_DIFFUSE;
  if (!l->options->has_shadows || !(whole > 0.0))
    return;
  double arriving = lamp->kind == CONIC_LAMP_SPHERE ? strength : whole;
  if (shadow)
    shadow[pixel] += luminance * (float)arriving * l->spread.filled[pixel];
  l->lamp_power[pixel] += luminance * (float)whole;
}

static void light_row(void *data, size_t y) {
  const lamp_lighting *work = data;
  const conic_light_work *l = work->l;
  double at[3], towards[3];
  for (size_t x = 0; x < (size_t)l->image->width; x++) {
    size_t pixel = conic_light_pixel(l, x, y);
    float z = work->depth[pixel];
    if (!(z > 0.0f) || !conic_pixel_place(&l->spread.rays, (double)x + 0.5 + work->offset,
                                          (double)y + 0.5 + work->offset, (double)z, at))
      continue;
    double strength = conic_lamp_strength(&work->point, at, towards);
    if (l->hidden && strength > 0.0)
      add_color(work, x, y, towards, (float)strength);
    add_power(work, pixel, at, strength);
  }
}

static conic_status light_lamp(lamp_lighting *work, const conic_lamp *lamp) {
  conic_light_work *l = work->l;
  conic_lighting_options middle = *l->options;
  conic_status status = CONIC_OK;
  double nearest = 0.01 * l->receivers.spacing;
  middle.is_sample = 0;
  conic_lamp_shine(lamp, l->options, l->receivers.origin, nearest, &work->point);
  conic_lamp_shine(lamp, &middle, l->receivers.origin, nearest, &work->middle);
  if (l->options->has_shadows)
    status = conic_lamp_receive(&l->room, &work->point, l->visible);
  for (size_t i = 0; i < l->receivers.count && !l->options->has_shadows; i++)
    l->visible[i] = 1.0f;
  if (status != CONIC_OK)
    return status;
  conic_edge_spread_fill(&l->spread, l->visible, 1.0f);
  conic_parallel_for(l->context, (size_t)l->image->height, light_row, work);
  return CONIC_OK;
}

/* A pixel at the border of what is drawn may have a colour but no depth. */
static conic_status find_lamp_depths(lamp_lighting *work) {
  conic_light_work *l = work->l;
  const float *z = l->image->planes[CONIC_PLANE_Z];
  size_t n = conic_image_pixels(l->image);
  if (conic_memory_allocate_these(l->context, CONIC_ROOM(work->depth, n), CONIC_ZEROED(l->lamp_power, n)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < l->receivers.count; i++)
    l->visible[i] = z[l->receivers.pixel[i]];
  conic_edge_spread_fill(&l->spread, l->visible, 0.0f);
  memcpy(work->depth, l->spread.filled, n * sizeof *work->depth);
  return CONIC_OK;
}

conic_status conic_light_add_lamps(conic_light_work *l) {
  lamp_lighting work = {.l = l, .offset = conic_depth_offset(l->options->samples)};
  conic_status status = find_lamp_depths(&work);
  for (size_t i = 0; i < l->options->n_lamps && status == CONIC_OK; i++) {
    status = conic_progress(l->context, "light", (double)i / (double)l->options->n_lamps);
    if (status == CONIC_OK)
      status = light_lamp(&work, &l->options->lamps[i]);
  }
  conic_memory_release(l->context, work.depth);
  return status;
}
