/* A request for a part of a file on a web server, and its answer as it comes. */
#pragma once

#ifdef CONIC_HAVE_CURL

#include <pthread.h>
#include <stdatomic.h>

#include "lod/ranges/curl_bridge.h"
#include "lod/ranges/http_response.h"
#include "lod/ranges/ranges_backend.h"

enum {
  CONIC_HTTP_PROBE_BYTES = 1 << 16, /* the first request's: it says how large the file is, and holds its beginning */
  CONIC_HTTP_CONNECTIONS = 16       /* at most */
};

/* Bytes that arrived; the answers in them share them. */
typedef struct conic_http_body {
  unsigned char *bytes;
  size_t n, room;
  int n_holders;
} conic_http_body;

/* Why a request failed. `conic_http_fates` says what comes of it. */
typedef enum conic_http_fault {
  CONIC_HTTP_SILENCE, /* the server is not there, slow or busy, or ends early: there may be more in a while */
  CONIC_HTTP_WRONG,   /* what it sends is not what was asked for */
  CONIC_HTTP_LASTING, /* nor will it ever be */
  CONIC_HTTP_BOUND    /* it is more than there is memory for */
} conic_http_fault;

typedef struct conic_http_transfer {
  struct conic_http_ranges *owner;
  CURL *easy;
  int is_busy;
  int is_probe, is_whole; /* it began as the first request; the server sends the whole file */
  int is_beside;          /* it is for the whole of another file, of n_expected bytes at most */
  char *own_url;          /* that file's */
  uint64_t offset;
  size_t n_expected;
  size_t n_here; /* of these, so many that came with the first request, and are not asked for */
  conic_http_body *body;
  conic_queued_range *parts;
  size_t n_parts, parts_room, n_answered;
  conic_http_response response;
  double came_s;          /* when it began, or when bytes came last, */
  uint64_t came_n;        /* and what all requests together had brought by then */
  double window_s;        /* when it was last checked whether it stalls */
  size_t window_n;        /* bytes that it had then */
  conic_http_fault fault; /* of its failure, if `reason`, which describes it, is not empty */
  char reason[CURL_ERROR_SIZE];
  char words[CURL_ERROR_SIZE]; /* libcurl's own */
} conic_http_transfer;

/* An answer that waits to be fetched. */
typedef struct conic_http_ready {
  conic_range_answer answer;
  char reason[CURL_ERROR_SIZE];
} conic_http_ready;

typedef struct conic_http_ranges {
  conic_ranges base;
  conic_ranges_options options;
  char *url;
  const conic_curl_bridge_functions *curl;
  CURLM *multi;
  int is_global; /* curl_global_init was called */
  conic_http_transfer transfers[CONIC_HTTP_CONNECTIONS];
  double latency_s, bytes_a_second; /* of the link, as measured; the least latency */
  double measured_s;                /* since then the bytes beyond measured_n come; 0: none are on their way */
  uint64_t measured_n;
  double beside_bytes;   /* what a file beside the first has, on average of late */
  conic_http_body *head; /* the file's beginning, or all of it, */
  int is_cut;            /* or what there was in time of a server that sends no ranges */
  char tag[CONIC_HTTP_TAG];
  conic_http_ready *ready;
  size_t first_ready, n_ready, ready_room; /* those from first_ready on wait */
  pthread_t pump;                          /* lets answers come while the caller does something else */
  atomic_int is_to_halt;                   /* tells the pump to end */
  int n_failures;                          /* of requests, since one succeeded */
  int is_dead;                             /* the server is given up, until nothing is asked for any more */
  conic_http_fault fault;                  /* why it was given up */
  char reason[CURL_ERROR_SIZE];            /* of the last answer, or of the server's end */
} conic_http_ranges;

/* By fault. */
extern const struct conic_http_fate {
  conic_status status;
  int most_repeats; /* of the request, if the options do not say less */
} conic_http_fates[];

/* Returns 0 where libcurl cannot. */
int conic_http_transfer_set_up(conic_http_ranges *http, conic_http_transfer *t);

/* Sends the transfer's request. On failure nothing is under way. */
conic_status conic_http_transfer_begin(conic_http_transfer *t);
void conic_http_transfer_end(conic_http_transfer *t);

/* Whether hardly anything came for long. libcurl's own check takes some seconds more. */
int conic_http_transfer_is_stalled(conic_http_transfer *t);

/* Whether the transfer brought what it should. If not, its reason says why. */
int conic_http_transfer_is_complete(conic_http_transfer *t, CURLcode code);

/* Gives up one hold on bytes that arrived. The last hold releases them. */
void conic_http_let_go(conic_http_ranges *http, conic_http_body *held);

#endif
