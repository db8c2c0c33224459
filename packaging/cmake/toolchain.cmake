# SPDX-License-Identifier: GPL-3.0-or-later
# Language, flags and compiler launcher of every target in the tree.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "Build type" FORCE)
endif()

# dev keeps its checks and just enough debug information for a back trace with lines.
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O2 -g1")
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG")

# Same bytes on every path: no fused multiply-add behind our back. SIMD kernels dispatch at run time above this baseline.
add_compile_options(-march=x86-64-v2 -ffp-contract=off)

# Objects must not depend on where the tree lies, so that several working trees share one cache.
add_compile_options(-ffile-prefix-map=${CMAKE_SOURCE_DIR}=.)

if(PATINA_SANITIZE)
  set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g")
  add_compile_options(-fsanitize=${PATINA_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${PATINA_SANITIZE})
endif()

# timed.sh appends the user CPU seconds of each compilation and link to compile_times.log (read by the budget test).
find_program(PATINA_CCACHE ccache)
set(PATINA_TIMED ${CMAKE_SOURCE_DIR}/packaging/cmake/timed.sh)
set(CMAKE_CXX_COMPILER_LAUNCHER ${PATINA_TIMED} ${CMAKE_BINARY_DIR}/compile_times.log -)
set(CMAKE_CXX_LINKER_LAUNCHER ${CMAKE_CXX_COMPILER_LAUNCHER})
if(PATINA_CCACHE)
  list(APPEND CMAKE_CXX_COMPILER_LAUNCHER
       ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${PATINA_CCACHE})
endif()
