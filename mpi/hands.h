/* What a rank hands over while it goes on with its work: a thread of its own sends it, in the order in which it was
 * put. Called by one thread. */
#ifndef CONIC_HANDS_H
#define CONIC_HANDS_H

#include <stddef.h>

/* So much may wait to be sent, but for what is longer and alone: about a strip of a large picture. */
#define HANDS_ROOM ((size_t)8 << 20)

typedef void hands_send(const void *bytes, size_t n_bytes);

/* Copies the bytes, and waits until there is room for them; `send` is always the same. 0: there is no memory, or no
 * thread. */
int hands_put(const void *bytes, size_t n_bytes, hands_send *send);

/* Waits until all has been sent. */
void hands_wait(void);

/* Ends the thread, after that. */
void hands_end(void);

#endif
