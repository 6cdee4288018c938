/* The result of a suite: a table for people, JSON for scripts, JUnit's XML for CI systems. */

#include "cli/commands/gaussian_commands.h"
#include "cli/judge/suite_judge.h"
#include "cli/judge/suite_planes.h"
#include "cli/judge/suite_scenes.h"
#include "core/files/file.h"

enum { SUITE_PRINTED = 12 };

/* Of a level; 0: of all. */
static size_t count_cases(const suite_run *run, int level, suite_outcome outcome) {
  size_t n = 0;
  for (size_t i = 0; i < run->n; i++)
    n += (level == 0 || run->verdicts[i].entry->level == level) && run->verdicts[i].outcome == outcome;
  return n;
}

int cli_suite_is_right(const suite_run *run) {
  return count_cases(run, 0, SUITE_IS_RIGHT) == run->n;
}

static int highest_level(const suite_run *run) {
  int level = 0;
  for (size_t i = 0; i < run->n; i++)
    level = run->verdicts[i].entry->level > level ? run->verdicts[i].entry->level : level;
  return level;
}

static size_t count_of_level(const suite_run *run, int level) {
  size_t n = 0;
  for (int outcome = 0; outcome < SUITE_OUTCOMES; outcome++)
    n += count_cases(run, level, (suite_outcome)outcome);
  return n;
}

/* What a level tests; unknown for suites with more levels. */
static const char *about_level(int level) {
  return level <= SUITE_LEVELS ? cli_suite_level_about(level) : "";
}

/* The level's case with the largest share of wrong pixels; null where no pixel is wrong. */
static const suite_verdict *worst_of_level(const suite_run *run, int level) {
  const suite_verdict *worst = NULL;
  double most = -1.0;
  for (size_t i = 0; i < run->n; i++) {
    const suite_verdict *v = &run->verdicts[i];
    double share = (double)v->pixels[CONIC_PIXEL_WRONG] / ((double)v->entry->width * (double)v->entry->height);
    if (v->entry->level == level && v->outcome == SUITE_IS_WRONG && share > most) {
      most = share;
      worst = v;
    }
  }
  return worst;
}

static void print_levels(const suite_run *run) {
  printf("level  cases  right  wrong  missing  worst\n");
  for (int level = 1; level <= highest_level(run); level++) {
    const suite_verdict *worst = worst_of_level(run, level);
    if (count_of_level(run, level) == 0)
      continue;
    printf("%5d %6zu %6zu %6zu %8zu  %s\n", level, count_of_level(run, level), count_cases(run, level, SUITE_IS_RIGHT),
           count_cases(run, level, SUITE_IS_WRONG), count_cases(run, level, SUITE_IS_MISSING),
           worst ? worst->entry->name : "-");
  }
}

/* The first cases with an outcome, and how many more there are. */
static void print_cases(const suite_run *run, suite_outcome outcome) {
  size_t n = 0;
  for (size_t i = 0; i < run->n; i++) {
    const suite_verdict *v = &run->verdicts[i];
    if (v->outcome != outcome || n++ >= SUITE_PRINTED)
      continue;
    printf("%-8s %s%s%s\n", cli_suite_outcome_names[outcome], v->entry->name, outcome == SUITE_IS_WRONG ? ": " : "",
           outcome == SUITE_IS_WRONG ? v->message : "");
  }
  if (n > SUITE_PRINTED)
    printf("         and %zu more\n", n - SUITE_PRINTED);
}

/* How to continue from the simplest wrong case. */
static void print_advice(const suite_run *run) {
  for (size_t i = 0; i < run->n; i++) {
    const suite_verdict *v = &run->verdicts[i];
    if (v->outcome != SUITE_IS_WRONG || !v->pixels[CONIC_PIXEL_WRONG])
      continue;
    const suite_entry *e = v->entry;
    int is_surface = strcmp(e->profile, cli_suite_profile_name(SUITE_SURFACE)) == 0;
    printf("to see why: conic judge %s/%s --camera %s/%s %s %s --picture %s/%s.%s\n", run->judging.suite, e->ply,
           run->judging.suite, e->camera, is_surface ? "--plain --method" : "--profile",
           is_surface ? "conic" : e->profile, run->judging.pictures, e->name, v->ending);
    return;
  }
}

void cli_suite_print(const suite_run *run) {
  print_levels(run);
  print_cases(run, SUITE_IS_WRONG);
  print_cases(run, SUITE_IS_MISSING);
  if (count_cases(run, 0, SUITE_IS_MISSING) && !run->is_profile_given)
    printf("to judge only the profiles that you draw: --profile NAME[,NAME]\n");
  print_advice(run);
  printf("%s: %zu of %zu cases\n", cli_suite_is_right(run) ? "right" : "WRONG", count_cases(run, 0, SUITE_IS_RIGHT),
         run->n);
}

