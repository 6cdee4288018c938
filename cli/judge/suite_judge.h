/* conic judge --suite: compares pictures of a suite's cases with the suite's bounds. */
#pragma once

#include "cli/json_write.h"
#include "cli/judge/suite_manifest.h"
#include "cli/session.h"

typedef enum suite_outcome { SUITE_IS_RIGHT, SUITE_IS_WRONG, SUITE_IS_MISSING, SUITE_OUTCOMES } suite_outcome;

/* "right", "wrong", "missing". */
extern const char *const cli_suite_outcome_names[SUITE_OUTCOMES];

typedef struct suite_verdict {
  const suite_entry *entry;
  suite_outcome outcome;
  const char *ending;                   /* of the picture's name; null: there is no picture */
  size_t pixels[CONIC_N_PIXEL_CLASSES]; /* all 0 if it could not be judged */
  int x, y, channel;                    /* the value that is farthest off, if pixels are wrong; channel: SUITE_… */
  double found, low, high;
  char message[192]; /* the fault; empty if there is none */
  double seconds;
} suite_verdict;

typedef struct suite_judging {
  const char *suite, *pictures; /* folders */
  unsigned long long max_wrong; /* wrong pixels that a case may have */
  conic_picture_options reading;
} suite_judging;

/* Judges the picture of a case. Faults of the picture go into the verdict. Errors: INPUT (the suite's own file),
 * MEMORY, CANCELLED. */
conic_status cli_suite_judge_case(conic_context *context, const suite_judging *judging, const suite_entry *entry,
                                  suite_verdict *verdict);

/* The result of a run. */
typedef struct suite_run {
  cli_session *session;
  suite_judging judging;
  const char *junit_path; /* null: none */
  int most_level;
  unsigned profiles; /* as bits */
  int is_profile_given;
  suite_manifest manifest;
  suite_verdict *verdicts; /* of the chosen cases, in the manifest's order */
  size_t n;
  size_t n_extra; /* pictures that belong to no case */
  char extra[3][SUITE_NAME_ROOM];
} suite_run;

int cli_suite_is_right(const suite_run *run);

/* The table, and what --json says, of a suite_run. */
void cli_suite_print(const suite_run *run);
void cli_suite_members(cli_json *json, const void *cookie);
/* JUnit's XML, as CI systems take it. Errors: as conic_output_open and _end. */
conic_status cli_suite_write_junit(const suite_run *run);

/* The options that only suites have, into a suite_run. */
#define CLI_SUITE_OPTIONS(run)                                                                                         \
  {"suite", CLI_TEXT, &(run).judging.suite, "FOLDER", "judge what conic conformance wrote, in the place of a scene"},  \
      {"pictures",                                                                                                     \
       CLI_TEXT,                                                                                                       \
       &(run).judging.pictures,                                                                                        \
       "FOLDER",                                                                                                       \
       "of a suite: where CASE.exr, .pfm, .npy, .npz or .png are, planes beside them",                                 \
       .acts.with = "suite"},                                                                                          \
      {"level", CLI_INT, &(run).most_level,   "N", "of a suite: only cases up to this level [all]",                    \
       1,       99,      .acts.with = "suite"},                                                                        \
  {                                                                                                                    \
    "junit", CLI_TEXT, &(run).junit_path, "FILE", "of a suite: the cases as JUnit's XML, as CI systems take it",       \
        .acts.with = "suite"                                                                                           \
  }

/* The command, where --suite is among its arguments; returns the exit code. */
int cli_suite_run(cli_session *session, int argc, char **argv);
