/* Images: planes of pixels, read, written, compared.
 *
 * A plane is an array of width × height pixels, row by row from the top, the channels of a pixel side by side. Colour
 * is linear; rgba is premultiplied. */
#ifndef CONIC_IMAGE_H
#define CONIC_IMAGE_H

#include <stddef.h>
#include <stdint.h>

#include "conic/camera.h"
#include "conic/context.h"

CONIC_BEGIN_C

typedef enum conic_plane {
  CONIC_PLANE_RGBA = 0,     /* 4 floats: R, G, B premultiplied by A */
  CONIC_PLANE_Z = 1,        /* 1 float: camera-space z, 0 where nothing is */
  CONIC_PLANE_NORMAL = 2,   /* 3 floats: world, unit, towards the viewer; 0 where nothing is */
  CONIC_PLANE_ALBEDO = 3,   /* 3 floats: colour before shading */
  CONIC_PLANE_WEIGHT = 4,   /* 1 float: sum of the weights */
  CONIC_PLANE_COUNT = 5,    /* 1 uint32: splats blended */
  CONIC_PLANE_ID = 6,       /* 1 uint32: index of the nearest visible splat, 0xFFFFFFFF where nothing is */
  CONIC_PLANE_CLUSTER = 7,  /* 1 uint32: cluster of a hybrid model, 0xFFFFFFFF where nothing is; conic_hybrid_name fills
                               it */
  CONIC_PLANE_POSITION = 8, /* 3 floats: the world position at depth Z; 0 where nothing is; conic_image_locate fills
                               it */
  CONIC_PLANE_MATTE_0 = 9,  /* 4 floats: the first layer of a Cryptomatte, the bits of two names' hashes, each beside
                               its coverage; 0 where there are fewer names */
  CONIC_PLANE_MATTE_1 = 10, /* the second layer */
  CONIC_PLANE_MATTE_2 = 11, /* the third */
  CONIC_PLANE_TRANSPARENCY = 12, /* 1 float: T, what is left of the light from behind; this and the next four are of
                                    Gaussian scenes */
  CONIC_PLANE_MEDIAN_Z = 13,     /* 1 float: z of the Gaussian at which T falls to ½; 0 where it stays above */
  CONIC_PLANE_INVERSE_Z = 14,    /* 1 float: Σ w/z; 0 where nothing is */
  CONIC_PLANE_LAST = 15,         /* 1 uint32: the last Gaussian composited, 0xFFFFFFFF where nothing is */
  CONIC_PLANE_DOUBT = 16,        /* 1 uint32: how many decisions rounding may turn either way;
                                    conic_gaussian_find_doubts fills it */
  CONIC_PLANE_AO = 17,     /* 1 float: the part of the light from all around that nothing hides; conic_image_light fills
                              it */
  CONIC_PLANE_SHADOW = 18, /* 1 float: the part of the lights' power that nothing hides; conic_image_light fills it */
  CONIC_PLANE_SAMPLES =
      19, /* 1 uint32: how many samples were accumulated; conic/accumulate.h fills this and the next */
  CONIC_PLANE_VARIANCE = 20, /* 1 float: variance of the luminance's mean, from the difference of two halves of the
                                samples */
  CONIC_PLANE_MOTION = 21,   /* 4 floats, in pixels, x to the right and y down: from the pixel's sample to where what it
                                shows is a frame later, and to where it was a frame before; 0 where nothing is, or it is
                                behind the camera then. conic_shot_draw fills it */
  CONIC_PLANE_BOUND = 22, /* 1 float: no channel of rgba differs by more from the picture without an error and a budget;
                             conic_shot_draw fills it */
  CONIC_N_PLANES = 23
} conic_plane;

/* The planes that drawing fills, which are the first ones: their number, and their bits. */
#define CONIC_N_DRAWN_PLANES CONIC_PLANE_CLUSTER
#define CONIC_DRAWN_PLANES ((1u << CONIC_PLANE_CLUSTER) - 1u)

/* The planes that only Gaussian scenes have, as bits. */
#define CONIC_GAUSSIAN_PLANES (31u << CONIC_PLANE_TRANSPARENCY)

