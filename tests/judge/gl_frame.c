#include "tests/judge/gl_frame.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "tests/judge/gl_device.h"

enum { CONSTANTS_ROOM = 4096 };

/* What distinguishes the profiles. */
typedef struct gl_profile {
  const char *name, *is_seen, *has_ended, *compensation; /* in GLSL */
  int clamp; /* 1: as inria's, with its tiles and centre; 2: as gsplat's; 0: none, and quads are blended */
  float near_z, dilation, alpha_most;
  int is_by_distance;
} gl_profile;

static const gl_profile profiles[] = {
    {"inria-2023", "z > near_z", "T < 0.0001", NULL, 1, 0.2f, 0.3f, 0.99f, 0},
    {"gsplat-1.5", "z >= near_z", "T <= 0.0001", NULL, 2, 0.01f, 0.3f, 0.999f, 0},
    {"gsplat-1.5-aa", "z >= near_z", "T <= 0.0001", "0.0", 2, 0.01f, 0.3f, 0.999f, 0},
    {"gsplat-1.6", "z >= near_z", "T <= 0.0001", NULL, 2, 0.01f, 0.3f, 0.99f, 0},
    {"gsplat-1.6-aa", "z >= near_z", "T <= 0.0001", "0.000025", 2, 0.01f, 0.3f, 0.99f, 0},
    {"khr-2026", "z > near_z", "false", NULL, 0, 0.0f, 0.0f, 1.0f, 1},
};
enum { N_PROFILES = sizeof profiles / sizeof *profiles };

typedef struct gl_job {
  const gl_order *order;
  const plain_scene *scene;
  const plain_camera *camera;
  gl_profile profile;
  GLuint buffers[4], targets[3];
} gl_job;

/* As gl_setup.glsl writes it. */
typedef struct gl_splat {
  float place[2], extent[2], form[4], color[4], key[4];
} gl_splat;

static int has(const gl_job *job, plain_fault fault) {
  return plain_has(job->order->faults, fault);
}

static void plant_in_profile(gl_job *job) {
  gl_profile *profile = &job->profile;
  if (has(job, PLAIN_DILATION_0) || has(job, PLAIN_DILATION_0_1))
    profile->dilation = has(job, PLAIN_DILATION_0) ? 0.0f : 0.1f;
  if (has(job, PLAIN_ALPHA_MAX_0_999) || has(job, PLAIN_ALPHA_MAX_0_99))
    profile->alpha_most = has(job, PLAIN_ALPHA_MAX_0_99) ? 0.99f : 0.999f;
  if (has(job, PLAIN_NEAR))
    profile->near_z = profile->clamp == 1 ? 0.01f : 0.2f;
  if (has(job, PLAIN_ORDER_DISTANCE))
    profile->is_by_distance = 1;
}

/* Floats a Gaussian: mean 3, scale 3, quaternion w x y z, opacity, harmonics. */
static size_t floats_between(const plain_scene *scene) {
  return 11 + 3 * (size_t)((scene->sh_degree + 1) * (scene->sh_degree + 1));
}

static void define(char *text, const char *format, ...) {
  va_list arguments;
  size_t n = strlen(text);
  va_start(arguments, format);
  n += (size_t)snprintf(text + n, CONSTANTS_ROOM - n, "#define ");
  n += (size_t)vsnprintf(text + n, CONSTANTS_ROOM - n, format, arguments);
  snprintf(text + n, CONSTANTS_ROOM - n, "\n");
  va_end(arguments);
}

