#include "cli/arguments.h"

#include <inttypes.h>
#include <limits.h>

#include "cli/command.h"
#include "cli/host.h"
#include "cli/option_check.h"
#include "cli/words.h"
#include "core/base/nearest_word.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/formats/text_columns.h"

enum { N_COMMON = 8 };

/* The options of every command. */
static void list_common(cli_session *session, int *is_help, cli_option common[N_COMMON]) {
  const cli_option list[N_COMMON] = {
      {"threads", CLI_INT, &session->threads, "N", "how many threads compute; the results never depend on it [0: all]",
       0, 1024, .is_usual = 1, .acts.is_work = 1},
      {"json", CLI_TEXT, &session->json_path, "FILE", "write statistics of the run as JSON; - is standard output",
       .is_usual = 1, .acts.is_work = 1},
      {"quiet", CLI_FLAG, &session->is_quiet, NULL, "no progress bar, no warnings; results are printed", .is_usual = 1,
       .acts.is_work = 1},
      {"q", CLI_FLAG, &session->is_quiet},
      {"verbose", CLI_FLAG, &session->is_verbose, NULL, "say more on standard error", .acts.is_work = 1},
      {"v", CLI_FLAG, &session->is_verbose},
      {"help", CLI_FLAG, is_help, NULL, "this text", .is_usual = 1, .acts.is_work = 1},
      {"h", CLI_FLAG, is_help},
  };
  memcpy(common, list, sizeof list);
}

/* A decimal number without anything behind it; strtod alone would also take blanks, hexadecimals, "inf" and "nan". */
static int parse_decimal(const char *text, const char **end, double *number) {
  if (strspn(text, "+-.0123456789") == 0 || text[strspn(text, "+-0")] == 'x' || text[strspn(text, "+-0")] == 'X')
    return 0;
  char *stop;
  *number = strtod(text, &stop);
  *end = stop;
  return stop != text && *number - *number == 0.0;
}

int cli_parse_number(const char *text, double *number) {
  const char *end;
  return parse_decimal(text, &end, number) && *end == '\0';
}

static int parse_int(const char *text, int *value) {
  char *end;
  if (strspn(text, "+-0123456789") != strlen(text))
    return 0;
  long long number = strtoll(text, &end, 10);
  if (end == text || *end || number < INT_MIN || number > INT_MAX)
    return 0;
  *value = (int)number;
  return 1;
}

/* All digits are taken exactly; 10k, 2M, 1.5e6 as long as they are whole. */
int cli_parse_count(const char *text, unsigned long long *value) {
  unsigned long long exact = 0;
  const char *digit = text;
  for (; *digit >= '0' && *digit <= '9'; digit++) {
    unsigned next = (unsigned)(*digit - '0');
    if (exact > (ULLONG_MAX - next) / 10)
      return 0;
    exact = 10 * exact + next;
  }
  if (digit != text && *digit == '\0') {
    *value = exact;
    return 1;
  }
  const char *end;
  double number;
  if (!parse_decimal(text, &end, &number))
    return 0;
  number *= *end == 'k' ? 1e3 : *end == 'M' ? 1e6 : *end == 'G' ? 1e9 : 1.0;
  end += *end == 'k' || *end == 'M' || *end == 'G';
  if (*end || !(number >= 0.0 && number < 9e15) || number != (double)(unsigned long long)number)
    return 0;
  *value = (unsigned long long)number;
  return 1;
}

/* What is wrong with the value that is being read. */
static _Thread_local const char *wrong;

int cli_because(const char *reason) {
  wrong = reason;
  return 0;
}

/* 2 or 3 numbers, with a separator between them. */
static int parse_row(const char *text, int n, char separator, double *numbers) {
  for (int i = 0; i < n; i++) {
    const char *end;
    if (!parse_decimal(text, &end, &numbers[i]) || *end != (i < n - 1 ? separator : '\0'))
      return cli_because(n == 2 ? "2 numbers are wanted" : "3 numbers are wanted");
    text = end + 1;
  }
  return 1;
}

int cli_parse_pair(const char *text, char separator, double pair[2]) {
  return parse_row(text, 2, separator, pair);
}

int cli_parse_vector(const char *text, double vector[3]) {
  return parse_row(text, 3, ',', vector);
}

