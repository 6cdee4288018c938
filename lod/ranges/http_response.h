/* What the headers of a web server's response say about the file. */
#pragma once

#include "core/base/base.h"

#define CONIC_HTTP_TAG 96

typedef struct conic_http_response {
  int status;     /* 206 …; of the last of several responses, after redirections */
  size_t n_bytes; /* of all headers so far */
  int has_range;  /* Content-Range: bytes first-last/size */
  uint64_t first, last, size;
  int has_length; /* Content-Length */
  uint64_t length;
  int is_packed;            /* Content-Encoding: other than identity */
  char tag[CONIC_HTTP_TAG]; /* ETag; empty where there is none, or it is too long or weak */
} conic_http_response;

/* Takes one header line, its end included. 0 where there are more than anyone needs. */
int conic_http_header(conic_http_response *response, const char *line, size_t n_bytes);
