# CPack runs this on the folders that are to become packages: man pages and changelog compressed, as
# Debian wants them, and every time that of SOURCE_DATE_EPOCH, so that two builds give the same
# bytes. CPack sets CPACK_TEMPORARY_DIRECTORY, with a folder for each package.
set(epoch "$ENV{SOURCE_DATE_EPOCH}")
if(epoch STREQUAL "")
  string(TIMESTAMP epoch "%s" UTC)
endif()
set(ENV{SOURCE_DATE_EPOCH} "${epoch}")
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)

set(changelog "cullhull (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium

  * ${CPACK_PACKAGE_HOMEPAGE_URL}/blob/v${CPACK_PACKAGE_VERSION}/CHANGELOG.md

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
file(GLOB documents "${CPACK_TEMPORARY_DIRECTORY}/*/usr/share/doc/*")
foreach(folder IN LISTS documents)
  file(WRITE "${folder}/changelog" "${changelog}")
  # scripts/artifacts.sh links zlib and zstd statically, so that one package serves every Debian.
  get_filename_component(package "${folder}" NAME)
  file(WRITE "${folder}/../../lintian/overrides/${package}" "${package}: embedded-library\n")
endforeach()
file(GLOB texts "${CPACK_TEMPORARY_DIRECTORY}/*/usr/share/man/man*/*.[17]"
  "${CPACK_TEMPORARY_DIRECTORY}/*/usr/share/doc/*/changelog")
if(texts)
  execute_process(COMMAND gzip -9nf ${texts} COMMAND_ERROR_IS_FATAL ANY)
endif()
execute_process(COMMAND find "${CPACK_TEMPORARY_DIRECTORY}" -exec touch -h -d "@${epoch}" {} +
  COMMAND_ERROR_IS_FATAL ANY)
