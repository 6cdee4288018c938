/* How much the colours differ in what each site stands for. */
#ifndef CONIC_CLUSTER_CONTRAST_H
#define CONIC_CLUSTER_CONTRAST_H

#include "lod/clusters/cluster_sites.h"

/* The box of no colour. */
void conic_site_begin_contrast(conic_site *site);

/* Widens the box by a linear colour. */
void conic_site_note_color(conic_site *site, const double color[3]);

/* Takes the diagonal of the box as the site's contrast, in steps of 1: black and white. */
void conic_site_end_contrast(conic_site *site);

/* How the colours that a site stands for differ from its own, which is in their middle. They are smeared as far as it
 * reaches. */
conic_seen_change conic_site_change(const conic_site *site);

/* The root mean square over all sites, or what is known where that is more. */
conic_seen_change conic_sites_change(const conic_sampler *sampler, conic_seen_change known);

/* Fills in the contrasts of the sites that are not settled: how far apart the colours are of the places that they own,
 * and of details between these. */
void conic_cluster_find_contrasts(conic_sampler *sampler);

#endif
