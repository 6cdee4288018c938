/* Reading arguments: what is understood, what is refused, and which name a mistyped one is near. */
#include <string.h>

#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/outputs.h"
#include "core/base/nearest_word.h"
#include "tests/support/check.h"

const cli_command *cli_find_command(const char *name) {
  (void)name;
  return NULL;
}

typedef struct settings {
  int flag, is_given, integer, choice, size[2], parsed;
  unsigned long long count;
  double number, vector[3];
  const char *text;
  const char *positional[8];
  int n_positional;
  cli_session session;
} settings;

static int parse_even(const char *text, void *value) {
  *(int *)value = text[0] - '0';
  return text[0] >= '0' && text[0] <= '9' && text[1] == '\0' && (text[0] - '0') % 2 == 0;
}

/* Parses a line of arguments that are parted by blanks. */
static int parse(settings *to, const char *line) {
  static const char *const choices[] = {"conic", "ray", NULL};
  static char words[512];
  char *argv[16] = {words};
  int argc = 1;
  memset(to, 0, sizeof *to);
  to->session.command = "test";
  const cli_option options[] = {
      {.name = "flag", .type = CLI_FLAG, .value = &to->flag, .help = "a flag"},
      {.name = "integer", .type = CLI_INT, .value = &to->integer, .argument = "N", .minimum = -5, .maximum = 5},
      {.name = "n", .type = CLI_COUNT, .value = &to->count, .argument = "COUNT", .is_given = &to->is_given},
      {.name = "number", .type = CLI_NUMBER, .value = &to->number, .argument = "X", .minimum = 0, .maximum = 1e9},
      {.name = "o", .type = CLI_TEXT, .value = &to->text, .argument = "FILE", .help = "a file"},
      {.name = "method", .type = CLI_CHOICE, .value = &to->choice, .argument = "METHOD", .choices = choices},
      {.name = "light", .type = CLI_VECTOR, .value = to->vector, .argument = "X,Y,Z"},
      {.name = "size", .type = CLI_SIZE, .value = to->size, .argument = "WxH", .minimum = 1, .maximum = 65535},
      {.name = "even", .type = CLI_PARSED, .value = &to->parsed, .argument = "DIGIT", .parse = parse_even},
  };
  snprintf(words, sizeof words, "test %s", line);
  for (char *blank = strchr(words, ' '); blank; blank = strchr(blank + 1, ' ')) {
    *blank = '\0';
    if (blank[1])
      argv[argc++] = blank + 1;
  }
  return cli_parse(&to->session, options, (int)(sizeof options / sizeof options[0]), argc, argv, to->positional,
                   &to->n_positional);
}

static int parse_tail(const char *text, void *value) {
  return cli_parse_number(text, value);
}

/* What stands behind a colon, old spellings, and which options were given. */
static void check_noted(void) {
  char *argv[] = {"test", "--size=3:4", "--loud", "--loud", "in"}, *wrong[] = {"test", "--size=3:x"};
  const char *positional[8], *values[3];
  double size = 0.0, tail = 0.0;
  int is_loud = 0, n_positional;
  cli_session session = {.command = "test"};
  const cli_option options[] = {
      {.name = "size", .type = CLI_NUMBER, .value = &size, .argument = "N", .parse_tail = parse_tail, .tail = &tail},
      {.name = "loud", .type = CLI_FLAG, .value = &is_loud, .now = "--noise 9"},
      {.name = "noise", .type = CLI_NUMBER, .value = &size, .argument = "N"},
  };
  CHECK(cli_parse_noting(&session, options, 3, 5, argv, positional, &n_positional, values) == CLI_DONE);
  CHECK(size == 3.0 && tail == 4.0 && is_loud && n_positional == 1);
  CHECK(values[0] && strcmp(values[0], "3:4") == 0 && values[1] && !values[2]);
  CHECK(session.old_spellings[0].name && strcmp(session.old_spellings[0].now, "--noise 9") == 0);
  CHECK(!session.old_spellings[1].name);
  CHECK(cli_parse_noting(&session, options, 3, 2, wrong, positional, &n_positional, values) == CLI_USAGE);
}

static void check_understood(void) {
  settings got;
  CHECK(parse(&got, "") == CLI_DONE && got.n_positional == 0 && !got.is_given);
  CHECK(parse(&got, "a --flag b -n 12 -") == CLI_DONE && got.flag && got.count == 12 && got.is_given);
  CHECK(got.n_positional == 3 && strcmp(got.positional[1], "b") == 0 && strcmp(got.positional[2], "-") == 0);
  CHECK(parse(&got, "--flag -- --flag -n") == CLI_DONE && got.n_positional == 2);
  CHECK(parse(&got, "--integer=-5") == CLI_DONE && got.integer == -5);
  CHECK(parse(&got, "--integer -4 --integer 3") == CLI_DONE && got.integer == 3);
  CHECK(parse(&got, "--number 0.25") == CLI_DONE && got.number == 0.25);
  CHECK(parse(&got, "--number=1e3") == CLI_DONE && got.number == 1000.0);
  CHECK(parse(&got, "-o=x") == CLI_DONE && strcmp(got.text, "=x") == 0);
  CHECK(parse(&got, "-o -") == CLI_DONE && strcmp(got.text, "-") == 0);
  CHECK(parse(&got, "--method ray") == CLI_DONE && got.choice == 1);
  CHECK(parse(&got, "--light -1,2.5,3e-1") == CLI_DONE && got.vector[0] == -1.0 && got.vector[1] == 2.5 &&
        got.vector[2] == 0.3);
  CHECK(parse(&got, "--size 1920x1080") == CLI_DONE && got.size[0] == 1920 && got.size[1] == 1080);
  CHECK(parse(&got, "--even 4") == CLI_DONE && got.parsed == 4);
  CHECK(parse(&got, "--threads 7 --json - --quiet --verbose") == CLI_DONE && got.session.threads == 7 &&
        strcmp(got.session.json_path, "-") == 0 && got.session.is_quiet && got.session.is_verbose);
  CHECK(parse(&got, "-q -v") == CLI_DONE && got.session.is_quiet && got.session.is_verbose);
}

