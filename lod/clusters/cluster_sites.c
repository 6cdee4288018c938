#include "lod/clusters/cluster_sites.h"

#include "core/base/color.h"
#include "core/base/random.h"
#include "core/base/vectors.h"

/* A step of the lattices, in spacings: fine enough that what a site stands for is round. */
static const double lattice_step = 0.9;
enum { MOST_SIDES = 32 };

/* --- lattices --- */

static int sides_of_face(const conic_sampler *s, uint32_t face, int depth) {
  double longest = 0.0;
  for (int corner = 0; corner < 3; corner++) {
    double a[3], b[3];
    conic_mesh_corner(&s->job->mesh->mesh, face, corner, a);
    conic_mesh_corner(&s->job->mesh->mesh, face, (corner + 1) % 3, b);
    for (int axis = 0; axis < 3; axis++)
      b[axis] -= a[axis];
    double length = conic_length(b);
    longest = length > longest ? length : longest;
  }
  double sides = longest / (lattice_step * conic_spacing_at(s, depth));
  return sides >= (double)MOST_SIDES ? MOST_SIDES : sides > 1.0 ? (int)sides + 1 : 1;
}

static conic_status lay_lattices(conic_sampler *s) {
  const conic_clustered_mesh *mesh = s->job->mesh;
  size_t begin = mesh->starts[s->job->cluster], n = mesh->starts[s->job->cluster + 1] - begin;
  conic_status status =
      conic_memory_reserve(s->context, &s->now.lattices, 0, n, &s->now.lattices_room, sizeof *s->now.lattices);
  if (status == CONIC_OK)
    status = conic_memory_reserve(s->context, &s->facing, 0, n, &s->facing_room, sizeof *s->facing);
  if (status != CONIC_OK)
    return status;
  s->n_lattices = n;
  s->n_places = 0;
  s->finest = 0;
  s->coarsest = CONIC_MOST_DEPTH;
  for (size_t i = 0; i < n; i++) {
    uint32_t face = mesh->faces[begin + i];
    int depth = s->depth[i];
    s->now.lattices[i] = (conic_face_lattice){face, sides_of_face(s, face, depth), depth, (uint32_t)s->n_places};
    s->finest = depth > s->finest ? depth : s->finest;
    s->coarsest = depth < s->coarsest ? depth : s->coarsest;
    s->n_places += conic_face_lattice_places(s->now.lattices[i].sides);
    conic_cluster_face_normal(mesh, face, s->facing[i]);
  }
  size_t lattice_room = s->places_room;
  status = conic_memory_reserve(s->context, &s->now.owner, 0, s->n_places, &s->now.owner_room, sizeof *s->now.owner);
  if (status == CONIC_OK)
    status = conic_memory_reserve(s->context, &s->lattice_of, 0, s->n_places, &lattice_room, sizeof *s->lattice_of);
  if (status == CONIC_OK)
    status = conic_memory_reserve(s->context, &s->places, 0, s->n_places, &s->places_room, sizeof *s->places);
  return status;
}

/* As conic_cluster_place of each. */
static void find_places_of(conic_sampler *s, uint32_t i_lattice) {
  const conic_face_lattice *l = &s->now.lattices[i_lattice];
  double corners[3][3], shares[MOST_SIDES + 1];
  uint32_t place = l->first;
  for (int corner = 0; corner < 3; corner++)
    conic_mesh_corner(&s->job->mesh->mesh, l->face, corner, corners[corner]);
  for (int i = 0; i <= l->sides; i++)
    shares[i] = (double)i / (double)l->sides;
  for (int i = 0; i <= l->sides; i++)
    for (int j = 0; j <= l->sides - i; j++, place++) {
      double a = shares[l->sides - i - j], b = shares[i], c = shares[j];
      s->lattice_of[place] = i_lattice;
      for (int axis = 0; axis < 3; axis++)
        s->places[place][axis] = (a * corners[0][axis] + b * corners[1][axis]) + c * corners[2][axis];
    }
}

/* --- candidates --- */

/* Sides of a face, as bits by the corner where each begins: those that a place lies on. */
static int sides_at(const conic_face_lattice *l, int i, int j) {
  return (j == 0) | (i + j == l->sides) << 1 | (i == 0) << 2;
}

