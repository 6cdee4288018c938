/* The values that a file's points have by name besides what splats hold, and the one of them that is wanted. */
#pragma once

#include "core/splats/builder.h"

/* Whether both names mean the same: upper and lower case, blanks, "_" and "-" do not matter, nor does "scalar_" before
 * it; "reflectance" is the intensity, "class" and "label" are the classification. */
int conic_field_is(const char *name, const char *other);

/* Whether splats have this of themselves: places, axes, colours and the like, by their usual names. */
int conic_field_is_of_splats(const char *name);

/* Adds a field to the model's list; `type` is static. Errors: MEMORY. */
conic_status conic_fields_add(conic_builder *builder, const char *name, size_t length, const char *type);

/* Which of the listed fields the options ask for: the reader is to fill their columns (core/splats/builder.h). Errors:
 * ARGUMENT (`where` makes no sense), INPUT (a field is not there), MEMORY. */
conic_status conic_fields_choose(conic_builder *builder, const char *file, const conic_read_options *options);

/* Of a file whose reader lists none: refuses wanted fields; and points chosen of one with faces. Errors: INPUT. */
conic_status conic_fields_check(conic_context *context, const char *file, const conic_read_options *options,
                                const conic_model *model);
