# SPDX-License-Identifier: Apache-2.0
# Build options and the flags that every target of ours shares.
option(SEXTANT_TESTS "Build the tests" ON)
option(SEXTANT_MPI "Build sextant-mpi (needs OpenMPI)" ON)
option(SEXTANT_SEARCH_ONLY "Only the rooms up to the search, with their tests: what scripts/test-arm64 builds" OFF)
set(SEXTANT_SANITIZE "" CACHE STRING "Sanitizers, e.g. address,undefined or thread")
option(SEXTANT_FUZZ "Build the libFuzzer targets of tests/fuzz (Clang only)" OFF)

add_library(sextant_flags INTERFACE)
target_include_directories(sextant_flags INTERFACE ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR})
target_compile_options(sextant_flags INTERFACE
  -Wall -Wextra -Wconversion -Wshadow -Werror
  # The score of a lattice pose is defined by one float function: no fused multiply-add anywhere.
  -ffp-contract=off)
# Eigen 3.4 under GCC 12 at -O3 trips this warning inside its own headers.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(sextant_flags INTERFACE -Wno-maybe-uninitialized)
endif()
if(SEXTANT_SANITIZE)
  target_compile_options(sextant_flags INTERFACE -fsanitize=${SEXTANT_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(sextant_flags INTERFACE -fsanitize=${SEXTANT_SANITIZE})
endif()
if(SEXTANT_FUZZ)
  # no-link: coverage in every room; only the fuzz targets bring libFuzzer's main().
  target_compile_options(sextant_flags INTERFACE
    -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_link_options(sextant_flags INTERFACE -fsanitize=address,undefined)
endif()

find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_C_COMPILER_LAUNCHER ${CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()
