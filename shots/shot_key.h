/* Keys: hashes of the fields of shots, and of what files hold. */
#pragma once

#include "conic/shot_file.h"
#include "core/files/sha256.h"

/* Adds what is other than the default of the fields whose paths begin as `part` (null: of all but `writing`), and what
 * the inputs hold. */
void conic_key_add_fields(conic_sha256 *sum, const conic_shot_file *file, const char *part);
void conic_key_add_inputs(conic_sha256 *sum, const conic_shot_file *file);
void conic_key_add_text(conic_sha256 *sum, const char *text);
void conic_key_add_number(conic_sha256 *sum, uint64_t number);
/* Its bits, as this machine has them: for keys that stay on it. */
void conic_key_add_real(conic_sha256 *sum, double number);

/* What decides no bit becomes as it is by default, so that pictures that are the same have one key: numbers of a lens,
 * a shutter or an eye that there is not, of splats where Gaussian scenes are composited, and so on. `abilities` are the
 * source's, of conic_source_abilities. */
void conic_shot_file_plain(conic_shot_file *file, unsigned abilities);
