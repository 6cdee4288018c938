/* The rows of a command's table as the pages show them. */

#include "cli/help/help.h"

/* What an option's value is, by what the help calls it. */
static cli_value_kind kind_of_value(const cli_option *option) {
  static const char *const folders[] = {"DIR", "FOLDER", NULL};
  static const char *const files[] = {"OUT", "FILE", "IN", "MESH", "SCENE", "PICTURE", NULL};
  const char *argument = option->argument;
  if (option->type == CLI_FLAG)
    return CLI_VALUE_NONE;
  if (option->choices)
    return CLI_VALUE_WORDS;
  if (!argument || (option->type != CLI_TEXT && option->type != CLI_PARSED))
    return CLI_VALUE_OTHER;
  size_t length = strlen(argument);
  for (int i = 0; folders[i]; i++)
    if (strcmp(argument, folders[i]) == 0 || (length && argument[length - 1] == '/'))
      return CLI_VALUE_FOLDER;
  for (int i = 0; files[i]; i++)
    if (strncmp(argument, files[i], strlen(files[i])) == 0)
      return CLI_VALUE_FILE;
  return strchr(argument, '.') ? CLI_VALUE_FILE : CLI_VALUE_OTHER; /* OLD.json */
}

/* Parts "the camera's height [15]" into text and default. */
static void part_help(const char *help, cli_help_entry *entry) {
  size_t length = strlen(help);
  const char *open = length && help[length - 1] == ']' ? strrchr(help, '[') : NULL;
  size_t n_text = open ? (size_t)(open - help) : length;
  while (n_text && help[n_text - 1] == ' ')
    n_text--;
  snprintf(entry->text, sizeof entry->text, "%.*s", (int)n_text, help);
  snprintf(entry->fallback, sizeof entry->fallback, "%.*s", open ? (int)(help + length - open) - 2 : 0,
           open ? open + 1 : "");
}

/* Whether a command has an option of its own in place of a common one (conic bench --threads). */
static int is_replaced(const cli_option_table *table, const cli_option *common) {
  for (int i = 0; i < table->n_own; i++)
    if (strcmp(table->own[i].name, common->name) == 0)
      return 1;
  return 0;
}

int cli_help_next(const cli_option_table *table, int *i, cli_help_entry *entry) {
  int n_all = table->n_own + table->n_common;
  const cli_option *option = NULL;
  entry->group = *i == 0 ? "options" : NULL;
  entry->intro = NULL;
  for (; *i < n_all && !option; ++*i) {
    int is_common = *i >= table->n_own;
    const cli_option *row = is_common ? &table->common[*i - table->n_own] : &table->own[*i];
    if (row->group || *i == table->n_own) {
      entry->group = row->group ? row->group : "options of every command";
      entry->intro = row->intro;
    }
    if (row->help && !row->now && !(is_common && is_replaced(table, row)))
      option = row;
  }
  if (!option)
    return 0;
  int is_last = *i == table->n_own || *i == n_all;
  entry->option = option;
  entry->alias = !is_last && !option[1].help ? option + 1 : NULL;
  entry->kind = kind_of_value(option);
  part_help(option->help, entry);
  return 1;
}

/* Whether a text has a number, by itself. */
static int names_number(const char *text, double number) {
  char digits[32];
  size_t length = (size_t)snprintf(digits, sizeof digits, "%.10g", number);
  for (const char *at = strstr(text, digits); at; at = strstr(at + 1, digits))
    if ((at == text || !strchr("0123456789.", at[-1])) && (!at[length] || !strchr("0123456789", at[length])))
      return 1;
  return 0;
}

void cli_help_limits(const cli_help_entry *entry, char *words, size_t room) {
  const cli_option *option = entry->option;
  const double most = 1e6; /* what is beyond is no limit that anybody would meet */
  words[0] = '\0';
  if (option->minimum == option->maximum || fabs(option->minimum) >= most || fabs(option->maximum) >= most)
    return;
  if (!names_number(entry->text, option->minimum) || !names_number(entry->text, option->maximum))
    snprintf(words, room, "%.10g to %.10g", option->minimum, option->maximum);
}

int cli_help_hides_words(const cli_help_entry *entry) {
  if (entry->option->type != CLI_CHOICE)
    return 0;
  for (int i = 0; entry->option->choices[i]; i++)
    if (!strstr(entry->text, entry->option->choices[i]))
      return 1;
  return 0;
}

void cli_help_put_list(const cli_words *list) {
  const char *about, *word;
  for (int i = 0; (word = list->at(i, &about)); i++)
    printf("%s%s", i ? " " : "", word);
}

void cli_help_put_choices(const cli_option *option) {
  for (int i = 0; option->choices[i]; i++)
    printf("%s%s", i ? " " : "", option->choices[i]);
}
