#include "cli/tell.h"

/* A line that is put together piece by piece; what is too long is cut. */
typedef struct text_line {
  char text[768];
  size_t length;
} text_line;

static void append_piece(text_line *to, const char *piece) {
  int n = snprintf(to->text + to->length, sizeof to->text - to->length, "%s%s", to->length ? ", " : "", piece);
  to->length += n > 0 ? (size_t)n : 0;
  if (to->length >= sizeof to->text)
    to->length = sizeof to->text - 1;
}

static void print_seconds(char *text, size_t room, double seconds) {
  if (seconds < 0.9995)
    snprintf(text, room, "%.*f ms", seconds < 0.00995 ? 1 : 0, 1e3 * seconds);
  else
    snprintf(text, room, "%.2f s", seconds);
}

double cli_other_seconds(const cli_stage *stages, int n_stages, double whole_seconds) {
  double other = whole_seconds;
  for (int i = 0; i < n_stages; i++)
    other -= stages[i].seconds > 0.0 ? stages[i].seconds - stages[i].parts : 0.0;
  return other > 0.0 ? other : 0.0;
}

static void append_stage(text_line *to, const char *name, double stage_seconds) {
  char seconds[32], piece[64];
  print_seconds(seconds, sizeof seconds, stage_seconds);
  snprintf(piece, sizeof piece, "%s %s", name, seconds);
  append_piece(to, piece);
}

void cli_tell_stages(cli_session *session, const cli_stage *stages, int n_stages, const char *whole,
                     double whole_seconds) {
  text_line told = {"", 0};
  char seconds[32];
  for (int i = 0; i < n_stages; i++)
    if (stages[i].seconds >= 0.0)
      append_stage(&told, stages[i].name, stages[i].seconds - stages[i].parts);
  append_stage(&told, "other", cli_other_seconds(stages, n_stages, whole_seconds));
  print_seconds(seconds, sizeof seconds, whole_seconds);
  conic_log(session->context, CONIC_LOG_INFO, "%s; %s %s", told.text, seconds, whole);
}

void cli_tell_run(cli_session *session, const cli_stage *stages, int n_stages, double total_seconds) {
  char whole[64];
  snprintf(whole, sizeof whole, "in all, %.0f MiB of memory at most", (double)cli_peak_rss_bytes() / 1048576.0);
  cli_tell_stages(session, stages, n_stages, whole, total_seconds);
}
