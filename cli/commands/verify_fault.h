/* A plane of a pixel that is not what it may be, as verify reports it. */
#ifndef CONIC_VERIFY_FAULT_H
#define CONIC_VERIFY_FAULT_H

#include "cli/json_write.h"
#include "conic/oracle.h"

/* Writes it as an object under `key`, or, where that is null, as an item. */
void cli_report_fault(cli_json *json, const char *key, const conic_oracle_fault *fault);
/* The same into an object that is open. */
void cli_fault_members(cli_json *json, const conic_oracle_fault *fault);

#endif
