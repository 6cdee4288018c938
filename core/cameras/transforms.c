/* transforms.json: nerfstudio's, instant-ngp's and the original one of NeRF. */

#include "core/base/trigonometry.h"
#include "core/cameras/camera_list.h"
#include "core/files/json_read.h"

/* Numbers given with a frame, or for all frames. */
enum { W, H, FL_X, FL_Y, CX, CY, ANGLE_X, ANGLE_Y, K1, K2, K3, K4, P1, P2, N_FRAME_NUMBERS };

static const char *const number_names[N_FRAME_NUMBERS] = {
    "w", "h", "fl_x", "fl_y", "cx", "cy", "camera_angle_x", "camera_angle_y", "k1", "k2", "k3", "k4", "p1", "p2"};

typedef struct frame_model {
  const char *name;
  conic_camera_kind kind;
  int has_lens;
} frame_model;

static const frame_model models[] = {{"OPENCV", CONIC_CAMERA_PERSPECTIVE, 1},
                                     {"OPENCV_FISHEYE", CONIC_CAMERA_FISHEYE, 1},
                                     {"PINHOLE", CONIC_CAMERA_PERSPECTIVE, 1},
                                     {"SIMPLE_PINHOLE", CONIC_CAMERA_PERSPECTIVE, 1},
                                     {"RADIAL", CONIC_CAMERA_PERSPECTIVE, 1},
                                     {"SIMPLE_RADIAL", CONIC_CAMERA_PERSPECTIVE, 1},
                                     {"EQUIRECTANGULAR", CONIC_CAMERA_EQUIRECTANGULAR, 0},
                                     {"ORTHOPHOTO", CONIC_CAMERA_ORTHOGRAPHIC, 0}};

typedef struct frame_numbers {
  double numbers[N_FRAME_NUMBERS];
  int is_given[N_FRAME_NUMBERS];
  const frame_model *model; /* null: not given */
} frame_numbers;

typedef struct transforms_frame {
  frame_numbers own;
  double world_from_camera[3][4];
  char *name; /* null: none */
  uint64_t line;
} transforms_frame;

typedef struct transforms_reader {
  conic_camera_list *list;
  conic_json json;
  frame_numbers shared; /* they may come after the frames */
  transforms_frame *frames;
  size_t n_frames, frame_room;
} transforms_reader;

static void read_frame_model(transforms_reader *reader, frame_numbers *numbers) {
  char text[32];
  if (conic_json_text(&reader->json, text, sizeof text) != CONIC_OK)
    return;
  for (size_t i = 0; i < sizeof models / sizeof *models; i++)
    if (strcmp(text, models[i].name) == 0)
      numbers->model = &models[i];
  if (!numbers->model)
    conic_json_wrong(&reader->json, "its camera_model is not read");
}

/* Whether the member is one of a camera's numbers; if so, it is read. */
static int read_frame_number(transforms_reader *reader, const char *key, frame_numbers *numbers) {
  int is_fisheye;
  for (int i = 0; i < N_FRAME_NUMBERS; i++)
    if (strcmp(key, number_names[i]) == 0) {
      numbers->is_given[i] = 1;
      conic_json_number(&reader->json, &numbers->numbers[i]);
      return 1;
    }
  if (strcmp(key, "camera_model") == 0)
    read_frame_model(reader, numbers);
  else if (strcmp(key, "is_fisheye") != 0)
    return 0;
  else if (conic_json_truth(&reader->json, &is_fisheye) == CONIC_OK && is_fisheye)
    numbers->model = &models[1];
  return 1;
}

static void read_frame_matrix(transforms_reader *reader, transforms_frame *frame) {
  conic_json *json = &reader->json;
  static const double last[4] = {0.0, 0.0, 0.0, 1.0};
  double row[4];
  size_t n;
  int n_rows = 0, is_wrong = 0;
  conic_json_begin_array(json);
  while (conic_json_next_item(json)) {
    is_wrong |= conic_json_numbers(json, row, 4, &n) != CONIC_OK || n != 4 || n_rows > 3;
    for (int i = 0; i < 4 && !is_wrong && n_rows < 3; i++)
      frame->world_from_camera[n_rows][i] = row[i];
    for (int i = 0; i < 4 && !is_wrong && n_rows == 3; i++)
      is_wrong |= row[i] != last[i];
    n_rows++;
    if (is_wrong)
      break;
  }
  if (is_wrong || n_rows < 3)
    conic_json_wrong(json, "a transform_matrix has 3 or 4 rows of 4 numbers, the last 0 0 0 1");
}

static void read_frame_name(transforms_reader *reader, transforms_frame *frame) {
  conic_context *context = reader->list->context;
  conic_memory_release(context, frame->name);
  frame->name = conic_memory_allocate(context, CONIC_CAMERA_NAME_ROOM, 1);
  if (frame->name)
    conic_json_text(&reader->json, frame->name, CONIC_CAMERA_NAME_ROOM);
  else if (reader->json.status == CONIC_OK)
    reader->json.status = CONIC_ERROR_MEMORY;
}

static conic_status read_frame(transforms_reader *reader) {
  char key[CONIC_JSON_KEY_ROOM];
  int has_matrix = 0;
  transforms_frame *frame =
      conic_memory_add(reader->list->context, &reader->frames, &reader->n_frames, &reader->frame_room, sizeof *frame);
  if (!frame)
    return CONIC_ERROR_MEMORY;
  frame->line = reader->json.line;
  conic_json_begin_object(&reader->json);
  while (conic_json_next_member(&reader->json, key))
    if (strcmp(key, "file_path") == 0)
      read_frame_name(reader, frame);
    else if (strcmp(key, "transform_matrix") == 0 && ++has_matrix)
      read_frame_matrix(reader, frame);
    else if (!read_frame_number(reader, key, &frame->own))
      conic_json_skip(&reader->json);
  if (!has_matrix)
    conic_json_wrong(&reader->json, "a frame has a transform_matrix");
  return reader->json.status;
}

