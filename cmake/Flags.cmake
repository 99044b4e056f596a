# Floating-point policy and warnings, on one interface target that all our code links privately.
add_library(cullhull_flags INTERFACE)
# Error-free transformations and derived bounds need every operation rounded once, as written.
# For device code that is -fmad=false; division, roots and subnormal numbers are exact by default.
set(_cxx "$<COMPILE_LANGUAGE:CXX>")
set(_cuda "$<COMPILE_LANGUAGE:CUDA>")
if(MSVC)  # cl and clang-cl
  set(_exact /fp:precise /bigobj /Zc:__cplusplus /DNOMINMAX)  # cl contracts under /fp:contract alone
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    list(APPEND _exact /clang:-ffp-contract=off)
  endif()
  set(_warnings /W4)
  set(_errors /WX)
else()
  set(_exact -ffp-contract=off -fno-fast-math)
  # GCC spills vectors of 32 and 64 bytes by moves that want them aligned, to a stack that Windows
  # aligns to 16 bytes alone (GCC's bug 54412): the assembler writes moves that do not.
  if(MINGW AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    list(APPEND _exact -Wa,-muse-unaligned-vector-move)
  endif()
  set(_warnings -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion)
  if(EMSCRIPTEN)  # counts have 64 bits, sizes 32: allocations fail before a count is cut off
    list(APPEND _warnings -Wno-shorten-64-to-32 -Wno-c++11-narrowing)
  endif()
  set(_errors -Werror)
endif()
target_compile_options(cullhull_flags INTERFACE
  "$<${_cxx}:${_exact}>"
  "$<${_cuda}:-fmad=false;--expt-relaxed-constexpr;-Xcompiler=-ffp-contract=off,-fno-fast-math>")
target_compile_options(cullhull_flags INTERFACE
  "$<${_cxx}:${_warnings}>"
  "$<${_cuda}:-Xcompiler=-Wall,-Wextra;-Wno-deprecated-gpu-targets>"
  # No kernel of ours keeps anything in a thread's memory: all of it fits into registers.
  "$<${_cuda}:-Xptxas=-warn-spills,-warn-lmem-usage>")
target_compile_definitions(cullhull_flags INTERFACE CULLHULL_OWN_SOURCES)  # cullhull/hull_fwd.hpp
if(CULLHULL_WERROR)
  target_compile_options(cullhull_flags INTERFACE
    "$<${_cxx}:${_errors}>" "$<${_cuda}:-Werror=all-warnings;-Xptxas=-Werror>")
endif()
if(CULLHULL_SANITIZE)
  # Host code of .cu files only launches kernels: nvcc would need other words for these flags.
  add_compile_options("$<$<NOT:${_cuda}>:-fsanitize=${CULLHULL_SANITIZE}>"
    "$<$<NOT:${_cuda}>:-fno-omit-frame-pointer>" "$<$<NOT:${_cuda}>:-fno-sanitize-recover=all>")
  add_link_options(-fsanitize=${CULLHULL_SANITIZE})
  # clang's thread sanitizer brings operators new and delete, which some tests replace to count.
  if(CULLHULL_SANITIZE MATCHES "thread" AND CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    add_link_options(LINKER:-z,muldefs)
  endif()
endif()

# A library of which nothing is used is not loaded: Highway's, in whose place
# src/parallel/simd_targets.cpp chooses instruction sets on x86-64.
if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
  add_link_options(LINKER:--as-needed)
endif()
