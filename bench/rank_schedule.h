/* What a job of conic-mpi would take on other numbers of ranks, by a trace of it (docs/notes/mpi.md). */
#ifndef CONIC_RANK_SCHEDULE_H
#define CONIC_RANK_SCHEDULE_H

#include <stddef.h>
#include <stdint.h>

#include "conic/context.h"

/* A unit of work: how long it took, what its result was on the way to rank 0, and when it was begun. */
typedef struct cli_rank_unit {
  double seconds, bytes, begin_s;
} cli_rank_unit;

/* What a rank did at a time. */
typedef enum cli_rank_kind {
  CLI_RANK_BUILDS, /* from its beginning to its end, around what follows */
  CLI_RANK_SHARES, /* a stage, */
  CLI_RANK_WAITS,  /* and what of it is waiting for others */
  CLI_RANK_OPENS,
  CLI_RANK_DRAWS,
  CLI_RANK_JOINS,
  CLI_RANK_WRITES,
  CLI_RANK_N_KINDS
} cli_rank_kind;

typedef struct cli_rank_event {
  double begin_s, end_s;
  int rank;
  cli_rank_kind kind;
} cli_rank_event;

/* The stages of building a layered cloud together, by what a trace calls them. */
typedef enum cli_rank_stage {
  CLI_STAGE_READ,
  CLI_STAGE_MEASURE,
  CLI_STAGE_SHARE,
  CLI_STAGE_EXCHANGE,
  CLI_STAGE_SORT,
  CLI_STAGE_GROW,
  CLI_STAGE_CROWN,
  CLI_STAGE_ORDER, /* rank 0's alone */
  CLI_STAGE_WRITE,
  CLI_RANK_N_STAGES
} cli_rank_stage;

/* Of all ranks: how long they worked, without waiting, what they sent, and of how much each spoke. */
typedef struct cli_rank_stage_sum {
  double seconds, bytes, number;
} cli_rank_stage_sum;

/* What the ranks do with a job. */
typedef enum cli_rank_job {
  CLI_RANK_UNITS,  /* draw frames, samples or windows */
  CLI_RANK_LAYERS, /* build a layered cloud, by the stages above */
  CLI_RANK_LOOPS   /* all do the same, but for loops that they share */
} cli_rank_job;

/* What a trace says of a job. */
typedef struct cli_rank_trace {
  cli_rank_job job;
  int n_ranks;            /* that it ran on */
  int is_by_processor;    /* times are what its ranks' first threads worked, but `seconds` and `events` */
  double seconds;         /* from its first event to the end of its last */
  double open_s;          /* before its units, on each rank: the mean */
  cli_rank_unit *units;   /* in the order in which they were begun */
  size_t n_units, room;   /* of layers: parts of the inputs, and of loops the ranks' turns, which are no units */
  cli_rank_event *events; /* all of them */
  size_t n_events, events_room;
  double join_s;               /* what rank 0 does with all results of units */
  double merge_s, merge_bytes; /* of one rank's sums: adding all of them to another's, and how long they are */
  double n_merges;             /* how often the sums come together */
  double write_s;              /* after all units */
  double first_event;          /* while it is read */
  cli_rank_stage_sum stages[CLI_RANK_N_STAGES];
  double n_parts;           /* of inputs, that were read */
  cli_rank_stage_sum loops; /* all stages, whatever their names; `number` says how many */
  double whole_s, alone_s;  /* of building, on rank 0: all of it, and without stages */
} cli_rank_trace;

/* Reads what --trace wrote: events of Chrome's format. On success the caller releases it. By the
 * processor's time it is of use where ranks have one thread each. Errors: INPUT, MEMORY. */
conic_status cli_rank_trace_read(conic_context *context, const char *path, int is_by_processor, cli_rank_trace *trace);
void cli_rank_trace_release(conic_context *context, cli_rank_trace *trace);

/* A picture of it: time goes to the right, and each rank has a row. Errors: IO, MEMORY. */
conic_status cli_rank_trace_draw(conic_context *context, const cli_rank_trace *trace, const char *path);

/* The line between ranks. */
typedef struct cli_rank_line {
  double latency_s, bytes_per_s;
} cli_rank_line;

/* Where time is lost, in seconds of the job: */
typedef enum cli_rank_loss {
  CLI_RANK_OPEN,   /* before the units, which more ranks do not make shorter */
  CLI_RANK_FIRST,  /* waiting for rank 0, the mean of the ranks */
  CLI_RANK_UNEVEN, /* until the last unit is done, the mean */
  CLI_RANK_MERGE,  /* bringing sums together */
  CLI_RANK_WRITE,
  CLI_RANK_N_LOSSES
} cli_rank_loss;

typedef struct cli_rank_estimate {
  int n_ranks;
  double seconds, efficiency; /* over one rank's seconds for the same job: 1 is ideal */
  double lost_s[CLI_RANK_N_LOSSES];
} cli_rank_estimate;

enum { CLI_MOST_RANKS = 65536 };

/* The job on 1 to CLI_MOST_RANKS ranks, with its units so many `times`. Units are taken in order, each by the first
 * rank that is free. Rank 0 gives them out and takes results one at a time, beside its own units; and a rank goes on
 * while its last result waits to be taken. Errors: MEMORY. */
conic_status cli_rank_schedule(conic_context *context, const cli_rank_trace *trace, const cli_rank_line *line,
                               int n_ranks, uint64_t times, cli_rank_estimate *estimate);

/* Of loops that all share, on so many ranks: bringing together what they made, in seconds. */
double cli_rank_loops_merge(const cli_rank_trace *trace, const cli_rank_line *line, int n_ranks, uint64_t times);

/* The same of a job of such loops: between them everybody does all of it. */
void cli_rank_loops(const cli_rank_trace *trace, const cli_rank_line *line, int n_ranks, uint64_t times,
                    cli_rank_estimate *estimate);

/* The same of building: what is shared out takes its share of the time, and then there is what more ranks make longer.
 */
void cli_rank_build(const cli_rank_trace *trace, const cli_rank_line *line, int n_ranks, uint64_t times,
                    cli_rank_estimate *estimate);

#endif
