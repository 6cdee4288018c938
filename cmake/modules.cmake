# Modules, loaded when they are needed. They lie where core/base/module_posix.c looks: in a folder beside libconic, in the
# build as in an installation. conic_add_module(NAME LIBRARY SOURCE …) makes
# conic-NAME.so.
set(conic_modules "")
include(CheckSymbolExists)
set(CMAKE_REQUIRED_DEFINITIONS -D_GNU_SOURCE)
check_symbol_exists(dladdr1 dlfcn.h CONIC_HAVE_DLADDR1)
unset(CMAKE_REQUIRED_DEFINITIONS)
set_source_files_properties(core/base/module_posix.c PROPERTIES COMPILE_DEFINITIONS # it asks where it is: not POSIX's
  "_GNU_SOURCE;CONIC_HAVE_DLADDR1=$<BOOL:${CONIC_HAVE_DLADDR1}>;CONIC_MODULES_FROM_PROGRAM=\"${libraries_from_programs}/conic\"")

macro(conic_add_module name library)
  add_library(conic_${name} MODULE ${ARGN})
  set_target_properties(conic_${name} PROPERTIES PREFIX "" OUTPUT_NAME conic-${name} SUFFIX .so
    LIBRARY_OUTPUT_DIRECTORY ${conic_library_folder}/conic)
  target_link_libraries(conic_${name} PRIVATE conic_flags ${library})
  # The C++ library's templates would otherwise be exported.
  conic_limit_exports(conic_${name} ${PROJECT_BINARY_DIR}/exports.map)
  if(CONIC_INSTALL)
    install(TARGETS conic_${name} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/conic COMPONENT library)
  endif()
  list(APPEND conic_modules conic_${name})
  string(TOUPPER ${name} upper_name)
  target_compile_definitions(conic_objects PRIVATE CONIC_HAVE_${upper_name}=1)
endmacro()

if(TARGET OpenImageIO::OpenImageIO)
  conic_add_module(openimageio OpenImageIO::OpenImageIO core/pictures/openimageio_bridge.cpp)
  target_compile_options(conic_openimageio PRIVATE -Wno-shadow)
endif()
if(TARGET assimp::assimp)
  conic_add_module(assimp assimp::assimp core/assimp/assimp_bridge.c core/assimp/assimp_files_bridge.c
    core/assimp/assimp_materials_bridge.c core/assimp/assimp_settle_bridge.c)
endif()
if(DRACO_FOUND)
  conic_add_module(draco ${DRACO_LIBRARY} core/gltf/draco_bridge.cpp)
  target_include_directories(conic_draco SYSTEM PRIVATE ${DRACO_INCLUDE_FOLDER})
endif()
if(CURL_FOUND AND NOT WIN32)
  conic_add_module(curl CURL::libcurl lod/ranges/curl_bridge.c)
endif()
