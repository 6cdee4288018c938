/* From where the points of a scan were seen. */
#ifndef CONIC_SIGHT_H
#define CONIC_SIGHT_H

/* The unit vector from a point towards the scanner; zero where the scanner cannot have seen so far, so that it is not
 * where the file has it. */
void conic_sight_find(const double scanner[3], const double point[3], double sight[3]);

#endif
