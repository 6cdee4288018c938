/* Why a picture is wrong: which mistake of a renderer, or which other profile, explains its differences.
 * docs/reference/diagnosis.md says what each name means. */
#ifndef CONIC_DIAGNOSIS_H
#define CONIC_DIAGNOSIS_H

#include "conic/gaussian_judge.h"

CONIC_BEGIN_C

typedef struct conic_diagnosis {
  const char *name;    /* of a mistake, "half-pixel" …, or of a profile; static */
  const char *with;    /* the second name, where only two together explain the picture; else null */
  double share;        /* the part of all judged pixels' difference that it explains: 1 where nothing is left */
  uint32_t righted;    /* wrong pixels that would be right by it … */
  uint32_t spoilt;     /* … and right ones that would be wrong */
  uint32_t is_nearest; /* it does not explain the picture, but nothing that was tried comes nearer */
  uint32_t reserved;
} conic_diagnosis;

#define CONIC_MOST_DIAGNOSES 16

/* Looks at the wrong pixels of a picture, as conic_gaussian_judge found them by the same arguments. `classes` has the
 * picture's size; values above CONIC_PIXEL_WRONG mark pixels that were not judged. `found` takes at most `room`
 * explanations, the best first, and *n_found says how many there are: none where no pixel is wrong, or where nothing
 * explains the picture. Two names that explain it together are two entries, one after the other. Reports progress as
 * "diagnose". Errors: ARGUMENT, MEMORY, CANCELLED. */
CONIC_API conic_status conic_gaussian_diagnose(conic_context *context, const conic_gaussians *gaussians,
                                               const conic_camera *camera, const conic_gaussian_options *options,
                                               const conic_gaussian_judging *judging, const conic_image *image,
                                               const uint8_t *classes, conic_diagnosis *found, int room, int *n_found);

/* conic_gaussian_diagnose for surface splats and triangles, with samples × samples samples a pixel, as
 * conic_oracle_judge found the wrong pixels; `options` as for conic_render. */
CONIC_API conic_status conic_drawing_diagnose(conic_context *context, const conic_drawing *drawing,
                                              const conic_camera *camera, const conic_render_options *options,
                                              int samples, const conic_oracle_judging *judging,
                                              const conic_image *image, const uint8_t *classes, conic_diagnosis *found,
                                              int room, int *n_found);

/* Where a picture is wrong, if that is a place, or some of its values, and all else is right. */
typedef struct conic_fault_place {
  const char *kind; /* "nan", "plane", "channel", "tile", "row", "column", "border", "half", "every" or "checkerboard";
                       static; null: nothing of that kind */
  const char *what; /* of a plane or channel, its name; of a border or half, "left", "right", "top" or "bottom"; of
                       every n-th, "row" or "column"; else null */
  int at[2];        /* of NaN and infinity, the first pixel; of a tile, its column and row; of rows, columns, halves and
                       every n-th, the first of them */
  int size;         /* the tile's edge or the band's width, in pixels; or the n of every n-th */
  int is_constant;  /* the picture has one value all over the place */
  size_t pixels;    /* wrong ones there */
  uint64_t reserved[2];
} conic_fault_place;

#define CONIC_MOST_FAULT_PLACES 4

/* Finds such places; *n says how many. `greatest` and `faults` are as in conic_gaussian_judging, and may be null.
 * Cannot fail. */
CONIC_API void conic_faults_locate(const conic_image *image, const conic_image *greatest, const uint8_t *classes,
                                   const uint32_t *faults, conic_fault_place places[CONIC_MOST_FAULT_PLACES], int *n);

/* What a name stands for, in a sentence: "Pixel centres are half a pixel off." Static; null for an unknown name. */
CONIC_API const char *conic_diagnosis_meaning(const char *name);

CONIC_END_C
#endif
