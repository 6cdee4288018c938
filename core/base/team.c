#include "core/base/team.h"

#include <string.h>

conic_status conic_team_status(const conic_team *team, conic_status status) {
  if (!team)
    return status;
  size_t sizes[CONIC_MOST_IN_TEAM];
  int own = status != CONIC_OK;
  char *all = team->collect(team->data, &own, sizeof own, sizes);
  for (int i = 0; i < team->count && status == CONIC_OK; i++) {
    int other;
    memcpy(&other, all + (size_t)i * sizeof other, sizeof other);
    status = other ? CONIC_ERROR_CANCELLED : CONIC_OK;
  }
  team->release(team->data, all);
  return status;
}

size_t conic_team_collect(const conic_team *team, const void *bytes, size_t n_bytes, void *all) {
  size_t sizes[CONIC_MOST_IN_TEAM], n_together = 0;
  void *collected = team->collect(team->data, bytes, n_bytes, sizes);
  for (int i = 0; i < team->count; i++)
    n_together += sizes[i];
  memcpy(all, collected, n_together);
  team->release(team->data, collected);
  return n_together;
}

conic_moment conic_team_note(const conic_team *team, const char *name, conic_moment from, uint64_t number) {
  if (team && team->note)
    team->note(team->data, name, from, number);
  return conic_moment_now();
}

void *conic_team_swap(const conic_team *team, int partner, const void *bytes, size_t n_bytes, size_t *n_received) {
  void *received = NULL;
  if (team->index < partner)
    team->send(team->data, partner, bytes, n_bytes);
  received = team->receive(team->data, partner, n_received);
  if (team->index > partner)
    team->send(team->data, partner, bytes, n_bytes);
  return received;
}
