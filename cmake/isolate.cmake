# cmake -DLIBRARY=... -DLINKER=... -DOBJCOPY=... -DNM=... -DAR=... -P isolate.cmake
# Makes the Eigen functions in a static library its own. Eigen is all inline: a program holds one copy of each function that it
# and the library both compiled, the linker takes either one, and copies compiled with other flags (-march, -fsanitize) get
# their memory from another allocator and expect other alignments. So the objects become one, in which these symbols are local.
foreach(name LIBRARY LINKER OBJCOPY NM AR)
  if(NOT ${name})
    message(FATAL_ERROR "isolate.cmake: ${name} is empty, expected a path")
  endif()
endforeach()
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(code)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "isolate.cmake: ${command}\n${out}")
  endif()
endfunction()

cmake_path(REPLACE_EXTENSION LIBRARY LAST_ONLY o OUTPUT_VARIABLE object)
# Functions of a group may be dropped for the same group elsewhere: local ones must not be in any.
run("${LINKER}" -r --force-group-allocation --whole-archive "${LIBRARY}" -o "${object}")

# Variables that GCC marks as unique in a program may be defined several times in groups only: outside they become weak ones.
execute_process(COMMAND "${NM}" "${object}" OUTPUT_VARIABLE listed COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL " u [^\n]+" unique "${listed}")
list(TRANSFORM unique REPLACE "^ u " "--weaken-symbol=")
if(unique)
  run("${OBJCOPY}" ${unique} "${object}")
endif()

set(symbols "")
foreach(prefix _ZN5Eigen _ZNK5Eigen _ZZN5Eigen _ZZNK5Eigen _ZGVZN5Eigen _ZGVZNK5Eigen _ZGVN5Eigen)
  list(APPEND symbols "--localize-symbol=${prefix}*")
endforeach()
run("${OBJCOPY}" --wildcard ${symbols} "${object}")
file(REMOVE "${LIBRARY}")
run("${AR}" qcs "${LIBRARY}" "${object}")
file(REMOVE "${object}")
