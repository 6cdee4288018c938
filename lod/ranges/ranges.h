/* Bytes of a file, asked for by ranges and handed over as they come, from a memory map or from a web server (HTTP/1.1
 * range requests). Both answer in the same way, so that nothing above knows where a file lies.
 *
 * Transfers go on within conic_ranges_next, several at a time, and after conic_ranges_go_on; otherwise nothing happens
 * between the calls. One thread at a time. */
#pragma once

#include "core/base/base.h"

typedef struct conic_ranges conic_ranges;

typedef struct conic_ranges_options {
  double connect_seconds;    /* a server that is not reached within these is tried again */
  double stall_seconds;      /* so is one that sends under 8 KiB/s for so long */
  int n_retries;             /* tries after the first, each after a longer pause, before a range is given up */
  double pause_seconds;      /* the first pause; each is twice the one before */
  int n_connections;         /* at a time */
  uint64_t most_whole_bytes; /* up to this size, a file is fetched as a whole from a server without ranges */
  double until_s;            /* when opening ends, by conic_seconds_now; infinite: it takes as long as it takes */
} conic_ranges_options;

/* 10 s, 15 s, 4 retries from 0.2 s on, 4 connections, 512 MiB, no end. */
void conic_ranges_options_init(conic_ranges_options *options);

/* Whether a name is a URL. */
int conic_ranges_is_url(const char *name);

/* Opens a path, or an http:// or https:// URL, and finds out its size. "-" is standard input. Of a server that sends
 * whole files only, what has come when opening is to end is kept, and ranges beyond are given up. On success the caller
 * owns *ranges. Errors: INPUT (it is not there, or not to be had, or the server answers wrongly), IO (the network or
 * the server fails, or not in time), UNSUPPORTED (a URL, and this build has no libcurl), MEMORY, CANCELLED. */
conic_status conic_ranges_open(conic_context *context, const char *name, const conic_ranges_options *options,
                               conic_ranges **ranges);

/* Gives up what is under way. Null is allowed. */
void conic_ranges_close(conic_ranges *ranges);

uint64_t conic_ranges_size(const conic_ranges *ranges);

/* Bytes that came over the network. */
uint64_t conic_ranges_received(const conic_ranges *ranges);

enum { CONIC_RANGE_FILE = 56 };

typedef struct conic_range {
  uint64_t offset;
  size_t n_bytes;
  uint64_t priority;           /* the lowest is asked for first; neighbours in this order that lie together, as one */
  uint32_t id;                 /* the caller's */
  char file[CONIC_RANGE_FILE]; /* empty: the file that was opened; else the name of one beside it, of n_bytes at most,
                                  all of which is asked for */
} conic_range;

/* Whether a range lies within the file, or is of another. */
int conic_ranges_holds(const conic_ranges *ranges, const conic_range *range);

/* Asks for a range, which must lie within the file, or for the whole of a file beside it. Errors: ARGUMENT, MEMORY. */
conic_status conic_ranges_request(conic_ranges *ranges, const conic_range *range);

typedef struct conic_range_answer {
  uint32_t id;
  conic_status status;        /* CONIC_OK; given up: IO, what did not come; INPUT, what came and was wrong */
  const unsigned char *bytes; /* as many as were asked for, or all of the file */
  size_t n_bytes;
  const char *reason; /* where given up: why, in a few words; until the next call */
  void *held;         /* private */
} conic_range_answer;

/* Takes the next answer, in any order, and returns 1. 0: none came within so many seconds, or nothing is asked for.
 * With seconds below 0 no request is sent any more: what has come is taken. */
int conic_ranges_next(conic_ranges *ranges, double wait_seconds, conic_range_answer *answer);

/* Gives an answer's bytes back, before the ranges are closed. */
void conic_ranges_release(conic_ranges *ranges, conic_range_answer *answer);

/* Lets what was asked for come while the caller does something else, until any other function is called. */
void conic_ranges_go_on(conic_ranges *ranges);

/* Forgets all that was asked for and not yet answered. */
void conic_ranges_cancel(conic_ranges *ranges);

/* How many ranges were asked for and not yet answered. */
size_t conic_ranges_pending(const conic_ranges *ranges);

/* Asks for a range and waits for it, until `until_s` by conic_seconds_now. Nothing else may be pending. `name` is for
 * messages. The caller releases *bytes. Errors: INPUT, IO, MEMORY, CANCELLED. */
conic_status conic_ranges_read(conic_ranges *ranges, const char *name, const conic_range *range, double until_s,
                               unsigned char **bytes, size_t *n_bytes);

/* Makes the name of `file` in the folder of `name`, which may be a URL, or is a folder where it ends with a slash. The
 * caller releases *beside. Errors: MEMORY. */
conic_status conic_ranges_name_beside(conic_context *context, const char *name, const char *file, char **beside);
