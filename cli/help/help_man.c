/* Manual pages. */
#include <ctype.h>

#include "cli/help/help.h"

enum { LINE_BYTES = 64 };

/* Text as roff takes it literally. */
static void put_roff(const char *text, size_t length) {
  for (size_t i = 0; i < length; i++)
    if (text[i] == '\\')
      fputs("\\e", stdout);
    else if (text[i] == '-')
      fputs("\\-", stdout);
    else
      putchar(text[i]);
}

/* How much of a word is an option's name, or a value's: "--size," "[-o" "WxH]". What stands around it stays roman. */
static size_t find_term(const char *word, size_t length, int marks_values, size_t *first, char *font) {
  *first = strspn(word, "([\"|");
  const char *term = word + *first;
  if (*first >= length)
    return 0;
  size_t n = 0;
  if (term[0] == '-' && (term[1] == '-' || isalpha((unsigned char)term[1]))) {
    *font = 'B';
    while (*first + n < length && (isalnum((unsigned char)term[n]) || term[n] == '-'))
      n++;
    return n;
  }
  *font = 'I';
  while (marks_values && *first + n < length && (isupper((unsigned char)term[n]) || term[n] == '_' || term[n] == ','))
    n++;
  return n && !(*first + n < length && islower((unsigned char)term[n])) ? n : 0;
}

static void put_word(const char *word, size_t length, int marks_values) {
  size_t first;
  char font = 'B';
  size_t n = find_term(word, length, marks_values, &first, &font);
  if (!n) {
    put_roff(word, length);
    return;
  }
  put_roff(word, first);
  printf("\\f%c", font);
  put_roff(word + first, n);
  fputs("\\fR", stdout);
  put_roff(word + first + n, length - first - n);
}

/* A paragraph, in lines that do not begin with what roff takes for a request. */
static void put_words(const char *text, int marks_values) {
  size_t column = 0;
  for (text += strspn(text, " \n"); *text; text += strspn(text, " \n")) {
    size_t length = strcspn(text, " \n");
    if (column && column + 1 + length > LINE_BYTES)
      column = 0, putchar('\n');
    else if (column)
      column++, putchar(' ');
    if (!column && (text[0] == '.' || text[0] == '\''))
      fputs("\\&", stdout);
    put_word(text, length, marks_values);
    column += length;
    text += length;
  }
}

static void put_paragraph(const char *text, int marks_values) {
  put_words(text, marks_values);
  putchar('\n');
}

/* A text of the table, which has no full stop. */
static void put_sentence(const char *text, const char *end) {
  size_t length = strlen(text);
  put_words(text, 0);
  puts(length && strchr(".?!", text[length - 1]) ? "" : end);
}

static void put_heading(const char *request, const char *text) {
  printf("%s %c", request, toupper((unsigned char)text[0]));
  put_roff(text + 1, strlen(text + 1));
  putchar('\n');
}

static void put_tag(const char *name, const char *about) {
  fputs(".TP\n.B ", stdout);
  put_roff(name, strlen(name));
  putchar('\n');
  put_sentence(about, ".");
}

static void put_title(const char *command) {
  fputs(".TH CONIC", stdout);
  for (const char *letter = command ? command : ""; *letter; letter++)
    printf("%s%c", letter == command ? "\\-" : "", toupper((unsigned char)*letter));
  printf(" 1 \"\" \"conic %s\" \"conic manual\"\n.SH NAME\nconic%s%s", conic_version(), command ? "\\-" : "",
         command ? command : "");
  fputs(" \\- ", stdout);
}

/* Each line that begins with "conic" is a way to call it; others go on. */
static void put_usage(const char *usage) {
  puts(".SH SYNOPSIS");
  while (*usage) {
    const char *end = strstr(usage, "\nconic ");
    size_t length = end ? (size_t)(end - usage) : strlen(usage);
    char line[1024];
    snprintf(line, sizeof line, "%.*s", (int)length, usage);
    const char *rest = line + strcspn(line, " ");
    rest += strspn(rest, " ");
    size_t n_name = strcspn(rest, " "); /* of the command */
    fputs(".SY \"conic ", stdout);
    put_roff(rest, n_name);
    puts("\"");
    put_paragraph(rest + n_name, 1);
    puts(".YS");
    usage += length + (end != NULL);
  }
}

