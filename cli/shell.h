/* What surrounds the program, where systems differ: its arguments, signals and terminal, names by patterns.
 * shell_posix.c and shell_windows.c. */
#pragma once

#include "core/base/base.h"

/* Before anything else: arguments in UTF-8, standard streams of bytes. Null without memory. */
char **cli_shell_begin(int *argc, char **argv);

/* Wishes to stop go to `on_wish`, and that nobody reads what is written to a pipe to `on_closed_pipe`, with a signal's
 * number: but what whoever started the program has turned off stays off. Handlers may be called on a thread of their
 * own. */
void cli_shell_catch(void (*on_wish)(int signal_number), void (*on_closed_pipe)(int signal_number));

/* Whether a standard stream is a terminal, and one that moves its cursor where it is told to; how wide it is. */
int cli_shell_is_terminal(FILE *stream);
int cli_shell_has_cursor(void);
int cli_shell_columns(void);

/* Whether there is a program of that name. */
int cli_shell_has_program(const char *name);
/* Starts a program, of whose words the last is null, and returns where to its input is written; null: it cannot be. A
 * program that does not read any more makes writing fail, and ends nothing. The second waits for it, and returns its
 * exit code, or -1. */
FILE *cli_shell_pipe_to(const char *const *words);
int cli_shell_pipe_end(FILE *pipe);

/* The most memory that this process has held, as the system counts it. */
unsigned long long cli_shell_peak_bytes(void);

/* The seconds that processors have worked for this process, on all threads. */
double cli_shell_cpu_seconds(void);

/* What the processor and the system call themselves; "unknown" where they do not say. */
void cli_shell_name_host(char *processor, size_t processor_room, char *system, size_t system_room);

/* From now on, what is released of more than 128 KiB goes back to the system at once, where it would else be kept. */
void cli_shell_give_back_memory(void);

/* Every name that a pattern with *, ? and [ … ] is of, until `take` returns 0. Returns 0 without memory. */
int cli_shell_match(const char *pattern, int (*take)(void *cookie, const char *path), void *cookie);
