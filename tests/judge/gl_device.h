/* OpenGL without a display, for the tests' own renderer: on a machine without a GPU it is Mesa's llvmpipe. */
#pragma once

#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>
#include <stddef.h>

/* Makes a context of OpenGL 4.3 current, which stays to the end of the process. 0: there is none; `reason` then says
 * why. */
int gl_open(const char **reason);

/* Makes current a program of the shaders FOLDER/NAME.glsl, each after its version and the constants. Programs are kept
 * for who asks for the same again. Ends the process, with the compiler's words, where one is not right. */
GLuint gl_compute_program(const char *folder, const char *constants, const char *name);
GLuint gl_drawing_program(const char *folder, const char *constants, const char *vertex, const char *fragment);

/* A buffer of shaders at a binding; null data: room alone. */
GLuint gl_buffer(GLuint binding, size_t bytes, const void *data);
/* Two planes of four floats a pixel, as what is drawn into, all zero. */
void gl_targets(int width, int height, GLuint framebuffer_and_planes[3]);

/* Zeroed; ends the process where there is not enough. */
void *gl_allocate(size_t n, size_t size);
