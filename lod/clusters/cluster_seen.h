/* Colours of a mesh as they are seen: in steps of a hundredth of the way from black to white in OKLab, of which two are
 * just visible. */
#ifndef CONIC_CLUSTER_SEEN_H
#define CONIC_CLUSTER_SEEN_H

#include <math.h>

#include "lod/clusters/cluster.h"

/* From black to white; and what is just visible. */
#define CONIC_SEEN_STEPS 100.0
#define CONIC_JUST_VISIBLE 2.0

/* Whether a mesh has more than one colour at all; and whether that is by textures. */
int conic_has_seen_colors(const conic_triangles *triangles);
int conic_has_textures(const conic_triangles *triangles);

/* A place of a triangle whose corners are vertices of the mesh, at most one of each place. */
typedef struct conic_seen_place {
  uint32_t corners[3], material;
  double bary[3];
} conic_seen_place;

/* The colour there, in steps; of a texture unfiltered. */
void conic_seen_color(const conic_triangles *triangles, const conic_seen_place *place, double steps[3]);

/* The greatest difference of colours within a face, by its corners and what of its texture lies between. */
double conic_seen_contrast(const conic_triangles *triangles, size_t face);

/* What a place of the mesh has become on a triangle: by how many steps its colour differs, and that times the length
 * over which it does. `contrast` is that of its surroundings: a texture that slid by a length differs by as much along
 * its edges, over that length. */
typedef struct conic_seen_change {
  double steps, smear;
} conic_seen_change;

/* No less than the number, and finite. */
static inline float conic_seen_float(double number) {
  return number < 1e37 ? (float)(number * (1.0 + 1e-6)) : 1e37f;
}

/* Means of squares over an area. */
typedef struct conic_seen_sums {
  double area, steps2, smear2;
} conic_seen_sums;

static inline void conic_seen_sums_add(conic_seen_sums *sums, conic_seen_change change, double area) {
  sums->area += area;
  sums->steps2 += area * change.steps * change.steps;
  sums->smear2 += area * change.smear * change.smear;
}

/* The root mean squares, where these are more than what is known. */
static inline conic_seen_change conic_seen_sums_change(const conic_seen_sums *sums, conic_seen_change known) {
  double steps = sums->area > 0.0 ? sqrt(sums->steps2 / sums->area) : 0.0;
  double smear = sums->area > 0.0 ? sqrt(sums->smear2 / sums->area) : 0.0;
  return (conic_seen_change){steps > known.steps ? steps : known.steps, smear > known.smear ? smear : known.smear};
}

conic_seen_change conic_seen_change_of(const conic_triangles *triangles, const conic_seen_place *before,
                                       double contrast, const conic_seen_place *now);

/* Where on a triangle it is nearest to a place: barycentric coordinates, and the squared distance, as
 * conic_distance2_to_triangle has it. */
double conic_seen_nearest(const double at[3], const double *const corners[3], double bary[3]);

#endif
