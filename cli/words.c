#include "cli/words.h"

/* What stands for a command alone comes first. */
static const cli_word command_words[] = {
    {"view show open", ""},
    {"version", "--version"},
    {"compare difference", "diff"},
    {"stats stat inspect describe", "info"},
    {"draw rasterize rasterise screenshot", "render"},
    {"translate export", "convert"},
    {"generate", "make"},
    {"crop clip filter", "cut"},
    {"combine concat", "merge"},
    {"boolean", "csg"},
    {"benchmark", "bench"},
    {"test", NULL, NULL,
     "conic verify IN compares a picture with exact arithmetic, and scripts/test runs conic's own tests"},
    {"check", NULL, NULL,
     "conic info FILE --check looks for what cannot be drawn, and conic verify at how it is drawn"},
    {"validate", NULL, NULL, "conic info FILE --check looks for what cannot be drawn, and conic judge at pictures"},
    {"turntable animate", NULL, NULL, "conic render IN -o OUT.png --turntable 36 draws OUT.0001.png and so on"},
    {"video film", NULL, NULL, "conic render IN -o OUT.png --turntable 36 draws OUT.0001.png and so on, for ffmpeg"},
    {"simplify decimate", NULL, NULL,
     "conic mls thin and conic prepare --count N leave fewer points, and conic hybrid makes meshes simpler"},
    {"downsample", NULL, NULL,
     "conic prepare IN -o OUT.ply --count N leaves N points, and conic mls thin as many as an error needs"},
    {"thin", NULL, NULL, "conic mls thin IN -o OUT.ply --max-error E, or conic prepare IN -o OUT.ply --count N"},
    {"smooth", NULL, NULL, "conic mls project IN -o OUT.ply draws points onto a smooth surface"},
    {"upsample", NULL, NULL, "conic mls densify IN -o OUT.ply adds points"},
    {"mesh", NULL, NULL,
     "conic makes no meshes of points; it draws points as a surface (conic render), and conic hybrid makes levels of "
     "detail of a mesh"},
    {"normals", NULL, NULL, "conic prepare IN -o OUT.ply gives points normals and sizes"},
    {"lod build", NULL, NULL,
     "conic octree and conic layer make levels of detail of points, and conic hybrid of meshes"},
    {"train", NULL, NULL, "conic trains no Gaussians; conic gradient checks a trainer's derivatives"},
};

