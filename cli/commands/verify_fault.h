/* How verify reports a wrong value of a pixel. */
#ifndef CONIC_VERIFY_FAULT_H
#define CONIC_VERIFY_FAULT_H

#include "cli/json_write.h"
#include "conic/oracle.h"

/* Writes it as an object under `key`, or, if that is null, as an item. */
void cli_report_fault(cli_json *json, const char *key, const conic_oracle_fault *fault);
/* Writes its members into an open object. */
void cli_fault_members(cli_json *json, const conic_oracle_fault *fault);

#endif
