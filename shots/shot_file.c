#include "conic/version.h"
#include "core/files/file.h"
#include "shots/shot_text.h"

typedef struct shot_writer {
  conic_text text;
  conic_shot_text what;
  int has_members; /* of the object at hand */
} shot_writer;

static void begin_member(shot_writer *w, const char *name, int depth) {
  conic_text_print(&w->text, "%s\n%*s\"%s\": ", w->has_members ? "," : "", 2 * depth, "", name);
  w->has_members = 1;
}

static void write_fields(shot_writer *w, const conic_shot_rows *rows, const void *value, const void *standard,
                         int depth);

/* Writes an object, or, if it has no members, and nobody needs it, nothing. Returns whether it did. */
static int write_object(shot_writer *w, const char *name, const conic_shot_rows *rows, const void *value,
                        const void *standard, int depth) {
  size_t n_before = w->text.n;
  int had_members = w->has_members;
  if (name)
    begin_member(w, name, depth);
  conic_text_say(&w->text, "{");
  w->has_members = 0;
  write_fields(w, rows, value, standard, depth + 1);
  int has_members = w->has_members;
  if (has_members)
    conic_text_print(&w->text, "\n%*s", 2 * depth, "");
  conic_text_say(&w->text, "}");
  w->has_members = 1;
  if (has_members || !name)
    return 1;
  w->has_members = had_members;
  w->text.n = n_before;
  return 0;
}

static void write_field_list(shot_writer *w, const conic_shot_row *row, const void *value, int depth) {
  conic_standard standard;
  const char *first = (const char *)value + row->offset;
  size_t n = conic_row_length(row, value);
  if (n == 0)
    return;
  if (row->is_apart)
    memcpy(&first, (const void *)first, sizeof first);
  conic_rows_standard(row->of, &standard);
  begin_member(w, row->name, depth);
  for (size_t i = 0; i < n; i++) {
    conic_text_print(&w->text, "%s\n%*s", i ? "," : "[", 2 * depth + 2, "");
    write_object(w, NULL, row->of, first + i * row->of->size, standard.bytes, depth + 1);
  }
  conic_text_print(&w->text, "\n%*s]", 2 * depth, "");
}

static void write_pointer(shot_writer *w, const conic_shot_row *row, const void *value, int depth) {
  conic_standard standard;
  const void *to;
  memcpy(&to, (const char *)value + row->offset, sizeof to);
  conic_rows_standard(row->of, &standard);
  if (to)
    write_object(w, row->name, row->of, to, standard.bytes, depth);
}

/* Of a map there is no camera yet. */
static int is_missing_camera(const conic_shot_row *row, const void *value) {
  return strcmp(row->name, "camera") == 0 && conic_is_zero(value, sizeof(conic_camera));
}

static void write_fields(shot_writer *w, const conic_shot_rows *rows, const void *value, const void *standard,
                         int depth) {
  for (size_t i = 0; i < rows->n_rows; i++) {
    const conic_shot_row *row = &rows->rows[i];
    const char *at = (const char *)value + row->offset, *like = (const char *)standard + row->offset;
    if (row->kind >= CONIC_ROW_LENGTH)
      continue;
    if (row->kind == CONIC_ROW_LIST) {
      write_field_list(w, row, value, depth);
    } else if (row->kind == CONIC_ROW_POINTER) {
      write_pointer(w, row, value, depth);
    } else if (row->kind == CONIC_ROW_STRUCT && rows == &conic_shot_file_rows && i == 1) {
      write_fields(w, row->of, at, like, depth);
    } else if (row->kind == CONIC_ROW_STRUCT) {
      if (!is_missing_camera(row, at))
        write_object(w, row->name, row->of, at, like, depth);
    } else if (row->is_said || (w->what == CONIC_SHOT_COMPLETE && row->kind != CONIC_ROW_TEXT) ||
               !conic_row_is_same(row, value, standard)) {
      begin_member(w, row->name, depth);
      conic_text_value(&w->text, row, value);
    }
  }
}

static const char *name_of_input(const shot_writer *w, const conic_shot_input *input) {
  int is_plain = w->what == CONIC_SHOT_IN_PICTURE && input->role != CONIC_SHOT_PART && !strstr(input->name, "://");
  return is_plain ? conic_file_name(input->name) : input->name;
}

static void write_inputs(shot_writer *w, const conic_shot_file *file) {
  if (file->n_inputs == 0)
    return;
  begin_member(w, "inputs", 1);
  for (size_t i = 0; i < file->n_inputs; i++) {
    const conic_shot_input *input = &file->inputs[i];
    conic_text_print(&w->text, "%s\n    {\"name\": ", i ? "," : "[");
    conic_text_quote(&w->text, name_of_input(w, input));
    if (input->role != CONIC_SHOT_SCENE)
      conic_text_print(&w->text, ", \"as\": \"%s\"", conic_shot_role_name(input->role));
    if (input->n_bytes)
      conic_text_print(&w->text, ", \"bytes\": %llu", (unsigned long long)input->n_bytes);
    if (*input->sha256)
      conic_text_print(&w->text, ", \"sha256\": \"%s\"", input->sha256);
    conic_text_say(&w->text, input->is_sampled ? ", \"sampled\": true}" : "}");
  }
  conic_text_say(&w->text, "\n  ]");
}

conic_status conic_shot_file_print(conic_context *context, const conic_shot_file *file, conic_shot_text what,
                                   char **text) {
  shot_writer w = {.text = {.context = context}, .what = what};
  conic_shot_file standard;
  *text = NULL;
  if (!file || file->size != sizeof *file)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "the shot's file was not initialised");
  conic_shot_file_init(&standard);
  conic_text_say(&w.text, "{");
  begin_member(&w, "conic_shot", 1);
  conic_text_print(&w.text, "%d", CONIC_SHOT_VERSION);
  begin_member(&w, "conic", 1);
  conic_text_quote(&w.text, conic_version());
  write_inputs(&w, file);
  write_fields(&w, &conic_shot_file_rows, file, &standard, 1);
  conic_text_say(&w.text, "\n}\n");
  if (w.text.status == CONIC_OK)
    *text = w.text.bytes;
  else
    conic_text_release(&w.text);
  return w.text.status;
}

void conic_shot_text_release(conic_context *context, char *text) {
  conic_memory_release(context, text);
}

conic_status conic_shot_file_write(conic_context *context, const conic_shot_file *file, const char *path) {
  conic_output *output;
  char *text;
  conic_status status = conic_shot_file_print(context, file, CONIC_SHOT_WHOLE, &text);
  if (status == CONIC_OK)
    status = conic_output_open(context, path, &output);
  if (status == CONIC_OK) {
    fputs(text, conic_output_stream(output)); /* which remembers what fails, and commit says so */
    status = conic_output_commit(output);
  }
  conic_shot_text_release(context, text);
  return status;
}
