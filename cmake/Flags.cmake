# Floating-point policy and warnings, on one interface target that all our code links privately.
add_library(cullhull_flags INTERFACE)
# Error-free transformations and derived bounds need every operation rounded once, as written.
target_compile_options(cullhull_flags INTERFACE -ffp-contract=off -fno-fast-math)
target_compile_options(cullhull_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
  -Wno-sign-conversion)
if(CULLHULL_WERROR)
  target_compile_options(cullhull_flags INTERFACE -Werror)
endif()
if(CULLHULL_SANITIZE)
  add_compile_options(-fsanitize=${CULLHULL_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${CULLHULL_SANITIZE})
endif()
