#include "core/files/file.h"

#include <unistd.h>

#include "core/base/context_struct.h"
#include "core/files/guard.h"
#include "core/files/scratch.h"

struct conic_output {
  conic_context *context;
  FILE *stream;
  char *path;           /* for messages */
  char *target;         /* the file that the path leads to */
  char *temporary_path; /* null for standard output, devices and pipes */
  int is_kept;          /* the temporary file stays, whatever happens */
  conic_output *next;   /* next of the context's outputs */
};

static void release_output(conic_output *output) {
  conic_context *context = output->context;
  conic_memory_release_these(context, output->path, output->target, output->temporary_path, output);
}

const char *conic_file_name(const char *path) {
  const char *name = path;
  for (const char *c = path; *c; c++)
    if (conic_disk_is_separator(*c))
      name = c + 1;
  return name;
}

const char *conic_file_ending(const char *path) {
  const char *dot = strrchr(conic_file_name(path), '.');
  return dot ? dot + 1 : "";
}

int conic_file_follow(const char *path, char *target, size_t room) {
  char link[4096];
  int n = snprintf(target, room, "%s", path);
  for (int steps = 0; n >= 0 && (size_t)n < room && steps < 40; steps++) {
    /* NOLINTNEXTLINE(readability-suspicious-call-argument): the target so far, which may be a link */
    size_t length = conic_disk_read_link(target, link, sizeof link);
    if (!length)
      return 1;
    size_t folder = conic_disk_is_absolute(link) ? 0 : (size_t)(conic_file_name(target) - target);
    n = (int)(folder + length);
    if ((size_t)n < room) {
      memcpy(target + folder, link, length);
      target[n] = '\0';
    }
  }
  return 0;
}

/* A name "name.ext" in two parts: "name", cut so that a temporary name has room, and ".ext". */
typedef struct name_parts {
  const char *stem, *ending;
  int n_stem;
} name_parts;

enum { LONGEST_NAME = 255, ADDED_BYTES = 24 };

static name_parts split_name(const char *name) {
  const char *dot = strrchr(name, '.');
  name_parts parts = {name, dot && dot != name ? dot : name + strlen(name), 0};
  size_t n = (size_t)(parts.ending - name), n_ending = strlen(parts.ending);
  size_t room = n_ending + ADDED_BYTES < LONGEST_NAME ? LONGEST_NAME - ADDED_BYTES - n_ending : 0;
  parts.n_stem = (int)(n < room ? n : room);
  return parts;
}

/* PATH "dir/name.ext" is first written as "dir/.name.PID-N.ext": hidden, in the same folder, with the same ending. */
static char *temporary_name(conic_context *context, const char *path, int attempt) {
  const char *name = conic_file_name(path);
  const name_parts parts = split_name(name);
  size_t n = strlen(path) + 48;
  char *temporary = conic_memory_allocate(context, n, 1);
  if (temporary)
    snprintf(temporary, n, "%.*s.%.*s.%ld-%d%s", (int)(name - path), path, parts.n_stem, parts.stem, (long)getpid(),
             attempt, parts.ending);
  return temporary;
}

/* Creates the temporary file if nothing has its name. Outputs with a temporary file are on the context's list. */
static int begin_temporary(conic_output *output) {
  conic_context *context = output->context;
  pthread_mutex_lock(&context->outputs_lock); /* conic_outputs_give_up locks this and never unlocks it */
  int descriptor = output->is_kept ? conic_disk_open_to_change(output->temporary_path)
                                   : conic_disk_create(output->temporary_path),
      error = errno;
  if (descriptor >= 0) {
    output->next = context->outputs;
    context->outputs = output;
  }
  pthread_mutex_unlock(&context->outputs_lock);
  errno = error;
  return descriptor;
}

/* Renames the temporary file if `is_wanted`, else removes it. Returns whether it now has the output's name. */
static int end_temporary(conic_output *output, int is_wanted) {
  conic_context *context = output->context;
  pthread_mutex_lock(&context->outputs_lock);
  int is_renamed = is_wanted && conic_disk_rename(output->temporary_path, output->target), error = errno;
  if (!is_renamed && !output->is_kept)
    conic_disk_remove(output->temporary_path);
  conic_output **at = &context->outputs;
  while (*at != output)
    at = &(*at)->next;
  *at = output->next;
  pthread_mutex_unlock(&context->outputs_lock);
  errno = error;
  return is_renamed;
}

