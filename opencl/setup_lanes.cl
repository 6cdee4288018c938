/* Set-up of 16 splats at a time, for CPUs: the usual splats by the text that the lanes of C have. What is not usual
 * (near the camera, not finite, not to be held by float) goes to project_one. */
#include "opencl/lanes_words.cl"

#include "opencl/lanes_double_words.cl"

/* The columns of a splat set that set-up reads. */
enum { POSITION = 0, TANGENT_U = 3, TANGENT_V = 6, COLOR = 9, OPACITY = 12, N_COLUMNS };

/* Those of an item's splats that may be drawn, packed; there is room for the last group's spare lanes. */
enum { BATCH_ROOM = CONIC_SETUP_SPLATS + 16 };

typedef struct batch {
  float columns[N_COLUMNS][BATCH_ROOM];
  uint index[BATCH_ROOM]; /* in the part */
  uint n, first; /* `first`: the index of the part's place 0 in the whole set */
} batch;

CONIC_INLINE lanes batch_column(const batch *from, int column, size_t at) {
  return vload16(0, from->columns[column] + at);
}

CONIC_INLINE index_lanes batch_index(const batch *from, size_t at) {
  return vload16(0, from->index + at) + from->first;
}

#include "raster/project/setup_body.h"

static lanes zip_low(lanes a, lanes b) {
  return (lanes)(a.s0, b.s0, a.s1, b.s1, a.s2, b.s2, a.s3, b.s3, a.s4, b.s4, a.s5, b.s5, a.s6, b.s6, a.s7, b.s7);
}

static lanes zip_high(lanes a, lanes b) {
  return (lanes)(a.s8, b.s8, a.s9, b.s9, a.sa, b.sa, a.sb, b.sb, a.sc, b.sc, a.sd, b.sd, a.se, b.se, a.sf, b.sf);
}

/* Numbers that lie by field and then by lane come to lie by lane and then by field; n, a power of two, is how many
 * fields there are. Each round takes the highest bit of a number's place to the end. */
CONIC_INLINE void turn(lanes *fields, int n) {
  lanes turned[16];
#pragma unroll
  for (int round = 1; round < n; round *= 2) {
#pragma unroll
    for (int i = 0; i < n / 2; i++) {
      turned[2 * i] = zip_low(fields[i], fields[i + n / 2]);
      turned[2 * i + 1] = zip_high(fields[i], fields[i + n / 2]);
    }
#pragma unroll
    for (int i = 0; i < n; i++)
      fields[i] = turned[i];
  }
}

/* Appends the record of one lane of a turned group. */
static void write_lane(const group_screen *s, const records *r, int lane, record_places *to) {
  vstore16(r->footprint[lane], 0, (__global float *)&to->footprints[to->at]);
  vstore8(lane % 2 ? r->surface[lane / 2].hi : r->surface[lane / 2].lo, 0, (__global float *)&to->surfaces[to->at]);
  conic_box box = {(ushort)((const int *)&s->begin[0])[lane], (ushort)((const int *)&s->end[0])[lane],
                   (ushort)((const int *)&s->begin[1])[lane], (ushort)((const int *)&s->end[1])[lane]};
  to->boxes[to->at] = box;
  if (((const int *)&s->by_ray)[lane]) {
    __global float *ray = (__global float *)&to->rays[to->at];
    for (int field = 0; field < 12; field++)
      ray[field] = ((const float *)&r->ray[field])[lane];
    to->footprints[to->at].i_ray = to->at;
  }
  to->at++;
}

static int has_column(const splat_columns *from, int column) {
  return column < COLOR || (column < OPACITY ? from->fields & CONIC_DEVICE_HAS_COLOR
                                             : from->fields & CONIC_DEVICE_HAS_OPACITY);
}