/* What profiles and faults are to the shaders: text, */
static void write_constants(const gl_job *job, char *text) {
  const gl_profile *p = &job->profile;
  const int is_other_falloff = has(job, PLAIN_FALLOFF_RENORMALISED);
  text[0] = '\0';
  define(text, "CLAMP %d", p->clamp);
  define(text, "SH_DEGREE %d", has(job, PLAIN_SH_DEGREE_0) ? 0 : job->scene->sh_degree);
  define(text, "STRIDE %zu", floats_between(job->scene));
  define(text, "IS_SEEN(z) (%s)", p->is_seen);
  define(text, "HAS_ENDED(T) (%s)", p->has_ended);
  define(text, "KEY(p) %s", p->is_by_distance ? "length(p)" : "p.z");
  define(text, "FALLOFF(x) %s", is_other_falloff ? "((exp(x) - exp(-4.0)) / (1.0 - exp(-4.0)))" : "exp(x)");
  define(text, "QUATERNION(q) %s", has(job, PLAIN_QUATERNION_NOT_NORMALISED) ? "q" : "normalize(q)");
  if (p->compensation)
    define(text, "COMPENSATION %s", p->compensation);
}

static void set_number(GLuint program, const char *name, float value) {
  glUniform1f(glGetUniformLocation(program, name), value); /* which does nothing where there is no such name */
}

/* and numbers. */
static void set_profile(GLuint program, const gl_job *job) {
  const gl_profile *p = &job->profile;
  const int ends_at_3 = has(job, PLAIN_EXTENT_3_SIGMA) || p->clamp == 0;
  set_number(program, "near_z", p->near_z);
  set_number(program, "dilation", p->dilation);
  set_number(program, "alpha_most", p->alpha_most);
  set_number(program, "alpha_least", p->clamp ? 1.0f / 255.0f : 0.0f);
  set_number(program, "pixel_centre", (p->clamp == 1) != has(job, PLAIN_HALF_PIXEL) ? 0.0f : 0.5f);
  set_number(program, "least_power", has(job, PLAIN_FALLOFF_RENORMALISED) ? -4.0f : ends_at_3 ? -4.5f : -1e30f);
}

/* The matrix by columns, the eye as −Rᵀ·t. */
static void set_camera(GLuint program, const gl_job *job) {
  const plain_camera *camera = job->camera;
  GLfloat turn[9], shift[3], eye[3], size[2] = {(GLfloat)camera->width, (GLfloat)camera->height};
  const int is_centred = has(job, PLAIN_CENTRE_IGNORED);
  for (int row = 0; row < 3; row++) {
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
      turn[k * 3 + row] = camera->view[row][k];
      sum += (double)camera->view[k][row] * (double)camera->view[k][3];
    }
    shift[row] = camera->view[row][3];
    eye[row] = (GLfloat)-sum;
  }
  glUniformMatrix3fv(glGetUniformLocation(program, "turn"), 1, GL_FALSE, turn);
  glUniform3fv(glGetUniformLocation(program, "shift"), 1, shift);
  glUniform3fv(glGetUniformLocation(program, "eye"), 1, eye);
  glUniform2f(glGetUniformLocation(program, "focal"), camera->fx, camera->fy);
  glUniform2f(glGetUniformLocation(program, "centre"), is_centred ? 0.5f * size[0] : camera->cx,
              is_centred ? 0.5f * size[1] : camera->cy);
  glUniform2fv(glGetUniformLocation(program, "size"), 1, size);
  glUniform1i(glGetUniformLocation(program, "count"), (GLint)job->scene->count);
}

static GLuint upload_scene(const plain_scene *scene) {
  const size_t stride = floats_between(scene);
  float *rows = gl_allocate(scene->count * stride, sizeof *rows);
  for (size_t i = 0; i < scene->count; i++) {
    float *row = rows + i * stride;
    memcpy(row, scene->mean + 3 * i, 3 * sizeof *row);
    memcpy(row + 3, scene->scale + 3 * i, 3 * sizeof *row);
    memcpy(row + 6, scene->rotation + 4 * i, 4 * sizeof *row);
    row[10] = scene->opacity[i];
    memcpy(row + 11, scene->sh + i * (stride - 11), (stride - 11) * sizeof *row);
  }
  GLuint buffer = gl_buffer(0, scene->count * stride * sizeof *rows, rows);
  free(rows);
  return buffer;
}