/* The planes of a Cryptomatte, as bits. */
#define CONIC_MATTE_PLANES (7u << CONIC_PLANE_MATTE_0)

/* Room for planes in structs, so that a later version may have more. */
#define CONIC_MAX_PLANES 24

#define CONIC_NO_ID 0xFFFFFFFFu

typedef struct conic_plane_description {
  const char *name;        /* as on the command line and in statistics: "rgba", "Z", "N", "albedo", … */
  int n_channels;          /* 1 to 4, each of 4 bytes */
  int is_uint;             /* channels are uint32 instead of float */
  const char *channels[4]; /* their names in an EXR: "R", "N.X", … */
} conic_plane_description;

/* Static data; null for a number that is no plane. */
CONIC_API const conic_plane_description *conic_plane_describe(conic_plane plane);

/* A named value that goes into an EXR's header. */
typedef enum conic_attribute_type {
  CONIC_ATTRIBUTE_TEXT = 0,
  CONIC_ATTRIBUTE_DOUBLE = 1,
  CONIC_ATTRIBUTE_MATRIX = 2,        /* 4 × 4, rows */
  CONIC_ATTRIBUTE_FLOAT = 3,         /* this and the next are written as floats */
  CONIC_ATTRIBUTE_FLOAT_PAIR = 4,    /* 2 values */
  CONIC_ATTRIBUTE_FLOAT_MATRIX = 5,  /* 4 × 4, rows */
  CONIC_ATTRIBUTE_CHROMATICITIES = 6 /* 8 values: x and y of red, green, blue and white */
} conic_attribute_type;

typedef struct conic_attribute {
  char name[40];
  conic_attribute_type type;
  char text[88];
  double values[16];
} conic_attribute;

#define CONIC_MAX_ATTRIBUTES 24

typedef struct conic_image {
  int width, height;
  void *planes[CONIC_MAX_PLANES]; /* float or uint32_t by conic_plane_describe; null: not there */
  int n_attributes;
  conic_attribute attributes[CONIC_MAX_ATTRIBUTES];
  uint64_t lacks_alpha; /* A of rgba is 1 and not in the file that the image was read from */
  uint64_t is_display;  /* rgba are display values: files of 8 or 16 bits take them unchanged */
  const char *manifest; /* the names of a Cryptomatte in JSON, for an EXR's header; the caller's. Null: none */
  uint64_t half_planes; /* bits of the planes that were read from half floats, or from 24 bits */
  const char *shot;     /* how it was made (conic/shot_file.h), for EXR, PNG and TIFF; the caller's. Null: not said */
  uint64_t reserved[3];
} conic_image;

/* Allocates the planes of `planes` (bit 1 << plane), contents zero. On failure *image is empty. Sizes are 1 to 65535.
 * Errors: ARGUMENT, MEMORY. */
CONIC_API conic_status conic_image_allocate(conic_context *context, int width, int height, unsigned planes,
                                            conic_image *image);
/* Which planes there are, as bits 1 << plane. */
CONIC_API unsigned conic_image_planes(const conic_image *image);
/* Releases the planes and leaves an empty image; null is allowed. */
CONIC_API void conic_image_release(conic_context *context, conic_image *image);

/* Fills the plane P, if the image has it, from the plane Z, which was drawn by this camera with `samples` × `samples`
 * samples a pixel. Errors: ARGUMENT (there is no Z, or not of this size). */
CONIC_API conic_status conic_image_locate(conic_context *context, const conic_camera *camera, int samples,
                                          conic_image *image);

/* 64-bit FNV-1a over the plane's little-endian bytes, row by row; 0 where the plane is not there. */
CONIC_API uint64_t conic_image_hash(const conic_image *image, conic_plane plane);

/* Adds the camera's attributes that programs expect in an EXR: worldToCamera and worldToNDC as OpenEXR defines them
 * (points are rows, to the left of the matrix; x right, y up, z forward; NDC (0, 0) to (1, 1) from the upper left),
 * screenWindowCenter, screenWindowWidth, pixelAspectRatio, and the chromaticities of Rec. 709. Attributes without room
 * are left out. */
CONIC_API void conic_image_describe_camera(conic_image *image, const conic_camera *camera);

