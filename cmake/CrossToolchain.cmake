# Builds for another processor with Debian's cross compilers, against the folder of libraries that
# scripts/cross-check.sh makes, and runs what is built under qemu:
#   -DCULLHULL_CROSS=aarch64|s390x -DCULLHULL_CROSS_ROOT=FOLDER
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR "${CULLHULL_CROSS}")
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CULLHULL_CROSS CULLHULL_CROSS_ROOT)
set(_triplet "${CULLHULL_CROSS}-linux-gnu")
set(CMAKE_C_COMPILER "${_triplet}-gcc")
set(CMAKE_CXX_COMPILER "${_triplet}-g++")
set(CMAKE_FIND_ROOT_PATH "${CULLHULL_CROSS_ROOT}")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_CROSSCOMPILING_EMULATOR "qemu-${CULLHULL_CROSS}-static;-L;/usr/${_triplet}")