/* Sets the Gaussians up, and brings what came of it back. */
static gl_splat *set_up(gl_job *job, const char *constants) {
  const size_t bytes = job->scene->count * sizeof(gl_splat);
  GLuint program = gl_compute_program(job->order->folder, constants, "gl_setup");
  gl_splat *splats = gl_allocate(job->scene->count, sizeof *splats);
  job->buffers[0] = upload_scene(job->scene);
  job->buffers[1] = gl_buffer(1, bytes, NULL);
  set_camera(program, job);
  set_profile(program, job);
  glDispatchCompute((GLuint)(job->scene->count + 63) / 64, 1, 1);
  glMemoryBarrier(GL_ALL_BARRIER_BITS);
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, job->buffers[1]);
  glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, (GLsizeiptr)bytes, splats);
  return splats;
}

typedef struct sorted_splat {
  float key;
  int index;
} sorted_splat;

static int compare_keys(const void *left, const void *right) {
  const sorted_splat *a = left, *b = right;
  return a->key != b->key ? (a->key > b->key) - (a->key < b->key) : a->index - b->index;
}

/* Those that are drawn, the nearest first. Returns how many. */
static size_t sort_splats(const gl_job *job, const gl_splat *splats, int *order) {
  sorted_splat *sorted = gl_allocate(job->scene->count, sizeof *sorted);
  size_t n = 0;
  for (size_t i = 0; i < job->scene->count; i++)
    if (splats[i].extent[0] > 0.0f && splats[i].extent[1] > 0.0f)
      sorted[n++] = (sorted_splat){splats[i].key[0], (int)i};
  if (!has(job, PLAIN_ORDER_FILE))
    qsort(sorted, n, sizeof *sorted, compare_keys);
  for (size_t i = 0; i < n; i++)
    order[i] = sorted[i].index;
  free(sorted);
  return n;
}

/* Along an axis, the first tile of 16 pixels that a Gaussian touches, or the one behind the last. */
static int tile_at(const gl_job *job, const gl_splat *s, int axis, int is_behind, int n_tiles) {
  float at = s->place[axis] + (is_behind ? s->extent[axis] : -s->extent[axis]);
  float tile = job->profile.clamp == 1 ? truncf((at + (is_behind ? 15.0f : 0.0f)) / 16.0f)
               : is_behind             ? ceilf(at / 16.0f)
                                       : floorf(at / 16.0f);
  return tile > 0.0f ? tile < (float)n_tiles ? (int)tile : n_tiles : 0;
}

/* Each tile's list, in the order of all. First counts, then fills. */
static void bin_splats(gl_job *job, const gl_splat *splats, const int *order, size_t n, const int n_tiles[2]) {
  size_t n_all = (size_t)n_tiles[0] * (size_t)n_tiles[1];
  int *begin = gl_allocate(n_all + 2, sizeof *begin), *list = NULL;
  for (int pass = 0; pass < 2; pass++) {
    for (size_t i = 0; i < n; i++) {
      const gl_splat *s = splats + order[i];
      const int x[2] = {tile_at(job, s, 0, 0, n_tiles[0]), tile_at(job, s, 0, 1, n_tiles[0])};
      const int y[2] = {tile_at(job, s, 1, 0, n_tiles[1]), tile_at(job, s, 1, 1, n_tiles[1])};
      for (int tile_y = y[0]; tile_y < y[1]; tile_y++)
        for (int tile_x = x[0]; tile_x < x[1]; tile_x++) {
          int *next = begin + tile_y * n_tiles[0] + tile_x + 1; /* where the tile before ended, moves to its end */
          if (list)
            list[*next] = order[i];
          (pass ? next : next + 1)[0]++;
        }
    }
    for (size_t i = 1; pass == 0 && i < n_all + 2; i++)
      begin[i] += begin[i - 1];
    if (pass == 0)
      list = gl_allocate((size_t)begin[n_all + 1], sizeof *list);
  }
  job->buffers[2] = gl_buffer(2, (size_t)begin[n_all] * sizeof *list, list);
  job->buffers[3] = gl_buffer(3, (n_all + 1) * sizeof *begin, begin);
  free(list);
  free(begin);
}

