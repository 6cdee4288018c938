/* OpenCL C has size_t, ptrdiff_t and NULL of itself. */
