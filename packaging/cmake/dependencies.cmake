# SPDX-License-Identifier: GPL-3.0-or-later
# Third-party libraries, each once, by name. Imported targets: their headers count as system headers.
# docs/dependencies.md says why each is here.

find_package(Threads REQUIRED)

# patina_import(<name> [HEADER <file> [SUFFIXES <folders>]] [LIBRARIES <names>] [DEFINES ...] [LINKS ...])
function(patina_import name)
  cmake_parse_arguments(arg "" "HEADER" "SUFFIXES;LIBRARIES;LIBRARY_SUFFIXES;DEFINES;LINKS" ${ARGN})
  add_library(patina::${name} INTERFACE IMPORTED GLOBAL)
  if(arg_HEADER)
    find_path(PATINA_${name}_INCLUDE ${arg_HEADER} PATH_SUFFIXES ${arg_SUFFIXES} REQUIRED)
    mark_as_advanced(PATINA_${name}_INCLUDE)
    target_include_directories(patina::${name} SYSTEM INTERFACE ${PATINA_${name}_INCLUDE})
  endif()
  foreach(library IN LISTS arg_LIBRARIES)
    find_library(PATINA_${library}_LIBRARY NAMES ${library} PATH_SUFFIXES ${arg_LIBRARY_SUFFIXES} REQUIRED)
    mark_as_advanced(PATINA_${library}_LIBRARY)
    target_link_libraries(patina::${name} INTERFACE ${PATINA_${library}_LIBRARY})
  endforeach()
  target_compile_definitions(patina::${name} INTERFACE ${arg_DEFINES})
  target_link_libraries(patina::${name} INTERFACE ${arg_LINKS})
endfunction()

# OpenCV without its CMake package: that one comes only with libopencv-dev and half of a desktop.
patina_import(opencv_core HEADER opencv2/core.hpp SUFFIXES opencv4 LIBRARIES opencv_core)
patina_import(opencv_imgproc LIBRARIES opencv_imgproc LINKS patina::opencv_core)
patina_import(opencv_calib3d LIBRARIES opencv_calib3d opencv_features2d opencv_flann LINKS patina::opencv_imgproc)
patina_import(opencv_aruco LIBRARIES opencv_aruco LINKS patina::opencv_calib3d)
patina_import(opencv_mcc LIBRARIES opencv_mcc LINKS patina::opencv_calib3d)
patina_import(opencv_photo LIBRARIES opencv_photo LINKS patina::opencv_imgproc)
patina_import(opencv_video LIBRARIES opencv_video LINKS patina::opencv_imgproc)
patina_import(eigen HEADER Eigen/Core SUFFIXES eigen3)

patina_import(libraw HEADER libraw/libraw.h LIBRARIES raw_r)
patina_import(exiv2 HEADER exiv2/exiv2.hpp LIBRARIES exiv2)
patina_import(jpeg HEADER jpeglib.h LIBRARIES jpeg)
patina_import(png HEADER png.h LIBRARIES png)
patina_import(tiff HEADER tiffio.h LIBRARIES tiff)
patina_import(imath HEADER half.h SUFFIXES Imath LIBRARIES Imath)
patina_import(openexr HEADER ImfInputFile.h SUFFIXES OpenEXR LIBRARIES OpenEXR Iex IlmThread LINKS patina::imath Threads::Threads)
patina_import(avformat HEADER libavformat/avformat.h LIBRARIES avformat avcodec swscale avutil)

patina_import(hdf5 HEADER hdf5.h SUFFIXES hdf5/serial LIBRARIES hdf5 LIBRARY_SUFFIXES hdf5/serial)
patina_import(sqlite HEADER sqlite3.h LIBRARIES sqlite3 LINKS Threads::Threads)
patina_import(crypto HEADER openssl/evp.h LIBRARIES crypto)

