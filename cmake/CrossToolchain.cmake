# Builds for another processor, for Windows or to WebAssembly with Debian's cross compilers, against
# the folder of libraries that scripts/cross-check.sh, windows.sh or wasm.sh makes, and runs what is
# built under qemu, wine or node:
#   -DCULLHULL_CROSS=aarch64|s390x|windows|wasm -DCULLHULL_CROSS_ROOT=FOLDER
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CULLHULL_CROSS CULLHULL_CROSS_ROOT)
if(CULLHULL_CROSS STREQUAL "wasm")
  # WebAssembly's own exceptions and vectors, which every engine has since 2022 (node 17).
  string(JOIN " " CMAKE_CXX_FLAGS_INIT -fwasm-exceptions -msimd128
    -include "${CMAKE_CURRENT_LIST_DIR}/wasm_std.hpp")
  # Kernels that the linker puts into the one function that calls them take 1.4 times as long: the
  # engines' compilers keep their numbers in memory.
  set(CMAKE_EXE_LINKER_FLAGS_INIT
    -sBINARYEN_EXTRA_PASSES=--one-caller-inline-max-function-size=100)
  list(APPEND CMAKE_FIND_ROOT_PATH "${CULLHULL_CROSS_ROOT}")
  set(THREADS_PREFER_PTHREAD_FLAG OFF)
  include(/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake)
  return()
endif()
if(CULLHULL_CROSS STREQUAL "windows")
  set(CMAKE_SYSTEM_NAME Windows)
  set(CMAKE_SYSTEM_PROCESSOR x86_64)
  set(_triplet x86_64-w64-mingw32)
  set(CMAKE_C_COMPILER ${_triplet}-gcc-posix)
  set(CMAKE_CXX_COMPILER ${_triplet}-g++-posix)
  set(CMAKE_RC_COMPILER ${_triplet}-windres)
  foreach(_kind EXE MODULE SHARED)  # each brings the libraries of C++ and of threads
    set(CMAKE_${_kind}_LINKER_FLAGS_INIT -static)
  endforeach()
  set(CMAKE_CROSSCOMPILING_EMULATOR wine)
else()
  set(CMAKE_SYSTEM_NAME Linux)
  set(CMAKE_SYSTEM_PROCESSOR "${CULLHULL_CROSS}")
  set(_triplet "${CULLHULL_CROSS}-linux-gnu")
  set(CMAKE_C_COMPILER "${_triplet}-gcc")
  set(CMAKE_CXX_COMPILER "${_triplet}-g++")
  set(CMAKE_CROSSCOMPILING_EMULATOR "qemu-${CULLHULL_CROSS}-static;-L;/usr/${_triplet}")
endif()
set(CMAKE_FIND_ROOT_PATH "${CULLHULL_CROSS_ROOT}")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
