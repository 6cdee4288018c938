#include "judge/planted_surfels.h"

#include <string.h>

#include "core/base/color.h"
#include "core/base/memory.h"

conic_status conic_planted_drawing_begin(conic_context *context, const conic_drawing *drawing, conic_planted *right,
                                         int samples, const conic_image *image, conic_planted_drawing *w) {
  const unsigned planes = (conic_image_planes(image) & CONIC_DRAWN_PLANES) | 1u << CONIC_PLANE_RGBA |
                          1u << CONIC_PLANE_ALBEDO | 1u << CONIC_PLANE_WEIGHT;
  const float white = conic_exposure_factor(right->options.exposure);
  memset(w, 0, sizeof *w);
  w->context = context;
  w->drawing = *drawing;
  w->samples = samples;
  right->is_opaque = right->options.has_background;
  for (int c = 0; c < 3 && right->options.has_background; c++)
    right->behind[c] = white * right->options.background[c];
  right->options.has_background = 0;
  if (!(right->options.near_z > 0.0))
    right->options.near_z = conic_drawing_near(drawing);
  conic_status status = conic_renderer_create(context, &w->renderer);
  if (status == CONIC_OK)
    status = conic_image_allocate(context, image->width, image->height, planes, &w->image);
  if (status == CONIC_OK && right->options.shading == CONIC_SHADE_PHONG)
    status = conic_image_allocate(context, image->width, image->height, 1u << CONIC_PLANE_RGBA, &w->matt);
  return status;
}

void conic_planted_drawing_end(conic_planted_drawing *w) {
  conic_image_release(w->context, &w->image);
  conic_image_release(w->context, &w->matt);
  if (w->renderer)
    conic_renderer_destroy(w->renderer);
}

/* Multiplies the axes by a factor, in arrays of their own. Errors: MEMORY. */
static conic_status lengthen_axes(conic_context *context, double factor, conic_splats *splats, float **room) {
  const size_t n = splats->count;
  const size_t strides[2] = {splats->strides.tangent_u, splats->strides.tangent_v};
  *room = conic_memory_allocate(context, n, 6 * sizeof **room);
  if (!*room)
    return CONIC_ERROR_MEMORY;
  for (int k = 0; k < 6; k++) {
    float **axis = k < 3 ? &splats->tangent_u[k] : &splats->tangent_v[k - 3], *to = *room + (size_t)k * n;
    const size_t stride = strides[k / 3] ? strides[k / 3] / sizeof(float) : 1;
    for (size_t i = 0; i < n; i++)
      to[i] = (float)(factor * (double)(*axis)[i * stride]);
    *axis = to;
  }
  splats->strides.tangent_u = splats->strides.tangent_v = 0;
  return CONIC_OK;
}

static conic_status draw_both(conic_planted_drawing *w, const conic_planted *p, const conic_drawing *drawing) {
  conic_render_options options = p->options;
  conic_renderer_slip(w->renderer, p->slips);
  conic_status status =
      conic_render_drawing(w->context, w->renderer, drawing, &p->camera, &options, w->samples, &w->image, NULL);
  options.shading = CONIC_SHADE_LAMBERT;
  if (status == CONIC_OK && w->matt.planes[CONIC_PLANE_RGBA])
    status = conic_render_drawing(w->context, w->renderer, drawing, &p->camera, &options, w->samples, &w->matt, NULL);
  return status;
}

static void take_samples(const conic_planted_drawing *w, const conic_planted *p, const conic_diagnosis_samples *s,
                         conic_channels *values) {
  const float *matt = w->matt.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < s->n; i++) {
    size_t x = s->places[i][0], y = s->places[i][1];
    x = p->mirrors[0] ? (size_t)s->width - 1 - x : x;
    y = p->mirrors[1] ? (size_t)s->height - 1 - y : y;
    const size_t pixel = y * (size_t)s->width + x;
    float *v = values[i];
    conic_channels_of_image(&w->image, pixel, v);
    v[CONIC_CHANNEL_T] = 1.0f - v[CONIC_CHANNEL_A];
    for (size_t c = 0; c < 3 && matt; c++) {
      v[CONIC_CHANNEL_GLOSS + c] = v[c] - matt[4 * pixel + c];
      v[c] = matt[4 * pixel + c];
    }
  }
}

conic_status conic_planted_drawing_draw(void *world, const conic_planted *p, const conic_diagnosis_samples *samples,
                                        conic_channels *values) {
  conic_planted_drawing *w = world;
  conic_drawing drawing = w->drawing;
  conic_splats splats;
  float *room = NULL;
  conic_status status = CONIC_OK;
  if (p->axes != 1.0 && drawing.splats && drawing.splats->tangent_u[0] && drawing.splats->tangent_v[0]) {
    splats = *drawing.splats;
    drawing.splats = &splats;
    status = lengthen_axes(w->context, p->axes, &splats, &room);
  }
  if (status == CONIC_OK)
    status = draw_both(w, p, &drawing);
  if (status == CONIC_OK)
    take_samples(w, p, samples, values);
  conic_memory_release(w->context, room);
  return status;
}
