/* How far out points may be for commands that frame or keep a scene. */
#ifndef CLI_REACH_H
#define CLI_REACH_H

/* Whether the box can be framed: the camera's numbers then stay well within those that drawing takes. */
static inline int cli_is_in_reach(const double low[3], const double high[3]) {
  for (int axis = 0; axis < 3; axis++)
    if (!(low[axis] > -1e20 && high[axis] < 1e20))
      return 0;
  return 1;
}

#endif