int cli_parse_direction(const char *text, double vector[3]) {
  return cli_parse_vector(text, vector) &&
         (vector[0] != 0.0 || vector[1] != 0.0 || vector[2] != 0.0 || cli_because("0,0,0 is no direction"));
}

int cli_parse_length(const char *text, void *length) {
  cli_length *parsed = length;
  const char *end;
  if (!parse_decimal(text, &end, &parsed->value) || !(parsed->value >= 0.0) || !(parsed->value < 1e30))
    return 0;
  parsed->is_in_spacings = *end == 'x';
  return end[parsed->is_in_spacings] == '\0';
}

const char *const cli_color_meanings[] = {"file", "display", "linear", NULL};

int cli_parse_columns(const char *text, void *columns) {
  conic_text_columns parsed;
  *(const char **)columns = text;
  return conic_text_columns_parse(text, &parsed) == NULL;
}

static int parse_size(const char *text, int size[2]) {
  char width[16];
  const char *cross = strchr(text, 'x');
  if (!cross || cross - text >= (int)sizeof width)
    return cli_because("2 whole numbers are wanted, as 640x360");
  snprintf(width, sizeof width, "%.*s", (int)(cross - text), text);
  return (parse_int(width, &size[0]) && parse_int(cross + 1, &size[1])) ||
         cli_because("2 whole numbers are wanted, as 640x360");
}

static int parse_choice(const char *text, const char *const *choices, int *value) {
  for (int i = 0; choices[i]; i++) {
    if (strcmp(text, choices[i]) == 0) {
      *value = i;
      return 1;
    }
  }
  return 0;
}

static int is_within_limits(const cli_option *option, double value) {
  return (option->minimum == 0.0 && option->maximum == 0.0) || (value >= option->minimum && value <= option->maximum);
}

static int refuse_range(const cli_session *session, const cli_option *option, const char *text) {
  return cli_usage("%s: %s%s: %s is not between %.10g and %.10g", session->command, cli_dashes(option), option->name,
                   text, option->minimum, option->maximum);
}

static int refuse_text(const cli_session *session, const cli_option *option, const char *text) {
  char words[512] = "";
  size_t used = 0;
  for (int i = 0; option->type == CLI_CHOICE && option->choices[i] && used < sizeof words; i++)
    used += (size_t)snprintf(words + used, sizeof words - used, "%s%s", i ? ", " : "", option->choices[i]);
  if (!used)
    return cli_usage("%s: %s%s: \"%s\" is not understood%s%s; it takes %s: %s", session->command, cli_dashes(option),
                     option->name, text, wrong ? ": " : "", wrong ? wrong : "", option->argument, option->help);
  return cli_usage("%s: %s%s: \"%s\" is not understood; it takes %s", session->command, cli_dashes(option),
                   option->name, text, words);
}

/* Whether it is a number, and none that the option takes. */
static int is_too_large(const cli_option *option, const char *text) {
  double number;
  return cli_parse_number(text, &number) && !is_within_limits(option, number);
}

/* Reads one value; CLI_DONE or CLI_USAGE after a message. */
static int store_value(const cli_session *session, const cli_option *option, const char *text) {
  int is_understood = 1, is_in_range = 1;
  const char *whole = text, *colon = text && option->parse_tail ? strchr(text, ':') : NULL;
  char head[64];
  wrong = NULL;
  if (colon) {
    snprintf(head, sizeof head, "%.*s", (int)(colon - text), text);
    if (colon - text >= (int)sizeof head || !option->parse_tail(colon + 1, option->tail))
      return refuse_text(session, option, whole);
    text = head;
  }
  switch (option->type) {
  case CLI_FLAG:
    *(int *)option->value = 1;
    break;
  case CLI_INT:
    is_understood = parse_int(text, option->value);
    is_in_range = is_understood && is_within_limits(option, *(int *)option->value);
    is_understood = is_understood || is_too_large(option, text); /* as 1e6 may be, which is no int's way of writing */
    break;
  case CLI_COUNT:
    is_understood = cli_parse_count(text, option->value);
    is_in_range = is_understood && is_within_limits(option, (double)*(unsigned long long *)option->value);
    break;
  case CLI_NUMBER:
    is_understood = cli_parse_number(text, option->value);
    is_in_range = is_understood && is_within_limits(option, *(double *)option->value);
    break;
  case CLI_TEXT:
    *(const char **)option->value = text;
    is_understood = *text != '\0'; /* as of a shell's variable that was never set */
    break;
  case CLI_CHOICE:
    is_understood = parse_choice(text, option->choices, option->value);
    break;
  case CLI_VECTOR:
    is_understood = cli_parse_vector(text, option->value);
    break;
  case CLI_SIZE:
    is_understood = parse_size(text, option->value);
    is_in_range = is_understood && is_within_limits(option, ((int *)option->value)[0]) &&
                  is_within_limits(option, ((int *)option->value)[1]);
    break;
  case CLI_PARSED:
    is_understood = option->parse(text, option->value);
    break;
  }
  if (!is_understood)
    return refuse_text(session, option, whole);
  if (!is_in_range)
    return refuse_range(session, option, text);
  if (option->is_given)
    *option->is_given = 1;
  return CLI_DONE;
}

