// The bridge to OpenImageIO, the one C++ file.
