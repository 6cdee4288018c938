/* What of C's <math.h> the shared text uses. OpenCL C's functions go by their argument's type. */
#ifndef CONIC_MATH_H
#define CONIC_MATH_H

#define sqrtf(x) sqrt((float)(x))
#define fabsf(x) fabs((float)(x))
#define floorf(x) floor((float)(x))

#endif
