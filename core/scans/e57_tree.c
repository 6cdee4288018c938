#include "core/scans/e57_file.h"

int conic_e57_column_find(const conic_e57_scan *scan, const char *name) {
  for (size_t i = 0; i < scan->n_columns; i++)
    if (strcmp(scan->columns[i].name, name) == 0)
      return (int)i;
  return -1;
}

void conic_e57_tree_release(conic_context *context, conic_e57_tree *tree) {
  conic_memory_release_these(context, tree->scans, tree->columns);
  memset(tree, 0, sizeof *tree);
}

#if CONIC_HAVE_XML

#include <libxml/parser.h>
#include <libxml/tree.h>

#include "core/files/number.h"

/* The XML does not hold the points: a longer one is no description of scans. */
static const uint64_t most_xml_bytes = 64 << 20;

typedef struct tree_reader {
  conic_e57_file *file;
  conic_e57_tree *tree;
  size_t scan_room, column_room;
} tree_reader;

static conic_status wrong_tree(const tree_reader *reader, const char *what) {
  return conic_fail(reader->file->context, CONIC_ERROR_INPUT, "%s: the XML: %s (at byte %llu)", reader->file->name,
                    what, (unsigned long long)reader->file->xml_offset);
}

static int is_element(const xmlNode *node, const char *name) {
  return node->type == XML_ELEMENT_NODE && (!name || strcmp((const char *)node->name, name) == 0);
}

static xmlNode *child_of(const xmlNode *node, const char *name) {
  for (xmlNode *child = node ? node->children : NULL; child; child = child->next)
    if (is_element(child, name))
      return child;
  return NULL;
}

static const char *attribute_of(const xmlNode *node, const char *name) {
  for (const xmlAttr *attribute = node->properties; attribute; attribute = attribute->next)
    if (strcmp((const char *)attribute->name, name) == 0 && attribute->children && attribute->children->content)
      return (const char *)attribute->children->content;
  return NULL;
}

/* The number in a text, which may have blanks around it; `absent` where there is none. */
static double number_in(const char *text, double absent) {
  double value = absent;
  while (text && *text && strchr(" \t\r\n", *text))
    text++;
  return text && conic_number_parse(text, strlen(text), &value) > 0 ? value : absent;
}

/* An element without content is 0. */
static double number_in_child(const xmlNode *parent, const char *name, double absent) {
  const xmlNode *node = child_of(parent, name);
  if (!node)
    return absent;
  return node->children && node->children->content ? number_in((const char *)node->children->content, 0.0) : 0.0;
}

/* A whole number of 64 bits, which a double may not hold; 0 where it is none. */
static int take_integer(const char *text, int64_t *value) {
  uint64_t sum = 0, most = (uint64_t)INT64_MAX;
  int is_negative = *text == '-';
  text += is_negative || *text == '+';
  if (!*text)
    return 0;
  for (; *text; text++) {
    if (*text < '0' || *text > '9' || sum > (most - (uint64_t)(*text - '0')) / 10) {
      if (is_negative && strcmp(text, "8") == 0 && sum == most / 10) { /* the least number */
        *value = INT64_MIN;
        return 1;
      }
      return 0;
    }
    sum = 10 * sum + (uint64_t)(*text - '0');
  }
  *value = is_negative ? -(int64_t)sum : (int64_t)sum;
  return 1;
}

static unsigned bits_for_range(uint64_t range) {
  unsigned bits = 0;
  while (bits < 64 && range >> bits)
    bits++;
  return bits;
}

static conic_status take_column(const tree_reader *reader, const xmlNode *node, conic_e57_column *column) {
  const char *type = attribute_of(node, "type"), *precision = attribute_of(node, "precision");
  const char *low = attribute_of(node, "minimum"), *high = attribute_of(node, "maximum");
  size_t length = strlen((const char *)node->name);
  memset(column, 0, sizeof *column);
  memcpy(column->name, node->name, length < CONIC_E57_NAME_ROOM ? length : CONIC_E57_NAME_ROOM - 1);
  if (type && strcmp(type, "Float") == 0) {
    int is_single = precision && strcmp(precision, "single") == 0;
    column->type = is_single ? CONIC_E57_SINGLE : CONIC_E57_DOUBLE;
    column->bits = is_single ? 32 : 64;
    return CONIC_OK;
  }
  int is_scaled = type && strcmp(type, "ScaledInteger") == 0;
  if (!is_scaled && !(type && strcmp(type, "Integer") == 0))
    return wrong_tree(reader, "a value of the points is no number");
  column->type = is_scaled ? CONIC_E57_SCALED : CONIC_E57_INTEGER;
  column->low = INT64_MIN;
  column->high = INT64_MAX;
  if ((low && !take_integer(low, &column->low)) || (high && !take_integer(high, &column->high)) ||
      column->high < column->low)
    return wrong_tree(reader, "the limits of a value of the points are none");
  column->bits = bits_for_range((uint64_t)column->high - (uint64_t)column->low);
  column->scale = is_scaled ? number_in(attribute_of(node, "scale"), 1.0) : 1.0;
  column->offset = is_scaled ? number_in(attribute_of(node, "offset"), 0.0) : 0.0;
  if (!conic_is_finite(column->scale) || !conic_is_finite(column->offset))
    return wrong_tree(reader, "the scale of a value of the points is none");
  return CONIC_OK;
}

static conic_status add_column(tree_reader *reader, const xmlNode *node, conic_e57_scan *scan) {
  conic_e57_tree *tree = reader->tree;
  if (scan->n_columns == CONIC_E57_MOST_COLUMNS)
    return wrong_tree(reader, "a scan has more values a point than are read");
  conic_status status = conic_memory_reserve(reader->file->context, &tree->columns, tree->n_columns,
                                             tree->n_columns + 1, &reader->column_room, sizeof *tree->columns);
  if (status == CONIC_OK)
    status = take_column(reader, node, &tree->columns[tree->n_columns]);
  if (status == CONIC_OK) {
    tree->n_columns++;
    scan->n_columns++;
  }
  return status;
}

