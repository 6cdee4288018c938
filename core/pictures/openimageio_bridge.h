/* The bridge to OpenImageIO: plain C, without C++ types and exceptions.
 *
 * It is a module, conic-openimageio.so, which is loaded when the first file needs it: OpenImageIO needs some 250
 * libraries, for which drawing into an EXR or a PNG should not wait. */
#pragma once

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { CONIC_BRIDGE_CHANNELS = 64 };

typedef struct conic_bridge_channel {
  char name[32];
  int is_uint; /* its samples are 32-bit numbers */
} conic_bridge_channel;

typedef struct conic_bridge_picture {
  int width, height, n_channels;
  int sample_bytes; /* 1, 2: unsigned integers; 4: floats */
  int is_straight;  /* the colour is not multiplied by alpha */
  int is_named;     /* its channels have names: an EXR that was read */
  conic_bridge_channel channels[CONIC_BRIDGE_CHANNELS];
  const char *description; /* of a TIFF that is written; null: none */
} conic_bridge_picture;

typedef struct conic_bridge_writer {
  char format[32]; /* OpenImageIO's name: "png", "tiff", "jpeg" … */
  int has_alpha;
} conic_bridge_writer;

enum { CONIC_BRIDGE_MESSAGE = 256 }; /* CONIC_MODULE_MESSAGE */

/* The outcome of a call. */
typedef enum conic_bridge_result {
  CONIC_BRIDGE_OK = 0,
  CONIC_BRIDGE_FAILED, /* the message says why */
  CONIC_BRIDGE_MEMORY
} conic_bridge_result;

/* The module's one symbol, conic_openimageio_bridge. */
typedef struct conic_bridge {
  const char *version; /* as in every module (core/base/machine.h) */

  /* Finds the format of files with this ending. */
  conic_bridge_result (*find_writer)(const char *ending, conic_bridge_writer *writer,
                                     char message[CONIC_BRIDGE_MESSAGE]);

  /* Encodes `samples` (row by row, channels side by side, colour sRGB-encoded unless they are floats) as a file in a
   * writer's format, and hands its bytes to `take`, which returns 0 to stop. Formats that can only write to their own
   * files fail. */
  conic_bridge_result (*write)(const char *format, const conic_bridge_picture *picture, const void *samples,
                               int (*take)(void *cookie, const void *bytes, size_t n_bytes), void *cookie,
                               char message[CONIC_BRIDGE_MESSAGE]);

  /* Reads the first picture of a file, of up to so many MiB of samples. Once its size is known, `make_room` is asked
   * for room for all its samples; if it returns null, the call ends with CONIC_BRIDGE_MEMORY. */
  conic_bridge_result (*read)(const char *path, int most_mib, conic_bridge_picture *picture,
                              void *(*make_room)(void *cookie, const conic_bridge_picture *picture), void *cookie,
                              char message[CONIC_BRIDGE_MESSAGE]);
} conic_bridge;

/* The bridge, loaded by the first call; null where it cannot be loaded, and the message says why. */
const conic_bridge *conic_bridge_load(char message[CONIC_BRIDGE_MESSAGE]);

/* Whether there is a module to load; the library itself is not checked. */
int conic_bridge_is_there(void);

#ifdef __cplusplus
}
#endif
