#include "cli/sheet/stroke_font.h"

#include <string.h>

/* Each letter, and behind it its strokes. */
static const char letters[] =
    "!BQBI BEBF\0\"AQAN CQCN\0#CQBE HQGE AMIM AIII\0$IN~IQEQ~AQAN~ALEK~IJIH~IEEE~AEAH ERED\0"
    "%BQ~DQDO~DMBM~AMAO~AQBQ IQBE HI~JIJG~JEHE~GEGG~GIHI\0&IEBN~BQDQ~FQFO~FMCK~AJAH~AEDE~HEII\0'BQBN\0(CQ~ANAJ~AFCC\0"
    ")AQ~CNCJ~CFAC\0*DPDJ AOGK GOAK\0+AKIK EOEG\0,BFAC\0-AJGJ\0.BEBF\0/ACGQ\0"
    "0EQ~IQIK~IEEE~AEAK~AQEQ\0"
    "1BNFQFE\0"
    "2AN~AQEQ~IQIN~IKEIAEIE\0"
    "3AQIQEL~ILII~IEEE~AEAH\0"
    "4GEGQAIII\0"
    "5HQBQAL~BMEM~IMII~IEEE~AEAH\0"
    "6GQ~AOAI~AEEE~IEII~IMEM~AMAI\0"
    "7AQIQDE\0"
    "8EQ~HQHO~HLEL~ILII~IEEE~AEAI~ALEL~BLBO~BQEQ\0"
    "9CE~IGIM~IQEQ~AQAM~AIEI~IIIM\0:BLBM BEBF\0;BLBM BFAC\0<GOAKGG\0=AMIM AIII\0>AOGKAG\0\?AN~AQDQ~GQGN~GLDJDI DEDF\0"
    "@HK~HMFM~DMDK~DIFI~HIHM HK~HIJI~KIKK~KQGQ~AQAJ~AEGE~IEJF\0AAEEQIE BIHI\0BAQEQ~HQHO~HLELAL EL~ILII~IEEEAEAQ\0"
    "CIN~HQEQ~AQAK~AEEE~HEIH\0DAEAQDQ~IQIK~IEDEAE\0EHQAQAEHE ALFL\0FHQAQAE ALFL\0GIN~HQEQ~AQAK~AEEE~IEIIIKFK\0"
    "HAQAE IQIE AKIK\0IBQBE\0JGQGH~GEDE~AEAH\0KAQAE IQAJ DMIE\0LAQAEHE\0MAEAQFGKQKE\0NAEAQIEIQ\0"
    "OFQ~KQKK~KEFE~AEAK~AQFQ\0PAEAQEQ~IQIN~IKEKAK\0QFQ~KQKK~KEFE~AEAK~AQFQ GHKD\0RAEAQEQ~IQIN~IKEKAK EKIE\0"
    "SIN~IQEQ~AQAN~ALEK~IJIH~IEEE~AEAH\0TAQIQ EQEE\0UAQAI~AEEE~IEIIIQ\0VAQEEIQ\0WAQDEGOJEMQ\0XAQIE IQAE\0"
    "YAQEKIQ EKEE\0ZAQIQAEIE\0[CQAQACCC\0\\AQGC\0]AQCQCCAC\0^ANDQGN\0_ADID\0`BQDO\0aGMGE GI~GMDM~AMAI~AEDE~GEGI\0"
    "bAQAE AI~AMDM~GMGI~GEDE~AEAI\0cGK~FMDM~AMAI~AEDE~FEGG\0dGQGE GI~GMDM~AMAI~AEDE~GEGI\0eAIGI~GMDM~AMAI~AEDE~FEGG\0"
    "fEQ~BQBNBE AMEM\0gGMGD~GADA~BAAB GI~GMDM~AMAI~AEDE~GEGI\0hAQAE AI~AMDM~GMGJGE\0iBMBE BPBQ\0jCMCD~CAAA CPCQ\0"
    "kAQAE GMAH CJGE\0lBQBE\0mAMAE AI~AMDM~FMFJFE FI~FMHM~KMKJKE\0nAMAE AI~AMDM~GMGJGE\0oDM~GMGI~GEDE~AEAI~AMDM\0"
    "pAMAA AI~AMDM~GMGI~GEDE~AEAI\0qGMGA GI~GMDM~AMAI~AEDE~GEGI\0rAMAE AI~AMEM\0sGL~FMDM~AMAK~AIDI~GIGG~GEDE~AEAF\0"
    "tBQBH~BEEE AMEM\0uAMAH~AEDE~GEGI GMGE\0vAMDEGM\0wAMCEEKGEIM\0xAMGE GMAE\0yAMDE GMCC~BAAA\0zAMGMAEGE\0"
    "{DQ~BQBO~BKAK~BKBG~BDDD\0|BQBC\0}AQ~CQCO~CKDK~CKCG~CDAD\0~AJ~CLEJ~GHIJ\0";

static const struct {
  unsigned code;
  const char *strokes;
} signs[] = {{0xa8, "BPBQ EPEQ"},
             {0xb0, "CQ~EQEO~EMCM~AMAO~AQCQ"},
             {0xb2, "AO~AQCQ~EQEO~ENAKEK"},
             {0xb3, "AQEQCO~EOEM~EKCK~AKAL"},
             {0xb4, "DQBO"},
             {0xb7, "BJBK"},
             {0xb8, "DE~EBBB"},
             {0xd7, "ALGF GLAF"},
             {0xdf, "AEAN~AQDQ~GQGN~GLDL~HLHI~HEDE"},
             {0x2da, "DQ~EQEP~EODO~COCP~CQDQ"},
             {0x2013, "AJKJ"},
             {0x2019, "BQBN"}};

const char *cli_glyph_strokes(unsigned code) {
  for (const char *at = letters; *at; at += strlen(at) + 1)
    if ((unsigned)*at == code)
      return at + 1;
  for (size_t i = 0; i < sizeof signs / sizeof *signs; i++)
    if (signs[i].code == code)
      return signs[i].strokes;
  return NULL;
}

/* From U+00C0 on: the letters, and their marks. */
static const char bases[] = "AAAAAA\0CEEEEIIII\0NOOOOO\0\0UUUUY\0\0aaaaaa\0ceeeeiiii\0nooooo\0\0uuuuy\0y";
static const char marks[] = "`'^~:o ,`'^:`'^: ~`'^~:  `'^:'  `'^~:o ,`'^:`'^: ~`'^~:  `'^:' :";

unsigned cli_glyph_part(unsigned code, unsigned *mark) {
  static const char order[] = "`'^~:o,";
  static const unsigned codes[] = {'`', 0xb4, '^', '~', 0xa8, 0x2da, 0xb8};
  *mark = 0;
  if (code < 0xc0 || code > 0xff || !bases[code - 0xc0])
    return code;
  for (size_t i = 0; order[i]; i++)
    if (order[i] == marks[code - 0xc0])
      *mark = codes[i];
  return (unsigned char)bases[code - 0xc0];
}
