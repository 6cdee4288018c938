/* Colours of a mesh as they are seen. A step is a hundredth of the way from black to white in OKLab; two steps are just
 * visible. */
#pragma once

#include "lod/clusters/cluster.h"

/* From black to white; and what is just visible. */
#define CONIC_SEEN_STEPS 100.0
#define CONIC_JUST_VISIBLE 2.0

/* Whether a mesh has more than one colour at all; and whether that is by textures. */
int conic_has_seen_colors(const conic_triangles *triangles);
int conic_has_textures(const conic_triangles *triangles);

/* A place of a triangle. Its corners are vertices of the mesh at three different places. */
typedef struct conic_seen_place {
  uint32_t corners[3], material;
  double bary[3];
} conic_seen_place;

/* The colour there, in steps; of a texture unfiltered. */
void conic_seen_color(const conic_triangles *triangles, const conic_seen_place *place, double steps[3]);

/* The greatest difference of colours within a face, by its corners and by the texture between them. */
double conic_seen_contrast(const conic_triangles *triangles, size_t face);

/* How a colour has changed: by how many steps it differs, and that times the length over which it does. */
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

/* What a place of the mesh has become on a triangle. `contrast` is that of its surroundings: along its edges, a texture
 * that slid by a length differs by as much, over that length. */
conic_seen_change conic_seen_change_of(const conic_triangles *triangles, const conic_seen_place *before,
                                       double contrast, const conic_seen_place *now);

/* The point of a triangle that is nearest to a place, in barycentric coordinates. Returns the squared distance, as
 * conic_distance2_to_triangle has it. */
double conic_seen_nearest(const double at[3], const double *const corners[3], double bary[3]);
