# cmake -DBUILD=... -DFOLDER=... -DCOMPILER=... -DGENERATOR=... -DCOMPONENTS=... -P run.cmake
# Installs the library into FOLDER, then builds and runs the project beside this file against it.
cmake_minimum_required(VERSION 3.25)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(code)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\n${out}")
  endif()
endfunction()

# configure(name components without...): the project asking for these components, on a machine without these packages.
macro(configure name components)
  set(command "${CMAKE_COMMAND}" -G ${GENERATOR} -S "${CMAKE_CURRENT_LIST_DIR}" -B "${FOLDER}/${name}"
              "-DCMAKE_CXX_COMPILER=${COMPILER}" "-DCMAKE_PREFIX_PATH=${FOLDER}/prefix")
  foreach(package ${ARGN})
    list(APPEND command -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
  endforeach()
  execute_process(COMMAND ${command} "-DCOMPONENTS=${components}"
                  RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
endmacro()

function(build_and_run name components)
  configure(${name} "${components}" ${ARGN})
  if(code)
    message(FATAL_ERROR "configuring for ${components}\n${output}")
  endif()
  run("${CMAKE_COMMAND}" --build "${FOLDER}/${name}" --parallel 2)
  file(STRINGS "${FOLDER}/${name}/programs.txt" programs)
  foreach(program IN LISTS programs)
    run("${FOLDER}/${name}/${program}")
  endforeach()
  foreach(component IN LISTS components)
    run("${FOLDER}/${name}/links_${component}")
  endforeach()
endfunction()

string(REPLACE "," ";" COMPONENTS "${COMPONENTS}")
file(REMOVE_RECURSE "${FOLDER}")
run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${FOLDER}/prefix")

# What the archives themselves say: no Eigen function is left for a program to take or replace, and no message prints a double
# by std::to_string, which makes 0.000000 of 1e-7 (shown() is for that).
find_program(NM nm)
file(GLOB_RECURSE archives "${FOLDER}/prefix/*.a")
if(NM)
  foreach(archive IN LISTS archives)
    execute_process(COMMAND "${NM}" "${archive}" OUTPUT_VARIABLE symbols ERROR_QUIET)
    if(symbols MATCHES " [WVuTBD] (_Z+(GVZ*)?NK?5Eigen[^\n]*)")
      message(FATAL_ERROR "${archive} shares ${CMAKE_MATCH_1} with whoever links it")
    endif()
    if(symbols MATCHES "__to_xstring")
      message(FATAL_ERROR "${archive}: a message holds std::to_string of a double, expected shown()")
    endif()
  endforeach()
endif()

# A reduced run needs Eigen only.
build_and_run(reduced "core;contact_dense;rom" SUNDIALS SuiteSparse GSL SerialHDF5 nlohmann_json GTest)
build_and_run(all "${COMPONENTS}")

build_and_run(front "tact" GSL SerialHDF5 nlohmann_json GTest)
configure(refused "contact" SuiteSparse)
if(NOT code OR NOT output MATCHES "SuiteSparse")
  message(FATAL_ERROR "a missing SuiteSparse is not named:\n${output}")
endif()
