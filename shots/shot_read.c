/* Shots from text: by the table of fields, and strictly. */

#include "core/files/file.h"
#include "core/files/json_read.h"
#include "core/pictures/picture_shot.h"
#include "shots/shot_text.h"

enum { MOST_MEMBERS = 1 << 20, MOST_NUMBERS = 16, MOST_INPUTS = 1 << 16, MOST_REPEATS = 256 };

CONIC_DEFINE_NAMES(conic_shot_role_name, conic_shot_role, CONIC_N_SHOT_ROLES, "scene", "texture", "sky", "motion",
                   "part")

/* A file that was read, and all the memory that it points to. */
typedef struct owned_shot {
  conic_shot_file file; /* the first */
  void **blocks;
  size_t n_blocks, room;
} owned_shot;

typedef struct shot_reader {
  conic_context *context;
  conic_json json;
  owned_shot *owned;
} shot_reader;

static conic_status fail_field(shot_reader *r, const char *format, const char *a, const char *b) {
  char what[256];
  snprintf(what, sizeof what, format, a, b);
  return conic_json_wrong(&r->json, what);
}

/* Memory that goes with the file, all zero. */
static void *own_block(shot_reader *r, size_t count, size_t size) {
  owned_shot *owned = r->owned;
  conic_status status = conic_memory_reserve(r->context, &owned->blocks, owned->n_blocks, owned->n_blocks + 1,
                                             &owned->room, sizeof *owned->blocks);
  void *block = status == CONIC_OK ? conic_memory_allocate_zeroed(r->context, count, size) : NULL;
  if (block)
    owned->blocks[owned->n_blocks++] = block;
  return block;
}

/* --- values --- */

/* A text of any length, which goes with the file. */
static conic_status read_owned_text(shot_reader *r, const char **words) {
  size_t room = conic_json_text_room(&r->json);
  char *to = own_block(r, room, 1);
  if (!to)
    return CONIC_ERROR_MEMORY;
  *words = to;
  return conic_json_text(&r->json, to, room);
}

static conic_status read_field_word(shot_reader *r, const conic_shot_row *row, char *at) {
  char word[64];
  conic_status status = conic_json_text(&r->json, word, sizeof word);
  for (int i = 0; status == CONIC_OK && row->word(i); i++)
    if (strcmp(row->word(i), word) == 0) {
      memcpy(at, &i, sizeof i);
      return CONIC_OK;
    }
  return status == CONIC_OK ? fail_field(r, "%s cannot be '%s'", row->name, word) : status;
}

static conic_status read_plane_words(shot_reader *r, const conic_shot_row *row, char *at) {
  unsigned bits = 0;
  conic_status status = conic_json_begin_array(&r->json);
  while (status == CONIC_OK && conic_json_next_item(&r->json)) {
    int i = 0;
    status = read_field_word(r, row, (char *)&i);
    bits |= 1u << i;
  }
  memcpy(at, &bits, sizeof bits);
  return status == CONIC_OK ? r->json.status : status;
}

/* Null, which is read as NaN, says that there is no bound. */
static conic_status take_null(shot_reader *r, const conic_shot_row *row, const char *at) {
  double bound = 0.0;
  if (row->kind == CONIC_ROW_DOUBLE)
    memcpy(&bound, at, sizeof bound);
  return bound - bound != 0.0 ? CONIC_OK : fail_field(r, "%s has to be a number%s", row->name, "");
}

static conic_status fail_range(shot_reader *r, const conic_shot_row *row, double value) {
  char range[96];
  snprintf(range, sizeof range, "%.10g to %.10g, and not %.10g", row->least, row->most, value);
  return fail_field(r, "%s is %s", row->name, range);
}

/* A number into the member's own type. */
static conic_status put_field_number(shot_reader *r, const conic_shot_row *row, double value, char *at) {
  float rounded = (float)value;
  int is_whole = value >= -9007199254740992.0 && value <= 9007199254740992.0 && value == (double)(int64_t)value;
  if (value != value)
    return take_null(r, row, at);
  if (value - value != 0.0 || (row->kind == CONIC_ROW_FLOAT && rounded - rounded != 0.0f))
    return fail_field(r, "%s is too large%s", row->name, "");
  if ((row->least != 0.0 || row->most != 0.0) && !(value >= row->least && value <= row->most))
    return fail_range(r, row, value);
  if (row->kind == CONIC_ROW_FLOAT) {
    memcpy(at, &rounded, sizeof rounded);
  } else if (row->kind == CONIC_ROW_DOUBLE) {
    memcpy(at, &value, sizeof value);
  } else if (row->kind == CONIC_ROW_INT && is_whole && value >= -2147483648.0 && value <= 2147483647.0) {
    int number = (int)value;
    memcpy(at, &number, sizeof number);
  } else if (row->kind == CONIC_ROW_UINT32 && is_whole && value >= 0.0 && value <= 4294967295.0) {
    uint32_t number = (uint32_t)value;
    memcpy(at, &number, sizeof number);
  } else if (row->kind == CONIC_ROW_UINT64 && is_whole && value >= 0.0) {
    uint64_t number = (uint64_t)value;
    memcpy(at, &number, sizeof number);
  } else
    return fail_field(r, "%s is a whole number%s", row->name, "");
  return CONIC_OK;
}