/* The command's options and the common ones, searched as one. */
typedef struct option_set {
  const cli_option *tables[2];
  int counts[2];
  const char **values[2]; /* each option's, as it was given last */
} option_set;

static const cli_option *find_option(const option_set *set, const char *name, size_t length, int is_long,
                                     const char ***value) {
  for (int table = 0; table < 2; table++)
    for (int i = 0; i < set->counts[table]; i++) {
      const cli_option *option = &set->tables[table][i];
      *value = &set->values[table][i];
      if (strlen(option->name) == length && strncmp(option->name, name, length) == 0 &&
          is_long == (cli_dashes(option)[1] == '-'))
        return option;
    }
  return NULL;
}

/* The last value holds, as scripts and aliases rely on; that another one is lost is said. */
static void warn_of_repeated(const cli_session *session, const cli_option *option, const char *former,
                             const char *value) {
  if (former && !option->may_repeat && strcmp(former, value) != 0)
    cli_warn(session, "%s: %s%s %s holds, and not %s, which was given before it", session->command, cli_dashes(option),
             option->name, value, former);
}

static int has_option(const void *cookie, const char *name) {
  const char **value;
  return find_option(cookie, name, strlen(name), name[1] != '\0', &value) != NULL;
}

static int refuse_option(const cli_session *session, const option_set *set, const char *argument) {
  char name[64];
  const char *nearest = NULL;
  snprintf(name, sizeof name, "%.*s", (int)strcspn(argument + strspn(argument, "-"), "="),
           argument + strspn(argument, "-"));
  for (int table = 0; table < 2; table++)
    for (int i = 0; i < set->counts[table]; i++)
      if (set->tables[table][i].name[1] && !set->tables[table][i].now)
        nearest = conic_nearer_word(name, nearest, set->tables[table][i].name);
  conic_disk_entry entry;
  if (conic_disk_look(argument, &entry))
    return cli_usage("%s: unknown option %s; the file of that name is ./%s", session->command, argument, argument);
  const cli_word *word = cli_word_for_option(name, strlen(name), has_option, set);
  if (word && word->hint)
    return cli_usage("%s: unknown option %s: %s", session->command, argument, word->hint);
  if (word)
    return cli_usage("%s: unknown option %s; did you mean %s%s%s%s?", session->command, argument,
                     word->is[1] ? "--" : "-", word->is, word->value && *word->value ? " " : "",
                     word->value ? word->value : "");
  if (nearest)
    return cli_usage("%s: unknown option %s; did you mean --%s?", session->command, argument, nearest);
  return cli_usage("%s: unknown option %s; see conic help %s", session->command, argument, session->command);
}

/* To be told when all is well. */
static void note_old(cli_session *session, const cli_option *option, const cli_word *word, const char *argument) {
  const int most = (int)(sizeof session->old_spellings / sizeof *session->old_spellings);
  int i = 0;
  while (i < most && session->old_spellings[i].name)
    i++;
  if (i < most) {
    session->old_spellings[i].name = word ? argument : option->name;
    session->old_spellings[i].now = option->now;
    session->old_spellings[i].word = word;
  }
}

/* What somebody else's word stands for here; null: nothing. Of a word after one dash, only a letter, or one with a
 * number behind it. */
static const cli_word *find_word(const option_set *set, const char *name, size_t length, int is_long) {
  if (!is_long && name[1] && !strchr("0123456789", name[1]))
    return NULL;
  const cli_word *word = cli_word_for_option(name, length, has_option, set);
  return word && !word->hint ? word : NULL;
}

