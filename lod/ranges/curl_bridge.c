#include "lod/ranges/curl_bridge.h"

#include "conic/export.h"
#include "conic/version.h"

#define CURL_TEXT_OF(x) #x
#define CURL_TEXT(x) CURL_TEXT_OF(x)

CONIC_API extern const conic_curl_bridge_functions conic_curl_bridge;
const conic_curl_bridge_functions conic_curl_bridge = {
    .version = CURL_TEXT(CONIC_VERSION_MAJOR) "." CURL_TEXT(CONIC_VERSION_MINOR) "." CURL_TEXT(CONIC_VERSION_PATCH),
    .global_init = curl_global_init,
    .global_cleanup = curl_global_cleanup,
    .easy_init = curl_easy_init,
    .easy_setopt = curl_easy_setopt,
    .easy_getinfo = curl_easy_getinfo,
    .easy_strerror = curl_easy_strerror,
    .easy_cleanup = curl_easy_cleanup,
    .multi_init = curl_multi_init,
    .multi_add_handle = curl_multi_add_handle,
    .multi_remove_handle = curl_multi_remove_handle,
    .multi_perform = curl_multi_perform,
    .multi_poll = curl_multi_poll,
#if LIBCURL_VERSION_NUM >= 0x074400
    .multi_wakeup = curl_multi_wakeup,
#endif
    .multi_info_read = curl_multi_info_read,
    .multi_cleanup = curl_multi_cleanup,
};
