/* The program, but for its main: finds the sub-command and hands over. */

#include "cli/command.h"
#include "cli/words.h"
#include "core/files/disk.h"
#include "core/files/file.h"

static void print_features(const char *label, int available) {
  fputs(label, stdout);
  int n_printed = 0;
  for (int i = 0; conic_feature_at(i); i++)
    if (conic_feature_at(i)->available == available)
      n_printed += printf(" %s", conic_feature_at(i)->name) > 0;
  puts(n_printed ? "" : " none");
}

static int print_version(void) {
  printf("conic %s\n", conic_version());
  puts("License: BSD-3-Clause. There is no warranty.");
  print_features("In this build:", 1);
  print_features("Not in this build:", 0);
  return CLI_DONE;
}

/* What was meant where other words were used, once it is done. */
static void tell_words(const cli_session *session) {
  for (int i = 0; i < 8 && session->old_spellings[i].name; i++) {
    const char *name = session->old_spellings[i].name;
    const cli_word *word = session->old_spellings[i].word;
    if (word)
      cli_note(session, "%s: %.*s means %s%s%s%s", session->command, name[1] == '-' ? (int)strcspn(name, "=") : 2, name,
               word->is[1] ? "--" : "-", word->is, word->value && *word->value ? " " : "",
               word->value ? word->value : "");
    else
      cli_note(session, "%s: --%s is now %s", session->command, name, session->old_spellings[i].now);
  }
  if (*session->meant)
    cli_note(session, "in full: %s", session->meant);
}

static int run_known(const cli_command *command, int is_meant, int argc, char **argv,
                     const struct conic_executor *team) {
  cli_session session = {.command = command->name, .team = team};
  if (is_meant)
    cli_mean_command(&session, argc, argv, -1);
  int exit_code = command->run(&session, argc, argv);
  if (exit_code < CLI_USAGE)
    tell_words(&session);
  cli_session_close(&session);
  return exit_code;
}

static int is_output(const void *cookie, const char *name) {
  (void)cookie;
  return strcmp(name, "o") == 0;
}

/* conic FILE: draws it into FILE.png here, unless an output is named. */
static int run_file(int argc, char **argv, const struct conic_executor *team) {
  static char render[] = "render", o[] = "-o";
  const char *base = conic_file_name(argv[0]), *ending = conic_file_ending(base);
  const int n_stem = (int)(strlen(base) - strlen(ending) - (*ending != '\0'));
  char output[256], *words[argc + 3];
  int is_named = argc > 1 && argv[1][0] != '-';
  for (int i = 1; i < argc; i++)
    is_named |= strncmp(argv[i], "-o", 2) == 0 ||
                (strncmp(argv[i], "--", 2) == 0 &&
                 cli_word_for_option(argv[i] + 2, strcspn(argv[i] + 2, "="), is_output, NULL));
  snprintf(output, sizeof output, "%.*s.png", n_stem < 200 ? n_stem : 200, base);
  words[0] = render;
  memcpy(words + 1, argv, (size_t)argc * sizeof *argv);
  words[argc + 1] = o;
  words[argc + 2] = output;
  conic_disk_entry entry;
  if (!is_named && conic_disk_look(output, &entry))
    return cli_usage("%s is there already; conic render %s -o %s writes over it", output, argv[0], output);
  return run_known(&cli_render, 1, argc + (is_named ? 1 : 3), words, team);
}

static int is_file(const char *word) {
  conic_disk_entry entry;
  return word[0] != '-' && (*conic_file_ending(word) || conic_layers_is_url(word) ||
                            (conic_disk_look(word, &entry) && (entry.is_file || strchr(word, '/'))));
}

static int run_command(int argc, char **argv, const struct conic_executor *team) {
  const cli_command *command = cli_find_command(argv[0]);
  const cli_word *word = command ? NULL : cli_word_for_command(argv[0]);
  if (command)
    return run_known(command, 0, argc, argv, team);
  if (word && !word->hint && !*word->is && argc > 1)
    return run_file(argc - 1, argv + 1, team);
  if (word && !word->hint && strcmp(word->is, "--version") == 0)
    return print_version();
  if (word && !word->hint && *word->is) {
    char name[16];
    snprintf(name, sizeof name, "%s", word->is);
    argv[0] = name;
    return run_known(cli_find_command(name), 1, argc, argv, team);
  }
  return !word && is_file(argv[0]) ? run_file(argc, argv, team) : cli_refuse_command(argv[0]);
}

static int run(int argc, char **argv, const struct conic_executor *team) {
  if (argc < 2) {
    cli_help_usage(stderr);
    return CLI_USAGE;
  }
  if (strcmp(argv[1], "help") == 0 || strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0)
    return cli_help(argc - 1, argv + 1);
  if (strcmp(argv[1], "--version") == 0 || strcmp(argv[1], "-V") == 0)
    return print_version();
  return run_command(argc - 1, argv + 1, team);
}

int cli_program(int argc, char **argv, const struct conic_executor *team) {
  int exit_code = run(argc, argv, team);
  errno = 0;
  if ((fflush(stdout) != 0 || ferror(stdout)) && exit_code < CLI_USAGE)
    exit_code =
        cli_error(CLI_RESOURCE, "standard output: cannot write: %s", errno ? strerror(errno) : "the device failed");
  return cli_exit_after_signals(exit_code);
}