/* Reads the option at argv[*i] and its value, which may be the next argument; *i moves to the last one used. */
static int parse_option(cli_session *session, const option_set *set, int argc, char **argv, int *i) {
  const char *argument = argv[*i], *value = NULL, **former;
  int is_long = argument[1] == '-';
  const char *name = argument + 1 + is_long;
  size_t length = is_long ? strcspn(name, "=") : 1;
  const cli_option *option = find_option(set, name, length, is_long, &former);
  const cli_word *word = option ? NULL : find_word(set, name, length, is_long);
  if (word)
    option = find_option(set, word->is, strlen(word->is), word->is[1] != '\0', &former);
  if (!option)
    return refuse_option(session, set, argument);
  if (name[length])
    value = name + length + is_long; /* behind the equals sign, or a short option's rest */
  if ((option->now && !*former) || word)
    note_old(session, option, word, argument);
  if (word && word->value && value)
    return cli_usage("%s: %s stands for a value, and takes none", session->command, argument);
  if (word && word->value)
    value = *word->value ? word->value : NULL;
  if (option->type == CLI_FLAG) {
    *former = option->name;
    return value ? cli_usage("%s: %s%s takes no value", session->command, cli_dashes(option), option->name)
                 : store_value(session, option, NULL);
  }
  if (!value && (*i + 1 >= argc || strncmp(argv[*i + 1], "--", 2) == 0))
    return cli_usage("%s: %s%s needs a value: %s", session->command, cli_dashes(option), option->name,
                     option->argument);
  if (!value)
    value = argv[++*i];
  warn_of_repeated(session, option, *former, value);
  *former = value;
  return store_value(session, option, value);
}

/* --- values of a host's --- */

/* Numbers as they read back the same, for options that take words, and for messages. */
static const char *say_numbers(cli_value *value) {
  size_t used = 0;
  if (value->type == CLI_VALUE_TEXT)
    return value->text;
  if (value->type == CLI_VALUE_WHOLE) {
    snprintf(value->said, sizeof value->said, "%" PRId64, value->whole);
    return value->said;
  }
  for (int i = 0; i < value->n_numbers; i++) {
    char number[40];
    for (int digits = 15; digits <= 17; digits++) {
      snprintf(number, sizeof number, "%.*g", digits, value->numbers[i]);
      if (strtod(number, NULL) == value->numbers[i])
        break;
    }
    used += (size_t)snprintf(value->said + used, sizeof value->said - used, "%s%s", i ? "," : "", number);
  }
  return value->said;
}

/* Numbers go where they belong as they are. 1: done; 0: the option takes words, or something else than these. */
static int store_numbers(const cli_option *option, const cli_value *value) {
  const int is_whole = value->type == CLI_VALUE_WHOLE, n = is_whole ? 1 : value->n_numbers;
  const double number = is_whole ? (double)value->whole : value->numbers[0];
  if (option->type == CLI_INT && is_whole && value->whole >= INT_MIN && value->whole <= INT_MAX)
    *(int *)option->value = (int)value->whole;
  else if (option->type == CLI_COUNT && is_whole && value->whole >= 0)
    *(unsigned long long *)option->value = (unsigned long long)value->whole;
  else if (option->type == CLI_NUMBER && n == 1 && number - number == 0.0)
    *(double *)option->value = number;
  else if (option->type == CLI_VECTOR && n == 3)
    memcpy(option->value, value->numbers, 3 * sizeof *value->numbers);
  else if (option->type == CLI_SIZE && n == 2)
    for (int i = 0; i < 2; i++) {
      const double edge = value->numbers[i];
      if (!(edge >= 0.0 && edge <= INT_MAX) || edge != (double)(int)edge)
        return 0;
      ((int *)option->value)[i] = (int)edge;
    }
  else
    return 0;
  return 1;
}

static int is_stored_in_range(const cli_option *option) {
  const int *whole = option->value;
  if (option->type == CLI_SIZE)
    return is_within_limits(option, whole[0]) && is_within_limits(option, whole[1]);
  return is_within_limits(option, option->type == CLI_INT     ? *whole
                                  : option->type == CLI_COUNT ? (double)*(unsigned long long *)option->value
                                                              : *(double *)option->value);
}

