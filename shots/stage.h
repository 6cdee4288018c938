/* The stages that draw a shot, one after the other: accumulated, domed, lit, gathered, leaf. Each does one thing to
 * what its next one draws, and leaves out what the plan does without. Views and samples that are lit have the lit stage
 * below the gathered one. Above the lit stage inputs get their roles, and surfaces are composited among Gaussians. No
 * stage calls back. */
#pragma once

#include "shots/executor.h"
#include "shots/shot_plan.h"

/* What changes from call to call: how a picture is looked at. */
typedef struct conic_look {
  const conic_camera *camera;
  const conic_render_options *render;
  const conic_source_view *view;
  const conic_sample *sample; /* that this is, with its place in pixel, lens and shutter; null: it is none */
} conic_look;

/* Whoever draws a shot may watch its samples, and keep their sums. Functions may be null; what they return other than
 * OK ends the drawing. */
typedef struct conic_sums_keeper {
  void *cookie;
  /* In the first process: hands over sums that were kept, which are gone on with; *sums null: there are none. */
  conic_status (*find)(void *cookie, const conic_camera *camera, unsigned planes, conic_accumulation **sums);
  /* Keeps what there is by now: where samples are shared at every power of two, and, where keeps_end is set, at the
   * end. */
  conic_status (*keep)(void *cookie, const conic_accumulation *sums);
  int keeps_end;
  /* Sees the sums after each sample, unless samples are shared; with the image that they go to, by conic_sums_show, and
   * the statistics of the middle. */
  conic_status (*watch)(void *cookie, const conic_accumulation *sums, conic_image *image,
                        const conic_render_statistics *statistics);
  /* The drawing was cancelled after these. */
  void (*stopped)(void *cookie, const conic_accumulation *sums);
} conic_sums_keeper;

/* One shot that is being drawn. */
typedef struct conic_shot_work {
  conic_context *context;
  conic_source *source;
  conic_source *surfaces; /* what the leaf draws: the source, or, below a composited stage, the surfaces among its
                             Gaussians */
  conic_renderer *renderer;
  const conic_shot *shot;
  conic_shot_plan plan;
  const conic_executor *executor;  /* at first the next: */
  conic_alone alone;               /* this process by itself */
  conic_shared_units units;        /* that it shares */
  const conic_sums_keeper *keeper; /* null: nobody keeps or watches */
  double seconds;                  /* above 0: no sample is begun after so many */
  unsigned planes;                 /* of the picture; of these, samples are summed up */
  double focus_depth;              /* once it is found */
  double light_ms;
  conic_accumulation_facts samples;
  double noise;
  double bound; /* the greatest of the plane; below 0: there is none */
} conic_shot_work;

typedef struct conic_shot_stage conic_shot_stage;
struct conic_shot_stage {
  /* Draws what is looked at into the planes that the image has. */
  conic_status (*draw)(const conic_shot_stage *stage, const conic_look *look, conic_image *image,
                       conic_render_statistics *statistics);
  const conic_shot_stage *next; /* null: of the leaf */
  const conic_shot_stage *leaf; /* the last of the chain, which also draws maps of light */
  conic_shot_work *work;
};

/* The draw functions of the six. */
conic_status conic_stage_accumulated(const conic_shot_stage *stage, const conic_look *look, conic_image *image,
                                     conic_render_statistics *statistics);
conic_status conic_stage_domed(const conic_shot_stage *stage, const conic_look *look, conic_image *image,
                               conic_render_statistics *statistics);
conic_status conic_stage_lit(const conic_shot_stage *stage, const conic_look *look, conic_image *image,
                             conic_render_statistics *statistics);
conic_status conic_stage_composited(const conic_shot_stage *stage, const conic_look *look, conic_image *image,
                                    conic_render_statistics *statistics);
conic_status conic_stage_roles(const conic_shot_stage *stage, const conic_look *look, conic_image *image,
                               conic_render_statistics *statistics);
conic_status conic_stage_gathered(const conic_shot_stage *stage, const conic_look *look, conic_image *image,
                                  conic_render_statistics *statistics);
conic_status conic_stage_leaf(const conic_shot_stage *stage, const conic_look *look, conic_image *image,
                              conic_render_statistics *statistics);

/* The chain of a plan; `stages` has that much room. Returns the first one. */
enum { CONIC_MOST_STAGES = 7 };

/* Whether this process has the picture at the end. */
int conic_work_has_picture(const conic_shot_work *work);
/* executor->agree. */
static inline conic_status conic_work_agree(const conic_shot_work *work, conic_status status) {
  conic_status of_all = work->executor->agree(work->executor->data, status);
  return status != CONIC_OK ? status : of_all;
}
/* executor->trace. */
void conic_work_trace(const conic_shot_work *work, const char *kind, const char *name, uint64_t number,
                      conic_moment since, uint64_t bytes);

/* Puts the means so far into the picture. */
conic_status conic_sums_show(const conic_shot *shot, const conic_accumulation *sums, conic_image *image);

/* conic_shot_draw by one of several processes, or with somebody who keeps sums: the work has been begun. `image` may
 * lack planes in processes that have no picture at the end. Collective, where units are shared. */
conic_status conic_shot_work_begin(conic_source *source, conic_renderer *renderer, const conic_shot *shot,
                                   conic_shot_work *work);
conic_status conic_shot_work_draw(conic_shot_work *work, conic_image *image, conic_shot_outcome *outcome);

/* conic_shot_expose by processes that share windows; the first one's exposure counts. */
conic_status conic_shot_expose_together(conic_source *source, conic_renderer *renderer, const conic_executor *executor,
                                        conic_shared_units units, conic_shot *shot);
