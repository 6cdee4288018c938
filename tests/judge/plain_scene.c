/* Files of a plain renderer: a binary PLY, a pinhole in JSON, and a picture as PFM or NPY. */
#include "tests/judge/plain_scene.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

const char *const plain_fault_names[PLAIN_N_FAULTS] = {"dilation-0",
                                                       "dilation-0.1",
                                                       "extent-3-sigma",
                                                       "alpha-max-0.999",
                                                       "alpha-max-0.99",
                                                       "falloff-renormalised",
                                                       "order-distance",
                                                       "order-file",
                                                       "sh-degree-0",
                                                       "f-rest-interleaved",
                                                       "quaternion-xyzw",
                                                       "quaternion-not-normalised",
                                                       "scale-linear",
                                                       "opacity-linear",
                                                       "half-pixel",
                                                       "mirrored-x",
                                                       "mirrored-y",
                                                       "centre-ignored",
                                                       "srgb-decoded",
                                                       "srgb-encoded",
                                                       "premultiplied",
                                                       "background-white",
                                                       "near",
                                                       "affine",
                                                       "no-amplitude",
                                                       "epsilon-in-z",
                                                       "radius-as-sigma",
                                                       "no-normalisation",
                                                       "back-faces"};

void plain_give_up(const char *path, const char *what) {
  fprintf(stderr, "%s: %s\n", path, what);
  exit(1);
}

plain_fault plain_fault_find(const char *name) {
  for (int k = 0; k < PLAIN_N_FAULTS; k++)
    if (strcmp(plain_fault_names[k], name) == 0)
      return (plain_fault)k;
  plain_give_up(name, "is no fault");
  return PLAIN_N_FAULTS;
}

static void *plain_calloc(size_t n, size_t size) {
  void *all = calloc(n ? n : 1, size);
  if (!all)
    plain_give_up("memory", "there is not enough");
  return all;
}

static size_t plain_size_of_type(const char *type) {
  if (strcmp(type, "double") == 0)
    return 8;
  return strcmp(type, "uchar") == 0 ? 1 : strcmp(type, "float") == 0 ? 4 : 0;
}

static double plain_number_of(const unsigned char *at, size_t size) {
  float single;
  double twice;
  memcpy(&single, at, sizeof single * (size == 4));
  memcpy(&twice, at, sizeof twice * (size == 8));
  return size == 1 ? (double)*at : size == 4 ? (double)single : twice;
}

/* Only what the tests write: one element, little-endian, of float, double and uchar. */
plain_table plain_table_read(const char *path) {
  plain_table t = {.n_rows = 0};
  size_t sizes[96], row_bytes = 0;
  char line[256], type[16], name[24];
  unsigned long long n;
  FILE *file = fopen(path, "rb");
  if (!file || !fgets(line, sizeof line, file) || strncmp(line, "ply", 3) != 0)
    plain_give_up(path, "cannot be read as a PLY");
  while (fgets(line, sizeof line, file) && strncmp(line, "end_header", 10) != 0) {
    if (sscanf(line, "element vertex %llu", &n) == 1)
      t.n_rows = (size_t)n;
    if (sscanf(line, "property %15s %23s", type, name) == 2) {
      if (t.n_columns == 96 || plain_size_of_type(type) == 0)
        plain_give_up(path, "has a property that is not known here");
      sizes[t.n_columns] = plain_size_of_type(type);
      row_bytes += sizes[t.n_columns];
      memcpy(t.names[t.n_columns++], name, sizeof name);
    }
  }
  unsigned char row[96 * 8];
  t.values = plain_calloc(t.n_rows * (size_t)t.n_columns, sizeof *t.values);
  for (size_t i = 0; i < t.n_rows; i++) {
    if (fread(row, 1, row_bytes, file) != row_bytes)
      plain_give_up(path, "ends early");
    const unsigned char *at = row;
    for (int k = 0; k < t.n_columns; at += sizes[k++])
      t.values[i * (size_t)t.n_columns + (size_t)k] = plain_number_of(at, sizes[k]);
  }
  fclose(file);
  return t;
}

int plain_table_find(const plain_table *t, const char *name) {
  for (int k = 0; k < t->n_columns; k++)
    if (strcmp(t->names[k], name) == 0)
      return k;
  return -1;
}

