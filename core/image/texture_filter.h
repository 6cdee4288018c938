/* The constants of elliptical texture filtering (docs/reference/picture.md, Textures), shared by plain C, device
 * programs and the lanes of raster/loops/texture_body.h. */
#pragma once

/* The filters of a pixel and of a texel have a standard deviation of half their width, and end at two of these. */
#define CONIC_FILTER_VARIANCE 0.25f
#define CONIC_FILTER_SUPPORT 4.0f
#define CONIC_FILTER_END 0x1.152aaap-3f /* e⁻², subtracted from the Gaussian so that it ends at 0 */

/* Only texels within a larger ellipse are read. It is larger by more than all rounding, so texels beyond it surely
 * weigh nothing. */
#define CONIC_FILTER_SPAN 4.05f

/* The greatest ratio of a footprint's length to its width: a narrower footprint is widened. */
#define CONIC_FILTER_RATIO 8.0f

/* The least half width, in texels of its level, of a footprint filtered on any level but the first. The greater it is,
 * the less a texel's filter blurs, and the more texels a pixel reads. */
#define CONIC_FILTER_WIDTH 1.5f

/* Farther out than this, sums have no digits left. */
#define CONIC_TEXTURE_FARTHEST 1e6f

/* In texels: a footprint of this width sees the whole picture at once, and so does one of an eighth of it; squares of
 * squares do not overflow. */
#define CONIC_TEXTURE_WIDEST 1e8f
