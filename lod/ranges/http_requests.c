#include "lod/ranges/http_requests.h"

#ifdef CONIC_HAVE_CURL

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/real.h"

enum {
  JOINED_BYTES = 1 << 19, /* ranges are joined to requests of up to so many, */
  GAP_BYTES = 1 << 12,    /* across gaps of up to so many, which are dropped; */
  BATCH_BYTES = 1 << 22   /* and looked for among so many */
};

/* A request is for what the link brings in so long, and is sent so long before it has nothing more to bring. What is
 * wanted first then comes first: more requests at a time would only share a slow link. */
static const double request_s = 0.25, ahead_s = 0.1;

/* A gap takes no longer. */
static const double gap_s = 0.003;

/* Within so long the link's speed is measured; who sends nothing for so long is not waited for. */
static const double measuring_s = 0.05, silence_s = 1.0;

/* A request is left behind that brings nothing while others bring what the link does in so long. */
static const double behind_s = 2.0;

static conic_http_ready *add_ready(conic_http_ranges *http) {
  if (http->first_ready == http->n_ready)
    http->first_ready = http->n_ready = 0;
  return conic_memory_add(http->base.context, &http->ready, &http->n_ready, &http->ready_room, sizeof *http->ready);
}

static int answer_from(conic_http_ranges *http, conic_http_body *from, uint64_t body_offset, const conic_range *range) {
  conic_http_ready *ready = add_ready(http);
  if (!ready)
    return 0;
  ready->answer.id = range->id;
  ready->answer.bytes = from->bytes + (range->offset - body_offset);
  ready->answer.n_bytes = range->file[0] ? from->n : range->n_bytes;
  ready->answer.held = from;
  from->n_holders++;
  return 1;
}

static void give_up(conic_http_ranges *http, const conic_range *range, conic_http_fault why, const char *reason) {
  conic_http_ready *ready = add_ready(http);
  if (!ready) {
    http->base.n_pending--; /* the message about memory is logged; the caller will find nothing pending */
    return;
  }
  ready->answer.id = range->id;
  ready->answer.status = conic_http_fates[why].status;
  snprintf(ready->reason, sizeof ready->reason, "%s", reason);
}

int conic_http_most_repeats(const conic_http_ranges *http, conic_http_fault why) {
  int most = conic_http_fates[why].most_repeats, allowed = http->options.n_retries;
  return most < allowed ? most : allowed;
}

/* A part of a failed request: once more after a pause, or never again. */
static void put_off(conic_http_ranges *http, const conic_http_transfer *t, conic_queued_range *part) {
  double pause = http->options.pause_seconds;
  for (int i = 0; i < part->n_failures; i++)
    pause *= 2.0;
  part->not_before_s = conic_seconds_now() + pause;
  part->n_failures++;
  int n_repeats = conic_http_most_repeats(http, t->fault), is_last = part->n_failures > n_repeats;
  if (n_repeats > 0 && is_last && http->n_failures > n_repeats && !http->is_dead) {
    http->is_dead = 1;
    http->fault = t->fault;
    snprintf(http->reason, sizeof http->reason, "%s", t->reason);
  }
  if (is_last || http->is_dead || conic_range_queue_push(http->base.context, &http->base.queue, part) != CONIC_OK)
    give_up(http, &part->range, t->fault, t->reason);
}

/* Answers parts whose bytes are all there. */
static void answer_parts(conic_http_transfer *t) {
  conic_http_ranges *http = t->owner;
  for (; t->n_answered < t->n_parts; t->n_answered++) {
    const conic_range *range = &t->parts[t->n_answered].range;
    if (!t->is_beside && range->offset + range->n_bytes > t->offset + t->body->n)
      return;
    if (!answer_from(http, t->body, t->offset, range))
      http->base.n_pending--;
  }
}

/* Those that had come of a request that fails are kept, and what else it was for has lost no try by that. */
static void finish_transfer(conic_http_transfer *t, CURLcode code) {
  conic_http_ranges *http = t->owner;
  int is_good = conic_http_transfer_is_complete(t, code);
  if (is_good)
    answer_parts(t);
  http->n_failures = is_good || t->n_answered > 0 ? 0 : http->n_failures + 1;
  for (size_t i = t->n_answered; i < t->n_parts; i++)
    put_off(http, t, &t->parts[i]);
  if (is_good && t->is_beside)
    http->beside_bytes = 0.5 * (http->beside_bytes + (double)t->body->n);
  t->n_parts = 0;
  conic_http_transfer_end(t);
}

