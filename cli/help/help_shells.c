/* Completion for zsh and for fish, which show what each option means, too. */

#include "cli/help/help.h"

/* --- zsh --- */

/* Within single quotes and within the brackets of _arguments. */
static void put_zsh(const char *text) {
  for (; *text; text++)
    if (*text == '\'')
      fputs("'\\''", stdout);
    else
      printf("%s%c", strchr("[]:\\", *text) ? "\\" : "", *text);
}

void cli_help_zsh_begin(void) {
  puts("#compdef conic\n"
       "# zsh completion of conic. Made by conic help --format zsh\n"
       "_conic() {\n"
       "  local -a commands\n"
       "  commands=(");
  for (int i = 0; cli_command_at(i); i++) {
    printf("    '%s:", cli_command_at(i)->name);
    put_zsh(cli_command_at(i)->summary);
    puts("'");
  }
  puts("    'help:prints the options of a command'\n"
       "  )\n"
       "  if ((CURRENT == 2)); then\n"
       "    _describe command commands\n"
       "    return\n"
       "  fi\n"
       "  local command=$words[2]\n"
       "  shift words\n"
       "  ((CURRENT--))\n"
       "  case $command in\n"
       "  help) _describe command commands ;;");
}

static void put_zsh_value(const cli_help_entry *entry, const cli_words *list) {
  const cli_option *option = entry->option;
  putchar(':');
  put_zsh(option->argument ? option->argument : " ");
  putchar(':');
  if (list && list->option && strcmp(option->name, list->option) == 0) {
    putchar('(');
    cli_help_put_list(list);
    putchar(')');
  } else if (entry->kind == CLI_VALUE_WORDS) {
    putchar('(');
    cli_help_put_choices(option);
    putchar(')');
  } else if (entry->kind == CLI_VALUE_FOLDER)
    fputs("_files -/", stdout);
  else if (entry->kind == CLI_VALUE_FILE || option->type == CLI_TEXT)
    fputs("_files", stdout);
  else
    putchar(' ');
}

static void put_zsh_option(const cli_option *name, const cli_help_entry *entry, const cli_words *list) {
  const char *dashes = cli_dashes(name);
  printf("      '%s%s%s%s[", entry->option->may_repeat ? "*" : "", dashes, name->name,
         name->type == CLI_FLAG ? ""
         : dashes[1]            ? "="
                                : "+");
  put_zsh(entry->option->help);
  putchar(']');
  if (name->type != CLI_FLAG)
    put_zsh_value(entry, list);
  puts("' \\");
}

void cli_help_zsh(cli_session *session, const cli_option_table *table) {
  const cli_words *list = cli_find_command(session->command)->words;
  cli_help_entry entry;
  printf("  %s)\n    _arguments \\\n", session->command);
  for (int i = 0; cli_help_next(table, &i, &entry);) {
    put_zsh_option(entry.option, &entry, list);
    if (entry.alias)
      put_zsh_option(entry.alias, &entry, list);
  }
  if (list && !list->option) {
    printf("      '1:%s:(", list->title);
    cli_help_put_list(list);
    puts(")' \\");
  }
  puts("      '*:file:_files'\n    ;;");
}

void cli_help_zsh_end(void) {
  puts("  esac\n}\n_conic \"$@\"");
}

/* --- fish --- */

static void put_fish(const char *text) {
  for (; *text; text++)
    printf("%s%c", strchr("'\\", *text) ? "\\" : "", *text);
}

void cli_help_fish_begin(void) {
  puts("# fish completion of conic. Made by conic help --format fish\n"
       "function __conic_is\n"
       "  set -l words (commandline -opc)\n"
       "  test (count $words) -gt 1; and test $words[2] = $argv[1]\n"
       "end\n"
       "function __conic_has_no_command\n"
       "  test (count (commandline -opc)) -eq 1\n"
       "end\n"
       "complete -c conic -n __conic_has_no_command -f -a help -d 'prints the options of a command'\n"
       "complete -c conic -n __conic_has_no_command -f -l version -d 'the version, and what is in this build'");
}

static void put_fish_option(const char *command, const cli_help_entry *entry, const cli_words *list) {
  const cli_option *option = entry->option;
  printf("complete -c conic -n '__conic_is %s' -%c %s", command, cli_dashes(option)[1] ? 'l' : 's', option->name);
  if (entry->alias)
    printf(" -%c %s", cli_dashes(entry->alias)[1] ? 'l' : 's', entry->alias->name);
  if (list && list->option && strcmp(option->name, list->option) == 0) {
    fputs(" -x -a '", stdout);
    cli_help_put_list(list);
    putchar('\'');
  } else if (entry->kind == CLI_VALUE_WORDS) {
    fputs(" -x -a '", stdout);
    cli_help_put_choices(option);
    putchar('\'');
  } else if (entry->kind == CLI_VALUE_FOLDER)
    fputs(" -x -a '(__fish_complete_directories)'", stdout);
  else if (entry->kind == CLI_VALUE_FILE || option->type == CLI_TEXT)
    fputs(" -r -F", stdout);
  else if (entry->kind != CLI_VALUE_NONE)
    fputs(" -x", stdout);
  fputs(" -d '", stdout);
  put_fish(option->help);
  puts("'");
}

void cli_help_fish(cli_session *session, const cli_option_table *table) {
  const cli_command *command = cli_find_command(session->command);
  cli_help_entry entry;
  printf("complete -c conic -n __conic_has_no_command -f -a %s -d '", command->name);
  put_fish(command->summary);
  puts("'");
  if (command->words && !command->words->option) {
    printf("complete -c conic -n '__conic_is %s' -a '", command->name);
    cli_help_put_list(command->words);
    puts("'");
  }
  for (int i = 0; cli_help_next(table, &i, &entry);)
    put_fish_option(command->name, &entry, command->words);
}