static int take_value(const cli_session *session, const option_set *set, cli_value *value) {
  const char **former;
  const cli_option *option = NULL;
  for (int is_long = 1; !option && is_long >= 0; is_long--)
    option = find_option(set, value->name, strlen(value->name), is_long, &former);
  if (!option)
    return refuse_option(session, set, value->name);
  const int is_flag = option->type == CLI_FLAG, is_set = value->type == CLI_VALUE_SET;
  const char *said = is_flag ? option->name : is_set ? NULL : say_numbers(value);
  if (option->now && !*former)
    cli_note(session, "%s: %s%s is now %s", session->command, cli_dashes(option), option->name, option->now);
  if (is_flag && !is_set)
    return cli_usage("%s: %s%s takes no value", session->command, cli_dashes(option), option->name);
  if (is_set && !is_flag)
    return cli_usage("%s: %s%s needs a value: %s", session->command, cli_dashes(option), option->name,
                     option->argument);
  *former = said;
  if (is_flag || !store_numbers(option, value))
    return store_value(session, option, is_flag ? NULL : said);
  if (!is_stored_in_range(option))
    return refuse_range(session, option, said);
  if (option->is_given)
    *option->is_given = 1;
  return CLI_DONE;
}

/* Whether a flag is given anywhere, whatever else is wrong with the arguments. */
static int asks_for(int argc, char **argv, const char *name, const char *letter) {
  for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++)
    if (strcmp(argv[i], name) == 0 || strcmp(argv[i], letter) == 0)
      return 1;
  return 0;
}

/* An argument at the end of which there is no file, where no -o is given: where the output goes, as of cp. */
static int take_output(cli_session *session, const option_set *set, int argc, char **argv, const char **positional,
                       int *n_positional) {
  const char **former;
  const cli_option *option = find_option(set, "o", 1, 0, &former);
  if (!option || *former || session->host || session->team || *n_positional < 2) /* ranks may look at other times */
    return CLI_DONE;
  const char *last = positional[*n_positional - 1], *other = positional[*n_positional - 2];
  const int is_input = *conic_file_ending(other) || strcmp(other, "-") == 0 || strcmp(session->command, "make") == 0;
  conic_disk_entry entry;
  if (!is_input || !*conic_file_ending(last) || conic_layers_is_url(last) || conic_disk_look(last, &entry))
    return CLI_DONE;
  int i_output = argc - 1;
  while (argv[i_output] != last)
    i_output--;
  cli_mean_command(session, argc, argv, i_output);
  --*n_positional;
  *former = last;
  return store_value(session, option, last);
}

int cli_parse(cli_session *session, const cli_option *options, int n_options, int argc, char **argv,
              const char **positional, int *n_positional) {
  const char *values[n_options + 1];
  return cli_parse_noting(session, options, n_options, argc, argv, positional, n_positional, values);
}

int cli_parse_noting(cli_session *session, const cli_option *options, int n_options, int argc, char **argv,
                     const char **positional, int *n_positional, const char **values) {
  int is_help = 0, exit_code = CLI_DONE, is_over = 0;
  cli_option common[N_COMMON];
  list_common(session, &is_help, common);
  *n_positional = 0;
  if (asks_for(argc, argv, "--help", "-h")) {
    const cli_option_table table = {options, common, n_options, N_COMMON};
    (session->show_help ? session->show_help : cli_help_text)(session, &table);
    return -1;
  }
  session->is_quiet = asks_for(argc, argv, "--quiet", "-q"); /* about the other arguments, too */
  const char *common_values[N_COMMON] = {NULL};
  memset(values, 0, (size_t)n_options * sizeof *values);
  option_set set = {{options, common}, {n_options, N_COMMON}, {values, common_values}};
  for (int i = 1; i < argc && exit_code == CLI_DONE; i++) {
    if (!is_over && strcmp(argv[i], "--") == 0)
      is_over = 1;
    else if (argv[i][0] == '\0')
      exit_code = cli_usage("%s: an argument is empty", session->command);
    else if (is_over || argv[i][0] != '-' || argv[i][1] == '\0')
      positional[(*n_positional)++] = argv[i];
    else
      exit_code = parse_option(session, &set, argc, argv, &i);
  }
  if (exit_code == CLI_DONE)
    exit_code = take_output(session, &set, argc, argv, positional, n_positional);
  for (size_t i = 0; session->host && i < session->host->n_values && exit_code == CLI_DONE; i++)
    exit_code = take_value(session, &set, &session->host->values[i]);
  return exit_code == CLI_DONE ? cli_effects_check_with(session, options, n_options, values, positional, *n_positional)
                               : exit_code;
}
