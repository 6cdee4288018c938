/* What options of pictures have an effect on, as bits of cli_effect (cli/arguments.h). */
#pragma once

enum cli_fact {
  /* Of what is drawn. Some of these are known only once it is read; until then they may hold. */
  CLI_FACT_COMPOSITED, /* Gaussians */
  CLI_FACT_MIXED,      /* these, with surfaces among them */
  CLI_FACT_GAUSSIANS,  /* the file is a Gaussian scene, however it is drawn */
  CLI_FACT_SPLATS,
  CLI_FACT_TRIANGLES,
  CLI_FACT_FACES, /* the file has some, whatever is made of them */
  CLI_FACT_TEXTURED,
  CLI_FACT_EDGES,     /* triangles whose file has no normals */
  CLI_FACT_RAW,       /* points whose sizes are estimated */
  CLI_FACT_TEXT,      /* a file of text */
  CLI_FACT_FRACTIONS, /* colours whose meaning --colors says */
  CLI_FACT_ALPHA,     /* surfaces that let light through */
  CLI_FACT_VALUED,    /* colours that are made of values */
  CLI_FACT_MEASURED,  /* points with values of their own */
  CLI_FACT_HYBRID,
  CLI_FACT_LEVELS,  /* a cloud in levels */
  CLI_FACT_NODES,   /* an octree */
  CLI_FACT_CHOOSES, /* by an error or a budget */
  CLI_FACT_URL,

  /* Of what is asked for. */
  CLI_FACT_ACCUMULATED,
  CLI_FACT_SAMPLE, /* one of those that are accumulated */
  CLI_FACT_LENS,
  CLI_FACT_WAY,     /* of the camera or the scene, while the shutter is open */
  CLI_FACT_FRAMED,  /* by the options, and not by a camera of a file */
  CLI_FACT_FIELD,   /* of view, which the projection has */
  CLI_FACT_CAMERAS, /* of a file, or the scene's sides by their names */
  CLI_FACT_UPRIGHT, /* it matters what points up */
  CLI_FACT_TURNTABLE,
  CLI_FACT_EVERY_VIEW,
  CLI_FACT_MAP,
  CLI_FACT_STEREO,
  CLI_FACT_ERROR,
  CLI_FACT_BUDGET,
  CLI_FACT_PATCH,
  CLI_FACT_KERNEL,     /* splats fade by a kernel */
  CLI_FACT_FILTERED,   /* and are filtered for the pixels */
  CLI_FACT_BLENDED,    /* by 3 passes */
  CLI_FACT_SHAPED,     /* normals are to be seen, in shades or planes */
  CLI_FACT_LIT,        /* surfaces have a shade */
  CLI_FACT_UNSETTLED,  /* --quality decides something */
  CLI_FACT_OWN_CENTER, /* the profile takes the picture's middle for the principal point */
  CLI_FACT_EXR,
  CLI_FACT_TIFF,
  CLI_FACT_TELLING,  /* files that say how they were made */
  CLI_FACT_CODES,    /* files of 8 or 16 bits */
  CLI_FACT_NAMELESS, /* files whose names do not say what they are */
  CLI_FACT_OPENCL,

  /* The rest is only looked at for what cannot be together. */
  CLI_FACT_ASKING,    /* the command asks about a picture, and makes none */
  CLI_FACT_EXACT,     /* Gaussians by --profile exact */
  CLI_FACT_PROJECTED, /* --projection, but for perspective; of these */
  CLI_FACT_CUBE,
  CLI_FACT_DEEP,
  CLI_FACT_MATTES,
  CLI_FACT_TRANSPARENT,
  CLI_FACT_SAMPLED, /* several samples a pixel */
  CLI_FACT_PROGRESSIVE,
  CLI_FACT_DEADLINE,
  CLI_FACT_REPEATED,
  CLI_FACT_EXPOSED,  /* by what the picture shows */
  CLI_FACT_BACKDROP, /* of two colours */
  CLI_FACT_LAMPS,    /* lights with a place or a size */
  CLI_FACT_MASKED,   /* light that is hidden is taken away */
  CLI_FACT_SHOWN,    /* a picture by --show, or a legend */
  CLI_FACT_STREAM,   /* pictures go to standard output, to a host, or on with others */
  CLI_N_FACTS
};

typedef unsigned long long cli_facts; /* a set of them */
#define CLI_FACT(name) (1ull << CLI_FACT_##name)
/* Those of what is drawn. */
#define CLI_SOURCE_FACTS (CLI_FACT(ACCUMULATED) - 1)
/* What is drawn and not composited. */
#define CLI_SURFACES (CLI_FACT(SPLATS) | CLI_FACT(TRIANGLES))
/* What looks at more of a scene than the pixels of one picture; and what is written beside its planes, or into them. */
#define CLI_LOOKS_AROUND                                                                                               \
  (CLI_FACT(TRANSPARENT) | CLI_FACT(MATTES) | CLI_FACT(DEEP) | CLI_FACT(PROGRESSIVE) | CLI_FACT(MASKED) |              \
   CLI_FACT(ACCUMULATED))
#define CLI_WRITES_MORE (CLI_FACT(DEEP) | CLI_FACT(SHOWN) | CLI_FACT(PROGRESSIVE) | CLI_FACT(BACKDROP))
/* More pictures than one of the scene, or of what lights it. */
#define CLI_DRAWS_MORE                                                                                                 \
  (CLI_FACT(TURNTABLE) | CLI_FACT(EVERY_VIEW) | CLI_FACT(STEREO) | CLI_FACT(PROJECTED) | CLI_FACT(REPEATED) |          \
   CLI_FACT(MASKED) | CLI_SAMPLES)
#define CLI_CHOSEN (CLI_FACT(ERROR) | CLI_FACT(BUDGET))
#define CLI_SAMPLES (CLI_FACT(ACCUMULATED) | CLI_FACT(SAMPLE))
