# cmake --install puts the libraries, the headers, the program and a CMake package in place.
include(CMakePackageConfigHelpers)
set(_dir "${CMAKE_INSTALL_LIBDIR}/cmake/cullhull")
set(_targets cullhull)
if(CULLHULL_BUILD_IO)
  list(APPEND _targets cullhull_io)
endif()
install(TARGETS ${_targets} EXPORT cullhullTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY include/cullhull DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT cullhullTargets NAMESPACE cullhull:: DESTINATION ${_dir})
set(CULLHULL_HAVE_QHULL OFF)
if(CULLHULL_WITH_QHULL AND TARGET Qhull::qhull_r)
  set(CULLHULL_HAVE_QHULL ON)
endif()
configure_package_config_file(cmake/cullhullConfig.cmake.in
  "${CMAKE_CURRENT_BINARY_DIR}/cullhullConfig.cmake" INSTALL_DESTINATION ${_dir})
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/cullhullConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/cullhullConfig.cmake"
  "${CMAKE_CURRENT_BINARY_DIR}/cullhullConfigVersion.cmake" cmake/Gmp.cmake
  DESTINATION ${_dir})
if(CULLHULL_BUILD_APPS)
  install(TARGETS cullhull_app RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