/* The server has not begun to answer, and others' answers come: it was not its turn. */
static void wait_again(conic_http_transfer *t) {
  conic_http_ranges *http = t->owner;
  for (size_t i = 0; i < t->n_parts; i++)
    if (conic_range_queue_push(http->base.context, &http->base.queue, &t->parts[i]) != CONIC_OK)
      give_up(http, &t->parts[i].range, CONIC_HTTP_BOUND, "out of memory");
  t->n_parts = 0;
  conic_http_transfer_end(t);
}

/* The one part that is a file of its own. Whether it can be asked for. */
static int name_part(conic_http_ranges *http, conic_http_transfer *t) {
  const conic_range *range = &t->parts[0].range;
  conic_memory_release(http->base.context, t->own_url);
  t->offset = 0;
  t->n_expected = range->n_bytes;
  return conic_ranges_name_beside(http->base.context, http->url, range->file, &t->own_url) == CONIC_OK;
}

static int is_busy(const conic_http_ranges *http) {
  int n = 0;
  for (int i = 0; i < http->options.n_connections; i++)
    n += http->transfers[i].is_busy;
  return n > 0;
}

/* Measures how fast bytes come while some are on their way. */
static void measure_link(conic_http_ranges *http) {
  double now = conic_seconds_now(), elapsed = now - http->measured_s;
  uint64_t n = http->base.n_received - http->measured_n;
  int is_going_on = is_busy(http) && http->measured_s > 0.0;
  if (is_going_on && (elapsed < measuring_s || n == 0))
    return;
  if (is_going_on) {
    double now_a_second = (double)n / elapsed, before = http->bytes_a_second;
    http->bytes_a_second = now_a_second > before ? now_a_second : 0.9 * before + 0.1 * now_a_second;
  }
  http->measured_s = is_busy(http) ? now : 0.0;
  http->measured_n = http->base.n_received;
}

/* Whether what is on its way keeps the link busy for a while. */
static int is_link_full(const conic_http_ranges *http) {
  double now = conic_seconds_now(), n = 0.0;
  for (int i = 0; i < http->options.n_connections; i++) {
    const conic_http_transfer *t = &http->transfers[i];
    if (t->is_busy && now - t->came_s < silence_s)
      n += t->is_beside && !t->response.has_length ? http->beside_bytes : (double)(t->n_expected - t->body->n);
  }
  return n > (ahead_s + 2.0 * http->latency_s) * http->bytes_a_second;
}

CONIC_DEFINE_ORDER(compare_offsets, conic_queued_range, range.offset)

static uint64_t end_of(const conic_queued_range *part) {
  return part->range.offset + part->range.n_bytes;
}

/* Leaves the wanted part and those about it, in the order of their places. The others wait again. */
static void keep_neighbours(conic_http_ranges *http, conic_http_transfer *t, uint64_t most) {
  uint64_t gap = gap_s * http->bytes_a_second < GAP_BYTES ? (uint64_t)(gap_s * http->bytes_a_second) : GAP_BYTES;
  const conic_range wanted = t->parts[0].range;
  conic_queued_range *parts = t->parts;
  size_t n = t->n_parts, begin = 0;
  qsort(parts, n, sizeof *parts, compare_offsets);
  while (parts[begin].range.id != wanted.id || parts[begin].range.offset != wanted.offset)
    begin++;
  size_t end = begin + 1;
  uint64_t last = end_of(&parts[begin]);
  while (begin > 0 && end_of(&parts[begin - 1]) + gap >= parts[begin].range.offset &&
         end_of(&parts[begin - 1]) <= last && last <= parts[begin - 1].range.offset + most)
    begin--;
  for (; end < n && parts[end].range.offset <= last + gap && end_of(&parts[end]) <= parts[begin].range.offset + most;
       end++)
    last = end_of(&parts[end]) > last ? end_of(&parts[end]) : last;
  t->offset = parts[begin].range.offset;
  t->n_expected = (size_t)(last - t->offset);
  t->n_parts = 0;
  for (size_t i = 0; i < n; i++)
    if (i >= begin && i < end)
      parts[t->n_parts++] = parts[i];
    else if (conic_range_queue_push(http->base.context, &http->base.queue, &parts[i]) != CONIC_OK)
      give_up(http, &parts[i].range, CONIC_HTTP_BOUND, "out of memory");
}