static void put_option(const cli_help_entry *entry) {
  const cli_option *option = entry->option;
  char line[1400], limits[80];
  fputs(".TP\n\\fB", stdout);
  put_roff(cli_dashes(option), strlen(cli_dashes(option)));
  put_roff(option->name, strlen(option->name));
  fputs("\\fR", stdout);
  if (entry->alias) {
    fputs(", \\fB", stdout);
    put_roff(cli_dashes(entry->alias), strlen(cli_dashes(entry->alias)));
    printf("%s\\fR", entry->alias->name);
  }
  if (option->argument) {
    fputs(" \\fI", stdout);
    put_roff(option->argument, strlen(option->argument));
    fputs("\\fR", stdout);
  }
  putchar('\n');
  put_sentence(entry->text, ".");
  if (cli_help_hides_words(entry)) {
    size_t used = (size_t)snprintf(line, sizeof line, "One of:");
    for (int i = 0; option->choices[i] && used < sizeof line; i++)
      used += (size_t)snprintf(line + used, sizeof line - used, "%s %s", i ? "," : "", option->choices[i]);
    put_sentence(line, ".");
  }
  cli_help_limits(entry, limits, sizeof limits);
  if (limits[0]) {
    snprintf(line, sizeof line, "From %s.", limits);
    put_paragraph(line, 0);
  }
  if (option->may_repeat && !strstr(entry->text, "repeated"))
    put_paragraph("It may be repeated.", 0);
  if (entry->fallback[0]) {
    snprintf(line, sizeof line, "Default: %s.", entry->fallback);
    put_paragraph(line, 0);
  }
}

static void put_exit_codes(void) {
  puts(".SH EXIT STATUS");
  for (const cli_help_row *row = cli_help_exit_codes; row->name; row++)
    put_tag(row->name, row->meaning);
}

void cli_help_man(cli_session *session, const cli_option_table *table) {
  const cli_command *command = cli_find_command(session->command);
  cli_help_entry entry;
  const char *about;
  put_title(command->name);
  put_paragraph(command->summary, 0);
  put_usage(command->usage);
  puts(".SH DESCRIPTION");
  put_sentence(command->description ? command->description : command->summary, ".");
  if (command->words) {
    put_heading(".SS", command->words->title);
    for (int i = 0; command->words->at(i, &about); i++)
      put_tag(command->words->at(i, &about), about);
  }
  puts(".SH OPTIONS");
  for (int i = 0; cli_help_next(table, &i, &entry);) {
    if (entry.group && strcmp(entry.group, "options") != 0)
      put_heading(".SS", entry.group);
    if (entry.intro)
      put_paragraph(entry.intro, 0);
    put_option(&entry);
  }
  put_exit_codes();
  for (int i = 0; i < 4 && command->examples[i].command; i++) {
    puts(i ? ".PP" : ".SH EXAMPLES");
    put_sentence(command->examples[i].what, ":");
    puts(".RS 4\n.EX");
    put_roff(command->examples[i].command, strlen(command->examples[i].command));
    puts("\n.EE\n.RE");
  }
  puts(".SH SEE ALSO\n.BR conic (1),\n.BR conic (3)");
}

void cli_help_man_program(void) {
  put_title(NULL);
  put_paragraph("draws surfaces that are given as points, meshes or Gaussians", 0);
  put_usage("conic COMMAND [arguments]\nconic help [--format FORMAT] [COMMAND]\nconic --version");
  puts(".SH DESCRIPTION");
  put_paragraph(
      "conic draws laser scans, splats, meshes and Gaussian scenes into pictures, on the processor and without a "
      "display. A picture has the same bits on every machine. conic also builds what it draws fast from, compares "
      "pictures, and says why a pixel is as it is.",
      0);
  puts(".PP");
  put_paragraph("conic reads " CLI_READABLE " and " CLI_READABLE_GAUSSIANS ". A long option takes its "
                "value as --name value or --name=value; -- ends the options.",
                0);
  puts(".SH COMMANDS");
  for (int i = 0; cli_command_at(i); i++) {
    printf(".TP\n.BR conic\\-%s (1)\n", cli_command_at(i)->name);
    put_sentence(cli_command_at(i)->summary, ".");
  }
  puts(".TP\n.B conic help");
  put_paragraph("prints the options of a command; with --all, of render more than most pictures need. --format says in "
                "which form: text, man, bash, zsh or fish (completion), or json.",
                0);
  put_exit_codes();
  puts(".SH ENVIRONMENT");
  for (const cli_help_row *row = cli_help_variables; row->name; row++)
    put_tag(row->name, row->meaning);
  puts(".SH EXAMPLES\n.EX\nconic make knot \\-o scan.ply\nconic render scan.ply \\-o scan.png\n.EE");
  fputs(".SH SEE ALSO\n", stdout);
  for (int i = 0; cli_command_at(i); i++)
    printf(".BR conic\\-%s (1),\n", cli_command_at(i)->name);
  puts(".BR conic (3)");
}