static float plain_cell(const plain_table *t, size_t row, int column) {
  return column < 0 ? 0.0f : (float)t->values[row * (size_t)t->n_columns + (size_t)column];
}

static void plain_columns(const plain_table *t, const char *format, int n, int *columns) {
  char name[24];
  for (int k = 0; k < n; k++) {
    snprintf(name, sizeof name, format, k);
    columns[k] = plain_table_find(t, name);
  }
}

/* f_rest holds all of red, then green, then blue: whoever takes it for colours one after the other mixes them. */
static void plain_take_harmonics(const plain_table *t, size_t i, unsigned faults, const int *dc, const int *rest,
                                 plain_scene *s) {
  const int n = (s->sh_degree + 1) * (s->sh_degree + 1);
  float *sh = s->sh + i * (size_t)n * 3;
  for (int c = 0; c < 3; c++) {
    sh[c] = plain_cell(t, i, dc[c]);
    for (int k = 1; k < n; k++) {
      int at = plain_has(faults, PLAIN_F_REST_INTERLEAVED) ? 3 * (k - 1) + c : c * (n - 1) + k - 1;
      sh[3 * k + c] = plain_cell(t, i, rest[at]);
    }
  }
}

static void plain_take_rotation(const plain_table *t, size_t i, unsigned faults, const int *columns, float q[4]) {
  float length = 0.0f;
  for (int k = 0; k < 4; k++) {
    int from = plain_has(faults, PLAIN_QUATERNION_XYZW) ? (k + 3) % 4 : k; /* takes what stands first for x */
    q[k] = plain_cell(t, i, columns[from]);
    length += q[k] * q[k];
  }
  length = sqrtf(length);
  for (int k = 0; k < 4 && !plain_has(faults, PLAIN_QUATERNION_NOT_NORMALISED); k++)
    q[k] /= length;
}

plain_scene plain_scene_read(const char *path, unsigned faults) {
  plain_table t = plain_table_read(path);
  plain_scene s = {.count = t.n_rows, .n_scales = plain_table_find(&t, "scale_2") < 0 ? 2 : 3};
  int dc[3], rest[72], scale[3], rotation[4], place[3], opacity = plain_table_find(&t, "opacity"), n_rest = 0;
  plain_columns(&t, "f_dc_%d", 3, dc);
  plain_columns(&t, "f_rest_%d", 72, rest);
  plain_columns(&t, "scale_%d", 3, scale);
  plain_columns(&t, "rot_%d", 4, rotation);
  for (int k = 0; k < 3; k++)
    place[k] = plain_table_find(&t, k == 0 ? "x" : k == 1 ? "y" : "z");
  if (place[0] < 0 || dc[0] < 0 || scale[0] < 0 || rotation[0] < 0 || opacity < 0)
    plain_give_up(path, "is no scene of Gaussians");
  while (n_rest < 72 && rest[n_rest] >= 0)
    n_rest++;
  while (3 * ((s.sh_degree + 2) * (s.sh_degree + 2) - 1) <= n_rest)
    s.sh_degree++;
  s.mean = plain_calloc(s.count, 3 * sizeof *s.mean);
  s.scale = plain_calloc(s.count, 3 * sizeof *s.scale);
  s.rotation = plain_calloc(s.count, 4 * sizeof *s.rotation);
  s.opacity = plain_calloc(s.count, sizeof *s.opacity);
  s.sh = plain_calloc(s.count * (size_t)((s.sh_degree + 1) * (s.sh_degree + 1)), 3 * sizeof *s.sh);
  for (size_t i = 0; i < s.count; i++) {
    for (size_t k = 0; k < 3; k++) {
      float stored = plain_cell(&t, i, scale[k]), raw = faults & PLAIN_OTHERWISE ? expf(expf(stored)) : stored;
      s.mean[3 * i + k] = plain_cell(&t, i, place[k]);
      s.scale[3 * i + k] = scale[k] < 0 ? 0.0f : plain_has(faults, PLAIN_SCALE_LINEAR) ? raw : expf(stored);
    }
    float logit = plain_cell(&t, i, opacity), raw = faults & PLAIN_OTHERWISE ? fminf(fmaxf(logit, 0.0f), 1.0f) : logit;
    s.opacity[i] = plain_has(faults, PLAIN_OPACITY_LINEAR) ? raw : 1.0f / (1.0f + expf(-logit));
    plain_take_rotation(&t, i, faults, rotation, s.rotation + 4 * i);
    plain_take_harmonics(&t, i, faults, dc, rest, &s);
  }
  free(t.values);
  return s;
}

