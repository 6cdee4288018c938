#include "cli/sheet/stroke_font.h"

#include <stddef.h>

static const struct {
  unsigned code;
  const char *strokes;
} letters[] = {
    {'0', "EQ~IQIK~IEEE~AEAK~AQEQ"},
    {'1', "BNFQFE"},
    {'2', "AN~AQEQ~IQIN~IKEIAEIE"},
    {'3', "AQIQEL~ILII~IEEE~AEAH"},
    {'4', "GEGQAIII"},
    {'5', "HQBQAL~BMEM~IMII~IEEE~AEAH"},
    {'6', "GQ~AOAI~AEEE~IEII~IMEM~AMAI"},
    {'7', "AQIQDE"},
    {'8', "EQ~HQHO~HLEL~ILII~IEEE~AEAI~ALEL~BLBO~BQEQ"},
    {'9', "CE~IGIM~IQEQ~AQAM~AIEI~IIIM"},
    {'A', "AEEQIE BIHI"},
    {'B', "AQEQ~HQHO~HLELAL EL~ILII~IEEEAEAQ"},
    {'C', "IN~HQEQ~AQAK~AEEE~HEIH"},
    {'D', "AEAQDQ~IQIK~IEDEAE"},
    {'E', "HQAQAEHE ALFL"},
    {'F', "HQAQAE ALFL"},
    {'G', "IN~HQEQ~AQAK~AEEE~IEIIIKFK"},
    {'H', "AQAE IQIE AKIK"},
    {'I', "BQBE"},
    {'J', "GQGH~GEDE~AEAH"},
    {'K', "AQAE IQAJ DMIE"},
    {'L', "AQAEHE"},
    {'M', "AEAQFGKQKE"},
    {'N', "AEAQIEIQ"},
    {'O', "FQ~KQKK~KEFE~AEAK~AQFQ"},
    {'P', "AEAQEQ~IQIN~IKEKAK"},
    {'Q', "FQ~KQKK~KEFE~AEAK~AQFQ GHKD"},
    {'R', "AEAQEQ~IQIN~IKEKAK EKIE"},
    {'S', "IN~IQEQ~AQAN~ALEK~IJIH~IEEE~AEAH"},
    {'T', "AQIQ EQEE"},
    {'U', "AQAI~AEEE~IEIIIQ"},
    {'V', "AQEEIQ"},
    {'W', "AQDEGOJEMQ"},
    {'X', "AQIE IQAE"},
    {'Y', "AQEKIQ EKEE"},
    {'Z', "AQIQAEIE"},
    {'a', "GMGE GI~GMDM~AMAI~AEDE~GEGI"},
    {'b', "AQAE AI~AMDM~GMGI~GEDE~AEAI"},
    {'c', "GK~FMDM~AMAI~AEDE~FEGG"},
    {'d', "GQGE GI~GMDM~AMAI~AEDE~GEGI"},
    {'e', "AIGI~GMDM~AMAI~AEDE~FEGG"},
    {'f', "EQ~BQBNBE AMEM"},
    {'g', "GMGD~GADA~BAAB GI~GMDM~AMAI~AEDE~GEGI"},
    {'h', "AQAE AI~AMDM~GMGJGE"},
    {'i', "BMBE BPBQ"},
    {'j', "CMCD~CAAA CPCQ"},
    {'k', "AQAE GMAH CJGE"},
    {'l', "BQBE"},
    {'m', "AMAE AI~AMDM~FMFJFE FI~FMHM~KMKJKE"},
    {'n', "AMAE AI~AMDM~GMGJGE"},
    {'o', "DM~GMGI~GEDE~AEAI~AMDM"},
    {'p', "AMAA AI~AMDM~GMGI~GEDE~AEAI"},
    {'q', "GMGA GI~GMDM~AMAI~AEDE~GEGI"},
    {'r', "AMAE AI~AMEM"},
    {'s', "GL~FMDM~AMAK~AIDI~GIGG~GEDE~AEAF"},
    {'t', "BQBH~BEEE AMEM"},
    {'u', "AMAH~AEDE~GEGI GMGE"},
    {'v', "AMDEGM"},
    {'w', "AMCEEKGEIM"},
    {'x', "AMGE GMAE"},
    {'y', "AMDE GMCC~BAAA"},
    {'z', "AMGMAEGE"},
    {'.', "BEBF"},
    {',', "BFAC"},
    {'-', "AJGJ"},
    {'+', "AKIK EOEG"},
    {'_', "ADID"},
    {'/', "ACGQ"},
    {':', "BLBM BEBF"},
    {';', "BLBM BFAC"},
    {'(', "CQ~ANAJ~AFCC"},
    {')', "AQ~CNCJ~CFAC"},
    {'=', "AMIM AIII"},
    {'\'', "BQBN"},
    {'"', "AQAN CQCN"},
    {'!', "BQBI BEBF"},
    {'?', "AN~AQDQ~GQGN~GLDJDI DEDF"},
    {'%', "BQ~DQDO~DMBM~AMAO~AQBQ IQBE HI~JIJG~JEHE~GEGG~GIHI"},
    {'&', "IEBN~BQDQ~FQFO~FMCK~AJAH~AEDE~HEII"},
    {'*', "DPDJ AOGK GOAK"},
    {'#', "CQBE HQGE AMIM AIII"},
    {'<', "GOAKGG"},
    {'>', "AOGKAG"},
    {'[', "CQAQACCC"},
    {']', "AQCQCCAC"},
    {'\\', "AQGC"},
    {'|', "BQBC"},
    {'^', "ANDQGN"},
    {'~', "AJ~CLEJ~GHIJ"},
    {'`', "BQDO"},
    {0xb0, "CQ~EQEO~EMCM~AMAO~AQCQ"},
    {0xb2, "AO~AQCQ~EQEO~ENAKEK"},
    {0xb3, "AQEQCO~EOEM~EKCK~AKAL"},
    {0xb4, "DQBO"},
    {0xb7, "BJBK"},
    {0xb8, "DE~EBBB"},
    {0xa8, "BPBQ EPEQ"},
    {0xd7, "ALGF GLAF"},
    {0xdf, "AEAN~AQDQ~GQGN~GLDL~HLHI~HEDE"},
    {0x2da, "DQ~EQEP~EODO~COCP~CQDQ"},
    {0x2013, "AJKJ"},
    {0x2019, "BQBN"},
};

const char *cli_glyph_strokes(unsigned code) {
  for (size_t i = 0; i < sizeof letters / sizeof *letters; i++)
    if (letters[i].code == code)
      return letters[i].strokes;
  return NULL;
}

/* From U+00C0 on: the letters, and their marks. */
static const char bases[] = "AAAAAA\0CEEEEIIII\0NOOOOO\0\0UUUUY\0\0aaaaaa\0ceeeeiiii\0nooooo\0\0uuuuy\0y";
static const char marks[] = "`'^~:o ,`'^:`'^: ~`'^~:  `'^:'  `'^~:o ,`'^:`'^: ~`'^~:  `'^:' :";

unsigned cli_glyph_part(unsigned code, unsigned *mark) {
  static const char signs[] = "`'^~:o,";
  static const unsigned codes[] = {'`', 0xb4, '^', '~', 0xa8, 0x2da, 0xb8};
  *mark = 0;
  if (code < 0xc0 || code > 0xff || !bases[code - 0xc0])
    return code;
  for (size_t i = 0; signs[i]; i++)
    if (signs[i] == marks[code - 0xc0])
      *mark = codes[i];
  return (unsigned char)bases[code - 0xc0];
}