static conic_status read_transforms(transforms_reader *reader) {
  char key[CONIC_JSON_KEY_ROOM];
  conic_status status = conic_json_begin_object(&reader->json);
  while (status == CONIC_OK && conic_json_next_member(&reader->json, key)) {
    if (strcmp(key, "frames") == 0) {
      status = conic_json_begin_array(&reader->json);
      while (status == CONIC_OK && conic_json_next_item(&reader->json))
        status = read_frame(reader);
    } else if (!read_frame_number(reader, key, &reader->shared))
      conic_json_skip(&reader->json);
  }
  if (status == CONIC_OK)
    status = conic_json_end(&reader->json);
  if (status == CONIC_OK && reader->n_frames == 0)
    status = conic_json_wrong(&reader->json, "there are no frames in it");
  return status;
}

/* A frame's own numbers win over shared ones. */
static void merge_numbers(const frame_numbers *shared, frame_numbers *own) {
  for (int i = 0; i < N_FRAME_NUMBERS; i++)
    if (!own->is_given[i] && shared->is_given[i]) {
      own->is_given[i] = 1;
      own->numbers[i] = shared->numbers[i];
    }
  if (!own->model)
    own->model = shared->model ? shared->model : &models[0];
}

/* The focal length for half the angle across `length`; makes the camera invalid where that is no angle. */
static double focal_of_angle(double angle_rad, double length) {
  return angle_rad > 0.0 && angle_rad < CONIC_PI ? 0.5 * length / conic_tan(0.5 * angle_rad) : 0.0;
}

static void take_focal_lengths(const frame_numbers *n, conic_camera *camera) {
  camera->fx = n->is_given[FL_X]      ? n->numbers[FL_X]
               : n->is_given[ANGLE_X] ? focal_of_angle(n->numbers[ANGLE_X], camera->width)
                                      : 0.0;
  camera->fy = n->is_given[FL_Y]      ? n->numbers[FL_Y]
               : n->is_given[ANGLE_Y] ? focal_of_angle(n->numbers[ANGLE_Y], camera->height)
                                      : camera->fx;
  if (camera->kind == CONIC_CAMERA_EQUIRECTANGULAR) { /* its focal length is the pixels of half a turn */
    camera->fx /= CONIC_PI;
    camera->fy /= CONIC_PI;
  }
  camera->cx = n->is_given[CX] ? n->numbers[CX] : 0.5 * camera->width;
  camera->cy = n->is_given[CY] ? n->numbers[CY] : 0.5 * camera->height;
}

static void take_lens(const frame_numbers *n, conic_camera *camera) {
  const double radial[4] = {n->numbers[K1], n->numbers[K2], n->numbers[K3], n->numbers[K4]};
  if (camera->kind == CONIC_CAMERA_FISHEYE && n->numbers[P1] == 0.0 && n->numbers[P2] == 0.0) {
    camera->lens = CONIC_LENS_RADIAL;
    memcpy(camera->distortion, radial, sizeof radial);
    return;
  }
  /* all four are the polynomial's; OPENCV's fourth is not */
  camera->lens = radial[3] != 0.0 || camera->kind == CONIC_CAMERA_FISHEYE ? CONIC_LENS_THIN_PRISM : CONIC_LENS_OPENCV;
  const double distortion[6] = {radial[0], radial[1], n->numbers[P1], n->numbers[P2], radial[2], radial[3]};
  memcpy(camera->distortion, distortion, sizeof distortion);
}

static conic_status add_frame(conic_camera_list *list, const frame_numbers *shared, const transforms_frame *frame) {
  frame_numbers n = frame->own;
  conic_status status = CONIC_OK;
  list->line = frame->line;
  merge_numbers(shared, &n);
  conic_camera camera = {
      .width = conic_camera_pixels(n.numbers[W]), .height = conic_camera_pixels(n.numbers[H]), .kind = n.model->kind};
  if (!n.is_given[W] && !n.is_given[H])
    status = conic_camera_list_size(list, frame->name, &camera.width, &camera.height);
  if (status != CONIC_OK)
    return status;
  if (camera.width && camera.height) /* else the size is found when it is added */
    take_focal_lengths(&n, &camera);
  if (n.model->has_lens)
    take_lens(&n, &camera);
  conic_camera_place_opengl(frame->world_from_camera, &camera);
  return conic_camera_list_add(list, &camera, frame->name ? frame->name : "", frame->name ? strlen(frame->name) : 0);
}

conic_status conic_camera_transforms_read(conic_camera_list *list, const unsigned char *bytes, size_t n_bytes) {
  transforms_reader reader = {.list = list};
  list->cameras->kind = CONIC_CAMERA_FILE_TRANSFORMS;
  conic_status status = conic_json_take(list->context, list->name, bytes, n_bytes, &reader.json);
  if (status != CONIC_OK)
    return status;
  status = read_transforms(&reader);
  for (size_t i = 0; i < reader.n_frames && status == CONIC_OK; i++)
    status = add_frame(list, &reader.shared, &reader.frames[i]);
  for (size_t i = 0; i < reader.n_frames; i++)
    conic_memory_release(list->context, reader.frames[i].name);
  conic_memory_release(list->context, reader.frames);
  conic_json_close(&reader.json);
  return status;
}
