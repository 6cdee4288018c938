/* What simplifying works on: the triangles of a region, vertices with their quadrics, and the places of the mesh by
 * which errors are measured. Private to lod/clusters/cluster_simplify*.c. */
#pragma once

#include "core/base/heap.h"
#include "lod/clusters/cluster_simplify.h"
#include "lod/mesh/quadric.h"

#define CONIC_NONE UINT32_MAX

typedef enum conic_simplifier_kind {
  CONIC_VERTEX_FREE = 0,   /* faces of one cluster all around */
  CONIC_VERTEX_BORDER = 1, /* on an open border, along which it may go */
  CONIC_VERTEX_CHAIN = 2,  /* between two clusters, along whose chain it may go */
  CONIC_VERTEX_LOCKED = 3  /* of another region too; or its surroundings are no surface */
} conic_simplifier_kind;

typedef struct conic_simplifier_vertex {
  uint32_t original;             /* in the mesh */
  uint32_t material;             /* of its faces */
  uint32_t ring;                 /* its first slot, 3 · triangle + corner, or none */
  uint32_t target;               /* what it is best drawn onto; once it is gone, what it was drawn onto */
  uint8_t kind, is_old, is_seam; /* is_seam: its attributes differ from face to face, and it may go along there */
  uint8_t is_gone;
  uint32_t moved;      /* the first of the moved vertices that a level has of it, or none yet */
  double at[3], to[3]; /* and where its target would be then */
  conic_quadric quadric;
  double faded, fading; /* lost of the colours about it so far, as a quadric's value; and if it goes */
} conic_simplifier_vertex;

/* As long as a line of the cache. What walks do not ask for lies elsewhere. */
typedef struct conic_simplifier_triangle {
  double normal[3];    /* of the mesh's face */
  uint32_t corners[3]; /* vertices */
  uint32_t next[3];    /* slots in the rings */
  uint32_t face;
  uint32_t cluster; /* from the region's first; 0 where the region is one */
  int is_alive;
} conic_simplifier_triangle;

/* A place of the mesh that the simpler triangles are compared with. */
typedef struct conic_simplifier_point {
  double at[3];
  uint32_t vertex;   /* that it was near at first */
  uint32_t triangle; /* one that it lies on */
  uint32_t corners;  /* of which of them it is the middle, as bits; none: its colour is not looked at */
} conic_simplifier_point;

/* The middle of a face of the mesh, and what is nearest to it. */
typedef struct conic_simplifier_hit {
  float area2, normal[3]; /* twice the face's area; the mean of its corners' normals, if any */
  uint32_t triangle;      /* none: nothing that looks the same way */
  float bary[3], height;  /* how much of each corner is there, and how far the middle is over it */
} conic_simplifier_hit;

/* A neighbour that a vertex may go to. */
typedef struct conic_simplifier_spoke {
  uint32_t vertex;
  uint32_t before, slot; /* its triangle's, if any: the corner before the vertex that goes, and the slot */
  int is_common;         /* whether it neighbours the vertex that is looked at, too */
  double at[3];          /* where it would be when the vertex has gone to it */
  double cost, fading;   /* what colours add to it, once it was asked; else infinite */
} conic_simplifier_spoke;

/* An edge along which vertices were left out. */
typedef struct conic_simplifier_border {
  conic_cluster_border of; /* the triangle's number is that in the region */
  uint32_t cluster;        /* from the region's first */
} conic_simplifier_border;

struct conic_simplifier {
  conic_context *context;
  const conic_clustered_mesh *mesh;
  const conic_face_tree *tree; /* of all the mesh's faces */
  conic_cluster_chains *chains;
  uint32_t *number; /* of each place of the mesh, while its region is worked on; else none */
  uint32_t begin, end;
  size_t n_vertices, n_triangles, n_points, n_borders, n_alive;
  conic_simplifier_vertex *vertices;
  conic_simplifier_triangle *triangles;
  uint32_t (*originals)[3]; /* the triangles' vertices in the mesh: with their attributes */
  uint32_t *wedges;         /* of triangles about a vertex that goes: what its corner becomes */
  uint32_t (*near)[4];      /* faces of the mesh that were near the middles of their edges and their own */
  conic_simplifier_point *points;
  conic_simplifier_border *borders; /* of the stage that is to be taken */
  size_t *point_starts[2];          /* of each cluster, and an end: its own; then, after all own, its borders' */
  size_t *border_starts;            /* likewise */
  uint32_t *alive;                  /* triangles of each cluster */
  uint32_t *taken;                  /* of each cluster: triangles of its last level */
  double *errors2;                  /* of each cluster, squared, so far */
  conic_simplifier_hit *hits;       /* of the mesh's faces, where the region is one: what is nearest to their middles */
  conic_seen_sums *changes;         /* of each cluster's colours, in the stage that is measured */
  float (*contrasts)[2];            /* of the triangles' faces, and twice their area; null: all has one colour */
  uint32_t stage;                   /* the last one that is taken, or is to be */
  size_t n_last, n_wanted;          /* triangles: of the last stage, and of the next */
  int is_to_fit, is_to_take, is_over;
  int is_one;                     /* the region is simplified as one cluster in pieces */
  double most_error;              /* of what is one; 0: any */
  conic_cluster_levels *levels;   /* of the region's clusters */
  conic_simplifier_spoke *spokes; /* room for those of any vertex */
  conic_heap queue;
};

