/* Joins faces to clusters, the cheapest joint first. A joint lies between two clusters, and is in the ring of each.
 * Joining two clusters moves the fewer joints to the other's ring. Where two joints then lead to the same third
 * cluster, one goes on with the length of both. A joint's cost becomes old when one of its clusters grows. That shows
 * when its turn comes, and it goes back into the queue with its new cost. Costs may fall when clusters grow, as a shape
 * becomes rounder. So the joints that are left at the end are asked again, until none is below the limit. */
#include "lod/mesh/mesh_clusters.h"

#include "core/base/heap.h"

static const uint32_t none = UINT32_MAX;

typedef struct joint {
  uint32_t ends[2];              /* clusters */
  uint32_t next[2], previous[2]; /* slots (2 · joint + end) in the rings */
  uint32_t stamp;                /* how often its clusters had grown when its cost was computed */
  double length;                 /* in units of the box; below 0: it is gone */
} joint;

typedef struct joining {
  conic_context *context;
  const conic_clustering_options *options;
  size_t n_clusters, n_joints;
  joint *joints;
  double *keys;
  conic_face_sums *sums; /* by cluster, which is numbered as one of its faces */
  uint32_t *ring;        /* of each cluster: a slot, or none */
  uint32_t *degree, *grown, *parent;
  uint8_t *is_new; /* joined in this phase */
  double largest_area;
  double limit; /* of a joint's cost in this phase */
  int phase;
  conic_heap queue;
  size_t n_evaluations;
} joining;

static joint *joint_of(const joining *j, uint32_t slot) {
  return &j->joints[slot / 2];
}

/* --- rings --- */

static void link_slot(joining *j, uint32_t slot, uint32_t cluster) {
  joint *own = joint_of(j, slot);
  uint32_t end = slot & 1, first = j->ring[cluster];
  own->ends[end] = cluster;
  j->degree[cluster]++;
  if (first == none) {
    own->next[end] = own->previous[end] = j->ring[cluster] = slot;
    return;
  }
  joint *head = joint_of(j, first);
  uint32_t last = head->previous[first & 1];
  own->next[end] = first;
  own->previous[end] = last;
  head->previous[first & 1] = slot;
  joint_of(j, last)->next[last & 1] = slot;
}

static void unlink_slot(joining *j, uint32_t slot) {
  joint *own = joint_of(j, slot);
  uint32_t end = slot & 1, cluster = own->ends[end], next = own->next[end], previous = own->previous[end];
  j->degree[cluster]--;
  joint_of(j, previous)->next[previous & 1] = next;
  joint_of(j, next)->previous[next & 1] = previous;
  if (j->ring[cluster] == slot)
    j->ring[cluster] = next == slot ? none : next;
}

static void drop_joint(joining *j, uint32_t i) {
  unlink_slot(j, 2 * i);
  unlink_slot(j, 2 * i + 1);
  j->joints[i].length = -1.0;
}

/* The joint between two clusters, looked for in the shorter ring; or none. */
static uint32_t find_joint(const joining *j, uint32_t a, uint32_t b) {
  uint32_t at = j->degree[a] <= j->degree[b] ? a : b, wanted = at == a ? b : a, slot = j->ring[at];
  for (uint32_t n = j->degree[at]; n > 0; n--, slot = joint_of(j, slot)->next[slot & 1])
    if (joint_of(j, slot)->ends[~slot & 1] == wanted)
      return slot / 2;
  return none;
}

/* --- costs --- */

/* Whose shape alone costs more than the limit is not joined whatever its plane, and that takes most of the time: its
 * shape is all that is told. */
static double cost_of(const joining *j, uint32_t i) {
  const joint *own = &j->joints[i];
  const conic_face_sums *a = &j->sums[own->ends[0]], *b = &j->sums[own->ends[1]];
  conic_face_sums both;
  if (j->phase == 1 && a->area + b->area > j->largest_area)
    return HUGE_VAL;
  conic_joining_cost cost = conic_joining_cost_without_plane(a, b, own->length, j->largest_area, &both);
  if (j->phase == 2)
    return cost.shape + cost.size;
  if (cost.shape > j->limit)
    return cost.shape;
  conic_joining_cost_add_plane(&both, &cost);
  return (cost.fit + cost.direction) + cost.shape;
}

