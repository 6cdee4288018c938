/* The meanings of the names of mistakes; docs/reference/diagnosis.md says more. */
#include <string.h>

#include "conic/diagnosis.h"

static const struct {
  const char *name, *meaning;
} meanings[] = {
    {"surfaces-behind", "Gaussians behind surfaces are drawn, too."},
    {"surfaces-before", "Surfaces hide the Gaussians before them, too."},
    {"surfaces-linear", "The surfaces' linear colours are not encoded before Gaussians are mixed with them."},
    {"dilation-0", "Ellipses are not widened on the screen."},
    {"dilation-0.1", "Ellipses are widened by 0.1 square pixels."},
    {"dilation-0.5", "Ellipses are widened by half a square pixel."},
    {"dilation-1", "Ellipses are widened by a square pixel."},
    {"alpha-max-1", "Alpha is 1 at most."},
    {"alpha-min-0", "Alpha has no least value."},
    {"exp2", "The falloff is a power of 2 in place of e."},
    {"falloff-not-halved", "The falloff is e^(-q) in place of e^(-q/2)."},
    {"order-coarse", "Gaussians are sorted by depths of few bits."},
    {"scale-order", "The axes of the scales are exchanged."},
    {"scale-factor", "Gaussians are larger or smaller by one factor."},
    {"jacobian-sign", "The Jacobian's third column has the other sign."},
    {"view-rotation", "Covariances are not turned into the camera's axes, or the wrong way round."},
    {"alpha-twice", "Colours are multiplied by alpha twice."},
    {"transmittance-after", "Weights take the light that is left after a Gaussian, and not before it."},
    {"last-batch", "The last Gaussians of the file, which fill no whole batch, are missing."},
    {"focal-exchanged", "The two focal lengths are exchanged."},
    {"focal-length", "Both focal lengths are off by one factor."},
    {"cross-term", "The mixed term of the quadratic form has a wrong factor or sign."},
    {"sh-direction", "The harmonics' direction is reversed, or taken from a wrong eye."},
    {"sh-sign", "A harmonic has the other sign."},
    {"sh-offset", "Colours lack the half that is added to the harmonics."},
    {"colours-not-clamped", "Gaussians' colours may be below 0."},
    {"colours-clamped", "Gaussians' colours are at most 1."},
    {"shifted", "The picture is a pixel off."},
    {"bgr", "Red and blue are exchanged."},
    {"clipped", "The picture is cut off at 0 and 1: --clipped makes it right."},
    {"z-not-divided", "Depths are not divided by alpha."},
    {"centre-flipped", "The principal point is measured from the other side."},
    {"extent-3-sigma", "Gaussians end 3 standard deviations from their centres."},
    {"extent-2-sigma", "Gaussians end 2 standard deviations from their centres."},
    {"extent-1-sigma", "Gaussians end 1 standard deviation from their centres."},
    {"extent-exact", "Gaussians do not end where the profile ends them."},
    {"alpha-max-0.999", "Alpha is 0.999 at most."},
    {"alpha-max-0.99", "Alpha is 0.99 at most."},
    {"falloff-renormalised", "The falloff is scaled so that it is 0 where it ends."},
    {"order-distance", "Gaussians are sorted by their distance from the eye."},
    {"order-file", "Gaussians are composited in the order of the file."},
    {"order-z", "Gaussians are sorted by the depth of their means."},
    {"order-reversed", "Gaussians are sorted the wrong way round."},
    {"near", "The near plane is elsewhere."},
    {"sh-degree-0", "Only the harmonic of degree 0 is used."},
    {"sh-degree-1", "Harmonics above degree 1 are left out."},
    {"sh-degree-2", "Harmonics above degree 2 are left out."},
    {"f-rest-interleaved", "Harmonics above degree 0 are read in the wrong order of channels and coefficients."},
    {"quaternion-xyzw", "Quaternions are read in the wrong order: x, y, z, w for w, x, y, z, or the reverse."},
    {"quaternion-conjugate", "Gaussians are turned the wrong way round."},
    {"quaternion-not-normalised", "Quaternions are not brought to length 1."},
    {"scale-linear", "The exponential of the scales is missing, or is taken twice."},
    {"opacity-linear", "The sigmoid of the opacities is missing, or is taken twice."},
    {"half-pixel", "Pixel centres are half a pixel off."},
    {"mirrored-x", "Left and right are exchanged."},
    {"mirrored-y", "The picture stands on its head."},
    {"centre-ignored", "The camera's principal point is taken to be the picture's middle."},
    {"field-of-view", "One focal length or one angle of view is used for both axes."},
    {"srgb-decoded", "Colours are decoded from sRGB once too often."},
    {"srgb-encoded", "Colours are encoded to sRGB once too often."},
    {"premultiplied", "Colours are multiplied by alpha once too often, or divided by it."},
    {"background-white", "The background is white."},
    {"background-black", "The background is black, or left out."},
    {"background-twice", "The background is added twice, or whole where Gaussians hide some of it."},
    {"affine", "Splats are projected by the Jacobian at their centres."},
    {"no-amplitude", "What the filter widens is not made fainter for it."},
    {"epsilon-in-z", "The depth tolerance is taken along the camera's axis, and not along the ray."},
    {"radius-as-sigma", "Radii are taken for standard deviations, or the reverse."},
    {"no-normalisation", "Colours are not divided by the sum of the weights."},
    {"back-faces", "What faces away is left out, or is drawn where it should not be."},
};

const char *conic_diagnosis_meaning(const char *name) {
  for (size_t i = 0; name && i < sizeof meanings / sizeof *meanings; i++)
    if (strcmp(meanings[i].name, name) == 0)
      return meanings[i].meaning;
  for (int profile = 0; name && profile < CONIC_N_GAUSSIAN_PROFILES; profile++)
    if (strcmp(conic_gaussian_profile_name((conic_gaussian_profile)profile), name) == 0)
      return "It is a picture of another profile.";
  return NULL;
}
