/* A gradient behind a picture. */
#pragma once

#include "conic/image.h"

/* Puts premultiplied colours over a gradient from `top` to `bottom`, which is linear in linear light and sampled in the
 * middle of each row; `exposure` multiplies it. Pictures without rgba stay. */
void conic_backdrop_put(const float top[3], const float bottom[3], float exposure, conic_image *image);
