/* Pictures of Gaussian scenes, composited by alpha: docs/reference/gaussians.md defines each profile to the bit. */
#ifndef CONIC_GAUSSIAN_RENDER_H
#define CONIC_GAUSSIAN_RENDER_H

#include <stddef.h>
#include <stdint.h>

#include "conic/camera.h"
#include "conic/context.h"
#include "conic/gaussians.h"
#include "conic/image.h"
#include "conic/isa.h"

CONIC_BEGIN_C

/* What a renderer does with a Gaussian. A profile that is named after a program draws what that version of the program
 * draws; it never changes. */
typedef enum conic_gaussian_profile {
  CONIC_PROFILE_EXACT = 0, /* the response along each pixel's own ray, in the order along that ray */
  CONIC_PROFILE_INRIA_2023 = 1,
  CONIC_PROFILE_GSPLAT_1_5 = 2,
  CONIC_PROFILE_GSPLAT_1_5_AA = 3, /* "antialiased": faint where the dilation is large */
  CONIC_PROFILE_GSPLAT_1_6 = 4,
  CONIC_PROFILE_GSPLAT_1_6_AA = 5,
  CONIC_PROFILE_2DGS_2024 = 6,   /* the 2D Gaussians of their authors' program */
  CONIC_PROFILE_2DGS_GSPLAT = 7, /* and of gsplat's */
  CONIC_PROFILE_KHR_2026 = 8,    /* KHR_gaussian_splatting, release candidate */
  CONIC_PROFILE_INRIA_2023_AA = 9,
  CONIC_PROFILE_MIP_2023 = 10, /* Mip-Splatting */
  CONIC_PROFILE_BRUSH_1 = 11,
  CONIC_PROFILE_SPLAT_2023 = 12,   /* antimatter15/splat */
  CONIC_PROFILE_PLAYCANVAS_2 = 13, /* PlayCanvas by WebGL */
  CONIC_PROFILE_SPARK_2 = 14,
  CONIC_PROFILE_GS3D_0_4 = 15,  /* GaussianSplats3D */
  CONIC_PROFILE_3DGUT_2025 = 16 /* gsplat 1.6 with_ut and with_eval3d */
} conic_gaussian_profile;

#define CONIC_N_GAUSSIAN_PROFILES 17

/* "exact", "inria-2023" …; null for a number that is no profile. */
CONIC_API const char *conic_gaussian_profile_name(conic_gaussian_profile profile);

/* Another device that composites: conic_opencl_gaussian_device of conic/opencl.h. */
typedef struct conic_gaussian_device conic_gaussian_device;

typedef struct conic_gaussian_options {
  size_t size; /* sizeof(conic_gaussian_options), set by the init function */
  conic_gaussian_profile profile;
  float background[3];           /* behind the Gaussians: colour · T is added to R, G, B */
  conic_isa isa;                 /* as the context has it */
  uint32_t ignores_center;       /* ignore the camera's centre where the profile ignores it; else such a profile refuses
                                    a camera that is not centred */
  conic_gaussian_device *device; /* composites in the place of the processor; null: none. No bit depends on it. */
  double prefilter; /* of `exact`: the variance of the filter on the screen, h, in square pixels, 0 to 10000 */
} conic_gaussian_options;

/* Exact, black, no filter. */
CONIC_API void conic_gaussian_options_init_sized(conic_gaussian_options *options, size_t size);
#define conic_gaussian_options_init(options) conic_gaussian_options_init_sized(options, sizeof *(options))

/* What a picture of Gaussians consists of, each of width × height numbers times its channels. Null: not wanted. */
typedef struct conic_gaussian_planes {
  int width, height;
  float *rgb;          /* 3: display values over the background, as the profile composites them */
  float *transparency; /* T: what is left of the light from behind */
  float *z; /* Σ w·z / Σ w, where z is of the mean, of the hit or of the greatest response, by the profile; 0: no
               Gaussian */
  float *median_z;        /* of the Gaussian at which T falls to ½; 0 where it stays above */
  float *inverse_z;       /* Σ w/z */
  float *normal;          /* 3: Σ w·n in the world, n the shortest axis, towards the eye */
  uint32_t *count;        /* Gaussians composited */
  uint32_t *id;           /* the Gaussian with the largest w, the first of equal ones; CONIC_NO_ID: none */
  uint32_t *last;         /* the last one composited */
  const float *surface_z; /* given: Gaussians whose z there is not below it are left out, as a surface hides them; 0
                             there: none is; null: nowhere */
  uint64_t reserved[7];
} conic_gaussian_planes;

typedef struct conic_gaussian_statistics {
  size_t gaussians_in, gaussians_skipped, gaussians_culled, gaussians_drawn; /* skipped: a number is not finite */
  size_t entries;                                                            /* of tiles' lists */
  double seconds_setup, seconds_sort, seconds_bin, seconds_composite;
  conic_isa isa;         /* what the hot loops used */
  int tile;              /* edge in pixels */
  uint64_t device_units; /* compute units of the device that composited; 0: the processor did */
  uint64_t pairs;        /* of a Gaussian and a pixel that it was blended into */
  uint64_t reserved[6];
} conic_gaussian_statistics;

/* Draws into the planes that are there. The bits are the same for any number of threads and every instruction set. Null
 * options are the defaults; statistics may be null. Errors: ARGUMENT, MEMORY, CANCELLED, UNSUPPORTED (the instruction
 * set, or the device cannot). */
CONIC_API conic_status conic_gaussians_render(conic_context *context, const conic_gaussians *gaussians,
                                              const conic_camera *camera, const conic_gaussian_options *options,
                                              conic_gaussian_planes *planes, conic_gaussian_statistics *statistics);

/* Writes a deep EXR, whose pixels have a sample for each Gaussian that they are composited of, in the order of depth:
 * alpha, its colour times that, the z of the plane Z, its number as id, and its share of the light as weight. Laid over
 * each other they give the picture, where the profile's order is that of depth. Surfaces of the picture's size, with
 * rgba, Z and id, are the samples behind; null: there are none. `header` gives the attributes; null: none. The file
 * appears when it is whole; how large it is is logged before. Errors: as conic_gaussians_render, ARGUMENT, UNSUPPORTED
 * (a build without OpenEXR), IO. */
CONIC_API conic_status conic_gaussians_write_deep(conic_context *context, const conic_gaussians *gaussians,
                                                  const conic_camera *camera, const conic_gaussian_options *options,
                                                  const conic_image *surfaces, const char *path,
                                                  const conic_image *header);

/* Whose share of the light an id is: of a Gaussian, or, counted on after these, of a surface. */
typedef size_t conic_gaussian_namer(const void *cookie, uint32_t id);

/* Finds how much of the light of each pixel is whose: shares[n_names·pixel + name_of(cookie, id)], for names below
 * n_names; together they are the pixel's alpha. The camera, and the surfaces (as above), are of samples × samples a
 * pixel. Errors: as conic_gaussians_render. */
CONIC_API conic_status conic_gaussians_find_shares(conic_context *context, const conic_gaussians *gaussians,
                                                   const conic_camera *camera, const conic_gaussian_options *options,
                                                   const conic_image *surfaces, int samples, size_t n_names,
                                                   conic_gaussian_namer *name_of, const void *cookie, float *shares);

CONIC_END_C
#endif
