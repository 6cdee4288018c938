/* Reading the trace of a job. */
#include <stdlib.h>
#include <string.h>

#include "bench/rank_schedule.h"
#include "core/base/memory.h"
#include "core/files/json_read.h"
#include "core/files/number.h"

typedef struct trace_event {
  char name[32], kind[16];
  double begun_us, lasted_us, worked_us, rank, bytes;
  double spent_s; /* one of the two, as is wanted */
} trace_event;

static conic_status add_unit(conic_context *context, cli_rank_trace *trace, const trace_event *event) {
  conic_status status = conic_memory_reserve(context, &trace->units, trace->n_units, trace->n_units + 1, &trace->room,
                                             sizeof *trace->units);
  if (status == CONIC_OK)
    trace->units[trace->n_units++] = (cli_rank_unit){event->spent_s, event->bytes, 1e-6 * event->begun_us};
  return status;
}

/* What is of no kind is not drawn. */
static conic_status add_event(conic_context *context, cli_rank_trace *trace, const trace_event *event) {
  static const char *const kinds[CLI_RANK_N_KINDS] = {"build", "stage", "wait", "open", "unit", "join", "write"};
  int kind = 0;
  while (kind < CLI_RANK_N_KINDS && strcmp(event->kind, kinds[kind]) != 0)
    kind++;
  if (kind == CLI_RANK_N_KINDS)
    return CONIC_OK;
  conic_status status = conic_memory_reserve(context, &trace->events, trace->n_events, trace->n_events + 1,
                                             &trace->events_room, sizeof *trace->events);
  if (status == CONIC_OK)
    trace->events[trace->n_events++] = (cli_rank_event){
        1e-6 * event->begun_us, 1e-6 * (event->begun_us + event->lasted_us), (int)event->rank, (cli_rank_kind)kind};
  return status;
}

/* "grow 20000" is a stage of building with its number; what was waited then is an event of the same name. */
static void add_stage(cli_rank_trace *trace, const trace_event *event, double sign) {
  static const char *const names[CLI_RANK_N_STAGES] = {"read", "measure", "share", "exchange", "sort",
                                                       "grow", "crown",   "order", "write"};
  for (int i = 0; i < CLI_RANK_N_STAGES; i++) {
    size_t length = strlen(names[i]);
    double number;
    if (strncmp(event->name, names[i], length) != 0 || event->name[length] != ' ')
      continue;
    trace->stages[i].seconds += sign * event->spent_s;
    trace->stages[i].bytes += event->bytes;
    if (sign > 0.0 && conic_number_parse(event->name + length + 1, strlen(event->name + length + 1), &number) > 0)
      trace->stages[i].number += number;
    trace->n_parts += i == CLI_STAGE_READ && sign > 0.0 ? 1.0 : 0.0;
  }
  trace->loops.seconds += sign * event->spent_s;
  trace->loops.bytes += event->bytes;
  trace->loops.number += sign > 0.0 ? 1.0 : 0.0;
  trace->alone_s -= event->rank < 1.0 && sign > 0.0 ? event->spent_s : 0.0;
}

/* Each time that sums come together, every rank says by "swap" how much it sends, and by "sums" how long it
 * worked on it; "parts" wait for others. */
static conic_status take_event(conic_context *context, cli_rank_trace *trace, const trace_event *event) {
  double end_s = 1e-6 * (event->begun_us + event->lasted_us);
  if (end_s > trace->seconds)
    trace->seconds = end_s;
  if (1e-6 * event->begun_us < trace->first_event)
    trace->first_event = 1e-6 * event->begun_us;
  if (event->rank >= trace->n_ranks)
    trace->n_ranks = (int)event->rank + 1;
  if (strcmp(event->kind, "unit") == 0)
    return add_unit(context, trace, event);
  if (strcmp(event->kind, "stage") == 0 || strcmp(event->kind, "wait") == 0)
    add_stage(trace, event, event->kind[0] == 's' ? 1.0 : -1.0);
  else if (strcmp(event->kind, "build") == 0 && event->rank < 1.0)
    trace->whole_s += event->spent_s;
  else if (strcmp(event->kind, "open") == 0)
    trace->open_s += event->spent_s;
  else if (strcmp(event->kind, "write") == 0)
    trace->write_s += event->spent_s;
  else if (strcmp(event->kind, "join") == 0 && strncmp(event->name, "swap", 4) == 0) {
    trace->merge_bytes += event->bytes;
    trace->n_merges += 1.0;
  } else if (strcmp(event->kind, "join") == 0 && strncmp(event->name, "sums", 4) == 0)
    trace->merge_s += event->spent_s;
  else if (strcmp(event->kind, "join") == 0 && strncmp(event->name, "parts", 5) != 0)
    trace->join_s += event->spent_s;
  return CONIC_OK;
}

static void read_arguments(conic_json *json, trace_event *event) {
  char key[CONIC_JSON_KEY_ROOM];
  conic_json_begin_object(json);
  while (conic_json_next_member(json, key))
    if (strcmp(key, "sent_bytes") == 0)
      conic_json_number(json, &event->bytes);
    else
      conic_json_skip(json);
}

