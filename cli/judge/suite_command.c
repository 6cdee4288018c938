/* conic judge --suite: judges the pictures of a whole suite. */

#include "cli/arguments.h"
#include "cli/judge/suite_files.h"
#include "cli/judge/suite_judge.h"
#include "cli/outputs.h"
#include "core/files/disk.h"

static int is_chosen_case(const suite_run *run, const suite_entry *entry) {
  for (int p = 0; p < SUITE_PROFILES; p++)
    if (strcmp(entry->profile, cli_suite_profile_name(p)) == 0)
      return run->profiles >> p & 1 && entry->level <= run->most_level;
  return !run->is_profile_given && entry->level <= run->most_level;
}

/* Whether a file is named after a case: its picture, or a plane beside it. */
static int is_of_case(const suite_run *run, const char *name) {
  for (size_t i = 0; i < run->manifest.n_cases; i++) {
    size_t n = strlen(run->manifest.cases[i].name);
    if (strncmp(name, run->manifest.cases[i].name, n) == 0 && (name[n] == '.' || name[n] == '\0'))
      return 1;
  }
  return 0;
}

/* A picture that belongs to no case has a mistyped name, or is an old one. */
static void find_extra_pictures(suite_run *run) {
  conic_disk_folder entries;
  conic_disk_open_folder(run->judging.pictures, &entries);
  for (const char *entry; (entry = conic_disk_next_name(&entries));) {
    const char *dot = strrchr(entry, '.');
    if (!dot || !(strcmp(dot, ".exr") == 0 || strcmp(dot, ".pfm") == 0 || strcmp(dot, ".npy") == 0 ||
                  strcmp(dot, ".npz") == 0 || strcmp(dot, ".png") == 0))
      continue;
    if (is_of_case(run, entry))
      continue;
    if (run->n_extra < 3)
      snprintf(run->extra[run->n_extra], sizeof run->extra[0], "%.90s", entry);
    run->n_extra++;
  }
  conic_disk_close_folder(&entries);
}

static void note_extra_pictures(const suite_run *run) {
  if (run->n_extra)
    cli_note(run->session, "%s: no case has the name of %s%s%s%s%s%s", run->judging.pictures, run->extra[0],
             run->n_extra > 1 ? ", " : "", run->extra[1], run->n_extra > 2 ? ", " : "", run->extra[2],
             run->n_extra > 3 ? ", …" : "");
}

static conic_status judge_cases(suite_run *run) {
  conic_context *context = run->session->context;
  char path[4096];
  conic_status status = cli_suite_join(context, run->judging.suite, "manifest.json", path, sizeof path);
  if (status == CONIC_OK)
    status = cli_suite_read_manifest(context, path, &run->manifest);
  if (status != CONIC_OK)
    return status;
  run->verdicts = conic_memory_allocate_zeroed(context, run->manifest.n_cases, sizeof *run->verdicts);
  if (!run->verdicts)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; status == CONIC_OK && i < run->manifest.n_cases; i++)
    if (is_chosen_case(run, &run->manifest.cases[i]))
      status = cli_suite_judge_case(context, &run->judging, &run->manifest.cases[i], &run->verdicts[run->n++]);
  if (status == CONIC_OK && run->n == 0) {
    cli_error(CLI_INPUT, "%s: the suite has no case of these profiles and levels", run->judging.suite);
    status = CONIC_ERROR_INPUT;
  }
  size_t n_missing = 0;
  for (size_t i = 0; status == CONIC_OK && i < run->n; i++)
    n_missing += run->verdicts[i].outcome == SUITE_IS_MISSING;
  if (status == CONIC_OK && n_missing == run->n) {
    cli_error(CLI_INPUT, "%s: nothing to judge: no case has its picture there", run->judging.pictures);
    status = CONIC_ERROR_INPUT;
  }
  return status;
}

static int tell_suite_run(suite_run *run) {
  int exit_code = cli_json_write(run->session, cli_suite_members, run);
  if (exit_code == CLI_DONE && run->junit_path)
    exit_code = cli_exit_of(cli_suite_write_junit(run));
  if (exit_code != CLI_DONE)
    return exit_code;
  if (cli_json_leaves_text(run->session) && !(run->junit_path && strcmp(run->junit_path, "-") == 0))
    cli_suite_print(run);
  note_extra_pictures(run);
  return cli_suite_is_right(run) ? CLI_DONE : CLI_DIFFERENT;
}

static int judge_suite(suite_run *run) {
  conic_disk_folder pictures;
  if (!conic_disk_open_folder(run->judging.pictures, &pictures))
    return cli_error(CLI_INPUT, "%s: cannot be read: %s", run->judging.pictures, strerror(errno));
  conic_disk_close_folder(&pictures);
  int exit_code = cli_session_open(run->session);
  if (exit_code != CLI_DONE)
    return exit_code;
  conic_status status = judge_cases(run);
  if (status == CONIC_OK)
    find_extra_pictures(run);
  exit_code = status == CONIC_OK ? tell_suite_run(run) : cli_exit_of(status);
  conic_memory_release(run->session->context, run->verdicts);
  cli_suite_release_manifest(run->session->context, &run->manifest);
  return exit_code;
}

int cli_suite_run(cli_session *session, int argc, char **argv) {
  static const char *const roundings[] = {"either", "nearest", "down", NULL};
  suite_run run = {.session = session, .most_level = 99};
  const char *positional[argc], *profiles = NULL;
  int n_positional, rounding = CONIC_CODES_EITHER;
  conic_picture_options_init(&run.judging.reading);
  const cli_option options[] = {
      CLI_SUITE_OPTIONS(run),
      {"profile", CLI_TEXT, &profiles, "NAMES", "only the cases of these profiles, with commas between [all]",
       .is_given = &run.is_profile_given},
      {"max-wrong", CLI_COUNT, &run.judging.max_wrong, "N", "so many pixels of a case may be wrong [0]", 0,
       4294836225.0},
      {"codes", CLI_CHOICE, &rounding, "HOW", "codes were rounded to the nearest, down, or either [either]",
       .choices = roundings},
      {"clipped", CLI_FLAG, &run.judging.reading.is_clipped, NULL,
       "colours of 0 and 1 stand for what is beyond, in floats, too"},
      {"straight", CLI_FLAG, &run.judging.reading.is_straight, NULL,
       "colours are not multiplied by alpha; of a PNG they never are"},
  };
  int exit_code = cli_parse(session, options, sizeof options / sizeof *options, argc, argv, positional, &n_positional);
  run.judging.reading.rounding = (conic_code_rounding)rounding;
  if (exit_code == CLI_DONE && n_positional)
    exit_code = cli_usage("judge: %s: with --suite, the scenes are the suite's", positional[0]);
  if (exit_code == CLI_DONE && !run.judging.pictures)
    exit_code = cli_usage("judge: no pictures; give --pictures FOLDER");
  if (exit_code == CLI_DONE && !(run.profiles = cli_suite_find_profiles("judge", profiles)))
    exit_code = CLI_USAGE;
  if (exit_code == CLI_DONE)
    exit_code = cli_check_outputs(session, &run.junit_path, 1);
  if (exit_code == CLI_DONE)
    exit_code = judge_suite(&run);
  return exit_code < 0 ? CLI_DONE : exit_code;
}
