#include "bench/rank_schedule.h"

#include <string.h>

#include "cli/session_team.h"
#include "core/base/memory.h"

/* What rank 0 takes to answer who wants a unit. */
static const double answer_s = 1e-6;

/* A rank that has done a unit. */
typedef struct rank_turn {
  double at;       /* when */
  double taken_s;  /* and when rank 0 will have taken the result of the one before */
  int is_first;    /* it is rank 0, */
  double joined_s; /* which has been held up by so much of what its thread has worked */
  uint64_t unit;   /* all ones: none, a first one is wanted */
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
  double all_bytes;                  /* of the trace's units */
  double answers_free, results_free; /* when rank 0 can answer the next one, and take the next result */
  double joined_s;                   /* what rank 0's thread has worked */
  double waited_s, done_s;           /* of all ranks: for rank 0; and when they are done */
  double last_s;
} rank_run;

static double later(double a, double b) {
  return a > b ? a : b;
}

/* Rank 0 takes the result, which then joins the others, after those that came before. Returns how long that takes. */
static double take_result(rank_run *run, rank_turn *turn) {
  const cli_rank_trace *trace = run->trace;
  double bytes = trace->units[turn->unit % trace->n_units].bytes;
  double part = run->all_bytes > 0.0 ? bytes / run->all_bytes : 1.0 / (double)trace->n_units;
  double lasts = trace->join_s * part + (turn->is_first ? 0.0 : bytes / run->line->bytes_per_s);
  turn->taken_s = later(turn->at + run->line->latency_s, run->results_free) + lasts;
  run->results_free = turn->taken_s;
  run->joined_s += lasts;
  return lasts;
}

/* Rank 0 answers who wants a unit once it is done with the message at hand: before it takes other results. Returns when
 * the answer is there. */
static double serve_turn(rank_run *run, rank_turn *turn) {
  double arrived = turn->at + run->line->latency_s, at_hand = run->results_free - arrived;
  double lasts = turn->unit == no_unit ? 0.0 : take_result(run, turn);
  if (at_hand > 0.0)
    arrived += at_hand < lasts ? at_hand : lasts;
  run->answers_free = later(arrived, run->answers_free) + answer_s;
  double answered = run->answers_free + run->line->latency_s;
  run->waited_s += answered - turn->at;
  return answered;
}

/* A rank whose result before waits to be taken goes no further, and rank 0 has been held up by what its thread worked
 * meanwhile. Returns for how long; 0: it is done. */
static double hold_up(rank_run *run, rank_turn *turn) {
  double begun = turn->at, joined_s = run->joined_s - turn->joined_s;
  turn->joined_s = run->joined_s;
  turn->at = turn->is_first ? begun + joined_s : later(begun, turn->taken_s);
  run->waited_s += turn->at - begun;
  return turn->at - begun;
}

static int is_left_to_others(const rank_run *run, const rank_turn *turn) {
  int hands_over = run->all_bytes > 0.0 || run->trace->join_s > 0.0;
  return turn->is_first && hands_over &&
         cli_team_leaves_rest((double)(run->n_units - run->next), (int)run->n_ranks, run->joined_s, turn->at);
}

static void run_units(rank_run *run) {
  size_t n = run->n_ranks;
  while (n > 0) {
    rank_turn *first = &run->turns[0];
    if (hold_up(run, first) > 0.0) {
      sink_turn(run->turns, n);
      continue;
    }
    double answered = serve_turn(run, first);
    if (run->next < run->n_units && !is_left_to_others(run, first)) {
      first->unit = run->next++;
      first->at = answered + run->trace->units[first->unit % run->trace->n_units].seconds;
    } else {
      run->done_s += answered;
      run->last_s = later(run->last_s, later(answered, first->taken_s));
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
    run.turns[i] = (rank_turn){.unit = no_unit, .is_first = i == 0};
  for (size_t i = 0; i < trace->n_units; i++)
    run.all_bytes += trace->units[i].bytes;
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
