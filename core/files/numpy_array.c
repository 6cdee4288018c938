#include "core/files/numpy_array.h"

#include "core/base/base.h"
#include "core/base/byte_order.h"

typedef struct npy_text {
  const char *text;
  size_t n;
} npy_text;

/* The text after 'key': in the header, without blanks; empty where the key is missing. */
static npy_text find_npy_value(npy_text header, const char *key) {
  size_t n_key = strlen(key);
  for (size_t i = 0; i + n_key <= header.n; i++)
    if (memcmp(header.text + i, key, n_key) == 0) {
      i += n_key;
      while (i < header.n && (header.text[i] == ' ' || header.text[i] == ':'))
        i++;
      return (npy_text){header.text + i, header.n - i};
    }
  return (npy_text){header.text, 0};
}

static int npy_begins(npy_text text, const char *with) {
  size_t n = strlen(with);
  return text.n >= n && memcmp(text.text, with, n) == 0;
}

/* '<f4', '<f8', '|u1' … */
static int take_npy_type(npy_text header, conic_numpy_array *array) {
  npy_text value = find_npy_value(header, "'descr'");
  if (value.n < 5 || value.text[0] != '\'' || value.text[4] != '\'')
    return 0;
  array->type = value.text[2];
  array->n_type_bytes = value.text[3] - '0';
  int n = array->n_type_bytes, is_byte = value.text[1] == '|' && n == 1, is_little = value.text[1] == '<';
  return (is_byte || is_little) &&
         (array->type == 'f' ? n == 2 || n == 4 || n == 8
                             : (array->type == 'i' || array->type == 'u') && (n == 1 || n == 2 || n == 4 || n == 8));
}

/* (), (3,), (3, 4, 4) … */
static int take_npy_shape(npy_text header, conic_numpy_array *array) {
  npy_text value = find_npy_value(header, "'shape'");
  size_t i = 1;
  if (!npy_begins(value, "("))
    return 0;
  while (i < value.n && value.text[i] != ')') {
    size_t n = 0, start = i;
    for (; i < value.n && value.text[i] >= '0' && value.text[i] <= '9' && n < CONIC_MOST_BYTES / 10; i++)
      n = n * 10 + (size_t)(value.text[i] - '0');
    if (i == start || (i < value.n && value.text[i] >= '0' && value.text[i] <= '9') ||
        array->n_axes == CONIC_NUMPY_MOST_AXES)
      return 0;
    array->shape[array->n_axes++] = n;
    while (i < value.n && (value.text[i] == ',' || value.text[i] == ' '))
      i++;
  }
  return i < value.n;
}

conic_status conic_numpy_array_open(conic_context *context, const char *file, const char *name,
                                    const unsigned char *bytes, size_t n_bytes, conic_numpy_array *array) {
  memset(array, 0, sizeof *array);
  int n_length = n_bytes >= 12 && bytes[6] == 1 ? 2 : 4;
  size_t start = 8 + (size_t)n_length;
  if (n_bytes < 12 || memcmp(bytes, "\x93NUMPY", 6) != 0 || bytes[6] < 1 || bytes[6] > 3)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: %s is no NumPy array (at byte 0)", file, name);
  size_t n_header = (size_t)conic_load_bits(bytes + 8, (size_t)n_length);
  if (n_header > n_bytes - start)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: %s ends too early (at byte 0)", file, name);
  npy_text header = {(const char *)bytes + start, n_header};
  if (!take_npy_type(header, array))
    return conic_fail(context, CONIC_ERROR_INPUT,
                      "%s: %s is not of numbers that are read: little-endian floats or whole numbers (at byte 0)", file,
                      name);
  npy_text order = find_npy_value(header, "'fortran_order'");
  array->is_fortran = npy_begins(order, "True");
  if ((!array->is_fortran && !npy_begins(order, "False")) || !take_npy_shape(header, array))
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: %s has no shape that is understood (at byte 0)", file, name);
  double n = array->n_type_bytes;
  for (int axis = 0; axis < array->n_axes; axis++)
    n *= (double)array->shape[axis];
  if (n != (double)(n_bytes - start - n_header))
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: %s is not as long as its shape says (at byte 0)", file, name);
  array->bytes = bytes + start + n_header;
  return CONIC_OK;
}

/* A half float: 5 bits of exponent, 10 of fraction. */
static double double_of_half(uint32_t bits) {
  int exponent = (int)(bits >> 10 & 31);
  double sign = bits & 0x8000u ? -1.0 : 1.0, part = (double)(bits & 1023u);
  if (exponent == 31)
    return (double)conic_float_of_bits((bits & 0x8000u) << 16 | 0x7f800000u | (bits & 1023u) << 13);
  return exponent ? sign * (1024.0 + part) * conic_power_of_two(exponent - 25) : sign * part * 0x1p-24;
}

double conic_numpy_array_at(const conic_numpy_array *array, size_t i) {
  size_t n_bytes = (size_t)array->n_type_bytes, at = i;
  if (array->is_fortran) {
    size_t step = 1, places[CONIC_NUMPY_MOST_AXES];
    for (int axis = array->n_axes; axis-- > 0; i /= array->shape[axis])
      places[axis] = i % array->shape[axis];
    at = 0;
    for (int axis = 0; axis < array->n_axes; step *= array->shape[axis++])
      at += places[axis] * step;
  }
  uint64_t bits = conic_load_bits(array->bytes + at * n_bytes, n_bytes);
  if (array->type == 'f' && n_bytes == 8)
    return conic_double_of_bits(bits);
  if (array->type == 'f')
    return n_bytes == 2 ? double_of_half((uint32_t)bits) : (double)conic_float_of_bits((uint32_t)bits);
  int shift = 64 - 8 * (int)n_bytes;
  return array->type == 'u' ? (double)bits : (double)((int64_t)(bits << shift) >> shift);
}

void conic_numpy_head(const char *type, const size_t *shape, int n_axes, unsigned char head[CONIC_NUMPY_HEAD]) {
  enum { START = 10 };
  char axes[CONIC_NUMPY_MOST_AXES * 22 + 1] = "", text[CONIC_NUMPY_HEAD - START + 1];
  for (int axis = 0, n = 0; axis < n_axes; axis++)
    n += snprintf(axes + n, sizeof axes - (size_t)n, "%zu,%s", shape[axis], axis + 1 < n_axes ? " " : "");
  if (n_axes > 1)
    axes[strlen(axes) - 1] = '\0';
  int n = snprintf(text, sizeof text, "{'descr': '%s', 'fortran_order': False, 'shape': (%s), }", type, axes);
  memset(head, ' ', CONIC_NUMPY_HEAD);
  memcpy(head, "\x93NUMPY\x01\x00", 8);
  conic_store_bits(head + 8, 2, CONIC_NUMPY_HEAD - START);
  memcpy(head + START, text, (size_t)n);
  head[CONIC_NUMPY_HEAD - 1] = '\n';
}
