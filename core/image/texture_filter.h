/* The numbers of elliptical texture filtering (docs/reference/picture.md, Textures), shared by plain C, a device's
 * programs and the lanes of raster/loops/texture_body.h. */
#ifndef CONIC_TEXTURE_FILTER_H
#define CONIC_TEXTURE_FILTER_H

/* The filter of a pixel, and that of a texel, have a standard deviation of half their width, and end at two. */
#define CONIC_FILTER_VARIANCE 0.25f
#define CONIC_FILTER_SUPPORT 4.0f
#define CONIC_FILTER_END 0x1.152aaap-3f /* e⁻², which the Gaussian is lowered by, so that it ends at 0 */

/* Texels of a row are looked at only within an ellipse that is larger by more than all rounding: what is beyond has no
 * weight, whatever rounding does. */
#define CONIC_FILTER_SPAN 4.05f

/* A footprint is no more than so many times as long as wide: a narrower one is widened. */
#define CONIC_FILTER_RATIO 8.0f

/* In texels of a level, the least half width of a footprint that is filtered on it, but for the first. The more, the
 * less the filter of a texel blurs, and the more texels a pixel reads. */
#define CONIC_FILTER_WIDTH 1.5f

/* No sum of what is farther out than this has any digits left. */
#define CONIC_TEXTURE_FARTHEST 1e6f

/* In texels: what is as wide as this, an eighth of it too, sees the whole picture at once; squares of squares do not
 * overflow. */
#define CONIC_TEXTURE_WIDEST 1e8f

#endif
