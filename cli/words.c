#include "cli/words.h"

/* What stands for a command alone comes first. */
static const cli_word command_words[] = {
    {"view", ""},
    {"show", ""},
    {"open", ""},
    {"version", "--version"},
    {"compare", "diff"},
    {"difference", "diff"},
    {"stats", "info"},
    {"stat", "info"},
    {"inspect", "info"},
    {"describe", "info"},
    {"draw", "render"},
    {"rasterize", "render"},
    {"rasterise", "render"},
    {"screenshot", "render"},
    {"translate", "convert"},
    {"export", "convert"},
    {"generate", "make"},
    {"crop", "cut"},
    {"clip", "cut"},
    {"filter", "cut"},
    {"combine", "merge"},
    {"concat", "merge"},
    {"boolean", "csg"},
    {"benchmark", "bench"},
    {"test", NULL, NULL,
     "conic verify IN compares a picture with exact arithmetic, and scripts/test runs conic's own tests"},
    {"check", NULL, NULL,
     "conic info FILE --check looks for what cannot be drawn, and conic verify at how it is drawn"},
    {"validate", NULL, NULL, "conic info FILE --check looks for what cannot be drawn, and conic judge at pictures"},
    {"turntable", NULL, NULL, "conic render IN -o OUT.png --turntable 36 draws OUT.0001.png and so on"},
    {"animate", NULL, NULL, "conic render IN -o OUT.png --turntable 36 draws OUT.0001.png and so on"},
    {"video", NULL, NULL, "conic render IN -o OUT.png --turntable 36 draws OUT.0001.png and so on, for ffmpeg"},
    {"simplify", NULL, NULL,
     "conic mls thin and conic prepare --count N leave fewer points, and conic hybrid makes "
     "meshes simpler"},
    {"decimate", NULL, NULL,
     "conic mls thin and conic prepare --count N leave fewer points, and conic hybrid makes "
     "meshes simpler"},
    {"downsample", NULL, NULL,
     "conic prepare IN -o OUT.ply --count N leaves N points, and conic mls thin as many as "
     "an error needs"},
    {"thin", NULL, NULL, "conic mls thin IN -o OUT.ply --max-error E, or conic prepare IN -o OUT.ply --count N"},
    {"smooth", NULL, NULL, "conic mls project IN -o OUT.ply draws points onto a smooth surface"},
    {"upsample", NULL, NULL, "conic mls densify IN -o OUT.ply adds points"},
    {"mesh", NULL, NULL,
     "conic makes no meshes of points; it draws points as a surface (conic render), and conic "
     "hybrid makes levels of detail of a mesh"},
    {"normals", NULL, NULL, "conic prepare IN -o OUT.ply gives points normals and sizes"},
    {"lod", NULL, NULL, "conic octree and conic layer make levels of detail of points, and conic hybrid of meshes"},
    {"build", NULL, NULL, "conic octree and conic layer make levels of detail of points, and conic hybrid of meshes"},
    {"train", NULL, NULL, "conic trains no Gaussians; conic gradient checks a trainer's derivatives"},
    {"film", NULL, NULL, "conic render IN -o OUT.png --turntable 36 draws OUT.0001.png and so on, for ffmpeg"},
};

#define CUT_HINT "--where 'z < 3' draws a part by values, and conic cut IN -o OUT --box X0,Y0,Z0,X1,Y1,Z1 keeps one"
#define FILM_HINT "--turntable N draws N pictures; ffmpeg -framerate 25 -i OUT.%04d.png OUT.mp4 makes a film of them"
#define SAMPLES_HINT "--samples N averages N x N samples in each pixel"
#define COLOR_HINT "--color-by WHAT says what colours points, and --background COLOR what is behind them"
#define WIRE_HINT "conic draws no lines; --as points draws a mesh's vertices"
#define LOOK_HINT "the camera looks at the scene's middle, from --eye X,Y,Z; --camera FILE looks anywhere"

