#include "core/pictures/pdf_page.h"

#include <stdarg.h>

#include "core/files/file.h"

#if CONIC_HAVE_ZLIB
#include <zlib.h>
#define FILTER " /Filter /FlateDecode"
enum { ZIP_LEVEL = 4, PACKED_BYTES = 1 << 16 };
#else
#define FILTER ""
#endif

/* Numbers of objects. Each picture has two: itself, and the length of its stream. */
enum { CATALOG = 1, PAGES, PAGE, CONTENTS, CONTENTS_LENGTH, FIRST_PICTURE };
enum { MOST_OBJECTS = FIRST_PICTURE + 2 * CONIC_PDF_MOST_PICTURES };

struct conic_pdf {
  conic_context *context;
  const char *path;
  conic_output *output;
  double size_pt[2];
  uint64_t at, places[MOST_OBJECTS]; /* bytes written; where objects begin */
  uint64_t stream_at;
  int n_pictures, has_contents;
#if CONIC_HAVE_ZLIB
  z_stream packer;
  unsigned char packed[PACKED_BYTES];
#endif
};

static void put_pdf_bytes(conic_pdf *pdf, const void *bytes, size_t n_bytes) {
  if (n_bytes)
    fwrite(bytes, 1, n_bytes, conic_output_stream(pdf->output)); /* the stream reports failures at the end */
  pdf->at += n_bytes;
}

static CONIC_AS_PRINTF(2, 3) void put_pdf(conic_pdf *pdf, const char *format, ...) {
  char line[512];
  va_list list;
  va_start(list, format);
  int n = vsnprintf(line, sizeof line, format, list);
  va_end(list);
  put_pdf_bytes(pdf, line, n > 0 && n < (int)sizeof line ? (size_t)n : 0);
}

static void begin_object(conic_pdf *pdf, int number) {
  pdf->places[number] = pdf->at;
  put_pdf(pdf, "%d 0 obj\n", number);
}

static void begin_stream(conic_pdf *pdf) {
  put_pdf(pdf, ">>\nstream\n");
  pdf->stream_at = pdf->at;
}

static void end_stream(conic_pdf *pdf, int length_number) {
  uint64_t n_bytes = pdf->at - pdf->stream_at;
  put_pdf(pdf, "\nendstream\nendobj\n");
  begin_object(pdf, length_number);
  put_pdf(pdf, "%llu\nendobj\n", (unsigned long long)n_bytes);
}

conic_status conic_pdf_open(conic_context *context, const char *path, const double size_pt[2], conic_pdf **pdf) {
  conic_pdf *p = *pdf = conic_memory_allocate_zeroed(context, 1, sizeof *p);
  if (!p)
    return CONIC_ERROR_MEMORY;
  p->context = context;
  p->path = path;
  memcpy(p->size_pt, size_pt, sizeof p->size_pt);
  conic_status status = conic_output_open(context, path, &p->output);
  if (status == CONIC_OK) {
    put_pdf(p, "%%PDF-1.4\n%%\xe2\xe3\xcf\xd3\n"); /* letters beyond ASCII say that it is no text */
    return CONIC_OK;
  }
  *pdf = NULL;
  conic_memory_release(context, p);
  return status;
}

conic_status conic_pdf_picture(conic_pdf *pdf, int width, int height) {
  if (pdf->n_pictures == CONIC_PDF_MOST_PICTURES)
    return conic_fail(pdf->context, CONIC_ERROR_ARGUMENT, "%s: too many pictures for one page", pdf->path);
  int number = FIRST_PICTURE + 2 * pdf->n_pictures;
  begin_object(pdf, number);
  put_pdf(pdf,
          "<< /Type /XObject /Subtype /Image /Width %d /Height %d /ColorSpace /DeviceRGB /BitsPerComponent 8 "
          "/Length %d 0 R" FILTER " ",
          width, height, number + 1);
  begin_stream(pdf);
#if CONIC_HAVE_ZLIB
  memset(&pdf->packer, 0, sizeof pdf->packer);
  if (deflateInit(&pdf->packer, ZIP_LEVEL) != Z_OK)
    return conic_fail(pdf->context, CONIC_ERROR_MEMORY, "%s: cannot write: out of memory", pdf->path);
#endif
  pdf->n_pictures++;
  return CONIC_OK;
}

