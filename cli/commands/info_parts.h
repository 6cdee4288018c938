/* What `conic info` says of every kind of model alike. */
#ifndef CONIC_INFO_PARTS_H
#define CONIC_INFO_PARTS_H

#include <stdint.h>

#include "cli/json_write.h"

void cli_bounds_print(const double low[3], const double high[3]);
void cli_bounds_report(cli_json *json, const double low[3], const double high[3]);

/* Something that can be broken in a file: how often it is, and what to call it. */
typedef struct cli_defect {
  uint64_t count;
  const char *key, *text;
} cli_defect;

/* Whether the file is sound, and else what is broken. */
void cli_defects_print(const cli_defect *list, int n);
void cli_defects_report(cli_json *json, const cli_defect *list, int n);

#endif
