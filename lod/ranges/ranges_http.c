/* Ranges of a file on a web server, by libcurl's multi interface: the one file that knows libcurl. */
#include "lod/ranges/ranges_backend.h"

#include "core/base/message.h"

#ifndef CONIC_HAVE_CURL

conic_status conic_ranges_open_url(conic_context *context, const char *url, const conic_ranges_options *options,
                                   conic_ranges **ranges) {
  (void)options;
  (void)ranges;
  return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "%s: this build reads no URLs: it is without libcurl", url);
}

#else

#include <curl/curl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "core/base/clock.h"
#include "core/base/memory.h"
#include "lod/ranges/http_response.h"

enum {
  PROBE_BYTES = 1 << 16,  /* the first request's: it says how large the file is, and holds its beginning */
  JOINED_BYTES = 1 << 19, /* ranges are joined to requests of up to so many, */
  GAP_BYTES = 1 << 12,    /* across gaps of up to so many, which are dropped */
  LEAST_BYTES_PER_SECOND = 1024,
  MOST_REDIRECTS = 5,
  MOST_CONNECTIONS = 16
};

/* What arrived, shared by the answers that lie in it. */
typedef struct body {
  unsigned char *bytes;
  size_t n, room;
  int n_holders;
} body;

/* Why a request failed, and what comes of it: `fates` says. */
typedef enum fault {
  FAULT_SILENCE, /* the server is not there, slow or busy, or ends early: there may be more in a while */
  FAULT_WRONG,   /* what it sends is not what was asked for */
  FAULT_LASTING, /* nor will it ever be */
  FAULT_BOUND    /* it is more than there is memory for */
} fault;

static const struct {
  conic_status status;
  int most_repeats; /* of the request, if the options do not say less */
} fates[] = {[FAULT_SILENCE] = {CONIC_ERROR_IO, INT_MAX},
             [FAULT_WRONG] = {CONIC_ERROR_INPUT, 1},
             [FAULT_LASTING] = {CONIC_ERROR_INPUT, 0},
             [FAULT_BOUND] = {CONIC_ERROR_IO, 0}};

typedef struct transfer {
  struct http_ranges *owner;
  CURL *easy;
  int is_busy;
  int is_probe, is_whole; /* it began as the first request; the server sends the whole file */
  uint64_t offset;
  size_t n_expected;
  body *body;
  conic_queued_range *parts;
  size_t n_parts, parts_room;
  conic_http_response response;
  double window_s; /* when it was last looked at whether it stalls, */
  size_t window_n; /* and what it had then */
  fault fault;     /* of its failure, which the reason describes: empty, where there is none yet */
  char reason[CURL_ERROR_SIZE];
  char words[CURL_ERROR_SIZE]; /* libcurl's own */
} transfer;

/* An answer that waits to be fetched. */
typedef struct ready_answer {
  conic_range_answer answer;
  char reason[CURL_ERROR_SIZE];
} ready_answer;

typedef struct http_ranges {
  conic_ranges base;
  conic_ranges_options options;
  char *url;
  CURLM *multi;
  int is_global; /* curl_global_init was called */
  transfer transfers[MOST_CONNECTIONS];
  body *head; /* the file's beginning, or all of it */
  char tag[CONIC_HTTP_TAG];
  ready_answer *ready;
  size_t first_ready, n_ready, ready_room; /* those from first_ready on wait */
  int n_failures;                          /* of requests, since one succeeded */
  int is_dead;                             /* the server is given up, until nothing is asked for any more */
  fault fault;                             /* of which it died */
  char reason[CURL_ERROR_SIZE];            /* of the last answer, or of the server's end */
} http_ranges;

static void let_go(http_ranges *http, body *held) {
  if (!held || --held->n_holders > 0)
    return;
  conic_memory_release(http->base.context, held->bytes);
  conic_memory_release(http->base.context, held);
}