/* The picture's end are no bytes. */
void conic_pdf_rows(conic_pdf *pdf, const unsigned char *rgb, size_t n_bytes) {
#if CONIC_HAVE_ZLIB
  pdf->packer.next_in = (z_const Bytef *)rgb;
  pdf->packer.avail_in = (uInt)n_bytes;
  do {
    pdf->packer.next_out = pdf->packed;
    pdf->packer.avail_out = PACKED_BYTES;
    deflate(&pdf->packer, n_bytes ? Z_NO_FLUSH : Z_FINISH);
    put_pdf_bytes(pdf, pdf->packed, PACKED_BYTES - pdf->packer.avail_out);
  } while (pdf->packer.avail_out == 0);
#else
  put_pdf_bytes(pdf, rgb, n_bytes);
#endif
}

void conic_pdf_picture_end(conic_pdf *pdf) {
  conic_pdf_rows(pdf, NULL, 0);
#if CONIC_HAVE_ZLIB
  deflateEnd(&pdf->packer);
#endif
  end_stream(pdf, FIRST_PICTURE + 2 * pdf->n_pictures - 1);
}

static void begin_contents(conic_pdf *pdf) {
  pdf->has_contents = 1;
  begin_object(pdf, CONTENTS);
  put_pdf(pdf, "<< /Length %d 0 R ", CONTENTS_LENGTH);
  begin_stream(pdf);
}

void conic_pdf_print(conic_pdf *pdf, const char *format, ...) {
  char line[512];
  va_list list;
  if (!pdf->has_contents)
    begin_contents(pdf);
  va_start(list, format);
  int n = vsnprintf(line, sizeof line, format, list);
  va_end(list);
  put_pdf_bytes(pdf, line, n > 0 && n < (int)sizeof line ? (size_t)n : 0);
}

static void put_structure(conic_pdf *pdf) {
  int n = FIRST_PICTURE + 2 * pdf->n_pictures;
  if (!pdf->has_contents)
    begin_contents(pdf);
  end_stream(pdf, CONTENTS_LENGTH);
  begin_object(pdf, CATALOG);
  put_pdf(pdf, "<< /Type /Catalog /Pages %d 0 R >>\nendobj\n", PAGES);
  begin_object(pdf, PAGES);
  put_pdf(pdf, "<< /Type /Pages /Kids [%d 0 R] /Count 1 >>\nendobj\n", PAGE);
  begin_object(pdf, PAGE);
  put_pdf(pdf, "<< /Type /Page /Parent %d 0 R /MediaBox [0 0 %.4f %.4f] /Contents %d 0 R /Resources << /XObject <<",
          PAGES, pdf->size_pt[0], pdf->size_pt[1], CONTENTS);
  for (int i = 0; i < pdf->n_pictures; i++)
    put_pdf(pdf, " /P%d %d 0 R", i, FIRST_PICTURE + 2 * i);
  put_pdf(pdf, " >> >> >>\nendobj\n");
  uint64_t table_at = pdf->at;
  put_pdf(pdf, "xref\n0 %d\n0000000000 65535 f \n", n);
  for (int i = 1; i < n; i++)
    put_pdf(pdf, "%010llu 00000 n \n", (unsigned long long)pdf->places[i]);
  put_pdf(pdf, "trailer\n<< /Size %d /Root %d 0 R >>\nstartxref\n%llu\n%%%%EOF\n", n, CATALOG,
          (unsigned long long)table_at);
}

conic_status conic_pdf_end(conic_pdf *pdf, conic_status status) {
  if (!pdf)
    return status;
  if (status == CONIC_OK)
    put_structure(pdf);
  status = conic_output_end(pdf->output, status);
  conic_memory_release(pdf->context, pdf);
  return status;
}
