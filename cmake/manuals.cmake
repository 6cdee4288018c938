# Manual pages and completion: the program writes them from its own tables, and scripts/library-manual from the headers.
set(manuals ${PROJECT_BINARY_DIR}/manuals)
set(conic_manuals "")

if(CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR)
  message(STATUS "No manual pages of commands and no completion: conic cannot run here, and there is no emulator")
else()
  add_custom_command(OUTPUT ${manuals}/program.stamp
    COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:conic> "-DEMULATOR=${CMAKE_CROSSCOMPILING_EMULATOR}"
      -DFOLDER=${manuals} -P ${PROJECT_SOURCE_DIR}/cmake/write_manuals.cmake
    COMMAND ${CMAKE_COMMAND} -E touch ${manuals}/program.stamp
    DEPENDS conic ${PROJECT_SOURCE_DIR}/cmake/write_manuals.cmake
    COMMENT "Writing the commands' manual pages and completion" VERBATIM)
  list(APPEND conic_manuals ${manuals}/program.stamp)
  install(DIRECTORY ${manuals}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT program OPTIONAL)
  install(FILES ${manuals}/bash/conic DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
    COMPONENT program OPTIONAL)
  install(FILES ${manuals}/zsh/_conic DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions
    COMPONENT program OPTIONAL)
  install(FILES ${manuals}/fish/conic.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
    COMPONENT program OPTIONAL)
endif()

find_program(PERL perl)
mark_as_advanced(PERL)
if(PERL)
  file(GLOB public_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/include/conic/*.h)
  add_custom_command(OUTPUT ${manuals}/library.stamp
    COMMAND ${PERL} ${PROJECT_SOURCE_DIR}/scripts/library-manual ${PROJECT_SOURCE_DIR}/include/conic ${manuals}
      ${PROJECT_VERSION}
    COMMAND ${CMAKE_COMMAND} -E touch ${manuals}/library.stamp
    DEPENDS ${public_headers} ${PROJECT_SOURCE_DIR}/scripts/library-manual
    COMMENT "Writing the library's manual pages" VERBATIM)
  list(APPEND conic_manuals ${manuals}/library.stamp)
  install(DIRECTORY ${manuals}/man3 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT development OPTIONAL)
else()
  message(STATUS "No manual pages of the library: they need perl")
endif()

add_custom_target(conic_manuals ALL DEPENDS ${conic_manuals})
