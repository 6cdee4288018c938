/* Input files as a stream of bytes through a window of bounded size; text files word by word. */
#pragma once

#include "core/base/base.h"

/* The most bytes that can be asked for at once. */
enum { CONIC_INPUT_WINDOW = 256 * 1024, CONIC_INPUT_LONGEST_WORD = 4096, CONIC_INPUT_LONGEST_LINE = 65536 };

typedef struct conic_input {
  conic_context *context;
  const char *name; /* for messages */
  int descriptor;
  int has_size;          /* size_bytes is known: the input is no pipe or terminal */
  uint64_t size_bytes;   /* from the first byte read */
  uint64_t start_bytes;  /* where that byte is in the file */
  unsigned char *window; /* the bytes from `next` to before `filled` are valid */
  size_t next, filled;
  uint64_t window_offset;  /* of window[0] in the file */
  uint64_t reported_bytes; /* when progress was reported last */
  uint64_t line;           /* of the next byte, from 1; only the functions for text count it */
  int is_at_end;           /* nothing follows the window's bytes */
  int has_jumped;          /* the descriptor's place is not behind the window */
  int continues_lines;     /* text: a line that ends with \ continues in the next one */
} conic_input;

/* Opens PATH ("-" is standard input) for reading; `path` must outlive *input. On success the caller ends it with
 * conic_input_close. Errors: INPUT (missing, unreadable, a folder), MEMORY. */
conic_status conic_input_open(conic_context *context, const char *path, conic_input *input);
void conic_input_close(conic_input *input);

/* Reads on until `count` bytes are in the window, or fewer at the end of the file. Errors: INPUT (reading failed),
 * CANCELLED. */
conic_status conic_input_fill(conic_input *input, size_t count);

static inline size_t conic_input_available(const conic_input *input) {
  return input->filled - input->next;
}

static inline const unsigned char *conic_input_bytes(const conic_input *input) {
  return input->window + input->next;
}

/* Takes so many bytes into memory, or fewer at the end of the file: where its size is not known, the memory grows with
 * the bytes that come. The caller releases *bytes, on failure too; it begins null. Errors: as fill, and MEMORY. */
conic_status conic_input_take(conic_input *input, uint64_t most, unsigned char **bytes, size_t *n_bytes);

/* The same of the rest of the file. Errors: also INPUT (there are more). */
conic_status conic_input_take_rest(conic_input *input, uint64_t most, unsigned char **bytes, size_t *n_bytes);

/* Copies n bytes from an offset of a file that has_size, without moving the next byte; fewer at the end of the file.
 * Errors: INPUT (reading failed). */
conic_status conic_input_read_at(const conic_input *input, uint64_t offset, void *bytes, size_t n, size_t *n_read);

/* The offset of the next byte. */
static inline uint64_t conic_input_offset(const conic_input *input) {
  return input->window_offset + input->next;
}

/* Bytes from the next one to the end; UINT64_MAX if not known. */
uint64_t conic_input_remaining_bytes(const conic_input *input);

/* Skips `count` bytes, or all up to the end; *skipped says how many. Errors: as fill. */
conic_status conic_input_skip(conic_input *input, uint64_t count, uint64_t *skipped);

/* The length of UTF-8's byte-order mark at the start of text: 0 or 3. Errors: INPUT (UTF-16). */
conic_status conic_text_byte_order_mark(conic_context *context, const char *name, const unsigned char *bytes,
                                        size_t n_bytes, size_t *n_mark);

/* Skips UTF-8's byte-order mark at the start of text. Errors: as fill, and INPUT (UTF-16). */
conic_status conic_input_skip_mark(conic_input *input);

/* The rest of the line without its end, which conic_input_next_line skips. Valid until the next call. Errors: as fill,
 * and INPUT (longer than CONIC_INPUT_LONGEST_LINE). */
conic_status conic_input_line(conic_input *input, const char **text, size_t *length);

/* Takes the next word of the line; *length is 0 where the line (or file) ends. Valid until the next call. Blanks and
 * carriage returns separate words. Errors: as fill, and INPUT (longer than CONIC_INPUT_LONGEST_WORD). */
conic_status conic_input_word(conic_input *input, const char **word, size_t *length);

/* The rest of the line without the blanks at both ends, as a name that may have some within. Valid until the next call;
 * conic_input_next_line skips it. Errors: as conic_input_line. */
conic_status conic_input_rest(conic_input *input, const char **text, size_t *length);

/* The numbers up to the line's end or a word that begins with #. Errors: as conic_input_word, and INPUT (a word is no
 * number, or there are more than `room`). */
conic_status conic_input_numbers(conic_input *input, double *numbers, int room, int *n);

/* Logs "FILE: what is wrong (line N)" for the current line, and returns INPUT. */
conic_status conic_input_wrong(const conic_input *input, const char *format, ...) CONIC_AS_PRINTF(2, 3);

/* "FOLDER/file" beside the file that is read, or `file` itself if it begins at the root. Returns the length, or 0 where
 * the room is too small. */
size_t conic_input_beside(const conic_input *input, const char *file, size_t length, char *path, size_t room);

/* Makes a name as files spell it, of a URI, with %20 and the like, or of Windows, with \, one as it is here. */
void conic_input_make_plain(char *name);

/* The path of a file that the file names: as it is written, else with %20 and \ read as a blank and /, else the last
 * part of it, since such paths are often another machine's. Returns 0 where there is none, after the first of these. */
int conic_input_find(const conic_input *input, const char *name, size_t length, char *path, size_t room);

/* What is done after a line's first word. */
typedef struct conic_input_statement {
  const char *keyword;
  conic_status (*read)(void *reader);
} conic_input_statement;

/* Whether the word is `keyword`. */
int conic_input_is(const char *word, size_t length, const char *keyword);

/* Reads to the end. Each line whose first word is a statement's keyword goes to that statement; other lines are
 * skipped. Errors: as fill, and the statements'. */
conic_status conic_input_read_statements(conic_input *input, const conic_input_statement *statements, size_t n,
                                         void *reader);

/* To the start of the next line; *is_done where the file ends before. Errors: as fill. */
conic_status conic_input_next_line(conic_input *input, int *is_done);
