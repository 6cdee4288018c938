#include "cli/render/accumulate_team.h"

#include <stdlib.h>

#include "accumulation/scattered.h"
#include "cli/render/sharing.h"
#include "cli/session_team.h"

enum { LEAST_SAMPLES = 16, UNITS_EACH = 4 };

typedef struct together {
  cli_session *session;
  cli_team *team;
  cli_render_job *job;
  const conic_accumulate_options *options;
  cli_sums_keeper *keep;
  conic_accumulation *sums;
} together;

/* Where the sums come together next: at the end or, where it matters in between, at a power of two. */
static uint64_t stage_end(const together *t, uint64_t begin) {
  uint64_t end = LEAST_SAMPLES;
  while (end <= begin)
    end *= 2;
  return (t->options->noise > 0.0 || t->keep) && end < t->options->end_sample ? end : t->options->end_sample;
}

/* Of the samples from `begin` to before `end` those that this process is given. */
static conic_status add_given(const together *t, uint64_t begin, uint64_t end) {
  uint64_t count = (uint64_t)t->team->count, each = (end - begin) / (count * UNITS_EACH) + 1, unit;
  conic_status status = CONIC_OK;
  t->team->share((end - begin + each - 1) / each, NULL, NULL);
  while (status == CONIC_OK && (unit = t->team->next()) != CLI_NO_UNIT) {
    double start = cli_seconds();
    uint64_t from = begin + unit * each, to = from + each < end ? from + each : end;
    status = conic_accumulate_range(t->session->context, t->options, from, to, t->sums);
    cli_sharing_note(t->session, t->job, "samples", from, start, 0);
  }
  return status;
}

static void send_sums(const together *t, int to) {
  uint64_t header[CONIC_SCATTERED_HEADER];
  size_t n_bytes;
  double start = cli_seconds();
  const void *bytes = conic_accumulation_bytes(t->sums, header, &n_bytes);
  t->team->send(to, header, sizeof header);
  t->team->send(to, bytes, n_bytes);
  cli_team_trace(t->session, "join", "send", (uint64_t)to, start, n_bytes);
  conic_accumulation_clear(t->sums);
}

static conic_status take_sums(const together *t, int from) {
  size_t n_header, n_bytes;
  double start = cli_seconds();
  uint64_t *header = t->team->receive(from, &n_header);
  void *bytes = t->team->receive(from, &n_bytes);
  conic_status status = conic_accumulation_join(t->sums, header, bytes, n_bytes);
  free(header);
  free(bytes);
  cli_team_trace(t->session, "join", "sums", (uint64_t)from, start, 0);
  return status;
}

/* Two by two, so that it takes the logarithm of their number. */
static conic_status join_all_sums(const together *t) {
  int index = t->team->index, count = t->team->count;
  conic_status status = CONIC_OK;
  for (int step = 1; step < count; step *= 2) {
    if (index % (2 * step) == step) {
      send_sums(t, index - step);
      break;
    }
    if (index + step < count) {
      conic_status taken = take_sums(t, index + step);
      status = status == CONIC_OK ? taken : status;
    }
  }
  if (index == 0)
    conic_accumulation_joined(t->sums, 0);
  return status;
}

static conic_status run_stage(const together *t, uint64_t begin) {
  conic_status status = cli_sharing_end(t->session, t->job, add_given(t, begin, stage_end(t, begin)));
  if (status == CONIC_OK)
    status = join_all_sums(t);
  if (status == CONIC_OK && t->keep && t->team->index == 0)
    status = t->keep(t->options->cookie, t->sums);
  return cli_sharing_end(t->session, t->job, status);
}

conic_status cli_accumulate_together(cli_session *session, cli_render_job *job, const conic_accumulate_options *options,
                                     cli_sums_keeper *keep, conic_accumulation *sums) {
  together t = {session, session->team, job, options, keep, sums};
  struct {
    uint64_t begin, is_enough;
  } next = {0, 0};
  conic_accumulation_facts facts;
  conic_accumulation_inspect(sums, &facts);
  conic_status status = facts.end_sample > 0 ? conic_accumulate_check_key(session->context, options, sums) : CONIC_OK;
  status = cli_sharing_end(session, job, status);
  while (status == CONIC_OK) {
    conic_accumulation_inspect(sums, &facts);
    next.begin = facts.end_sample;
    next.is_enough = (uint64_t)conic_accumulate_is_enough(options, sums);
    t.team->broadcast(&next, sizeof next);
    if (next.is_enough)
      break;
    status = run_stage(&t, next.begin);
  }
  return status;
}
