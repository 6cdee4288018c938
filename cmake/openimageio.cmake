# Finds OpenImageIO and drops what its package file names but does not install (Debian 12's names OpenCV's headers),
# which CMake would refuse.
find_package(OpenImageIO CONFIG QUIET)
if(TARGET OpenImageIO::OpenImageIO)
  get_target_property(folders OpenImageIO::OpenImageIO INTERFACE_INCLUDE_DIRECTORIES)
  set(present "")
  foreach(folder ${folders})
    if(EXISTS ${folder})
      list(APPEND present ${folder})
    endif()
  endforeach()
  set_target_properties(OpenImageIO::OpenImageIO PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${present}")
endif()