/* Keeps what arrives; room grows with it, and not with what a server claims. */
static int keep_received(http_ranges *http, body *to, const char *data, size_t n, size_t most) {
  if (n > to->room - to->n) {
    size_t room = 2 * to->room + n + PROBE_BYTES;
    room = room < most ? room : most;
    if (conic_memory_grow(http->base.context, &to->bytes, to->n, room, 1) != CONIC_OK)
      return 0;
    to->room = room;
  }
  memcpy(to->bytes + to->n, data, n);
  to->n += n;
  http->base.n_received += n;
  return 1;
}

static int refuse_answer(transfer *t, fault why, const char *reason) {
  snprintf(t->reason, sizeof t->reason, "%s", reason);
  t->fault = why;
  return 0;
}

/* The whole file, of a server that knows no ranges. */
static int accept_whole(transfer *t) {
  http_ranges *http = t->owner;
  uint64_t most = http->options.most_whole_bytes;
  if (t->response.has_length && t->response.length > most) {
    snprintf(t->reason, sizeof t->reason,
             "the server sends no ranges, and the whole file of %llu MiB is over the memory bound",
             (unsigned long long)(t->response.length >> 20));
    t->fault = FAULT_BOUND;
    return 0;
  }
  t->is_whole = 1;
  t->n_expected = (size_t)(t->response.has_length ? t->response.length : most);
  return 1;
}

static int refuse_status(transfer *t, int status) {
  snprintf(t->reason, sizeof t->reason, "the server answers with status %d", status);
  if (status >= 500 || status == 408 || status == 429)
    t->fault = FAULT_SILENCE;
  else
    t->fault = status >= 400 ? FAULT_LASTING : FAULT_WRONG;
  return 0;
}

/* Whether the response that begins is what was asked for. */
static int accept_response(transfer *t) {
  const conic_http_response *r = &t->response;
  http_ranges *http = t->owner;
  if (r->is_packed)
    return refuse_answer(t, FAULT_WRONG, "the server sends the file compressed, which nobody asked for");
  if (t->is_probe && r->status == 200)
    return accept_whole(t);
  if (r->status == 200)
    return refuse_answer(t, FAULT_WRONG, "the server sends the whole file for a range");
  if (r->status != 206)
    return refuse_status(t, r->status);
  if (!r->has_range)
    return refuse_answer(t, FAULT_WRONG, "the server does not say which range it sends");
  if (t->is_probe) {
    http->base.size = r->size;
    t->n_expected = r->size < PROBE_BYTES ? (size_t)r->size : PROBE_BYTES;
    memcpy(http->tag, r->tag, sizeof http->tag);
  }
  if (r->size != http->base.size || (r->tag[0] && http->tag[0] && strcmp(r->tag, http->tag) != 0))
    return refuse_answer(t, FAULT_LASTING, "the file on the server has changed");
  if (r->first != t->offset || r->last != t->offset + t->n_expected - 1)
    return refuse_answer(t, FAULT_WRONG, "the server sends another range than was asked for");
  if (r->has_length && r->length != t->n_expected)
    return refuse_answer(t, FAULT_WRONG,
                         r->length > t->n_expected ? "the server sends more than was asked for"
                                                   : "the server sends less than was asked for");
  return 1;
}

static size_t on_header(char *line, size_t one, size_t n, void *cookie) {
  transfer *t = cookie;
  if (!conic_http_header(&t->response, line, one * n)) {
    refuse_answer(t, FAULT_WRONG, "the server's headers do not end");
    return 0;
  }
  return one * n;
}

static size_t on_body(char *data, size_t one, size_t n, void *cookie) {
  transfer *t = cookie;
  n *= one;
  if (t->body->n == 0 && !accept_response(t))
    return 0;
  if (n > t->n_expected - t->body->n) {
    refuse_answer(t, t->is_whole ? FAULT_BOUND : FAULT_WRONG,
                  t->is_whole && !t->response.has_length
                      ? "the server sends no ranges, and the whole file is over the memory bound"
                      : "the server sends more than was asked for");
    return 0;
  }
  if (!keep_received(t->owner, t->body, data, n, t->n_expected)) {
    refuse_answer(t, FAULT_BOUND, "out of memory");
    return 0;
  }
  return n;
}

