/* A framed camera's direction, and its distance. */
#pragma once

#include "conic/camera.h"

/* Checks the framing and copies it to *own. Errors: ARGUMENT. */
conic_status conic_framing_take(conic_context *context, const conic_framing *given, conic_framing *own);

/* The rows of the camera's rotation: right, down and forward in the world. */
void conic_framing_rotation(const conic_framing *framing, double rows[3][3]);

/* The camera that looks along `rows` with the framing's focal length and sees the world's point `center` at the camera
 * coordinates `at`. */
void conic_framing_camera(const conic_framing *framing, double rows[3][3], const double center[3], const double at[3],
                          conic_camera *camera);

/* The tangent of half the angle of `length` pixels about the middle of the framing's picture, at zoom 1. */
double conic_framing_tangent(const conic_framing *framing, double length);

/* The part of a picture's width or height that the scene fills, at zoom 1. */
#define CONIC_FRAMING_PART 0.9
