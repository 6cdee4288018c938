/* What a source says of itself, as JSON and for people. */
#pragma once

#include "cli/json_write.h"
#include "conic/source.h"

/* From fact `first` on. */
void cli_facts_report(cli_json *json, const conic_facts *facts, size_t first);
/* The lines on standard output; and where defects were looked for, which were found. */
void cli_facts_print(const conic_facts *facts);
/* Whether none was. */
int cli_facts_are_sound(const conic_facts *facts);