void conic_outputs_give_up(conic_context *context) {
  pthread_mutex_lock(&context->outputs_lock);
  for (conic_output *output = context->outputs; output; output = output->next)
    if (!output->is_kept)
      conic_disk_remove(output->temporary_path);
}

void conic_outputs_watch(conic_context *context, void (*watch)(void *cookie, const char *path), void *cookie) {
  context->watch_outputs = watch;
  context->watch_cookie = cookie;
}

static conic_status open_kept(conic_output *output) {
  conic_disk_entry there;
  if (conic_disk_look(output->temporary_path, &there)) {
    conic_status status = conic_guard_check(output->context, output->temporary_path, &there);
    if (status != CONIC_OK)
      return status;
  }
  int descriptor = begin_temporary(output);
  output->stream = descriptor >= 0 ? fdopen(descriptor, "r+b") : NULL;
  if (output->stream)
    return CONIC_OK;
  conic_fail(output->context, CONIC_ERROR_IO, "%s: cannot write: %s", output->temporary_path, strerror(errno));
  if (descriptor >= 0) {
    close(descriptor);
    end_temporary(output, 0);
  }
  return CONIC_ERROR_IO;
}

static conic_status open_temporary(conic_output *output) {
  if (output->is_kept)
    return open_kept(output);
  if (conic_output_sweep(output->context, output->target) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (int attempt = 0; attempt < 100; attempt++) {
    conic_memory_release(output->context, output->temporary_path);
    output->temporary_path = temporary_name(output->context, output->target, attempt);
    if (!output->temporary_path)
      return CONIC_ERROR_MEMORY;
    int descriptor = begin_temporary(output);
    if (descriptor >= 0) {
      output->stream = fdopen(descriptor, "wb");
      if (output->stream)
        return CONIC_OK;
      close(descriptor);
      end_temporary(output, 0);
      break;
    }
    if (errno != EEXIST)
      break;
  }
  return conic_fail(output->context, CONIC_ERROR_IO, "%s: cannot write: %s", output->path, strerror(errno));
}

/* A file, device or pipe that exists: devices and pipes are written directly. */
static conic_status open_existing(conic_output *output, const conic_disk_entry *existing) {
  conic_status status = conic_guard_check(output->context, output->path, existing);
  if (status != CONIC_OK)
    return status;
  if (existing->is_folder)
    return conic_fail(output->context, CONIC_ERROR_IO, "%s: cannot write: it is a directory", output->path);
  if (existing->is_file) {
    status = open_temporary(output);
    if (status == CONIC_OK)
      conic_disk_permit(fileno(output->stream), existing->permissions);
    return status;
  }
  output->stream = conic_disk_open_stream(output->path, "wb");
  return output->stream
             ? CONIC_OK
             : conic_fail(output->context, CONIC_ERROR_IO, "%s: cannot write: %s", output->path, strerror(errno));
}

static conic_status open_target(conic_output *output) {
  conic_disk_entry existing;
  char target[4096];
  if (strcmp(output->path, "-") == 0) {
    output->stream = stdout;
    return CONIC_OK;
  }
  int is_there = conic_disk_look(output->path, &existing);
  if (is_there && !existing.is_file && output->is_kept)
    return conic_fail(output->context, CONIC_ERROR_IO, "%s: cannot be gone on with: it is no file", output->path);
  if (is_there && !existing.is_file)
    return open_existing(output, &existing);
  if (!conic_file_follow(output->path, target, sizeof target))
    return conic_fail(output->context, CONIC_ERROR_IO, "%s: cannot write: the name is too long, or links to itself",
                      output->path);
  output->target = conic_memory_copy_text(output->context, target);
  if (!output->target)
    return CONIC_ERROR_MEMORY;
  return is_there ? open_existing(output, &existing) : open_temporary(output);
}

static conic_status open_output(conic_context *context, const char *path, const char *part, conic_output **output) {
  *output = NULL;
  conic_output *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->context = context;
  made->path = conic_memory_copy_text(context, path);
  made->is_kept = part != NULL;
  made->temporary_path = part ? conic_memory_copy_text(context, part) : NULL;
  conic_status status = made->path && (!part || made->temporary_path) ? open_target(made) : CONIC_ERROR_MEMORY;
  if (status != CONIC_OK) {
    release_output(made);
    return status;
  }
  *output = made;
  return CONIC_OK;
}

conic_status conic_output_open(conic_context *context, const char *path, conic_output **output) {
  return open_output(context, path, NULL, output);
}

conic_status conic_output_go_on(conic_context *context, const char *path, const char *part, conic_output **output) {
  return open_output(context, path, part, output);
}

FILE *conic_output_stream(conic_output *output) {
  return output->stream;
}

const char *conic_output_temporary(const conic_output *output) {
  return output->temporary_path;
}

conic_status conic_output_commit(conic_output *output) {
  conic_status status = CONIC_OK;
  int is_wrong = ferror(output->stream) || fflush(output->stream) != 0;
  if (output->stream != stdout && fclose(output->stream) != 0)
    is_wrong = 1;
  if (output->temporary_path && !end_temporary(output, !is_wrong))
    is_wrong = 1;
  if (is_wrong)
    status = conic_fail(output->context, CONIC_ERROR_IO, "%s: cannot write: %s", output->path,
                        errno ? strerror(errno) : "the device failed");
  else if (output->temporary_path && output->context->watch_outputs)
    output->context->watch_outputs(output->context->watch_cookie, output->path);
  release_output(output);
  return status;
}

void conic_output_abandon(conic_output *output) {
  if (!output)
    return;
  if (output->stream != stdout)
    fclose(output->stream);
  if (output->temporary_path)
    end_temporary(output, 0);
  release_output(output);
}

conic_status conic_output_end(conic_output *output, conic_status status) {
  if (status == CONIC_OK)
    return conic_output_commit(output);
  conic_output_abandon(output);
  return status;
}

/* Whether "NAME" is ".STEM.PID-N.EXT" of a process that has ended, or a scratch file that kept its name. */
static int is_left_over(const char *name, const char *stem, size_t n_stem, const char *ending) {
  char *end;
  if (strncmp(name, CONIC_SCRATCH_START, strlen(CONIC_SCRATCH_START)) == 0)
    return 1;
  if (name[0] != '.' || strncmp(name + 1, stem, n_stem) != 0 || name[1 + n_stem] != '.')
    return 0;
  long process = strtol(name + n_stem + 2, &end, 10);
  if (process <= 0 || *end != '-')
    return 0;
  long attempt = strtol(end + 1, &end, 10);
  return attempt >= 0 && strcmp(end, ending) == 0 && conic_disk_is_writer_gone(process);
}

static void remove_if_old(const char *path) {
  conic_disk_entry found;
  char link[4096];
  if (conic_disk_look(path, &found) && found.is_file && !conic_disk_read_link(path, link, sizeof link) &&
      (int64_t)time(NULL) - found.modified_seconds > 60)
    conic_disk_remove(path);
}

conic_status conic_output_sweep(conic_context *context, const char *path) {
  const char *name = conic_file_name(path);
  const name_parts parts = split_name(name);
  conic_disk_folder folder;
  const int n_folder = (int)(name - path);
  const size_t room = (size_t)n_folder + LONGEST_NAME + 2;
  char *found = conic_memory_allocate(context, room, 1);
  if (!found)
    return CONIC_ERROR_MEMORY;
  snprintf(found, room, "%.*s", n_folder ? n_folder : 1, n_folder ? path : ".");
  conic_disk_open_folder(found, &folder);
  for (const char *entry; (entry = conic_disk_next_name(&folder));)
    if (is_left_over(entry, parts.stem, (size_t)parts.n_stem, parts.ending) &&
        snprintf(found, room, "%.*s%s", n_folder, path, entry) < (int)room)
      remove_if_old(found);
  conic_disk_close_folder(&folder);
  conic_memory_release(context, found);
  return CONIC_OK;
}

int conic_file_is_there(const char *path) {
  conic_disk_entry about;
  return conic_disk_look(path, &about) && about.is_file && conic_disk_can_read(path);
}

int conic_file_has_ending(const char *path, const char *ending) {
  size_t n = strlen(path), n_ending = strlen(ending);
  if (n <= n_ending || path[n - n_ending - 1] != '.')
    return 0;
  for (const char *c = path + n - n_ending; *c; c++, ending++)
    if ((*c >= 'A' && *c <= 'Z' ? *c - 'A' + 'a' : *c) != *ending)
      return 0;
  return 1;
}

size_t conic_file_read_head(const char *path, void *head, size_t n_bytes) {
  FILE *file = strcmp(path, "-") != 0 && conic_file_is_there(path) ? conic_disk_open_stream(path, "rb") : NULL;
  if (!file)
    return 0;
  size_t n = fread(head, 1, n_bytes, file);
  fclose(file);
  return n;
}

int conic_file_begins_with(const char *path, const void *bytes, size_t n_bytes) {
  unsigned char head[16];
  return conic_file_read_head(path, head, n_bytes) == n_bytes && memcmp(head, bytes, n_bytes) == 0;
}
