#include "shots/samples_shared.h"

#include <pthread.h>

#include "accumulation/scattered.h"

enum { LEAST_SAMPLES = 16, UNITS_EACH = 4 };

typedef struct together {
  const conic_shot_work *work;
  const conic_executor *executor;
  const conic_accumulate_options *options;
  const conic_sums_keeper *keeper; /* null: nobody keeps */
  conic_accumulation *sums;
} together;

/* Where the sums come together next: at the end or, where it matters in between, at a power of two. */
static uint64_t stage_end(const together *t, uint64_t begin) {
  uint64_t end = LEAST_SAMPLES;
  while (end <= begin)
    end *= 2;
  return (t->options->noise > 0.0 || t->keeper) && end < t->options->end_sample ? end : t->options->end_sample;
}

/* Of the samples from `begin` to before `end` those that this process is given. */
static conic_status add_given(const together *t, uint64_t begin, uint64_t end) {
  const conic_executor *executor = t->executor;
  uint64_t count = (uint64_t)executor->cut_for, each = (end - begin) / (count * UNITS_EACH) + 1, unit;
  conic_status status = CONIC_OK;
  executor->share(executor->data, (end - begin + each - 1) / each, NULL, NULL);
  while (status == CONIC_OK && (unit = executor->next(executor->data)) != CONIC_NO_UNIT) {
    conic_moment start = conic_moment_now();
    uint64_t from = begin + unit * each, to = from + each < end ? from + each : end;
    status = conic_accumulate_range(t->work->context, t->options, from, to, t->sums);
    executor->did(executor->data, "samples", from, start, 0);
  }
  return status;
}

typedef struct part_sending {
  const conic_accumulation *sums;
  const conic_team *team;
} part_sending;

static void *send_parts(void *cookie) {
  const part_sending *work = cookie;
  const conic_team *team = work->team;
  for (int round = 0; round < team->count; round++) {
    int partner = conic_team_partner(team, round);
    size_t n_bytes;
    const void *part = conic_accumulation_part(work->sums, partner, team->count, &n_bytes);
    if (partner != team->index)
      team->send(team->data, partner, part, n_bytes);
  }
  return NULL;
}

static void add_time_since(conic_moment start, conic_moment *sum) {
  conic_moment now = conic_moment_now();
  sum->clock_s += now.clock_s - start.clock_s;
  sum->processor_s += now.processor_s - start.processor_s;
}

/* Every process brings together a part of the sums: it meets each of the others, and they swap their parts; both ways
 * at a time, where there is a thread for it. */
static conic_status join_own_part(const together *t, const conic_team *team, conic_moment *joining) {
  part_sending sending = {t->sums, team};
  pthread_t thread;
  int has_thread = pthread_create(&thread, NULL, send_parts, &sending) == 0;
  conic_status status = CONIC_OK;
  for (int round = 0; round < team->count; round++) {
    int partner = conic_team_partner(team, round);
    size_t n_bytes;
    const void *part = conic_accumulation_part(t->sums, partner, team->count, &n_bytes);
    if (partner == team->index)
      continue;
    void *others = has_thread ? team->receive(team->data, partner, &n_bytes)
                              : conic_team_swap(team, partner, part, n_bytes, &n_bytes);
    conic_moment start = conic_moment_now();
    if (status == CONIC_OK)
      status = conic_accumulation_join_part(t->sums, team->index, team->count, others, n_bytes);
    add_time_since(start, joining);
    team->release(team->data, others);
  }
  if (has_thread)
    pthread_join(thread, NULL);
  return status;
}

static conic_status take_joined_part(const together *t, const conic_team *team, int from) {
  size_t n_header, n_bytes;
  conic_scattered *header = team->receive(team->data, from, &n_header);
  void *part = team->receive(team->data, from, &n_bytes);
  conic_status status = conic_accumulation_take_part(t->sums, from, team->count, header, part, n_bytes);
  team->release(team->data, header);
  team->release(team->data, part);
  return status;
}

/* The parts come together in the first process. */
static conic_status take_all_parts(const together *t, const conic_team *team) {
  conic_status status = CONIC_OK;
  if (team->index > 0) {
    size_t n_bytes;
    const conic_scattered header = conic_accumulation_scattered(t->sums);
    const void *part = conic_accumulation_part(t->sums, team->index, team->count, &n_bytes);
    team->send(team->data, 0, &header, sizeof header);
    team->send(team->data, 0, part, n_bytes);
    return CONIC_OK;
  }
  for (int from = 1; from < team->count; from++) {
    conic_status taken = take_joined_part(t, team, from);
    status = status == CONIC_OK ? taken : status;
  }
  return status;
}

/* Of the swap, what is no waiting. */
static void trace_joining(const conic_shot_work *work, const conic_moment *took) {
  conic_moment now = conic_moment_now();
  conic_work_trace(work, "join", "sums", 0,
                   (conic_moment){now.clock_s - took->clock_s, now.processor_s - took->processor_s}, 0);
}

/* Two by two again and again, everything would go over the line as often as the logarithm of their number says; so it
 * goes twice. */
static conic_status join_all_sums(const together *t) {
  const conic_team *team = t->executor->team;
  conic_moment start = conic_moment_now(), joining = {0.0, 0.0};
  size_t n_bytes, n_own;
  conic_accumulation_part(t->sums, 0, 1, &n_bytes);
  conic_accumulation_part(t->sums, team->index, team->count, &n_own);
  conic_status status = join_own_part(t, team, &joining);
  conic_work_trace(t->work, "join", "swap", 0, start, n_bytes - n_own);
  trace_joining(t->work, &joining);
  start = conic_moment_now();
  conic_status taken = take_all_parts(t, team);
  conic_work_trace(t->work, "join", "parts", 0, start, team->index ? n_own : 0);
  if (team->index == 0)
    conic_accumulation_joined(t->sums, 0);
  else
    conic_accumulation_clear(t->sums);
  return status == CONIC_OK ? taken : status;
}

static conic_status run_stage(const together *t, uint64_t begin) {
  conic_status status = conic_work_agree(t->work, add_given(t, begin, stage_end(t, begin)));
  if (status == CONIC_OK)
    status = join_all_sums(t);
  if (status == CONIC_OK && t->keeper && t->executor->index == 0)
    status = t->keeper->keep(t->keeper->cookie, t->sums);
  return conic_work_agree(t->work, status);
}

conic_status conic_accumulate_together(const conic_shot_work *work, const conic_accumulate_options *options,
                                       conic_accumulation *sums) {
  const conic_executor *executor = work->executor;
  together t = {work, executor, options, work->keeper && work->keeper->keep ? work->keeper : NULL, sums};
  struct {
    uint64_t begin, is_enough;
  } next = {0, 0};
  conic_accumulation_facts facts;
  conic_accumulation_inspect(sums, &facts);
  conic_status status = facts.end_sample > 0 ? conic_accumulate_check_key(work->context, options, sums) : CONIC_OK;
  status = conic_work_agree(work, status);
  while (status == CONIC_OK) {
    conic_accumulation_inspect(sums, &facts);
    next.begin = facts.end_sample;
    next.is_enough = (uint64_t)conic_accumulate_is_enough(options, sums);
    executor->broadcast(executor->data, &next, sizeof next);
    if (next.is_enough)
      break;
    status = run_stage(&t, next.begin);
  }
  return status;
}
