# The module with the bridge to OpenImageIO, loaded when it is needed. It lies where core/image/openimageio_load.c looks: in a
# folder beside libconic, in the build as in an installation.
add_library(conic_openimageio MODULE core/image/openimageio_bridge.cpp)
set_target_properties(conic_openimageio PROPERTIES PREFIX "" OUTPUT_NAME conic-openimageio SUFFIX .so
  LIBRARY_OUTPUT_DIRECTORY ${conic_library_folder}/conic LINK_DEPENDS ${CMAKE_BINARY_DIR}/exports.map)
target_compile_options(conic_openimageio PRIVATE -Wno-shadow)
target_link_libraries(conic_openimageio PRIVATE conic_flags OpenImageIO::OpenImageIO)
# The C++ library's templates would otherwise be exported.
target_link_options(conic_openimageio PRIVATE LINKER:--version-script=${CMAKE_BINARY_DIR}/exports.map)
install(TARGETS conic_openimageio LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/conic)

target_compile_definitions(conic_objects PRIVATE CONIC_HAVE_OPENIMAGEIO=1)
set_source_files_properties(core/image/openimageio_load.c PROPERTIES # which asks where it is: no question of POSIX's
  COMPILE_DEFINITIONS "_GNU_SOURCE;CONIC_MODULES_FROM_PROGRAM=\"${libraries_from_programs}/conic\"")
