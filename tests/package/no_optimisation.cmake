# Fails unless COMMANDS, a compile_commands.json, compiles the library and its tests, and every source
# without optimisation.
file(STRINGS "${COMMANDS}" commands REGEX "\"command\":")
foreach(part "/src/result/" "/src/certify/" "/tests/exactness/")
  if(NOT commands MATCHES "${part}")
    message(FATAL_ERROR "${COMMANDS} has no command for ${part}")
  endif()
endforeach()
foreach(command IN LISTS commands)
  if(command MATCHES " -O[^0]" OR command MATCHES " [-/]O[12xs] ")
    message(FATAL_ERROR "compiled with optimisation: ${command}")
  endif()
endforeach()