/* --- JSON --- */

static void report_outcomes(cli_json *json, const suite_run *run, int level) {
  cli_json_count(json, "cases", count_of_level(run, level));
  for (int outcome = 0; outcome < SUITE_OUTCOMES; outcome++)
    cli_json_count(json, cli_suite_outcome_names[outcome], count_cases(run, level, (suite_outcome)outcome));
}

static void report_case(cli_json *json, const suite_verdict *v) {
  cli_json_object(json, NULL);
  cli_json_text(json, "name", v->entry->name);
  cli_json_count(json, "level", (uint64_t)v->entry->level);
  cli_json_texts(json, NULL, {"scene", v->entry->scene}, {"profile", v->entry->profile},
                 {"outcome", cli_suite_outcome_names[v->outcome]});
  cli_json_object(json, "pixels");
  for (int k = 0; k < CONIC_N_PIXEL_CLASSES; k++)
    cli_json_count(json, cli_class_words[k], v->pixels[k]);
  cli_json_close(json);
  if (v->pixels[CONIC_PIXEL_WRONG]) {
    cli_json_object(json, "worst");
    cli_json_counts(json, NULL, {"x", (uint64_t)v->x}, {"y", (uint64_t)v->y});
    cli_json_text(json, "channel", cli_suite_channel_names[v->channel]);
    cli_json_figures(json, NULL, {"found", v->found}, {"low", v->low}, {"high", v->high});
    cli_json_close(json);
  }
  cli_json_text(json, "message", v->message[0] ? v->message : NULL);
  cli_json_close(json);
}

void cli_suite_members(cli_json *json, const void *cookie) {
  const suite_run *run = cookie;
  cli_json_texts(json, NULL, {"verdict", cli_suite_is_right(run) ? "right" : "wrong"}, {"suite", run->judging.suite},
                 {"floats", run->manifest.floats});
  cli_json_object(json, "total");
  report_outcomes(json, run, 0);
  cli_json_close(json);
  cli_json_array(json, "levels");
  for (int level = 1; level <= highest_level(run); level++) {
    cli_json_object(json, NULL);
    cli_json_count(json, "level", (uint64_t)level);
    cli_json_text(json, "about", about_level(level));
    report_outcomes(json, run, level);
    cli_json_close(json);
  }
  cli_json_close(json);
  cli_json_array(json, "cases");
  for (size_t i = 0; i < run->n; i++)
    report_case(json, &run->verdicts[i]);
  cli_json_close(json);
  cli_json_count(json, "extra_pictures", run->n_extra);
}

/* --- JUnit --- */

/* Names are plain words, and messages are ours; but a folder's name may hold anything. */
static void put_xml_text(FILE *to, const char *text) {
  for (const char *c = text; *c; c++)
    if (strchr("<>&\"", *c))
      fprintf(to, "&#%d;", *c);
    else
      fputc((unsigned char)*c < 0x20 ? '?' : *c, to);
}

static void put_xml_case(FILE *to, const suite_verdict *v) {
  fprintf(to, "    <testcase classname=\"conic.%s\" name=\"%s\" time=\"%.6f\"", v->entry->profile, v->entry->name,
          v->seconds);
  if (v->outcome == SUITE_IS_RIGHT) {
    fputs("/>\n", to);
    return;
  }
  fprintf(to, ">\n      <failure type=\"%s\" message=\"", cli_suite_outcome_names[v->outcome]);
  put_xml_text(to, v->message);
  fputs("\"/>\n    </testcase>\n", to);
}

static void put_xml_level(FILE *to, const suite_run *run, int level) {
  size_t n = count_of_level(run, level);
  if (n == 0)
    return;
  fprintf(to, "  <testsuite name=\"level %d: %s\" tests=\"%zu\" failures=\"%zu\" errors=\"0\" skipped=\"0\">\n", level,
          about_level(level), n, n - count_cases(run, level, SUITE_IS_RIGHT));
  for (size_t i = 0; i < run->n; i++)
    if (run->verdicts[i].entry->level == level)
      put_xml_case(to, &run->verdicts[i]);
  fputs("  </testsuite>\n", to);
}

conic_status cli_suite_write_junit(const suite_run *run) {
  conic_output *output;
  conic_status status = conic_output_open(run->session->context, run->junit_path, &output);
  if (status != CONIC_OK)
    return status;
  FILE *to = conic_output_stream(output);
  fprintf(to,
          "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
          "<testsuites name=\"conic-conformance\" tests=\"%zu\" failures=\"%zu\" errors=\"0\">\n",
          run->n, run->n - count_cases(run, 0, SUITE_IS_RIGHT));
  for (int level = 1; level <= highest_level(run); level++)
    put_xml_level(to, run, level);
  fputs("</testsuites>\n", to);
  return conic_output_commit(output);
}
