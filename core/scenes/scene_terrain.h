/* The terrain's heights: an island of fractal mountains in a flat sea. */
#pragma once

#include <stdint.h>

typedef struct conic_terrain_place {
  double ground;     /* height of the ground above the sea, which is at 0; negative under it */
  double height;     /* of the surface: the ground or the sea */
  double slope[2];   /* its derivatives by x and z */
  double ruggedness; /* how steep the large forms are, from 0 on */
} conic_terrain_place;

/* The terrain of that seed at (x, z). */
void conic_terrain_at(uint64_t seed, double x, double z, conic_terrain_place *place);
