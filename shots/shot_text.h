/* Text that grows, and a shot as text: what is written reads back to the bit. */
#pragma once

#include "core/files/sha256.h"
#include "shots/shot_fields.h"

/* Of a shot's text: it grows with every field that older versions do not know. */
enum { CONIC_SHOT_VERSION = 1 };

/* "scene", "texture" …; null for a number that is none. */
const char *conic_shot_role_name(conic_shot_role value);

typedef struct conic_text {
  conic_context *context; /* null: there is no more room than `room`, at `bytes` */
  conic_sha256 *sum;      /* what is added goes to this hash and stands nowhere; null: it stands */
  char *bytes;            /* zero at the end; null where there is nothing yet */
  size_t n, room;
  conic_status status; /* of all that was added: OK, MEMORY */
} conic_text;

void conic_text_add(conic_text *text, const char *bytes, size_t n);
void conic_text_say(conic_text *text, const char *words);
void conic_text_print(conic_text *text, const char *format, ...) CONIC_AS_PRINTF(2, 3);
/* In quotes, as JSON has it. */
void conic_text_quote(conic_text *text, const char *words);
void conic_text_release(conic_text *text);

/* The value of a row that is a field of its own, as JSON; `value` is its struct. */
void conic_text_value(conic_text *text, const conic_shot_row *row, const void *value);

/* Whether two structs have the same there, to the bit; texts by what they say. */
int conic_row_is_same(const conic_shot_row *row, const void *a, const void *b);

/* Looks at every field of a struct, and of all within it. */
typedef struct conic_field_visit {
  const char *path; /* "render.lighting.lights[2].color" */
  const conic_shot_row *row;
  const void *value, *standard; /* the structs that have it */
} conic_field_visit;
typedef void conic_field_visitor(void *cookie, const conic_field_visit *visit);
void conic_fields_visit(const conic_shot_file *file, conic_field_visitor *visitor, void *cookie);
