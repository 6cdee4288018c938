/* How much the colours differ in what each site stands for. */
#include "lod/clusters/cluster_sites.h"

#include "core/base/color.h"
#include "core/base/vectors.h"
#include "lod/clusters/cluster_seen.h"

void conic_site_begin_contrast(conic_site *site) {
  for (int k = 0; k < 3; k++) {
    site->lowest_seen[k] = HUGE_VAL;
    site->highest_seen[k] = -HUGE_VAL;
  }
}

void conic_site_note_color(conic_site *site, const double color[3]) {
  double lab[3];
  conic_oklab_of(color, lab);
  for (int k = 0; k < 3; k++) {
    site->lowest_seen[k] = lab[k] < site->lowest_seen[k] ? lab[k] : site->lowest_seen[k];
    site->highest_seen[k] = lab[k] > site->highest_seen[k] ? lab[k] : site->highest_seen[k];
  }
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
  for (size_t i = 0; i < s->n_sites; i++)
    conic_seen_sums_add(&sums, conic_site_change(&s->sites[i]), s->sites[i].area);
  return conic_seen_sums_change(&sums, known);
}

static void note_place(conic_sampler *s, const conic_face_lattice *l, int i, int j, double side) {
  conic_site *site = &s->sites[s->owner[conic_face_lattice_place(l, i, j)]];
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
  for (size_t i = 0; i < s->n_sites; i++)
    if (!s->sites[i].is_settled)
      conic_site_begin_contrast(&s->sites[i]);
  for (size_t k = 0; k < s->n_lattices; k++) {
    const conic_face_lattice *l = &s->lattices[k];
    for (int i = 0; i <= l->sides; i++)
      for (int j = 0; j <= l->sides - i; j++)
        if (conic_face_lattice_is_own(s->job->mesh, l, i, j))
          note_place(s, l, i, j, 0.5 * conic_spacing_at(s, s->depth[k]));
  }
  for (size_t i = 0; i < s->n_sites; i++)
    conic_site_end_contrast(&s->sites[i]);
}
