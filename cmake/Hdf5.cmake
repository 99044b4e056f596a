# libhdf5, the serial one. CMake's own module needs C and compiles with h5cc. Used by our build and
# by cullhullConfig.cmake; optional. Parallel builds of it need MPI and are passed over.
if(NOT TARGET Hdf5::hdf5)
  find_path(HDF5_INCLUDE_DIR hdf5.h PATH_SUFFIXES hdf5/serial)
  find_library(HDF5_LIBRARY NAMES hdf5_serial hdf5 PATH_SUFFIXES hdf5/serial)
  mark_as_advanced(HDF5_INCLUDE_DIR HDF5_LIBRARY)
  set(_parallel "")
  if(HDF5_INCLUDE_DIR AND EXISTS "${HDF5_INCLUDE_DIR}/H5pubconf.h")
    file(STRINGS "${HDF5_INCLUDE_DIR}/H5pubconf.h" _parallel REGEX "define H5_HAVE_PARALLEL 1")
  endif()
  if(HDF5_INCLUDE_DIR AND HDF5_LIBRARY AND NOT _parallel)
    add_library(Hdf5::hdf5 UNKNOWN IMPORTED)
    set_target_properties(Hdf5::hdf5 PROPERTIES IMPORTED_LOCATION "${HDF5_LIBRARY}"
      INTERFACE_INCLUDE_DIRECTORIES "${HDF5_INCLUDE_DIR}")
  endif()
endif()