static conic_status read_field_numbers(shot_reader *r, const conic_shot_row *row, char *at) {
  double values[MOST_NUMBERS];
  size_t n = conic_row_count(row), n_read = 0, columns = row->columns ? (size_t)row->columns : n;
  conic_status status = CONIC_OK;
  if (n == 1) {
    status = conic_json_number(&r->json, values);
  } else if (columns == n) {
    status = conic_json_numbers(&r->json, values, n, &n_read);
  } else {
    status = conic_json_begin_array(&r->json);
    for (size_t i = 0, n_row; status == CONIC_OK && conic_json_next_item(&r->json); i += columns) {
      if (i + columns > n)
        return fail_field(r, "%s has too many rows%s", row->name, "");
      status = conic_json_numbers(&r->json, values + i, columns, &n_row);
      n_read += n_row == columns ? columns : n + 1;
    }
  }
  if (status == CONIC_OK)
    status = r->json.status;
  if (status == CONIC_OK && n > 1 && n_read != n)
    return fail_field(r, "%s has another number of values%s", row->name, "");
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    status = put_field_number(r, row, values[i], at + i * (row->bytes / n));
  return status;
}

/* --- structs --- */

static conic_status read_fields(shot_reader *r, const conic_shot_rows *rows, char *value);

static conic_status read_pointer(shot_reader *r, const conic_shot_row *row, char *at) {
  conic_standard standard;
  char *to = own_block(r, 1, row->of->size);
  if (!to)
    return CONIC_ERROR_MEMORY;
  conic_rows_standard(row->of, &standard);
  memcpy(to, standard.bytes, row->of->size);
  memcpy(at, &to, sizeof to);
  return read_fields(r, row->of, to);
}

static conic_status read_list(shot_reader *r, const conic_shot_row *row, char *value) {
  conic_standard standard;
  const size_t size = row->of->size, most = row->is_apart ? MOST_MEMBERS : row->bytes / size;
  char *members = NULL, *at = value + row->offset;
  size_t n = 0, room = 0;
  conic_rows_standard(row->of, &standard);
  conic_status status = conic_json_begin_array(&r->json);
  while (status == CONIC_OK && conic_json_next_item(&r->json)) {
    if (n == most)
      status = fail_field(r, "%s has too many members%s", row->name, "");
    else
      status = conic_memory_reserve(r->context, &members, n, n + 1, &room, size);
    if (status == CONIC_OK) {
      /* NOLINTNEXTLINE(clang-analyzer-core.NonNullParamChecker): no member is empty */
      memcpy(members + n * size, standard.bytes, size);
      status = read_fields(r, row->of, members + n++ * size);
    }
  }
  if (status == CONIC_OK)
    status = r->json.status;
  char *to = status == CONIC_OK && row->is_apart ? own_block(r, n ? n : 1, size) : at;
  if (status == CONIC_OK && !to)
    status = CONIC_ERROR_MEMORY;
  if (status == CONIC_OK && n)
    memcpy(to, members, n * size);
  conic_memory_release(r->context, members);
  if (status != CONIC_OK)
    return status;
  uint64_t long_length = n;
  int length = (int)n;
  if (row->is_apart)
    memcpy(at, &to, sizeof to);
  if (row->length_is_64)
    memcpy(value + row->length, &long_length, sizeof long_length);
  else
    memcpy(value + row->length, &length, sizeof length);
  return CONIC_OK;
}

/* Whether it is null is all that there is to know. */
static conic_status read_presence(shot_reader *r, char *at) {
  int is_there = 0;
  conic_status status = conic_json_truth(&r->json, &is_there);
  const void *to = is_there ? (const void *)r->owned : NULL;
  memcpy(at, &to, sizeof to);
  return status;
}

