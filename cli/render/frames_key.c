#include <string.h>
#include <unistd.h>

#include "cli/render/kept_frames.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/files/guard.h"

enum { PIECE_BYTES = 1 << 20, MOST_PIECES = 64 };

/* Options that decide no bit of a frame, nor where it goes. */
static const struct {
  const char *name;
  int has_value;
} left_out[] = {{"--threads", 1}, {"--json", 1},  {"--isa", 1}, {"--tile", 1},    {"--resume", 1}, {"--frames", 1},
                {"--preview", 1}, {"--quiet", 0}, {"-q", 0},    {"--verbose", 0}, {"-v", 0},       {"--resumable", 0}};

/* Those whose value is written, so that what stands there now does not matter. */
static const char *const written[] = {"-o", "--deep", "--overdraw", "--clusters", "--boxes", "--legend-out"};

static void hash_number(conic_sha256 *sum, uint64_t number) {
  conic_sha256_add(sum, &number, sizeof number);
}

static void hash_text(conic_sha256 *sum, const char *text) {
  conic_sha256_add(sum, text, strlen(text) + 1);
}

/* Nothing of what cannot be read: whoever needs it has said so. */
static void hash_file(conic_sha256 *sum, const char *path) {
  static char piece[PIECE_BYTES];
  conic_disk_entry entry;
  int descriptor = conic_file_is_there(path) ? conic_disk_open(path) : -1;
  if (descriptor < 0 || !conic_disk_look_at(descriptor, &entry))
    return;
  uint64_t n_whole = (entry.n_bytes + PIECE_BYTES - 1) / PIECE_BYTES, n = n_whole < MOST_PIECES ? n_whole : MOST_PIECES;
  uint64_t step = n_whole <= MOST_PIECES ? PIECE_BYTES : (entry.n_bytes - PIECE_BYTES) / (MOST_PIECES - 1);
  hash_number(sum, entry.n_bytes);
  if (n_whole > MOST_PIECES)
    hash_number(sum, (uint64_t)entry.modified_seconds);
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

void cli_frames_key(const cli_session *session, const cli_render_job *job, char key[CONIC_SHA256_ROOM]) {
  conic_sha256 sum;
  conic_sha256_begin(&sum);
  hash_text(&sum, conic_version());
  for (int i = 1, n; i < job->n_arguments; i += n ? n : 1) {
    const char *argument = job->arguments[i], *equals = strchr(argument, '=');
    n = count_left_out(argument);
    if (n)
      continue;
    hash_text(&sum, argument);
    if (!is_written(argument)) {
      hash_file(&sum, argument);
      hash_file(&sum, argument[0] == '-' && equals ? equals + 1 : "");
    } else if (i + 1 < job->n_arguments)
      hash_text(&sum, job->arguments[++i]);
  }
  hash_number(&sum, conic_guard_bytes(session->context));
  conic_sha256_add(&sum, &job->options.exposure, sizeof job->options.exposure); /* which may be automatic */
  conic_sha256_end(&sum, key);
}
