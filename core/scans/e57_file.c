#include "core/scans/e57_file.h"

#include "core/base/byte_order.h"

enum { HEADER_BYTES = 48, SUM_BYTES = 4, LEAST_PAGE = 64, MOST_PAGE = 1 << 20 };

static const uint64_t most_piped_bytes = (UINT64_C(1) << 31) - 1;

conic_status conic_e57_wrong(const conic_e57_file *file, const char *what, uint64_t at) {
  return conic_fail(file->context, CONIC_ERROR_INPUT, "%s: %s (at byte %llu)", file->name, what,
                    (unsigned long long)at);
}

/* CRC-32C, as iSCSI has it. */
static uint32_t page_sum(const unsigned char *bytes, uint64_t n) {
  static const uint32_t nibbles[16] = {0x00000000, 0x105EC76F, 0x20BD8EDE, 0x30E349B1, 0x417B1DBC, 0x5125DAD3,
                                       0x61C69362, 0x7198540D, 0x82F63B78, 0x92A8FC17, 0xA24BB5A6, 0xB21572C9,
                                       0xC38D26C4, 0xD3D3E1AB, 0xE330A81A, 0xF36E6F75};
  uint32_t sum = 0xFFFFFFFFu;
  for (uint64_t i = 0; i < n; i++) {
    sum ^= bytes[i];
    sum = sum >> 4 ^ nibbles[sum & 15u];
    sum = sum >> 4 ^ nibbles[sum & 15u];
  }
  return ~sum;
}

/* A page's sum has the other byte order than the rest of the file. */
static conic_status check_page(conic_e57_file *file, uint64_t page) {
  const unsigned char *bytes = file->mapping.bytes + page * file->page_bytes,
                      *sum = bytes + file->page_bytes - SUM_BYTES;
  uint32_t stated = (uint32_t)sum[0] << 24 | (uint32_t)sum[1] << 16 | (uint32_t)sum[2] << 8 | sum[3];
  if (page == file->sound_page)
    return CONIC_OK;
  if (page_sum(bytes, file->page_bytes - SUM_BYTES) != stated)
    return conic_e57_wrong(file, "a page's checksum is wrong: the file is damaged", page * file->page_bytes);
  file->sound_page = page;
  return CONIC_OK;
}

/* How many bytes of the page's content follow an offset; 0 where that is in a sum or past the end. */
static uint64_t content_after(const conic_e57_file *file, uint64_t offset) {
  uint64_t in_page = offset % file->page_bytes, end = file->page_bytes - SUM_BYTES;
  return offset < file->mapping.n_bytes && in_page < end ? end - in_page : 0;
}

static void advance(const conic_e57_file *file, uint64_t *offset, uint64_t n) {
  *offset += n;
  if (*offset % file->page_bytes == file->page_bytes - SUM_BYTES)
    *offset += SUM_BYTES;
}

conic_status conic_e57_file_take(conic_e57_file *file, uint64_t *offset, void *to, size_t n) {
  while (n > 0) {
    uint64_t step = content_after(file, *offset);
    if (step == 0)
      return conic_e57_wrong(file, "the file ends, or a page does, where more should follow", *offset);
    conic_status status = check_page(file, *offset / file->page_bytes);
    if (status != CONIC_OK)
      return status;
    step = step < n ? step : n;
    memcpy(to, file->mapping.bytes + *offset, (size_t)step);
    advance(file, offset, step);
    to = (unsigned char *)to + step;
    n -= (size_t)step;
  }
  return CONIC_OK;
}

conic_status conic_e57_file_skip(conic_e57_file *file, uint64_t *offset, uint64_t n) {
  while (n > 0) {
    uint64_t step = content_after(file, *offset);
    if (step == 0)
      return conic_e57_wrong(file, "the file ends, or a page does, where more should follow", *offset);
    step = step < n ? step : n;
    advance(file, offset, step);
    n -= step;
  }
  return CONIC_OK;
}

static conic_status read_e57_header(conic_e57_file *file) {
  const unsigned char *header = file->mapping.bytes;
  if (file->mapping.n_bytes < HEADER_BYTES)
    return conic_e57_wrong(file, "the file ends within the header", file->mapping.n_bytes);
  if (conic_load_bits(header + 8, 4) != 1)
    return conic_fail(file->context, CONIC_ERROR_INPUT, "%s: version %u of E57; version 1 is read (at byte 8)",
                      file->name, (unsigned)conic_load_bits(header + 8, 4));
  file->xml_offset = conic_load_bits(header + 24, 8);
  file->xml_bytes = conic_load_bits(header + 32, 8);
  file->page_bytes = conic_load_bits(header + 40, 8);
  if (file->page_bytes < LEAST_PAGE || file->page_bytes > MOST_PAGE)
    return conic_e57_wrong(file, "the size of a page is none", 40);
  if (conic_load_bits(header + 16, 8) != file->mapping.n_bytes || file->mapping.n_bytes % file->page_bytes != 0)
    return conic_e57_wrong(file, "the file is not as long as its header says: a part of it is missing", 16);
  if (file->xml_offset >= file->mapping.n_bytes || file->xml_bytes > file->mapping.n_bytes - file->xml_offset)
    return conic_e57_wrong(file, "the XML begins or ends past the end of the file", 24);
  return CONIC_OK;
}

conic_status conic_e57_file_open(conic_input *input, conic_e57_file *file) {
  memset(file, 0, sizeof *file);
  file->context = input->context;
  file->name = input->name;
  file->sound_page = UINT64_MAX;
  conic_status status = conic_mapping_take(input, most_piped_bytes, &file->mapping);
  if (status == CONIC_OK)
    status = read_e57_header(file);
  if (status != CONIC_OK)
    conic_e57_file_close(file);
  return status;
}

void conic_e57_file_close(conic_e57_file *file) {
  conic_mapping_close(file->context, &file->mapping);
}

void conic_e57_mend(unsigned char *bytes, size_t n_bytes) {
  uint64_t page_bytes = n_bytes >= HEADER_BYTES ? conic_load_bits(bytes + 40, 8) : 0;
  if (page_bytes < LEAST_PAGE || page_bytes > MOST_PAGE)
    return;
  for (; n_bytes >= page_bytes; bytes += page_bytes, n_bytes -= (size_t)page_bytes) {
    uint32_t sum = page_sum(bytes, page_bytes - SUM_BYTES);
    for (int i = 0; i < SUM_BYTES; i++)
      bytes[page_bytes - SUM_BYTES + (uint64_t)i] = (unsigned char)(sum >> (24 - 8 * i));
  }
}
