/* The bridge to libcurl, a module of its own: libcurl's own libraries take longer to load than all else that the
 * program needs, and most runs ask no server for anything. */
#pragma once

#include <curl/curl.h>

/* The module's one symbol, conic_curl_bridge: libcurl's functions, named without "curl_". */
typedef struct conic_curl_bridge_functions {
  const char *version; /* as of every module (core/base/machine.h) */

  CURLcode (*global_init)(long flags);
  void (*global_cleanup)(void);
  CURL *(*easy_init)(void);
  CURLcode (*easy_setopt)(CURL *easy, CURLoption option, ...);
  CURLcode (*easy_getinfo)(CURL *easy, CURLINFO info, ...);
  const char *(*easy_strerror)(CURLcode code);
  void (*easy_cleanup)(CURL *easy);
  CURLM *(*multi_init)(void);
  CURLMcode (*multi_add_handle)(CURLM *multi, CURL *easy);
  CURLMcode (*multi_remove_handle)(CURLM *multi, CURL *easy);
  CURLMcode (*multi_perform)(CURLM *multi, int *n_running);
  CURLMcode (*multi_poll)(CURLM *multi, struct curl_waitfd *more, unsigned n_more, int timeout_ms, int *n_ready);
  CURLMcode (*multi_wakeup)(CURLM *multi);
  CURLMsg *(*multi_info_read)(CURLM *multi, int *n_left);
  CURLMcode (*multi_cleanup)(CURLM *multi);
} conic_curl_bridge_functions;
