# What conic can use: all of it optional, but for threads.
include(CheckLanguage)

set(THREADS_PREFER_PTHREAD_FLAG ON)
find_package(Threads REQUIRED)

if(CONIC_WITH_OPENEXR)
  set(CMAKE_MESSAGE_LOG_LEVEL WARNING) # Debian's package of it talks even when asked to be quiet
  find_package(OpenEXR 3.1 CONFIG QUIET)
  unset(CMAKE_MESSAGE_LOG_LEVEL)
endif()

if(CONIC_WITH_PNG)
  find_package(PNG 1.6 QUIET)
else()
  set(PNG_FOUND FALSE)
endif()

if(CONIC_WITH_ZLIB)
  find_package(ZLIB QUIET)
else()
  set(ZLIB_FOUND FALSE)
endif()

if(CONIC_WITH_LIBDEFLATE) # which has no CMake package in Debian
  find_library(LIBDEFLATE_LIBRARY deflate)
  find_path(LIBDEFLATE_INCLUDE_FOLDER libdeflate.h)
  mark_as_advanced(LIBDEFLATE_LIBRARY LIBDEFLATE_INCLUDE_FOLDER)
endif()
if(CONIC_WITH_LIBDEFLATE AND LIBDEFLATE_LIBRARY AND LIBDEFLATE_INCLUDE_FOLDER)
  set(LIBDEFLATE_FOUND TRUE)
else()
  set(LIBDEFLATE_FOUND FALSE)
endif()

if(CONIC_WITH_OPENIMAGEIO AND NOT WIN32) # where no module is loaded, as in core/base/module_absent.c
  if(NOT CMAKE_CXX_COMPILER)
    unset(CMAKE_CXX_COMPILER CACHE) # one may have been installed since the last look
  endif()
  check_language(CXX)
  if(CMAKE_CXX_COMPILER)
    enable_language(CXX)
    set(CMAKE_CXX_STANDARD 17)
    set(CMAKE_CXX_STANDARD_REQUIRED ON)
    set(CMAKE_CXX_EXTENSIONS OFF)
    set(CMAKE_CXX_VISIBILITY_PRESET hidden)
    include(cmake/openimageio.cmake)
  endif()
endif()

if(CONIC_WITH_ASSIMP AND NOT WIN32)
  find_package(assimp 5 CONFIG QUIET)
endif()

if(CONIC_WITH_DRACO AND NOT WIN32)
  check_language(CXX)
  if(CMAKE_CXX_COMPILER)
    enable_language(CXX)
    find_library(DRACO_LIBRARY draco)
    find_path(DRACO_INCLUDE_FOLDER draco/compression/decode.h)
    mark_as_advanced(DRACO_LIBRARY DRACO_INCLUDE_FOLDER)
  endif()
endif()
if(CONIC_WITH_DRACO AND DRACO_LIBRARY AND DRACO_INCLUDE_FOLDER)
  set(DRACO_FOUND TRUE)
else()
  set(DRACO_FOUND FALSE)
endif()

if(CONIC_WITH_MESHOPTIMIZER)
  find_library(MESHOPTIMIZER_LIBRARY meshoptimizer)
  find_path(MESHOPTIMIZER_INCLUDE_FOLDER meshoptimizer.h)
  mark_as_advanced(MESHOPTIMIZER_LIBRARY MESHOPTIMIZER_INCLUDE_FOLDER)
endif()
if(CONIC_WITH_MESHOPTIMIZER AND MESHOPTIMIZER_LIBRARY AND MESHOPTIMIZER_INCLUDE_FOLDER)
  set(MESHOPTIMIZER_FOUND TRUE)
else()
  set(MESHOPTIMIZER_FOUND FALSE)
endif()

if(CONIC_WITH_OPENCL)
  find_package(OpenCL QUIET)
else()
  set(OpenCL_FOUND FALSE)
endif()

if(CONIC_WITH_ZSTD) # likewise
  find_library(ZSTD_LIBRARY zstd)
  find_path(ZSTD_INCLUDE_FOLDER zstd.h)
  mark_as_advanced(ZSTD_LIBRARY ZSTD_INCLUDE_FOLDER)
