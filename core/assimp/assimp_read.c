#include "core/assimp/assimp_read.h"
#include "core/files/guard.h"

#include "core/assimp/assimp_3mf.h"
#include "core/assimp/assimp_kinds.h"
#include "core/assimp/assimp_part.h"
#include "core/base/machine.h"
#include "core/files/file.h"

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
  size_t n_bytes;
} whole_file;

typedef struct assimp_reader {
  const conic_input *input;
  conic_assimp_process *process;
  conic_mesh_parts parts;
} assimp_reader;

/* A text from the process, without ends of lines or sentences. */
static conic_status take_text(assimp_reader *reader, const conic_assimp_record *record, char text[LONGEST_TEXT]) {
  size_t n = record->n_bytes < LONGEST_TEXT ? (size_t)record->n_bytes : LONGEST_TEXT - 1;
  conic_status status = conic_assimp_process_take(reader->process, text, n);
  while (n > 0 && ((unsigned char)text[n - 1] <= ' ' || text[n - 1] == '.'))
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

static conic_status pass_note_on(assimp_reader *reader, const conic_assimp_record *record) {
  char text[LONGEST_TEXT];
  conic_status status = take_text(reader, record, text);
  if (status == CONIC_OK)
    conic_log(reader->input->context, CONIC_LOG_WARNING, "%s: %.200s", reader->input->name, text);
  return status;
}

/* Notes another file that was read. */
static conic_status note_opened(assimp_reader *reader, const conic_assimp_record *record) {
  char path[LONGEST_TEXT];
  conic_status status = take_text(reader, record, path);
  return status == CONIC_OK ? conic_guard_note_path(reader->input->context, path) : status;
}

static conic_status take_end(assimp_reader *reader, const conic_assimp_record *record) {
  conic_model *model = reader->parts.builder.model;
  memcpy(model->up, record->up, sizeof model->up);
  if (model->points.count == 0)
    return conic_fail(reader->input->context, CONIC_ERROR_INPUT,
                      "%s: Assimp finds neither faces nor points in the file (lines are not drawn)",
                      reader->input->name);
  return conic_mesh_parts_end(&reader->parts);
}

static conic_status take_record(assimp_reader *reader, const conic_assimp_record *record) {
  switch (record->type) {
  case CONIC_ASSIMP_MATERIAL:
    return conic_assimp_take_material(reader->input, reader->process, record, &reader->parts);
  case CONIC_ASSIMP_PART:
    return conic_assimp_take_part(reader->process, record, &reader->parts);
  case CONIC_ASSIMP_OPENED:
    return note_opened(reader, record);
  case CONIC_ASSIMP_NOTE:
    return pass_note_on(reader, record);
  case CONIC_ASSIMP_FAILED:
    return fail_as_told(reader, record);
  case CONIC_ASSIMP_END:
    return take_end(reader, record);
  default:
    return conic_fail(reader->input->context, CONIC_ERROR_INPUT, "%s: cannot read: Assimp has lost its way",
                      reader->input->name);
  }
}

conic_status conic_assimp_read_records(const conic_input *input, conic_assimp_process *process,
                                       const conic_read_options *options, conic_model *model) {
  conic_assimp_record record = {.type = 0};
  assimp_reader reader = {.input = input, .process = process};
  conic_status status = conic_mesh_parts_begin(input->context, input->name, options, model, &reader.parts);
  while (status == CONIC_OK && record.type != CONIC_ASSIMP_END) {
    status = conic_assimp_process_take(process, &record, sizeof record);
    if (status == CONIC_OK)
      status = take_record(&reader, &record);
  }
  conic_mesh_parts_release(&reader.parts);
  return status;
}

/* Assimp reads cut texts as far as they go. */
static void warn_if_cut(const conic_input *input, conic_model_kind kind, const whole_file *file) {
  size_t n_last = file->n_bytes < 300 ? file->n_bytes : 300;
  if (kind == CONIC_MODEL_DXF && !conic_assimp_has_text(file->bytes + file->n_bytes - n_last, n_last, "EOF"))
    conic_log(input->context, CONIC_LOG_WARNING, "%s: the file ends without EOF: only a part of it may be there",
              input->name);
}

static conic_status start_process(const conic_input *input, const conic_assimp_bridge_functions *bridge,
                                  conic_model_kind kind, const conic_read_options *options, const whole_file *file,
                                  conic_assimp_process *process) {
  char made[16];
  const char *ending = conic_model_kind_name(kind), *name = conic_file_name(input->name);
  snprintf(made, sizeof made, "model.%s", ending);
  conic_assimp_request request = {.name = conic_file_has_ending(name, ending) ? name : made,
                                  .ending = ending,
                                  .bytes = file->bytes,
                                  .n_bytes = file->n_bytes,
                                  .folder = input->name,
                                  .folder_length = (size_t)(name - input->name),
                                  .keeps_faces = options->keeps_faces};
  warn_if_cut(input, kind, file);
  return conic_assimp_process_start(input->context, input->name, bridge, request, process);
}

conic_status conic_assimp_read(conic_input *input, conic_model_kind kind, const conic_read_options *options,
                               conic_model *model) {
  char message[CONIC_MODULE_MESSAGE] = "";
  whole_file file = {NULL, 0};
  conic_assimp_process process = {.descriptor = -1};
  const conic_assimp_bridge_functions *bridge = load_bridge(message);
  if (!bridge)
    return conic_fail(input->context, CONIC_ERROR_UNSUPPORTED, "%s: cannot read %s: %s", input->name,
                      conic_model_kind_name(kind), message);
  conic_status status = conic_input_take_rest(input, most_bytes, &file.bytes, &file.n_bytes);
  if (status == CONIC_OK && kind == CONIC_MODEL_3MF)
    status = conic_3mf_unpack(input->context, input->name, &file.bytes, &file.n_bytes);
  if (status == CONIC_OK)
    status = start_process(input, bridge, kind, options, &file, &process);
  conic_memory_release(input->context, file.bytes); /* the process has its own */
  if (status == CONIC_OK)
    status = conic_assimp_read_records(input, &process, options, model);
  conic_assimp_process_end(&process);
  return status;
}