/* The group of the batch that begins at `at`. */
static void project_group(const conic_view *view, splat_columns *from, const batch *packed, uint at, record_places *to,
                          uint counts[CONIC_DEVICE_N_COUNTS]) {
  group_screen s;
  records r;
  uint n_valid = min(packed->n - at, 16u);
  const uint *places = packed->index + at;
  group_verdict verdict = set_up_group(view, packed, at, &s, &r);
  turn(r.footprint, 16);
  turn(r.surface, 8);
  for (int lane = 0; lane < (int)n_valid; lane++) {
    if (((const int *)&verdict.usual)[lane]) {
      count_outcome(view, ((const int *)&s.by_ray)[lane] ? CONIC_DRAWN_RAY : CONIC_DRAWN_VARIANCE, counts);
      counts[CONIC_DEVICE_LAPLACES] += ((const int *)&s.by_ray)[lane] && ((const float *)r.footprint)[16 * lane + 5] > 0.0f;
      write_lane(&s, &r, lane, to);
      if (from->n_clips)
        clip_record(view, from, places[lane], to);
    } else if (((const int *)&verdict.unusual)[lane]) {
      project_one(view, from, places[lane], to, counts);
    } else {
      count_outcome(view, ((const int *)&verdict.skipped)[lane] ? CONIC_SKIPPED : CONIC_CULLED, counts);
    }
  }
}

/* Appends the kept ones of the sixteen splats at place i, and calls for those of the next item: so many columns at a
 * time are more than the hardware fetches ahead by itself. */
static void append_group(const splat_columns *from, uint i, uint ahead, int16 kept, batch *to) {
#pragma unroll
  for (int column = 0; column < N_COLUMNS; column++)
    if (has_column(from, column)) {
      CONIC_FETCH_AHEAD(from->values[column] + ahead);
      lanes_append((uint *)(to->columns[column] + to->n), kept, as_uint16(vload16(0, from->values[column] + i)));
    }
  to->n += (uint)lanes_append(to->index + to->n, kept, lanes_ascending(i));
}

/* Packs those of the splats begin … end - 1 that do not surely face away; whole groups are looked at. A set without
 * colours is white, one without opacities opaque. */
static void pack_facing(const conic_view *view, const splat_columns *from, uint begin, uint end, uint n_splats,
                        batch *to) {
  uint i = begin;
  for (int column = COLOR; column < N_COLUMNS; column++)
    for (uint at = 0; at < BATCH_ROOM && !has_column(from, column); at++)
      to->columns[column][at] = 1.0f;
  for (; i + 16 <= end; i += 16) {
    int16 away = 0;
    if (view->cull_back) {
      lanes columns[COLOR];
#pragma unroll
      for (int column = 0; column < COLOR; column++)
        columns[column] = vload16(0, from->values[column] + i);
      away = surely_faces_away(view, columns + POSITION, columns + TANGENT_U, columns + TANGENT_V);
    }
    append_group(from, i, min(i + CONIC_SETUP_SPLATS, n_splats - 1), ~away, to);
  }
  for (; i < end; i++) {
    for (int column = 0; column < N_COLUMNS; column++)
      if (has_column(from, column))
        to->columns[column][to->n] = from->values[column][i];
    to->index[to->n++] = i;
  }
}

/* The same as the entry `project`, of all methods but point and disc. */
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void lanes_project(SETUP_ARGUMENTS) {
  conic_view view = *frame_view;
  uint item = (uint)get_global_id(0), begin = item * splats_per_item, own[CONIC_DEVICE_N_COUNTS] = {0};
  uint end = n - begin < splats_per_item ? n : begin + splats_per_item;
  splat_columns columns = SETUP_COLUMNS;
  record_places to = {footprints, boxes, surfaces, rays, records, begin};
  batch packed;
  packed.n = 0;
  packed.first = first;
  seek_clip(&columns, first + begin);
  pack_facing(&view, &columns, begin, end, n, &packed);
  fill_last_group(&packed);
  own[CONIC_DEVICE_CULLED] = end - begin - packed.n;
  for (uint at = 0; at < packed.n; at += 16)
    project_group(&view, &columns, &packed, at, &to, own);
  n_drawn[item] = to.at - begin;
  add_counts(own, counts);
}
