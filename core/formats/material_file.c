#include "core/formats/material_file.h"

#include "core/base/color.h"
#include "core/files/input.h"
#include "core/files/number.h"
#include "core/image/image_common.h"
#include "core/image/texture_levels.h"

typedef struct material_reader {
  conic_input input;
  const conic_texts *names;
  conic_material *materials, *current; /* current is null for a material that nobody uses */
  conic_texture **alphas;              /* a material's map_d; null: none */
} material_reader;

static conic_status read_name(void *data) {
  material_reader *reader = data;
  const char *word;
  size_t length;
  conic_status status = conic_input_rest(&reader->input, &word, &length);
  if (status != CONIC_OK)
    return status;
  size_t i = conic_texts_find(reader->names, word, length);
  reader->current = i < reader->names->count ? &reader->materials[i] : NULL;
  return CONIC_OK;
}

/* Kd r g b, or one value for all; linear. */
static conic_status read_color(void *data) {
  material_reader *reader = data;
  for (int channel = 0; channel < 3; channel++) {
    const char *word;
    size_t length;
    double value;
    conic_status status = conic_input_word(&reader->input, &word, &length);
    if (status != CONIC_OK)
      return status;
    if (length == 0 && channel > 0) {
      for (; channel < 3 && reader->current; channel++)
        reader->current->color[channel] = reader->current->color[0];
      return CONIC_OK;
    }
    if (conic_number_parse(word, length, &value) != length || length == 0 || !(value >= 0.0 && value <= 1e6))
      return conic_input_wrong(&reader->input, "a colour's value is no number in range");
    if (reader->current)
      reader->current->color[channel] = (float)value;
  }
  return CONIC_OK;
}

/* A number from 0 to 1; a word that is none, such as -halo, has no effect. */
static conic_status read_material_part(material_reader *reader, int is_opacity) {
  const char *word;
  size_t length;
  double value;
  conic_status status = conic_input_word(&reader->input, &word, &length);
  if (status != CONIC_OK || !reader->current || length == 0 || conic_number_parse(word, length, &value) != length ||
      !(value >= 0.0 && value <= 1.0))
    return status;
  reader->current->transparency = (float)(is_opacity ? 1.0 - value : value);
  return CONIC_OK;
}

static conic_status read_opacity(void *data) {
  return read_material_part(data, 1);
}

static conic_status read_transparency(void *data) {
  return read_material_part(data, 0);
}

/* How many values an option of a picture has at most; -1 where the word is no option. Some take a word, the others
 * numbers. */
static int count_values(const char *word, size_t length, int *takes_word) {
  static const struct {
    const char *name;
    int n;
  } known[] = {{"-o", 3},       {"-s", 3},      {"-t", 3},      {"-mm", 2},     {"-bm", 1},
               {"-boost", 1},   {"-texres", 1}, {"-blendu", 1}, {"-blendv", 1}, {"-clamp", 1},
               {"-imfchan", 1}, {"-cc", 1},     {"-type", 1}};
  enum { FIRST_OF_WORDS = 7 };
  for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
    if (conic_input_is(word, length, known[i].name)) {
      *takes_word = i >= FIRST_OF_WORDS;
      return known[i].n;
    }
  return -1;
}

/* Passes over [-option value …]; of these only `-clamp on` matters here. */
static void skip_options(const char **text, size_t *length, conic_texture_wrap *wrap) {
  for (int left = 0, is_clamp = 0, takes_word = 0; *length > 0;) {
    size_t n = 0, next;
    double number;
    while (n < *length && (*text)[n] != ' ' && (*text)[n] != '\t')
      n++;
    for (next = n; next < *length && ((*text)[next] == ' ' || (*text)[next] == '\t');)
      next++;
    int is_number = conic_number_parse(*text, n, &number) == n, n_values = count_values(*text, n, &takes_word);
    if (n_values < 0 && (left == 0 || (!takes_word && !is_number) || next == *length))
      return; /* the name begins */
    if (n_values < 0 && is_clamp && conic_input_is(*text, n, "on"))
      *wrap = CONIC_WRAP_CLAMP;
    is_clamp = conic_input_is(*text, n, "-clamp");
    left = n_values >= 0 ? n_values : left - 1;
    *text += next;
    *length -= next;
  }
}

