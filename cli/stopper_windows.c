#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <windows.h>

#include "cli/stopper.h"
#include "core/base/message.h"
#include "core/files/file.h"

enum { PATIENCE_MS = 300 };

static conic_context *watched;
static const char *watched_command;
static int (*watched_exit_code)(void);
static HANDLE over, asked;
static pthread_t thread;
static atomic_int is_watching;

static int is_over_within(DWORD most_ms) {
  const HANDLE words[] = {over, asked};
  return WaitForMultipleObjects(2, words, FALSE, most_ms) == WAIT_OBJECT_0;
}

static void *watch(void *nothing) {
  if (is_over_within(INFINITE) || is_over_within(PATIENCE_MS))
    return nothing;
  conic_outputs_give_up(watched);
  conic_fail(watched, CONIC_ERROR_CANCELLED, "%s: cancelled", watched_command);
  _exit(watched_exit_code());
}

void cli_stopper_begin(conic_context *context, const char *command, int (*exit_code)(void)) {
  watched = context;
  watched_command = command;
  watched_exit_code = exit_code;
  if (atomic_load(&is_watching))
    return;
  over = over ? over : CreateEventW(NULL, FALSE, FALSE, NULL);
  asked = asked ? asked : CreateEventW(NULL, FALSE, FALSE, NULL);
  atomic_store(&is_watching, over && asked && pthread_create(&thread, NULL, watch, NULL) == 0);
}

void cli_stopper_end(void) {
  if (atomic_exchange(&is_watching, 0) && SetEvent(over))
    pthread_join(thread, NULL);
}

int cli_stopper_ask(void) {
  return atomic_load(&is_watching) && SetEvent(asked);
}
