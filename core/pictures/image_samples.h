/* Converts between the rgba plane (linear, premultiplied floats) and the samples of image formats. */
#pragma once

#include "conic/image.h"

typedef struct conic_samples_layout {
  int n_channels;   /* 1: grey; 2: grey, alpha; 3: R, G, B; 4: R, G, B, A; more: the rest is ignored */
  int sample_bytes; /* 1 or 2: unsigned, colour sRGB-encoded, alpha not; 4: linear floats */
  int is_straight;  /* the colour is not multiplied by alpha */
  int is_display;   /* the plane's colours are display values: neither sRGB-encoded nor decoded */
  conic_tone tone;  /* the curve from linear colours to codes */
} conic_samples_layout;

static inline int conic_samples_have_alpha(conic_samples_layout layout) {
  return layout.n_channels == 2 || layout.n_channels >= 4;
}

/* Fills width × height × n_channels samples; the layout has 3 or 4 channels. Without alpha, the colour is the picture
 * over black. Codes are the nearest on the encoded scale, clamped; NaN gives 0, and so does the colour where alpha is
 * 0. */
void conic_samples_from_rgba(conic_context *context, const float *rgba, int width, int height,
                             conic_samples_layout layout, void *samples);

/* One row of it, of 8 bits a code, by tables that are filled once. */
typedef struct conic_samples_tables {
  float thresholds[255]; /* of linear light, between the codes */
  uint8_t first[4096];   /* the code at the lower end of each of so many equal steps of it */
  float decoded[256];
} conic_samples_tables;

void conic_samples_tables_fill(conic_samples_tables *tables);
void conic_samples_row_from_rgba(const conic_samples_tables *tables, conic_samples_layout layout, const float *rgba,
                                 size_t width, void *samples);

/* The reverse; missing alpha is 1. */
void conic_samples_to_rgba(conic_context *context, const void *samples, int width, int height,
                           conic_samples_layout layout, float *rgba);
