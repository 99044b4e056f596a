# CGAL, of which tests ask for other opinions and benchmarks for other times: CULLHULL_HAVE_CGAL.
# It is GPL, so nothing that is installed is linked with it. Headers of CGAL 5.5 do not compile with
# clang from 19 on.
find_package(CGAL QUIET)
set(CULLHULL_HAVE_CGAL FALSE)
if(TARGET CGAL::CGAL)
  set(CULLHULL_HAVE_CGAL TRUE)
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    include(CheckCXXSourceCompiles)
    # By its folders: where CGAL is headers alone, CGAL::CGAL is no imported target, which a
    # check_cxx_source_compiles could not link.
    set(CMAKE_REQUIRED_INCLUDES ${CGAL_INCLUDE_DIRS} ${Boost_INCLUDE_DIRS})
    set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
    check_cxx_source_compiles([[#include <CGAL/Surface_mesh.h>
      int main() { return 0; }]] CULLHULL_CGAL_COMPILES)
    unset(CMAKE_TRY_COMPILE_TARGET_TYPE)
    unset(CMAKE_REQUIRED_INCLUDES)
    if(NOT CULLHULL_CGAL_COMPILES)
      set(CULLHULL_HAVE_CGAL FALSE)
      message(STATUS "CGAL is left out of tests and benchmarks: this compiler refuses its headers")
    endif()
  endif()
endif()
