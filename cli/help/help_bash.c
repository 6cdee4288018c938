/* Completion for bash: a function that knows each command's options and what their values are. */

#include "cli/help/help.h"

void cli_help_bash_begin(void) {
  puts("# bash completion of conic. Made by conic help --format bash\n"
       "_conic() {\n"
       "  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}\n"
       "  local options= kind=file words=\n"
       "  COMPREPLY=()\n"
       "  if [[ $current == '=' ]]; then # --name=value comes in three words\n"
       "    current=\n"
       "  elif [[ $previous == '=' ]] && ((COMP_CWORD >= 2)); then\n"
       "    previous=${COMP_WORDS[COMP_CWORD - 2]}\n"
       "  fi\n"
       "  case ${COMP_WORDS[1]} in");
}

static void print_value_case(const cli_help_entry *entry) {
  static const char *const kinds[] = {"option", "file", "words", "file", "folder"};
  const cli_option *option = entry->option;
  int is_number = entry->kind == CLI_VALUE_OTHER && option->type != CLI_TEXT;
  printf("        %s%s) kind=%s", cli_dashes(option), option->name, is_number ? "none" : kinds[entry->kind]);
  if (entry->kind == CLI_VALUE_WORDS) {
    fputs(" words='", stdout);
    cli_help_put_choices(option);
    putchar('\'');
  }
  puts(" ;;");
}

void cli_help_bash(cli_session *session, const cli_option_table *table) {
  const cli_words *list = cli_find_command(session->command)->words;
  cli_help_entry entry;
  printf("    %s)\n      options='", session->command);
  for (int i = 0, n = 0; cli_help_next(table, &i, &entry); n++) {
    printf("%s%s%s", n ? " " : "", cli_dashes(entry.option), entry.option->name);
    if (entry.alias)
      printf(" %s%s", cli_dashes(entry.alias), entry.alias->name);
  }
  puts("'");
  if (list) {
    fputs("      words='", stdout);
    cli_help_put_list(list);
    puts("'");
  }
  puts("      case $previous in");
  for (int i = 0; cli_help_next(table, &i, &entry);)
    if (list && list->option && entry.option->type != CLI_FLAG && strcmp(entry.option->name, list->option) == 0)
      printf("        %s%s) kind=words ;;\n", cli_dashes(entry.option), entry.option->name);
    else if (entry.kind != CLI_VALUE_NONE)
      print_value_case(&entry);
  printf("        *) kind=%s ;;\n      esac\n      ;;\n", list && !list->option ? "either" : "argument");
}

static void put_commands(void) {
  fputs("kind=words words='", stdout);
  for (int i = 0; cli_command_at(i); i++)
    printf("%s ", cli_command_at(i)->name);
}

void cli_help_bash_end(void) {
  fputs("    help) ", stdout);
  put_commands();
  puts("--format' ;;\n"
       "    *) kind=none ;;\n"
       "  esac\n"
       "  if ((COMP_CWORD == 1)); then");
  fputs("    ", stdout);
  put_commands();
  puts("help --help --version'\n"
       "  elif [[ $current == -* && $kind == @(argument|either) ]]; then\n"
       "    kind=words words=$options\n"
       "  fi\n"
       "  case $kind in\n"
       "    words) mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$current\") ;;\n"
       "    either) mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$current\"; compgen -f -- \"$current\") ;;\n"
       "    folder) mapfile -t COMPREPLY < <(compgen -d -- \"$current\") ;;\n"
       "    file | argument) mapfile -t COMPREPLY < <(compgen -f -- \"$current\") ;;\n"
       "  esac\n"
       "  if [[ $kind != words && $kind != none ]]; then\n"
       "    compopt -o filenames 2> /dev/null\n"
       "  fi\n"
       "}\n"
       "complete -F _conic conic");
}
