/* A web server within a test, on the loopback: a good one, or one that misbehaves as the first part of the path says.
 * Its first answer is always good, unless said otherwise below, so that what comes later is what is tested. */
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { HTTP_MENDED = 4096 };

typedef struct http_server {
  int listener, port;
  const unsigned char *bytes;
  size_t n_bytes;
  pthread_t thread;
  atomic_int n_requests, n_connections, n_busy, is_stopping;
  atomic_char is_mended[HTTP_MENDED]; /* a place that was wrong once */
  atomic_int n_good;                  /* so many answers are good before it misbehaves */
  long long link_bytes_a_second;      /* of a link: 12.5 MB unless set, */
  int link_ms;                        /* and how long it takes to answer: 20 ms */
  atomic_llong link_free_us;          /* when it has sent what it was given so far */
} http_server;

typedef struct http_connection {
  http_server *server;
  int socket;
} http_connection;

typedef struct http_request {
  char mode[32];
  int has_range;
  size_t first, last;
} http_request;

static inline void http_pause(int milliseconds) {
  struct timespec time = {milliseconds / 1000, (long)(milliseconds % 1000) * 1000000L};
  nanosleep(&time, NULL);
}

/* 0 where the other side is gone. */
static inline int http_send(int socket, const void *bytes, size_t n) {
  const char *from = bytes;
  while (n > 0) {
    ssize_t sent = send(socket, from, n, MSG_NOSIGNAL);
    if (sent <= 0)
      return 0;
    from += sent;
    n -= (size_t)sent;
  }
  return 1;
}

static inline int http_say(int socket, const char *text) {
  return http_send(socket, text, strlen(text));
}

/* Reads a request up to its empty line: 0 at the connection's end. */
static inline int http_receive(const http_server *server, int socket, http_request *request) {
  char text[4096];
  size_t n = 0;
  memset(request, 0, sizeof *request);
  while (n < sizeof text - 1) {
    ssize_t got = recv(socket, text + n, 1, 0);
    if (got <= 0)
      return 0;
    n++;
    text[n] = '\0';
    if (n >= 4 && strcmp(text + n - 4, "\r\n\r\n") == 0)
      break;
  }
  if (sscanf(text, "GET /%31[^/ ]", request->mode) != 1)
    return 0;
  static const char before_range[] = "Range: bytes=";
  const char *range = strstr(text, before_range);
  if (!range)
    return 1;
  char *end = NULL;
  unsigned long long first = strtoull(range + sizeof before_range - 1, &end, 10), last = 0;
  request->has_range = *end == '-' && end[1] >= '0' && end[1] <= '9';
  if (request->has_range)
    last = strtoull(end + 1, NULL, 10);
  request->first = (size_t)first;
  request->last = last < server->n_bytes ? (size_t)last : server->n_bytes - 1;
  return 1;
}

/* The head of an answer with `length` bytes; `shift` is how far the range that it names is off. */
static inline int http_head(const http_server *server, int socket, const http_request *r, size_t length, int shift,
                            const char *tag) {
  char head[512];
  snprintf(head, sizeof head,
           "HTTP/1.1 206 Partial Content\r\nContent-Length: %zu\r\nContent-Range: bytes %zu-%zu/%zu\r\nETag: "
           "\"%s\"\r\n\r\n",
           length, r->first + (size_t)shift, r->last + (size_t)shift, server->n_bytes, tag);
  return http_say(socket, head);
}

static inline int http_answer_well(const http_server *server, int socket, const http_request *r) {
  size_t n = r->last - r->first + 1;
  return http_head(server, socket, r, n, 0, "a") && http_send(socket, server->bytes + r->first, n);
}

/* The whole file, or the first of so many parts of it. */
static inline int http_answer_whole(const http_server *server, int socket, int has_length, size_t parts) {
  char head[128];
  snprintf(head, sizeof head, "HTTP/1.1 200 OK\r\nContent-Length: %zu\r\n\r\n", server->n_bytes);
  http_say(socket, has_length ? head : "HTTP/1.1 200 OK\r\nConnection: close\r\n\r\n");
  return http_send(socket, server->bytes, server->n_bytes / parts) && has_length;
}

/* Repeats a text until nobody listens. */
static inline int http_repeat(const http_server *server, int socket, const char *text, int milliseconds) {
  while (!atomic_load(&server->is_stopping) && http_say(socket, text))
    if (milliseconds)
      http_pause(milliseconds);
  return 0;
}

/* Nothing more, until the other side has gone or the test ends. */
static inline int http_hang(const http_server *server, int socket) {
  char byte;
  while (!atomic_load(&server->is_stopping)) {
    ssize_t n = recv(socket, &byte, 1, MSG_DONTWAIT);
    if (n == 0)
      break;
    http_pause(10);
  }
  return 0;
}