/* Of rows for one word the first holds whose option the command has. */
static const cli_word option_words[] = {
    {"output out outfile output-file", "o"},
    {"output o", "heatmap", NULL, "--heatmap OUT.png writes where pictures differ, and --json FILE by how much"},
    {"input i", NULL, NULL, "files to read stand without an option before them"},
    {"force overwrite", NULL, NULL, "files are written over without being asked"},
    {"f format type", "to"},
    {"s resolution res dimensions image-size", "size"},
    {"s", "seed"},
    {"width height w", "size", NULL, "--size WIDTHxHEIGHT is both"},
    {"dpi", "size", NULL, "pixels alone count: --size WxH"},
    {"scale", "zoom", NULL, "--zoom Z shows the scene larger, and --size WxH makes the picture larger"},
    {"j jobs cores num-threads", "threads"},
    {"silent no-progress", "quiet", ""},
    {"debug", "verbose", NULL, "--verbose says more"},
    {"log-level", "verbose", NULL, "--verbose says more, and --quiet less"},
    {"version V", NULL, NULL, "conic --version"},
    {"gpu opencl", "device", "opencl"},
    {"cuda", "device", NULL, "graphics processors draw by --device opencl"},
    {"cpu", "device", "cpu"},
    {"bg bg-color background-color background-colour", "background"},
    {"transparent no-background", "background", "none"},
    {"color colour", "color-by", NULL,
     "--color-by WHAT says what colours points, and --background COLOR what is behind them"},
    {"colour-by scalars coloring-array", "color-by"},
    {"cmap colormap palette", "ramp"},
    {"clim range", "ramp", NULL, "--ramp A,B, or behind a ramp's name, --ramp heat:A,B"},
    {"colorbar scalar-bar", "show", "legend"},
    {"ortho orthographic parallel", "projection", "orthographic"},
    {"perspective", "projection", "perspective"},
    {"fisheye", "projection", "fisheye"},
    {"panorama", "projection", "panorama"},
    {"yaw angle camera-azimuth-angle", "azimuth"},
    {"pitch camera-elevation-angle", "elevation"},
    {"view-angle camera-view-angle", "fov"},
    {"position camera-position", "eye"},
    {"look-at lookat target", "eye", NULL,
     "the camera looks at the scene's middle, from --eye X,Y,Z; --camera FILE looks anywhere"},
    {"rotate", "azimuth", NULL, "--azimuth DEG goes around the scene, and --up DIR says what points up"},
    {"orbit spin n-frames", "turntable"},
    {"framerate", "fps"},
    {"section slice", "where", NULL,
     "--where 'z < 3' draws a part by values, and conic cut IN -o OUT --box X0,Y0,Z0,X1,Y1,Z1 keeps one"},
    {"clip crop bbox", "camera", NULL,
     "--where 'z < 3' draws a part by values, and conic cut IN -o OUT --box X0,Y0,Z0,X1,Y1,Z1 keeps one"},
    {"clip crop bbox bounds", "box"},
    {"point-size pointsize", "method", NULL,
     "points are as large as their neighbours are far; --method point draws each as a pixel"},
    {"spp aa antialiasing msaa ssaa", "samples", NULL, "--samples N averages N x N samples in each pixel"},
    {"ssao ambient-occlusion", "ao", NULL, "--ao 64 darkens what little light from around reaches"},
    {"shadows", "shadow", ""},
    {"unlit no-lighting", "shade", "none"},
    {"shading lighting", "shade"},
    {"flat", "crease", "0"},
    {"hdri env envmap", "sky"},
    {"brightness", "exposure"},
    {"gamma", "exposure", NULL, "--exposure EV makes all brighter, and --tone NAME bends what is bright"},
    {"tonemap tone-mapping", "tone"},
    {"depth", "aov", NULL, "--aov Z is the plane of depths, which an .exr holds anyway"},
    {"normals", "aov", NULL, "--aov N is the plane of normals, and --color-by normal shows them"},
    {"wireframe edges", "as", NULL, "conic draws no lines; --as points draws a mesh's vertices"},
    {"max-splats", "budget"},
    {"lod", "error", NULL, "--error PX draws as coarsely as that many pixels allow, and --budget N the best N splats"},
    {"max-points n-points", "count"},
    {"voxel-size", "spacing"},
    {"tolerance", "max-abs"},
    {"psnr", "min-psnr"},
    {"ssim", "min-ssim"},
    {"ao shadow", NULL, NULL,
     "it is an option of conic render and conic sheet: shadows are neither verified, judged nor explained"},
    {"again accumulate aperture catcher deadline deep focus fps frames holdout memory motion occlusion path place "
     "preview progressive repeat resumable resume save-shot show shutter stereo tone transparency turntable",
     NULL, NULL, "it is an option of conic render"},
};

/* Whether a word of so many letters is one of those in `said`. */
static int is_said(const cli_word *row, const char *word, size_t length) {
  for (const char *said = row->said; *said; said += strspn(said, " ")) {
    const size_t n = strcspn(said, " ");
    if (n == length && strncmp(said, word, n) == 0)
      return 1;
    said += n;
  }
  return 0;
}

const cli_word *cli_word_for_command(const char *word) {
  for (size_t i = 0; i < sizeof command_words / sizeof *command_words; i++)
    if (is_said(&command_words[i], word, strlen(word)))
      return &command_words[i];
  return NULL;
}

const cli_word *cli_word_for_option(const char *word, size_t length, int (*has)(const void *cookie, const char *name),
                                    const void *cookie) {
  for (size_t i = 0; i < sizeof option_words / sizeof *option_words; i++) {
    const cli_word *row = &option_words[i];
    if (is_said(row, word, length) && (!row->is || has(cookie, row->is)))
      return row;
  }
  return NULL;
}

void cli_mean_command(cli_session *session, int argc, char *const *argv, int i_output) {
  const size_t room = sizeof session->meant;
  size_t used = (size_t)snprintf(session->meant, room, "conic");
  for (int i = 0; i < argc && used < room; i++)
    used += (size_t)snprintf(session->meant + used, room - used, " %s%s", i == i_output ? "-o " : "", argv[i]);
}
