#include "tests/judge/gl_device.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <stdio.h>
#include <string.h>

#include "tests/judge/plain_scene.h"

void *gl_allocate(size_t n, size_t size) {
  void *all = calloc(n ? n : 1, size);
  if (!all)
    plain_give_up("memory", "there is not enough");
  return all;
}

int gl_open(const char **reason) {
  static const EGLint wanted[] = {
      EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  const char *has = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  *reason = "EGL has no platform without a surface (EGL_MESA_platform_surfaceless)";
  if (!has || !strstr(has, "EGL_MESA_platform_surfaceless"))
    return 0;
  EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
  *reason = "EGL finds no driver (Debian: libegl-mesa0, libgl1-mesa-dri)";
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, NULL, NULL))
    return 0;
  *reason = "there is no OpenGL 4.3";
  if (!eglBindAPI(EGL_OPENGL_API))
    return 0;
  EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted);
  return context != EGL_NO_CONTEXT && eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
}

/* The whole text of a shader, which the caller frees. */
static char *read_shader(const char *folder, const char *name) {
  char path[4096];
  snprintf(path, sizeof path, "%s/%s.glsl", folder, name);
  FILE *file = fopen(path, "rb");
  size_t room = 1 << 16;
  char *text = gl_allocate(room, 1);
  if (!file || fread(text, 1, room - 1, file) == 0)
    plain_give_up(path, "cannot be read");
  fclose(file);
  return text;
}

static void attach_shader(GLuint program, GLenum kind, const char *folder, const char *constants, const char *name) {
  char *text = read_shader(folder, name), words[4096] = "";
  const char *parts[] = {"#version 430 core\n", constants, "#line 1\n", text};
  GLuint shader = glCreateShader(kind);
  GLint is_right;
  glShaderSource(shader, 4, parts, NULL);
  glCompileShader(shader);
  glGetShaderiv(shader, GL_COMPILE_STATUS, &is_right);
  glGetShaderInfoLog(shader, sizeof words, NULL, words);
  if (!is_right)
    plain_give_up(name, words);
  glAttachShader(program, shader);
  glDeleteShader(shader);
  free(text);
}

static void link_program(GLuint program) {
  char words[4096] = "";
  GLint is_right;
  glLinkProgram(program);
  glGetProgramiv(program, GL_LINK_STATUS, &is_right);
  glGetProgramInfoLog(program, sizeof words, NULL, words);
  if (!is_right)
    plain_give_up("program", words);
}

/* Compiling takes longer than a small picture. */
static GLuint find_program(const char *constants, const char *name, int *is_new) {
  enum { MOST = 64, ROOM = 2048 };
  static char keys[MOST][ROOM];
  static GLuint programs[MOST];
  char key[ROOM];
  int i = 0;
  snprintf(key, sizeof key, "%s\n%s", name, constants);
  while (i + 1 < MOST && programs[i] && strcmp(keys[i], key) != 0)
    i++;
  *is_new = !programs[i] || strcmp(keys[i], key) != 0;
  if (*is_new) {
    snprintf(keys[i], sizeof keys[i], "%s", key);
    programs[i] = glCreateProgram();
  }
  return programs[i];
}

GLuint gl_compute_program(const char *folder, const char *constants, const char *name) {
  int is_new;
  GLuint program = find_program(constants, name, &is_new);
  if (is_new) {
    attach_shader(program, GL_COMPUTE_SHADER, folder, constants, name);
    link_program(program);
  }
  glUseProgram(program);
  return program;
}

GLuint gl_drawing_program(const char *folder, const char *constants, const char *vertex, const char *fragment) {
  int is_new;
  GLuint program = find_program(constants, fragment, &is_new);
  if (is_new) {
    attach_shader(program, GL_VERTEX_SHADER, folder, constants, vertex);
    attach_shader(program, GL_FRAGMENT_SHADER, folder, constants, fragment);
    link_program(program);
  }
  glUseProgram(program);
  return program;
}

GLuint gl_buffer(GLuint binding, size_t bytes, const void *data) {
  GLuint buffer;
  glGenBuffers(1, &buffer);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer);
  glBufferData(GL_SHADER_STORAGE_BUFFER, (GLsizeiptr)(bytes ? bytes : 4), data, GL_STATIC_DRAW);
  return buffer;
}

void gl_targets(int width, int height, GLuint framebuffer_and_planes[3]) {
  static const GLenum both[2] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  GLuint vertices, *planes = framebuffer_and_planes + 1;
  glGenVertexArrays(1, &vertices); /* without one, nothing is drawn */
  glBindVertexArray(vertices);
  glGenFramebuffers(1, framebuffer_and_planes);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_and_planes[0]);
  glGenTextures(2, planes);
  for (int i = 0; i < 2; i++) {
    glBindTexture(GL_TEXTURE_2D, planes[i]);
    glTexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA32F, width, height);
    glFramebufferTexture2D(GL_FRAMEBUFFER, both[i], GL_TEXTURE_2D, planes[i], 0);
  }
  glDrawBuffers(2, both);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    plain_give_up("OpenGL", "has no planes of four floats");
  glViewport(0, 0, width, height);
  glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
  glClear(GL_COLOR_BUFFER_BIT);
}
