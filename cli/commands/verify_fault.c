#include "cli/commands/verify_fault.h"

void cli_fault_members(cli_json *json, const conic_oracle_fault *fault) {
  cli_json_count(json, "x", (uint64_t)fault->x);
  cli_json_count(json, "y", (uint64_t)fault->y);
  cli_json_text(json, "plane", conic_plane_describe((conic_plane)fault->plane)->name);
  cli_json_count(json, "channel", (uint64_t)fault->channel);
  cli_json_number(json, "found", fault->found);
  cli_json_number(json, "low", fault->low);
  cli_json_number(json, "high", fault->high);
}

void cli_report_fault(cli_json *json, const char *key, const conic_oracle_fault *fault) {
  cli_json_object(json, key);
  cli_fault_members(json, fault);
  cli_json_close(json);
}
