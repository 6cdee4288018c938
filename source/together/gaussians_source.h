/* A Gaussian scene as a source, alone or among the surfaces of other inputs. */
#pragma once

#include "conic/gaussian_render.h"
#include "lod/blends/levels_read.h"
#include "source/input_places.h"
#include "source/source_kind.h"

/* An input of several. */
typedef struct conic_among_input {
  int is_gaussian;
  uint32_t first_id; /* of its Gaussians; of a surface its number among the surfaces' inputs */
  conic_place place;
  conic_levels *levels; /* of a scene in levels; else null */
  conic_levels_cut cut; /* of these */
  conic_gaussians set;  /* of a scene that is not in levels, beside one that is */
  int is_lent;          /* the set is a caller's */
} conic_among_input;

typedef struct conic_gaussians_source {
  conic_source base;
  conic_gaussians gaussians; /* of all inputs that are scenes, one after the other, where they are now */
  conic_gaussians rest;      /* … and at rest, while something moves; else empty */
  int is_lent;               /* the Gaussians are a caller's */
  conic_gaussian_options options;
  conic_gaussian_statistics drawn;
  /* Makes the Gaussians those of a picture; null: they are all that there is. */
  conic_status (*choose)(conic_source *source, const conic_camera *camera);
  conic_source *surfaces; /* of the other inputs; null: there are none */
  conic_among_input *inputs;
  size_t n_inputs; /* 0: there is one */
} conic_gaussians_source;

/* Whether a file is a scene that is to be composited. */
int conic_gaussians_source_takes(const char *path, const conic_source_options *options);

/* Measures the Gaussians. Errors: INPUT (there is none to draw), MEMORY. */
conic_status conic_gaussians_source_measure(conic_gaussians_source *g);

void conic_gaussians_source_close(conic_source *source);
conic_status conic_gaussians_source_draw(conic_source *source, conic_renderer *renderer, const conic_camera *camera,
                                         const conic_render_options *render, const conic_source_view *view,
                                         conic_image *image, conic_render_statistics *statistics);
/* What a picture of levels by the source's view and profile wishes. */
conic_levels_wish conic_gaussians_source_wish(const conic_gaussians_source *source);

/* What a small picture shows, of which a veil is found. */
conic_levels_wish conic_levels_coarser(const conic_levels_wish *wish, const conic_levels_scene *scenes, size_t n,
                                       const conic_gaussian_options *options);
/* Finds the veil of what that is. The caller releases its depths, on failure too. Errors: as of drawing. */
conic_status conic_levels_find_veil(conic_context *context, const conic_gaussians *set, const conic_camera *camera,
                                    const conic_gaussian_options *options, conic_levels_veil *veil);

/* A source of several inputs, or of one in levels. */
conic_status conic_together_open(conic_source *source, const char *const *paths, size_t n_paths,
                                 const conic_source_options *options);

/* Tells of n inputs, as far as they are in levels. */
void conic_levels_tell(const conic_among_input *inputs, size_t n, conic_facts *facts);

void conic_gaussians_source_tell(const conic_source *source, conic_facts *facts);

extern const conic_source_windowing conic_gaussians_windowing;
