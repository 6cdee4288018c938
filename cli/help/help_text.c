/* The help on a terminal. */

#include "cli/help/help.h"

enum { HELP_COLUMN = 28, LAST_COLUMN = 100 };

/* Columns on the screen, one a character. */
static int text_width(const char *text) {
  int width = 0;
  for (; *text; text++)
    width += ((unsigned char)*text & 0xC0) != 0x80;
  return width;
}

/* The words from `first_column` on, where the first line already is, in as many lines as they need. */
static void print_words(const char *words, int first_column) {
  int column = first_column;
  while (*words) {
    int length = (int)strcspn(words, " ");
    char word[128];
    snprintf(word, sizeof word, "%.*s", length, words);
    int width = text_width(word);
    if (column > first_column && column + 1 + width > LAST_COLUMN) {
      printf("\n%*s", first_column, "");
      column = first_column;
    }
    column += printf("%s%s", column > first_column ? " " : "", word) - (int)strlen(word) + width;
    words += length + (words[length] == ' ');
  }
  putchar('\n');
}

static void print_option(const cli_help_entry *entry) {
  const cli_option *option = entry->option;
  char names[128];
  snprintf(names, sizeof names, "  %s%s%s%s%s%s%s", cli_dashes(option), option->name, entry->alias ? ", " : "",
           entry->alias ? cli_dashes(entry->alias) : "", entry->alias ? entry->alias->name : "",
           option->argument ? " " : "", option->argument ? option->argument : "");
  int width = text_width(names);
  fputs(names, stdout);
  if (width > HELP_COLUMN - 2)
    printf("\n%*s", HELP_COLUMN, "");
  else
    printf("%*s", HELP_COLUMN - width, "");
  print_words(option->help, HELP_COLUMN);
}

static void print_list(const cli_words *list) {
  const char *about;
  printf("\n%s:\n", list->title);
  for (int i = 0; list->at(i, &about); i++)
    printf("  %-10s %s\n", list->at(i, &about), about);
}

/* So many options are read as one page: of more only the usual ones are shown, unless all are asked for. */
enum { MOST_WHOLE = 40 };

void cli_help_text(cli_session *session, const cli_option_table *table) {
  const cli_command *command = cli_find_command(session->command);
  cli_help_entry entry;
  const char *group = NULL, *intro = NULL;
  int n = 0, n_usual = 0;
  for (int i = 0; cli_help_next(table, &i, &entry); n++)
    n_usual += entry.option->is_usual && i <= table->n_own;
  int is_short = n > MOST_WHOLE && n_usual && !session->is_help_whole;
  if (command)
    printf("%s\n\nusage: %s\n\n", command->summary, command->usage);
  if (command && command->description) {
    print_words(command->description, 0);
    putchar('\n');
  }
  for (int i = 0, is_first = 1; cli_help_next(table, &i, &entry);) {
    group = entry.group ? entry.group : group;
    intro = entry.group ? entry.intro : intro;
    if (is_short && !entry.option->is_usual)
      continue;
    if (group)
      printf("%s%s:%s%s\n", is_first ? "" : "\n", group, intro ? " " : "", intro ? intro : "");
    print_option(&entry);
    group = intro = NULL;
    is_first = 0;
  }
  if (is_short)
    printf("\nMost pictures need no more; conic help %s --all shows all %d options.\n", session->command, n);
  if (command && command->words)
    print_list(command->words);
  for (int i = 0; command && i < 4 && command->examples[i].command; i++)
    printf("%s  %s\n      %s\n", i ? "" : "\nexamples:\n", command->examples[i].what, command->examples[i].command);
}
