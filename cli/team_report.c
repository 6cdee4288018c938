#include "cli/team_report.h"

void cli_team_report_gather(const cli_session *session, cli_team_work work, cli_team_report *report) {
  const conic_executor *team = session->team;
  cli_team_part own = {.n_units = work.n, .peak_bytes = cli_peak_rss_bytes(), .busy_seconds = work.busy_seconds};
  team->count_traffic(team->data, &own.sent_bytes, &own.received_bytes, &own.waited_seconds);
  cli_team_part *all = calloc((size_t)team->count, sizeof *all);
  int is_wanted = team->agree(team->data, all ? CONIC_OK : CONIC_ERROR_MEMORY) == CONIC_OK;
  if (is_wanted)
    conic_team_collect(team->team, &own, sizeof own, all);
  report->of = all;
  report->n = is_wanted ? team->count : 0;
}

void cli_team_report_release(cli_team_report *report) {
  free(report->of);
}

void cli_team_report_write(cli_json *json, const char *what, const cli_team_report *report) {
  if (!report->n)
    return;
  cli_json_object(json, "team");
  cli_json_text(json, "shares", what);
  cli_json_array(json, "processes");
  for (int i = 0; i < report->n; i++) {
    const cli_team_part *s = &report->of[i];
    cli_json_object(json, NULL);
    cli_json_count(json, "units", s->n_units);
    cli_json_figures(json, NULL, {"busy_ms", 1e3 * s->busy_seconds}, {"waited_ms", 1e3 * s->waited_seconds});
    cli_json_counts(json, NULL, {"sent_bytes", s->sent_bytes}, {"received_bytes", s->received_bytes},
                    {"peak_rss_bytes", s->peak_bytes});
    cli_json_close(json);
  }
  cli_json_close(json);
  cli_json_close(json);
}
