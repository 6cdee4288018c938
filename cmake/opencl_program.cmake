# The programs for OpenCL devices: each opencl/NAME.cl with all that it includes, the C path's own text among it, as one
# text within the library. The preprocessor knows nothing of this machine, so that the text is the same from every one.
set(conic_opencl_sources ${PROJECT_SOURCE_DIR}/opencl/opencl_device.c ${PROJECT_SOURCE_DIR}/opencl/program.c
  ${PROJECT_SOURCE_DIR}/opencl/cache.c ${PROJECT_SOURCE_DIR}/opencl/queue.c ${PROJECT_SOURCE_DIR}/opencl/frame.c
  ${PROJECT_SOURCE_DIR}/opencl/frame_setup.c ${PROJECT_SOURCE_DIR}/opencl/frame_tiles.c ${PROJECT_SOURCE_DIR}/opencl/frame_triangles.c
  ${PROJECT_SOURCE_DIR}/opencl/frame_gaussians.c ${PROJECT_SOURCE_DIR}/opencl/host_setup.c ${PROJECT_SOURCE_DIR}/opencl/opencl_renderer.c)
foreach(program setup raster triangles gaussian_tiles gaussian_pixels)
  set(text ${PROJECT_BINARY_DIR}/opencl/${program}.cl)
  set(source ${PROJECT_BINARY_DIR}/opencl/${program}_text.c)
  add_custom_command(OUTPUT ${text} DEPFILE ${text}.d
    COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/opencl
    COMMAND ${CMAKE_C_COMPILER} -x c -E -P -nostdinc -undef -I${PROJECT_SOURCE_DIR}/opencl/c_library
      -I${PROJECT_SOURCE_DIR} -I${PROJECT_SOURCE_DIR}/include -MD -MF ${text}.d -MT ${text}
      -o ${text} ${PROJECT_SOURCE_DIR}/opencl/${program}.cl
    DEPENDS ${PROJECT_SOURCE_DIR}/opencl/${program}.cl
    COMMENT "Preprocessing opencl/${program}.cl" VERBATIM)
  add_custom_command(OUTPUT ${source}
    COMMAND ${CMAKE_COMMAND} -DTEXT=${text} -DNAME=${program} -DSOURCE=${source}
      -P ${PROJECT_SOURCE_DIR}/cmake/opencl_text.cmake
    DEPENDS ${text} ${PROJECT_SOURCE_DIR}/cmake/opencl_text.cmake VERBATIM)
  list(APPEND conic_opencl_sources ${source})
endforeach()
