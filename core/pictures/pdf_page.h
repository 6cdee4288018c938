/* A PDF 1.4 file of one page: pictures that are written row by row, and then strokes over them. */
#pragma once

#include "core/base/base.h"

enum { CONIC_PDF_MOST_PICTURES = 256 };

typedef struct conic_pdf conic_pdf;

/* Starts a file that appears under its name when it is whole; sizes are in points, 1/72 inch. On success the caller
 * owns *pdf and ends it with conic_pdf_end. Errors: MEMORY, IO. */
conic_status conic_pdf_open(conic_context *context, const char *path, const double size_pt[2], conic_pdf **pdf);

/* Begins a picture of so many pixels, of which rows of R, G and B follow, a byte each, from the top; then ends it.
 * Errors: ARGUMENT (too many of them), MEMORY. */
conic_status conic_pdf_picture(conic_pdf *pdf, int width, int height);
void conic_pdf_rows(conic_pdf *pdf, const unsigned char *rgb, size_t n_bytes);
void conic_pdf_picture_end(conic_pdf *pdf);

/* Adds to what is on the page, once all pictures are there: operators of PDF, as printf. Picture i, from 0, is /Pi. */
void conic_pdf_print(conic_pdf *pdf, const char *format, ...) CONIC_AS_PRINTF(2, 3);

/* Completes the file, or drops it if the status is not OK. Releases it, which may be null; returns the status. Errors:
 * IO. */
conic_status conic_pdf_end(conic_pdf *pdf, conic_status status);
