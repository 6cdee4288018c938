/* A whole .lpc file in memory: for looking at it, not for drawing. */
#ifndef CONIC_LAYERS_READ_H
#define CONIC_LAYERS_READ_H

#include "core/files/mapping.h"
#include "lod/layers/format/layers_format.h"

typedef struct conic_layers_file {
  conic_context *context;
  const char *name; /* for messages */
  conic_mapping mapping;
  conic_layers_header header;
  conic_layers_entry *entries;
} conic_layers_file;

/* Maps the file and checks header and index; `path` must outlive the file. Errors: INPUT, MEMORY. */
conic_status conic_layers_file_open(conic_context *context, const char *path, conic_layers_file *file);
void conic_layers_file_close(conic_layers_file *file);

#endif