void plain_scene_release(plain_scene *s) {
  free(s->mean);
  free(s->scale);
  free(s->rotation);
  free(s->opacity);
  free(s->sh);
}

/* The number after "name":, which is there once. */
static const char *plain_after(const char *path, const char *text, const char *name) {
  char quoted[32];
  snprintf(quoted, sizeof quoted, "\"%s\"", name);
  const char *at = strstr(text, quoted);
  at = at ? strchr(at + strlen(quoted), ':') : NULL;
  if (!at)
    plain_give_up(path, "lacks a number of the camera");
  return at + 1;
}

plain_camera plain_camera_read(const char *path) {
  char text[8192];
  FILE *file = fopen(path, "rb");
  size_t n = file ? fread(text, 1, sizeof text - 1, file) : 0;
  plain_camera c;
  if (n == 0)
    plain_give_up(path, "cannot be read");
  fclose(file);
  text[n] = '\0';
  c.width = (int)strtol(plain_after(path, text, "width"), NULL, 10);
  c.height = (int)strtol(plain_after(path, text, "height"), NULL, 10);
  c.fx = strtof(plain_after(path, text, "fx"), NULL);
  c.fy = strtof(plain_after(path, text, "fy"), NULL);
  c.cx = strtof(plain_after(path, text, "cx"), NULL);
  c.cy = strtof(plain_after(path, text, "cy"), NULL);
  const char *at = plain_after(path, text, "world_to_camera");
  for (int k = 0; k < 12; k++) {
    at += strcspn(at, "-0123456789");
    char *end;
    c.view[k / 4][k % 4] = strtof(at, &end);
    if (end == at)
      plain_give_up(path, "lacks a number of world_to_camera");
    at = end;
  }
  return c;
}

plain_picture plain_picture_allocate(int width, int height) {
  const size_t n = (size_t)width * (size_t)height;
  plain_picture p = {width, height, NULL, NULL, NULL, NULL, NULL};
  p.rgb = plain_calloc(n, 3 * sizeof(float));
  p.T = plain_calloc(n, sizeof(float));
  p.alpha = plain_calloc(n, sizeof(float));
  p.z = plain_calloc(n, sizeof(float));
  p.count = plain_calloc(n, sizeof(float));
  return p;
}

void plain_picture_release(plain_picture *p) {
  free(p->rgb);
  free(p->T);
  free(p->alpha);
  free(p->z);
  free(p->count);
}

static void plain_mirror_plane(float *plane, int width, int height, int n_channels, int is_upside_down) {
  const size_t w = (size_t)width, h = (size_t)height, n = (size_t)n_channels;
  for (size_t y = 0; y < (is_upside_down ? h / 2 : h); y++)
    for (size_t x = 0; x < (is_upside_down ? w : w / 2); x++)
      for (size_t c = 0; c < n; c++) {
        float *a = &plane[(y * w + x) * n + c];
        float *b = is_upside_down ? &plane[((h - 1 - y) * w + x) * n + c] : &plane[(y * w + w - 1 - x) * n + c];
        float kept = *a;
        *a = *b;
        *b = kept;
      }
}

static void plain_mirror(plain_picture *p, int is_upside_down) {
  plain_mirror_plane(p->rgb, p->width, p->height, 3, is_upside_down);
  plain_mirror_plane(p->T, p->width, p->height, 1, is_upside_down);
  plain_mirror_plane(p->alpha, p->width, p->height, 1, is_upside_down);
  plain_mirror_plane(p->z, p->width, p->height, 1, is_upside_down);
  plain_mirror_plane(p->count, p->width, p->height, 1, is_upside_down);
}

static float plain_decode(float v, int is_power) {
  if (is_power)
    return powf(v, 2.2f);
  return v <= 0.04045f ? v / 12.92f : powf((v + 0.055f) / 1.055f, 2.4f);
}