/* How an EXR is compressed: all but the last keep every bit. */
typedef enum conic_compression {
  CONIC_COMPRESSION_ZIP = 0, /* 16 rows at a time */
  CONIC_COMPRESSION_NONE = 1,
  CONIC_COMPRESSION_RLE = 2,
  CONIC_COMPRESSION_ZIPS = 3, /* row by row */
  CONIC_COMPRESSION_PIZ = 4,
  CONIC_COMPRESSION_PXR24 = 5 /* floats lose 8 bits */
} conic_compression;

#define CONIC_N_COMPRESSIONS 6

/* "zip", "none", "rle" …; null for a number that is none. */
CONIC_API const char *conic_compression_name(conic_compression compression);

/* How linear colours become the codes of files of 8 and 16 bits. The curves bring colours brighter than 1 below 1; sRGB
 * then encodes them. Floats (EXR, PFM, HDR), alpha and display values never go through a curve. */
typedef enum conic_tone {
  CONIC_TONE_SRGB = 0,   /* no curve: colours above 1 are white */
  CONIC_TONE_FILMIC = 1, /* Hable's of 2010, channel by channel, with his exposure of 2 before: 5.6 is white */
  CONIC_TONE_ACES = 2,   /* Hill's fit of the Academy's reference rendering (ACES 1, for sRGB screens), with matrices */
  CONIC_TONE_AGX = 3     /* Sobotka's AgX, by Wrensch's polynomial: 16.5 stops, bright colours go towards white */
} conic_tone;

#define CONIC_N_TONES 4

/* "srgb", "filmic", "aces", "agx"; null for a number that is none. */
CONIC_API const char *conic_tone_name(conic_tone tone);

/* Maps a linear colour, not multiplied by alpha, to a linear colour from 0 to 1. CONIC_TONE_SRGB, or an unknown number,
 * leaves it as it is. Through a curve black stays black; negative numbers and NaN count as 0. `mapped` may be `linear`.
 * The bits are the same on every machine. */
CONIC_API void conic_tone_map(conic_tone tone, const float linear[3], float mapped[3]);

/* How an image is written. */
typedef struct conic_image_options {
  size_t size;        /* sizeof(conic_image_options), set by the init function */
  const char *format; /* "png", "exr" …: for "-" and for names without an ending; null: png for "-", none for
                         such names */
  int is_half;        /* of an EXR: rgba, N and albedo in half floats */
  conic_compression compression; /* of an EXR */
  conic_tone tone;               /* of files of 8 and 16 bits */
} conic_image_options;

/* Floats, zip, no curve. */
CONIC_API void conic_image_options_init_sized(conic_image_options *options, size_t size);
#define conic_image_options_init(options) conic_image_options_init_sized(options, sizeof *(options))

/* Writes the image by its name's ending: exr (all planes, float and uint32, attributes), pfm (rgb, built in; or one
 * other plane, also of whole numbers if floats hold them), png, and OpenImageIO's formats (tif, jpg …): rgba,
 * sRGB-encoded for integer formats, unpremultiplied where the format needs it. "-" is standard output. The file appears
 * under its name only when it is whole. Null options are the defaults. Errors: ARGUMENT (no plane the format can hold,
 * unknown ending), UNSUPPORTED (not in this build; numbers that no float holds), MEMORY, IO. */
CONIC_API conic_status conic_image_write_as(conic_context *context, const char *path, const conic_image *image,
                                            const conic_image_options *options);
/* conic_image_write_as with the default options. */
CONIC_API conic_status conic_image_write(conic_context *context, const char *path, const conic_image *image);

/* Whether conic_image_write_as could write an image with these planes (bits) under that name, as far as the name tells.
 * To be asked before the work. Errors: ARGUMENT, UNSUPPORTED, MEMORY, with the messages of writing. */
CONIC_API conic_status conic_image_check_output_as(conic_context *context, const char *path, unsigned planes,
                                                   const conic_image_options *options);
CONIC_API conic_status conic_image_check_output(conic_context *context, const char *path, unsigned planes);

