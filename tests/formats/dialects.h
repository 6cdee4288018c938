/* What the tests of readers share: a small scene, and dialects as words. A dialect is one line, such as "ply {ascii,le}
 * color:{uchar,float}", which stands for all that its braces make of it; a writer looks for its words. */
#pragma once

#include "core/base/byte_order.h"
#include "core/base/color.h"
#include "core/splats/point_values.h"
#include "tests/support/files.h"
#include "tests/support/mesh_file.h"

/* A cube without its top, of colours and smooth normals at its corners; and points with all fields. */
enum { SCENE_CORNERS = 8, SCENE_FACES = 5, SCENE_POINTS = 100 };

static const int scene_quads[SCENE_FACES][4] = {{0, 2, 3, 1}, {0, 1, 5, 4}, {1, 3, 7, 5}, {3, 2, 6, 7}, {2, 0, 4, 6}};
static const int scene_codes[SCENE_CORNERS][3] = {{255, 0, 0},    {0, 255, 0}, {0, 0, 255},     {250, 250, 40},
                                                  {40, 100, 200}, {1, 2, 3},   {128, 128, 128}, {200, 20, 90}};

static inline double scene_corner(int i, int axis) {
  return i >> axis & 1 ? 3.0 : -2.0;
}

static inline double scene_normal(int i, int axis) {
  return (i >> axis & 1 ? 1.0 : -1.0) / sqrt(3.0);
}

static inline double scene_point(int i, int axis) {
  return axis == 0 ? 0.25 * i - 7.0 : axis == 1 ? 0.5 * (i * 7 % 10) : 1.0 + i % 3;
}

static inline double scene_point_normal(int i, int axis) {
  static const double normals[3][3] = {{0.6, 0.0, -0.8}, {0.0, 1.0, 0.0}, {-0.6, 0.8, 0.0}};
  return normals[i % 3][axis];
}

static inline int scene_point_code(int i, int channel) {
  return channel == 0 ? 2 * i + 50 : channel == 1 ? 255 - i : 7 * i % 251;
}

static inline double scene_intensity(int i) {
  return 300.0 + 11 * i;
}

static inline double scene_time(int i) {
  return 189446023.0587 + 0.0054 * i;
}

static inline int scene_class(int i) {
  return i % 7;
}

/* --- words --- */

/* The word, or what stands behind "word:"; null: the dialect has it not. */
static inline const char *word_of(const char *dialect, const char *word) {
  static char known[256][40];
  size_t n = strlen(word);
  for (const char *c = dialect; *c; c += strcspn(c, " "), c += *c == ' ') {
    if (strncmp(c, word, n) != 0 || (c[n] != ' ' && c[n] != ':' && c[n]))
      continue;
    const char *from = c[n] == ':' ? c + n + 1 : c;
    size_t length = strcspn(from, " ");
    for (size_t i = 0; i < 256; i++) {
      if (!known[i][0])
        snprintf(known[i], sizeof known[i], "%.*s", (int)length, from);
      if (strlen(known[i]) == length && memcmp(known[i], from, length) == 0)
        return known[i];
    }
    exit(1);
  }
  return NULL;
}

static inline int is_said(const char *dialect, const char *word) {
  return word_of(dialect, word) != NULL;
}

static inline int says(const char *dialect, const char *word, const char *what) {
  const char *found = word_of(dialect, word);
  return found && strcmp(found, what) == 0;
}

/* Calls `each` for every line without braces that the line stands for; returns how many there are. */
static inline int for_each_dialect(const char *line, void (*each)(const char *dialect)) {
  const char *open = strchr(line, '{'), *close = open ? strchr(open, '}') : NULL;
  char made[512];
  int n = 0;
  if (!close) {
    int before = check_failures;
    each(line);
    if (check_failures > before)
      fprintf(stderr, "  that was: %s\n", line);
    return 1;
  }
  for (const char *c = open + 1; c <= close; c += strcspn(c, ",}") + 1) {
    snprintf(made, sizeof made, "%.*s%.*s%s", (int)(open - line), line, (int)strcspn(c, ",}"), c, close + 1);
    n += for_each_dialect(made, each);
  }
  return n;
}

/* --- numbers --- */

/* The type and the scale of colours: "float", "ushort/255". What white is. */
static inline double white_of(const char *color) {
  const char *slash = strchr(color, '/');
  return slash                                                      ? atof(slash + 1)
         : strncmp(color, "ushort", 6) == 0                         ? 65535.0
         : strstr("float float-linear double double-linear", color) ? 1.0
                                                                    : 255.0;
}

/* A code of 8 bits as these colours write it. */
static inline double color_value(const char *color, int code) {
  double share = code / 255.0;
  return strstr(color, "linear") ? conic_srgb_decode(share) : share * white_of(color);
}

static inline void put_number(mesh_file *file, const char *encoding, const char *type, double value) {
  unsigned char bytes[8];
  static const struct {
    const char *names[2];
    size_t n;
  } types[] = {{{"char", "int8"}, 1}, {{"uchar", "uint8"}, 1}, {{"short", "int16"}, 2},   {{"ushort", "uint16"}, 2},
               {{"int", "int32"}, 4}, {{"uint", "uint32"}, 4}, {{"float", "float32"}, 4}, {{"double", "float64"}, 8}};
  size_t i = 0, n = strcspn(type, "/-"), n_bytes;
  while (i < 8 && !(strlen(types[i].names[0]) == n && strncmp(types[i].names[0], type, n) == 0) &&
         !(strlen(types[i].names[1]) == n && strncmp(types[i].names[1], type, n) == 0))
    i++;
  if (i == 8) {
    fprintf(stderr, "no type '%s'\n", type);
    exit(1);
  }
  if (strcmp(encoding, "ascii") == 0) {
    mesh_text(file, i < 6 ? "%.0f " : i == 6 ? "%.9g " : "%.17g ", value);
    return;
  }
  n_bytes = types[i].n;
  if (i == 6)
    conic_store_float(bytes, (float)value);
  else if (i == 7)
    conic_store_double(bytes, value);
  else
    conic_store_bits(bytes, n_bytes, (uint64_t)(int64_t)floor(value + 0.5));
  for (size_t k = 0; k < n_bytes; k++)
    mesh_put(file, &bytes[strcmp(encoding, "be") == 0 ? n_bytes - 1 - k : k], 1);
}

/* --- what was read --- */

/* A colour of 8 bits; `steps` are those of coarser ones. */
static inline void check_color(const conic_splats *points, size_t i, const int code[3], double bound) {
  CHECK(points->color[0] != NULL);
  for (int channel = 0; channel < 3 && points->color[0]; channel++)
    CHECK_NEAR((double)points->color[channel][i], conic_srgb_decode(code[channel] / 255.0), bound);
}

/* A format: three letters with which its dialects begin, and what writes one into the file. */
typedef struct dialect_format {
  const char *ending;
  void (*write)(const char *dialect);
} dialect_format;

/* The format of a dialect, by its number among n; n where there is none. */
static inline size_t dialect_format_of(const char *d, const dialect_format *formats, size_t n) {
  size_t i = 0;
  while (i < n && strncmp(d, formats[i].ending, 3) != 0)
    i++;
  return i;
}

/* Writes a dialect's file, and returns its path. */
static inline const char *dialect_write(const char *d, const dialect_format *format, mesh_file *file) {
  char name[16];
  file->n = 0;
  format->write(d);
  snprintf(name, sizeof name, "a.%s", format->ending);
  return files_write_bytes(name, file->bytes, file->n);
}
