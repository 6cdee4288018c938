/* Colour ramps: a line through a few colours of OKLab (Ottosson, 2020), where equal steps look equally large; and a
 * palette of classes. Linear RGB from 0 to 1, computed by + − × ÷ alone. */
#pragma once

#include <stdint.h>

typedef enum conic_ramp {
  CONIC_RAMP_SEQUENTIAL = 0, /* dark violet to light yellow */
  CONIC_RAMP_GREY = 1,
  CONIC_RAMP_HEAT = 2,      /* black to yellow through red */
  CONIC_RAMP_DIVERGING = 3, /* blue to red through white */
  CONIC_RAMP_TERRAIN = 4,   /* green to white through brown */
  CONIC_RAMP_VIRIDIS = 5,   /* as others have them: */
  CONIC_RAMP_MAGMA = 6,
  CONIC_RAMP_TURBO = 7,
  CONIC_RAMP_CLASSES = 8, /* no ramp: a colour for each whole number, as in LAS (ASPRS) up to 22 */
  CONIC_N_RAMPS = 9
} conic_ramp;

/* At t from 0 to 1; beyond, the nearer end's colour. Not for classes. */
void conic_ramp_color(conic_ramp ramp, double t, float linear[3]);

/* The colour of a class; from 23 on, eight colours in turn. */
void conic_class_color(uint32_t number, float linear[3]);

/* A bright colour for a number, unlike its neighbours' colours. */
void conic_number_color(uint32_t number, float linear[3]);

/* "ground", "water" …; null from 23 on. */
const char *conic_class_name(uint32_t number);
