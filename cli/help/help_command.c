/* conic help: of the program and of each command, in every format. */

#include "cli/help/help.h"
#include "cli/json_write.h"

const cli_help_row cli_help_exit_codes[] = {
    {"0", "done"},
    {"1", "compared and different"},
    {"2", "wrong usage"},
    {"3", "an input that cannot be used"},
    {"4", "a resource failed: memory, disk, what this build or machine lacks"},
    {"128+N", "stopped by signal N; 130 by Ctrl-C"},
    {NULL, NULL},
};

const cli_help_row cli_help_variables[] = {
    {"TERM", "a progress bar is shown on a terminal, unless this is dumb"},
    {"TMPDIR", "where what does not fit into memory goes that has no place beside an output; else /tmp"},
    {"XDG_CACHE_HOME", "programs that were built for an OpenCL device are kept in conic below this; else in ~/.cache"},
    {NULL, NULL},
};

void cli_help_usage(FILE *to) {
  fputs("conic draws point-sampled surfaces as splats.\n\n"
        "usage: conic COMMAND [arguments]\n"
        "       conic help [--all] [--format text|man|bash|zsh|fish|json] [COMMAND]\n"
        "       conic --version, -V\n\n"
        "commands:\n",
        to);
  for (int i = 0; cli_command_at(i); i++)
    fprintf(to, "  %-11s %s\n", cli_command_at(i)->name, cli_command_at(i)->summary);
}

/* What each feature of a build would bring, and Debian's package of it. */
static const struct {
  const char *feature, *brings, *package;
} missed[] = {{"OpenEXR", "pictures in EXR", "libopenexr-dev"},
              {"libpng", "textures and pictures to compare in PNG, and smaller PNG", "libpng-dev"},
              {"OpenImageIO", "JPEG, TIFF and others", "libopenimageio-dev"},
              {"Assimp", "3MF, DAE, FBX and others", "libassimp-dev"},
              {"libxml2", "E57", "libxml2-dev"},
              {"zstd", ".lpc and .spz", "libzstd-dev"},
              {"CURL", "clouds on the web", "libcurl4-openssl-dev"},
              {"zlib", "3MF, .spz, NPZ and glTF that are deflated", "zlib1g-dev"},
              {"libwebp", ".sog", "libwebp-dev"},
              {"Brotli", "Potree 2 that is packed", "libbrotli-dev"},
              {"Draco", "glTF by Draco", "libdraco-dev"},
              {"meshoptimizer", "glTF by meshopt", "libmeshoptimizer-dev"}};

static void print_missed(void) {
  const char *label = "this build lacks";
  for (int i = 0; conic_feature_at(i); i++)
    for (size_t k = 0; k < sizeof missed / sizeof *missed; k++)
      if (!conic_feature_at(i)->available && strcmp(conic_feature_at(i)->name, missed[k].feature) == 0) {
        printf("%s %s: %s (%s)", label, missed[k].feature, missed[k].brings, missed[k].package);
        label = ";";
      }
  if (*label == ';')
    putchar('\n');
}

static void print_program(void) {
  cli_help_usage(stdout);
  puts("\nreads: " CLI_READABLE "; " CLI_READABLE_GAUSSIANS);
  print_missed();
  puts("\nexit codes:");
  for (const cli_help_row *row = cli_help_exit_codes; row->name; row++)
    printf("  %-2s %s\n", row->name, row->meaning);
  puts("\nThe guide begins with docs/guide/first-picture.md beside conic's source.");
}

/* A form in which help is given. Completion is one text for all commands. */
typedef struct help_format {
  const char *name;
  void (*show)(cli_session *session, const cli_option_table *table);
  void (*program)(void); /* null: what is of each command stands between begin and end */
  void (*begin)(void), (*end)(void);
} help_format;

static const help_format formats[] = {
    {"text", cli_help_text, print_program},
    {"man", cli_help_man, cli_help_man_program},
    {"bash", cli_help_bash, .begin = cli_help_bash_begin, .end = cli_help_bash_end},
    {"zsh", cli_help_zsh, .begin = cli_help_zsh_begin, .end = cli_help_zsh_end},
    {"fish", cli_help_fish, .begin = cli_help_fish_begin},
    {"json", cli_help_json},
};

enum { N_FORMATS = sizeof formats / sizeof *formats };

/* A command is asked as its user asks it, so that what is shown is the table by which it reads its arguments. */
static int show_command(const help_format *format, const cli_command *command, cli_json *json, int is_whole) {
  char ask[] = "--help", name[32];
  snprintf(name, sizeof name, "%s", command->name);
  char *arguments[] = {name, ask, NULL};
  cli_session session = {.command = command->name, .show_help = format->show, .help = json, .is_help_whole = is_whole};
  return command->run(&session, 2, arguments);
}

static int show_commands(const help_format *format, const cli_command *only) {
  cli_json json;
  int is_json = format->show == cli_help_json, answer = CLI_DONE;
  if (format->begin)
    format->begin();
  if (is_json) {
    cli_json_begin(&json, stdout);
    cli_json_text(&json, "version", conic_version());
    cli_json_array(&json, "commands");
  }
  for (int i = 0; cli_command_at(i) && answer == CLI_DONE; i++)
    if (!only || only == cli_command_at(i))
      answer = show_command(format, cli_command_at(i), &json, 1);
  if (is_json) {
    cli_json_close(&json);
    cli_json_end(&json);
  }
  if (format->end)
    format->end();
  return answer;
}

static int show_help(const help_format *format, const char *name, int is_whole) {
  const cli_command *command = NULL;
  if (name && strcmp(name, "help") != 0) {
    command = cli_find_command(name);
    if (!command)
      return cli_refuse_command(name);
    if (format->begin)
      return cli_usage("help: completion is of all commands at once, and not of %s", name);
  }
  if (!command && format->program) {
    format->program();
    return CLI_DONE;
  }
  return format->program ? show_command(format, command, NULL, is_whole) : show_commands(format, command);
}

int cli_help(int argc, char **argv) {
  const help_format *format = &formats[0];
  const char *name = NULL, *word = NULL;
  int is_whole = 0;
  for (int i = 1; i < argc; i++) {
    if (strcmp(argv[i], "--format") == 0 || strncmp(argv[i], "--format=", 9) == 0) {
      word = argv[i][8] ? argv[i] + 9 : i + 1 < argc ? argv[++i] : "";
      format = NULL;
      for (int j = 0; j < N_FORMATS; j++)
        if (strcmp(formats[j].name, word) == 0)
          format = &formats[j];
      if (!format)
        return cli_usage("help: --format: \"%s\" is not understood; it takes text, man, bash, zsh, fish, json", word);
    } else if (strcmp(argv[i], "--all") == 0)
      is_whole = 1;
    else if (argv[i][0] != '-' && !name)
      name = argv[i];
  }
  return show_help(format, name, is_whole);
}