/* [-option value …] FILE, whose name may have blanks. The path is empty where there is no such file. */
static conic_status read_path(material_reader *reader, conic_texture_wrap *wrap,
                              char path[2 * CONIC_INPUT_LONGEST_WORD]) {
  const char *name;
  size_t length;
  *wrap = CONIC_WRAP_REPEAT;
  path[0] = '\0';
  conic_status status = conic_input_rest(&reader->input, &name, &length);
  if (status != CONIC_OK)
    return status;
  skip_options(&name, &length, wrap);
  if (length == 0 || !reader->current)
    return CONIC_OK;
  if (length > CONIC_INPUT_LONGEST_WORD)
    return conic_input_wrong(&reader->input, "a picture's name is too long");
  if (conic_input_find(&reader->input, name, length, path, (size_t)2 * CONIC_INPUT_LONGEST_WORD))
    return CONIC_OK;
  conic_log(reader->input.context, CONIC_LOG_WARNING, "%s: the texture %s is not there, and is left out (line %llu)",
            reader->input.name, path, (unsigned long long)reader->input.line);
  path[0] = '\0';
  return CONIC_OK;
}

static conic_status read_map(void *data) {
  material_reader *reader = data;
  char path[2 * CONIC_INPUT_LONGEST_WORD];
  conic_texture_wrap wrap;
  conic_status status = read_path(reader, &wrap, path);
  if (status != CONIC_OK || !path[0] || reader->current->texture)
    return status;
  return conic_texture_read(reader->input.context, path, wrap, &reader->current->texture);
}

/* A picture of alpha: its own alpha, or its brightness where it has none. Its colour is white. */
static conic_status read_alpha_picture(conic_context *context, const char *path, conic_texture_wrap wrap,
                                       conic_texture **texture) {
  conic_image image;
  conic_status status = conic_texture_read_image(context, path, &image);
  if (status != CONIC_OK)
    return status;
  float *rgba = image.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < conic_image_pixels(&image); i++) {
    float *pixel = rgba + 4 * i;
    float bright = (0.2126f * pixel[0] + 0.7152f * pixel[1]) + 0.0722f * pixel[2];
    float alpha = image.lacks_alpha ? (float)conic_srgb_encode((double)bright) : pixel[3];
    pixel[0] = pixel[1] = pixel[2] = pixel[3] = alpha;
  }
  return conic_texture_take(context, &image, wrap, texture);
}

/* map_d replaces the alpha of map_Kd, which may come later. */
static conic_status read_alpha_map(void *data) {
  material_reader *reader = data;
  char path[2 * CONIC_INPUT_LONGEST_WORD];
  conic_texture_wrap wrap;
  conic_status status = read_path(reader, &wrap, path);
  if (status != CONIC_OK || !path[0])
    return status;
  conic_texture **alpha = &reader->alphas[reader->current - reader->materials];
  return *alpha ? CONIC_OK : read_alpha_picture(reader->input.context, path, wrap, alpha);
}

/* A material without a picture takes the picture of its alpha. */
static conic_status join_alphas(material_reader *reader) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < reader->names->count; i++) {
    conic_material *material = &reader->materials[i];
    if (reader->alphas[i] && material->texture && status == CONIC_OK)
      status = conic_texture_take_alpha(material->texture, reader->alphas[i]);
    else if (reader->alphas[i] && status == CONIC_OK) {
      material->texture = reader->alphas[i];
      reader->alphas[i] = NULL;
    }
    conic_texture_destroy(reader->alphas[i]);
  }
  return status;
}

conic_status conic_material_file_read(conic_context *context, const char *path, const conic_texts *names,
                                      conic_material *materials) {
  static const conic_input_statement statements[] = {{"newmtl", read_name},     {"Kd", read_color},
                                                     {"map_Kd", read_map},      {"d", read_opacity},
                                                     {"Tr", read_transparency}, {"map_d", read_alpha_map}};
  material_reader reader = {.names = names, .materials = materials};
  reader.alphas = conic_memory_allocate_zeroed(context, names->count, sizeof *reader.alphas);
  conic_status status = reader.alphas ? conic_input_open(context, path, &reader.input) : CONIC_ERROR_MEMORY;
  if (status != CONIC_OK) {
    conic_memory_release(context, reader.alphas);
    return status;
  }
  status = conic_input_skip_mark(&reader.input);
  if (status == CONIC_OK)
    status = conic_input_read_statements(&reader.input, statements, sizeof statements / sizeof *statements, &reader);
  conic_input_close(&reader.input);
  conic_status joined = join_alphas(&reader);
  conic_memory_release(context, reader.alphas);
  return status == CONIC_OK ? joined : status;
}
