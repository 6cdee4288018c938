#include "core/formats/material_file.h"

#include <stdio.h>
#include <string.h>

#include "core/base/message.h"
#include "core/files/file.h"
#include "core/files/input.h"
#include "core/files/number.h"

typedef struct material_reader {
  conic_input input;
  const conic_texts *names;
  conic_material *materials, *current; /* null: one that nobody uses */
  int has_warned;
} material_reader;

static conic_status read_name(void *data) {
  material_reader *reader = data;
  const char *word;
  size_t length;
  conic_status status = conic_input_word(&reader->input, &word, &length);
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

/* Triangles are opaque; said once of a file. */
static conic_status warn_of_opacity(material_reader *reader, double opaque) {
  const char *word;
  size_t length;
  double value;
  conic_status status = conic_input_word(&reader->input, &word, &length);
  if (status != CONIC_OK || reader->has_warned || !reader->current || length == 0 ||
      conic_number_parse(word, length, &value) != length || value == opaque)
    return status;
  reader->has_warned = 1;
  conic_log(reader->input.context, CONIC_LOG_WARNING,
            "%s: triangles are opaque: what d and Tr say is left out (line %llu)", reader->input.name,
            (unsigned long long)reader->input.line);
  return CONIC_OK;
}

static conic_status read_opacity(void *data) {
  return warn_of_opacity(data, 1.0);
}

static conic_status read_transparency(void *data) {
  return warn_of_opacity(data, 0.0);
}

/* map_Kd [-option value …] FILE: the file is the last word; `-clamp on` is the one option that matters here. */
static conic_status read_map(void *data) {
  material_reader *reader = data;
  char file[CONIC_INPUT_LONGEST_WORD + 1] = "", path[2 * CONIC_INPUT_LONGEST_WORD];
  int is_clamp_next = 0;
  conic_texture_wrap wrap = CONIC_WRAP_REPEAT;
  for (;;) {
    const char *word;
    size_t length;
    conic_status status = conic_input_word(&reader->input, &word, &length);
    if (status != CONIC_OK)
      return status;
    if (length == 0)
      break;
    if (is_clamp_next && conic_input_is(word, length, "on"))
      wrap = CONIC_WRAP_CLAMP;
    is_clamp_next = conic_input_is(word, length, "-clamp");
    snprintf(file, sizeof file, "%.*s", (int)length, word);
  }
  if (!file[0] || !reader->current || reader->current->texture)
    return CONIC_OK;
  if (!conic_input_beside(&reader->input, file, strlen(file), path, sizeof path))
    return conic_input_wrong(&reader->input, "a picture's name is too long");
  if (!conic_file_is_there(path)) {
    conic_log(reader->input.context, CONIC_LOG_WARNING, "%s: the texture %s is not there, and is left out (line %llu)",
              reader->input.name, path, (unsigned long long)reader->input.line);
    return CONIC_OK;
  }
  return conic_texture_read(reader->input.context, path, wrap, &reader->current->texture);
}

conic_status conic_material_file_read(conic_context *context, const char *path, const conic_texts *names,
                                      conic_material *materials) {
  static const conic_input_statement statements[] = {
      {"newmtl", read_name}, {"Kd", read_color}, {"map_Kd", read_map}, {"d", read_opacity}, {"Tr", read_transparency}};
  material_reader reader = {.names = names, .materials = materials};
  conic_status status = conic_input_open(context, path, &reader.input);
  if (status != CONIC_OK)
    return status;
  status = conic_input_skip_mark(&reader.input);
  if (status == CONIC_OK)
    status = conic_input_read_statements(&reader.input, statements, sizeof statements / sizeof *statements, &reader);
  conic_input_close(&reader.input);
  return status;
}
