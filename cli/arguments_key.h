/* The key of a command whose work can be gone on with: what decides its bits. */
#ifndef CONIC_ARGUMENTS_KEY_H
#define CONIC_ARGUMENTS_KEY_H

#include "core/files/sha256.h"

/* The program's version, the arguments that decide bits, in their order, the command's name first, and, if wanted, what
 * the files hold that they name. */
void cli_arguments_key_add(conic_sha256 *sum, int n_arguments, char *const *arguments, int with_files);

/* What a file holds; of one of over 64 MiB 64 pieces, its length and its time. Nothing of what cannot be read: whoever
 * needs it has said so. */
void cli_arguments_key_add_file(conic_sha256 *sum, const char *path);

void cli_arguments_key_add_text(conic_sha256 *sum, const char *text);
void cli_arguments_key_add_number(conic_sha256 *sum, uint64_t number);

#endif