static uint32_t stamp_of(const joining *j, uint32_t i) {
  return j->grown[j->joints[i].ends[0]] + j->grown[j->joints[i].ends[1]];
}

enum { CHUNK = 4096 };

static void evaluate_task(void *data, size_t i_chunk) {
  joining *j = data;
  size_t begin = i_chunk * CHUNK, end = begin + CHUNK < j->n_joints ? begin + CHUNK : j->n_joints;
  for (size_t i = begin; i < end; i++)
    if (j->joints[i].length >= 0.0) {
      j->keys[i] = cost_of(j, (uint32_t)i);
      j->joints[i].stamp = stamp_of(j, (uint32_t)i);
    }
}

/* --- joining --- */

static void join_clusters(joining *j, uint32_t i) {
  uint32_t a = j->joints[i].ends[0], b = j->joints[i].ends[1];
  uint32_t kept = j->degree[a] > j->degree[b] || (j->degree[a] == j->degree[b] && a < b) ? a : b;
  uint32_t gone = kept == a ? b : a;
  j->sums[kept] = conic_face_sums_join(&j->sums[a], &j->sums[b], j->joints[i].length);
  drop_joint(j, i);
  while (j->ring[gone] != none) {
    uint32_t slot = j->ring[gone], other = joint_of(j, slot)->ends[~slot & 1], twin = find_joint(j, kept, other);
    if (twin != none) {
      j->joints[twin].length += joint_of(j, slot)->length;
      drop_joint(j, slot / 2);
    } else {
      unlink_slot(j, slot);
      link_slot(j, slot, kept);
    }
  }
  j->grown[kept]++;
  j->grown[kept] += j->grown[gone]; /* the sum of both ends' never comes back to an old one */
  j->parent[gone] = kept;
  j->is_new[kept] = 1;
}

/* Every joint that costs less than the limit by now, in the queue. */
static int fill_queue(joining *j) {
  conic_parallel_for(j->context, (j->n_joints + CHUNK - 1) / CHUNK, evaluate_task, j);
  j->queue.n = 0;
  for (size_t i = 0; i < j->n_joints; i++)
    if (j->joints[i].length >= 0.0) {
      j->n_evaluations++;
      if (j->keys[i] <= j->limit)
        conic_heap_push(&j->queue, (uint32_t)i);
    }
  return j->queue.n > 0;
}

static conic_status run_phase(joining *j, int phase, double limit) {
  static const size_t joints_a_report = 20000;
  size_t n_done = 0;
  j->phase = phase;
  j->limit = limit;
  memset(j->is_new, 0, j->n_clusters);
  while (fill_queue(j))
    while (j->queue.n > 0) {
      uint32_t i = conic_heap_pop(&j->queue);
      if (j->joints[i].length < 0.0)
        continue;
      if (j->joints[i].stamp == stamp_of(j, i)) {
        join_clusters(j, i);
      } else {
        j->keys[i] = cost_of(j, i);
        j->joints[i].stamp = stamp_of(j, i);
        j->n_evaluations++;
        if (j->keys[i] <= j->limit)
          conic_heap_push(&j->queue, i);
      }
      if (++n_done % joints_a_report == 0) {
        double share = (double)n_done / (double)(4 * j->n_joints);
        conic_status status = conic_progress(j->context, "cluster", share < 1.0 ? share : 1.0);
        if (status != CONIC_OK)
          return status;
      }
    }
  return CONIC_OK;
}

/* --- beginning and end --- */

