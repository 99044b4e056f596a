# Builds for another system with zig (scripts/zig.sh):
#   -DCULLHULL_ZIG=FOLDER, of its compilers (bin) and libraries (deps), -DCULLHULL_ZIG_TARGET=TARGET
string(REGEX MATCH "^([^-]+)-([^-.]+)" _name "${CULLHULL_ZIG_TARGET}")
set(CMAKE_SYSTEM_PROCESSOR "${CMAKE_MATCH_1}")
set(CMAKE_SYSTEM_NAME Linux)
if(CMAKE_MATCH_2 STREQUAL "macos")
  set(CMAKE_SYSTEM_NAME Darwin)
  set(CMAKE_OSX_SYSROOT "" CACHE STRING "")  # zig has one
  set(CMAKE_INSTALL_NAME_TOOL true)  # nothing is installed
  # macOS's <math.h> includes <float.h> for INFINITY and NAN alone, and libc++'s <float.h>, which is
  # read once, would give nothing else to those who include it later.
  set(_float "-D__need_float_float= -D__need_infinity_nan=")
else()
  # musl gives threads 128 KiB where the program does not ask for more.
  set(CMAKE_EXE_LINKER_FLAGS_INIT "-s -Wl,-z,stack-size=8388608")
  set(CMAKE_MODULE_LINKER_FLAGS_INIT -s)
endif()
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CULLHULL_ZIG CULLHULL_ZIG_TARGET)
set(CMAKE_C_COMPILER "${CULLHULL_ZIG}/bin/clang")
set(CMAKE_CXX_COMPILER "${CULLHULL_ZIG}/bin/clang++")
set(CMAKE_AR "${CULLHULL_ZIG}/bin/ar" CACHE FILEPATH "")
set(CMAKE_RANLIB "${CULLHULL_ZIG}/bin/ranlib" CACHE FILEPATH "")
set(CMAKE_CXX_FLAGS_INIT "${_float} -ffile-prefix-map=${CMAKE_SOURCE_DIR}=.")
set(CMAKE_FIND_ROOT_PATH "${CULLHULL_ZIG}/deps")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
