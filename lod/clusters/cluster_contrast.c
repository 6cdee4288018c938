#include "lod/clusters/cluster_contrast.h"

/* Whether a mesh has more than one colour at all. */
static int has_colors(const conic_triangles *t) {
  int has_texture = 0;
  for (size_t i = 0; i < t->n_materials; i++)
    has_texture |= t->materials[i].texture != NULL;
  return t->color[0] || has_texture || (t->n_materials > 1 && t->material);
}

static void note_color(conic_sampler *s, const conic_face_lattice *l, int i, int j, double side) {
  conic_site *site = &s->sites[s->owner[conic_face_lattice_place(l, i, j)]];
  double bary[3], color[3], texel[3];
  if (site->is_settled)
    return;
  conic_face_lattice_bary(l, i, j, bary);
  conic_cluster_color(s->job->mesh, l->face, bary, color);
  conic_cluster_texel(s->job->mesh, l->face, bary, side, texel);
  for (int channel = 0; channel < 3; channel++) {
    double shown = conic_as_shown(color[channel] * texel[channel]);
    site->darkest[channel] = shown < site->darkest[channel] ? shown : site->darkest[channel];
    site->brightest[channel] = shown > site->brightest[channel] ? shown : site->brightest[channel];
  }
}

void conic_cluster_find_contrasts(conic_sampler *s) {
  if (!has_colors(s->job->mesh->triangles))
    return;
  for (size_t i = 0; i < s->n_sites; i++)
    for (int channel = 0; channel < 3 && !s->sites[i].is_settled; channel++) {
      s->sites[i].darkest[channel] = 1.0;
      s->sites[i].brightest[channel] = 0.0;
    }
  for (size_t k = 0; k < s->n_lattices; k++) {
    const conic_face_lattice *l = &s->lattices[k];
    for (int i = 0; i <= l->sides; i++)
      for (int j = 0; j <= l->sides - i; j++)
        if (conic_face_lattice_is_own(s->job->mesh, l, i, j))
          note_color(s, l, i, j, conic_spacing_at(s, s->depth[k]));
  }
  for (size_t i = 0; i < s->n_sites; i++)
    for (int channel = 0; channel < 3; channel++) {
      double difference = s->sites[i].brightest[channel] - s->sites[i].darkest[channel];
      s->sites[i].contrast = difference > s->sites[i].contrast ? difference : s->sites[i].contrast;
    }
}
