/* Turns what the points of a surface receive into what the pixels of a picture receive. */
#ifndef CONIC_EDGE_SPREAD_H
#define CONIC_EDGE_SPREAD_H

#include "core/image/camera_rays.h"
#include "lighting/receivers.h"

typedef struct conic_edge_spread {
  conic_context *context;
  const conic_image *image;
  const conic_receivers *receivers;
  conic_camera_rays rays;
  float epsilon;       /* the casters' */
  int samples;         /* N × N of the picture's pixel */
  size_t edge_px;      /* how far splats may stick out */
  unsigned char *kind; /* of each pixel */
  float *own;          /* of each pixel that is a receiver: what it received */
  float *filled;       /* of each pixel: what it gets from that */
  float otherwise;     /* for pixels that get nothing */
} conic_edge_spread;

/* Finds which pixels of the picture, which has Z and N, are at edges. Keeps references to the arguments. Errors:
 * MEMORY; the caller releases it then, too. */
conic_status conic_edge_spread_init(conic_context *context, const conic_camera *camera, const conic_image *image,
                                    const conic_receivers *receivers, double epsilon, int samples,
                                    conic_edge_spread *spread);

/* Fills `filled` from what the receivers received, each at least 0; `otherwise` for pixels without receivers at or
 * around them. */
void conic_edge_spread_fill(conic_edge_spread *spread, const float *of_receivers, float otherwise);

void conic_edge_spread_release(conic_edge_spread *spread);

#endif
