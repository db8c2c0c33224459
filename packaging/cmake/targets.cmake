# SPDX-License-Identifier: GPL-3.0-or-later
# The three kinds of target in the tree: a room, a program, a room's tests.

function(patina_compile_options target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Werror)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
endfunction()

# patina_library(<target> [SOURCES ...] [LINKS <public> ...] [PRIVATE_LINKS ...])
# A room without sources is an INTERFACE library.
function(patina_library target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LINKS;PRIVATE_LINKS")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "patina_library(${target}): unknown argument ${arg_UNPARSED_ARGUMENTS}")
  endif()
  if(arg_SOURCES)
    add_library(${target} STATIC ${arg_SOURCES})
    patina_compile_options(${target})
    target_link_libraries(${target} PUBLIC ${arg_LINKS} PRIVATE ${arg_PRIVATE_LINKS})
  else()
    add_library(${target} INTERFACE)
    target_link_libraries(${target} INTERFACE ${arg_LINKS})
  endif()
endfunction()

# patina_program(<target> SOURCES ... [LINKS ...]): lies at the top of the build folder.
function(patina_program target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LINKS")
  add_executable(${target} ${arg_SOURCES})
  patina_compile_options(${target})
  target_link_libraries(${target} PRIVATE ${arg_LINKS})
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
endfunction()

# patina_test(<target> SOURCES ... [LINKS ...] [SHARDS n] [LABELS ...] [RESOURCE_LOCK ...] [ENVIRONMENT NAME=value ...]
#             [TIMEOUT s] [DEPENDS <programs the test runs>] [LAUNCHER <command>])
# LAUNCHER runs it: umockdev-wrapper for tests of simulated devices.
# One gtest binary out of several files, one CTest entry a shard. Every entry has its folder under tests/ as a label, and
# the target tests-<folder> (slashes as dashes) builds what the folder's tests need.
function(patina_test target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "SHARDS;TIMEOUT" "SOURCES;LINKS;LABELS;RESOURCE_LOCK;ENVIRONMENT;DEPENDS;LAUNCHER")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "patina_test(${target}): unknown argument ${arg_UNPARSED_ARGUMENTS}")
  endif()
  if(NOT arg_SHARDS)
    set(arg_SHARDS 1)
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)
  endif()

  add_executable(${target} ${arg_SOURCES})
  patina_compile_options(${target})
  target_link_libraries(${target} PRIVATE ${arg_LINKS} patina_test_support patina::gtest)
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)

  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${PROJECT_SOURCE_DIR}/tests OUTPUT_VARIABLE folder)
  string(REPLACE "/" "-" group tests-${folder})
  if(NOT TARGET ${group})
    add_custom_target(${group})
  endif()
  add_dependencies(${group} ${target} ${arg_DEPENDS})
  if(arg_DEPENDS)
    add_dependencies(${target} ${arg_DEPENDS})
  endif()

  math(EXPR last "${arg_SHARDS} - 1")
  foreach(shard RANGE ${last})
    set(entry ${target})
    if(arg_SHARDS GREATER 1)
      set(entry ${target}.${shard})
    endif()
    add_test(NAME ${entry}
             COMMAND ${PATINA_TIMED} ${PROJECT_BINARY_DIR}/test_times.log ${entry} ${arg_LAUNCHER} $<TARGET_FILE:${target}>)
    # PATINA_TEST_DATA and PATINA_UPDATE_GOLDEN come through from the caller's environment.
    set_tests_properties(${entry} PROPERTIES
      LABELS "${folder};${arg_LABELS}" TIMEOUT ${arg_TIMEOUT} RESOURCE_LOCK "${arg_RESOURCE_LOCK}"
      ENVIRONMENT "GTEST_TOTAL_SHARDS=${arg_SHARDS};GTEST_SHARD_INDEX=${shard};GTEST_BRIEF=1;GTEST_OUTPUT=json:${PROJECT_BINARY_DIR}/test_reports/${entry}.json;PATINA_PROGRAM=${PROJECT_BINARY_DIR}/patina;UBSAN_OPTIONS=print_stacktrace=1;TSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/packaging/tsan.supp;${arg_ENVIRONMENT}")
    set_property(GLOBAL APPEND PROPERTY PATINA_TEST_ENTRIES ${entry})
  endforeach()
endfunction()

# patina_long_test(<entry> TARGET <a test> [FILTER <gtest filter>] [ENVIRONMENT NAME=value ...]): the same binary in its
# long form, run by `make test-long` alone and outside the budgets.
function(patina_long_test entry)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "TARGET;FILTER" "ENVIRONMENT")
  if(NOT arg_FILTER)
    set(arg_FILTER *)
  endif()
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${PROJECT_SOURCE_DIR}/tests OUTPUT_VARIABLE folder)
  add_test(NAME ${entry} COMMAND ${arg_TARGET} --gtest_filter=${arg_FILTER})
  set_tests_properties(${entry} PROPERTIES LABELS "${folder};long" TIMEOUT 7200
    ENVIRONMENT "PATINA_PROGRAM=${PROJECT_BINARY_DIR}/patina;${arg_ENVIRONMENT}")
endfunction()