static float plain_encode(float v, int is_power) {
  if (is_power)
    return powf(v, 1.0f / 2.2f);
  return v <= 0.0031308f ? 12.92f * v : 1.055f * powf(v, 1.0f / 2.4f) - 0.055f;
}

void plain_picture_spoil(plain_picture *p, unsigned faults) {
  const int is_other = (faults & PLAIN_OTHERWISE) != 0;
  const size_t n = (size_t)p->width * (size_t)p->height;
  for (size_t i = 0; i < 3 * n; i++) {
    if (plain_has(faults, PLAIN_PREMULTIPLIED))
      p->rgb[i] = !is_other ? p->rgb[i] * p->alpha[i / 3] : p->alpha[i / 3] > 0.0f ? p->rgb[i] / p->alpha[i / 3] : 0.0f;
    if (plain_has(faults, PLAIN_SRGB_DECODED))
      p->rgb[i] = plain_decode(p->rgb[i], is_other);
    if (plain_has(faults, PLAIN_SRGB_ENCODED))
      p->rgb[i] = plain_encode(p->rgb[i], is_other);
  }
  if (plain_has(faults, PLAIN_MIRRORED_X))
    plain_mirror(p, 0);
  if (plain_has(faults, PLAIN_MIRRORED_Y))
    plain_mirror(p, 1);
}

/* Rows from below, as PFM has them. */
static void plain_write_pfm(const char *path, const float *plane, int width, int height, int n_channels) {
  FILE *file = fopen(path, "wb");
  size_t row = (size_t)width * (size_t)n_channels, n = 0;
  if (!file)
    plain_give_up(path, "cannot be written");
  fprintf(file, "%s\n%d %d\n-1.0\n", n_channels == 3 ? "PF" : "Pf", width, height);
  for (size_t y = (size_t)height; y-- > 0;)
    n += fwrite(plane + y * row, sizeof *plane, row, file);
  if (fclose(file) != 0 || n != row * (size_t)height)
    plain_give_up(path, "cannot be written");
}

static void plain_write_npy(const char *path, const float *plane, int width, int height, int n_channels) {
  FILE *file = fopen(path, "wb");
  char shape[48], header[128];
  const size_t n = (size_t)width * (size_t)height * (size_t)n_channels;
  if (!file)
    plain_give_up(path, "cannot be written");
  snprintf(shape, sizeof shape, n_channels == 1 ? "(%d, %d)" : "(%d, %d, 4)", height, width);
  snprintf(header, sizeof header, "{'descr': '<f4', 'fortran_order': False, 'shape': %s, }", shape);
  fwrite("\x93NUMPY\x01\x00\x76\x00", 1, 10, file);
  fprintf(file, "%-117s\n", header);
  if (fwrite(plane, sizeof *plane, n, file) != n || fclose(file) != 0)
    plain_give_up(path, "cannot be written");
}

void plain_picture_write(const plain_picture *p, const char *path) {
  const size_t n = (size_t)p->width * (size_t)p->height, stem = strlen(path) - 4;
  char beside[1024];
  if (strlen(path) < 4 || strlen(path) > 1000)
    plain_give_up(path, "ends neither in .pfm nor in .npy");
  if (strcmp(path + stem, ".pfm") == 0) {
    plain_write_pfm(path, p->rgb, p->width, p->height, 3);
    snprintf(beside, sizeof beside, "%.*s.T.pfm", (int)stem, path);
    plain_write_pfm(beside, p->T, p->width, p->height, 1);
    snprintf(beside, sizeof beside, "%.*s.Z.pfm", (int)stem, path);
    plain_write_pfm(beside, p->z, p->width, p->height, 1);
    return;
  }
  if (strcmp(path + stem, ".npy") != 0)
    plain_give_up(path, "ends neither in .pfm nor in .npy");
  float *rgba = plain_calloc(n, 4 * sizeof *rgba);
  for (size_t i = 0; i < n; i++) {
    memcpy(rgba + 4 * i, p->rgb + 3 * i, 3 * sizeof *rgba);
    rgba[4 * i + 3] = p->alpha[i];
  }
  plain_write_npy(path, rgba, p->width, p->height, 4);
  snprintf(beside, sizeof beside, "%.*s.Z.npy", (int)stem, path);
  plain_write_npy(beside, p->z, p->width, p->height, 1);
  free(rgba);
}
