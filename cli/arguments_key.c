#include <string.h>
#include <unistd.h>

#include "cli/arguments_key.h"
#include "conic/version.h"
#include "core/files/disk.h"
#include "core/files/file.h"

enum { PIECE_BYTES = 1 << 20, MOST_PIECES = 64 };

/* Options that decide no bit of what is made, nor where it goes. */
static const struct {
  const char *name;
  int has_value;
} left_out[] = {{"--threads", 1}, {"--json", 1},  {"--isa", 1}, {"--tile", 1},    {"--resume", 1}, {"--frames", 1},
                {"--preview", 1}, {"--quiet", 0}, {"-q", 0},    {"--verbose", 0}, {"-v", 0},       {"--resumable", 0}};

/* Those whose value is written, so that what stands there now does not matter. */
static const char *const written[] = {"-o", "--deep", "--overdraw", "--clusters", "--boxes", "--legend-out"};

void cli_arguments_key_add_number(conic_sha256 *sum, uint64_t number) {
  conic_sha256_add(sum, &number, sizeof number);
}

void cli_arguments_key_add_text(conic_sha256 *sum, const char *text) {
  conic_sha256_add(sum, text, strlen(text) + 1);
}

void cli_arguments_key_add_file(conic_sha256 *sum, const char *path) {
  static char piece[PIECE_BYTES];
  conic_disk_entry entry;
  int descriptor = conic_file_is_there(path) ? conic_disk_open(path) : -1;
  if (descriptor < 0 || !conic_disk_look_at(descriptor, &entry))
    return;
  uint64_t n_whole = (entry.n_bytes + PIECE_BYTES - 1) / PIECE_BYTES, n = n_whole < MOST_PIECES ? n_whole : MOST_PIECES;
  uint64_t step = n_whole <= MOST_PIECES ? PIECE_BYTES : (entry.n_bytes - PIECE_BYTES) / (MOST_PIECES - 1);
  cli_arguments_key_add_number(sum, entry.n_bytes);
  if (n_whole > MOST_PIECES)
    cli_arguments_key_add_number(sum, (uint64_t)entry.modified_seconds);
  for (uint64_t i = 0; i < n; i++) {
    ptrdiff_t n_bytes = conic_disk_read_at(descriptor, piece, sizeof piece, i * step);
    conic_sha256_add(sum, piece, n_bytes > 0 ? (size_t)n_bytes : 0);
  }
  close(descriptor);
}

/* How many arguments from this one on are left out. */
static int count_left_out(const char *argument) {
  for (size_t i = 0; i < sizeof left_out / sizeof *left_out; i++) {
    size_t n = strlen(left_out[i].name);
    if (strncmp(argument, left_out[i].name, n) == 0 && (!argument[n] || (left_out[i].has_value && argument[n] == '=')))
      return 1 + (left_out[i].has_value && !argument[n]);
  }
  return 0;
}

static int is_written(const char *argument) {
  for (size_t i = 0; i < sizeof written / sizeof *written; i++)
    if (strcmp(argument, written[i]) == 0)
      return 1;
  return 0;
}

void cli_arguments_key_add(conic_sha256 *sum, int n_arguments, char *const *arguments, int with_files) {
  cli_arguments_key_add_text(sum, conic_version());
  for (int i = 1, n; i < n_arguments; i += n ? n : 1) {
    const char *argument = arguments[i], *equals = strchr(argument, '=');
    n = count_left_out(argument);
    if (n)
      continue;
    cli_arguments_key_add_text(sum, argument);
    if (!with_files)
      continue;
    if (!is_written(argument)) {
      cli_arguments_key_add_file(sum, argument);
      cli_arguments_key_add_file(sum, argument[0] == '-' && equals ? equals + 1 : "");
    } else if (i + 1 < n_arguments)
      cli_arguments_key_add_text(sum, arguments[++i]);
  }
}
