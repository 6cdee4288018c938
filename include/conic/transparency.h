/* Transparency: splats, textures and materials that let light through from behind (docs/reference/transparency.md). */
#ifndef CONIC_TRANSPARENCY_H
#define CONIC_TRANSPARENCY_H

#include "conic/triangles.h"

CONIC_BEGIN_C

/* How a picture shows it. */
typedef enum conic_transparency {
  CONIC_TRANSPARENCY_NONE = 0,   /* not at all: opacities only weigh splats within their surface, and alpha is
                                    ignored */
  CONIC_TRANSPARENCY_LAYERS = 1, /* each pixel's surfaces one over the other */
  CONIC_TRANSPARENCY_CHANCE = 2  /* each pixel shows one of its surfaces, or none; the mean over all chances is LAYERS'
                                    rgba. For samples that are changed by their depths and normals */
} conic_transparency;

#define CONIC_N_TRANSPARENCIES 3

/* conic_render_drawing with transparency. `chance`, in [0, 1), decides which surfaces CHANCE shows, differently in each
 * pixel; the other kinds ignore it. Where nothing in the drawing lets light through, the picture is
 * conic_render_drawing's, bit for bit. Takes memory for a mask of the picture and for all projected splats besides.
 * Errors: as there, and ARGUMENT (options->passes is not 3; an unknown kind; a chance out of range). */
CONIC_API conic_status conic_render_transparent(conic_context *context, conic_renderer *renderer,
                                                const conic_drawing *drawing, const conic_camera *camera,
                                                const conic_render_options *options, conic_transparency transparency,
                                                double chance, int samples, conic_image *image,
                                                conic_render_statistics *statistics);

/* Whether a drawing lets light through anywhere. */
CONIC_API int conic_drawing_is_transparent(const conic_drawing *drawing);

CONIC_END_C
#endif
