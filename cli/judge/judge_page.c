#include "cli/judge/judge_page.h"

#include "core/files/disk.h"
#include "core/pictures/image_png.h"

void cli_page_text(const cli_page *page, const char *text) {
  for (; *text; text++) {
    if (*text == '&')
      fputs("&amp;", page->to);
    else if (*text == '<')
      fputs("&lt;", page->to);
    else if (*text == '>')
      fputs("&gt;", page->to);
    else if (*text == '"')
      fputs("&quot;", page->to);
    else
      putc(*text, page->to);
  }
}

static void put_base64(FILE *from, FILE *to) {
  static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  unsigned char b[3];
  for (size_t n; (n = fread(b, 1, 3, from)) > 0;) {
    unsigned bits = (unsigned)b[0] << 16 | (n > 1 ? (unsigned)b[1] << 8 : 0u) | (n > 2 ? (unsigned)b[2] : 0u);
    char word[5] = {letters[bits >> 18], letters[bits >> 12 & 63], letters[bits >> 6 & 63], letters[bits & 63], 0};
    for (size_t i = n + 1; i < 4; i++)
      word[i] = '=';
    fputs(word, to);
  }
}

static conic_status put_png(const cli_page *page, const conic_image *image) {
  FILE *between = conic_disk_open_nameless();
  if (!between)
    return conic_fail(page->session->context, CONIC_ERROR_IO, "a temporary file for a picture cannot be written");
  conic_status status = conic_png_write_to(page->session->context, between, image);
  if (status == CONIC_OK && (fflush(between) != 0 || ferror(between)))
    status = conic_fail(page->session->context, CONIC_ERROR_IO, "a temporary file for a picture cannot be written");
  rewind(between);
  if (status == CONIC_OK)
    put_base64(between, page->to);
  fclose(between);
  return status;
}

conic_status cli_page_picture(const cli_page *page, const conic_image *image, int screen_px, const char *caption) {
  int width = image->width < screen_px ? screen_px / image->width * image->width : screen_px;
  fprintf(page->to, "<figure><img width=\"%d\" alt=\"", width);
  cli_page_text(page, caption);
  fputs("\" src=\"data:image/png;base64,", page->to);
  conic_status status = put_png(page, image);
  fputs("\"><figcaption>", page->to);
  cli_page_text(page, caption);
  fputs("</figcaption></figure>\n", page->to);
  return status;
}