static int set_up(http_ranges *http, transfer *t) {
  const conic_ranges_options *o = &http->options;
  CURL *easy = t->easy = curl_easy_init();
  t->owner = http;
  if (!easy)
    return 0;
  int failed = curl_easy_setopt(easy, CURLOPT_URL, http->url) != CURLE_OK;
#if LIBCURL_VERSION_NUM >= 0x075500
  failed |= curl_easy_setopt(easy, CURLOPT_PROTOCOLS_STR, "http,https") != CURLE_OK;
  failed |= curl_easy_setopt(easy, CURLOPT_REDIR_PROTOCOLS_STR, "http,https") != CURLE_OK;
#else
  failed |= curl_easy_setopt(easy, CURLOPT_PROTOCOLS, CURLPROTO_HTTP | CURLPROTO_HTTPS) != CURLE_OK;
  failed |= curl_easy_setopt(easy, CURLOPT_REDIR_PROTOCOLS, CURLPROTO_HTTP | CURLPROTO_HTTPS) != CURLE_OK;
#endif
#if LIBCURL_VERSION_NUM >= 0x075700 /* else giving up waits for a name server that does not answer */
  failed |= curl_easy_setopt(easy, CURLOPT_QUICK_EXIT, 1L) != CURLE_OK;
#endif
  failed |= curl_easy_setopt(easy, CURLOPT_HTTP_VERSION, (long)CURL_HTTP_VERSION_1_1) != CURLE_OK;
  failed |= curl_easy_setopt(easy, CURLOPT_NOSIGNAL, 1L) != CURLE_OK;
  failed |= curl_easy_setopt(easy, CURLOPT_FOLLOWLOCATION, 1L) != CURLE_OK;
  failed |= curl_easy_setopt(easy, CURLOPT_MAXREDIRS, (long)MOST_REDIRECTS) != CURLE_OK;
  failed |= curl_easy_setopt(easy, CURLOPT_CONNECTTIMEOUT_MS, (long)(1e3 * o->connect_seconds)) != CURLE_OK;
  failed |= curl_easy_setopt(easy, CURLOPT_HEADERFUNCTION, on_header) != CURLE_OK;
  failed |= curl_easy_setopt(easy, CURLOPT_HEADERDATA, t) != CURLE_OK;
  failed |= curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, on_body) != CURLE_OK;
  failed |= curl_easy_setopt(easy, CURLOPT_WRITEDATA, t) != CURLE_OK;
  failed |= curl_easy_setopt(easy, CURLOPT_ERRORBUFFER, t->words) != CURLE_OK;
  failed |= curl_easy_setopt(easy, CURLOPT_PRIVATE, t) != CURLE_OK;
  return !failed;
}

/* Sends the transfer's request. On failure nothing is under way. */
static conic_status begin_transfer(transfer *t) {
  http_ranges *http = t->owner;
  char range[64];
  t->body = conic_memory_allocate_zeroed(http->base.context, 1, sizeof *t->body);
  if (!t->body)
    return CONIC_ERROR_MEMORY;
  t->body->n_holders = 1;
  memset(&t->response, 0, sizeof t->response);
  t->reason[0] = t->words[0] = '\0';
  t->is_whole = 0;
  snprintf(range, sizeof range, "%llu-%llu", (unsigned long long)t->offset,
           (unsigned long long)(t->offset + t->n_expected - 1));
  if (curl_easy_setopt(t->easy, CURLOPT_RANGE, range) != CURLE_OK ||
      curl_multi_add_handle(http->multi, t->easy) != CURLM_OK) {
    let_go(http, t->body);
    t->body = NULL;
    return CONIC_ERROR_MEMORY;
  }
  t->is_busy = 1;
  t->window_s = conic_seconds_now();
  t->window_n = 0;
  return CONIC_OK;
}

