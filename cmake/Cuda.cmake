# The CUDA backend is compiled where it is asked for and left out elsewhere: same API, and asking
# for it is Error{backend_unavailable}. `make test` asks for it wherever nvcc works. The run-time
# library is linked statically and finds the driver when it is first asked, so the programs start on
# machines without one.
set(CULLHULL_WITH_CUDA OFF CACHE STRING "The CUDA backend: OFF, ON or AUTO (where nvcc works)")
set_property(CACHE CULLHULL_WITH_CUDA PROPERTY STRINGS AUTO ON OFF)
# "fat": code for every architecture from sm_75 to sm_120, and PTX for later ones; the preset `cuda`
# builds that. The default is quick to build and still runs everywhere: code for one architecture,
# and PTX that the driver compiles for any other when it is first used.
set(CULLHULL_CUDA_ARCHITECTURES "75-virtual;90-real" CACHE STRING
  "CUDA architectures as CMake writes them, or fat")
set(CULLHULL_HAVE_CUDA OFF)
if(NOT CULLHULL_WITH_CUDA STREQUAL "OFF")
  if(CULLHULL_WITH_CUDA STREQUAL "AUTO")
    # nvcc is often installed where no PATH leads.
    if(NOT CMAKE_CUDA_COMPILER AND NOT DEFINED ENV{CUDACXX})
      find_program(CULLHULL_NVCC nvcc HINTS ENV CUDA_PATH PATHS /usr/local/cuda PATH_SUFFIXES bin)
      mark_as_advanced(CULLHULL_NVCC)
      if(CULLHULL_NVCC)
        set(ENV{CUDACXX} "${CULLHULL_NVCC}")
      endif()
    endif()
    include(CheckLanguage)
    check_language(CUDA)
  endif()
  if(CMAKE_CUDA_COMPILER OR CULLHULL_WITH_CUDA STREQUAL "ON")
    if(CULLHULL_CUDA_ARCHITECTURES STREQUAL "fat")
      set(_architectures 75-real 80-real 86-real 89-real 90-real 100-real 120)
    else()
      set(_architectures ${CULLHULL_CUDA_ARCHITECTURES})
    endif()
    if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
      set(CMAKE_CUDA_ARCHITECTURES "${_architectures}")  # also for the compiler's own check
    endif()
    enable_language(CUDA)
    if(NOT CMAKE_CUDA20_STANDARD_COMPILE_OPTION)  # CMake 3.25 does not know that nvcc 12 has it
      set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION "-std=c++20")
      set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION "-std=c++20")
    endif()
    # FindCUDAToolkit of CMake 3.25 sets a property of this target without asking whether there is
    # one; CUDA 13 no longer has the library.
    if(CMAKE_VERSION VERSION_LESS 3.26 AND NOT TARGET CUDA::nvToolsExt)
      add_library(CUDA::nvToolsExt INTERFACE IMPORTED)
    endif()
    find_package(CUDAToolkit 12.0 REQUIRED)
    set(CULLHULL_HAVE_CUDA ON)
    if(CULLHULL_CCACHE AND NOT CMAKE_CUDA_COMPILER_LAUNCHER)
      set(CMAKE_CUDA_COMPILER_LAUNCHER "${CULLHULL_CCACHE}")
    endif()
  endif()
endif()
message(STATUS "CUDA backend: ${CULLHULL_HAVE_CUDA}")