static conic_status read_truth(shot_reader *r, char *at) {
  int truth = 0;
  conic_status status = conic_json_truth(&r->json, &truth);
  memcpy(at, &truth, sizeof truth);
  return status;
}

static conic_status read_text(shot_reader *r, char *at) {
  const char *words = NULL;
  conic_status status = read_owned_text(r, &words);
  memcpy(at, &words, sizeof words);
  return status;
}

static conic_status read_field(shot_reader *r, const conic_shot_row *row, char *value) {
  /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): a length has the row of its list behind it */
  char *at = value + row->offset;
  return row->kind == CONIC_ROW_STRUCT    ? read_fields(r, row->of, at)
         : row->kind == CONIC_ROW_POINTER ? read_pointer(r, row, at)
         : row->kind == CONIC_ROW_LIST    ? read_list(r, row, value)
         : row->kind == CONIC_ROW_WORD    ? read_field_word(r, row, at)
         : row->kind == CONIC_ROW_PLANES  ? read_plane_words(r, row, at)
         : row->kind == CONIC_ROW_HAS     ? read_presence(r, at)
         : row->kind == CONIC_ROW_TRUTH   ? read_truth(r, at)
         : row->kind == CONIC_ROW_TEXT    ? read_text(r, at)
                                          : read_field_numbers(r, row, at);
}

static const conic_shot_row *find_shot_row(const conic_shot_rows *rows, const char *key) {
  for (size_t i = 0; i < rows->n_rows; i++)
    if (rows->rows[i].kind < CONIC_ROW_LENGTH && strcmp(rows->rows[i].name, key) == 0)
      return &rows->rows[i];
  return NULL;
}

/* Each field of a struct stands once. */
static conic_status note_field(shot_reader *r, const char *key, uint64_t bit, uint64_t *is_read) {
  if (*is_read & bit)
    return fail_field(r, "the field '%s' stands twice%s", key, "");
  *is_read |= bit;
  return CONIC_OK;
}

static uint64_t bit_of(const conic_shot_rows *rows, const conic_shot_row *row) {
  return UINT64_C(1) << (row - rows->rows);
}

/* What has to be said was, and what was said can be. */
static conic_status check_fields(shot_reader *r, const conic_shot_rows *rows, const void *value, uint64_t is_read) {
  for (size_t i = 0; i < rows->n_rows; i++)
    if (rows->rows[i].is_said && !(is_read & bit_of(rows, &rows->rows[i])))
      return fail_field(r, "'%s' is missing%s", rows->rows[i].name, "");
  const char *fault = rows->fault ? rows->fault(value) : NULL;
  return fault ? conic_json_wrong(&r->json, fault) : CONIC_OK;
}

static conic_status read_fields(shot_reader *r, const conic_shot_rows *rows, char *value) {
  char key[CONIC_JSON_KEY_ROOM];
  uint64_t is_read = 0; /* bits of rows */
  conic_status status = conic_json_begin_object(&r->json);
  while (status == CONIC_OK && conic_json_next_member(&r->json, key)) {
    const conic_shot_row *row = find_shot_row(rows, key);
    status = row ? note_field(r, key, bit_of(rows, row), &is_read) : fail_field(r, "there is no field '%s'%s", key, "");
    if (status == CONIC_OK)
      status = read_field(r, row, value);
  }
  if (status == CONIC_OK)
    status = r->json.status;
  return status == CONIC_OK ? check_fields(r, rows, value, is_read) : status;
}

/* --- the file --- */

static conic_status read_role(shot_reader *r, conic_shot_input *input) {
  char word[CONIC_JSON_KEY_ROOM];
  conic_status status = conic_json_text(&r->json, word, sizeof word);
  for (int i = 0; i < CONIC_N_SHOT_ROLES && status == CONIC_OK; i++)
    if (strcmp(word, conic_shot_role_name((conic_shot_role)i)) == 0) {
      input->role = (conic_shot_role)i;
      return CONIC_OK;
    }
  return status == CONIC_OK ? fail_field(r, "an input cannot be '%s'%s", word, "") : status;
}

static conic_status read_hash(shot_reader *r, conic_shot_input *input) {
  conic_status status = conic_json_text(&r->json, input->sha256, sizeof input->sha256);
  int is_hash = strspn(input->sha256, "0123456789abcdef") == 64 && !input->sha256[64];
  return status == CONIC_OK && !is_hash ? fail_field(r, "sha256 has 64 digits%s%s", "", "") : status;
}