/* Of rows for one word the first holds whose option the command has. */
static const cli_word option_words[] = {
    {"output", "o"},
    {"out", "o"},
    {"outfile", "o"},
    {"output-file", "o"},
    {"output", "heatmap", NULL, "--heatmap OUT.png writes where pictures differ, and --json FILE by how much"},
    {"o", "heatmap", NULL, "--heatmap OUT.png writes where pictures differ, and --json FILE by how much"},
    {"input", NULL, NULL, "files to read stand without an option before them"},
    {"i", NULL, NULL, "files to read stand without an option before them"},
    {"force", NULL, NULL, "files are written over without being asked"},
    {"overwrite", NULL, NULL, "files are written over without being asked"},
    {"f", "to"},
    {"format", "to"},
    {"type", "to"},
    {"s", "size"},
    {"resolution", "size"},
    {"res", "size"},
    {"dimensions", "size"},
    {"image-size", "size"},
    {"s", "seed"},
    {"width", "size", NULL, "--size WIDTHxHEIGHT is both"},
    {"height", "size", NULL, "--size WIDTHxHEIGHT is both"},
    {"w", "size", NULL, "--size WIDTHxHEIGHT is both"},
    {"dpi", "size", NULL, "pixels alone count: --size WxH"},
    {"scale", "zoom", NULL, "--zoom Z shows the scene larger, and --size WxH makes the picture larger"},
    {"j", "threads"},
    {"jobs", "threads"},
    {"cores", "threads"},
    {"num-threads", "threads"},
    {"silent", "quiet", ""},
    {"no-progress", "quiet", ""},
    {"debug", "verbose", NULL, "--verbose says more"},
    {"log-level", "verbose", NULL, "--verbose says more, and --quiet less"},
    {"version", NULL, NULL, "conic --version"},
    {"V", NULL, NULL, "conic --version"},
    {"gpu", "device", "opencl"},
    {"opencl", "device", "opencl"},
    {"cuda", "device", NULL, "graphics processors draw by --device opencl"},
    {"cpu", "device", "cpu"},
    {"bg", "background"},
    {"bg-color", "background"},
    {"background-color", "background"},
    {"background-colour", "background"},
    {"transparent", "background", "none"},
    {"no-background", "background", "none"},
    {"color", "color-by", NULL, COLOR_HINT},
    {"colour", "color-by", NULL, COLOR_HINT},
    {"colour-by", "color-by"},
    {"scalars", "color-by"},
    {"coloring-array", "color-by"},
    {"cmap", "ramp"},
    {"colormap", "ramp"},
    {"palette", "ramp"},
    {"clim", "ramp", NULL, "--ramp A,B, or behind a ramp's name, --ramp heat:A,B"},
    {"range", "ramp", NULL, "--ramp A,B, or behind a ramp's name, --ramp heat:A,B"},
    {"colorbar", "show", "legend"},
    {"scalar-bar", "show", "legend"},
    {"ortho", "projection", "orthographic"},
    {"orthographic", "projection", "orthographic"},
    {"parallel", "projection", "orthographic"},
    {"perspective", "projection", "perspective"},
    {"fisheye", "projection", "fisheye"},
    {"panorama", "projection", "panorama"},
    {"yaw", "azimuth"},
    {"angle", "azimuth"},
    {"camera-azimuth-angle", "azimuth"},
    {"pitch", "elevation"},
    {"camera-elevation-angle", "elevation"},
    {"view-angle", "fov"},
    {"camera-view-angle", "fov"},
    {"position", "eye"},
    {"camera-position", "eye"},
    {"look-at", "eye", NULL, LOOK_HINT},
    {"lookat", "eye", NULL, LOOK_HINT},
    {"target", "eye", NULL, LOOK_HINT},
    {"rotate", "azimuth", NULL, "--azimuth DEG goes around the scene, and --up DIR says what points up"},
    {"orbit", "turntable"},
    {"spin", "turntable"},
    {"n-frames", "turntable"},
    {"fps", "turntable", NULL, FILM_HINT},
    {"framerate", "turntable", NULL, FILM_HINT},
    {"section", "where", NULL, CUT_HINT},
    {"slice", "where", NULL, CUT_HINT},
    {"clip", "camera", NULL, CUT_HINT},
    {"crop", "camera", NULL, CUT_HINT},
    {"bbox", "camera", NULL, CUT_HINT},
    {"clip", "box"},
    {"crop", "box"},
    {"bbox", "box"},
    {"bounds", "box"},
    {"point-size", "method", NULL,
     "points are as large as their neighbours are far; --method point draws each as a pixel"},
    {"pointsize", "method", NULL,
     "points are as large as their neighbours are far; --method point draws each as a pixel"},
    {"spp", "samples", NULL, SAMPLES_HINT},
    {"aa", "samples", NULL, SAMPLES_HINT},
    {"antialiasing", "samples", NULL, SAMPLES_HINT},
    {"msaa", "samples", NULL, SAMPLES_HINT},
    {"ssaa", "samples", NULL, SAMPLES_HINT},
    {"ssao", "ao", NULL, "--ao 64 darkens what little light from around reaches"},
    {"ambient-occlusion", "ao", NULL, "--ao 64 darkens what little light from around reaches"},
    {"shadows", "shadow", ""},
    {"unlit", "shade", "none"},
    {"no-lighting", "shade", "none"},
    {"flat", "crease", "0"},
    {"hdri", "sky"},
    {"env", "sky"},
    {"envmap", "sky"},
    {"brightness", "exposure"},
    {"gamma", "exposure", NULL, "--exposure EV makes all brighter, and --tone NAME bends what is bright"},
    {"tonemap", "tone"},
    {"tone-mapping", "tone"},
    {"depth", "aov", NULL, "--aov Z is the plane of depths, which an .exr holds anyway"},
    {"normals", "aov", NULL, "--aov N is the plane of normals, and --color-by normal shows them"},
    {"wireframe", "as", NULL, WIRE_HINT},
    {"edges", "as", NULL, WIRE_HINT},
    {"max-splats", "budget"},
    {"lod", "error", NULL, "--error PX draws as coarsely as that many pixels allow, and --budget N the best N splats"},
    {"max-points", "count"},
    {"n-points", "count"},
    {"voxel-size", "spacing"},
    {"tolerance", "max-abs"},
    {"psnr", "min-psnr"},
    {"ssim", "min-ssim"},
};

const cli_word *cli_word_for_command(const char *said) {
  for (size_t i = 0; i < sizeof command_words / sizeof *command_words; i++)
    if (strcmp(command_words[i].said, said) == 0)
      return &command_words[i];
  return NULL;
}

const cli_word *cli_word_for_option(const char *said, size_t length, int (*has)(const void *cookie, const char *name),
                                    const void *cookie) {
  for (size_t i = 0; i < sizeof option_words / sizeof *option_words; i++) {
    const cli_word *word = &option_words[i];
    if (strlen(word->said) == length && strncmp(word->said, said, length) == 0 && (!word->is || has(cookie, word->is)))
      return word;
  }
  return NULL;
}

void cli_mean_command(cli_session *session, int argc, char *const *argv, int i_output) {
  const size_t room = sizeof session->meant;
  size_t used = (size_t)snprintf(session->meant, room, "conic");
  for (int i = 0; i < argc && used < room; i++)
    used += (size_t)snprintf(session->meant + used, room - used, " %s%s", i == i_output ? "-o " : "", argv[i]);
}
