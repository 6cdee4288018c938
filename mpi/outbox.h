/* What a rank hands over while it goes on with its work: a thread of its own sends it, in the order in which it was
 * put. Called by one thread. */
#pragma once

#include <stddef.h>

/* So much may wait to be sent, but for what is longer and alone: about a strip of a large picture. */
#define OUTBOX_ROOM ((size_t)8 << 20)

typedef void outbox_send(const void *bytes, size_t n_bytes);

/* Copies the bytes, and waits until there is room for them; `send` is always the same. 0: there is no memory, or no
 * thread. */
int outbox_put(const void *bytes, size_t n_bytes, outbox_send *send);

/* Waits until all has been sent. */
void outbox_wait(void);

/* Ends the thread, after that. */
void outbox_end(void);
