/* A page of HTML in one file, with escaped text, and pictures inside as PNG. */
#pragma once

#include "cli/session.h"

typedef struct cli_page {
  cli_session *session;
  FILE *to;
} cli_page;

/* Text with HTML's special characters escaped. */
void cli_page_text(const cli_page *page, const char *text);

/* A <figure> of an rgba image, sRGB-encoded, so many screen pixels wide; small images are enlarged by a whole
 * number. */
conic_status cli_page_picture(const cli_page *page, const conic_image *image, int screen_px, const char *caption);
