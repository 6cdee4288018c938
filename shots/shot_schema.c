/* What the fields are, for others: one by one, and as a JSON schema. */

#include "shots/shot_text.h"

/* --- one by one --- */

typedef struct field_finding {
  size_t left; /* fields to pass over */
  conic_shot_field *field;
  int is_found;
} field_finding;

static conic_shot_field_kind kind_of_field(const conic_shot_row *row) {
  static const conic_shot_field_kind kinds[] = {
      [CONIC_ROW_INT] = CONIC_SHOT_FIELD_INTEGER,    [CONIC_ROW_UINT32] = CONIC_SHOT_FIELD_INTEGER,
      [CONIC_ROW_UINT64] = CONIC_SHOT_FIELD_INTEGER, [CONIC_ROW_FLOAT] = CONIC_SHOT_FIELD_FLOAT,
      [CONIC_ROW_DOUBLE] = CONIC_SHOT_FIELD_DOUBLE,  [CONIC_ROW_TRUTH] = CONIC_SHOT_FIELD_TRUTH,
      [CONIC_ROW_HAS] = CONIC_SHOT_FIELD_TRUTH,      [CONIC_ROW_WORD] = CONIC_SHOT_FIELD_WORD,
      [CONIC_ROW_PLANES] = CONIC_SHOT_FIELD_WORDS,   [CONIC_ROW_TEXT] = CONIC_SHOT_FIELD_TEXT};
  return kinds[row->kind];
}

static void take_field(field_finding *f, const char *path, const conic_shot_row *row, const void *standard) {
  if (f->is_found || f->left-- > 0)
    return;
  f->is_found = 1;
  memset(f->field, 0, sizeof *f->field);
  snprintf(f->field->path, sizeof f->field->path, "%s", path);
  f->field->kind = kind_of_field(row);
  f->field->count = (int)conic_row_count(row);
  f->field->unit = row->unit;
  f->field->meaning = row->meaning;
  for (int i = 0; row->word && i < CONIC_MAX_SHOT_WORDS - 1; i++)
    f->field->words[i] = row->word(i);
  conic_text standard_text = {.bytes = f->field->standard, .room = sizeof f->field->standard};
  if (!row->is_said)
    conic_text_value(&standard_text, row, standard);
}

static void find_in_rows(field_finding *f, const conic_shot_rows *rows, const void *standard, const char *before) {
  /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): a row of this kind has rows of its own */
  for (size_t i = 0; i < rows->n_rows && !f->is_found; i++) {
    const conic_shot_row *row = &rows->rows[i];
    conic_standard own;
    char path[96];
    if (row->kind >= CONIC_ROW_LENGTH)
      continue;
    int is_shot = rows == &conic_shot_file_rows && i == 1, has_rows = row->of != NULL;
    snprintf(path, sizeof path, "%.60s%s%s%s", before, is_shot ? "" : row->name,
             row->kind == CONIC_ROW_LIST ? "[]" : "", has_rows && !is_shot ? "." : "");
    if (row->kind == CONIC_ROW_LIST || row->kind == CONIC_ROW_POINTER) {
      conic_rows_standard(row->of, &own);
      find_in_rows(f, row->of, own.bytes, path);
    } else if (has_rows)
      find_in_rows(f, row->of, (const char *)standard + row->offset, path);
    else
      take_field(f, path, row, standard);
  }
}

int conic_shot_field_at(size_t i, conic_shot_field *field) {
  conic_shot_file standard;
  field_finding f = {.left = i, .field = field};
  conic_shot_file_init(&standard);
  find_in_rows(&f, &conic_shot_file_rows, &standard, "");
  return f.is_found;
}

/* --- as a schema --- */

static void add_schema(conic_text *text, const conic_shot_rows *rows, const void *standard, int depth);

static void add_type(conic_text *text, const conic_shot_row *row) {
  static const char *const types[] = {[CONIC_SHOT_FIELD_TRUTH] = "\"type\": \"boolean\"",
                                      [CONIC_SHOT_FIELD_INTEGER] = "\"type\": \"integer\"",
                                      [CONIC_SHOT_FIELD_FLOAT] = "\"type\": [\"number\", \"null\"]",
                                      [CONIC_SHOT_FIELD_DOUBLE] = "\"type\": [\"number\", \"null\"]",
                                      [CONIC_SHOT_FIELD_TEXT] = "\"type\": \"string\""};
  int n = (int)conic_row_count(row), columns = row->columns ? row->columns : n;
  if (row->word) {
    conic_text_say(text,
                   row->kind == CONIC_ROW_PLANES ? "\"type\": \"array\", \"items\": {\"enum\": [" : "\"enum\": [");
    for (int i = 0; row->word(i); i++) {
      conic_text_say(text, i ? ", " : "");
      conic_text_quote(text, row->word(i));
    }
    conic_text_say(text, row->kind == CONIC_ROW_PLANES ? "]}" : "]");
    return;
  }
  for (int left = n; left > 1; left = left == n && columns < n ? columns : 1)
    conic_text_print(text, "\"type\": \"array\", \"minItems\": %d, \"maxItems\": %d, \"items\": {",
                     left == n ? n / columns == 1 ? n : n / columns : columns,
                     left == n ? n / columns == 1 ? n : n / columns : columns);
  conic_text_say(text, types[kind_of_field(row)]);
  if (row->least != 0.0 || row->most != 0.0)
    conic_text_print(text, ", \"minimum\": %.10g, \"maximum\": %.10g", row->least, row->most);
  for (int left = n; left > 1; left = left == n && columns < n ? columns : 1)
    conic_text_say(text, "}");
}

