#include "core/coloring/color_ramp.h"

#include <stddef.h>

#include "core/base/color.h"

enum { N_KNOTS = 9 };

/* Lightness, and the axes towards red and yellow; knots are equally far apart. */
static const double knots[CONIC_RAMP_CLASSES][N_KNOTS][3] = {
    [CONIC_RAMP_SEQUENTIAL] = {{0.320, 0.075, -0.130},
                               {0.397, 0.016, -0.149},
                               {0.469, -0.039, -0.132},
                               {0.546, -0.065, -0.078},
                               {0.632, -0.092, -0.040},
                               {0.714, -0.122, 0.005},
                               {0.787, -0.136, 0.063},
                               {0.864, -0.100, 0.112},
                               {0.940, -0.046, 0.143}},
    [CONIC_RAMP_GREY] = {{0.28, 0, 0},
                         {0.37, 0, 0},
                         {0.46, 0, 0},
                         {0.55, 0, 0},
                         {0.64, 0, 0},
                         {0.73, 0, 0},
                         {0.82, 0, 0},
                         {0.91, 0, 0},
                         {1.00, 0, 0}},
    [CONIC_RAMP_HEAT] = {{0.200, 0.017, -0.014},
                         {0.304, 0.075, -0.033},
                         {0.396, 0.151, -0.018},
                         {0.498, 0.181, 0.041},
                         {0.595, 0.170, 0.106},
                         {0.692, 0.103, 0.130},
                         {0.796, 0.045, 0.151},
                         {0.901, -0.014, 0.147},
                         {0.970, -0.057, 0.156}},
    [CONIC_RAMP_DIVERGING] = {{0.380, -0.019, -0.139},
                              {0.528, -0.035, -0.131},
                              {0.671, -0.033, -0.095},
                              {0.812, -0.022, -0.051},
                              {0.949, -0.003, 0.001},
                              {0.824, 0.049, 0.046},
                              {0.688, 0.102, 0.070},
                              {0.547, 0.145, 0.080},
                              {0.400, 0.134, 0.068}},
    [CONIC_RAMP_TERRAIN] = {{0.470, -0.088, 0.043},
                            {0.530, -0.096, 0.060},
                            {0.590, -0.098, 0.078},
                            {0.648, -0.087, 0.097},
                            {0.718, -0.054, 0.113},
                            {0.779, -0.004, 0.105},
                            {0.836, 0.018, 0.062},
                            {0.905, 0.005, 0.026},
                            {0.980, 0, 0}},
    /* Every eighth of Matplotlib's. */
    [CONIC_RAMP_VIRIDIS] = {{0.285, 0.102, -0.091},
                            {0.373, 0.054, -0.116},
                            {0.449, -0.007, -0.098},
                            {0.522, -0.055, -0.060},
                            {0.595, -0.093, -0.018},
                            {0.671, -0.127, 0.036},
                            {0.749, -0.141, 0.102},
                            {0.833, -0.110, 0.159},
                            {0.918, -0.039, 0.182}},
    [CONIC_RAMP_MAGMA] = {{0.053, 0.005, -0.028},
                          {0.232, 0.027, -0.091},
                          {0.352, 0.096, -0.131},
                          {0.449, 0.142, -0.087},
                          {0.544, 0.174, -0.022},
                          {0.642, 0.176, 0.054},
                          {0.747, 0.116, 0.095},
                          {0.860, 0.040, 0.093},
                          {0.978, -0.025, 0.075}},
    [CONIC_RAMP_TURBO] = {{0.251, 0.058, -0.056},
                          {0.569, -0.009, -0.187},
                          {0.742, -0.093, -0.096},
                          {0.850, -0.177, 0.077},
                          {0.903, -0.153, 0.171},
                          {0.857, -0.019, 0.159},
                          {0.724, 0.114, 0.138},
                          {0.560, 0.168, 0.111},
                          {0.367, 0.129, 0.072}},
};

