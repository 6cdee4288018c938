# What libraries export: conic_limit_exports(TARGET MAP HEADER …). A linker that knows no maps leaves it at what the
# compiler hides; that of Windows, which hides nothing, is given the names that the headers mark by CONIC_API.
include(CheckLinkerFlag)

# Who was linked against one version takes another of the same interface version, as by cmake/install.cmake's
# COMPATIBILITY; before 1.0 every minor version may change the interface.
set(conic_interface_version ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
configure_file(cmake/exports.map.in ${PROJECT_BINARY_DIR}/exports.map @ONLY)
check_linker_flag(C LINKER:--version-script=${PROJECT_BINARY_DIR}/exports.map CONIC_LINKS_BY_MAP)
check_linker_flag(C LINKER:--no-undefined CONIC_LINKS_WHOLE)

file(GLOB public_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/include/conic/*.h)

function(conic_limit_exports target map)
  if(WIN32)
    set(names "EXPORTS\n")
    foreach(header ${ARGN})
      set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${header})
      file(STRINGS ${header} lines REGEX "^CONIC_API ")
      foreach(line ${lines})
        string(REGEX MATCH "([a-z0-9_]+)\\(" matched ${line})
        string(APPEND names "${CMAKE_MATCH_1}\n")
      endforeach()
    endforeach()
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/${target}.def CONTENT "${names}")
    target_sources(${target} PRIVATE ${PROJECT_BINARY_DIR}/${target}.def)
  elseif(CONIC_LINKS_BY_MAP)
    target_link_options(${target} PRIVATE LINKER:--version-script=${map})
    set_target_properties(${target} PROPERTIES LINK_DEPENDS ${map})
  endif()
endfunction()
