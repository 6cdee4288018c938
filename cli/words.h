/* Words that other programs have for what conic does: each is taken for what it means here, or answered. */
#pragma once

#include "cli/arguments.h"

/* Words for one thing, and what it is here. With `hint`, nothing is done and the hint is said; else each stands for
 * `is`. */
typedef struct cli_word {
  const char *said;  /* parted by blanks, without dashes; names of commands, or of options */
  const char *is;    /* the command, or "": conic FILE; or the option, which the command has to have, null: any may */
  const char *value; /* of an option: the value that the word alone stands for; null: the value that follows it */
  const char *hint;
} cli_word;

/* The first row for a command's name; null: there is none. */
const cli_word *cli_word_for_command(const char *word);
/* The first row for an option of so many letters for which `has` knows the option; null: there is none. */
const cli_word *cli_word_for_option(const char *word, size_t length, int (*has)(const void *cookie, const char *name),
                                    const void *cookie);

/* Notes, to be said when all is well, the command that other words stand for: "conic", argv[0 … argc), and "-o" before
 * the argument i_output, where that is not below 0. */
void cli_mean_command(cli_session *session, int argc, char *const *argv, int i_output);