static void end_transfer(transfer *t) {
  if (!t->is_busy)
    return;
  curl_multi_remove_handle(t->owner->multi, t->easy);
  let_go(t->owner, t->body);
  t->body = NULL;
  t->is_busy = 0;
}

/* Whether hardly anything came for long. libcurl's own look at it takes some seconds more. */
static int is_stalled(transfer *t) {
  double now = conic_seconds_now(), elapsed = now - t->window_s;
  if (elapsed < t->owner->options.stall_seconds)
    return 0;
  if ((double)(t->body->n - t->window_n) < LEAST_BYTES_PER_SECOND * elapsed) {
    refuse_answer(t, FAULT_SILENCE, "the server sends nothing more");
    return 1;
  }
  t->window_s = now;
  t->window_n = t->body->n;
  return 0;
}

static ready_answer *add_ready(http_ranges *http) {
  if (http->first_ready == http->n_ready)
    http->first_ready = http->n_ready = 0;
  if (conic_memory_reserve(http->base.context, &http->ready, http->n_ready, http->n_ready + 1, &http->ready_room,
                           sizeof *http->ready) != CONIC_OK)
    return NULL;
  ready_answer *added = &http->ready[http->n_ready++];
  memset(added, 0, sizeof *added);
  return added;
}

static int answer_from(http_ranges *http, body *from, uint64_t body_offset, const conic_range *range) {
  ready_answer *ready = add_ready(http);
  if (!ready)
    return 0;
  ready->answer.id = range->id;
  ready->answer.bytes = from->bytes + (range->offset - body_offset);
  ready->answer.n_bytes = range->n_bytes;
  ready->answer.held = from;
  from->n_holders++;
  return 1;
}

static void give_up(http_ranges *http, const conic_range *range, fault why, const char *reason) {
  ready_answer *ready = add_ready(http);
  if (!ready) {
    http->base.n_pending--; /* the message about memory is logged; the caller will find nothing pending */
    return;
  }
  ready->answer.id = range->id;
  ready->answer.status = fates[why].status;
  snprintf(ready->reason, sizeof ready->reason, "%s", reason);
}

static int most_repeats(const http_ranges *http, fault why) {
  int most = fates[why].most_repeats, allowed = http->options.n_retries;
  return most < allowed ? most : allowed;
}

/* A part of a failed request: once more after a pause, or never again. */
static void put_off(http_ranges *http, const transfer *t, conic_queued_range *part) {
  double pause = http->options.pause_seconds;
  for (int i = 0; i < part->n_failures; i++)
    pause *= 2.0;
  part->not_before_s = conic_seconds_now() + pause;
  part->n_failures++;
  int n_repeats = most_repeats(http, t->fault), is_last = part->n_failures > n_repeats;
  if (n_repeats > 0 && is_last && http->n_failures > n_repeats && !http->is_dead) {
    http->is_dead = 1;
    http->fault = t->fault;
    snprintf(http->reason, sizeof http->reason, "%s", t->reason);
  }
  if (is_last || http->is_dead || conic_range_queue_push(http->base.context, &http->base.queue, part) != CONIC_OK)
    give_up(http, &part->range, t->fault, t->reason);
}