static void draw_tiles(gl_job *job, const char *constants, const gl_splat *splats, const int *order, size_t n) {
  const int n_tiles[2] = {(job->camera->width + 15) / 16, (job->camera->height + 15) / 16};
  bin_splats(job, splats, order, n, n_tiles);
  GLuint program = gl_drawing_program(job->order->folder, constants, "gl_whole_vertex", "gl_composite");
  glUniform1i(glGetUniformLocation(program, "tiles_across"), n_tiles[0]);
  set_profile(program, job);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

/* Front to back: what is there already is over what comes. */
static void draw_quads(gl_job *job, const char *constants, const int *order, size_t n) {
  job->buffers[2] = gl_buffer(2, n * sizeof *order, order);
  GLuint program = gl_drawing_program(job->order->folder, constants, "gl_quad_vertex", "gl_quad_fragment");
  glUniform2f(glGetUniformLocation(program, "size"), (GLfloat)job->camera->width, (GLfloat)job->camera->height);
  set_profile(program, job);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_ONE);
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)n);
  glDisable(GL_BLEND);
}

static const gl_profile *find_profile(const char *name) {
  for (int i = 0; i < N_PROFILES; i++)
    if (strcmp(profiles[i].name, name) == 0)
      return profiles + i;
  plain_give_up(name, "is no profile");
  return NULL;
}

/* Both targets, as OpenGL has them, are made a picture. What was blended has T from A, else A is from T; both divide
 * the depth by A. */
static void read_back(const gl_job *job, plain_picture *p) {
  const size_t n = (size_t)p->width * (size_t)p->height;
  float *color = gl_allocate(n, 4 * sizeof *color), *depth = gl_allocate(n, 4 * sizeof *depth);
  glReadPixels(0, 0, p->width, p->height, GL_RGBA, GL_FLOAT, color);
  glReadBuffer(GL_COLOR_ATTACHMENT1);
  glReadPixels(0, 0, p->width, p->height, GL_RGBA, GL_FLOAT, depth);
  for (size_t i = 0; i < n; i++) {
    const float A = color[4 * i + 3], T = job->profile.clamp ? depth[4 * i + 1] : 1.0f - A;
    for (size_t c = 0; c < 3; c++)
      p->rgb[3 * i + c] = color[4 * i + c] + (has(job, PLAIN_BACKGROUND_WHITE) ? T : 0.0f);
    p->alpha[i] = A;
    p->T[i] = T;
    p->z[i] = A > 0.0f ? depth[4 * i] / A : 0.0f;
  }
  free(color);
  free(depth);
  plain_picture_spoil(p, job->order->faults);
}

void gl_draw(const gl_order *order, const plain_scene *scene, const plain_camera *camera, plain_picture *picture) {
  char constants[CONSTANTS_ROOM];
  gl_job job = {.order = order, .scene = scene, .camera = camera, .profile = *find_profile(order->profile)};
  plant_in_profile(&job);
  write_constants(&job, constants);
  gl_splat *splats = set_up(&job, constants);
  int *sorted = gl_allocate(scene->count, sizeof *sorted);
  size_t n = sort_splats(&job, splats, sorted);
  gl_targets(camera->width, camera->height, job.targets);
  if (job.profile.clamp)
    draw_tiles(&job, constants, splats, sorted, n);
  else
    draw_quads(&job, constants, sorted, n);
  read_back(&job, picture);
  if (glGetError())
    plain_give_up("OpenGL", "reports an error");
  glDeleteBuffers(4, job.buffers);
  glDeleteFramebuffers(1, job.targets);
  glDeleteTextures(2, job.targets + 1);
  free(splats);
  free(sorted);
}
