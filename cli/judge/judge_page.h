/* A page of HTML in one file: text that is escaped, and pictures inside as PNG. */
#ifndef CONIC_JUDGE_PAGE_H
#define CONIC_JUDGE_PAGE_H

#include "cli/session.h"

typedef struct cli_page {
  cli_session *session;
  FILE *to;
} cli_page;

/* Text with what HTML takes for its own in words. */
void cli_page_text(const cli_page *page, const char *text);

/* <figure> of an rgba image, as it is sRGB-encoded, so many pixels of the screen across; small ones a whole number of
 * times as large as they are. */
conic_status cli_page_picture(const cli_page *page, const conic_image *image, int screen_px, const char *caption);

#endif
