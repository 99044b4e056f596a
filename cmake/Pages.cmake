# Man pages and completions for shells, made of what the program says of itself.
find_package(Python3 COMPONENTS Interpreter REQUIRED)
set(_pages "${CMAKE_CURRENT_BINARY_DIR}/pages")
add_custom_command(OUTPUT "${_pages}/done"
  COMMAND "${Python3_EXECUTABLE}" "${PROJECT_SOURCE_DIR}/scripts/program-pages.py"
    "$<TARGET_FILE:cullhull_app>" "${_pages}"
  COMMAND "${CMAKE_COMMAND}" -E touch "${_pages}/done"
  DEPENDS cullhull_app "${PROJECT_SOURCE_DIR}/scripts/program-pages.py" VERBATIM)
add_custom_target(cullhull_pages ALL DEPENDS "${_pages}/done")
install(DIRECTORY "${_pages}/man1" "${_pages}/man7" DESTINATION ${CMAKE_INSTALL_MANDIR}
  COMPONENT program)
install(FILES "${_pages}/cullhull.bash" RENAME cullhull
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
install(FILES "${_pages}/cullhull.fish"
  DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)
install(FILES "${_pages}/_cullhull"
  DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)
