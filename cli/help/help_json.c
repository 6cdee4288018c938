/* The table of options as JSON, for programs that are to know them all. */
#include "cli/help/help.h"
#include "cli/json_write.h"
#include "cli/option_check.h"

static void write_name(cli_json *json, const char *key, const cli_option *option) {
  char name[64];
  if (option)
    snprintf(name, sizeof name, "%s%s", cli_dashes(option), option->name);
  cli_json_text(json, key, option ? name : NULL);
}

/* The facts of a set by name. */
static void write_facts(cli_json *json, const char *key, unsigned long long facts) {
  cli_json_array(json, key);
  for (int i = 0; i < CLI_N_FACTS; i++)
    if (facts >> i & 1 && cli_fact_name(i))
      cli_json_text(json, NULL, cli_fact_name(i));
  cli_json_close(json);
}

static void write_option(cli_json *json, const char *group, const cli_help_entry *entry) {
  static const char *const types[] = {"flag",   "integer", "count", "number", "text",
                                      "choice", "vector",  "size",  "parsed"};
  const cli_option *option = entry->option;
  int is_limited = option->minimum != 0.0 || option->maximum != 0.0;
  cli_json_object(json, NULL);
  write_name(json, "name", option);
  write_name(json, "alias", entry->alias);
  cli_json_texts(json, NULL, {"group", group}, {"type", types[option->type]}, {"argument", option->argument},
                 {"text", entry->text}, {"default", entry->fallback[0] ? entry->fallback : NULL});
  if (is_limited) {
    cli_json_figures(json, NULL, {"minimum", option->minimum}, {"maximum", option->maximum});
  }
  if (option->choices) {
    cli_json_array(json, "words");
    for (int i = 0; option->choices[i]; i++)
      cli_json_text(json, NULL, option->choices[i]);
    cli_json_close(json);
  }
  cli_json_bool(json, "repeatable", option->may_repeat);
  cli_json_bool(json, "usual", option->is_usual);
  cli_json_bool(json, "is_work", option->acts.is_work); /* no bit of a picture depends on it */
  write_facts(json, "acts_on", option->acts.on);
  write_facts(json, "needs", option->acts.needs);
  cli_json_close(json);
}

void cli_help_json(cli_session *session, const cli_option_table *table) {
  const cli_command *command = cli_find_command(session->command);
  cli_json *json = session->help;
  cli_help_entry entry;
  const char *group = NULL;
  cli_json_object(json, NULL);
  cli_json_texts(json, NULL, {"name", command->name}, {"summary", command->summary}, {"usage", command->usage},
                 {"description", command->description});
  cli_json_array(json, "options");
  for (int i = 0; cli_help_next(table, &i, &entry);) {
    group = entry.group ? entry.group : group;
    write_option(json, group, &entry);
  }
  cli_json_close(json);
  cli_json_array(json, "old_spellings");
  for (int i = 0; i < table->n_own; i++)
    if (table->own[i].now) {
      cli_json_object(json, NULL);
      write_name(json, "name", &table->own[i]);
      cli_json_text(json, "now", table->own[i].now);
      cli_json_close(json);
    }
  cli_json_close(json);
  cli_json_array(json, "examples");
  for (int i = 0; i < 4 && command->examples[i].command; i++)
    cli_json_text(json, NULL, command->examples[i].command);
  cli_json_close(json);
  cli_json_close(json);
}