static conic_status begin_joining(joining *j, const conic_mesh *mesh, const conic_adjacency *adjacency) {
  conic_unit_box box = conic_unit_box_of(mesh, adjacency);
  j->n_clusters = mesh->n_faces;
  j->n_joints = adjacency->n_joints;
  if (conic_memory_allocate_these(j->context, CONIC_ROOM(j->joints, j->n_joints), CONIC_ROOM(j->keys, j->n_joints),
                                  CONIC_ROOM(j->queue.slots, j->n_joints), CONIC_ROOM(j->sums, j->n_clusters),
                                  CONIC_ROOM(j->ring, j->n_clusters), CONIC_ROOM(j->parent, j->n_clusters),
                                  CONIC_ZEROED(j->degree, j->n_clusters), CONIC_ZEROED(j->grown, j->n_clusters),
                                  CONIC_ROOM(j->is_new, j->n_clusters)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  double whole_area = 0.0;
  j->queue.keys = j->keys;
  for (size_t i = 0; i < j->n_clusters; i++) {
    j->ring[i] = none;
    j->parent[i] = (uint32_t)i;
    if (adjacency->side[i]) {
      j->sums[i] = conic_face_sums_of(mesh, adjacency, &box, i);
      whole_area += j->sums[i].area;
    }
  }
  j->largest_area = j->options->most_area * whole_area;
  for (size_t i = 0; i < j->n_joints; i++) {
    const conic_joint *from = &adjacency->joints[i];
    uint32_t twin = from->faces[0] == from->faces[1] ? none : find_joint(j, from->faces[0], from->faces[1]);
    j->joints[i].length = -1.0;
    if (twin != none)
      j->joints[twin].length += from->length * box.scale;
    if (twin != none || from->faces[0] == from->faces[1])
      continue;
    j->joints[i].length = from->length * box.scale;
    link_slot(j, (uint32_t)(2 * i), from->faces[0]);
    link_slot(j, (uint32_t)(2 * i + 1), from->faces[1]);
  }
  return CONIC_OK;
}

static uint32_t root_of(joining *j, uint32_t i) {
  while (j->parent[i] != i) {
    j->parent[i] = j->parent[j->parent[i]];
    i = j->parent[i];
  }
  return i;
}

static size_t count_roots(joining *j, const conic_adjacency *adjacency) {
  size_t n = 0;
  for (size_t i = 0; i < j->n_clusters; i++)
    n += adjacency->side[i] && j->parent[i] == i;
  return n;
}

/* Numbers the clusters by their first faces. The rings are not needed any more and hold the numbers. */
static conic_status collect_clusters(joining *j, const conic_adjacency *adjacency, conic_mesh_clusters *clusters) {
  size_t n = count_roots(j, adjacency);
  if (conic_memory_allocate_these(j->context, CONIC_ROOM(clusters->of_face, j->n_clusters),
                                  CONIC_ROOM(clusters->is_gathered, n), CONIC_ROOM(clusters->sums, n)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  memset(j->ring, 0xFF, j->n_clusters * sizeof *j->ring);
  for (size_t i = 0; i < j->n_clusters; i++) {
    clusters->of_face[i] = CONIC_NO_CLUSTER;
    if (!adjacency->side[i])
      continue;
    uint32_t root = root_of(j, (uint32_t)i);
    if (j->ring[root] == none) {
      clusters->is_gathered[clusters->n_clusters] = j->is_new[root];
      clusters->sums[clusters->n_clusters] = j->sums[root];
      j->ring[root] = (uint32_t)clusters->n_clusters++;
    }
    clusters->of_face[i] = j->ring[root];
  }
  clusters->n_evaluations = j->n_evaluations;
  return CONIC_OK;
}

conic_status conic_mesh_clusters_find(conic_context *context, const conic_mesh *mesh, const conic_adjacency *adjacency,
                                      const conic_clustering_options *options, conic_mesh_clusters *clusters) {
  joining j = {.context = context, .options = options};
  memset(clusters, 0, sizeof *clusters);
  conic_status status = begin_joining(&j, mesh, adjacency);
  if (status == CONIC_OK)
    status = run_phase(&j, 1, options->phase1);
  if (status == CONIC_OK) {
    clusters->n_first = count_roots(&j, adjacency);
    status = run_phase(&j, 2, options->phase2);
  }
  if (status == CONIC_OK)
    status = collect_clusters(&j, adjacency, clusters);
  conic_memory_release_these(context, j.joints, j.keys, j.queue.slots, j.sums, j.ring, j.parent, j.degree, j.grown,
                             j.is_new);
  if (status != CONIC_OK)
    conic_mesh_clusters_release(context, clusters);
  return status;
}

void conic_mesh_clusters_release(conic_context *context, conic_mesh_clusters *clusters) {
  conic_memory_release_these(context, clusters->of_face, clusters->is_gathered, clusters->sums);
  memset(clusters, 0, sizeof *clusters);
}