static conic_status read_length(shot_reader *r, conic_shot_input *input) {
  static const conic_shot_row row = {CONIC_ROW_UINT64, "bytes", .bytes = sizeof(uint64_t), .most = 0x1p53};
  return read_field_numbers(r, &row, (char *)&input->n_bytes);
}

static conic_status read_shot_input(shot_reader *r, conic_shot_input *input) {
  static const char *const keys[] = {"name", "as", "bytes", "sha256", "sampled"};
  enum { NAME, ROLE, LENGTH, HASH, SAMPLED, N_KEYS };
  char key[CONIC_JSON_KEY_ROOM];
  uint64_t is_read = 0;
  memset(input, 0, sizeof *input);
  conic_status status = conic_json_begin_object(&r->json);
  while (status == CONIC_OK && conic_json_next_member(&r->json, key)) {
    int i = 0;
    while (i < N_KEYS && strcmp(key, keys[i]) != 0)
      i++;
    status = i < N_KEYS ? note_field(r, key, UINT64_C(1) << i, &is_read)
                        : fail_field(r, "there is no field '%s' of an input%s", key, "");
    if (status == CONIC_OK)
      status = i == NAME     ? read_owned_text(r, &input->name)
               : i == ROLE   ? read_role(r, input)
               : i == LENGTH ? read_length(r, input)
               : i == HASH   ? read_hash(r, input)
                             : conic_json_truth(&r->json, &input->is_sampled);
  }
  if (status == CONIC_OK)
    status = r->json.status;
  return status == CONIC_OK && !input->name ? fail_field(r, "an input has no name%s%s", "", "") : status;
}

