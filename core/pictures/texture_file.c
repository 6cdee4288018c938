#include "core/pictures/texture_file.h"

#include "core/base/context_struct.h"
#include "core/files/guard.h"
#include "core/files/scratch.h"
#include "core/image/texture_levels.h"

/* Messages while a picture is read become warnings of the model, which can be drawn without it. */
typedef struct picture_log {
  conic_context *context;
  const char *model, *path; /* the picture's path, which messages begin with, is replaced by: */
  const char *name;
} picture_log;

static void warn_of_picture(void *cookie, conic_log_level level, const char *message) {
  const picture_log *log = cookie;
  size_t n = strlen(log->path);
  if (strncmp(message, log->path, n) == 0 && strncmp(message + n, ": ", 2) == 0)
    message += n + 2;
  conic_log(log->context, level == CONIC_LOG_ERROR ? CONIC_LOG_WARNING : level, "%s: the texture %s%s: %s", log->model,
            log->name, level == CONIC_LOG_ERROR ? " is left out" : "", message);
}

/* The copy of the context would keep to itself what it notes. */
static conic_status read_texture(conic_context *context, const char *model, const char *path, const char *name,
                                 conic_texture_wrap wrap, conic_texture **texture) {
  conic_context told = *context;
  picture_log log = {context, model, path, name};
  conic_image image;
  told.options.log = warn_of_picture;
  told.options.log_cookie = &log;
  told.guards_inputs = 0;
  conic_status status = conic_texture_read_image(&told, path, &image);
  if (status == CONIC_ERROR_MEMORY || status == CONIC_ERROR_CANCELLED)
    return status;
  if (status != CONIC_OK)
    return CONIC_OK;
  return conic_texture_take(context, &image, wrap, texture);
}

conic_status conic_texture_file_read(conic_context *context, const char *model, const char *path, const char *name,
                                     conic_texture_wrap wrap, conic_texture **texture) {
  const conic_status status = conic_guard_note_path(context, path);
  return status == CONIC_OK ? read_texture(context, model, path, name, wrap, texture) : status;
}

/* Pictures are read from files; this one becomes one without a name. */
conic_status conic_texture_bytes_read(conic_context *context, const char *model, const void *bytes, size_t n_bytes,
                                      const char *name, conic_texture_wrap wrap, conic_texture **texture) {
  const char *folder = getenv("TMPDIR");
  char beside[4096], path[64];
  conic_scratch scratch;
  snprintf(beside, sizeof beside, "%s/texture", folder && *folder ? folder : "/tmp");
  conic_status status = conic_scratch_open(context, beside, &scratch);
  if (status != CONIC_OK)
    return status;
  snprintf(path, sizeof path, "/proc/self/fd/%d", scratch.descriptor);
  status = conic_scratch_write(&scratch, 0, bytes, n_bytes);
  if (status == CONIC_OK)
    status = read_texture(context, model, path, name, wrap, texture);
  conic_scratch_close(&scratch);
  return status;
}
