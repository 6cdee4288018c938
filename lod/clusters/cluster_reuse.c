/* What one pass over a cluster need not do again: sites whose surroundings are as they were in the last. */
#include "lod/clusters/cluster_sites.h"

void conic_cluster_end_pass(conic_sampler *s) {
  conic_sampling_pass now = {.n_sites = s->n_sites,
                             .lattices_room = s->lattices_room,
                             .owner_room = s->owner_room,
                             .sites_room = s->sites_room,
                             .lattices = s->lattices,
                             .owner = s->owner,
                             .sites = s->sites};
  s->lattices_room = s->last.lattices_room;
  s->owner_room = s->last.owner_room;
  s->sites_room = s->last.sites_room;
  s->lattices = s->last.lattices;
  s->owner = s->last.owner;
  s->sites = s->last.sites;
  s->last = now;
}

static int is_as_fine(const conic_sampler *s, size_t k) {
  return s->lattices[k].depth == s->last.lattices[k].depth;
}

/* Two sites are the same where the place that each was chosen at, which it owns, is the same. Those that stayed are
 * settled for now; the last pass's tell which they are. */
static void match_sites(conic_sampler *s) {
  for (size_t i = 0; i < s->last.n_sites; i++)
    s->last.sites[i].last = CONIC_NO_SITE;
  for (uint32_t i = 0; i < s->n_sites; i++) {
    conic_site *site = &s->sites[i];
    uint32_t k = s->lattice_of[site->place];
    if (!is_as_fine(s, k) || s->owner[site->place] != i)
      continue;
    uint32_t place = site->place - s->lattices[k].first + s->last.lattices[k].first, last = s->last.owner[place];
    if (s->last.sites[last].place == place) {
      site->last = last;
      site->is_settled = 1;
      s->last.sites[last].last = i;
    }
  }
}

/* Whether each place of a face belongs to the site that it belonged to. */
static int is_as_it_was(const conic_sampler *s, size_t k) {
  const uint32_t *owner = s->owner + s->lattices[k].first, *last = s->last.owner + s->last.lattices[k].first;
  uint32_t n = conic_face_lattice_places(s->lattices[k].sides), i = 0;
  if (!is_as_fine(s, k))
    return 0;
  while (i < n && s->sites[owner[i]].last == last[i])
    i++;
  return i == n;
}

/* Neither who owns something of a face now nor who did is settled. */
static void unsettle(conic_sampler *s, size_t k) {
  const conic_face_lattice *now = &s->lattices[k], *then = &s->last.lattices[k];
  for (uint32_t i = 0; i < conic_face_lattice_places(now->sides); i++)
    s->sites[s->owner[now->first + i]].is_settled = 0;
  for (uint32_t i = 0; i < conic_face_lattice_places(then->sides); i++) {
    uint32_t same = s->last.sites[s->last.owner[then->first + i]].last;
    if (same != CONIC_NO_SITE)
      s->sites[same].is_settled = 0;
  }
}

void conic_cluster_settle_sites(conic_sampler *s) {
  match_sites(s);
  for (size_t k = 0; k < s->n_lattices; k++)
    if (!is_as_it_was(s, k))
      unsettle(s, k);
  for (size_t i = 0; i < s->n_sites; i++) {
    conic_site *site = &s->sites[i];
    if (!site->is_settled)
      continue;
    uint32_t place = site->place;
    *site = s->last.sites[site->last];
    site->place = place;
    site->is_settled = 1;
  }
}
