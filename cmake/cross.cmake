# A toolchain file for Linux on another processor, by Debian's cross-compilers and qemu:
#   cmake --toolchain cmake/cross.cmake -DCONIC_PROCESSOR=s390x …
# CONIC_LIBRARIES is a folder in which packages for that processor have been unpacked (dpkg -x), if any: what the build
# finds there is used.
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CONIC_PROCESSOR CONIC_LIBRARIES)
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR ${CONIC_PROCESSOR})
set(CMAKE_LIBRARY_ARCHITECTURE ${CONIC_PROCESSOR}-linux-gnu)
set(CMAKE_C_COMPILER ${CMAKE_LIBRARY_ARCHITECTURE}-gcc)
set(CMAKE_FIND_ROOT_PATH /usr/${CMAKE_LIBRARY_ARCHITECTURE} ${CONIC_LIBRARIES})
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CONIC_WITH_OPENIMAGEIO OFF CACHE BOOL "is of C++, for which there is no cross-compiler")
find_program(CONIC_EMULATOR NAMES qemu-${CONIC_PROCESSOR} qemu-${CONIC_PROCESSOR}-static)
if(CONIC_EMULATOR)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${CONIC_EMULATOR} -L /usr/${CMAKE_LIBRARY_ARCHITECTURE})
endif()
if(CONIC_LIBRARIES) # what these need themselves is looked for neither by the linker nor where it runs, unless one says
  set(conic_library_folders
    ${CONIC_LIBRARIES}/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}:${CONIC_LIBRARIES}/lib/${CMAKE_LIBRARY_ARCHITECTURE})
  foreach(kind EXE SHARED)
    set(CMAKE_${kind}_LINKER_FLAGS_INIT -Wl,-rpath-link,${conic_library_folders})
  endforeach()
  if(CONIC_EMULATOR)
    list(APPEND CMAKE_CROSSCOMPILING_EMULATOR -E LD_LIBRARY_PATH=${conic_library_folders})
  endif()
endif()