/* libcurl's reason, unless there is one already. */
static int refuse_code(transfer *t, CURLcode code) {
  long system_error = 0;
  int redirects = t->response.status >= 300 && t->response.status < 400;
  if (t->reason[0])
    return 0;
  if (t->body->n == 0 && t->response.n_bytes > 0 && code == CURLE_OUT_OF_MEMORY) /* of a line's room, not of memory */
    return refuse_answer(t, FAULT_WRONG, "the server's headers do not end");
  if (code == CURLE_UNSUPPORTED_PROTOCOL && !redirects)
    return refuse_answer(t, FAULT_WRONG, "the server sends what is no answer, or more than it said in the one before");
  if (curl_easy_getinfo(t->easy, CURLINFO_OS_ERRNO, &system_error) != CURLE_OK)
    system_error = 0;
  int is_lasting = code == CURLE_TOO_MANY_REDIRECTS || code == CURLE_UNSUPPORTED_PROTOCOL ||
                   code == CURLE_URL_MALFORMAT || code == CURLE_PEER_FAILED_VERIFICATION;
  int is_wrong =
      code == CURLE_WEIRD_SERVER_REPLY || code == CURLE_WRITE_ERROR || (code == CURLE_RECV_ERROR && system_error == 0);
  return refuse_answer(t,
                       is_lasting ? FAULT_LASTING
                       : is_wrong ? FAULT_WRONG
                                  : FAULT_SILENCE,
                       t->words[0] ? t->words : curl_easy_strerror(code));
}

/* Whether the transfer brought what it should. If not, its reason says why. */
static int is_complete(transfer *t, CURLcode code) {
  if (code != CURLE_OK)
    return refuse_code(t, code);
  if (t->body->n == 0 && !accept_response(t)) /* it had no body, so nobody has looked at it yet */
    return 0;
  if (t->is_whole ? t->response.has_length && t->body->n != t->n_expected : t->body->n != t->n_expected)
    return refuse_answer(t, FAULT_SILENCE, "the server ends before all was sent");
  return 1;
}

static void finish_transfer(transfer *t, CURLcode code) {
  http_ranges *http = t->owner;
  int is_good = is_complete(t, code);
  http->n_failures = is_good ? 0 : http->n_failures + 1;
  for (size_t i = 0; i < t->n_parts; i++)
    if (!is_good)
      put_off(http, t, &t->parts[i]);
    else if (!answer_from(http, t->body, t->offset, &t->parts[i].range))
      http->base.n_pending--;
  t->n_parts = 0;
  end_transfer(t);
}

/* Takes the next range and those behind it that lie next to it: 1, or 0 where none is to be had now. */
static int gather_parts(http_ranges *http, transfer *t, double *wait_s) {
  conic_queued_range item;
  t->n_parts = 0;
  uint64_t last = 0;
  while (conic_range_queue_pop(&http->base.queue, conic_seconds_now(), &item, wait_s)) {
    uint64_t range_end = item.range.offset + item.range.n_bytes;
    if (range_end <= http->head->n) {
      if (!answer_from(http, http->head, 0, &item.range))
        http->base.n_pending--;
      continue;
    }
    if (conic_memory_reserve(http->base.context, &t->parts, t->n_parts, t->n_parts + 1, &t->parts_room,
                             sizeof *t->parts) != CONIC_OK) {
      give_up(http, &item.range, FAULT_BOUND, "out of memory");
      break;
    }
    if (t->n_parts == 0)
      t->offset = item.range.offset;
    t->parts[t->n_parts++] = item;
    last = range_end > last ? range_end : last;
    const conic_queued_range *next = conic_range_queue_first(&http->base.queue);
    if (!next || next->not_before_s > 0.0 || next->range.offset < t->offset || next->range.offset > last + GAP_BYTES ||
        next->range.offset + next->range.n_bytes - t->offset > JOINED_BYTES)
      break;
  }
  t->n_expected = (size_t)(last - t->offset);
  return t->n_parts > 0;
}

/* Fills free connections with requests. *wait_s is how long until one that waits may be sent, below 0 if none does. */
static void send_requests(http_ranges *http, double *wait_s) {
  *wait_s = -1.0;
  for (int i = 0; i < http->options.n_connections; i++) {
    transfer *t = &http->transfers[i];
    if (t->is_busy)
      continue;
    if (!gather_parts(http, t, wait_s))
      return;
    if (begin_transfer(t) != CONIC_OK) {
      for (size_t k = 0; k < t->n_parts; k++)
        give_up(http, &t->parts[k].range, FAULT_BOUND, "out of memory");
      t->n_parts = 0;
    }
  }
}

