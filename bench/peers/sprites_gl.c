/* A GPU's answer to splats: point sprites of OpenGL, whose fragments meet the disc with the pixel's ray. The first pass
 * finds the nearest depths and adds a disc's radius to them, the second adds up, by a Gaussian, what lies before these;
 * then sums are divided. Without a GPU this is Mesa's llvmpipe. Prints what uploading and a frame took, as a median, in
 * milliseconds, and writes the picture.
 *
 *   sprites_gl SPLATS.ply CAMERA OUT.pfm FRAMES       arguments as those of discs_embree.c; its shaders lie beside it:
 *                                                     PEER_SHADERS, when it is compiled */
#include <stddef.h>

#include "peer_scene.h"
#include "tests/judge/gl_device.h"

typedef struct sprite {
  float position[3], normal[3], radius, color[3];
} sprite;

static void upload_sprites(const peer_splat *splats, unsigned n) {
  static const struct {
    int n;
    size_t offset;
  } fields[] = {{3, offsetof(sprite, position)},
                {3, offsetof(sprite, normal)},
                {1, offsetof(sprite, radius)},
                {3, offsetof(sprite, color)}};
  float linear_of[256];
  sprite *sprites = gl_allocate(n, sizeof *sprites);
  GLuint buffer;
  fill_linear(linear_of);
  for (unsigned i = 0; i < n; i++) {
    memcpy(&sprites[i], &splats[i], offsetof(sprite, color));
    for (int k = 0; k < 3; k++)
      sprites[i].color[k] = linear_of[splats[i].color[k]];
  }
  glGenBuffers(1, &buffer);
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(n * sizeof *sprites), sprites, GL_STATIC_DRAW);
  for (GLuint i = 0; i < 4; i++) {
    glEnableVertexAttribArray(i);
    glVertexAttribPointer(i, fields[i].n, GL_FLOAT, GL_FALSE, sizeof *sprites, (const void *)fields[i].offset);
  }
  glFinish();
  free(sprites);
}

static GLuint use_program(const peer_camera *c) {
  GLuint program = gl_drawing_program(PEER_SHADERS, "", "sprites_vertex", "sprites_fragment");
  float columns[12];
  for (int i = 0; i < 12; i++)
    columns[i] = (float)c->world_to_camera[i % 3][i / 3];
  glUniformMatrix4x3fv(glGetUniformLocation(program, "camera_from_world"), 1, GL_FALSE, columns);
  glUniform2f(glGetUniformLocation(program, "focal"), (float)c->f[0], (float)c->f[1]);
  glUniform2f(glGetUniformLocation(program, "center"), (float)c->c[0], (float)c->c[1]);
  glUniform2f(glGetUniformLocation(program, "size"), (float)c->width, (float)c->height);
  return program;
}

/* The depth beyond which nothing is, for depths from 0 to 1. */
static float farthest_of(const peer_camera *c, const peer_splat *splats, unsigned n) {
  double most = 0.0;
  for (unsigned i = 0; i < n; i++) {
    double z = c->world_to_camera[2][3] + 2.0 * (double)splats[i].radius;
    for (int k = 0; k < 3; k++)
      z += c->world_to_camera[2][k] * (double)splats[i].position[k];
    most = z > most ? z : most;
  }
  return (float)most;
}

static void open_targets(const peer_camera *c) {
  GLuint targets[2], framebuffer;
  glGenFramebuffers(1, &framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glGenTextures(2, targets);
  for (int i = 0; i < 2; i++) {
    glBindTexture(GL_TEXTURE_2D, targets[i]);
    glTexStorage2D(GL_TEXTURE_2D, 1, i ? GL_DEPTH_COMPONENT32F : GL_RGBA32F, c->width, c->height);
    glFramebufferTexture2D(GL_FRAMEBUFFER, i ? GL_DEPTH_ATTACHMENT : GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, targets[i],
                           0);
  }
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    fail_peer("OpenGL has no planes of four floats");
  glViewport(0, 0, c->width, c->height);
}

static void draw_sprites(GLuint program, const peer_camera *c, unsigned n, float *sums, float *rgb) {
  size_t n_pixels = (size_t)c->width * (size_t)c->height;
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  glClear(GL_DEPTH_BUFFER_BIT);
  glUniform1i(glGetUniformLocation(program, "is_visibility"), 1);
  glDrawArrays(GL_POINTS, 0, (GLsizei)n);
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glClear(GL_COLOR_BUFFER_BIT);
  glUniform1i(glGetUniformLocation(program, "is_visibility"), 0);
  glDrawArrays(GL_POINTS, 0, (GLsizei)n);
  glReadPixels(0, 0, c->width, c->height, GL_RGBA, GL_FLOAT, sums);
  for (size_t i = 0; i < n_pixels; i++)
    for (size_t k = 0; k < 3; k++)
      rgb[3 * i + k] = sums[4 * i + 3] > 0.0f ? sums[4 * i + k] / sums[4 * i + 3] : 0.0f;
}

int main(int argc, char **argv) {
  unsigned n;
  peer_camera c;
  const char *reason;
  if (argc != 5)
    fail_peer("usage: sprites_gl SPLATS.ply CAMERA OUT.pfm FRAMES");
  if (!gl_open(&reason))
    fail_peer(reason);
  peer_splat *splats = read_splats(argv[1], &n);
  read_peer_camera(argv[2], &c);
  int n_frames = atoi(argv[4]);
  if (!splats || n_frames < 1)
    fail_peer("no splats, or no frames");
  GLuint vertices;
  glGenVertexArrays(1, &vertices);
  glBindVertexArray(vertices);
  double start = spent_ms();
  upload_sprites(splats, n);
  double uploaded = spent_ms() - start;
  open_targets(&c);
  GLuint program = use_program(&c);
  glUniform1f(glGetUniformLocation(program, "farthest"), farthest_of(&c, splats, n));
  glEnable(GL_PROGRAM_POINT_SIZE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glBlendFunc(GL_ONE, GL_ONE);
  glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
  float *sums = gl_allocate((size_t)c.width * (size_t)c.height, 4 * sizeof *sums);
  float *rgb = gl_allocate((size_t)c.width * (size_t)c.height, 3 * sizeof *rgb);
  double *ms = gl_allocate((size_t)n_frames, sizeof *ms);
  draw_sprites(program, &c, n, sums, rgb); /* which compiles */
  for (int frame = 0; frame < n_frames; frame++) {
    double begun = spent_ms();
    draw_sprites(program, &c, n, sums, rgb);
    ms[frame] = spent_ms() - begun;
  }
  qsort(ms, (size_t)n_frames, sizeof *ms, compare_ms);
  write_peer_picture(argv[3], &c, rgb);
  printf("%.2f %.2f\n", uploaded, ms[n_frames / 2]);
  return 0;
}