static void begin_property(conic_text *text, const conic_shot_row *row, int is_first, int depth) {
  conic_text_print(text, "%s\n%*s", is_first ? "" : ",", 2 * depth, "");
  conic_text_quote(text, row->name);
  conic_text_say(text, ": {\"description\": ");
  conic_text_quote(text, row->meaning);
  if (row->unit)
    conic_text_print(text, ", \"$comment\": \"unit: %s\"", row->unit);
  conic_text_say(text, ", ");
}

static void add_properties(conic_text *text, const conic_shot_rows *rows, const void *standard, int depth,
                           int is_first) {
  for (size_t i = 0; i < rows->n_rows; i++) {
    const conic_shot_row *row = &rows->rows[i];
    const char *at = (const char *)standard + row->offset;
    conic_standard own;
    if (row->kind >= CONIC_ROW_LENGTH)
      continue;
    if (rows == &conic_shot_file_rows && i == 1) {
      add_properties(text, row->of, at, depth, is_first);
      is_first = 0;
      continue;
    }
    begin_property(text, row, is_first, depth);
    is_first = 0;
    if (row->kind == CONIC_ROW_LIST || row->kind == CONIC_ROW_POINTER) {
      conic_rows_standard(row->of, &own);
      at = (const char *)own.bytes;
    }
    if (row->kind == CONIC_ROW_LIST)
      conic_text_say(text, "\"type\": \"array\", \"items\": {");
    if (row->of)
      add_schema(text, row->of, at, depth);
    else {
      add_type(text, row);
      if (!row->is_said && row->kind != CONIC_ROW_TEXT) {
        conic_text_say(text, ", \"default\": ");
        conic_text_value(text, row, standard);
      }
    }
    conic_text_say(text, row->kind == CONIC_ROW_LIST ? "}}" : "}");
  }
}

static void add_schema(conic_text *text, const conic_shot_rows *rows, const void *standard, int depth) {
  conic_text_say(text, "\"type\": \"object\", \"additionalProperties\": false, \"properties\": {");
  add_properties(text, rows, standard, depth + 1, 1);
  conic_text_print(text, "\n%*s}", 2 * depth, "");
}

static const char schema_head[] =
    "{\n"
    "  \"$schema\": \"https://json-schema.org/draft/2020-12/schema\",\n"
    "  \"title\": \"a shot of conic\",\n"
    "  \"description\": \"All that decides a picture. What is left out is as `default` says.\",\n"
    "  \"type\": \"object\",\n"
    "  \"required\": [\"conic_shot\"],\n"
    "  \"additionalProperties\": false,\n"
    "  \"properties\": {\n"
    "    \"conic_shot\": {\"description\": \"the version of this text\", \"const\": ";

static const char schema_inputs[] =
    "},\n"
    "    \"conic\": {\"description\": \"the version that wrote it\", \"type\": \"string\"},\n"
    "    \"inputs\": {\"description\": \"the files that it is made of\", \"type\": \"array\", \"items\": {\n"
    "      \"type\": \"object\", \"required\": [\"name\"], \"additionalProperties\": false, \"properties\": {\n"
    "        \"name\": {\"description\": \"a file, a folder or a URL\", \"type\": \"string\"},\n"
    "        \"as\": {\"description\": \"what it is to the picture\", \"enum\": [\"scene\", \"texture\", \"sky\", "
    "\"motion\", \"part\"], \"default\": \"scene\"},\n"
    "        \"bytes\": {\"description\": \"its length\", \"type\": \"integer\"},\n"
    "        \"sha256\": {\"description\": \"the hash of what it holds\", \"type\": \"string\"},\n"
    "        \"sampled\": {\"description\": \"the hash is of its length, its time and 64 pieces\", \"type\": "
    "\"boolean\", \"default\": false}}}},";

conic_status conic_shot_schema_print(conic_context *context, char **text) {
  conic_text schema = {.context = context};
  conic_shot_file standard;
  conic_shot_file_init(&standard);
  conic_text_say(&schema, schema_head);
  conic_text_print(&schema, "%d", CONIC_SHOT_VERSION);
  conic_text_say(&schema, schema_inputs);
  add_properties(&schema, &conic_shot_file_rows, &standard, 2, 1);
  conic_text_say(&schema, "\n  }\n}\n");
  *text = schema.status == CONIC_OK ? schema.bytes : NULL;
  if (schema.status != CONIC_OK)
    conic_text_release(&schema);
  return schema.status;
}