static int compare_names(const void *a, const void *b) {
  return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Nobody draws one file so many times, and who did would wait for days. */
static conic_status check_repeats(shot_reader *r, const conic_shot_input *inputs, size_t n) {
  const char **names = conic_memory_allocate(r->context, n, sizeof *names);
  conic_status status = names ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (size_t i = 0; names && i < n; i++)
    names[i] = inputs[i].name;
  if (names)
    qsort(names, n, sizeof *names, compare_names);
  for (size_t i = MOST_REPEATS; i < n && status == CONIC_OK; i++)
    if (strcmp(names[i], names[i - MOST_REPEATS]) == 0)
      status = fail_field(r, "the input '%.100s' stands too many times%s", names[i], "");
  conic_memory_release(r->context, names);
  return status;
}

static conic_status read_inputs(shot_reader *r) {
  conic_shot_input *inputs = NULL;
  size_t n = 0, room = 0;
  conic_status status = conic_json_begin_array(&r->json);
  while (status == CONIC_OK && conic_json_next_item(&r->json)) {
    status = n == MOST_INPUTS ? fail_field(r, "there are too many inputs%s%s", "", "")
                              : conic_memory_reserve(r->context, &inputs, n, n + 1, &room, sizeof *inputs);
    if (status == CONIC_OK)
      status = read_shot_input(r, &inputs[n++]);
  }
  if (status == CONIC_OK)
    status = r->json.status;
  if (status == CONIC_OK)
    status = check_repeats(r, inputs, n);
  conic_shot_input *kept = status == CONIC_OK && n ? own_block(r, n, sizeof *inputs) : NULL;
  if (status == CONIC_OK && n && !kept)
    status = CONIC_ERROR_MEMORY;
  if (kept)
    memcpy(kept, inputs, n * sizeof *inputs);
  r->owned->file.inputs = kept;
  r->owned->file.n_inputs = kept ? n : 0;
  conic_memory_release(r->context, inputs);
  return status;
}

static conic_status read_version(shot_reader *r) {
  double version;
  char what[128];
  conic_status status = conic_json_number(&r->json, &version);
  if (status != CONIC_OK || version == (double)CONIC_SHOT_VERSION)
    return status;
  snprintf(what, sizeof what, "it is a shot of version %g, and this conic reads version %d", version,
           CONIC_SHOT_VERSION);
  return conic_json_wrong(&r->json, what);
}

/* What stands beside the members of the struct. */
enum { VERSION, WRITER, INPUTS, N_BESIDE };
static const char *const beside[N_BESIDE] = {[VERSION] = "conic_shot", [WRITER] = "conic", [INPUTS] = "inputs"};

static conic_status read_beside(shot_reader *r, int i) {
  char word[CONIC_JSON_KEY_ROOM];
  return i == VERSION ? read_version(r) : i == WRITER ? conic_json_text(&r->json, word, sizeof word) : read_inputs(r);
}

/* Members of the shot stand beside those of the file; what was read of the file's, of the shot's, and else. */
static conic_status read_shot_member(shot_reader *r, const char *key, uint64_t is_read[3]) {
  const conic_shot_rows *file_rows = &conic_shot_file_rows;
  const conic_shot_row *shot = &file_rows->rows[1];
  const conic_shot_row *of_shot = find_shot_row(shot->of, key), *of_file = find_shot_row(file_rows, key);
  char *file = (char *)&r->owned->file;
  int i = 0;
  while (i < N_BESIDE && strcmp(key, beside[i]) != 0)
    i++;
  if (i != VERSION && !is_read[2])
    return fail_field(r, "a shot begins with its version, \"conic_shot\", and not with '%s'%s", key, "");
  if (i == N_BESIDE && !of_shot && (!of_file || of_file == shot))
    return fail_field(r, "there is no field '%s'%s", key, "");
  conic_status status = i < N_BESIDE ? note_field(r, key, UINT64_C(1) << i, &is_read[2])
                        : of_shot    ? note_field(r, key, bit_of(shot->of, of_shot), &is_read[1])
                                     : note_field(r, key, bit_of(file_rows, of_file), &is_read[0]);
  if (status != CONIC_OK)
    return status;
  return i < N_BESIDE ? read_beside(r, i)
         : of_shot    ? read_field(r, of_shot, file + shot->offset)
                      : read_field(r, of_file, file);
}

static conic_status read_shot(shot_reader *r) {
  char key[CONIC_JSON_KEY_ROOM];
  uint64_t is_read[3] = {0, 0, 0};
  conic_status status = conic_json_begin_object(&r->json);
  while (status == CONIC_OK && conic_json_next_member(&r->json, key))
    status = read_shot_member(r, key, is_read);
  if (status == CONIC_OK)
    status = r->json.status;
  if (status == CONIC_OK)
    status = check_fields(r, conic_shot_file_rows.rows[1].of, &r->owned->file.shot, is_read[1]);
  if (status == CONIC_OK)
    status = conic_json_end(&r->json);
  if (status == CONIC_OK && !is_read[2])
    status = fail_field(r, "it is no shot%s%s", "", "");
  if (r->owned->file.reading.gaussians)
    r->owned->file.reading.gaussians = &r->owned->file.shot.gaussians;
  return status;
}

conic_status conic_shot_file_parse(conic_context *context, const char *name, const char *text, size_t n_bytes,
                                   conic_shot_file **file) {
  shot_reader r = {.context = context};
  *file = NULL;
  r.owned = conic_memory_allocate_zeroed(context, 1, sizeof *r.owned);
  if (!r.owned)
    return CONIC_ERROR_MEMORY;
  conic_shot_file_init(&r.owned->file);
  conic_status status = conic_json_take(context, name ? name : "shot", text, n_bytes, &r.json);
  if (status == CONIC_OK) {
    r.json.is_silent = !name;
    status = read_shot(&r);
    conic_json_close(&r.json);
  }
  if (status == CONIC_OK)
    *file = &r.owned->file;
  else
    conic_shot_file_destroy(context, &r.owned->file);
  return status;
}

void conic_shot_file_destroy(conic_context *context, conic_shot_file *file) {
  owned_shot *owned = (owned_shot *)file;
  if (!owned)
    return;
  for (size_t i = 0; i < owned->n_blocks; i++)
    conic_memory_release(context, owned->blocks[i]);
  conic_memory_release_these(context, owned->blocks, owned);
}

int conic_shot_is_file(const char *path) {
  char head[257] = "";
  size_t n = strcmp(path, "-") != 0 ? conic_file_read_head(path, (unsigned char *)head, sizeof head - 1) : 0;
  const char *key = n ? strstr(head, "\"conic_shot\"") : NULL;
  return key && head[strspn(head, " \t\r\n")] == '{';
}

conic_status conic_shot_file_read(conic_context *context, const char *path, conic_shot_file **file) {
  char *text = NULL;
  size_t n_bytes = 0;
  *file = NULL;
  conic_status status = conic_picture_shot_text(context, path, &text, &n_bytes);
  if (status == CONIC_OK && !text)
    status = conic_fail(context, CONIC_ERROR_INPUT,
                        "%s: does not say how it was made: it is neither a shot nor a picture that carries one", path);
  if (status == CONIC_OK)
    status = conic_shot_file_parse(context, path, text, n_bytes, file);
  conic_memory_release(context, text);
  return status;
}
