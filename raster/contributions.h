/* The inside of a frame's contributions. */
#ifndef RASTER_CONTRIBUTIONS_H
#define RASTER_CONTRIBUTIONS_H

#include "conic/contributions.h"
#include "raster/coverage.h"

/* Rows of the picture whose splats are listed together. */
enum { CONIC_CONTRIBUTION_BAND = 8 };

struct conic_contributions {
  conic_context *context;
  const conic_splats *splats;
  conic_render_options options;
  conic_view view;
  conic_projected projected;
  size_t *band_begin; /* band b's splats are references[band_begin[b] … band_begin[b + 1]), in the order of the set */
  uint32_t *references;     /* indices of footprints */
  conic_contribution *list; /* of the last pixel that was asked for */
  size_t list_room;
};

/* The footprint at a pixel, which it covers: everything but the verdict. */
conic_contribution conic_contribution_of(const conic_contributions *contributions, uint32_t i_footprint, int x, int y,
                                         const conic_fragment *fragment);

/* By what a fragment hides others, and by what it is seen: docs/picture.md, "Visible". */
static inline float conic_hiding_iz(const conic_footprint *footprint, const conic_fragment *fragment) {
  return footprint->nearness * (fragment->plane_iz < fragment->iz ? fragment->plane_iz : fragment->iz);
}

static inline float conic_seen_iz(const conic_fragment *fragment) {
  return fragment->plane_iz > fragment->iz ? fragment->plane_iz : fragment->iz;
}

#endif
