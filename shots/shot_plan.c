#include "shots/shot_plan.h"

#include "shots/focus.h"
#include "shots/shot_faults.h"
#include "source/source_kind.h"
#include "source/surfaces_among.h"

enum { RGBA = 1u << CONIC_PLANE_RGBA, Z = 1u << CONIC_PLANE_Z, NORMAL = 1u << CONIC_PLANE_NORMAL };
enum { MOTION = 1u << CONIC_PLANE_MOTION };

int conic_shot_is_lit(const conic_shot *shot) {
  return shot->light.n_directions > 0 || shot->light.has_shadows || shot->light.n_lamps > 0;
}

unsigned conic_shot_needs(const conic_shot *shot, unsigned planes) {
  if (conic_shot_is_lit(shot))
    planes |= Z | NORMAL | (planes & RGBA ? 1u << CONIC_PLANE_ALBEDO : 0);
  if (planes & 1u << CONIC_PLANE_POSITION || (planes & RGBA && shot->light.dome_stops > 0.0) ||
      (shot->n_samples > 0 && conic_focus_is_seen(shot)))
    planes |= Z;
  if (planes & 1u << CONIC_PLANE_BOUND)
    planes |= RGBA;
  if (planes & MOTION)
    planes |= Z | (shot->motion ? 1u << CONIC_PLANE_ID : 0);
  if (planes & 1u << CONIC_PLANE_CLUSTER || shot->catchers | shot->holdouts)
    planes |= 1u << CONIC_PLANE_ID;
  return planes;
}

/* Gaussians have pictures of their own for what a profile defines, but not through a lens, nor of all directions at
 * once. */
static int draws_itself(const conic_shot *shot, unsigned abilities, const conic_camera *camera) {
  int has_lens = shot->n_samples > 0 && shot->aperture.diameter > 0.0;
  if (!(abilities & CONIC_SOURCE_COMPOSITES) || abilities & CONIC_SOURCE_MIXES)
    return 0;
  return camera->kind != CONIC_CAMERA_CUBE && (shot->gaussians.profile != CONIC_PROFILE_EXACT || !has_lens);
}

int conic_shot_is_gathered(const conic_shot *shot, unsigned abilities, const conic_camera *camera) {
  return (camera->kind || camera->lens) && !draws_itself(shot, abilities, camera);
}

/* Samples of gathered pictures, surfaces among Gaussians, and sides that no one camera sees together, are lit view by
 * view. */
static conic_lit lit_how(const conic_shot *shot, int is_gathered, int is_composited) {
  if (!conic_shot_is_lit(shot))
    return CONIC_LIT_NOT;
  if (is_gathered && (is_composited || shot->n_samples > 0 || shot->camera.kind == CONIC_CAMERA_CUBE))
    return CONIC_LIT_BY_VIEW;
  return shot->n_samples > 0 ? CONIC_LIT_BY_SAMPLE : CONIC_LIT_WHOLE;
}

/* What is wrong with it; null: nothing. */
static const char *find_fault(const conic_source *source, const conic_shot *shot) {
  const unsigned abilities = source->scale.abilities;
  const char *fault = conic_fault_of_shot(shot);
  if (fault)
    return fault;
  if (conic_shot_is_lit(shot) && abilities & CONIC_SOURCE_COMPOSITES && !conic_source_surfaces(source))
    return "light is hidden from surfaces, not from Gaussians that are composited";
  if (shot->light.dome_stops > 0.0 && abilities & CONIC_SOURCE_COMPOSITES)
    return "eye-dome lighting is of surfaces, not of Gaussians that are composited";
  if (shot->view.transparency != CONIC_TRANSPARENCY_NONE && !shot->n_samples && conic_source_surfaces(source))
    return "surfaces among Gaussians let light through in the mean of samples: n_samples is above 0";
  if (shot->catchers && !conic_shot_is_lit(shot))
    return "a catcher needs light that may be hidden";
  if (shot->catchers | shot->holdouts && shot->view.samples > 1 && !conic_source_surfaces(source))
    return "catchers and holdouts have one sample a pixel, of which there may be means";
  if (shot->catchers | shot->holdouts && abilities & CONIC_SOURCE_COMPOSITES && !conic_source_surfaces(source))
    return "catchers and holdouts are surfaces";
  if (shot->planes & CONIC_GAUSSIAN_PLANES && !(abilities & CONIC_SOURCE_COMPOSITES))
    return "the planes T, medianZ, inverseZ, last and doubt are of Gaussians that are composited";
  if (shot->planes & 1u << CONIC_PLANE_DOUBT && conic_source_surfaces(source) &&
      conic_shot_is_gathered(shot, abilities, &shot->camera))
    return "the plane doubt, with surfaces among Gaussians, is of a perspective camera without a lens that distorts";
  if (shot->planes & 1u << CONIC_PLANE_CLUSTER && !(abilities & CONIC_SOURCE_CLUSTERS))
    return "the plane cluster is of hybrids";
  if (shot->planes & MOTION && (shot->camera.lens || (shot->camera.kind != CONIC_CAMERA_PERSPECTIVE &&
                                                      shot->camera.kind != CONIC_CAMERA_ORTHOGRAPHIC)))
    return "the plane motion is of perspective and parallel cameras without a lens that distorts";
  return NULL;
}

conic_status conic_shot_plan_make(const conic_source *source, const conic_renderer *renderer, const conic_shot *shot,
                                  conic_shot_plan *plan) {
  const unsigned abilities = source->scale.abilities;
  const char *fault = find_fault(source, shot);
  if (fault)
    return conic_fail(source->context, CONIC_ERROR_ARGUMENT, "%s: the shot cannot be drawn: %s", source->name, fault);
  plan->is_accumulated = shot->n_samples > 0;
  plan->is_gathered = conic_shot_is_gathered(shot, abilities, &shot->camera);
  plan->is_composited = conic_source_surfaces(source) != NULL;
  plan->lit = lit_how(shot, plan->is_gathered, plan->is_composited);
  plan->is_apart = plan->is_composited && (plan->lit != CONIC_LIT_NOT || shot->catchers | shot->holdouts);
  plan->planes = conic_shot_needs(shot, shot->planes);
  plan->has_windows = conic_source_has_windows(source, renderer, shot->view.transparency != CONIC_TRANSPARENCY_NONE) &&
                      !(shot->catchers | shot->holdouts) && !plan->is_apart;
  return CONIC_OK;
}
