# Man pages and completions for shells, which the program prints itself.
set(_pages "${CMAKE_CURRENT_BINARY_DIR}/pages")
add_custom_command(OUTPUT "${_pages}/done"
  COMMAND "$<TARGET_FILE:cullhull_app>" man --folder "${_pages}"
  COMMAND "$<TARGET_FILE:cullhull_app>" completion bash > "${_pages}/cullhull.bash"
  COMMAND "$<TARGET_FILE:cullhull_app>" completion fish > "${_pages}/cullhull.fish"
  COMMAND "$<TARGET_FILE:cullhull_app>" completion zsh > "${_pages}/_cullhull"
  COMMAND "${CMAKE_COMMAND}" -E touch "${_pages}/done"
  DEPENDS cullhull_app VERBATIM)
add_custom_target(cullhull_pages ALL DEPENDS "${_pages}/done")
install(DIRECTORY "${_pages}/man1" "${_pages}/man7" DESTINATION ${CMAKE_INSTALL_MANDIR}
  COMPONENT program)
install(FILES "${_pages}/cullhull.bash" RENAME cullhull
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
install(FILES "${_pages}/cullhull.fish"
  DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)
install(FILES "${_pages}/_cullhull"
  DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)
