/* What each rank did and when, for --trace: events in Chrome's format, which scripts/simulate and browsers read. */
#pragma once

#include "core/base/base.h"

/* Collective: from now on events are noted, and now is time 0. */
void timeline_begin(void);
/* A conic_executor's `trace`, on any thread. */
void timeline_note(void *unused, const char *kind, const char *name, uint64_t number, conic_moment from,
                   uint64_t sent_bytes);
/* Collective: rank 0 writes the events of all. Returns the exit code. */
int timeline_write(const char *path);
