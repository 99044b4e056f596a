# cmake --install puts the libraries, the headers, the program, its pages and a CMake package in
# place; with CULLHULL_SHARED the shared library instead of the static ones. Components: program,
# runtime (the shared library) and development.
include(CMakePackageConfigHelpers)
set(_package "${CMAKE_INSTALL_LIBDIR}/cmake/cullhull")
if(CULLHULL_SHARED)
  set(_libraries cullhull_shared cullhull_shared_io)
else()
  set(_libraries cullhull)
  if(CULLHULL_BUILD_IO)
    list(APPEND _libraries cullhull_io)
  endif()
endif()
install(TARGETS ${_libraries} EXPORT cullhullTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime
    NAMELINK_COMPONENT development
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY include/cullhull DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
if(TARGET cullhull_c)
  install(TARGETS cullhull_c EXPORT cullhullTargets
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime
      NAMELINK_COMPONENT development
    RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  install(FILES bindings/c/cullhull.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
    COMPONENT development)
endif()
# In a folder of its own, which users name: Qhull's stays what it is. Not in packages, which would
# promise others a whole Qhull.
if(TARGET cullhull_qhull AND NOT CULLHULL_SHARED)
  install(TARGETS cullhull_qhull cullhull_qhull_one LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/cullhull
    COMPONENT runtime)
endif()
install(EXPORT cullhullTargets NAMESPACE cullhull:: DESTINATION ${_package}
  COMPONENT development)
if(CULLHULL_HAVE_MPI)
  install(TARGETS cullhull_mpi EXPORT cullhullMpiTargets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  install(EXPORT cullhullMpiTargets NAMESPACE cullhull:: DESTINATION ${_package}
    COMPONENT development)
endif()
if(CULLHULL_HAVE_CUDA AND NOT CULLHULL_SHARED)
  get_target_property(_cudart CUDA::cudart_static IMPORTED_LOCATION)
  install(FILES "${_cudart}" DESTINATION ${CMAKE_INSTALL_LIBDIR}/cullhull
    RENAME libcudart_static.a COMPONENT development)
endif()

set(CULLHULL_HAVE_ZLIB OFF)
set(CULLHULL_HAVE_ZSTD OFF)
if(CULLHULL_BUILD_IO AND TARGET ZLIB::ZLIB)
  set(CULLHULL_HAVE_ZLIB ON)
endif()
if(CULLHULL_BUILD_IO AND TARGET Zstd::zstd)
  set(CULLHULL_HAVE_ZSTD ON)
endif()
configure_package_config_file(cmake/cullhullConfig.cmake.in
  "${CMAKE_CURRENT_BINARY_DIR}/cullhullConfig.cmake" INSTALL_DESTINATION ${_package})
set(_compatibility SameMajorVersion)
if(PROJECT_VERSION_MAJOR EQUAL 0)
  set(_compatibility SameMinorVersion)
endif()
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/cullhullConfigVersion.cmake"
  COMPATIBILITY ${_compatibility})
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/cullhullConfig.cmake"
  "${CMAKE_CURRENT_BINARY_DIR}/cullhullConfigVersion.cmake" cmake/Gmp.cmake
  cmake/Zstd.cmake
  DESTINATION ${_package} COMPONENT development)

file(STRINGS packaging/repository.txt _pc_url)
# pkg-config: static libraries name what they need, the shared one needs nothing.
set(_pc_requires "")
set(_pc_libraries "-lcullhull")
if(NOT CULLHULL_SHARED)
  set(_pc_requires "libhwy gmp")
  if(CULLHULL_BUILD_IO)
    set(_pc_libraries "-lcullhull_io -lcullhull")
    string(APPEND _pc_requires " fmt")
    if(CULLHULL_HAVE_ZLIB)
      string(APPEND _pc_requires " zlib")
    endif()
    if(CULLHULL_HAVE_ZSTD)
      string(APPEND _pc_requires " libzstd")
    endif()
  endif()
  if(CULLHULL_HAVE_CUDA)
    string(APPEND _pc_libraries " -L\${libdir}/cullhull -lcudart_static -lrt -ldl")
  endif()
  string(APPEND _pc_libraries " -pthread")
endif()
file(RELATIVE_PATH _pc_prefix "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" /)
string(REGEX REPLACE "/$" "" _pc_prefix "${_pc_prefix}")
set(_pc_name cullhull)
configure_file(cmake/cullhull.pc.in "${CMAKE_CURRENT_BINARY_DIR}/cullhull.pc" @ONLY)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/cullhull.pc"
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
if(TARGET cullhull_c)
  set(_pc_name cullhull_c)
  set(_pc_requires "")
  set(_pc_libraries "-lcullhull_c")
  configure_file(cmake/cullhull.pc.in "${CMAKE_CURRENT_BINARY_DIR}/cullhull_c.pc" @ONLY)
  install(FILES "${CMAKE_CURRENT_BINARY_DIR}/cullhull_c.pc"
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endif()

if(CULLHULL_BUILD_APPS)
  install(TARGETS cullhull_app RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  if(CULLHULL_BUILD_PAGES)
    include(cmake/Pages.cmake)
  endif()
endif()
if(CULLHULL_SHARED)  # packages of their own, each with its copyright, as Debian wants it
  file(READ LICENSE _license)
  file(READ packaging/THIRD-PARTY.txt _others)
  # Debian has these texts on every system, and wants them named instead of repeated.
  set(_headings Apache-2.0 LGPL-3.0 GPL-3.0 LGPL-2.1)
  set(_files Apache-2.0 LGPL-3 GPL-3 LGPL-2.1)
  foreach(_heading _file IN ZIP_LISTS _headings _files)
    string(FIND "${_others}" "\n==== ${_heading} (" _start)
    string(SUBSTRING "${_others}" ${_start} -1 _rest)
    string(FIND "${_rest}" " ====\n" _end)
    math(EXPR _end "${_start} + ${_end} + 6")
    string(SUBSTRING "${_others}" 0 ${_end} _before)
    string(SUBSTRING "${_others}" ${_end} -1 _rest)
    string(FIND "${_rest}" "\n==== " _next)
    string(SUBSTRING "${_rest}" ${_next} -1 _rest)
    set(_others "${_before}\nThe text is in /usr/share/common-licenses/${_file}.\n${_rest}")
  endforeach()
  file(WRITE "${CMAKE_CURRENT_BINARY_DIR}/copyright" "${_license}\n${_others}")
  foreach(_part IN ITEMS program runtime development)
    set(_package_doc cullhull)
    if(_part STREQUAL "runtime")
      set(_package_doc libcullhull${cullhull_abi})
    elseif(_part STREQUAL "development")
      set(_package_doc libcullhull-dev)
    endif()
    install(FILES "${CMAKE_CURRENT_BINARY_DIR}/copyright" COMPONENT ${_part}
      DESTINATION "${CMAKE_INSTALL_DATAROOTDIR}/doc/${_package_doc}")
  endforeach()
else()
  install(FILES LICENSE packaging/THIRD-PARTY.txt DESTINATION ${CMAKE_INSTALL_DOCDIR}
    COMPONENT program)
endif()
