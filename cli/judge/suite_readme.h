/* The README.md of a suite. */
#ifndef CONIC_SUITE_README_H
#define CONIC_SUITE_README_H

extern const char cli_suite_readme[];

#endif
