# Every dependency is named, with its reason, in docs/dependencies.md.
find_package(hwy REQUIRED)
find_package(Threads REQUIRED)
include("${CMAKE_CURRENT_LIST_DIR}/Gmp.cmake")
if(CULLHULL_WITH_QHULL)
  find_package(Qhull CONFIG QUIET)
endif()
if(CULLHULL_BUILD_IO)
  find_package(fmt REQUIRED)
  find_package(nlohmann_json REQUIRED)
  find_package(FastFloat REQUIRED)
  find_package(ZLIB)  # .gz and deflated .npz; without it one line says what reads them
  include("${CMAKE_CURRENT_LIST_DIR}/Zstd.cmake")
endif()
