/* What `conic info` says of a hybrid model. */
#ifndef CONIC_HYBRID_INFO_H
#define CONIC_HYBRID_INFO_H

#include "cli/json_write.h"
#include "conic/hybrid.h"

/* `broken` may be null: not looked for. */
void cli_hybrid_print(const conic_hybrid_info *info, const conic_hybrid_defects *broken);
void cli_hybrid_report(cli_json *json, const conic_hybrid_info *info, const conic_hybrid_defects *broken);

#endif