static void check_counts(void) {
  static const struct {
    const char *text;
    unsigned long long value;
  } counts[] = {{"0", 0},        {"10k", 10000},
                {"2M", 2000000}, {"1e6", 1000000},
                {"1.5k", 1500},  {"3G", 3000000000},
                {"2.5e3", 2500}, {"18446744073709551615", ~0ULL},
                {"007", 7},      {"9007199254740993", 9007199254740993ULL}};
  for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
    settings got;
    char line[64];
    snprintf(line, sizeof line, "-n %s", counts[i].text);
    CHECK(parse(&got, line) == CLI_DONE && got.count == counts[i].value);
  }
}

static void check_refused(void) {
  static const char *const lines[] = {
      "--unknown",       "-x",           "--n 3",        "--flag=1",     "--integer",       "--integer 6",
      "--integer 1.5",   "--integer=",   "--integer 3a", "-n",           "-n -3",           "-n 1.5",
      "-n 1.0005k",      "-n 10kk",      "-n 0x10",      "-n nan",       "-n 1e30",         "-n 18446744073709551616",
      "--number nan",    "--number inf", "--number -1",  "--number 2e9", "--number 0x1p3",  "--number 1,5",
      "--number 1e999",  "--method r",   "--method",     "--light 1,2",  "--light 1,2,3,4", "--light 1,2,x",
      "--light 1,,2",    "--size 10",    "--size 0x10",  "--size 10x",   "--size 10x70000", "--size x10",
      "--size 10x10x10", "--even 3",     "--even",       "-o",           "-o --flag",       "--threads 2000",
      "--threads -1",    "--json",       "--fla",
  };
  for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
    settings got;
    int exit_code = parse(&got, lines[i]);
    if (exit_code != CLI_USAGE)
      fprintf(stderr, "not refused: %s\n", lines[i]);
    CHECK(exit_code == CLI_USAGE);
  }
}

static void check_nearest(void) {
  static const char *const names[] = {"make", "prepare", "render", "diff", "info"};
  static const struct {
    const char *word, *nearest;
  } cases[] = {{"rendr", "render"}, {"redner", "render"}, {"diffs", "diff"}, {"prep", "prepare"},
               {"infp", "info"},    {"mkae", "make"},     {"zzzzzz", NULL},  {"", NULL}};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    const char *nearest = NULL;
    for (size_t name = 0; name < sizeof names / sizeof names[0]; name++)
      nearest = conic_nearer_word(cases[i].word, nearest, names[name]);
    CHECK(!nearest == !cases[i].nearest && (!nearest || strcmp(nearest, cases[i].nearest) == 0));
  }
  CHECK(conic_word_distance("kitten", "sitting") == 3);
  CHECK(conic_word_distance("ab", "ba") == 1);
  CHECK(conic_word_distance("", "abc") == 3);
}

static void check_outputs(void) {
  cli_session session = {.command = "test"};
  const char *const different[] = {"a", "-", NULL, "b", "/dev/null", "/dev/null"};
  const char *const twice[] = {"-", NULL, "-"};
  const char *const same[] = {"a", "a"};
  CHECK(cli_check_outputs(&session, different, 6) == CLI_DONE);
  CHECK(cli_check_outputs(&session, twice, 3) == CLI_USAGE);
  CHECK(cli_check_outputs(&session, same, 2) == CLI_USAGE);
  session.json_path = "-";
  CHECK(cli_check_outputs(&session, different, 1) == CLI_DONE);
  CHECK(cli_check_outputs(&session, different, 2) == CLI_USAGE);
}

static void test_lengths(void) {
  cli_length length;
  CHECK(cli_parse_length("0.5x", &length) && length.value == 0.5 && length.is_in_spacings);
  CHECK(cli_parse_length("2", &length) && length.value == 2.0 && !length.is_in_spacings);
  CHECK(!cli_parse_length("x", &length) && !cli_parse_length("2y", &length) && !cli_parse_length("2xx", &length));
  CHECK(!cli_parse_length("-1", &length) && !cli_parse_length("", &length) && !cli_parse_length("nan", &length));
}

int main(void) {
  check_noted();
  check_understood();
  check_counts();
  check_refused();
  check_nearest();
  check_outputs();
  test_lengths();
  return check_result();
}