endif()
if(CONIC_WITH_ZSTD AND ZSTD_LIBRARY AND ZSTD_INCLUDE_FOLDER)
  set(ZSTD_FOUND TRUE)
else()
  set(ZSTD_FOUND FALSE)
endif()

if(CONIC_WITH_WEBP) # likewise
  find_library(WEBP_LIBRARY webp)
  find_path(WEBP_INCLUDE_FOLDER webp/encode.h)
  mark_as_advanced(WEBP_LIBRARY WEBP_INCLUDE_FOLDER)
endif()
if(CONIC_WITH_WEBP AND WEBP_LIBRARY AND WEBP_INCLUDE_FOLDER)
  set(WEBP_FOUND TRUE)
else()
  set(WEBP_FOUND FALSE)
endif()

if(CONIC_WITH_BROTLI) # likewise
  find_library(BROTLI_LIBRARY brotlidec)
  find_library(BROTLI_COMMON_LIBRARY brotlicommon)
  find_path(BROTLI_INCLUDE_FOLDER brotli/decode.h)
  mark_as_advanced(BROTLI_LIBRARY BROTLI_COMMON_LIBRARY BROTLI_INCLUDE_FOLDER)
endif()
if(CONIC_WITH_BROTLI AND BROTLI_LIBRARY AND BROTLI_COMMON_LIBRARY AND BROTLI_INCLUDE_FOLDER)
  set(BROTLI_FOUND TRUE)
else()
  set(BROTLI_FOUND FALSE)
endif()

if(CONIC_WITH_XML)
  find_package(LibXml2 QUIET)
else()
  set(LIBXML2_FOUND FALSE)
endif()

if(CONIC_WITH_CURL)
  find_package(CURL 7.66 QUIET)
else()
  set(CURL_FOUND FALSE)
endif()

if(CONIC_WITH_MPI AND (NOT CMAKE_CROSSCOMPILING OR MPI_C_COMPILER) AND NOT WIN32) # of another processor where it is said which
  find_package(MPI QUIET COMPONENTS C)
else()
  set(MPI_C_FOUND FALSE)
endif()

set(found_openexr ${OpenEXR_FOUND})
set(found_png ${PNG_FOUND})
set(found_zlib ${ZLIB_FOUND})
set(found_libdeflate ${LIBDEFLATE_FOUND})
set(found_openimageio ${OpenImageIO_FOUND})
set(found_assimp ${assimp_FOUND})
set(found_draco ${DRACO_FOUND})
set(found_meshoptimizer ${MESHOPTIMIZER_FOUND})
set(found_opencl ${OpenCL_FOUND})
set(found_curl ${CURL_FOUND})
set(found_zstd ${ZSTD_FOUND})
set(found_webp ${WEBP_FOUND})
set(found_brotli ${BROTLI_FOUND})
set(found_xml ${LIBXML2_FOUND})
set(found_mpi ${MPI_C_FOUND})
foreach(dependency "openexr:OpenEXR (EXR images)" "png:libpng (PNG images)"
        "zlib:zlib (compressed deep images, Gaussian scenes in .spz)"
        "libdeflate:libdeflate (EXR images packed faster)"
        "openimageio:OpenImageIO (TIFF, JPEG … images, and PNG without libpng)"
        "assimp:Assimp (3MF, DAE, FBX … meshes)" "draco:libdraco (glTF packed by Draco)"
        "meshoptimizer:libmeshoptimizer (glTF packed by meshopt)" "opencl:OpenCL (other devices)"
        "zstd:zstd (layered point clouds, Gaussian scenes in .spz)" "webp:libwebp (Gaussian scenes in .sog)" "xml:libxml2 (scans in .e57)" "brotli:libbrotlidec (points of Potree 2)" "curl:CURL (layered clouds from web servers)"
        "mpi:MPI (the program conic-mpi)")
  string(REGEX MATCH "^([a-z]+):(.*)$" matched ${dependency})
  set(description "${CMAKE_MATCH_2}")
  if(found_${CMAKE_MATCH_1})
    message(STATUS "Found: ${description}")
  else()
    message(STATUS "Not found: ${description}")
  endif()
endforeach()
