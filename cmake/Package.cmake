# CPack: three Debian packages (scripts/artifacts.sh deb).
file(STRINGS "${PROJECT_SOURCE_DIR}/packaging/repository.txt" CPACK_PACKAGE_HOMEPAGE_URL)
set(CPACK_PACKAGE_NAME cullhull)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The cullhull authors <cullhull@users.noreply.github.com>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_PRE_BUILD_SCRIPTS "${PROJECT_SOURCE_DIR}/packaging/deb/finish.cmake")
set(CPACK_COMPONENTS_ALL program runtime development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION math)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME cullhull)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME libcullhull${cullhull_abi})
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA "${PROJECT_SOURCE_DIR}/packaging/deb/triggers")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libcullhull-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libcullhull${cullhull_abi} (= ${PROJECT_VERSION})")
set(_about "cullhull computes convex hulls, Delaunay triangulations, Voronoi
diagrams and alpha shapes with exact predicates. It first discards every
point that is provably inside the hull, as fast as memory can be read.")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "${_about}
.
This package has the program cullhull, which reads files of points.")
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "${_about}
.
This package has the shared library.")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "${_about}
.
This package has the headers, a CMake package and a pkg-config file.")
include(CPack)