/* Reads an image. Channels (EXR) and arrays (.npz) map to planes by name, all else to rgba. Colours are decoded to
 * linear, except NumPy's bytes and words. On success the caller owns *image. Errors: INPUT (also where it is no regular
 * file), UNSUPPORTED, MEMORY. */
CONIC_API conic_status conic_image_read(conic_context *context, const char *path, conic_image *image);

/* How two images differ. See docs/reference/diff.md for the definitions. */
typedef struct conic_plane_difference {
  int compared; /* the plane is in both images */
  double max_abs, rmse;
  double p999; /* of the pixels' largest differences */
} conic_plane_difference;

typedef struct conic_difference {
  int identical;           /* same size, same planes, same bits, a missing A being 1 */
  int same_size;           /* where 0, nothing below is set */
  double max_abs, rmse;    /* over all common planes, without those of names and counts; NaN against a number counts as
                              infinite */
  double p999;             /* 99.9 % of the pixels differ by no more in any of these planes */
  double psnr, ssim;       /* of R, G, B, sRGB-encoded, peak 1; psnr is infinite for equal pictures */
  double flip;             /* mean ꟻLIP of R, G, B, clamped to 0 … 1: 0 where nothing differs, 1 at most */
  size_t over_code;        /* pixels where R, G or B, sRGB-encoded, differ by more than 1/255 */
  int has_color;           /* both have rgba: psnr, ssim, flip and over_code are set */
  size_t differing_pixels; /* pixels where any common plane differs */
  size_t largest_hole;     /* pixels of the largest 4-connected set covered in the first and not in the second */
  conic_plane_difference planes[CONIC_MAX_PLANES];
  uint64_t lacks_alpha; /* rgba was compared by R, G and B alone: at least one of the images has no A */
  double ssim_padded;   /* ssim over the windows about all pixels, with zeros beyond the edges */
  uint64_t is_display;  /* rgba were compared as display values: at least one of the images has them */
  uint64_t reserved[5];
} conic_difference;

/* Turns linear rgba into display values: R, G and B are divided by A, sRGB-encoded, and multiplied by A. An image with
 * display values, or without rgba, stays as it is. */
CONIC_API void conic_image_encode(conic_image *image);

/* Compares `b` with the reference `a`. If one of them has display values, the other's rgba is encoded for the
 * comparison. Errors: ARGUMENT, MEMORY. */
CONIC_API conic_status conic_image_compare(conic_context *context, const conic_image *a, const conic_image *b,
                                           conic_difference *difference);

/* A false-colour picture of where `b` differs from `a` (rgba plane; same size needed): black where equal, then blue,
 * red, yellow, white by the logarithm of the largest channel's difference. On success the caller owns *heatmap. Errors:
 * ARGUMENT, MEMORY. */
CONIC_API conic_status conic_image_heatmap(conic_context *context, const conic_image *a, const conic_image *b,
                                           conic_image *heatmap);

/* A false-colour picture of ꟻLIP: black at 0, then linearly over blue, red and yellow to white at 1. Errors: as
 * conic_image_heatmap. */
CONIC_API conic_status conic_image_flip_heatmap(conic_context *context, const conic_image *a, const conic_image *b,
                                                conic_image *heatmap);

/* The exposure in stops that makes a picture with an rgba plane suitably bright: the greatest multiple of 1/8, from -16
 * to 16, with which at most one in twenty of the covered pixels (A at least 1/2) has a luminance above 2^(-3/8). 0
 * where nothing is covered, or all is black. */
CONIC_API double conic_image_exposure(const conic_image *image);

/* A false-colour picture of how many splats were blended in each pixel (count plane needed): black for none, blue for
 * one, red for 4, yellow for 16, white for 64 and more, by the logarithm between. On success the caller owns *map.
 * Errors: ARGUMENT, MEMORY. */
CONIC_API conic_status conic_image_overdraw(conic_context *context, const conic_image *image, conic_image *map);

/* conic_image_overdraw in the colours of Confetti (Fig. 18): black for none, blue for one, green for 8, red for 16 and
 * more, linear between. */
CONIC_API conic_status conic_image_overdraw_confetti(conic_context *context, const conic_image *image,
                                                     conic_image *map);

CONIC_END_C
#endif
