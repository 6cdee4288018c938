/* Directions and ellipses as few bits, and back. Only + - x / and roots: the same bits everywhere. */
#pragma once

#include "conic/splats.h"
#include "lod/layers/format/layers_schema.h"

/* Codes a normal of any length but zero as two coordinates of the octahedron; and finds the unit normal of a code. */
void conic_layers_code_normal(const float normal[3], uint8_t code[2]);
void conic_layers_normal_of(const uint8_t code[2], float normal[3]);

/* Likewise of half 32767. */
void conic_layers_code_fine_normal(const float normal[3], uint16_t code[2]);
void conic_layers_fine_normal_of(const uint16_t code[2], float normal[3]);

/* Two unit vectors that make a frame with any unit normal. Each half of the sphere has a rule of its own, in which
 * nothing cancels. */
void conic_layers_frame(const float normal[3], float u[3], float v[3]);

/* Codes both axes as lengths, normal and turn. The second becomes orthogonal to the first. 0: they span no plane. */
int conic_layers_code_axes(const float u[3], const float v[3], conic_layers_axes *axes);

/* Unit vectors along both axes. */
void conic_layers_axes_of(const conic_layers_axes *axes, float u[3], float v[3], float normal[3]);

/* A size as the upper half of a float's bits, not rounded down; 0: it is none. And back. */
uint16_t conic_layers_code_size(float size);
float conic_layers_size_of(uint16_t code);

/* Clip lines, in units of the axes, as codes and back; the record's index is the caller's. */
void conic_layers_code_lines(const conic_clip *clip, conic_layers_lines *lines);
int conic_layers_lines_of(const conic_layers_lines *lines, conic_clip *clip);
