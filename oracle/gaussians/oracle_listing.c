/* Why a pixel is as it is: the Gaussians that have it in their reach, in their order. */

#include "core/image/view_arguments.h"
#include "oracle/gaussians/oracle_cells.h"
#include "oracle/gaussians/oracle_surface.h"

conic_status conic_oracle_enter(conic_context *context, const conic_gaussians *gaussians, const conic_camera *camera,
                                const conic_gaussian_options *options, const conic_float_model *model, int samples,
                                oracle_entry *e) {
  memset(e, 0, sizeof *e);
  conic_gaussian_options_init(&e->options);
  conic_float_model_init(&e->model, CONIC_FLOATS_OWN);
  if (!gaussians || !camera || (options && !conic_options_take(&e->options, options)) ||
      (model && !conic_options_take(&e->model, model)) || !conic_profile_row_of(e->options.profile) || samples < 1 ||
      samples > CONIC_MAX_SAMPLES)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "judge: no such options, profile, floats or samples");
  if (e->options.prefilter != 0.0)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "judge: a picture under a prefilter is not judged");
  if (conic_view_bounded_check(context, "judge", conic_profile_row_of(e->options.profile), camera) != CONIC_OK)
    return CONIC_ERROR_ARGUMENT;
  if ((long)camera->width * samples > 65535 || (long)camera->height * samples > 65535)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "judge: so many samples make more than 65535 a side");
  conic_oracle_middle(camera, &e->fine);
  e->fine.width *= samples;
  e->fine.height *= samples;
  e->fine.fx *= samples;
  e->fine.fy *= samples;
  e->fine.cx *= samples;
  e->fine.cy *= samples;
  conic_oracle_gaussian_look(&e->fine, e->options.profile, &e->view);
  if (camera->shutter)
    conic_oracle_shutter_eye(camera, e->view.eye);
  const conic_profile_row *rules = e->view.rules;
  e->bounding = (oracle_bound_request){
      .context = context,
      .doubting = {&e->view,
                   &e->model,
                   gaussians,
                   {(double)(float)rules->alpha_least, (double)(float)rules->alpha_most, (double)(float)rules->stop,
                    rules->greatest_half_q, (double)(float)rules->disc_near, rules->fall_end,
                    1.0 / (1.0 - rules->fall_end)}},
      .background = e->options.background,
      .samples = samples,
      .width = camera->width,
      .height = camera->height,
      .n_pixels = (size_t)camera->width * (size_t)camera->height};
  return CONIC_OK;
}

/* What becomes of an entry, as the double run goes. */
typedef struct listing_run {
  double T;
  int has_ended;
} listing_run;

static void fill_entry(const oracle_doubting *d, const oracle_meeting *m, listing_run *run, conic_gaussian_entry *to) {
  const oracle_uncertain *g = m->g;
  *to = (conic_gaussian_entry){.index = g->index,
                               .part = m->part,
                               .key = m->key,
                               .z = m->z_v,
                               .q = 2.0 * m->half_q_v,
                               .q_low = 2.0 * m->half_q[0],
                               .q_high = 2.0 * m->half_q[1],
                               .alpha = m->alpha_v,
                               .alpha_low = m->alpha[0],
                               .alpha_high = m->alpha[1],
                               .color = {g->color[0].v, g->color[1].v, g->color[2].v},
                               .opacity = g->opacity.v,
                               .doubts = m->may_cover ? m->noted : 0};
  if (!m->covers)
    return;
  double after = run->T * (1.0 - m->alpha_v), stop = d->limits.stop;
  run->has_ended |= after < stop || (d->view->rules->is_beyond_stop && after == stop);
  if (run->has_ended) {
    to->part = CONIC_PART_HIDDEN;
    return;
  }
  to->before = run->T;
  to->after = run->T = after;
  to->weight = m->alpha_v * to->before;
}

