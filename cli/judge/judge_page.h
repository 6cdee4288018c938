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

/* <figure> of an rgba image, as it is sRGB-encoded, `zoom` times as large as it is; at most `most_px` of the screen
 * across where that is above 0. */
conic_status cli_page_picture(const cli_page *page, const conic_image *image, int zoom, int most_px,
                              const char *caption);

#endif
