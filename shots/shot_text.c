#include "shots/shot_text.h"

#include <stdarg.h>

#include "core/files/number.h"

void conic_text_add(conic_text *text, const char *bytes, size_t n) {
  if (text->sum) {
    conic_sha256_add(text->sum, bytes, n);
    return;
  }
  if (!text->context && text->n + n + 1 > text->room)
    text->status = CONIC_ERROR_MEMORY;
  if (text->status == CONIC_OK && text->context)
    text->status = conic_memory_reserve(text->context, &text->bytes, text->n, text->n + n + 1, &text->room, 1);
  if (text->status != CONIC_OK)
    return;
  memcpy(text->bytes + text->n, bytes, n);
  text->n += n;
  text->bytes[text->n] = '\0';
}

void conic_text_say(conic_text *text, const char *words) {
  conic_text_add(text, words, strlen(words));
}

void conic_text_print(conic_text *text, const char *format, ...) {
  char bytes[512];
  va_list arguments;
  va_start(arguments, format);
  int n = vsnprintf(bytes, sizeof bytes, format, arguments);
  va_end(arguments);
  conic_text_add(text, bytes, n < 0 ? 0 : (size_t)n < sizeof bytes ? (size_t)n : sizeof bytes - 1);
}

void conic_text_quote(conic_text *text, const char *words) {
  conic_text_say(text, "\"");
  for (; *words; words++) {
    if (*words == '"' || *words == '\\')
      conic_text_print(text, "\\%c", *words);
    else if ((unsigned char)*words < ' ')
      conic_text_print(text, "\\u%04x", (unsigned)(unsigned char)*words);
    else
      conic_text_add(text, words, 1);
  }
  conic_text_say(text, "\"");
}

void conic_text_release(conic_text *text) {
  conic_memory_release(text->context, text->bytes);
  text->bytes = NULL;
  text->n = text->room = 0;
}

/* --- values --- */

static void add_real(conic_text *text, const conic_shot_row *row, const char *at) {
  char digits[CONIC_NUMBER_ROOM] = "null";
  double value;
  float number;
  if (row->kind == CONIC_ROW_FLOAT) {
    memcpy(&number, at, sizeof number);
    if (number - number == 0.0f)
      conic_number_print_float(digits, number);
  } else {
    memcpy(&value, at, sizeof value);
    if (value - value == 0.0)
      conic_number_print(digits, value);
  }
  conic_text_say(text, digits);
}

static int int_at(const char *at) {
  int value;
  memcpy(&value, at, sizeof value);
  return value;
}

static void add_one_word(conic_text *text, const conic_shot_row *row, const char *at) {
  const char *word = row->word(int_at(at));
  if (word)
    conic_text_quote(text, word);
  else
    conic_text_print(text, "%d", int_at(at));
}

static void add_plane_words(conic_text *text, const conic_shot_row *row, const char *at) {
  unsigned bits = (unsigned)int_at(at);
  const char *between = "";
  conic_text_say(text, "[");
  for (int i = 0; i < 32; i++) {
    const char *word = bits >> i & 1 ? row->word(i) : NULL;
    if (!word)
      continue;
    conic_text_say(text, between);
    conic_text_quote(text, word);
    between = ", ";
  }
  conic_text_say(text, "]");
}

static const char *text_at(const conic_shot_row *row, const void *value) {
  const char *words;
  memcpy(&words, (const char *)value + row->offset, sizeof words);
  return words;
}

static void add_one(conic_text *text, const conic_shot_row *row, const char *at) {
  uint64_t number;
  uint32_t small;
  if (row->kind == CONIC_ROW_INT) {
    conic_text_print(text, "%d", int_at(at));
  } else if (row->kind == CONIC_ROW_TRUTH) {
    conic_text_say(text, int_at(at) ? "true" : "false");
  } else if (row->kind == CONIC_ROW_UINT32) {
    memcpy(&small, at, sizeof small);
    conic_text_print(text, "%lu", (unsigned long)small);
  } else if (row->kind == CONIC_ROW_UINT64) {
    memcpy(&number, at, sizeof number);
    conic_text_print(text, "%llu", (unsigned long long)number);
  } else
    add_real(text, row, at);
}

