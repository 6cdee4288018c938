/* Points of a disc (a lens, the sun) from two numbers of the sequence. */
#pragma once

/* A point of the unit disc. Squares about the square's centre become circles; areas and neighbourhoods are kept
 * (Shirley and Chiu, "A low distortion map between disk and square", 1997). u and v are in [0, 1). */
void conic_disc_point(double u, double v, double point[2]);
