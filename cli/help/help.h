/* What the program says of itself, all of it from the commands' tables of options: text, manual pages, completion of
 * three shells, JSON. */
#pragma once

#include "cli/arguments.h"
#include "cli/command.h"

/* What completion offers for an option's value. */
typedef enum cli_value_kind {
  CLI_VALUE_NONE,
  CLI_VALUE_OTHER,
  CLI_VALUE_WORDS,
  CLI_VALUE_FILE,
  CLI_VALUE_FOLDER
} cli_value_kind;

/* An option as the pages show it. */
typedef struct cli_help_entry {
  const cli_option *option, *alias; /* the alias, its other name, may be null */
  const char *group, *intro;        /* the heading, and a line about it, where a group begins here; else null */
  char text[1024], fallback[256];   /* the table's help without the default; the default, empty where there is none */
  cli_value_kind kind;
} cli_help_entry;

/* Walks the options of a table: *i is 0 before the first. 0 past the last. */
int cli_help_next(const cli_option_table *table, int *i, cli_help_entry *entry);

/* The limits of an option's numbers in words, "6 to 64"; empty where there are none or the text has them. */
void cli_help_limits(const cli_help_entry *entry, char *words, size_t room);

/* Whether an option's text leaves out some of the words that it takes. */
int cli_help_hides_words(const cli_help_entry *entry);

/* Words with blanks between them, for completion: a list's, an option's choices. */
void cli_help_put_list(const cli_words *list);
void cli_help_put_choices(const cli_option *option);

/* How cli_parse answers --help, in each format but text. The command is the session's. */
void cli_help_man(cli_session *session, const cli_option_table *table);
void cli_help_json(cli_session *session, const cli_option_table *table); /* into the cli_json that is session->help */
void cli_help_bash(cli_session *session, const cli_option_table *table);
void cli_help_zsh(cli_session *session, const cli_option_table *table);
void cli_help_fish(cli_session *session, const cli_option_table *table);

/* What stands before the commands, and behind them, in the completion of a shell. */
void cli_help_bash_begin(void);
void cli_help_bash_end(void);
void cli_help_zsh_begin(void);
void cli_help_zsh_end(void);
void cli_help_fish_begin(void);

/* The page of the whole program, conic(1). */
void cli_help_man_program(void);

/* The exit codes and the variables of the environment with their meanings; the names end with a null. */
typedef struct cli_help_row {
  const char *name, *meaning;
} cli_help_row;

extern const cli_help_row cli_help_exit_codes[], cli_help_variables[];
