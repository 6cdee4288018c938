# The library with the program's commands in it (cli/host.h), for Python: what `pip install ./python` puts into a wheel,
# with the modules beside it.
add_library(conic_hosted SHARED $<TARGET_OBJECTS:conic_objects> $<TARGET_OBJECTS:conic_cli_objects>)
set_target_properties(conic_hosted PROPERTIES OUTPUT_NAME conic-hosted
  LIBRARY_OUTPUT_DIRECTORY ${conic_library_folder})
target_link_libraries(conic_hosted PRIVATE ${conic_libraries})
conic_limit_exports(conic_hosted ${PROJECT_SOURCE_DIR}/cmake/hosted.map ${public_headers} ${PROJECT_SOURCE_DIR}/cli/host.h)
if(CONIC_SANITIZE)
  target_link_options(conic_hosted PRIVATE -fsanitize=${CONIC_SANITIZE})
elseif(CONIC_LINKS_WHOLE) # what is missing is to be said by the linker, and not by who imports it
  target_link_options(conic_hosted PRIVATE LINKER:--no-undefined)
endif()
if(NOT PROJECT_IS_TOP_LEVEL) # whoever takes conic in asks for it by name
  set_target_properties(conic_hosted PROPERTIES EXCLUDE_FROM_ALL ON)
endif()
if(conic_modules)
  add_dependencies(conic_hosted ${conic_modules})
endif()
if(SKBUILD)
  install(TARGETS conic_hosted LIBRARY DESTINATION conic/library COMPONENT python
    RUNTIME DESTINATION conic/library COMPONENT python)
  foreach(module ${conic_modules})
    install(TARGETS ${module} LIBRARY DESTINATION conic/library/conic COMPONENT python)
  endforeach()
  if(CONIC_BUNDLED) # a folder of static libraries: what is of others has to say so (scripts/wheel)
    install(DIRECTORY ${CONIC_BUNDLED}/licenses DESTINATION conic/library COMPONENT python)
  endif()
endif()
