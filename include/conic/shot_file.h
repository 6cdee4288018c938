/* Shots in files: all that decides a picture, as text that people can read, and the key of it. docs/reference/shot.md
 * defines the text, docs/reference/shot.schema.json its schema.
 *
 * One table of fields stands behind all of this (conic_shot_field_at). */
#ifndef CONIC_SHOT_FILE_H
#define CONIC_SHOT_FILE_H

#include "conic/shot.h"

CONIC_BEGIN_C

/* What a file is to a picture. */
typedef enum conic_shot_role {
  CONIC_SHOT_SCENE = 0,   /* it is drawn; these are in the order of the source's files */
  CONIC_SHOT_TEXTURE = 1, /* the picture of conic_source_options.texture_path */
  CONIC_SHOT_SKY = 2,
  CONIC_SHOT_MOTION = 3,
  CONIC_SHOT_PART = 4 /* one of the others leads to it */
} conic_shot_role;

#define CONIC_N_SHOT_ROLES 5

/* A file, a folder or a URL that a picture is made of. */
typedef struct conic_shot_input {
  const char
      *name; /* as it was given; of a part, from the folder of the first file of the scene, where it lies below */
  conic_shot_role role;
  int is_sampled;   /* it is larger than 64 MiB: the hash is of its size, its time and 64 pieces */
  uint64_t n_bytes; /* 0: not known, as of standard input */
  char sha256[72];  /* 64 digits; empty: not known, as of a URL */
  uint64_t reserved[4];
} conic_shot_input;

/* A map, which is seen from straight above: its camera follows. */
typedef struct conic_shot_map {
  int is_wanted;
  int epsg;                      /* the coordinate system by its code; 0: the file's */
  double pixel;                  /* a pixel's edge in the world; 0: the spacing of the points */
  double minimum[3], maximum[3]; /* what is seen; infinite: all */
  uint64_t reserved[4];
} conic_shot_map;

/* How files are made of the drawn picture, as far as it decides what they show. */
typedef struct conic_shot_writing {
  conic_tone tone;               /* of files of 8 and 16 bits */
  conic_compression compression; /* of an EXR */
  int is_half;                   /* of an EXR */
  int is_bare;                   /* files to look at have nothing behind the picture that it has not itself */
  int has_legend, has_mattes;
  const char *matte_by; /* the property of Gaussians whose values have a matte each; null: each input has one */
  uint64_t reserved[3];
} conic_shot_writing;

/* All that decides a picture. Who fills one in keeps what it points to. */
typedef struct conic_shot_file {
  size_t size; /* sizeof(conic_shot_file), set by the init function */
  conic_shot shot;
  conic_source_options reading; /* how the files of the scene become a source */
  conic_shot_map map;
  conic_shot_writing writing;
  const conic_shot_input *inputs;
  size_t n_inputs;
} conic_shot_file;

/* The library's defaults, and no inputs. */
CONIC_API void conic_shot_file_init_sized(conic_shot_file *file, size_t size);
#define conic_shot_file_init(file) conic_shot_file_init_sized(file, sizeof *(file))

enum { CONIC_SHOT_KEY_ROOM = 65 };

/* The key of a picture, as hex digits: a hash of the fields, but for `writing`, and of what the inputs hold. However a
 * picture was asked for, it has one key. Errors: ARGUMENT. */
CONIC_API conic_status conic_shot_file_key(conic_context *context, const conic_shot_file *file,
                                           char key[CONIC_SHOT_KEY_ROOM]);

/* --- as text --- */

/* What text to write. */
typedef enum conic_shot_text {
  CONIC_SHOT_WHOLE = 0,      /* inputs by the names that they were given by */
  CONIC_SHOT_IN_PICTURE = 1, /* without their folders: the same wherever the picture was drawn */
  CONIC_SHOT_COMPLETE = 2    /* also what is as it is by default */
} conic_shot_text;

/* The file's text, with zero at its end, which the caller releases by conic_shot_text_release. Numbers read back to the
 * bit; what is as by default is left out, but for the camera. Errors: ARGUMENT, MEMORY. */
CONIC_API conic_status conic_shot_file_print(conic_context *context, const conic_shot_file *file, conic_shot_text what,
                                             char **text);
CONIC_API void conic_shot_text_release(conic_context *context, char *text);

/* Writes it to PATH, which appears when it is whole. Errors: as before, IO. */
CONIC_API conic_status conic_shot_file_write(conic_context *context, const conic_shot_file *file, const char *path);

/* Reads the text in memory; `name` is for messages; null: nothing is said of what is wrong with it. On success the
 * caller owns *file and destroys it before the context. Sky and motion are null in it, and a texture's name, too: they
 * are among the inputs. Errors: INPUT (a key that is none, a later version, a value that cannot be), MEMORY. */
CONIC_API conic_status conic_shot_file_parse(conic_context *context, const char *name, const char *text, size_t n_bytes,
                                             conic_shot_file **file);
/* The same of a file, or of a picture that carries one: an EXR, a PNG or a TIFF. Errors: as before; INPUT (there is no
 * such file, or the picture carries none). */
CONIC_API conic_status conic_shot_file_read(conic_context *context, const char *path, conic_shot_file **file);
/* Null is allowed. */
CONIC_API void conic_shot_file_destroy(conic_context *context, conic_shot_file *file);

/* Whether a file that can be read is a shot by itself; whether a picture carries one is not looked at. */
CONIC_API int conic_shot_is_file(const char *path);

/* A field that two shots differ in: what it is in each, as JSON; null: one of them has no such field. */
typedef void conic_shot_difference(void *cookie, const char *field, const char *a, const char *b);
/* Tells of each, in the order of the table, then of inputs, as "inputs[0]". Errors: MEMORY. */
CONIC_API conic_status conic_shot_file_compare(conic_context *context, const conic_shot_file *a,
                                               const conic_shot_file *b, conic_shot_difference *receive, void *cookie);

/* The JSON schema of the text, as it stands in docs/reference/shot.schema.json. Errors: MEMORY. */
CONIC_API conic_status conic_shot_schema_print(conic_context *context, char **text);

/* --- the table of fields --- */

typedef enum conic_shot_field_kind {
  CONIC_SHOT_FIELD_TRUTH = 0,
  CONIC_SHOT_FIELD_INTEGER = 1,
  CONIC_SHOT_FIELD_FLOAT = 2,  /* rounded to float */
  CONIC_SHOT_FIELD_DOUBLE = 3, /* 64 bits */
  CONIC_SHOT_FIELD_WORD = 4,   /* one of `words` */
  CONIC_SHOT_FIELD_WORDS = 5,  /* several of them */
  CONIC_SHOT_FIELD_TEXT = 6
} conic_shot_field_kind;

#define CONIC_MAX_SHOT_WORDS 32

/* A number, a word or an array of them. */
typedef struct conic_shot_field {
  char path[96]; /* "view.samples"; of each member of a list "render.lighting.lights[].color" */
  conic_shot_field_kind kind;
  int count;                               /* of numbers */
  const char *unit;                        /* null: none */
  const char *meaning;                     /* a line */
  const char *words[CONIC_MAX_SHOT_WORDS]; /* null after the last */
  char standard[160];                      /* what it is unless it is said, as JSON; empty: it has to be said */
} conic_shot_field;

/* The fields from 0 on; returns 0 after the last. */
CONIC_API int conic_shot_field_at(size_t i, conic_shot_field *field);

CONIC_END_C
#endif
