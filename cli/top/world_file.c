#include "cli/top/top_tiff.h"

#include "core/files/file.h"
#include "core/files/number.h"

/* The fewest digits that read back as the same number. */
static void put_line(FILE *file, double number) {
  char digits[40];
  for (int n = 1; n <= 17; n++) {
    double again;
    int length = snprintf(digits, sizeof digits, "%.*g", n, number);
    if (conic_number_parse(digits, (size_t)length, &again) && again == number)
      break;
  }
  fprintf(file, "%s\n", digits);
}

/* "tif" becomes "tfw". */
static void name_ending(const char *ending, char name[4]) {
  size_t n = strlen(ending);
  snprintf(name, 4, "%.1s%.1sw", ending, n > 1 ? ending + n - 1 : "l");
}

conic_status cli_world_file_write(conic_context *context, const char *path, double pixel, const double corner[2]) {
  const char *ending = conic_file_ending(path);
  size_t n_stem = (size_t)(ending - path), room = n_stem + 8;
  char *name = conic_memory_allocate(context, room, 1), letters[4];
  conic_output *output;
  if (!name)
    return CONIC_ERROR_MEMORY;
  name_ending(ending, letters);
  snprintf(name, room, "%.*s%s", (int)n_stem, path, letters);
  conic_status status = conic_output_open(context, name, &output);
  if (status == CONIC_OK) {
    FILE *file = conic_output_stream(output);
    const double lines[6] = {pixel, 0.0, 0.0, -pixel, corner[0] + 0.5 * pixel, corner[1] - 0.5 * pixel};
    for (int i = 0; i < 6; i++)
      put_line(file, lines[i]);
    status = conic_output_commit(output);
  }
  conic_memory_release(context, name);
  return status;
}
