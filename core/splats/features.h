/* Sharp features: where a surface has creases, and the clip lines that splats get there (docs/notes/features.md). */
#ifndef CONIC_FEATURES_H
#define CONIC_FEATURES_H

#include <stdint.h>

#include "conic/model.h"

/* A crease as one of the splats at a split vertex sees it: `mate` stands at the same place on the other side, and
 * `inside` is a vertex on the splat's own side. */
typedef struct conic_crease {
  uint32_t wedge, mate, inside;
} conic_crease;

typedef struct conic_creases {
  size_t n;
  conic_crease *all; /* in order of their wedges */
  size_t *starts;    /* those of vertex i are all[starts[i] … starts[i + 1]) */
} conic_creases;

/* Copies a mesh so that every vertex is in faces of one smooth piece only: faces that meet at an edge by no more than
 * the angle of that cosine hang together, and a vertex that is on several pieces becomes one vertex a piece. The first
 * keeps its number, the others come after all vertices. On success the caller owns *split and *creases. Errors:
 * ARGUMENT, MEMORY. */
conic_status conic_creases_split(conic_context *context, double cosine, const conic_model *model, conic_model *split,
                                 conic_creases *creases);
void conic_creases_release(conic_context *context, conic_creases *creases);

/* Gives the vertices of a split mesh, which have their axes, the clip lines of the creases that they and the vertices
 * next to them are on. Errors: MEMORY. */
conic_status conic_creases_clip(conic_context *context, const conic_creases *creases, double cutoff,
                                conic_model *split);

/* Finds creases among points that have axes: where the planes of neighbours meet at more than the angle of that cosine.
 * Splats there are turned into the plane that their side lies in, made large enough to reach the crease, and clipped at
 * it. Errors: ARGUMENT, MEMORY, CANCELLED. */
conic_status conic_features_in_points(conic_context *context, double cosine, const conic_estimate_options *options,
                                      conic_splats *splats);

/* A choice of clip lines for one splat. */
typedef struct conic_clip_choice {
  int n;                /* candidates */
  float lines[16][3];   /* the nearest 16 at most */
  double distances[16]; /* of the centre, in units of the axes */
} conic_clip_choice;

/* Notes the line (a, b, c) as a candidate unless it is farther than `reach` or has hardly any direction. */
void conic_clip_choice_add(conic_clip_choice *choice, const double line[3], double reach);

/* The lines that leave all of the places (u, v): those of the two nearest directions, combined by AND or else OR, or
 * else one of them. A place may be cut by `slack` of its own distance. Returns 0 where none does. */
int conic_clip_choose(const conic_clip_choice *choice, const double (*places)[2], size_t n_places, double slack,
                      conic_clip *clip);

#endif
