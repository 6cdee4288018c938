# CMake looks for a file of each system's name.
include(Platform/UnixPaths)
set(UNIX 1)
set(WASI 1)
set(CMAKE_EXECUTABLE_SUFFIX .wasm)
