/* The plane of motion: how far what each pixel shows moves from frame to frame, with the camera and the inputs. */
#pragma once

#include "shots/stage.h"

/* Fills in the plane, where the image has it, from the plane Z of N × N samples and, where inputs move, id; `camera`
 * drew them. Errors: ARGUMENT (the camera's way; inputs that shrink to nothing), UNSUPPORTED (shapes that change),
 * MEMORY. */
conic_status conic_motion_plane_find(const conic_shot_work *work, const conic_camera *camera, int samples,
                                     const conic_image *image);
