/* sRGB to linear and back, with the same bits on every machine (only + − × ÷ √). */
#pragma once

#include <stdint.h>

/* The transfer curve and its inverse, for any value; below 0 both are linear. NaN stays NaN. Error under 1e-15
 * relative inside. */
double conic_srgb_decode(double encoded);
double conic_srgb_encode(double linear);

/* Linear RGB, clamped to 0 to 1, as lightness and two more axes of OKLab (Ottosson, 2020), where equal distances look
 * equally large: 1 between black and white, about 0.02 for a step that is just visible. */
void conic_oklab_of(const double linear[3], double lab[3]);

/* The linear values of the 8-bit codes. */
void conic_srgb_decode_table(float table[256]);

/* The 8-bit code whose value is nearest on the encoded scale: round(255·encode(linear)), clamped; NaN gives 0.
 * `thresholds` comes from conic_srgb_thresholds: thresholds[i] is the least linear value of code i + 1. */
void conic_srgb_thresholds(float thresholds[255]);
uint8_t conic_srgb_code(const float thresholds[255], float linear);

/* An exposure in stops, -100 to 100, as a factor: 2^stops. */
float conic_exposure_factor(double stops);
