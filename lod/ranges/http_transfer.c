#include "lod/ranges/http_transfer.h"

#ifdef CONIC_HAVE_CURL

#include <limits.h>
#include <stdio.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/memory.h"

enum { LEAST_BYTES_PER_SECOND = 8192, MOST_REDIRECTS = 5 };

const struct conic_http_fate conic_http_fates[] = {[CONIC_HTTP_SILENCE] = {CONIC_ERROR_IO, INT_MAX},
                                                   [CONIC_HTTP_WRONG] = {CONIC_ERROR_INPUT, 1},
                                                   [CONIC_HTTP_LASTING] = {CONIC_ERROR_INPUT, 0},
                                                   [CONIC_HTTP_BOUND] = {CONIC_ERROR_IO, 0}};

void conic_http_let_go(conic_http_ranges *http, conic_http_body *held) {
  if (!held || --held->n_holders > 0)
    return;
  conic_memory_release_these(http->base.context, held->bytes, held);
}

/* Keeps bytes; room grows with it, and not with what a server claims. Of several parts, which are answered one
 * by one, nothing may move: they are few bytes together. */
static int keep_bytes(conic_http_transfer *t, const void *data, size_t n) {
  conic_http_body *to = t->body;
  if (n > to->room - to->n) {
    size_t room = 2 * to->room + n + CONIC_HTTP_PROBE_BYTES;
    room = room < t->n_expected && t->n_parts < 2 ? room : t->n_expected;
    if (conic_memory_grow(t->owner->base.context, &to->bytes, to->n, room, 1) != CONIC_OK)
      return 0;
    to->room = room;
  }
  memcpy(to->bytes + to->n, data, n);
  to->n += n;
  return 1;
}

/* How long the server took to answer at all, at best. */
static void note_arrival(conic_http_transfer *t, size_t n) {
  double now = conic_seconds_now();
  if (t->body->n == t->n_here && !(t->owner->latency_s < now - t->came_s))
    t->owner->latency_s = now - t->came_s;
  t->came_s = now;
  t->owner->base.n_received += n;
  t->came_n = t->owner->base.n_received;
}

static int refuse_answer(conic_http_transfer *t, conic_http_fault why, const char *reason) {
  snprintf(t->reason, sizeof t->reason, "%s", reason);
  t->fault = why;
  return 0;
}

/* The whole file, of a server that knows no ranges. */
static int accept_whole(conic_http_transfer *t) {
  conic_http_ranges *http = t->owner;
  uint64_t most = http->options.most_whole_bytes;
  if (t->response.has_length && t->response.length > most) {
    snprintf(t->reason, sizeof t->reason,
             "the server sends no ranges, and the whole file of %llu MiB is over the memory bound",
             (unsigned long long)(t->response.length >> 20));
    t->fault = CONIC_HTTP_BOUND;
    return 0;
  }
  t->is_whole = 1;
  t->n_expected = (size_t)(t->response.has_length ? t->response.length : most);
  return 1;
}

static int refuse_status(conic_http_transfer *t, int status) {
  snprintf(t->reason, sizeof t->reason, "the server answers with status %d", status);
  if (status >= 500 || status == 408 || status == 429)
    t->fault = CONIC_HTTP_SILENCE;
  else
    t->fault = status >= 400 ? CONIC_HTTP_LASTING : CONIC_HTTP_WRONG;
  return 0;
}

/* All of a file beside the first. */
static int accept_beside(conic_http_transfer *t) {
  if (t->response.status != 200)
    return refuse_status(t, t->response.status);
  if (t->response.has_length && t->response.length > t->n_expected)
    return refuse_answer(t, CONIC_HTTP_WRONG, "the file is larger than what it is to hold can be");
  t->is_whole = 1;
  if (t->response.has_length)
    t->n_expected = (size_t)t->response.length;
  return 1;
}

