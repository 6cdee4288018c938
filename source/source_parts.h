/* A picture drawn in windows, each with the bits of the whole, by several processes that each draw only some. */
#pragma once

#include "conic/source.h"
#include "raster/view/part.h"

/* Counts that a kind keeps of its windows. */
enum { CONIC_SOURCE_TALLIES = 4 };

/* Whether a source can be drawn in windows: the processor must draw, and the kind must have windows; not every kind has
 * them with transparency. */
int conic_source_has_windows(const conic_source *source, const conic_renderer *renderer, int is_transparent);

typedef struct conic_source_windows {
  conic_source *source;
  conic_renderer *renderer;
  conic_camera camera;
  conic_render_options render; /* settled */
  unsigned planes;
  int samples;
  int step;             /* windows begin at multiples of so many pixels, in rows counted from the start of their band
                           … */
  int band_rows;        /* … and none crosses the border of two bands, each of so many rows */
  int is_summed;        /* the windows' statistics add up to the picture's; else only fragments and pixels do */
  uint64_t other_bytes; /* memory that the source must leave free, besides the current image */
  uint64_t tallies[CONIC_SOURCE_TALLIES]; /* of the windows drawn so far; their sum over all processes is that of all
                                             windows */
  void *own;                              /* the kind's data */
} conic_source_windows;

/* How a kind of source draws in windows. */
typedef struct conic_source_windowing {
  int has_transparency; /* its windows can have transparency */
  /* Chooses what the camera sees, and sets step, band_rows and is_summed. `end` releases `own`, after a failure,
   * too. */
  conic_status (*begin)(conic_source_windows *windows);
  void (*end)(conic_source_windows *windows);
  /* The next three implement the functions below. */
  conic_status (*draw)(conic_source_windows *windows, const conic_window *window, conic_image *image,
                       conic_render_statistics *statistics);
  conic_status (*count)(const conic_source_windows *windows, conic_render_statistics *statistics); /* null: nothing */
  void (*weigh)(const conic_source_windows *windows, const conic_window *list, size_t n, double *weights);
  conic_status (*deal)(conic_source_windows *windows, const conic_window *list, size_t n, int is_in_order,
                       int *owners); /* null: the kind does not decide who draws a window */
} conic_source_windowing;

/* For kinds that choose before they draw. */
extern const conic_source_windowing conic_source_windowing_choice;

/* Chooses what the camera sees; the choice stays until the source's next picture. `planes` are those of the windows'
 * images. The caller ends the windows, on failure too. Errors: as conic_source_draw; UNSUPPORTED where the source has
 * no windows. */
conic_status conic_source_windows_begin(conic_source *source, conic_renderer *renderer, const conic_camera *camera,
                                        const conic_render_options *render, const conic_source_view *view,
                                        unsigned planes, conic_source_windows *windows);
void conic_source_windows_end(conic_source_windows *windows);

/* Whether a process may only draw windows that are dealt to it: the source belongs to a team, and no process has all of
 * it. */
int conic_source_windows_are_dealt(const conic_source_windows *windows);

/* Collective, for such a source, after beginning: deals the windows of a list, the same in all processes, and brings
 * each process the splats that its windows need. owners[i] is the process that draws window i; the first one is the
 * first process's. With `is_in_order`, every process gets some of the first windows. Errors: MEMORY, CANCELLED. */
conic_status conic_source_windows_deal(conic_source_windows *windows, const conic_window *list, size_t n,
                                       int is_in_order, int *owners);

/* Draws the window's pixels into an image of its size. In `statistics`, fragments and pixels are the window's; other
 * counts are the band's, or the window's part of the picture's. Drawing band by band is quickest. Errors: as
 * conic_source_draw. */
conic_status conic_source_windows_draw(conic_source_windows *windows, const conic_window *window, conic_image *image,
                                       conic_render_statistics *statistics);

/* Turns the sum of all windows' statistics into the picture's; the source's facts are then about the picture. Errors:
 * MEMORY, CANCELLED. */
conic_status conic_source_windows_count(const conic_source_windows *windows, conic_render_statistics *statistics);

/* About how much work each window is, from its contents and its pixels. In the list, neither the windows' first rows
 * nor their last rows ever decrease. */
void conic_source_windows_weigh(const conic_source_windows *windows, const conic_window *list, size_t n,
                                double *weights);

/* Adds the weights of places (three arrays of `count`, measured from `origin`) to the windows that hold them; `columns`
 * may be null. */
void conic_source_windows_weigh_places(const conic_source_windows *windows, float *const columns[3], size_t count,
                                       const double origin[3], const conic_window *list, size_t n, double *weights);
