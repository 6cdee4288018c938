/* Polygons of a mesh, which become triangles. */
#pragma once

#include "conic/model.h"

/* The model's triangles from `first` on are the fan of one polygon, about its first corner. Where that reaches outside
 * it, for it is not convex, they become others that do not, with what else the faces have. A polygon of more than 256
 * corners, or one that crosses itself, or of vertices that were not read yet, stays the fan. */
void conic_polygon_settle(conic_model *model, size_t first);
