#include "bench/rank_schedule.h"

#include <string.h>

#include "core/base/memory.h"

/* What rank 0 takes to answer who wants a unit. */
static const double answer_s = 1e-6;

/* A rank's next message to rank 0, and when it leaves. */
typedef struct rank_turn {
  double at;
  uint64_t unit; /* that is done, and whose result is handed over; all ones: none, a first one is wanted */
} rank_turn;

static const uint64_t no_unit = UINT64_MAX;

/* A heap of turns, the first at the top: puts the top where it belongs. */
static void sink_turn(rank_turn *heap, size_t n) {
  for (size_t i = 0, child; (child = 2 * i + 1) < n; i = child) {
    child += child + 1 < n && heap[child + 1].at < heap[child].at;
    if (heap[i].at <= heap[child].at)
      return;
    rank_turn above = heap[i];
    heap[i] = heap[child];
    heap[child] = above;
  }
}

typedef struct rank_run {
  const cli_rank_trace *trace;
  const cli_rank_line *line;
  rank_turn *turns;
  size_t n_ranks;
  uint64_t n_units, next;
  double first_free;       /* when rank 0's thread is */
  double waited_s, done_s; /* of all ranks: for rank 0; and when they are done */
  double last_s;
} rank_run;

/* Rank 0 takes a result, which then joins the others, and answers. Returns when the answer is there. */
static double serve_turn(rank_run *run, const rank_turn *turn) {
  double arrived = turn->at + run->line->latency_s, begun = arrived > run->first_free ? arrived : run->first_free;
  double received = begun;
  run->first_free = begun;
  if (turn->unit != no_unit) {
    const cli_rank_unit *unit = &run->trace->units[turn->unit % run->trace->n_units];
    received += unit->bytes / run->line->bytes_per_s;
    run->first_free = received + run->trace->join_s / (double)run->trace->n_units;
  }
  run->first_free += answer_s;
  double answered = run->first_free + run->line->latency_s;
  run->waited_s += answered - turn->at;
  return answered;
}

static void run_units(rank_run *run) {
  size_t n = run->n_ranks;
  while (n > 0) {
    rank_turn *first = &run->turns[0];
    double answered = serve_turn(run, first);
    if (run->next < run->n_units) {
      first->unit = run->next++;
      first->at = answered + run->trace->units[first->unit % run->trace->n_units].seconds;
    } else {
      run->done_s += answered;
      run->last_s = answered > run->last_s ? answered : run->last_s;
      *first = run->turns[--n];
    }
    sink_turn(run->turns, n);
  }
}

/* Ranks swap parts of their sums, both ways at a time, so that each has one part of all; these go to rank 0. A message
 * is its length and its bytes. */
static double merging_s(const cli_rank_trace *trace, const cli_rank_line *line, int n_ranks) {
  double others = n_ranks - 1.0, share = others / n_ranks;
  return trace->n_merges *
         (4.0 * others * line->latency_s + share * (2.0 * trace->merge_bytes / line->bytes_per_s + trace->merge_s));
}

conic_status cli_rank_schedule(conic_context *context, const cli_rank_trace *trace, const cli_rank_line *line,
                               int n_ranks, uint64_t times, cli_rank_estimate *estimate) {
  rank_run run = {
      .trace = trace, .line = line, .n_ranks = (size_t)n_ranks, .n_units = trace->n_units * times, .last_s = 0.0};
  double work_s = 0.0, loops_s = trace->loops.seconds * (double)times; /* light that a picture's windows then get */
  memset(estimate, 0, sizeof *estimate);
  if (trace->job != CLI_RANK_UNITS) {
    (trace->job == CLI_RANK_LAYERS ? cli_rank_build : cli_rank_loops)(trace, line, n_ranks, times, estimate);
    return CONIC_OK;
  }
  run.turns = conic_memory_allocate(context, run.n_ranks, sizeof *run.turns);
  if (!run.turns)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < run.n_ranks; i++)
    run.turns[i] = (rank_turn){0.0, no_unit};
  run_units(&run);
  conic_memory_release(context, run.turns);
  for (size_t i = 0; i < trace->n_units; i++)
    work_s += trace->units[i].seconds * (double)times;
  estimate->n_ranks = n_ranks;
  estimate->lost_s[CLI_RANK_OPEN] = trace->open_s;
  estimate->lost_s[CLI_RANK_FIRST] = run.waited_s / n_ranks;
  estimate->lost_s[CLI_RANK_UNEVEN] = run.last_s - run.done_s / n_ranks;
  estimate->lost_s[CLI_RANK_MERGE] =
      merging_s(trace, line, n_ranks) + cli_rank_loops_merge(trace, line, n_ranks, times);
  /* More samples are no larger picture. */
  double write_s = trace->n_merges > 0.0 ? trace->write_s : trace->write_s * (double)times;
  estimate->lost_s[CLI_RANK_WRITE] = write_s;
  estimate->seconds = trace->open_s + run.last_s + loops_s / n_ranks + estimate->lost_s[CLI_RANK_MERGE] + write_s;
  double alone_s = trace->open_s + work_s + loops_s + trace->join_s * (double)times + write_s;
  estimate->efficiency = alone_s / (n_ranks * estimate->seconds);
  return CONIC_OK;
}
