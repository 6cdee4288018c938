#include "mpi/timeline.h"

#include <pthread.h>

#include "cli/session.h"
#include "mpi/ranks.h"

/* The events of this rank, as lines of JSON that end in a comma. */
static struct {
  pthread_mutex_t lock;
  char *text;
  size_t n, room;
  double begun;
  int is_on;
} timeline = {.lock = PTHREAD_MUTEX_INITIALIZER};

void timeline_begin(void) {
  ranks_barrier();
  timeline.begun = cli_seconds();
  timeline.is_on = 1;
}

/* Without memory an event is left out. */
static int make_timeline_room(size_t wanted) {
  if (wanted <= timeline.room)
    return 1;
  char *text = realloc(timeline.text, 2 * wanted);
  if (!text)
    return 0;
  timeline.text = text;
  timeline.room = 2 * wanted;
  return 1;
}

void timeline_note(void *unused, const char *kind, const char *name, uint64_t number, conic_moment from,
                   uint64_t sent_bytes) {
  char line[256];
  conic_moment to = conic_moment_now();
  (void)unused;
  if (!timeline.is_on)
    return;
  int n = snprintf(
      line, sizeof line,
      "{\"name\": \"%s %llu\", \"cat\": \"%s\", \"ph\": \"X\", \"ts\": %.1f, \"dur\": %.1f, \"tdur\": %.1f, "
      "\"pid\": %d, \"tid\": 0, \"args\": {\"sent_bytes\": %llu}},\n",
      name, (unsigned long long)number, kind, 1e6 * (from.clock_s - timeline.begun), 1e6 * (to.clock_s - from.clock_s),
      1e6 * (to.processor_s - from.processor_s), ranks_index(), (unsigned long long)sent_bytes);
  pthread_mutex_lock(&timeline.lock);
  if (n > 0 && (size_t)n < sizeof line && make_timeline_room(timeline.n + (size_t)n + 1)) {
    memcpy(timeline.text + timeline.n, line, (size_t)n);
    timeline.n += (size_t)n;
  }
  pthread_mutex_unlock(&timeline.lock);
}

static int write_events(const char *path, const char *events, size_t n) {
  FILE *file = fopen(path, "wb");
  int is_written = file && fputs("{\"traceEvents\": [\n", file) >= 0;
  if (is_written && n > 2) /* the last comma */
    is_written = fwrite(events, 1, n - 2, file) == n - 2;
  is_written = is_written && fputs("\n], \"displayTimeUnit\": \"ms\"}\n", file) >= 0;
  if (file && fclose(file) != 0)
    is_written = 0;
  return is_written ? CLI_DONE : cli_error(CLI_RESOURCE, "%s: cannot write", path);
}

int timeline_write(const char *path) {
  size_t *sizes = calloc((size_t)ranks_count(), sizeof *sizes), n = 0;
  int exit_code = CLI_DONE;
  char *all = sizes ? ranks_gather(timeline.text, timeline.n, sizes) : NULL;
  for (int i = 0; all && i < ranks_count(); i++)
    n += sizes[i];
  if (ranks_index() == 0)
    exit_code = all ? write_events(path, all, n) : cli_error(CLI_RESOURCE, "%s: out of memory", path);
  free(all);
  free(sizes);
  free(timeline.text);
  return exit_code;
}
