#include "core/formats/assimp_read.h"

#include <stdio.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/module.h"
#include "core/formats/assimp_kinds.h"
#include "core/formats/assimp_material.h"
#include "core/formats/assimp_part.h"
#include "core/formats/assimp_process.h"

static const char module[] = "conic-assimp.so";

/* Assimp counts some sizes in 32 bits. */
static const uint64_t most_bytes = 0x7FFFFFFF;

enum { LONGEST_TEXT = 4096 };

#if CONIC_HAVE_ASSIMP

static const conic_assimp_bridge_functions *load_bridge(char message[CONIC_MODULE_MESSAGE]) {
  return conic_module_load(module, "conic_assimp_bridge", message);
}

int conic_assimp_is_there(void) {
  return conic_module_is_there(module);
}

#else

static const conic_assimp_bridge_functions *load_bridge(char message[CONIC_MODULE_MESSAGE]) {
  snprintf(message, CONIC_MODULE_MESSAGE, "this build is without Assimp, which reads it (%s is missing)", module);
  return NULL;
}

int conic_assimp_is_there(void) {
  return 0;
}

#endif

/* A file in memory. */
typedef struct whole_file {
  unsigned char *bytes;
  size_t n_bytes, room;
} whole_file;

static conic_status read_whole(conic_input *input, whole_file *file) {
  uint64_t remaining = conic_input_remaining_bytes(input);
  conic_status status = CONIC_OK;
  if (remaining != UINT64_MAX && remaining <= most_bytes)
    status = conic_memory_reserve(input->context, &file->bytes, 0, (size_t)remaining, &file->room, 1);
  for (size_t n = 1; status == CONIC_OK && n > 0;) {
    status = conic_input_fill(input, 1);
    n = conic_input_available(input);
    if (status == CONIC_OK && file->n_bytes + n > most_bytes)
      return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: files of this kind are read up to 2 GiB", input->name);
    if (status == CONIC_OK)
      status = conic_memory_reserve(input->context, &file->bytes, file->n_bytes, file->n_bytes + n, &file->room, 1);
    if (status == CONIC_OK && n > 0)
      memcpy(file->bytes + file->n_bytes, conic_input_bytes(input), n);
    input->next += status == CONIC_OK ? n : 0;
    file->n_bytes += status == CONIC_OK ? n : 0;
  }
  return status;
}

typedef struct assimp_reader {
  conic_input *input;
  conic_assimp_process process;
  conic_assimp_part_builder parts;
} assimp_reader;

/* A text of the process, on one line. */
static conic_status take_text(assimp_reader *reader, const conic_assimp_record *record, char text[LONGEST_TEXT]) {
  size_t n = record->n_bytes < LONGEST_TEXT ? (size_t)record->n_bytes : LONGEST_TEXT - 1;
  conic_status status = conic_assimp_process_take(&reader->process, text, n);
  for (size_t i = 0; i < n; i++)
    if ((unsigned char)text[i] < 0x20)
      text[i] = ' ';
  while (n > 0 && (text[n - 1] == ' ' || text[n - 1] == '.'))
    n--;
  text[n] = '\0';
  return status;
}

static conic_status fail_as_told(assimp_reader *reader, const conic_assimp_record *record) {
  char text[LONGEST_TEXT];
  conic_status status = take_text(reader, record, text);
  if (status != CONIC_OK)
    return status;
  return conic_fail(reader->input->context, CONIC_ERROR_INPUT, "%s: cannot read: %.200s", reader->input->name,
                    text[0] ? text : "Assimp gives no reason");
}

/* A file that was read besides. */
static conic_status note_opened(assimp_reader *reader, const conic_assimp_record *record) {
  char path[LONGEST_TEXT];
  return take_text(reader, record, path);
}

static conic_status take_up(assimp_reader *reader, const conic_assimp_record *record) {
  conic_model *model = reader->parts.builder.model;
  memcpy(model->up, record->up, sizeof model->up);
  if (model->points.count == 0)
    return conic_fail(reader->input->context, CONIC_ERROR_INPUT,
                      "%s: there is neither a face nor a point in the file that Assimp can read", reader->input->name);
  return CONIC_OK;
}

static conic_status take_records(assimp_reader *reader) {
  conic_assimp_record record;
  for (;;) {
    conic_status status = conic_assimp_process_take(&reader->process, &record, sizeof record);
    if (status == CONIC_OK)
      switch (record.type) {
      case CONIC_ASSIMP_MATERIAL:
        status = conic_assimp_take_material(reader->input, &reader->process, &record, &reader->parts);
        break;
      case CONIC_ASSIMP_PART:
        status = conic_assimp_take_part(&reader->process, &record, &reader->parts);
        break;
      case CONIC_ASSIMP_OPENED:
        status = note_opened(reader, &record);
        break;
      case CONIC_ASSIMP_FAILED:
        return fail_as_told(reader, &record);
      case CONIC_ASSIMP_END:
        return take_up(reader, &record);
      default:
        status = conic_fail(reader->input->context, CONIC_ERROR_INPUT, "%s: cannot read: Assimp has lost its way",
                            reader->input->name);
      }
    if (status != CONIC_OK)
      return status;
  }
}

static conic_status read_file(assimp_reader *reader, const conic_assimp_bridge_functions *bridge, conic_model_kind kind,
                              const whole_file *file) {
  char name[32];
  const char *path = reader->input->name, *slash = strrchr(path, '/');
  snprintf(name, sizeof name, "model.%s", conic_model_kind_name(kind));
  conic_assimp_request request = {.name = name,
                                  .bytes = file->bytes,
                                  .n_bytes = file->n_bytes,
                                  .folder = path,
                                  .folder_length = slash ? (size_t)(slash + 1 - path) : 0,
                                  .keeps_faces = reader->parts.faces != NULL};
  conic_status status = conic_assimp_process_start(reader->input->context, path, bridge, request, &reader->process);
  if (status == CONIC_OK)
    status = take_records(reader);
  conic_assimp_process_end(&reader->process);
  return status;
}

conic_status conic_assimp_read(conic_input *input, conic_model_kind kind, const conic_read_options *options,
                               conic_model *model) {
  char message[CONIC_MODULE_MESSAGE] = "";
  whole_file file = {NULL, 0, 0};
  assimp_reader reader = {.input = input, .process = {.descriptor = -1}};
  const conic_assimp_bridge_functions *bridge = load_bridge(message);
  if (!bridge)
    return conic_fail(input->context, CONIC_ERROR_UNSUPPORTED, "%s: cannot read %s: %s", input->name,
                      conic_model_kind_name(kind), message);
  conic_status status = conic_assimp_parts_begin(input->context, kind, options, model, &reader.parts);
  if (status == CONIC_OK)
    status = read_whole(input, &file);
  if (status == CONIC_OK)
    status = read_file(&reader, bridge, kind, &file);
  if (status == CONIC_OK)
    status = conic_assimp_parts_end(&reader.parts);
  conic_assimp_parts_release(&reader.parts);
  conic_memory_release(input->context, file.bytes);
  return status;
}
