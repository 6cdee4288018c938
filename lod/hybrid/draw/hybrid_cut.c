/* Which nodes stand for all of their clusters. */
#include "lod/hybrid/draw/hybrid_choose.h"

static double sum_clusters(const conic_hybrid_cutting *c, const conic_hybrid_node *node) {
  double sum = 0.0;
  for (uint32_t i = node->begin; i < node->end; i++)
    sum += c->amounts[i];
  return sum;
}

/* A node's children come right after it, and end where it ends. */
static double sum_children(const conic_hybrid_cutting *c, size_t node) {
  double sum = 0.0;
  for (size_t i = node + 1; i < c->hybrid->nodes[node].next; i = c->hybrid->nodes[i].next)
    sum += c->below[i];
  return sum;
}

/* A node by itself against the best of what is below it. */
static void cut_node(const conic_hybrid_cutting *c, size_t i, uint32_t *nodes) {
  const conic_hybrid_node *node = &c->hybrid->nodes[i];
  double sum = node->next == i + 1 ? sum_clusters(c, node) : sum_children(c, i);
  nodes[i] = CONIC_HYBRID_NO_NODE;
  c->below[i] = sum;
  if (!(sum > 0.0)) /* nothing is in sight, or something must stay */
    return;
  conic_hybrid_offer offer = c->offer(c->data, node);
  if (offer.amount < sum) {
    nodes[i] = offer.level;
    c->below[i] = offer.amount;
  }
}

/* The number of the k-th node that is looked at. All are, where there is no list. */
static size_t seen_node(const uint32_t *seen, size_t k) {
  return seen ? seen[k] : k;
}

double conic_hybrid_cut_seen(const conic_hybrid_cutting *c, const uint32_t *seen, size_t n_seen, uint32_t *nodes) {
  const conic_hybrid *h = c->hybrid;
  double less = 0.0;
  for (size_t k = n_seen; k-- > 0;) /* from the leaves to the root */
    cut_node(c, seen_node(seen, k), nodes);
  for (size_t k = 0; k < n_seen;) {
    size_t i = seen_node(seen, k++);
    if (nodes[i] == CONIC_HYBRID_NO_NODE)
      continue;
    less += sum_clusters(c, &h->nodes[i]) - c->below[i];
    for (; k < n_seen && seen_node(seen, k) < h->nodes[i].next; k++)
      nodes[seen_node(seen, k)] = CONIC_HYBRID_NO_NODE;
  }
  return less;
}

double conic_hybrid_cut(const conic_hybrid_cutting *c, uint32_t *nodes) {
  return conic_hybrid_cut_seen(c, NULL, c->hybrid->n_nodes, nodes);
}

void conic_hybrid_find_standing(const conic_hybrid *h, const uint32_t *nodes, uint32_t *standing) {
  for (size_t i = 0; i < h->n_clusters; i++)
    standing[i] = CONIC_HYBRID_NO_NODE;
  for (uint32_t i = 0; i < h->n_nodes; i++)
    for (uint32_t k = h->nodes[i].begin; k < h->nodes[i].end && nodes[i] != CONIC_HYBRID_NO_NODE; k++)
      standing[k] = i;
}