static conic_status take_points_element(tree_reader *reader, const xmlNode *points, conic_e57_scan *scan) {
  const char *offset = attribute_of(points, "fileOffset"), *count = attribute_of(points, "recordCount");
  int64_t at = 0, n = 0;
  conic_status status = CONIC_OK;
  if (!offset || !count || !take_integer(offset, &at) || !take_integer(count, &n) || at <= 0 || n < 0)
    return wrong_tree(reader, "it does not say where the points of a scan are, or how many");
  if (child_of(child_of(points, "codecs"), NULL))
    return wrong_tree(reader, "the points are coded in another way than bitPackCodec, which is the only one there is");
  scan->records_offset = (uint64_t)at;
  scan->n_records = (uint64_t)n;
  const xmlNode *prototype = child_of(points, "prototype");
  for (const xmlNode *node = prototype ? prototype->children : NULL; node && status == CONIC_OK; node = node->next)
    if (is_element(node, NULL))
      status = add_column(reader, node, scan);
  return status;
}

static conic_status take_station(const tree_reader *reader, const xmlNode *pose, conic_e57_scan *scan) {
  static const char *const names[] = {"w", "x", "y", "z"};
  const xmlNode *rotation = child_of(pose, "rotation"), *translation = child_of(pose, "translation");
  double length2 = 0.0;
  for (int i = 0; i < 4; i++) {
    scan->rotation[i] = number_in_child(rotation, names[i], i == 0 ? 1.0 : 0.0);
    length2 += scan->rotation[i] * scan->rotation[i];
  }
  for (int axis = 0; axis < 3; axis++) {
    scan->translation[axis] = number_in_child(translation, names[axis + 1], 0.0);
    if (!conic_is_finite(scan->translation[axis]))
      return wrong_tree(reader, "a scanner stands nowhere");
  }
  if (!(length2 > 0.0) || !conic_is_finite(length2))
    return wrong_tree(reader, "a scan's rotation is none");
  for (int i = 0; i < 4; i++)
    scan->rotation[i] /= sqrt(length2);
  scan->has_pose = pose != NULL;
  return CONIC_OK;
}

static void take_limits(const xmlNode *limits, const char *low, const char *high, conic_e57_limits *to) {
  to->is_there = limits != NULL;
  to->low = number_in_child(limits, low, 0.0);
  to->high = number_in_child(limits, high, 0.0);
}

static conic_status take_scan(tree_reader *reader, const xmlNode *node) {
  conic_e57_tree *tree = reader->tree;
  conic_e57_scan *scan =
      conic_memory_add(reader->file->context, &tree->scans, &tree->n_scans, &reader->scan_room, sizeof *scan);
  if (!scan)
    return CONIC_ERROR_MEMORY;
  scan->first_column = tree->n_columns;
  take_limits(child_of(node, "colorLimits"), "colorRedMinimum", "colorRedMaximum", &scan->color);
  conic_status status = take_station(reader, child_of(node, "pose"), scan);
  const xmlNode *points = child_of(node, "points");
  return status == CONIC_OK && points ? take_points_element(reader, points, scan) : status;
}

static conic_status take_tree(tree_reader *reader, const xmlDoc *document) {
  const xmlNode *root = xmlDocGetRootElement(document);
  const xmlNode *scans = child_of(root, "data3D");
  conic_status status = CONIC_OK;
  if (!root || !is_element(root, "e57Root"))
    return wrong_tree(reader, "it does not describe scans");
  for (const xmlNode *node = scans ? scans->children : NULL; node && status == CONIC_OK; node = node->next)
    if (is_element(node, "vectorChild"))
      status = take_scan(reader, node);
  for (size_t i = 0; reader->tree->columns && i < reader->tree->n_scans; i++)
    reader->tree->scans[i].columns = reader->tree->columns + reader->tree->scans[i].first_column;
  return status;
}

/* Loads nothing from outside of the file, and expands no entity. */
static conic_status parse_xml(tree_reader *reader, const char *xml, size_t n_bytes) {
  xmlInitParser();
  xmlDoc *document =
      xmlReadMemory(xml, (int)n_bytes, NULL, NULL, XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING);
  if (!document)
    return wrong_tree(reader, "it is damaged");
  conic_status status = take_tree(reader, document);
  xmlFreeDoc(document);
  return status;
}

conic_status conic_e57_tree_read(conic_e57_file *file, conic_e57_tree *tree) {
  tree_reader reader = {.file = file, .tree = tree};
  uint64_t offset = file->xml_offset;
  memset(tree, 0, sizeof *tree);
  if (file->xml_bytes == 0 || file->xml_bytes > most_xml_bytes)
    return wrong_tree(&reader, "it is empty, or too long");
  char *xml = conic_memory_allocate(file->context, (size_t)file->xml_bytes, 1);
  conic_status status = xml ? conic_e57_file_take(file, &offset, xml, (size_t)file->xml_bytes) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = parse_xml(&reader, xml, (size_t)file->xml_bytes);
  conic_memory_release(file->context, xml);
  if (status != CONIC_OK)
    conic_e57_tree_release(file->context, tree);
  return status;
}

#else

conic_status conic_e57_tree_read(conic_e57_file *file, conic_e57_tree *tree) {
  memset(tree, 0, sizeof *tree);
  return conic_fail(file->context, CONIC_ERROR_UNSUPPORTED, "%s: this build is without libxml2, which reads E57",
                    file->name);
}

#endif