patina_import(tbb HEADER tbb/parallel_for.h LIBRARIES tbb LINKS Threads::Threads)
patina_import(embree HEADER embree3/rtcore.h LIBRARIES embree3)
patina_import(tinygltf HEADER tiny_gltf.h LIBRARIES tinygltf)
patina_import(tinyobj HEADER tiny_obj_loader.h LIBRARIES tinyobjloader)
patina_import(fftw HEADER fftw3.h LIBRARIES fftw3f)

# OpenBLAS by its own name, never libblas/liblapack: those are alternatives that another package may turn to a slow one.
# It holds BLAS, CBLAS and LAPACK; LAPACKE comes as an archive, whose shared form would bring those alternatives along.
find_file(PATINA_lapacke_ARCHIVE NAMES liblapacke.a PATHS /usr/lib PATH_SUFFIXES ${CMAKE_LIBRARY_ARCHITECTURE} REQUIRED)
mark_as_advanced(PATINA_lapacke_ARCHIVE)
patina_import(openblas HEADER cblas.h SUFFIXES ${CMAKE_LIBRARY_ARCHITECTURE}/openblas-pthread
              LINKS ${PATINA_lapacke_ARCHIVE})
find_library(PATINA_openblas_LIBRARY NAMES openblas
             PATHS /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/openblas-pthread NO_DEFAULT_PATH REQUIRED)
mark_as_advanced(PATINA_openblas_LIBRARY)
target_link_libraries(patina::openblas INTERFACE ${PATINA_openblas_LIBRARY})

patina_import(spdlog HEADER spdlog/spdlog.h LIBRARIES spdlog fmt LINKS Threads::Threads
              DEFINES SPDLOG_COMPILED_LIB SPDLOG_SHARED_LIB SPDLOG_FMT_EXTERNAL)
patina_import(json HEADER nlohmann/json.hpp)
patina_import(cli11 HEADER CLI/CLI.hpp)
patina_import(toml HEADER toml++/toml.h)
patina_import(expected HEADER tl/expected.hpp)
patina_import(curl HEADER curl/curl.h SUFFIXES ${CMAKE_LIBRARY_ARCHITECTURE} LIBRARIES curl)
patina_import(mosquitto HEADER mosquitto.h LIBRARIES mosquitto)
patina_import(microhttpd HEADER microhttpd.h LIBRARIES microhttpd)
patina_import(muparser HEADER muParser.h LIBRARIES muparser)
patina_import(gphoto2 HEADER gphoto2/gphoto2.h LIBRARIES gphoto2 gphoto2_port)
patina_import(usb HEADER libusb.h SUFFIXES libusb-1.0 LIBRARIES usb-1.0)
patina_import(gpiod HEADER gpiod.h LIBRARIES gpiod)
patina_import(camera HEADER libcamera/libcamera.h SUFFIXES libcamera LIBRARIES camera camera-base)
patina_import(systemd HEADER systemd/sd-daemon.h LIBRARIES systemd)

# gmock_main is an archive: a test that brings its own main() simply wins.
patina_import(gtest HEADER gmock/gmock.h LIBRARIES gmock_main gmock gtest LINKS Threads::Threads)
# Only a test's disk.
patina_import(fuse HEADER fuse3/fuse.h LIBRARIES fuse3)
# Simulated devices below the real libraries: only tests use it.
patina_import(glib HEADER glib.h SUFFIXES glib-2.0 LIBRARIES glib-2.0 gobject-2.0 gio-2.0)
find_path(PATINA_glibconfig_INCLUDE glibconfig.h PATHS /usr/lib
          PATH_SUFFIXES ${CMAKE_LIBRARY_ARCHITECTURE}/glib-2.0/include REQUIRED)
mark_as_advanced(PATINA_glibconfig_INCLUDE)
target_include_directories(patina::glib SYSTEM INTERFACE ${PATINA_glibconfig_INCLUDE})
patina_import(umockdev HEADER umockdev.h SUFFIXES umockdev-1.0 LIBRARIES umockdev LINKS patina::glib)
patina_import(benchmark HEADER benchmark/benchmark.h LIBRARIES benchmark LINKS Threads::Threads)
