/* What a picture is made of: the files that were named, and whatever they led to, with what these hold. */
#pragma once

#include "conic/shot_file.h"

/* Names of files; null: there is none. */
typedef struct conic_shot_names {
  const char *const *scene;
  size_t n_scene;
  const char *texture, *sky, *motion;
} conic_shot_names;

/* In the order of the roles, parts by their names. */
typedef struct conic_shot_inputs {
  conic_shot_input *inputs;
  size_t n, room;
  struct conic_shot_looking *looking; /* at them, beside the calling thread; null: nobody is */
} conic_shot_inputs;

/* Lists the named files, and begins to look at them on a thread of its own, so that it takes no time of whoever reads
 * and draws them; unless the context has one thread. Nobody else touches the inputs until they are found or released.
 * Errors: MEMORY. */
conic_status conic_shot_inputs_begin(conic_context *context, const conic_shot_names *names, conic_shot_inputs *inputs);

/* Lists the named files, unless that was begun, and as parts whatever else the context has read since
 * conic_guard_go_on. A file that cannot be read has no hash: whoever needs it has said so. Errors: MEMORY, CANCELLED;
 * the caller releases in any case. */
conic_status conic_shot_inputs_find(conic_context *context, const conic_shot_names *names, conic_shot_inputs *inputs);
void conic_shot_inputs_release(conic_context *context, conic_shot_inputs *inputs);

/* What a file holds, or a folder, or the folder of a hierarchy's first file; `input` has its name already. Of more than
 * 64 MiB its length, its time and 64 pieces. Errors: MEMORY, CANCELLED. */
conic_status conic_shot_input_look(conic_context *context, const char *path, conic_shot_input *input);
