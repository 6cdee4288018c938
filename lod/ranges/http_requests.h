/* Which ranges a server is asked for next, in which requests, and what becomes of their answers. */
#pragma once

#include "lod/ranges/http_transfer.h"

#ifdef CONIC_HAVE_CURL

/* Sends requests over free connections, as many as keep the link busy. */
void conic_http_send_requests(conic_http_ranges *http);

/* Answers what has come, asks again for what failed, and measures the link. */
void conic_http_take_finished(conic_http_ranges *http);

/* The server is given up: so is all that waits. */
void conic_http_give_up_all(conic_http_ranges *http);

/* Whether nothing waits and nothing is on its way. */
int conic_http_is_idle(const conic_http_ranges *http);

/* How often a request that failed so is sent again. */
int conic_http_most_repeats(const conic_http_ranges *http, conic_http_fault why);

#endif