/* Those that the surfels must reach to by themselves: what lies across is no surfels, or nothing. */
static int rims_of(const conic_clustered_mesh *mesh, uint32_t face) {
  int rims = 0;
  for (int corner = 0; corner < 3; corner++) {
    uint32_t across = mesh->adjacency->across[3 * (size_t)face + (size_t)corner];
    int is_rim = conic_cluster_ends_at(mesh, face, corner) &&
                 (!conic_edge_is_shared(across) || !mesh->clusters->is_gathered[mesh->clusters->of_face[across / 3]]);
    rims |= is_rim << corner;
  }
  return rims;
}

/* Those whose places are another face's of the cluster, too, which answers for them. */
static int sides_of_others(const conic_clustered_mesh *mesh, uint32_t face) {
  int sides = 0;
  for (int corner = 0; corner < 3; corner++) {
    uint32_t across = mesh->adjacency->across[3 * (size_t)face + (size_t)corner];
    sides |= (!conic_cluster_ends_at(mesh, face, corner) && across / 3 < face) << corner;
  }
  return sides;
}

/* Whether a place is this lattice's. Where two faces of the cluster share a side, only one has its places. */
static int face_lattice_is_own(const conic_clustered_mesh *mesh, const conic_face_lattice *l, int i, int j) {
  return !(sides_at(l, i, j) & sides_of_others(mesh, l->face));
}

/* There is room for it. */
static void add_candidate(conic_sampler *s, uint32_t i_lattice, int i, int j, int is_first) {
  const conic_face_lattice *l = &s->now.lattices[i_lattice];
  uint64_t turn = conic_random_bits(l->face, (uint64_t)i << 16 | (uint64_t)j, 0) >> 43;
  int rank = (is_first ? 0 : CONIC_MOST_DEPTH + 1) + l->depth;
  s->candidates[s->n_candidates].key = (uint64_t)rank << 21 | turn;
  s->candidates[s->n_candidates].value = (uint32_t)s->n_candidates;
  s->seeds[s->n_candidates][0] = i_lattice;
  s->seeds[s->n_candidates++][1] = (uint32_t)i << 16 | (uint32_t)j;
}

static conic_status make_room_for_candidates(conic_sampler *s) {
  conic_status status =
      conic_memory_reserve(s->context, &s->candidates, 0, s->n_places, &s->candidates_room, sizeof *s->candidates);
  if (status == CONIC_OK)
    status = conic_memory_reserve(s->context, &s->seeds, 0, s->n_places, &s->seeds_room, sizeof *s->seeds);
  return status;
}

static conic_status list_candidates(conic_sampler *s) {
  conic_status status = make_room_for_candidates(s);
  s->n_candidates = 0;
  for (size_t k = 0; k < s->n_lattices && status == CONIC_OK; k++) {
    const conic_face_lattice *l = &s->now.lattices[k];
    int rims = rims_of(s->job->mesh, l->face), others = sides_of_others(s->job->mesh, l->face);
    for (int i = 0; i <= l->sides; i++)
      for (int j = 0; j <= l->sides - i; j++) {
        int sides = sides_at(l, i, j);
        if ((sides & rims) || !(sides & others))
          add_candidate(s, (uint32_t)k, i, j, (sides & rims) != 0);
      }
  }
  return status == CONIC_OK ? conic_radix_sort(s->context, s->candidates, s->n_candidates, 24) : status;
}

/* --- sites --- */

/* Becomes the owner of what it is nearest to, of the places from number `first` on. */
static conic_status add_site(conic_sampler *s, uint32_t i_lattice, int i, int j, size_t first) {
  const conic_face_lattice *l = &s->now.lattices[i_lattice];
  uint32_t place = conic_face_lattice_place(l, i, j);
  const double *at = s->places[place];
  conic_site *site = conic_memory_add(s->context, &s->now.sites, &s->now.n_sites, &s->now.sites_room, sizeof *site);
  if (!site)
    return CONIC_ERROR_MEMORY;
  memcpy(site->at, at, sizeof site->at);
  memcpy(site->foot, at, sizeof site->foot);
  conic_face_lattice_bary(l, i, j, site->bary);
  memcpy(site->facing, s->facing[i_lattice], sizeof site->facing);
  site->face = l->face;
  site->place = place;
  site->last = CONIC_NO_SITE;
  site->spacing = conic_spacing_at(s, s->depth[i_lattice]);
  conic_place_table_put(&s->table, (uint32_t)(s->now.n_sites - 1), at, s->facing[i_lattice], first);
  return CONIC_OK;
}

