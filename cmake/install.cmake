# `cmake --install`: libraries, headers, the program, a CMake package and a pkg-config file. All of it may be moved
# after it was installed.
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/conic)

install(TARGETS conic)
install(TARGETS conic_shared EXPORT conic-shared)
install(TARGETS conic_static EXPORT conic-static)
install(DIRECTORY include/conic DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

# Two sets, since only who links the static library needs its dependencies found again.
foreach(kind shared static)
  install(EXPORT conic-${kind} NAMESPACE conic:: DESTINATION ${package_folder})
endforeach()
if(TARGET OpenEXR::OpenEXRCore)
  set(static_openexr "find_dependency(OpenEXR CONFIG)")
endif()
if(OpenCL_FOUND)
  set(static_opencl "find_dependency(OpenCL)")
endif()
if(CURL_FOUND)
  set(static_curl "find_dependency(CURL)")
endif()
configure_package_config_file(cmake/conic-config.cmake.in ${CMAKE_BINARY_DIR}/package/conic-config.cmake
  INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/conic-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/package/conic-config.cmake ${CMAKE_BINARY_DIR}/package/conic-config-version.cmake
  DESTINATION ${package_folder})

# For pkg-config --static the private libraries stand by their files, so that who links the shared library needs none
# of their packages.
set(private_libraries "-pthread -ldl -lm")
if(TARGET OpenEXR::OpenEXRCore)
  string(APPEND private_libraries " $<TARGET_LINKER_FILE:OpenEXR::OpenEXRCore>")
endif()
if(OpenCL_FOUND)
  string(APPEND private_libraries " ${OpenCL_LIBRARY}")
endif()
if(ZSTD_FOUND)
  string(APPEND private_libraries " ${ZSTD_LIBRARY}")
endif()
if(CURL_FOUND)
  string(APPEND private_libraries " $<TARGET_LINKER_FILE:CURL::libcurl>")
endif()
if(conic_modules)
  string(APPEND private_libraries " -Wl,-rpath,\${libdir}/conic")
endif()
file(RELATIVE_PATH prefix_from_package /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
string(REGEX REPLACE "/$" "" prefix_from_package ${prefix_from_package})
configure_file(cmake/conic.pc.in ${CMAKE_BINARY_DIR}/package/conic.pc.in @ONLY)
file(GENERATE OUTPUT ${CMAKE_BINARY_DIR}/package/conic.pc INPUT ${CMAKE_BINARY_DIR}/package/conic.pc.in)
install(FILES ${CMAKE_BINARY_DIR}/package/conic.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