void conic_text_value(conic_text *text, const conic_shot_row *row, const void *value) {
  const char *at = (const char *)value + row->offset;
  size_t n = conic_row_count(row), columns = (size_t)row->columns;
  if (row->kind == CONIC_ROW_WORD) {
    add_one_word(text, row, at);
  } else if (row->kind == CONIC_ROW_PLANES) {
    add_plane_words(text, row, at);
  } else if (row->kind == CONIC_ROW_HAS) {
    conic_text_say(text, text_at(row, value) ? "true" : "false");
  } else if (row->kind == CONIC_ROW_TEXT) {
    if (text_at(row, value))
      conic_text_quote(text, text_at(row, value));
    else
      conic_text_say(text, "null");
  } else if (n == 1) {
    add_one(text, row, at);
  } else {
    conic_text_say(text, "[");
    for (size_t i = 0; i < n; i++) {
      int begins = columns && i % columns == 0, ends = columns && (i + 1) % columns == 0;
      conic_text_print(text, "%s%s", i ? ", " : "", begins ? "[" : "");
      add_one(text, row, at + i * (row->bytes / n));
      conic_text_say(text, ends ? "]" : "");
    }
    conic_text_say(text, "]");
  }
}

int conic_row_is_same(const conic_shot_row *row, const void *a, const void *b) {
  if (row->kind == CONIC_ROW_TEXT) {
    const char *first = text_at(row, a), *second = text_at(row, b);
    return first == second || (first && second && strcmp(first, second) == 0);
  }
  if (row->kind == CONIC_ROW_HAS)
    return !text_at(row, a) == !text_at(row, b);
  if (row->kind == CONIC_ROW_TRUTH)
    return !int_at((const char *)a + row->offset) == !int_at((const char *)b + row->offset);
  return memcmp((const char *)a + row->offset, (const char *)b + row->offset, row->bytes) == 0;
}

/* --- visiting --- */

enum { PATH_ROOM = 160 };

typedef struct visiting {
  conic_field_visitor *visitor;
  void *cookie;
  char path[PATH_ROOM];
} visiting;

static void visit_rows(visiting *v, const conic_shot_rows *rows, const void *value, const void *standard,
                       size_t n_path);

static void visit_list(visiting *v, const conic_shot_row *row, const void *value, size_t n_path) {
  conic_standard standard;
  const char *first = (const char *)value + row->offset;
  if (row->is_apart)
    memcpy(&first, (const void *)first, sizeof first);
  conic_rows_standard(row->of, &standard);
  for (size_t i = 0; i < conic_row_length(row, value); i++) {
    int n = snprintf(v->path + n_path, sizeof v->path - n_path, "%s[%zu].", row->name, i);
    visit_rows(v, row->of, first + i * row->of->size, standard.bytes, n_path + (size_t)n);
  }
}

static void visit_pointer(visiting *v, const conic_shot_row *row, const void *value, size_t n_path) {
  conic_standard standard;
  const void *to = text_at(row, value);
  int n = snprintf(v->path + n_path, sizeof v->path - n_path, "%s.", row->name);
  conic_rows_standard(row->of, &standard);
  visit_rows(v, row->of, to ? to : standard.bytes, standard.bytes, n_path + (size_t)n);
}

static void visit_rows(visiting *v, const conic_shot_rows *rows, const void *value, const void *standard,
                       size_t n_path) {
  for (size_t i = 0; i < rows->n_rows; i++) {
    const conic_shot_row *row = &rows->rows[i];
    int is_shot = rows == &conic_shot_file_rows && i == 1; /* whose members stand beside the other parts */
    if (row->kind >= CONIC_ROW_LENGTH)
      continue;
    if (row->kind == CONIC_ROW_LIST) {
      visit_list(v, row, value, n_path);
    } else if (row->kind == CONIC_ROW_POINTER) {
      visit_pointer(v, row, value, n_path);
    } else if (row->kind == CONIC_ROW_STRUCT) {
      int n = is_shot ? 0 : snprintf(v->path + n_path, sizeof v->path - n_path, "%s.", row->name);
      visit_rows(v, row->of, (const char *)value + row->offset, (const char *)standard + row->offset,
                 n_path + (size_t)n);
    } else {
      snprintf(v->path + n_path, sizeof v->path - n_path, "%s", row->name);
      const conic_field_visit visit = {v->path, row, value, standard};
      v->visitor(v->cookie, &visit);
    }
  }
}

void conic_fields_visit(const conic_shot_file *file, conic_field_visitor *visitor, void *cookie) {
  visiting v = {.visitor = visitor, .cookie = cookie};
  conic_shot_file standard;
  conic_shot_file_init(&standard);
  visit_rows(&v, &conic_shot_file_rows, file, &standard, 0);
}
