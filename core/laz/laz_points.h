/* The two ways of packing points: one after the other, and in layers. */
#pragma once

#include "core/laz/laz.h"
#include "core/laz/laz_models.h"

/* The states of decoding a chunk, zero at first. `first` is the chunk's first record. */
typedef struct conic_laz_serial conic_laz_serial;
typedef struct conic_laz_layered conic_laz_layered;

/* Errors: MEMORY. */
conic_status conic_laz_serial_create(conic_context *context, conic_laz_serial **serial);
conic_status conic_laz_layered_create(conic_context *context, conic_laz_layered **layered);
void conic_laz_serial_destroy(conic_context *context, conic_laz_serial *serial);
void conic_laz_layered_destroy(conic_context *context, conic_laz_layered *layered);

/* Begin with the bytes after the chunk's first record. Errors: INPUT, MEMORY (layered). */
conic_status conic_laz_serial_begin(conic_laz_serial *serial, const conic_laz_format *format, conic_laz_arena *arena,
                                    const unsigned char *first, const unsigned char *bytes, size_t n_bytes);
conic_status conic_laz_layered_begin(conic_laz_layered *layered, const conic_laz_format *format, conic_laz_arena *arena,
                                     unsigned wanted, const unsigned char *first, const unsigned char *bytes,
                                     size_t n_bytes);

/* Decodes the next n points; returns 0 where they are spoiled. */
int conic_laz_serial_next(conic_laz_serial *serial, size_t n, unsigned char *records);
int conic_laz_layered_next(conic_laz_layered *layered, size_t n, unsigned char *records);

/* Continues with the bytes after the used ones. */
void conic_laz_serial_feed(conic_laz_serial *serial, const unsigned char *bytes, size_t n_bytes);

/* The number of layers of a format, one of them for each extra byte. */
size_t conic_laz_count_layers(const conic_laz_format *format);

/* The end of the used bytes. */
const unsigned char *conic_laz_serial_end(const conic_laz_serial *serial);
const unsigned char *conic_laz_layered_end(const conic_laz_layered *layered);