/* Whether the response that begins is what was asked for. */
static int accept_response(conic_http_transfer *t) {
  const conic_http_response *r = &t->response;
  conic_http_ranges *http = t->owner;
  if (r->is_packed)
    return refuse_answer(t, CONIC_HTTP_WRONG, "the server sends the file compressed, which nobody asked for");
  if (t->is_beside)
    return accept_beside(t);
  if (t->is_probe && r->status == 200)
    return accept_whole(t);
  if (r->status == 200)
    return refuse_answer(t, CONIC_HTTP_WRONG, "the server sends the whole file for a range");
  if (r->status != 206)
    return refuse_status(t, r->status);
  if (!r->has_range)
    return refuse_answer(t, CONIC_HTTP_WRONG, "the server does not say which range it sends");
  if (t->is_probe) {
    http->base.size = r->size;
    t->n_expected = r->size < CONIC_HTTP_PROBE_BYTES ? (size_t)r->size : CONIC_HTTP_PROBE_BYTES;
    memcpy(http->tag, r->tag, sizeof http->tag);
  }
  if (r->size != http->base.size || (r->tag[0] && http->tag[0] && strcmp(r->tag, http->tag) != 0))
    return refuse_answer(t, CONIC_HTTP_LASTING, "the file on the server has changed");
  if (r->first != t->offset + t->n_here || r->last != t->offset + t->n_expected - 1)
    return refuse_answer(t, CONIC_HTTP_WRONG, "the server sends another range than was asked for");
  if (r->has_length && r->length != t->n_expected - t->n_here)
    return refuse_answer(t, CONIC_HTTP_WRONG,
                         r->length > t->n_expected - t->n_here ? "the server sends more than was asked for"
                                                               : "the server sends less than was asked for");
  return 1;
}

static size_t on_header(char *line, size_t one, size_t n, void *cookie) {
  conic_http_transfer *t = cookie;
  if (!conic_http_header(&t->response, line, one * n)) {
    refuse_answer(t, CONIC_HTTP_WRONG, "the server's headers do not end");
    return 0;
  }
  return one * n;
}

static size_t on_body(char *data, size_t one, size_t n, void *cookie) {
  conic_http_transfer *t = cookie;
  n *= one;
  if (t->body->n == t->n_here && !accept_response(t))
    return 0;
  if (n > t->n_expected - t->body->n) {
    refuse_answer(t, t->is_whole && !t->is_beside ? CONIC_HTTP_BOUND : CONIC_HTTP_WRONG,
                  t->is_whole && !t->is_beside && !t->response.has_length
                      ? "the server sends no ranges, and the whole file is over the memory bound"
                      : "the server sends more than was asked for");
    return 0;
  }
  note_arrival(t, n);
  if (!keep_bytes(t, data, n)) {
    refuse_answer(t, CONIC_HTTP_BOUND, "out of memory");
    return 0;
  }
  return n;
}

int conic_http_transfer_set_up(conic_http_ranges *http, conic_http_transfer *t) {
  const conic_ranges_options *o = &http->options;
  CURL *easy = t->easy = http->curl->easy_init();
  t->owner = http;
  if (!easy)
    return 0;
  CURLcode (*set)(CURL *, CURLoption, ...) = http->curl->easy_setopt;
  int failed = set(easy, CURLOPT_URL, http->url) != CURLE_OK;
#if LIBCURL_VERSION_NUM >= 0x075500
  failed |= set(easy, CURLOPT_PROTOCOLS_STR, "http,https") != CURLE_OK;
  failed |= set(easy, CURLOPT_REDIR_PROTOCOLS_STR, "http,https") != CURLE_OK;
#else
  failed |= set(easy, CURLOPT_PROTOCOLS, CURLPROTO_HTTP | CURLPROTO_HTTPS) != CURLE_OK;
  failed |= set(easy, CURLOPT_REDIR_PROTOCOLS, CURLPROTO_HTTP | CURLPROTO_HTTPS) != CURLE_OK;
#endif
#if LIBCURL_VERSION_NUM >= 0x075700 /* else giving up waits for a name server that does not answer */
  failed |= set(easy, CURLOPT_QUICK_EXIT, 1L) != CURLE_OK;
#endif
  failed |= set(easy, CURLOPT_HTTP_VERSION, (long)CURL_HTTP_VERSION_1_1) != CURLE_OK;
  failed |= set(easy, CURLOPT_NOSIGNAL, 1L) != CURLE_OK;
  failed |= set(easy, CURLOPT_FOLLOWLOCATION, 1L) != CURLE_OK;
  failed |= set(easy, CURLOPT_MAXREDIRS, (long)MOST_REDIRECTS) != CURLE_OK;
  failed |= set(easy, CURLOPT_CONNECTTIMEOUT_MS, (long)(1e3 * o->connect_seconds)) != CURLE_OK;
  failed |= set(easy, CURLOPT_HEADERFUNCTION, on_header) != CURLE_OK;
  failed |= set(easy, CURLOPT_HEADERDATA, t) != CURLE_OK;
  failed |= set(easy, CURLOPT_WRITEFUNCTION, on_body) != CURLE_OK;
  failed |= set(easy, CURLOPT_WRITEDATA, t) != CURLE_OK;
  failed |= set(easy, CURLOPT_ERRORBUFFER, t->words) != CURLE_OK;
  failed |= set(easy, CURLOPT_PRIVATE, t) != CURLE_OK;
  return !failed;
}

