#if CONIC_HAVE_OPENEXR

#include "core/image/image_exr_attributes.h"

#include <string.h>

static exr_result_t add_attribute(exr_context_t file, const conic_attribute *attribute) {
  exr_attr_m44d_t matrix;
  switch (attribute->type) {
  case CONIC_ATTRIBUTE_TEXT:
    return exr_attr_set_string(file, 0, attribute->name, attribute->text);
  case CONIC_ATTRIBUTE_DOUBLE:
    return exr_attr_set_double(file, 0, attribute->name, attribute->values[0]);
  case CONIC_ATTRIBUTE_MATRIX:
    memcpy(matrix.m, attribute->values, sizeof matrix.m);
    return exr_attr_set_m44d(file, 0, attribute->name, &matrix);
  }
  return EXR_ERR_INVALID_ARGUMENT;
}

/* Names over 31 bytes make a file that old readers refuse, so the flag is set only where one is. */
static int has_long_name(const conic_image *image) {
  for (int i = 0; i < image->n_attributes; i++)
    if (strlen(image->attributes[i].name) > 31)
      return 1;
  return 0;
}

exr_result_t conic_exr_prepare_attributes(exr_context_t file, const conic_image *image) {
  return has_long_name(image) ? exr_set_longname_support(file, 1) : EXR_ERR_SUCCESS;
}

exr_result_t conic_exr_add_attributes(exr_context_t file, const conic_image *image) {
  exr_result_t result = EXR_ERR_SUCCESS;
  for (int i = 0; result == EXR_ERR_SUCCESS && i < image->n_attributes; i++)
    result = add_attribute(file, &image->attributes[i]);
  return result;
}

#else
typedef int conic_exr_attributes_are_not_built;
#endif
