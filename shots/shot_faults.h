/* What cannot be of values whose numbers are in their ranges each: for the table of fields, and for who draws them. */
#ifndef CONIC_SHOT_FAULTS_H
#define CONIC_SHOT_FAULTS_H

#include "conic/shot.h"
#include "core/image/view_arguments.h"

/* What is wrong with a shot, whatever is drawn of it; null: nothing. */
const char *conic_shot_fault(const conic_shot *shot);

/* conic_shot_rows.is_wrong of a conic_camera, conic_camera_way, and so on. */
int conic_camera_value_is_wrong(const void *value, char wrong[CONIC_CAMERA_FAULT_ROOM]);
int conic_way_is_wrong(const void *value, char wrong[CONIC_CAMERA_FAULT_ROOM]);
int conic_light_is_wrong(const void *value, char wrong[CONIC_CAMERA_FAULT_ROOM]);
int conic_lighting_is_wrong(const void *value, char wrong[CONIC_CAMERA_FAULT_ROOM]);
int conic_render_is_wrong(const void *value, char wrong[CONIC_CAMERA_FAULT_ROOM]);
int conic_shot_light_is_wrong(const void *value, char wrong[CONIC_CAMERA_FAULT_ROOM]);
int conic_aperture_is_wrong(const void *value, char wrong[CONIC_CAMERA_FAULT_ROOM]);
int conic_map_is_wrong(const void *value, char wrong[CONIC_CAMERA_FAULT_ROOM]);
int conic_shot_is_wrong(const void *value, char wrong[CONIC_CAMERA_FAULT_ROOM]);

#endif
