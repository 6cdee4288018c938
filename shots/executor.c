#include "shots/executor.h"

static void share_alone(void *data, uint64_t n, conic_unit_taker *take, void *cookie) {
  conic_alone *alone = data;
  alone->next = 0;
  alone->end = n;
  alone->take = take;
  alone->cookie = cookie;
}

static uint64_t next_alone(void *data) {
  conic_alone *alone = data;
  return alone->next < alone->end ? alone->next++ : CONIC_NO_UNIT;
}

/* Nobody else is ahead of what has been taken. */
static void allow_alone(void *data, uint64_t end) {
  (void)data, (void)end;
}

static void hand_alone(void *data, const void *bytes, size_t n_bytes) {
  const conic_alone *alone = data;
  if (alone->take)
    alone->take(alone->cookie, 0, bytes, n_bytes);
}

static conic_status agree_alone(void *data, conic_status status) {
  (void)data;
  return status;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): others hear a message */
static int worst_alone(void *data, int code, char *message, size_t room) {
  (void)data, (void)message, (void)room;
  return code;
}

static void broadcast_alone(void *data, void *bytes, size_t n_bytes) {
  (void)data, (void)bytes, (void)n_bytes;
}

static void count_no_traffic(void *data, uint64_t *sent_bytes, uint64_t *received_bytes, double *waited_seconds) {
  (void)data;
  *sent_bytes = *received_bytes = 0;
  *waited_seconds = 0.0;
}

static void did_alone(void *data, const char *name, uint64_t number, conic_moment since, uint64_t handed_bytes) {
  (void)data, (void)name, (void)number, (void)since, (void)handed_bytes;
}

static void trace_alone(void *data, const char *kind, const char *name, uint64_t number, conic_moment since,
                        uint64_t bytes) {
  (void)data, (void)kind, (void)name, (void)number, (void)since, (void)bytes;
}

void conic_executor_alone(conic_alone *alone) {
  memset(alone, 0, sizeof *alone);
  alone->executor = (conic_executor){.data = alone,
                                     .count = 1,
                                     .cut_for = 1,
                                     .share = share_alone,
                                     .next = next_alone,
                                     .allow = allow_alone,
                                     .hand = hand_alone,
                                     .agree = agree_alone,
                                     .worst = worst_alone,
                                     .broadcast = broadcast_alone,
                                     .count_traffic = count_no_traffic,
                                     .did = did_alone,
                                     .trace = trace_alone};
}