/* OKLab's two matrices, and cubes between them. */
static void linear_of_oklab(const double lab[3], float linear[3]) {
  static const double cones[3][2] = {
      {0.3963377774, 0.2158037573}, {-0.1055613458, -0.0638541728}, {-0.0894841775, -1.2914855480}};
  static const double rgb[3][3] = {{4.0767416621, -3.3077115913, 0.2309699292},
                                   {-1.2684380046, 2.6097574011, -0.3413193965},
                                   {-0.0041960863, -0.7034186147, 1.7076147010}};
  double cubes[3];
  for (int i = 0; i < 3; i++) {
    double root = lab[0] + cones[i][0] * lab[1] + cones[i][1] * lab[2];
    cubes[i] = root * root * root;
  }
  for (int channel = 0; channel < 3; channel++) {
    double value = rgb[channel][0] * cubes[0] + rgb[channel][1] * cubes[1] + rgb[channel][2] * cubes[2];
    linear[channel] = (float)(value > 0.0 ? value < 1.0 ? value : 1.0 : 0.0);
  }
}

void conic_ramp_color(conic_ramp ramp, double t, float linear[3]) {
  double at = (t > 0.0 ? t < 1.0 ? t : 1.0 : 0.0) * (double)(N_KNOTS - 1), lab[3];
  int i = at < (double)(N_KNOTS - 2) ? (int)at : N_KNOTS - 2;
  for (int k = 0; k < 3; k++) {
    double from = knots[ramp][i][k], to = knots[ramp][i + 1][k];
    lab[k] = from + (to - from) * (at - (double)i);
  }
  linear_of_oklab(lab, linear);
}

/* The classes of LAS 1.4, table 17, with colours as on maps; sRGB codes. */
static const struct {
  const char *name;
  uint8_t code[3];
} classes[] = {{"never classified", {150, 150, 150}},
               {"unclassified", {190, 190, 185}},
               {"ground", {166, 118, 72}},
               {"low vegetation", {170, 205, 105}},
               {"medium vegetation", {88, 165, 72}},
               {"high vegetation", {28, 110, 52}},
               {"building", {222, 92, 60}},
               {"low noise", {200, 60, 160}},
               {"key point", {150, 110, 200}},
               {"water", {62, 130, 205}},
               {"rail", {95, 80, 105}},
               {"road", {105, 108, 112}},
               {"overlap", {200, 190, 160}},
               {"wire guard", {245, 215, 90}},
               {"wire conductor", {250, 190, 40}},
               {"transmission tower", {125, 95, 175}},
               {"wire connector", {245, 145, 40}},
               {"bridge deck", {190, 150, 135}},
               {"high noise", {235, 85, 140}},
               {"overhead structure", {140, 160, 190}},
               {"ignored ground", {205, 175, 140}},
               {"snow", {240, 245, 250}},
               {"temporal exclusion", {90, 90, 95}}};

enum { N_CLASSES = sizeof classes / sizeof *classes };

const char *conic_class_name(uint32_t number) {
  return number < N_CLASSES ? classes[number].name : NULL;
}

void conic_class_color(uint32_t number, float linear[3]) {
  static const uint8_t others[8][3] = {{68, 160, 170}, {215, 130, 45}, {120, 110, 190}, {200, 80, 120},
                                       {130, 170, 60}, {190, 160, 30}, {140, 110, 80},  {90, 130, 180}};
  const uint8_t *code = number < N_CLASSES ? classes[number].code : others[number % 8];
  for (int channel = 0; channel < 3; channel++)
    linear[channel] = (float)conic_srgb_decode((double)code[channel] / 255.0);
}

void conic_number_color(uint32_t number, float linear[3]) {
  uint32_t bits = (number + 1) * 2654435761u;
  bits ^= bits >> 15;
  bits *= 2246822519u;
  bits ^= bits >> 13;
  for (int channel = 0; channel < 3; channel++)
    linear[channel] = 0.08f + 0.92f * (float)(bits >> 8 * channel & 0xFF) / 255.0f;
}
