# Builds for any Linux with glibc 2.31 or later, whatever this machine has: against the folder that
# scripts/portable-sysroot.sh makes (-DCULLHULL_SYSROOT=...).
set(CMAKE_SYSROOT "${CULLHULL_SYSROOT}")
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CULLHULL_SYSROOT)
# The compiler's own search path ends at this machine's C library: the folder's comes first.
set(_lib "${CULLHULL_SYSROOT}/usr/lib/x86_64-linux-gnu")
set(_flags "-B${_lib}/ -L${CULLHULL_SYSROOT}/usr/lib/unwinder -L${_lib}")
string(APPEND _flags " -L${CULLHULL_SYSROOT}/lib/x86_64-linux-gnu")
string(APPEND _flags " -Wl,--exclude-libs,ALL")
# Programs and Python modules bring the C++ library. The shared library does not: exceptions pass
# between it and those who use it. None but the static program brings the unwinder (libgcc_s, which
# every system with glibc has): an exception that leaves std::call_once passes a frame of glibc,
# which uses libgcc_s, and two unwinders in one process abort there. This machine's libgcc_s may ask
# for a newer glibc than the folder's; that is no matter, since each system brings its own.
set(CMAKE_SHARED_LINKER_FLAGS_INIT "${_flags}")
foreach(_kind EXE MODULE)
  set(CMAKE_${_kind}_LINKER_FLAGS_INIT "${_flags} -static-libstdc++ -Wl,--allow-shlib-undefined")
endforeach()
# -pthread: the compiler names libpthread behind the C++ library, which needs it.
set(CMAKE_CXX_STANDARD_LIBRARIES "${CULLHULL_SYSROOT}/usr/lib/compat.o -pthread")
# The same bytes wherever the sources lie.
set(CMAKE_CXX_FLAGS_INIT "-ffile-prefix-map=${CMAKE_SOURCE_DIR}=.")
set(CULLHULL_GMP_BY_NAME ON)
set(CMAKE_FIND_ROOT_PATH "${CULLHULL_SYSROOT}")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
# Python's headers are this machine's, all else is the folder's.
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE BOTH)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY BOTH)
