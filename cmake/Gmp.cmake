# GMP has no CMake package of its own. Used by our build and by cullhullConfig.cmake.
# CULLHULL_GMP_BY_NAME: the linker looks for it, so that a static program takes the archive.
if(NOT TARGET GMP::gmp AND CULLHULL_GMP_BY_NAME)
  add_library(GMP::gmp INTERFACE IMPORTED)
  set_target_properties(GMP::gmp PROPERTIES INTERFACE_LINK_LIBRARIES gmp)
elseif(NOT TARGET GMP::gmp)
  find_path(GMP_INCLUDE_DIR gmp.h REQUIRED)
  find_library(GMP_LIBRARY gmp REQUIRED)
  add_library(GMP::gmp UNKNOWN IMPORTED)
  set_target_properties(GMP::gmp PROPERTIES IMPORTED_LOCATION "${GMP_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${GMP_INCLUDE_DIR}")
endif()