/* The slot of a vertex's next living triangle, from this one on; none at the end. */
static inline uint32_t conic_simplifier_living(const conic_simplifier *s, uint32_t slot) {
  while (slot != CONIC_NONE && !s->triangles[slot / 3].is_alive)
    slot = s->triangles[slot / 3].next[slot % 3];
  return slot;
}

static inline uint32_t conic_simplifier_after(const conic_simplifier *s, uint32_t slot) {
  return conic_simplifier_living(s, s->triangles[slot / 3].next[slot % 3]);
}

/* Vertices of scans have some six triangles; the middle of a fan may have thousands until its rim has become simpler.
 * What is done for each pair or triple of a vertex's triangles is not done for more than this: such vertices stay,
 * nothing is drawn onto them, and of what lies about them so many are looked at. */
enum { CONIC_SIMPLIFIER_MANY = 128 };

static inline int conic_simplifier_has_many(const conic_simplifier *s, uint32_t v) {
  int n = 0;
  for (uint32_t slot = conic_simplifier_living(s, s->vertices[v].ring);
       slot != CONIC_NONE && n <= CONIC_SIMPLIFIER_MANY; slot = conic_simplifier_after(s, slot))
    n++;
  return n > CONIC_SIMPLIFIER_MANY;
}

static inline int conic_simplifier_has(const conic_simplifier_triangle *t, uint32_t v) {
  return t->corners[0] == v || t->corners[1] == v || t->corners[2] == v;
}

/* The material of a triangle's face. */
static inline uint32_t conic_simplifier_material(const conic_simplifier *s, const conic_simplifier_triangle *t) {
  const uint32_t *materials = s->mesh->triangles->material;
  return materials ? materials[t->face] : 0;
}

/* Fills in vertices, triangles and points of the region [begin, end), with room for what is done with them. Errors:
 * MEMORY. */
conic_status conic_simplifier_load(conic_simplifier *s);
void conic_simplifier_release_region(conic_simplifier *s);

/* What a corner of u becomes when u is drawn onto v. It is the mesh's vertex at v of a triangle beside their edge that
 * has the same corner at u, and the same cluster and material. NONE where there is no such triangle, or they differ. */
uint32_t conic_simplifier_wedge(const conic_simplifier *s, uint32_t u, uint32_t v, uint32_t slot);

/* Where v is best when u has gone to it: at its own place, unless it may move. `both` is the sum of their quadrics. */
void conic_simplifier_find_place(const conic_simplifier *s, uint32_t u, uint32_t v, const conic_quadric *both,
                                 double at[3]);

/* Whether the triangle of a slot neither turns over nor loses its area when that corner is at another place. */
int conic_simplifier_keeps_facing(const conic_simplifier *s, uint32_t slot, const double at[3]);

/* Sets the target of vertex u and its key, or neither where it may be drawn onto no neighbour. */
void conic_simplifier_find_target(conic_simplifier *s, uint32_t u);

/* How much of the colours about vertex u is lost when it goes to v, as a quadric's value. Colours are not all the same.
 */
double conic_simplifier_fading(const conic_simplifier *s, uint32_t u, uint32_t v);

/* Notes what a point of a cluster has become, being nearest to a triangle. */
void conic_simplifier_note_change(conic_simplifier *s, uint32_t cluster, const conic_simplifier_point *point,
                                  const conic_simplifier_triangle *triangle);

/* Twice the area of a triangle as it is now; `cross` becomes the product of two sides. */
static inline double conic_simplifier_twice_area(const conic_simplifier *s, size_t triangle, double cross[3]) {
  const uint32_t *corners = s->triangles[triangle].corners;
  double sides[2][3];
  for (int k = 0; k < 2; k++)
    conic_subtract(s->vertices[corners[k + 1]].at, s->vertices[corners[0]].at, sides[k]);
  conic_cross(sides[0], sides[1], cross);
  return conic_length(cross);
}

/* Whether a cluster has become so much simpler that this stage is a level of it. */
static inline int conic_simplifier_is_worth_a_level(const conic_simplifier *s, uint32_t cluster) {
  return s->is_one || 4 * (size_t)s->alive[cluster] <= 3 * (size_t)s->taken[cluster];
}

/* Makes what is alive one more stage, to be measured and then taken, if clusters would fit. Otherwise it is over.
 * Errors: MEMORY. */
conic_status conic_simplifier_begin_stage(conic_simplifier *s);

/* The target of each vertex that is gone becomes what it is now. */
void conic_simplifier_shorten_ways(conic_simplifier *s);

/* For a region that is one and has colours: moves the vertices along their normals to where they fit the mesh best, by
 * what its faces have been nearest to. Errors: MEMORY. */
conic_status conic_simplifier_fit_places(conic_simplifier *s);

/* Normals of the triangles' corners, and the number of each corner's; both null where the mesh has none. */
typedef struct conic_simplifier_normals {
  uint32_t (*of_corner)[3]; /* of triangles, as the simplifier has them */
  double (*normals)[3];     /* unit vectors */
} conic_simplifier_normals;

/* For a region that is one: the normals that fit the mesh's best. The caller releases them, on failure too. Errors:
 * MEMORY. */
conic_status conic_simplifier_fit_normals(const conic_simplifier *s, conic_simplifier_normals *normals);
void conic_simplifier_normals_release(const conic_simplifier *s, conic_simplifier_normals *normals);

/* Takes what is alive as the levels of the stage. Errors: MEMORY. */
conic_status conic_simplifier_take(conic_simplifier *s);
