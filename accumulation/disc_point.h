/* Points of a disc by two numbers of the sequence: a lens, the sun. */
#ifndef CONIC_DISC_POINT_H
#define CONIC_DISC_POINT_H

/* Of the unit disc, by squares about its centre that become circles, which keeps areas and what is near (Shirley and
 * Chiu, "A low distortion map between disk and square", 1997). u and v are in [0, 1). */
void conic_disc_point(double u, double v, double point[2]);

#endif