static conic_status fill_table(conic_sampler *s) {
  const conic_places places = {.n = s->n_places,
                               .at = (const double(*)[3])s->places,
                               .group = s->lattice_of,
                               .facing = (const double(*)[3])s->facing,
                               .depth = s->depth,
                               .spacing = s->job->spacing,
                               .coarsest = s->coarsest,
                               .finest = s->finest};
  return conic_place_table_fill(s->context, &s->table, &places, s->now.owner);
}

/* A candidate that lies near no site becomes one. */
static conic_status choose_sites(conic_sampler *s) {
  conic_status status = CONIC_OK;
  s->now.n_sites = 0;
  for (size_t k = 0; k < s->n_candidates && status == CONIC_OK; k++) {
    const uint32_t *seed = s->seeds[s->candidates[k].value];
    int i = (int)(seed[1] >> 16), j = (int)(seed[1] & 0xFFFF);
    if (s->now.owner[conic_face_lattice_place(&s->now.lattices[seed[0]], i, j)] == CONIC_NO_SITE)
      status = add_site(s, seed[0], i, j, 0);
  }
  return status;
}

/* Every place of the lattices belongs to the nearest site by now; where there is none near (a place that was no
 * candidate and lies in a fold), it becomes one, for itself and those after it. */
static conic_status choose_in_folds(conic_sampler *s) {
  conic_status status = CONIC_OK;
  size_t place = 0;
  for (size_t k = 0; k < s->n_lattices; k++) {
    const conic_face_lattice *l = &s->now.lattices[k];
    for (int i = 0; i <= l->sides; i++)
      for (int j = 0; j <= l->sides - i && status == CONIC_OK; j++, place++)
        if (s->now.owner[place] == CONIC_NO_SITE) {
          uint32_t own = (uint32_t)s->now.n_sites;
          status = add_site(s, (uint32_t)k, i, j, place);
          s->now.owner[place] = own; /* also where its face has no area and faces nothing */
        }
  }
  return status;
}

conic_status conic_cluster_find_sites(conic_sampler *s) {
  conic_status status = lay_lattices(s);
  if (status != CONIC_OK)
    return status;
  for (size_t k = 0; k < s->n_lattices; k++)
    find_places_of(s, (uint32_t)k);
  status = list_candidates(s);
  if (status == CONIC_OK)
    status = fill_table(s);
  if (status == CONIC_OK)
    status = choose_sites(s);
  return status == CONIC_OK ? choose_in_folds(s) : status;
}

/* --- what one pass over a cluster need not do again --- */

void conic_cluster_end_pass(conic_sampler *s) {
  conic_sampling_pass ended = s->now;
  s->now = s->last;
  s->last = ended;
}

static int is_as_fine(const conic_sampler *s, size_t k) {
  return s->now.lattices[k].depth == s->last.lattices[k].depth;
}

/* Two sites are the same where the place that each was chosen at, which it owns, is the same. Those that stayed are
 * settled for now; the last pass's tell which they are. */
static void match_sites(conic_sampler *s) {
  for (size_t i = 0; i < s->last.n_sites; i++)
    s->last.sites[i].last = CONIC_NO_SITE;
  for (uint32_t i = 0; i < s->now.n_sites; i++) {
    conic_site *site = &s->now.sites[i];
    uint32_t k = s->lattice_of[site->place];
    if (!is_as_fine(s, k) || s->now.owner[site->place] != i)
      continue;
    uint32_t place = site->place - s->now.lattices[k].first + s->last.lattices[k].first, last = s->last.owner[place];
    if (s->last.sites[last].place == place) {
      site->last = last;
      site->is_settled = 1;
      s->last.sites[last].last = i;
    }
  }
}

/* Whether each place of a face belongs to the site that it belonged to. */
static int is_as_it_was(const conic_sampler *s, size_t k) {
  const uint32_t *owner = s->now.owner + s->now.lattices[k].first, *last = s->last.owner + s->last.lattices[k].first;
  uint32_t n = conic_face_lattice_places(s->now.lattices[k].sides), i = 0;
  if (!is_as_fine(s, k))
    return 0;
  while (i < n && s->now.sites[owner[i]].last == last[i])
    i++;
  return i == n;
}

