/* The direction from which a scan's points were seen. */
#ifndef CONIC_SIGHT_H
#define CONIC_SIGHT_H

/* The unit vector from a point towards the scanner; zero where that is too far for a scanner, whose place in the file
 * must then be wrong. */
void conic_sight_find(const double scanner[3], const double point[3], double sight[3]);

#endif
