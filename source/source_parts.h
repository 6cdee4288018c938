/* One picture in windows, each of them to the bits of the whole: for several processes, of which none draws all. */
#ifndef CONIC_SOURCE_PARTS_H
#define CONIC_SOURCE_PARTS_H

#include "conic/source.h"
#include "raster/view/part.h"

/* What a kind counts of its windows. */
enum { CONIC_SOURCE_TALLIES = 4 };

/* Whether it can: by the processor, what its kind has windows of, and with transparency not every kind. */
int conic_source_has_windows(const conic_source *source, const conic_renderer *renderer, int is_transparent);

typedef struct conic_source_windows {
  conic_source *source;
  conic_renderer *renderer;
  conic_camera camera;
  conic_render_options render; /* settled */
  unsigned planes;
  int samples;
  int step;             /* windows begin at multiples of so many pixels, in rows from where their band begins, */
  int band_rows;        /* and none lies in two bands of so many rows */
  int is_summed;        /* the windows' statistics sum up to the picture's; else only fragments and pixels do */
  uint64_t other_bytes; /* of memory that is not the source's to take, beside the image at hand */
  uint64_t tallies[CONIC_SOURCE_TALLIES]; /* of the windows drawn so far: a sum over processes is all windows' */
  void *own;                              /* the kind's */
} conic_source_windows;

/* How a kind of source draws in windows. */
typedef struct conic_source_windowing {
  int has_transparency; /* whether its windows do */
  /* Chooses what the camera sees, and sets step, band_rows and is_summed. What it leaves in `own`, also on failure, is
   * ended. */
  conic_status (*begin)(conic_source_windows *windows);
  void (*end)(conic_source_windows *windows);
  /* The next three are the functions of this page. */
  conic_status (*draw)(conic_source_windows *windows, const conic_window *window, conic_image *image,
                       conic_render_statistics *statistics);
  conic_status (*count)(const conic_source_windows *windows, conic_render_statistics *statistics); /* null: nothing */
  void (*weigh)(const conic_source_windows *windows, const conic_window *list, size_t n, double *weights);
  conic_status (*deal)(conic_source_windows *windows, const conic_window *list, size_t n, int is_in_order,
                       int *owners); /* null: who draws a window is not the kind's to say */
} conic_source_windowing;

/* Of what is chosen before it is drawn. */
extern const conic_source_windowing conic_source_windowing_choice;

/* Chooses what the camera sees, which stays chosen until the source's next picture. `planes`: those of the images that
 * come. The caller ends what was begun, on failure too. Errors: as conic_source_draw; UNSUPPORTED where it has no
 * windows. */
conic_status conic_source_windows_begin(conic_source *source, conic_renderer *renderer, const conic_camera *camera,
                                        const conic_render_options *render, const conic_source_view *view,
                                        unsigned planes, conic_source_windows *windows);
void conic_source_windows_end(conic_source_windows *windows);

/* Whether a process only draws windows that are dealt to it: the source is a team's, and nobody has all of it. */
int conic_source_windows_are_dealt(const conic_source_windows *windows);

/* Collective, of such a source, once it has begun: deals the windows of a list, which all have alike, and gives this
 * process what its own need. owners[i] becomes who draws window i, the first process the first. Where they are wanted
 * `is_in_order`, everybody gets some of the first ones. Errors: MEMORY, CANCELLED. */
conic_status conic_source_windows_deal(conic_source_windows *windows, const conic_window *list, size_t n,
                                       int is_in_order, int *owners);

/* Draws the window's pixels into an image of its size. Of `statistics`, fragments and pixels are the window's, all else
 * the band's, or the window's part of the picture's. Windows are best drawn band by band. Errors: as conic_source_draw.
 */
conic_status conic_source_windows_draw(conic_source_windows *windows, const conic_window *window, conic_image *image,
                                       conic_render_statistics *statistics);

/* Makes of the sum of all windows' statistics those of the picture, which the source's facts are then about. Errors:
 * MEMORY, CANCELLED. */
conic_status conic_source_windows_count(const conic_source_windows *windows, conic_render_statistics *statistics);

/* How much work each of the windows is, about: of what lies in it, and of its pixels. Neither
 * their first nor their last rows ever decrease. */
void conic_source_windows_weigh(const conic_source_windows *windows, const conic_window *list, size_t n,
                                double *weights);

/* Adds to the weights the places (three arrays of `count`, from `origin` on) that lie in them; `columns` may be null.
 */
void conic_source_windows_weigh_places(const conic_source_windows *windows, float *const columns[3], size_t count,
                                       const double origin[3], const conic_window *list, size_t n, double *weights);

#endif
