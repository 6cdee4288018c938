#include "raster/transparency/pixel_sheets.h"

#include "core/base/base.h"
#include "raster/transparency/triangle_alpha.h"

/* The sums over a sheet, as the picture forms them. */
typedef struct sums {
  float whole; /* of the weights without opacity */
  float weight, color[3], normal[3];
  float heaviest_weight, nearest_iz;
  const conic_footprint *heaviest; /* null: the triangle */
  const float *heaviest_normal;
  uint32_t count, id;
} sums;

/* --- in order --- */

static int compare_seen(const void *a, const void *b) {
  const conic_ranked_splat *first = a, *second = b;
  if (first->seen != second->seen)
    return first->seen > second->seen ? -1 : 1;
  return (first->i_splat > second->i_splat) - (first->i_splat < second->i_splat);
}

CONIC_DEFINE_ORDER(compare_file_order, conic_ranked_splat, i_splat)

static int compare_ranked_triangles(const void *a, const void *b) {
  const conic_ranked_triangle *first = a, *second = b;
  if (first->iz != second->iz)
    return first->iz > second->iz ? -1 : 1;
  return (first->i_triangle > second->i_triangle) - (first->i_triangle < second->i_triangle);
}

/* Most lists are short. */
static void sort_ranked(conic_ranked_splat *list, size_t n, int (*compare)(const void *, const void *)) {
  enum { SHORT = 24 };
  if (n > SHORT) {
    qsort(list, n, sizeof *list, compare);
    return;
  }
  for (size_t i = 1; i < n; i++) {
    conic_ranked_splat one = list[i];
    size_t k = i;
    for (; k > 0 && compare(&list[k - 1], &one) > 0; k--)
      list[k] = list[k - 1];
    list[k] = one;
  }
}

void conic_pixel_sheets_begin(conic_pixel_sheets *sheets) {
  const conic_projected *projected = &sheets->scene->contributions->projected;
  for (size_t i = 0; i < sheets->n; i++) {
    conic_ranked_splat *ranked = &sheets->ranked[i];
    const conic_sheet_splat *splat = &sheets->splats[ranked->i_splat];
    const conic_footprint *footprint = &projected->footprints[splat->footprint];
    ranked->seen = conic_seen_iz(&splat->fragment);
    ranked->hides = conic_hiding_iz(footprint, &splat->fragment, sheets->ray[0], sheets->ray[1]);
  }
  sort_ranked(sheets->ranked, sheets->n, compare_seen);
  float reach = 0.0f;
  for (size_t i = sheets->n; i-- > 0;) {
    reach = reach < sheets->ranked[i].hides ? sheets->ranked[i].hides : reach;
    sheets->ranked[i].reach = reach;
  }
  if (sheets->n_triangles > 1)
    qsort(sheets->ranked_triangles, sheets->n_triangles, sizeof *sheets->ranked_triangles, compare_ranked_triangles);
  sheets->i = sheets->i_triangle = 0;
}

/* --- a sheet --- */

/* Of what is not a number, nothing is seen. */
static float sheet_opacity(const float *opacity, uint32_t splat) {
  float value = opacity ? opacity[splat] : 1.0f;
  return value > 0.0f ? value < 1.0f ? value : 1.0f : 0.0f;
}

static void sum_splat(const conic_pixel_sheets *sheets, const conic_sheet_splat *splat, sums *s) {
  const conic_contributions *c = sheets->scene->contributions;
  const conic_footprint *footprint = &c->projected.footprints[splat->footprint];
  const conic_projected_surface *surface = &c->projected.surfaces[splat->footprint];
  float whole = conic_final_weight(&c->view, footprint, splat->fragment.q, splat->fragment.scale);
  float weight = whole * sheet_opacity(sheets->scene->opacity, surface->index);
  s->whole += whole;
  if (!(weight > 0.0f))
    return;
  s->weight += weight;
  for (int axis = 0; axis < 3; axis++) {
    s->color[axis] += weight * surface->color[axis];
    s->normal[axis] += weight * surface->normal[axis];
  }
  if (s->heaviest_weight < weight) {
    s->heaviest_weight = weight;
    s->heaviest = footprint;
    s->heaviest_normal = surface->normal;
  }
  if (s->nearest_iz < splat->fragment.iz) {
    s->nearest_iz = splat->fragment.iz;
    s->id = surface->index;
  }
  s->count++;
}