/* Bounds the meetings that may cover, and copies their notes back to the list of all. */
static conic_status bound_meetings(const oracle_bound_request *b, const oracle_surface *surface,
                                   oracle_meeting *meetings, size_t n, conic_gaussian_bound *bound) {
  oracle_meeting *those;
  size_t *from, n_those = 0;
  oracle_step *steps;
  conic_status status =
      conic_memory_allocate_these(b->context, CONIC_ROOM(those, n), CONIC_ROOM(from, n), CONIC_ROOM(steps, n));
  if (status == CONIC_OK) {
    for (size_t i = 0; i < n; i++)
      if (meetings[i].may_cover) {
        from[n_those] = i;
        those[n_those++] = meetings[i];
      }
    conic_oracle_composite(&b->doubting, those, n_those, b->background, surface, steps, bound);
    for (size_t i = 0; i < n_those; i++)
      meetings[from[i]].noted = those[i].noted;
  }
  conic_memory_release_these(b->context, those, from, steps);
  return status;
}

static void fill_surface(const oracle_surface *surface, double T, conic_gaussian_listing *to) {
  to->has_surface = 1;
  to->surface_z = surface->z;
  to->surface_weight = T;
  to->surface_id = surface->id;
  memcpy(to->surface_color, surface->color, sizeof to->surface_color);
}

/* Lists the meetings of a pixel, which are in their order. */
static conic_status list_meetings(const oracle_bound_request *b, const oracle_surface *surface,
                                  oracle_meeting *meetings, size_t n, conic_gaussian_listing *listing) {
  listing_run run = {1.0, 0};
  for (size_t i = 0; i < n && surface; i++)
    meetings[i].may_cover &= conic_oracle_is_before_surface(surface, &meetings[i]);
  conic_status status = bound_meetings(b, surface, meetings, n, &listing->bound);
  if (status == CONIC_OK && !(listing->entries = conic_memory_allocate(b->context, n, sizeof *listing->entries)))
    status = CONIC_ERROR_MEMORY;
  if (status != CONIC_OK)
    return status;
  for (size_t i = 0; i < n; i++)
    fill_entry(&b->doubting, &meetings[i], &run, &listing->entries[i]);
  listing->n = n;
  listing->has_ended = run.has_ended;
  if (surface)
    fill_surface(surface, run.T, listing);
  return CONIC_OK;
}

conic_status conic_gaussian_explain(conic_context *context, const conic_gaussians *gaussians,
                                    const conic_camera *camera, const conic_gaussian_options *options,
                                    const conic_float_model *model, const conic_gaussian_surfaces *surfaces, int x,
                                    int y, conic_gaussian_listing *listing) {
  oracle_entry e;
  oracle_surface surface;
  oracle_uncertain *placed = NULL;
  oracle_meeting *meetings = NULL;
  size_t n = 0;
  memset(listing, 0, sizeof *listing);
  conic_status status = conic_oracle_enter(context, gaussians, camera, options, model, 1, &e);
  if (status == CONIC_OK && (x < 0 || y < 0 || x >= camera->width || y >= camera->height))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "explain: the pixel is not in the picture");
  if (status == CONIC_OK && surfaces && !conic_oracle_surfaces_fit(surfaces, camera->width, camera->height, 0))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "explain: the surfaces are not those of the picture's pixels");
  int is_there = status == CONIC_OK && surfaces && conic_oracle_surface_at(surfaces, x, y, &surface);
  if (status == CONIC_OK)
    status = conic_oracle_meet_all(&e.bounding, x + 0.5, y + 0.5, &placed, &meetings, &n);
  if (status == CONIC_OK)
    status = list_meetings(&e.bounding, is_there ? &surface : NULL, meetings, n, listing);
  conic_memory_release_these(context, placed, meetings);
  return status;
}

void conic_gaussian_listing_release(conic_context *context, conic_gaussian_listing *listing) {
  conic_memory_release(context, listing->entries);
  memset(listing, 0, sizeof *listing);
}
