/* What is wrong with values whose numbers are in their ranges each, whatever is drawn by them: for the table of fields,
 * and for who draws them. Each takes the struct that its name says, and returns null where nothing is; what it returns
 * holds until the thread's next call. */
#pragma once

const char *conic_fault_of_camera(const void *value);
const char *conic_fault_of_way(const void *value);
const char *conic_fault_of_light(const void *value);
const char *conic_fault_of_lighting(const void *value);
const char *conic_fault_of_render(const void *value);
const char *conic_fault_of_shot_light(const void *value);
const char *conic_fault_of_aperture(const void *value);
const char *conic_fault_of_map(const void *value);
const char *conic_fault_of_shot(const void *value);
