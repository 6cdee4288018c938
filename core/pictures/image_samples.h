/* Between the rgba plane (linear, premultiplied floats) and the samples that image formats hold. */
#ifndef CONIC_IMAGE_SAMPLES_H
#define CONIC_IMAGE_SAMPLES_H

#include <stddef.h>

#include "conic/image.h"

typedef struct conic_samples_layout {
  int n_channels;   /* 1: grey; 2: grey, alpha; 3: R, G, B; 4: R, G, B, A; more: the rest is not looked at */
  int sample_bytes; /* 1 or 2: unsigned, colour sRGB-encoded, alpha not; 4: linear floats */
  int is_straight;  /* the colour is not multiplied by alpha */
  int is_display;   /* the colours of the plane are display values: they are neither sRGB-encoded nor decoded */
  conic_tone tone;  /* through which linear colours go on their way to codes */
} conic_samples_layout;

static inline int conic_samples_have_alpha(conic_samples_layout layout) {
  return layout.n_channels == 2 || layout.n_channels >= 4;
}

/* Fills width × height × n_channels samples; the layout has 3 or 4 channels. Without alpha the colour is what the
 * picture shows over black. Codes are the nearest on the encoded scale, clamped; NaN gives 0, and so does the colour
 * where alpha is 0. */
void conic_samples_from_rgba(conic_context *context, const float *rgba, int width, int height,
                             conic_samples_layout layout, void *samples);

/* The way back; missing alpha is 1. */
void conic_samples_to_rgba(conic_context *context, const void *samples, int width, int height,
                           conic_samples_layout layout, float *rgba);

#endif