static void take_finished(http_ranges *http) {
  CURLMsg *message;
  int n_left, n_running;
  curl_multi_perform(http->multi, &n_running);
  while ((message = curl_multi_info_read(http->multi, &n_left))) {
    char *cookie = NULL;
    CURLcode code = message->data.result;
    if (message->msg == CURLMSG_DONE && curl_easy_getinfo(message->easy_handle, CURLINFO_PRIVATE, &cookie) == CURLE_OK)
      finish_transfer((transfer *)(void *)cookie, code);
  }
  for (int i = 0; i < http->options.n_connections; i++)
    if (http->transfers[i].is_busy && is_stalled(&http->transfers[i]))
      finish_transfer(&http->transfers[i], CURLE_OPERATION_TIMEDOUT);
}

/* The server is given up: so is all that waits. */
static void give_up_all(http_ranges *http) {
  for (size_t i = 0; i < http->base.queue.n; i++)
    give_up(http, &http->base.queue.items[i].range, http->fault, http->reason);
  http->base.queue.n = 0;
}

static int take_ready(http_ranges *http, conic_range_answer *answer) {
  if (http->first_ready == http->n_ready)
    return 0;
  ready_answer *ready = &http->ready[http->first_ready++];
  *answer = ready->answer;
  if (answer->status != CONIC_OK) {
    memmove(http->reason, ready->reason, sizeof http->reason);
    answer->reason = http->reason;
  }
  return 1;
}

static int is_idle(const http_ranges *http) {
  for (int i = 0; i < http->options.n_connections; i++)
    if (http->transfers[i].is_busy)
      return 0;
  return http->base.queue.n == 0;
}

static int next(conic_ranges *ranges, double wait_seconds, conic_range_answer *answer) {
  http_ranges *http = (http_ranges *)ranges;
  double until = conic_seconds_now() + wait_seconds;
  for (;;) {
    double wait_s;
    if (http->is_dead)
      give_up_all(http);
    else
      send_requests(http, &wait_s);
    take_finished(http);
    if (take_ready(http, answer)) {
      http->is_dead &= ranges->n_pending > 1;
      return 1;
    }
    double left = until - conic_seconds_now();
    if (!(left > 0.0) || is_idle(http))
      return 0;
    left = left < 0.1 ? left : 0.1;
    curl_multi_poll(http->multi, NULL, 0, 1 + (int)(1e3 * left), NULL);
  }
}

static void release_answer(conic_ranges *ranges, conic_range_answer *answer) {
  let_go((http_ranges *)ranges, answer->held);
}

static void cancel(conic_ranges *ranges) {
  http_ranges *http = (http_ranges *)ranges;
  for (int i = 0; i < MOST_CONNECTIONS; i++)
    end_transfer(&http->transfers[i]);
  for (; http->first_ready < http->n_ready; http->first_ready++)
    let_go(http, http->ready[http->first_ready].answer.held);
  http->is_dead = 0;
}

static void close_url(conic_ranges *ranges) {
  http_ranges *http = (http_ranges *)ranges;
  conic_context *context = ranges->context;
  cancel(ranges);
  for (int i = 0; i < MOST_CONNECTIONS; i++) {
    if (http->transfers[i].easy)
      curl_easy_cleanup(http->transfers[i].easy);
    conic_memory_release(context, http->transfers[i].parts);
  }
  if (http->multi)
    curl_multi_cleanup(http->multi);
  if (http->is_global)
    curl_global_cleanup();
  let_go(http, http->head);
  conic_memory_release(context, http->ready);
  conic_memory_release(context, http->url);
  conic_memory_release(context, http);
}

static const conic_ranges_backend backend = {next, release_answer, cancel, close_url};

