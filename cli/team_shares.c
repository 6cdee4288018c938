#include "cli/team_shares.h"

#include <stdlib.h>

#include "cli/session_team.h"

void cli_team_shares_gather(const cli_session *session, uint64_t n_units, double busy_seconds,
                            cli_team_shares *shares) {
  cli_team *team = session->team;
  cli_team_share own = {.n_units = n_units, .peak_bytes = cli_peak_rss_bytes(), .busy_seconds = busy_seconds};
  team->count_traffic(&own.sent_bytes, &own.received_bytes, &own.waited_seconds);
  size_t *sizes = calloc((size_t)team->count, sizeof *sizes);
  if (sizes)
    shares->of = team->gather(&own, sizeof own, sizes);
  shares->n = shares->of ? team->count : 0;
  free(sizes);
}

void cli_team_shares_release(cli_team_shares *shares) {
  free(shares->of);
}

void cli_team_shares_report(cli_json *json, const char *what, const cli_team_shares *shares) {
  if (!shares->n)
    return;
  cli_json_object(json, "team");
  cli_json_text(json, "shares", what);
  cli_json_array(json, "processes");
  for (int i = 0; i < shares->n; i++) {
    const cli_team_share *s = &shares->of[i];
    cli_json_object(json, NULL);
    cli_json_count(json, "units", s->n_units);
    cli_json_number(json, "busy_ms", 1e3 * s->busy_seconds);
    cli_json_number(json, "waited_ms", 1e3 * s->waited_seconds);
    cli_json_count(json, "sent_bytes", s->sent_bytes);
    cli_json_count(json, "received_bytes", s->received_bytes);
    cli_json_count(json, "peak_rss_bytes", s->peak_bytes);
    cli_json_close(json);
  }
  cli_json_close(json);
  cli_json_close(json);
}
