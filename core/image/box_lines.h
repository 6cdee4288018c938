/* Boxes in a picture, as lines. */
#pragma once

#include "conic/image.h"

/* Paints the twelve edges of a box, from its low corner to its high one in the world, into the plane rgba of a map of
 * the camera's size; fainter where they lie behind the depths z of what is drawn. Nothing nearer than near_z shows. */
void conic_box_lines_paint(const conic_camera *camera, double near_z, const float *z, conic_image *map,
                           const double box[2][3], const float color[3]);
