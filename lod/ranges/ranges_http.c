/* Ranges of a file on a web server, by libcurl's multi interface: many requests at once. */

#ifndef CONIC_HAVE_CURL

#include "core/base/message.h"
#include "lod/ranges/ranges_backend.h"

conic_status conic_ranges_open_url(conic_context *context, const char *url, const conic_ranges_options *options,
                                   conic_ranges **ranges) {
  (void)options;
  (void)ranges;
  return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "%s: this build reads no URLs: it is without libcurl", url);
}

#else

#include "core/base/machine.h"
#include "lod/ranges/http_requests.h"

static int take_ready(conic_http_ranges *http, conic_range_answer *answer) {
  if (http->first_ready == http->n_ready)
    return 0;
  conic_http_ready *ready = &http->ready[http->first_ready++];
  *answer = ready->answer;
  if (answer->status != CONIC_OK) {
    memmove(http->reason, ready->reason, sizeof http->reason);
    answer->reason = http->reason;
  }
  return 1;
}

static int next(conic_ranges *ranges, double wait_seconds, conic_range_answer *answer) {
  conic_http_ranges *http = (conic_http_ranges *)ranges;
  double until = conic_seconds_now() + wait_seconds;
  for (;;) {
    if (http->is_dead)
      conic_http_give_up_all(http);
    else if (wait_seconds >= 0.0 || http->is_cut)
      conic_http_send_requests(http);
    conic_http_take_finished(http);
    if (take_ready(http, answer)) {
      http->is_dead &= ranges->n_pending > 1;
      return 1;
    }
    double left = until - conic_seconds_now();
    if (!(left > 0.0) || conic_http_is_idle(http))
      return 0;
    left = left < 0.1 ? left : 0.1;
    http->curl->multi_poll(http->multi, NULL, 0, 1 + (int)(1e3 * left), NULL);
  }
}

static void release_answer(conic_ranges *ranges, conic_range_answer *answer) {
  conic_http_let_go((conic_http_ranges *)ranges, answer->held);
}

static void cancel(conic_ranges *ranges) {
  conic_http_ranges *http = (conic_http_ranges *)ranges;
  for (int i = 0; i < CONIC_HTTP_CONNECTIONS; i++)
    conic_http_transfer_end(&http->transfers[i]);
  for (; http->first_ready < http->n_ready; http->first_ready++)
    conic_http_let_go(http, http->ready[http->first_ready].answer.held);
  http->is_dead = 0;
}

static void close_url(conic_ranges *ranges) {
  conic_http_ranges *http = (conic_http_ranges *)ranges;
  conic_context *context = ranges->context;
  cancel(ranges);
  for (int i = 0; i < CONIC_HTTP_CONNECTIONS; i++) {
    if (http->transfers[i].easy)
      http->curl->easy_cleanup(http->transfers[i].easy);
    conic_memory_release_these(context, http->transfers[i].parts, http->transfers[i].own_url);
  }
  if (http->multi)
    http->curl->multi_cleanup(http->multi);
  if (http->is_global)
    http->curl->global_cleanup();
  conic_http_let_go(http, http->head);
  conic_memory_release_these(context, http->ready, http->url, http);
}

static void *pump_transfers(void *data) {
  conic_http_ranges *http = data;
  while (!atomic_load(&http->is_to_halt) && !http->is_dead && !conic_http_is_idle(http)) {
    conic_http_send_requests(http);
    conic_http_take_finished(http);
    if (!conic_http_is_idle(http))
      http->curl->multi_poll(http->multi, NULL, 0, 20, NULL);
  }
  return NULL;
}

static int start_pump(conic_ranges *ranges) {
  conic_http_ranges *http = (conic_http_ranges *)ranges;
  atomic_store(&http->is_to_halt, 0);
  return pthread_create(&http->pump, NULL, pump_transfers, http) == 0;
}

static void halt(conic_ranges *ranges) {
  conic_http_ranges *http = (conic_http_ranges *)ranges;
  atomic_store(&http->is_to_halt, 1);
#if LIBCURL_VERSION_NUM >= 0x074400
  http->curl->multi_wakeup(http->multi);
#endif
  pthread_join(http->pump, NULL);
}

static const conic_ranges_backend backend = {next, release_answer, cancel, start_pump, halt, close_url};

/* Whether opening may go on; waits a little for what comes. */
static conic_status go_on_opening(conic_http_ranges *http, int wait_ms) {
  conic_status status = conic_progress(http->base.context, "connect", 0.0);
  double left = http->options.until_s - conic_seconds_now();
  if (status != CONIC_OK)
    return status;
  if (!(left > 0.0))
    return conic_fail(http->base.context, CONIC_ERROR_IO, "%s: cannot read: nothing came in time", http->url);
  wait_ms = left < 1e-3 * wait_ms ? 1 + (int)(1e3 * left) : wait_ms;
  http->curl->multi_poll(http->multi, NULL, 0, wait_ms, NULL);
  return CONIC_OK;
}

