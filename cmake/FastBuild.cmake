# What halves the time of a build from nothing, off unless CULLHULL_FAST_BUILD: every source must
# compile alone too, as the other presets see to, and ccache shares more between folders that way.

# cullhull_precompile(TARGET [HEADER...]): the standard headers that most sources include, and those
# named, are compiled once for all sources of TARGET.
function(cullhull_precompile target)
  if(NOT CULLHULL_FAST_BUILD)
    return()
  endif()
  set(stop_token <stop_token>)
  if(EMSCRIPTEN)  # whose C++ library has none (cullhull/stop_token.hpp)
    set(stop_token)
  endif()
  target_precompile_headers(${target} PRIVATE
    <algorithm> <array> <atomic> <bit> <cmath> <cstdint> <cstring> <functional> <limits> <memory>
    <mutex> <numeric> <optional> <span> ${stop_token} <string> <string_view> <thread> <vector>
    ${ARGN})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_LAUNCHER)
    target_compile_options(${target} PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>")
  endif()
endfunction()

# cullhull_precompiled_like(TARGET OTHER): what is precompiled for OTHER serves TARGET as well, whose
# flags must be the same.
function(cullhull_precompiled_like target other)
  if(NOT CULLHULL_FAST_BUILD)
    return()
  endif()
  target_precompile_headers(${target} REUSE_FROM ${other})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_LAUNCHER)
    target_compile_options(${target} PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>")
  endif()
endfunction()

# GCC takes a source that is included for a header, whose classes should not hold local types.
function(cullhull_included_sources target)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    set_target_properties(${target} PROPERTIES UNITY_BUILD_CODE_BEFORE_INCLUDE
      "#pragma GCC diagnostic ignored \"-Wsubobject-linkage\"")
  endif()
endfunction()

# cullhull_in_batches(TARGET): the sources of TARGET are compiled six at a time, whichever they are, so
# that no two of them may define the same name.
function(cullhull_in_batches target)
  if(CULLHULL_FAST_BUILD)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 6)
    cullhull_included_sources(${target})
  endif()
endfunction()

# cullhull_together(TARGET FOLDER NAME... [AND NAME...]...): the sources FOLDER/NAME.cpp between two AND
# are compiled as one, which spares what each would instantiate for itself. Their unnamed namespaces
# become one as well, so they are listed: sources that are not compile alone, and two functions of
# one name and as many parameters in a group must not be.
function(cullhull_together target folder)
  if(NOT CULLHULL_FAST_BUILD)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  string(MAKE_C_IDENTIFIER "${folder}" group)
  foreach(name IN LISTS ARGN)
    if(name STREQUAL "AND")
      string(APPEND group "_")
      continue()
    endif()
    if(NOT EXISTS "${CMAKE_CURRENT_SOURCE_DIR}/${folder}/${name}.cpp")
      message(FATAL_ERROR "there is no ${folder}/${name}.cpp to compile together with others")
    endif()
    set_source_files_properties("${CMAKE_CURRENT_SOURCE_DIR}/${folder}/${name}.cpp"
      TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP "${group}")
  endforeach()
  cullhull_included_sources(${target})
endfunction()