/* Neither who owns something of a face now nor who did is settled. */
static void unsettle(conic_sampler *s, size_t k) {
  const conic_face_lattice *now = &s->now.lattices[k], *then = &s->last.lattices[k];
  for (uint32_t i = 0; i < conic_face_lattice_places(now->sides); i++)
    s->now.sites[s->now.owner[now->first + i]].is_settled = 0;
  for (uint32_t i = 0; i < conic_face_lattice_places(then->sides); i++) {
    uint32_t same = s->last.sites[s->last.owner[then->first + i]].last;
    if (same != CONIC_NO_SITE)
      s->now.sites[same].is_settled = 0;
  }
}

void conic_cluster_settle_sites(conic_sampler *s) {
  match_sites(s);
  for (size_t k = 0; k < s->n_lattices; k++)
    if (!is_as_it_was(s, k))
      unsettle(s, k);
  for (size_t i = 0; i < s->now.n_sites; i++) {
    conic_site *site = &s->now.sites[i];
    if (!site->is_settled)
      continue;
    uint32_t place = site->place;
    *site = s->last.sites[site->last];
    site->place = place;
    site->is_settled = 1;
  }
}

/* --- how much the colours differ in what each site stands for --- */

void conic_site_begin_contrast(conic_site *site) {
  for (int k = 0; k < 3; k++) {
    site->lowest_seen[k] = HUGE_VAL;
    site->highest_seen[k] = -HUGE_VAL;
  }
}

void conic_site_note_color(conic_site *site, const double color[3]) {
  double lab[3];
  conic_oklab_of(color, lab);
  conic_widen_box(site->lowest_seen, site->highest_seen, lab);
}

void conic_site_end_contrast(conic_site *site) {
  double sides[3];
  conic_subtract(site->highest_seen, site->lowest_seen, sides);
  site->contrast = sides[0] >= 0.0 ? conic_length(sides) : 0.0;
}

conic_seen_change conic_site_change(const conic_site *site) {
  double steps = 0.5 * CONIC_SEEN_STEPS * site->contrast;
  return (conic_seen_change){steps, steps * site->ellipse.reach};
}

conic_seen_change conic_sites_change(const conic_sampler *s, conic_seen_change known) {
  conic_seen_sums sums = {0.0, 0.0, 0.0};
  for (size_t i = 0; i < s->now.n_sites; i++)
    conic_seen_sums_add(&sums, conic_site_change(&s->now.sites[i]), s->now.sites[i].area);
  return conic_seen_sums_change(&sums, known);
}

static void note_place(conic_sampler *s, const conic_face_lattice *l, int i, int j, double side) {
  conic_site *site = &s->now.sites[s->now.owner[conic_face_lattice_place(l, i, j)]];
  double bary[3], color[3], texel[3];
  if (site->is_settled)
    return;
  conic_face_lattice_bary(l, i, j, bary);
  conic_cluster_color(s->job->mesh, l->face, bary, color);
  conic_cluster_texel(s->job->mesh, l->face, bary, side, texel);
  for (int channel = 0; channel < 3; channel++)
    color[channel] *= texel[channel];
  conic_site_note_color(site, color);
}

void conic_cluster_find_contrasts(conic_sampler *s) {
  if (!conic_has_seen_colors(s->job->mesh->triangles))
    return;
  for (size_t i = 0; i < s->now.n_sites; i++)
    if (!s->now.sites[i].is_settled)
      conic_site_begin_contrast(&s->now.sites[i]);
  for (size_t k = 0; k < s->n_lattices; k++) {
    const conic_face_lattice *l = &s->now.lattices[k];
    for (int i = 0; i <= l->sides; i++)
      for (int j = 0; j <= l->sides - i; j++)
        if (face_lattice_is_own(s->job->mesh, l, i, j))
          note_place(s, l, i, j, 0.5 * conic_spacing_at(s, s->depth[k]));
  }
  for (size_t i = 0; i < s->now.n_sites; i++)
    conic_site_end_contrast(&s->now.sites[i]);
}
