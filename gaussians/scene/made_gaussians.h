/* A scene of Gaussians that is like what is trained from photographs, and needs no file. */
#pragma once

#include "conic/gaussians.h"

/* Balls on a floor, in the frame "rdf", within 4.3 of the origin; 1 in 20 Gaussians floats about them. Most are flat,
 * lie in a surface and cover their neighbours; a third is faint. In no order, of a colour by place, and with harmonics
 * that fall off by degree. The same of one seed on every machine. On success the caller owns *gaussians; on failure it
 * is empty. Errors: ARGUMENT (the degree, or no or over 2³¹ − 1 Gaussians), MEMORY. */
conic_status conic_gaussians_make(conic_context *context, size_t count, int sh_degree, uint64_t seed,
                                  conic_gaussians *gaussians);
