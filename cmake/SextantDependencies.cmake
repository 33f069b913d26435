# SPDX-License-Identifier: Apache-2.0
# Debian 12 packages; scripts/setup installs them.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED)
find_package(fmt 9 REQUIRED)
find_package(FlatBuffers 2 REQUIRED)
find_program(FLATC flatc REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
pkg_check_modules(HWY REQUIRED IMPORTED_TARGET libhwy)
# Vectors whose length the compiler does not know (arm64's SVE, RISC-V's) cannot lie in arrays, as the kernels' do:
# such CPUs run the fixed ones (NEON).
target_compile_definitions(PkgConfig::HWY INTERFACE
  "HWY_DISABLED_TARGETS=(HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128|HWY_RVV)")

# OpenCV's CMake configuration comes only with all of OpenCV (libopencv-dev); core and imgproc are all we use.
find_path(OPENCV_INCLUDE opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
foreach(module core imgproc)
  find_library(OPENCV_${module} opencv_${module} REQUIRED)
  add_library(opencv_${module} INTERFACE IMPORTED)
  target_include_directories(opencv_${module} SYSTEM INTERFACE ${OPENCV_INCLUDE})
  target_link_libraries(opencv_${module} INTERFACE ${OPENCV_${module}})
endforeach()
if(SEXTANT_SEARCH_ONLY)
  return()
endif()

find_package(CycloneDDS 0.10 REQUIRED)
find_package(yaml-cpp 0.7 REQUIRED)
find_package(CLI11 2.1 REQUIRED)
find_package(spdlog 1.10 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(assimp 5.2 REQUIRED)
pkg_check_modules(SPNG REQUIRED IMPORTED_TARGET spng)
pkg_check_modules(TURBOJPEG REQUIRED IMPORTED_TARGET libturbojpeg)
pkg_check_modules(QHULL REQUIRED IMPORTED_TARGET qhull_r)
pkg_check_modules(EPOXY REQUIRED IMPORTED_TARGET epoxy)
pkg_check_modules(SYSTEMD REQUIRED IMPORTED_TARGET libsystemd)
