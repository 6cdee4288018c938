/* What the system says about the machine. */
#ifndef CONIC_MACHINE_H
#define CONIC_MACHINE_H

/* How many threads run at the same time; at least 1. */
int conic_machine_threads(void);

#endif