conic_status conic_http_transfer_begin(conic_http_transfer *t) {
  conic_http_ranges *http = t->owner;
  char range[64];
  t->body = conic_memory_allocate_zeroed(http->base.context, 1, sizeof *t->body);
  if (!t->body)
    return CONIC_ERROR_MEMORY;
  t->body->n_holders = 1;
  memset(&t->response, 0, sizeof t->response);
  t->reason[0] = t->words[0] = '\0';
  t->is_whole = 0;
  t->n_here = t->is_beside || t->is_probe || t->offset > http->head->n ? 0 : http->head->n - (size_t)t->offset;
  snprintf(range, sizeof range, "%llu-%llu", (unsigned long long)t->offset + t->n_here,
           (unsigned long long)(t->offset + t->n_expected - 1));
  if ((t->n_here > 0 && !keep_bytes(t, http->head->bytes + t->offset, t->n_here)) ||
      http->curl->easy_setopt(t->easy, CURLOPT_RANGE, t->is_beside ? NULL : range) != CURLE_OK ||
      http->curl->easy_setopt(t->easy, CURLOPT_URL, t->is_beside ? t->own_url : http->url) != CURLE_OK ||
      http->curl->multi_add_handle(http->multi, t->easy) != CURLM_OK) {
    conic_http_let_go(http, t->body);
    t->body = NULL;
    return CONIC_ERROR_MEMORY;
  }
  t->is_busy = 1;
  t->came_s = t->window_s = conic_seconds_now();
  t->window_n = t->n_here;
  t->n_answered = 0;
  t->came_n = http->base.n_received;
  return CONIC_OK;
}

void conic_http_transfer_end(conic_http_transfer *t) {
  if (!t->is_busy)
    return;
  t->owner->curl->multi_remove_handle(t->owner->multi, t->easy);
  conic_http_let_go(t->owner, t->body);
  t->body = NULL;
  t->is_busy = 0;
}

int conic_http_transfer_is_stalled(conic_http_transfer *t) {
  double now = conic_seconds_now(), elapsed = now - t->window_s;
  if (elapsed < t->owner->options.stall_seconds)
    return 0;
  if ((double)(t->body->n - t->window_n) < LEAST_BYTES_PER_SECOND * elapsed) {
    refuse_answer(t, CONIC_HTTP_SILENCE, "the server sends nothing more");
    return 1;
  }
  t->window_s = now;
  t->window_n = t->body->n;
  return 0;
}

/* libcurl's reason, unless there is one already. */
static int refuse_code(conic_http_transfer *t, CURLcode code) {
  long system_error = 0;
  int redirects = t->response.status >= 300 && t->response.status < 400;
  if (t->reason[0])
    return 0;
  if (t->body->n == t->n_here && t->response.n_bytes > 0 &&
      code == CURLE_OUT_OF_MEMORY) /* of a line's room, not of memory */
    return refuse_answer(t, CONIC_HTTP_WRONG, "the server's headers do not end");
  if (code == CURLE_UNSUPPORTED_PROTOCOL && !redirects)
    return refuse_answer(t, CONIC_HTTP_WRONG,
                         "the server sends what is no answer, or more than it said in the one before");
  if (t->owner->curl->easy_getinfo(t->easy, CURLINFO_OS_ERRNO, &system_error) != CURLE_OK)
    system_error = 0;
  int is_lasting = code == CURLE_TOO_MANY_REDIRECTS || code == CURLE_UNSUPPORTED_PROTOCOL ||
                   code == CURLE_URL_MALFORMAT || code == CURLE_PEER_FAILED_VERIFICATION;
  int is_wrong =
      code == CURLE_WEIRD_SERVER_REPLY || code == CURLE_WRITE_ERROR || (code == CURLE_RECV_ERROR && system_error == 0);
  return refuse_answer(t,
                       is_lasting ? CONIC_HTTP_LASTING
                       : is_wrong ? CONIC_HTTP_WRONG
                                  : CONIC_HTTP_SILENCE,
                       t->words[0] ? t->words : t->owner->curl->easy_strerror(code));
}

int conic_http_transfer_is_complete(conic_http_transfer *t, CURLcode code) {
  if (code != CURLE_OK)
    return refuse_code(t, code);
  if (t->body->n == t->n_here && !accept_response(t)) /* it had no body, so nobody has looked at it yet */
    return 0;
  if (t->is_whole ? t->response.has_length && t->body->n != t->n_expected : t->body->n != t->n_expected)
    return refuse_answer(t, CONIC_HTTP_SILENCE, "the server ends before all was sent");
  return 1;
}

#endif