/* Whether opening may go on; waits a little for what comes. */
static conic_status go_on_opening(http_ranges *http, int wait_ms) {
  conic_status status = conic_progress(http->base.context, "connect", 0.0);
  double left = http->options.until_s - conic_seconds_now();
  if (status != CONIC_OK)
    return status;
  if (!(left > 0.0))
    return conic_fail(http->base.context, CONIC_ERROR_IO, "%s: cannot read: nothing came in time", http->url);
  wait_ms = left < 1e-3 * wait_ms ? 1 + (int)(1e3 * left) : wait_ms;
  curl_multi_poll(http->multi, NULL, 0, wait_ms, NULL);
  return CONIC_OK;
}

/* The first request, once. */
static conic_status probe(http_ranges *http, transfer *t, int *is_good) {
  conic_status status;
  t->is_probe = 1;
  t->offset = 0;
  t->n_expected = PROBE_BYTES;
  *is_good = 0;
  if (begin_transfer(t) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (;;) {
    CURLMsg *message;
    int n_running = 0, n_left;
    curl_multi_perform(http->multi, &n_running);
    message = curl_multi_info_read(http->multi, &n_left);
    if (message && message->msg == CURLMSG_DONE) {
      *is_good = is_complete(t, message->data.result);
      status = CONIC_OK;
      break;
    }
    status = go_on_opening(http, 100);
    if (status != CONIC_OK || is_stalled(t))
      break;
  }
  if (*is_good) {
    if (t->is_whole)
      http->base.size = t->body->n;
    http->head = t->body;
    http->head->n_holders++;
  }
  end_transfer(t);
  t->is_probe = 0;
  return status;
}

static conic_status pause_between(http_ranges *http, double seconds) {
  double until = conic_seconds_now() + seconds;
  conic_status status = CONIC_OK;
  while (conic_seconds_now() < until && status == CONIC_OK)
    status = go_on_opening(http, 50);
  return status;
}

/* Finds the file's size, and takes its beginning along. */
static conic_status look_at_file(http_ranges *http) {
  transfer *t = &http->transfers[0];
  double pause = http->options.pause_seconds;
  int is_good = 0;
  conic_status status = probe(http, t, &is_good);
  for (int i = 0; status == CONIC_OK && !is_good && i < most_repeats(http, t->fault); i++, pause *= 2.0) {
    status = pause_between(http, pause);
    if (status == CONIC_OK)
      status = probe(http, t, &is_good);
  }
  if (status != CONIC_OK || is_good)
    return status;
  return conic_fail(http->base.context, fates[t->fault].status, "%s: cannot read: %s", http->url, t->reason);
}

static conic_status start(http_ranges *http, const char *url) {
  conic_context *context = http->base.context;
  size_t length = strlen(url) + 1;
  http->url = conic_memory_allocate(context, length, 1);
  if (!http->url)
    return CONIC_ERROR_MEMORY;
  memcpy(http->url, url, length);
  http->is_global = curl_global_init(CURL_GLOBAL_DEFAULT) == CURLE_OK;
  http->multi = http->is_global ? curl_multi_init() : NULL;
  int is_up = http->multi != NULL;
  for (int i = 0; i < http->options.n_connections && is_up; i++)
    is_up = set_up(http, &http->transfers[i]);
  return is_up ? CONIC_OK : conic_fail(context, CONIC_ERROR_MEMORY, "%s: libcurl cannot start", url);
}

conic_status conic_ranges_open_url(conic_context *context, const char *url, const conic_ranges_options *options,
                                   conic_ranges **ranges) {
  http_ranges *http = conic_memory_allocate_zeroed(context, 1, sizeof *http);
  if (!http)
    return CONIC_ERROR_MEMORY;
  http->base.context = context;
  http->base.backend = &backend;
  http->options = *options;
  if (http->options.n_connections < 1 || http->options.n_connections > MOST_CONNECTIONS)
    http->options.n_connections = http->options.n_connections < 1 ? 1 : MOST_CONNECTIONS;
  conic_status status = start(http, url);
  if (status == CONIC_OK)
    status = look_at_file(http);
  if (status != CONIC_OK) {
    close_url(&http->base);
    return status;
  }
  *ranges = &http->base;
  return CONIC_OK;
}

#endif
