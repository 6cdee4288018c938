/* What the system says about the machine. */
#ifndef CONIC_MACHINE_H
#define CONIC_MACHINE_H

#include <stdint.h>

/* How many threads run at the same time; at least 1. */
int conic_machine_threads(void);

/* Bytes of memory; 0 where it does not say. */
uint64_t conic_machine_memory(void);

#endif
