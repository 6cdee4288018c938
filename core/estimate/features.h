/* Sharp features: creases of a surface, and the clip lines that splats get there (docs/notes/features.md). */
#pragma once

#include "conic/model.h"

/* Finds creases among points that have axes: places where the planes of neighbours meet at more than the angle of that
 * cosine. Splats there are turned into the plane of their side, made large enough to reach the crease, and clipped at
 * it. With are_sides the splats' planes are those of their sides already, also near creases; else the planes are found
 * anew from the points. Errors: ARGUMENT, MEMORY, CANCELLED. */
conic_status conic_features_in_points(conic_context *context, double cosine, int are_sides,
                                      const conic_estimate_options *options, conic_splats *splats);

/* A choice of clip lines for one splat. */
typedef struct conic_clip_choice {
  int n;                /* candidates */
  float lines[16][3];   /* the nearest 16 at most */
  double distances[16]; /* from the centre, in units of the axes */
  double lost_share;    /* the share of the places that lines may cut off, if their directions are sure; 0: none */
} conic_clip_choice;

/* Notes the line (a, b, c) as a candidate, unless it is farther than `reach` or has hardly any direction. */
void conic_clip_choice_add(conic_clip_choice *choice, const double line[3], double reach);

/* Chooses lines that keep all of the places (u, v): those of the two nearest directions, combined by AND or else OR, or
 * else one of them. A place may be cut by `slack` of its own distance. Returns 0 where no choice does. */
int conic_clip_choose(const conic_clip_choice *choice, const double (*places)[2], size_t n_places, double slack,
                      conic_clip *clip);
