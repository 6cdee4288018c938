/* The smallest manifest of a suite. */
#pragma once

#define SUITE_EXAMPLE_SUM "00112233445566778899aabbccddeeff00112233445566778899aabbccddeeff"
#define SUITE_EXAMPLE                                                                                                  \
  "{\"format\": \"conic-conformance\", \"version\": 1, \"conic\": \"1\",\n\"floats\": {\"name\": \"fast\", \"x\": "    \
  "[1]},\n\"scenes\": [{\"name\": \"a\", \"files\": {\"ply\": \"s/a.ply\", \"spz\": \"s/a.spz\"},\n\"camera\": "       \
  "{\"conic\": \"c/a.json\"}, \"width\": 36, \"height\": 20}],\n\"cases\": [{\"name\": \"L1-a-p\", \"level\": 1, "     \
  "\"scene\": \"a\", \"profile\": \"p\", \"npy\": \"e/a.npy\"}],\n\"files\": [{\"path\": \"e/a.npy\", \"bytes\": 5, "  \
  "\"sha256\": \"" SUITE_EXAMPLE_SUM "\"}]}\n"
