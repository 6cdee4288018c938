/* Pictures of Gaussian scenes as GPU viewers make them: set up in a compute shader, sorted by the CPU, composited tile
 * by tile in a fragment shader, or by blending quads; all in float, on whatever OpenGL there is. Nothing is shared with
 * conic. */
#pragma once

#include "tests/judge/plain_scene.h"

typedef struct gl_order {
  const char *folder; /* of the shaders */
  const char *profile;
  unsigned faults; /* the scene was read with the same */
} gl_order;

/* Over black, on what gl_open opened. `picture` has the camera's size; its count is left alone. Ends the process, with
 * a message, where it cannot. */
void gl_draw(const gl_order *order, const plain_scene *scene, const plain_camera *camera, plain_picture *picture);