static void sum_triangle(const conic_pixel_sheets *sheets, float iz, const conic_triangle_sight *sight, float alpha,
                         sums *s) {
  const conic_triangle_frame *frame = &sheets->scene->contributions->triangles;
  const conic_ranked_triangle *ranked = &sheets->ranked_triangles[sheets->i_triangle];
  float size = 0.0f;
  s->whole += 1.0f;
  s->weight += alpha;
  for (int axis = 0; axis < 3; axis++) {
    s->color[axis] += alpha * sight->color[axis]; /* NOLINT(clang-analyzer-core.*): a triangle was seen */
    s->normal[axis] += alpha * sight->normal[axis];
    size += fabsf(s->normal[axis]);
  }
  for (int axis = 0; axis < 3 && !(size > 0.0f); axis++)
    s->normal[axis] = sight->normal[axis] * CONIC_LEAST_WEIGHT;
  if (alpha > s->heaviest_weight) {
    s->heaviest = NULL;
    s->heaviest_normal = sight->normal;
  }
  if (iz > s->nearest_iz)
    s->id = frame->first_id + sheets->triangles[ranked->i_triangle].record->index;
  s->count++;
}

/* The nearest triangle that is there and that no splat left hides, in `sight`. Returns its alpha; 0: there is none. */
static float visible_triangle(conic_pixel_sheets *sheets, float threshold, conic_triangle_sight *sight) {
  const conic_sheet_scene *scene = sheets->scene;
  for (; sheets->i_triangle < sheets->n_triangles; sheets->i_triangle++) {
    const conic_ranked_triangle *ranked = &sheets->ranked_triangles[sheets->i_triangle];
    const conic_triangle_record *record = sheets->triangles[ranked->i_triangle].record;
    if (!(ranked->iz >= threshold))
      return 0.0f;
    conic_triangle_see(&scene->contributions->triangles, record, scene->finish->world_from_cam, sheets->x, sheets->y,
                       sheets->ray, sight);
    float alpha = conic_triangle_lay_alpha(scene->contributions->triangles.triangles, record->index, sight);
    if (alpha > 0.0f)
      return alpha;
  }
  return 0.0f;
}

static void finish_sheet(const conic_pixel_sheets *sheets, const sums *s, float iz, conic_sheet *sheet) {
  conic_finish_covered(sheets->scene->finish, s->weight, s->color, s->normal, s->heaviest_normal, sheets->ray[0],
                       sheets->ray[1], &sheet->pixel);
  sheet->opacity = s->weight < s->whole ? s->weight / s->whole : 1.0f;
  sheet->z = s->heaviest ? conic_plane_z(s->heaviest, sheets->x, sheets->y) : 1.0f / iz;
  sheet->weight = s->weight;
  sheet->count = s->count;
  sheet->id = s->id;
}

/* Whatever is seen by less lies behind all that is seen by more, so that the visible ones come first among the rest. */
static void take_sheet(conic_pixel_sheets *sheets, float threshold, const conic_triangle_sight *sight, float alpha,
                       sums *s, float *iz) {
  size_t first = sheets->i;
  *iz = alpha > 0.0f ? sheets->ranked_triangles[sheets->i_triangle].iz : 0.0f;
  while (sheets->i < sheets->n && sheets->ranked[sheets->i].seen >= threshold)
    sheets->i++;
  sort_ranked(sheets->ranked + first, sheets->i - first, compare_file_order);
  for (size_t k = first; k < sheets->i; k++)
    sum_splat(sheets, &sheets->splats[sheets->ranked[k].i_splat], s);
  if (alpha > 0.0f)
    sum_triangle(sheets, *iz, sight, alpha, s);
  sheets->i_triangle += alpha > 0.0f;
}

int conic_pixel_sheets_next(conic_pixel_sheets *sheets, conic_sheet *sheet) {
  for (;;) {
    conic_triangle_sight sight;
    sums s;
    float iz, threshold = sheets->i < sheets->n ? sheets->ranked[sheets->i].reach : 0.0f;
    float alpha = visible_triangle(sheets, threshold, &sight);
    if (sheets->i == sheets->n && !(alpha > 0.0f))
      return 0;
    if (alpha > 0.0f) {
      float hides =
          conic_triangle_hides(sheets->scene->contributions->triangles.epsilon,
                               sheets->ranked_triangles[sheets->i_triangle].iz, sheets->ray[0], sheets->ray[1]);
      threshold = threshold < hides ? hides : threshold;
    }
    memset(&s, 0, sizeof s);
    take_sheet(sheets, threshold, &sight, alpha, &s, &iz);
    if (!(s.weight > 0.0f))
      continue;
    finish_sheet(sheets, &s, iz, sheet);
    return 1;
  }
}
