#include "source/input_places.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/base/base.h"
#include "core/base/vectors.h"
#include "core/formats/text_columns.h"

enum { MOST_NUMBERS = 16 };

/* How far a matrix may be from one that only turns and scales, relative to its scale. */
static const double least_shear = 1e-6;

/* One input's words, "I:" and what follows up to a semicolon or the end. Returns what is behind them; null: they are
 * none. */
static const char *take_entry(const char *text, size_t *input, conic_text_word *numbers) {
  const char *end = text + strcspn(text, ";");
  *input = 0;
  if (*text < '0' || *text > '9')
    return NULL;
  for (; *text >= '0' && *text <= '9' && *input < 100000000; text++)
    *input = 10 * *input + (size_t)(*text - '0');
  if (*text != ':')
    return NULL;
  *numbers = (conic_text_word){text + 1, (size_t)(end - text - 1)};
  return *end ? end + 1 : end;
}

const char *conic_place_find_parts(conic_place *p) {
  double across[3];
  p->is_moved = 1;
  const double(*m)[4] = (const double(*)[4])p->matrix;
  conic_cross(m[0], m[1], across);
  const double volume = conic_dot(across, m[2]);
  if (!(volume > 0.0 && volume < 1e60))
    return "it mirrors, flattens or is not finite";
  p->scale = conic_length(m[0]);
  for (int row = 0; row < 3; row++) {
    p->shift[row] = m[row][3];
    for (int other = 0; other < 3; other++) {
      p->rotation[row][other] = m[row][other] / p->scale;
      double product = conic_dot(m[row], m[other]) / (p->scale * p->scale);
      if (!(fabs(product - (row == other)) <= least_shear))
        return "it stretches or shears: a place turns, scales evenly and shifts";
    }
    if (!(fabs(p->shift[row]) < 1e20))
      return "it shifts too far";
  }
  return NULL;
}

/* Of three numbers a shift, of twelve three rows of four, of sixteen four rows. */
static const char *read_place(conic_text_word text, conic_place *p) {
  conic_text_dialect dialect;
  conic_text_word words[MOST_NUMBERS + 1];
  double numbers[MOST_NUMBERS];
  int is_open;
  conic_text_dialect_begin(CONIC_TEXT_BLANKS | CONIC_TEXT_COMMAS, &dialect);
  const size_t n = conic_text_split(&dialect, text, words, MOST_NUMBERS + 1, &is_open);
  if ((n != 3 && n != 12 && n != 16) || is_open)
    return "a place is a shift of 3 numbers, or a matrix of 12 or 16, row by row";
  for (size_t i = 0; i < n; i++)
    if (!conic_text_number(&dialect, words[i], &numbers[i]) || !(fabs(numbers[i]) < 1e20))
      return "a place is of finite numbers";
  if (n == 16 && (numbers[12] != 0.0 || numbers[13] != 0.0 || numbers[14] != 0.0 || numbers[15] != 1.0))
    return "its last row is not 0, 0, 0, 1";
  for (size_t row = 0; row < 3; row++)
    for (size_t column = 0; column < 4; column++)
      p->matrix[row][column] = n > 3 ? numbers[4 * row + column] : column == 3 ? numbers[row] : (double)(row == column);
  return conic_place_find_parts(p);
}

conic_status conic_places_read(conic_context *context, const char *text, size_t n, conic_place *places) {
  memset(places, 0, n * sizeof *places);
  for (size_t i = 0; i < n; i++) {
    places[i].scale = 1.0;
    for (int axis = 0; axis < 3; axis++)
      places[i].rotation[axis][axis] = places[i].matrix[axis][axis] = 1.0;
  }
  while (text && *text) {
    size_t input;
    conic_text_word numbers;
    const char *next = take_entry(text, &input, &numbers);
    const char *fault = !next                    ? "each is \"I:\" and its numbers, with semicolons between"
                        : input >= n             ? "there is no such input"
                        : places[input].is_moved ? "an input has two"
                                                 : read_place(numbers, &places[input]);
    if (fault)
      return conic_fail(context, CONIC_ERROR_ARGUMENT, "the inputs' places: %.40s: %s", text, fault);
    text = next;
  }
  return CONIC_OK;
}

conic_status conic_places_part(conic_context *context, const char *text, const int *is_kept, size_t n, char **part) {
  const size_t room = text ? strlen(text) + 1 : 1;
  size_t used = 0;
  *part = NULL;
  if (!text || !*text)
    return CONIC_OK;
  char *kept = conic_memory_allocate(context, room + 8 * n, 1);
  if (!kept)
    return CONIC_ERROR_MEMORY;
  while (*text) {
    size_t input, number = 0;
    conic_text_word numbers;
    const char *next = take_entry(text, &input, &numbers);
    if (!next || input >= n)
      break;
    for (size_t i = 0; i < input; i++)
      number += (size_t)is_kept[i];
    if (is_kept[input])
      used += (size_t)snprintf(kept + used, room + 8 * n - used, "%s%zu:%.*s", used ? ";" : "", number,
                               (int)numbers.length, numbers.text);
    text = next;
  }
  kept[used] = '\0';
  if (used > 0)
    *part = kept;
  else
    conic_memory_release(context, kept);
  return CONIC_OK;
}