static void read_event(conic_json *json, int is_by_processor, trace_event *event) {
  char key[CONIC_JSON_KEY_ROOM];
  memset(event, 0, sizeof *event);
  event->worked_us = -1.0;
  conic_json_begin_object(json);
  while (conic_json_next_member(json, key))
    if (strcmp(key, "name") == 0)
      conic_json_text(json, event->name, sizeof event->name);
    else if (strcmp(key, "cat") == 0)
      conic_json_text(json, event->kind, sizeof event->kind);
    else if (strcmp(key, "ts") == 0)
      conic_json_number(json, &event->begun_us);
    else if (strcmp(key, "dur") == 0)
      conic_json_number(json, &event->lasted_us);
    else if (strcmp(key, "tdur") == 0)
      conic_json_number(json, &event->worked_us);
    else if (strcmp(key, "pid") == 0)
      conic_json_number(json, &event->rank);
    else if (strcmp(key, "args") == 0)
      read_arguments(json, event);
    else
      conic_json_skip(json);
  if (!(event->lasted_us >= 0.0) || !(event->bytes >= 0.0) || !(event->rank >= 0.0) || event->rank >= CLI_MOST_RANKS)
    conic_json_wrong(json, "is no event of a trace");
  else if (is_by_processor && !(event->worked_us >= 0.0))
    conic_json_wrong(json, "has no processor time");
  event->spent_s = 1e-6 * (is_by_processor ? event->worked_us : event->lasted_us);
}

static conic_status read_events(conic_context *context, conic_json *json, cli_rank_trace *trace) {
  conic_status status = CONIC_OK;
  conic_json_begin_array(json);
  while (status == CONIC_OK && conic_json_next_item(json)) {
    trace_event event;
    read_event(json, trace->is_by_processor, &event);
    status = json->status == CONIC_OK ? add_event(context, trace, &event) : json->status;
    if (status == CONIC_OK)
      status = take_event(context, trace, &event);
  }
  return status;
}

/* A stage alone does not tell: the light of a picture has some, too. */
static void find_job(cli_rank_trace *trace) {
  if (trace->whole_s > 0.0) {
    trace->job = CLI_RANK_LOOPS;
    trace->n_units = (size_t)trace->loops.number;
  } else if (trace->n_units == 0) {
    trace->job = CLI_RANK_LAYERS;
    trace->n_units = (size_t)trace->n_parts;
  }
}

static int compare_units(const void *a, const void *b) {
  double first = ((const cli_rank_unit *)a)->begin_s, second = ((const cli_rank_unit *)b)->begin_s;
  return (first > second) - (first < second);
}

/* Sums of ranks and merges become means; each rank kept its share of the bytes. */
static void settle_trace(cli_rank_trace *trace) {
  trace->seconds -= trace->first_event;
  if (trace->job == CLI_RANK_UNITS) /* which a trace has rank by rank */
    qsort(trace->units, trace->n_units, sizeof *trace->units, compare_units);
  trace->open_s /= trace->n_ranks;
  trace->loops.seconds = trace->loops.seconds > 0.0 ? trace->loops.seconds : 0.0;
  trace->alone_s = trace->whole_s + trace->alone_s > 0.0 ? trace->whole_s + trace->alone_s : 0.0;
  if (trace->n_merges > 0.0) {
    double whole = trace->n_ranks > 1 ? trace->n_ranks / (trace->n_ranks - 1.0) : 1.0;
    trace->merge_s *= whole / trace->n_merges;
    trace->merge_bytes *= whole / trace->n_merges;
    trace->n_merges /= trace->n_ranks;
  }
}

conic_status cli_rank_trace_read(conic_context *context, const char *path, int is_by_processor, cli_rank_trace *trace) {
  char key[CONIC_JSON_KEY_ROOM];
  conic_json json;
  memset(trace, 0, sizeof *trace);
  trace->first_event = 1e300;
  trace->is_by_processor = is_by_processor;
  conic_status status = conic_json_open(context, path, &json);
  if (status != CONIC_OK)
    return status;
  conic_json_begin_object(&json);
  while (status == CONIC_OK && conic_json_next_member(&json, key))
    if (strcmp(key, "traceEvents") == 0)
      status = read_events(context, &json, trace);
    else
      conic_json_skip(&json);
  if (status == CONIC_OK)
    status = conic_json_end(&json);
  find_job(trace);
  if (status == CONIC_OK && trace->n_units == 0)
    status = conic_json_wrong(&json, "is no trace of conic-mpi: it has neither units nor stages of building");
  conic_json_close(&json);
  if (status == CONIC_OK)
    settle_trace(trace);
  else
    cli_rank_trace_release(context, trace);
  return status;
}

void cli_rank_trace_release(conic_context *context, cli_rank_trace *trace) {
  conic_memory_release(context, trace->units);
  conic_memory_release(context, trace->events);
  trace->units = NULL;
  trace->events = NULL;
  trace->n_units = trace->room = trace->n_events = trace->events_room = 0;
}