/* The range with bytes that are wrong; `is_mending`: each is right from the second time on. */
static inline int http_answer_wrongly(http_server *server, int socket, const http_request *r, int is_mending) {
  size_t n = r->last - r->first + 1;
  unsigned char *copy = malloc(n);
  if (!copy)
    return 0;
  memcpy(copy, server->bytes + r->first, n);
  for (size_t at = (r->first + 996) / 997 * 997; at <= r->last; at += 997)
    if (!is_mending || !atomic_exchange(&server->is_mended[at / 997 % HTTP_MENDED], 1))
      copy[at - r->first] ^= 0x55;
  int is_sent = http_head(server, socket, r, n, 0, "a") && http_send(socket, copy, n);
  free(copy);
  return is_sent;
}

static inline long long http_now_us(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (long long)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

/* Over a link that all connections share. */
static inline int http_answer_by_link(http_server *server, int socket, const http_request *r) {
  long long rate = server->link_bytes_a_second;
  size_t most = rate > 2000000 ? (size_t)rate / 1000 : 2000, n = r->last - r->first + 1;
  http_pause(server->link_ms);
  int is_open = http_head(server, socket, r, n, 0, "a");
  for (size_t at = 0; at < n && is_open; at += most) {
    size_t piece = n - at < most ? n - at : most;
    long long free_us = atomic_load(&server->link_free_us), now_us = http_now_us(), sent_us;
    do
      sent_us = (free_us > now_us ? free_us : now_us) + (long long)piece * 1000000 / rate;
    while (!atomic_compare_exchange_weak(&server->link_free_us, &free_us, sent_us));
    while (http_now_us() < sent_us)
      http_pause(1);
    is_open = http_send(socket, server->bytes + r->first + at, piece);
  }
  return is_open;
}

/* Every way but the good one. 1 where the connection goes on. */
static inline int http_misbehave(http_server *server, int socket, const http_request *r, int i_request) {
  const char *mode = r->mode;
  size_t n = r->last - r->first + 1;
  char text[256];
  if (strcmp(mode, "short") == 0) { /* closes midway */
    http_head(server, socket, r, n, 0, "a");
    http_send(socket, server->bytes + r->first, n / 2);
    return 0;
  }
  if (strcmp(mode, "less") == 0) { /* fewer bytes than asked for, and says so */
    http_request less = *r;
    less.last = r->first + n / 2;
    return http_answer_well(server, socket, &less);
  }
  if (strcmp(mode, "more") == 0)
    return http_head(server, socket, r, n + 100, 0, "a") && http_send(socket, server->bytes + r->first, n) &&
           http_send(socket, server->bytes, 100);
  if (strcmp(mode, "shifted") == 0)
    return http_head(server, socket, r, n, 1, "a") && http_send(socket, server->bytes + r->first, n);
  if (strcmp(mode, "unsaid") == 0) {
    snprintf(text, sizeof text, "HTTP/1.1 206 Partial Content\r\nContent-Length: %zu\r\n\r\n", n);
    return http_say(socket, text) && http_send(socket, server->bytes + r->first, n);
  }
  if (strcmp(mode, "changed") == 0)
    return http_head(server, socket, r, n, 0, "b") && http_send(socket, server->bytes + r->first, n);
  if (strcmp(mode, "500") == 0)
    return http_say(socket, "HTTP/1.1 500 No\r\nContent-Length: 2\r\n\r\nno");
  if (strcmp(mode, "404") == 0)
    return http_say(socket, "HTTP/1.1 404 No\r\nContent-Length: 2\r\n\r\nno");
  if (strcmp(mode, "redirect") == 0)
    return http_say(socket, "HTTP/1.1 302 Found\r\nLocation: /redirect/again\r\nContent-Length: 0\r\n\r\n");
  if (strcmp(mode, "elsewhere") == 0)
    return http_say(socket, "HTTP/1.1 302 Found\r\nLocation: file:///etc/passwd\r\nContent-Length: 0\r\n\r\n");
  if (strcmp(mode, "headers") == 0)
    return http_say(socket, "HTTP/1.1 206 Partial Content\r\n") && http_repeat(server, socket, "X-More: yes\r\n", 0);
  if (strcmp(mode, "header") == 0)
    return http_say(socket, "HTTP/1.1 206 Partial Content\r\nX-More: ") && http_repeat(server, socket, "and more, ", 0);
  if (strcmp(mode, "packed") == 0) {
    snprintf(text, sizeof text,
             "HTTP/1.1 206 Partial Content\r\nContent-Encoding: gzip\r\nContent-Range: bytes %zu-%zu/%zu\r\n"
             "Content-Length: %zu\r\n\r\n",
             r->first, r->last, server->n_bytes, n);
    return http_say(socket, text) && http_send(socket, server->bytes + r->first, n);
  }
  if (strcmp(mode, "drops") == 0) /* 1.5 KB/s */
    return http_head(server, socket, r, n, 0, "a") &&
           http_repeat(server, socket, "0123456789012345678901234567890123456789012345678901234567890123456789012345",
                       50);
  if (strcmp(mode, "garbage") == 0)
    return http_repeat(server, socket, "\x01\xff garbage\n", 0);
  if (strcmp(mode, "stalled") == 0 || strcmp(mode, "laggard") == 0)
    return http_head(server, socket, r, n, 0, "a") && http_send(socket, server->bytes + r->first, n / 2) &&
           http_hang(server, socket);
  if (strcmp(mode, "silent") == 0)
    return http_hang(server, socket);
  if (strcmp(mode, "trickle") == 0)
    return http_head(server, socket, r, n, 0, "a") && http_repeat(server, socket, "x", 50);
  if (strcmp(mode, "damaged") == 0)
    return http_answer_wrongly(server, socket, r, 0);
  if (strcmp(mode, "mended") == 0) /* wrong, then right */
    return http_answer_wrongly(server, socket, r, 1);
  if (strcmp(mode, "flaky") == 0)
    return i_request % 2 ? http_say(socket, "HTTP/1.1 503 Busy\r\nContent-Length: 0\r\n\r\n")
                         : http_answer_well(server, socket, r);
  if (strcmp(mode, "forgets") == 0) /* that it knows ranges */
    return http_answer_whole(server, socket, 1, 1);
  if (strcmp(mode, "dead") == 0) {
    shutdown(server->listener, SHUT_RDWR); /* whoever comes now finds nobody */
    return 0;
  }
  return http_answer_well(server, socket, r);
}

static inline void *http_serve(void *cookie) {
  http_connection connection = *(http_connection *)cookie;
  http_server *server = connection.server;
  int is_open = 1, one = 1;
  free(cookie);
  setsockopt(connection.socket, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
  while (is_open && !atomic_load(&server->is_stopping)) {
    http_request r;
    if (!http_receive(server, connection.socket, &r))
      break;
    int i_request = atomic_fetch_add(&server->n_requests, 1);
    if (strcmp(r.mode, "whole") == 0 || strcmp(r.mode, "unlengthy") == 0)
      is_open = http_answer_whole(server, connection.socket, r.mode[0] == 'w', 1);
    else if (strcmp(r.mode, "link") == 0 || (strcmp(r.mode, "laggard") == 0 && i_request != 2))
      is_open = http_answer_by_link(server, connection.socket, &r);
    else if (strcmp(r.mode, "half") == 0)
      is_open = http_answer_whole(server, connection.socket, 1, 2) && http_hang(server, connection.socket);
    else if (strcmp(r.mode, "endless") == 0)
      is_open = http_say(connection.socket, "HTTP/1.1 200 OK\r\nConnection: close\r\n\r\n") &&
                http_repeat(server, connection.socket, "for ever and ever and ever and ever and ever and ever", 0);
    else if (i_request < atomic_load(&server->n_good))
      is_open = http_answer_well(server, connection.socket, &r);
    else
      is_open = http_misbehave(server, connection.socket, &r, i_request);
  }
  close(connection.socket);
  atomic_fetch_sub(&server->n_busy, 1);
  return NULL;
}

static inline void *http_accept(void *cookie) {
  http_server *server = cookie;
  for (;;) {
    pthread_t thread;
    int socket = accept(server->listener, NULL, NULL);
    if (socket < 0)
      return NULL;
    http_connection *connection = malloc(sizeof *connection);
    if (!connection) {
      close(socket);
      return NULL;
    }
    *connection = (http_connection){server, socket};
    atomic_fetch_add(&server->n_connections, 1);
    atomic_fetch_add(&server->n_busy, 1);
    if (pthread_create(&thread, NULL, http_serve, connection) != 0)
      abort();
    pthread_detach(thread);
  }
}

/* Serves the bytes, which must stay, until http_server_stop. */
static inline void http_server_start(http_server *server, const unsigned char *bytes, size_t n_bytes, int n_good) {
  struct sockaddr_in address;
  socklen_t length = sizeof address;
  memset(server, 0, sizeof *server);
  memset(&address, 0, sizeof address);
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  server->bytes = bytes;
  server->n_bytes = n_bytes;
  server->link_bytes_a_second = 12500000;
  server->link_ms = 20;
  atomic_store(&server->n_good, n_good);
  server->listener = socket(AF_INET, SOCK_STREAM, 0);
  if (server->listener < 0 || bind(server->listener, (struct sockaddr *)&address, sizeof address) != 0 ||
      listen(server->listener, 64) != 0 || getsockname(server->listener, (struct sockaddr *)&address, &length) != 0) {
    perror("the test's web server cannot start");
    exit(1);
  }
  server->port = ntohs(address.sin_port);
  if (pthread_create(&server->thread, NULL, http_accept, server) != 0)
    abort();
}

static inline void http_server_stop(http_server *server) {
  atomic_store(&server->is_stopping, 1);
  shutdown(server->listener, SHUT_RDWR);
  pthread_join(server->thread, NULL);
  close(server->listener);
  while (atomic_load(&server->n_busy) > 0)
    http_pause(1);
}
