# `cmake --install`: libraries, headers, the program, a CMake package and a pkg-config file. All of it may be moved
# after it was installed.
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/conic)

# In components, each of which is a package: the program, the library that programs run with, and what they are built with.
install(TARGETS conic COMPONENT program)
install(DIRECTORY include/conic DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT development)

# Two sets, since only who links the static library needs its dependencies found again.
foreach(kind ${conic_kinds})
  install(TARGETS conic_${kind} EXPORT conic-${kind} COMPONENT development
    LIBRARY COMPONENT library NAMELINK_COMPONENT development)
  install(EXPORT conic-${kind} NAMESPACE conic:: DESTINATION ${package_folder} COMPONENT development)
endforeach()
if(TARGET OpenEXR::OpenEXRCore)
  set(static_openexr "find_dependency(OpenEXR CONFIG)")
endif()
if(PNG_FOUND)
  set(static_png "find_dependency(PNG)")
endif()
if(ZLIB_FOUND)
  set(static_zlib "find_dependency(ZLIB)")
endif()
if(OpenCL_FOUND)
  set(static_opencl "find_dependency(OpenCL)")
endif()
if(CURL_FOUND)
  set(static_curl "find_dependency(CURL)")
endif()
configure_package_config_file(cmake/conic-config.cmake.in ${PROJECT_BINARY_DIR}/package/conic-config.cmake
  INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/package/conic-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/package/conic-config.cmake ${PROJECT_BINARY_DIR}/package/conic-config-version.cmake
  DESTINATION ${package_folder} COMPONENT development)

# For pkg-config --static: the private libraries by their names, with the folders of those that the linker would not find.
# Requires.private would make who links the shared library install their packages.
set(private_libraries "-pthread -ldl -lm")
macro(conic_link_privately file)
  get_filename_component(folder ${file} DIRECTORY)
  get_filename_component(name ${file} NAME)
  file(REAL_PATH ${folder} real_folder)
  if(NOT folder IN_LIST CMAKE_C_IMPLICIT_LINK_DIRECTORIES AND NOT real_folder IN_LIST CMAKE_C_IMPLICIT_LINK_DIRECTORIES)
    string(APPEND private_libraries " -L${folder}")
  endif()
  string(REGEX REPLACE "^lib(.*)\\.(so|a|dylib)[.0-9]*$" "-l\\1" name ${name})
  string(APPEND private_libraries " ${name}")
endmacro()
foreach(target OpenEXR::OpenEXRCore PNG::PNG ZLIB::ZLIB OpenCL::OpenCL CURL::libcurl)
  if(TARGET ${target})
    set(locations LOCATION LOCATION_RELEASE LOCATION_RELWITHDEBINFO LOCATION_NONE LOCATION_NOCONFIG)
    foreach(location ${locations})
      get_target_property(file ${target} IMPORTED_${location})
      if(file)
        break()
      endif()
    endforeach()
    conic_link_privately(${file})
  endif()
endforeach()
if(ZSTD_FOUND)
  conic_link_privately(${ZSTD_LIBRARY})
endif()
if(WEBP_FOUND)
  conic_link_privately(${WEBP_LIBRARY})
endif()
if(conic_modules)
  string(APPEND private_libraries " -Wl,-rpath,\${libdir}/conic")
endif()
set(public_libraries "")
if(conic_kind STREQUAL static) # there is no other
  set(public_libraries " ${private_libraries}")
endif()
file(RELATIVE_PATH prefix_from_package /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
string(REGEX REPLACE "/$" "" prefix_from_package ${prefix_from_package})
configure_file(cmake/conic.pc.in ${PROJECT_BINARY_DIR}/package/conic.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/package/conic.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

# cmake --build FOLDER --target uninstall takes away what was installed last.
if(PROJECT_IS_TOP_LEVEL)
  add_custom_target(uninstall COMMAND ${CMAKE_COMMAND} -DMANIFEST=${PROJECT_BINARY_DIR}/install_manifest.txt
    -P ${PROJECT_SOURCE_DIR}/cmake/uninstall.cmake VERBATIM)
endif()