/* The first request, once. */
static conic_status probe(conic_http_ranges *http, conic_http_transfer *t, int *is_good) {
  conic_status status;
  t->is_probe = 1;
  t->offset = 0;
  t->n_expected = CONIC_HTTP_PROBE_BYTES;
  *is_good = 0;
  if (conic_http_transfer_begin(t) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (;;) {
    CURLMsg *message;
    int n_running = 0, n_left;
    http->curl->multi_perform(http->multi, &n_running);
    message = http->curl->multi_info_read(http->multi, &n_left);
    if (message && message->msg == CURLMSG_DONE) {
      *is_good = conic_http_transfer_is_complete(t, message->data.result);
      status = CONIC_OK;
      break;
    }
    http->is_cut = t->is_whole && t->response.has_length && conic_seconds_now() >= http->options.until_s;
    *is_good = http->is_cut;
    status = http->is_cut ? CONIC_OK : go_on_opening(http, 100);
    if (http->is_cut || status != CONIC_OK || conic_http_transfer_is_stalled(t))
      break;
  }
  if (*is_good) {
    double elapsed = t->came_s - (t->window_s + http->latency_s);
    http->bytes_a_second = (double)t->body->n / (elapsed > 1e-3 ? elapsed : 1e-3);
    if (t->is_whole)
      http->base.size = http->is_cut ? t->response.length : t->body->n;
    http->head = t->body;
    http->head->n_holders++;
  }
  conic_http_transfer_end(t);
  t->is_probe = 0;
  return status;
}

static conic_status pause_between(conic_http_ranges *http, double seconds) {
  double until = conic_seconds_now() + seconds;
  conic_status status = CONIC_OK;
  while (conic_seconds_now() < until && status == CONIC_OK)
    status = go_on_opening(http, 50);
  return status;
}

/* Finds the file's size, and takes its beginning along. */
static conic_status look_at_file(conic_http_ranges *http) {
  conic_http_transfer *t = &http->transfers[0];
  double pause = http->options.pause_seconds;
  int is_good = 0;
  conic_status status = probe(http, t, &is_good);
  for (int i = 0; status == CONIC_OK && !is_good && i < conic_http_most_repeats(http, t->fault); i++, pause *= 2.0) {
    status = pause_between(http, pause);
    if (status == CONIC_OK)
      status = probe(http, t, &is_good);
  }
  if (status != CONIC_OK || is_good)
    return status;
  return conic_fail(http->base.context, conic_http_fates[t->fault].status, "%s: cannot read: %s", http->url, t->reason);
}

#ifdef _WIN32 /* where nothing is loaded late */
extern const conic_curl_bridge_functions conic_curl_bridge;

static const conic_curl_bridge_functions *load_curl(char message[CONIC_MODULE_MESSAGE]) {
  message[0] = 0;
  return &conic_curl_bridge;
}
#else
static const conic_curl_bridge_functions *load_curl(char message[CONIC_MODULE_MESSAGE]) {
  return conic_module_load("conic-curl.so", "conic_curl_bridge", message);
}
#endif

static conic_status start(conic_http_ranges *http, const char *url) {
  conic_context *context = http->base.context;
  http->url = conic_memory_copy_text(context, url);
  if (!http->url)
    return CONIC_ERROR_MEMORY;
  char message[CONIC_MODULE_MESSAGE];
  http->curl = load_curl(message);
  if (!http->curl)
    return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "%s: libcurl cannot be loaded: %s", url, message);
  http->is_global = http->curl->global_init(CURL_GLOBAL_DEFAULT) == CURLE_OK;
  http->multi = http->is_global ? http->curl->multi_init() : NULL;
  int is_up = http->multi != NULL;
  for (int i = 0; i < http->options.n_connections && is_up; i++)
    is_up = conic_http_transfer_set_up(http, &http->transfers[i]);
  return is_up ? CONIC_OK : conic_fail(context, CONIC_ERROR_MEMORY, "%s: libcurl cannot start", url);
}

conic_status conic_ranges_open_url(conic_context *context, const char *url, const conic_ranges_options *options,
                                   conic_ranges **ranges) {
  conic_http_ranges *http = conic_memory_allocate_zeroed(context, 1, sizeof *http);
  if (!http)
    return CONIC_ERROR_MEMORY;
  http->base.context = context;
  http->base.backend = &backend;
  http->options = *options;
  http->latency_s = HUGE_VAL;
  http->beside_bytes = CONIC_HTTP_PROBE_BYTES;
  if (http->options.n_connections < 1 || http->options.n_connections > CONIC_HTTP_CONNECTIONS)
    http->options.n_connections = http->options.n_connections < 1 ? 1 : CONIC_HTTP_CONNECTIONS;
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
