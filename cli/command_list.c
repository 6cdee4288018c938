/* All sub-commands, by their names. */

#include "cli/command.h"
#include "cli/words.h"
#include "core/base/nearest_word.h"

static const cli_command *const commands[] = {
    &cli_make,   &cli_prepare, &cli_octree,  &cli_layer,    &cli_merge,       &cli_cut,   &cli_mls,   &cli_csg,
    &cli_hybrid, &cli_convert, &cli_render,  &cli_sheet,    &cli_contact,     &cli_diff,  &cli_info,  &cli_verify,
    &cli_judge,  &cli_explain, &cli_project, &cli_gradient, &cli_conformance, &cli_chart, &cli_bench, &cli_devices};

enum { N_COMMANDS = sizeof commands / sizeof commands[0] };

const cli_command *cli_find_command(const char *name) {
  for (int i = 0; i < N_COMMANDS; i++)
    if (strcmp(commands[i]->name, name) == 0)
      return commands[i];
  return NULL;
}

const cli_command *cli_command_at(int i) {
  return i < N_COMMANDS ? commands[i] : NULL;
}

int cli_refuse_command(const char *name) {
  if (strcmp(name, "simulate") == 0) /* a command of earlier builds */
    return cli_usage("simulate is a script of conic's source: scripts/simulate, with the same options");
  const cli_word *word = cli_word_for_command(name);
  if (word)
    return cli_usage("unknown command %s: %s%s", name, word->hint ? word->hint : "conic ",
                     word->hint  ? ""
                     : *word->is ? word->is
                                 : "FILE draws a picture of it");
  int is_option = name[0] == '-';
  const char *kind = is_option ? "option" : "command";
  const char *nearest = conic_nearer_word(name, NULL, is_option ? "--version" : "help");
  if (is_option)
    nearest = conic_nearer_word(name, nearest, "--help");
  for (int i = 0; i < N_COMMANDS && !is_option; i++)
    nearest = conic_nearer_word(name, nearest, commands[i]->name);
  if (nearest)
    return cli_usage("unknown %s %s; did you mean %s?", kind, name, nearest);
  return cli_usage("unknown %s %s; see conic help", kind, name);
}