/* Whether a range is answered without a request. */
static int is_answered_at_once(conic_http_ranges *http, const conic_queued_range *item) {
  int is_here = !item->range.file[0] && end_of(item) <= http->head->n;
  if (is_here && !answer_from(http, http->head, 0, &item->range))
    http->base.n_pending--;
  if (!is_here && http->is_cut && !item->range.file[0])
    give_up(http, &item->range, CONIC_HTTP_SILENCE, "the server sends no ranges, and the time is up");
  return is_here || (http->is_cut && !item->range.file[0]);
}

/* Takes ranges that wait: what the link brings within the time of a request, or one that has to be asked for alone. */
static void take_waiting(conic_http_ranges *http, conic_http_transfer *t, double most) {
  conic_range_queue *queue = &http->base.queue;
  conic_queued_range item;
  double n_bytes = 0.0;
  int is_alone = 0;
  t->n_parts = 0;
  while (!is_alone && n_bytes <= most && conic_range_queue_pop(queue, conic_seconds_now(), &item)) {
    if (is_answered_at_once(http, &item))
      continue;
    is_alone = item.range.file[0] || item.not_before_s > 0.0;
    conic_status status = is_alone && t->n_parts > 0 ? conic_range_queue_push(http->base.context, queue, &item)
                                                     : conic_memory_append(http->base.context, &t->parts, &t->n_parts,
                                                                           &t->parts_room, &item, sizeof item);
    if (status != CONIC_OK)
      give_up(http, &item.range, CONIC_HTTP_BOUND, "out of memory");
    n_bytes += (double)item.range.n_bytes;
  }
}

/* Takes the next range, and what lies next to it of those that come soon: 1, or 0 where none is to be had now. */
static int gather_parts(conic_http_ranges *http, conic_http_transfer *t) {
  double most = request_s * http->bytes_a_second;
  take_waiting(http, t, most < BATCH_BYTES ? most : BATCH_BYTES);
  t->is_beside = t->n_parts > 0 && t->parts[0].range.file[0];
  if (t->n_parts > 0 && !t->is_beside)
    keep_neighbours(http, t, most < JOINED_BYTES ? (uint64_t)most : JOINED_BYTES);
  if (!t->is_beside || name_part(http, t))
    return t->n_parts > 0;
  give_up(http, &t->parts[0].range, CONIC_HTTP_BOUND, "out of memory");
  return 0;
}

void conic_http_send_requests(conic_http_ranges *http) {
  for (int i = 0; i < http->options.n_connections; i++) {
    conic_http_transfer *t = &http->transfers[i];
    if (t->is_busy)
      continue;
    if (is_link_full(http) || !gather_parts(http, t))
      return;
    if (conic_http_transfer_begin(t) != CONIC_OK) {
      for (size_t k = 0; k < t->n_parts; k++)
        give_up(http, &t->parts[k].range, CONIC_HTTP_BOUND, "out of memory");
      t->n_parts = 0;
    }
  }
}

void conic_http_take_finished(conic_http_ranges *http) {
  CURLMsg *message;
  int n_left, n_running;
  http->curl->multi_perform(http->multi, &n_running);
  while ((message = http->curl->multi_info_read(http->multi, &n_left))) {
    char *cookie = NULL;
    CURLcode code = message->data.result;
    if (message->msg == CURLMSG_DONE &&
        http->curl->easy_getinfo(message->easy_handle, CURLINFO_PRIVATE, &cookie) == CURLE_OK)
      finish_transfer((conic_http_transfer *)(void *)cookie, code);
  }
  for (int i = 0; i < http->options.n_connections; i++) {
    conic_http_transfer *t = &http->transfers[i];
    int is_behind = t->is_busy && (double)(http->base.n_received - t->came_n) > behind_s * http->bytes_a_second;
    if (is_behind && t->body->n == t->n_here)
      wait_again(t);
    else if (is_behind || (t->is_busy && conic_http_transfer_is_stalled(t)))
      finish_transfer(t, CURLE_OPERATION_TIMEDOUT);
    else if (t->is_busy && t->n_parts > 1)
      answer_parts(t);
  }
  measure_link(http);
}

void conic_http_give_up_all(conic_http_ranges *http) {
  for (size_t i = 0; i < http->base.queue.n; i++)
    give_up(http, &http->base.queue.items[i].range, http->fault, http->reason);
  http->base.queue.n = 0;
}

int conic_http_is_idle(const conic_http_ranges *http) {
  return http->base.queue.n == 0 && !is_busy(http);
}

#endif
