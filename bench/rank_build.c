/* Building on more ranks. */
#include <math.h>

#include "bench/rank_schedule.h"

/* What the builder does (lod/layers/build), in its numbers: bytes of the samples on their way that a rank with 1 GiB
 * has room for; parts of a share, and of what is known of the samples when the shares are made; nodes that are told of
 * at a time, and what they are on their way; and what each rank has counted of outlines. */
static const double parcels_bytes = 128.0 * 1048576.0, most_in_parcel = 65536.0, parts_a_rank = 16.0,
                    cells_a_rank = 64.0, most_cells = 8192.0, nodes_at_once = 256.0, node_bytes = 64.0,
                    outlines_bytes = 524288.0;

/* What rank 0 takes to receive a small message. */
static const double small_s = 1e-6;

/* By how much the largest share is larger than the mean: a part at most, or, where there are few cells a rank, as
 * chance has it. */
static double unevenness(double n_ranks) {
  double cells = most_cells / n_ranks;
  double by_parts = 1.0 / parts_a_rank, by_chance = cells < cells_a_rank ? log(n_ranks) / cells : 0.0;
  return n_ranks < 2.0 ? 0.0 : by_chance > by_parts ? by_chance : by_parts;
}

/* Everybody sends what is not its own, and meets everybody whenever a parcel is full. */
static double exchange_s(const cli_rank_trace *trace, const cli_rank_line *line, double n_ranks, double times) {
  const cli_rank_stage_sum *sum = &trace->stages[CLI_STAGE_EXCHANGE];
  double n_samples = sum->number * times, sent_here = 1.0 - 1.0 / (double)trace->n_ranks;
  double sample_bytes = sum->number > 0.0 && sent_here > 0.0 ? sum->bytes / (sum->number * sent_here) : 16.0;
  double room = parcels_bytes / (n_ranks * sample_bytes);
  room = room < most_in_parcel ? room : most_in_parcel;
  double meetings = n_samples / n_ranks / room + 1.0;
  return n_samples / n_ranks * sample_bytes * (1.0 - 1.0 / n_ranks) / line->bytes_per_s +
         meetings * n_ranks * 4.0 * line->latency_s;
}

/* Branches are joined pair by pair, and rank 0 gets the list of all nodes and everybody's counts. */
static double crown_s(const cli_rank_trace *trace, const cli_rank_line *line, double n_ranks, double n_nodes) {
  const cli_rank_stage_sum *sum = &trace->stages[CLI_STAGE_CROWN];
  double n_joins = sum->number / (double)trace->n_ranks - 1.0, rounds = ceil(log2(n_ranks)) + 1.0;
  n_joins = n_joins > 1.0 ? n_joins : 1.0;
  double branch_bytes = sum->bytes / n_joins;
  return rounds * (sum->seconds / n_joins + branch_bytes / line->bytes_per_s + 2.0 * line->latency_s) +
         (n_nodes * node_bytes + n_ranks * outlines_bytes) / line->bytes_per_s + n_ranks * 4.0 * line->latency_s;
}

/* Everybody says something small, and rank 0 something to all. */
static double round_s(const cli_rank_line *line, double n_ranks) {
  return n_ranks * small_s + (2.0 + 2.0 * ceil(log2(n_ranks))) * line->latency_s;
}

/* Everybody writes its own clouds in place, of some at a time, which rank 0 tells all. */
static double telling_s(const cli_rank_line *line, double n_ranks, double n_nodes) {
  return (n_nodes / nodes_at_once + 2.0) * round_s(line, n_ranks);
}

void cli_rank_build(const cli_rank_trace *trace, const cli_rank_line *line, int n_ranks, uint64_t times,
                    cli_rank_estimate *estimate) {
  const cli_rank_stage_sum *s = trace->stages;
  double n = (double)n_ranks, factor = (double)times, n_nodes = s[CLI_STAGE_ORDER].number * factor;
  int is_together = n_ranks > 1;
  double alone_s = 0.0, shared_s = 0.0;
  for (int i = 0; i < CLI_STAGE_CROWN; i++)
    if (i != CLI_STAGE_SHARE && i != CLI_STAGE_EXCHANGE)
      alone_s += s[i].seconds * factor;
    else
      shared_s += is_together ? s[i].seconds * factor : 0.0;
  double write_s = s[CLI_STAGE_WRITE].seconds * factor, order_s = s[CLI_STAGE_ORDER].seconds * factor;
  double grow_s = (s[CLI_STAGE_SORT].seconds + s[CLI_STAGE_GROW].seconds) * factor;
  alone_s += write_s;
  shared_s += alone_s;
  *estimate = (cli_rank_estimate){.n_ranks = n_ranks};
  estimate->lost_s[CLI_RANK_OPEN] = trace->open_s;
  estimate->lost_s[CLI_RANK_UNEVEN] = unevenness(n) * grow_s / n;
  estimate->lost_s[CLI_RANK_FIRST] = order_s;
  if (is_together) {
    estimate->lost_s[CLI_RANK_MERGE] = exchange_s(trace, line, n, factor) + crown_s(trace, line, n, n_nodes);
    estimate->lost_s[CLI_RANK_WRITE] = telling_s(line, n, n_nodes);
  }
  estimate->seconds = shared_s / n;
  for (int i = 0; i < CLI_RANK_N_LOSSES; i++)
    estimate->seconds += estimate->lost_s[i];
  estimate->efficiency = (trace->open_s + alone_s + order_s) / (n * estimate->seconds);
}

double cli_rank_loops_merge(const cli_rank_trace *trace, const cli_rank_line *line, int n_ranks, uint64_t times) {
  double here = (double)trace->n_ranks, n_loops = trace->loops.number / here, others = 1.0 - 1.0 / (double)n_ranks;
  if (n_ranks < 2)
    return 0.0;
  /* Rank 0 gets what the others made, and sends all of it once: so the trace counts. */
  double bytes = trace->loops.bytes * (double)times / (2.0 - 1.0 / here);
  return (others + 1.0) * bytes / line->bytes_per_s + n_loops * round_s(line, (double)n_ranks);
}

void cli_rank_loops(const cli_rank_trace *trace, const cli_rank_line *line, int n_ranks, uint64_t times,
                    cli_rank_estimate *estimate) {
  double n = (double)n_ranks, shared_s = trace->loops.seconds * (double)times, alone_s = trace->alone_s * (double)times;
  *estimate = (cli_rank_estimate){.n_ranks = n_ranks};
  estimate->lost_s[CLI_RANK_OPEN] = alone_s;
  estimate->lost_s[CLI_RANK_MERGE] = cli_rank_loops_merge(trace, line, n_ranks, times);
  estimate->seconds = alone_s + shared_s / n + estimate->lost_s[CLI_RANK_MERGE];
  estimate->efficiency = (alone_s + shared_s) / (n * estimate->seconds);
}
