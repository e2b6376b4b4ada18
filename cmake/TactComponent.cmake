# tact_component(name
#   SOURCES ...        .cpp files; none: a header-only component
#   HEADERS ...        .hpp files; those in cmake/public_headers.txt are installed to include/tact/<path in the project>
#   USES ...           other components, public
#   PUBLIC ...         third-party targets which the headers include
#   DEFINE ...         compile definitions, public
#   PRIVATE ...        third-party targets which only the sources include
#   FIND ...           one string per package, the arguments of its find_package; users of the component look for it too
#   FIND_TO_BUILD ...  the same, for header-only packages behind PRIVATE $<BUILD_INTERFACE:...>: not needed once built
#   INTERNAL)          not installed
#
# makes the static library tact_<name>, alias tact::<name>.
function(tact_component name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "INTERNAL" "" "SOURCES;HEADERS;USES;PUBLIC;DEFINE;PRIVATE;FIND;FIND_TO_BUILD")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "tact_component(${name}): unknown ${arg_UNPARSED_ARGUMENTS}")
  endif()

  foreach(package IN LISTS arg_FIND arg_FIND_TO_BUILD)
    separate_arguments(words UNIX_COMMAND "${package}")
    find_package(${words} REQUIRED)
  endforeach()

  if(arg_SOURCES)
    set(scope PUBLIC)
    add_library(tact_${name} STATIC ${arg_SOURCES} ${arg_HEADERS})
    tact_compile_options(tact_${name})
    target_link_libraries(tact_${name} PRIVATE ${arg_PRIVATE})
  else()
    message(STATUS "tact: component ${name} has no sources yet")
    set(scope INTERFACE)
    add_library(tact_${name} INTERFACE)
  endif()
  add_library(tact::${name} ALIAS tact_${name})
  set_target_properties(tact_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(tact_${name} ${scope} cxx_std_20)
  target_include_directories(tact_${name} ${scope} $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  list(TRANSFORM arg_USES PREPEND tact:: OUTPUT_VARIABLE used)
  target_link_libraries(tact_${name} ${scope} ${used} ${arg_PUBLIC})
  target_compile_definitions(tact_${name} ${scope} ${arg_DEFINE})

  if(arg_INTERNAL)
    return()
  endif()
  set_property(GLOBAL APPEND PROPERTY TACT_COMPONENTS ${name})
  set_property(GLOBAL PROPERTY TACT_${name}_USES "${arg_USES}")
  set_property(GLOBAL PROPERTY TACT_${name}_FIND "${arg_FIND}")
  file(STRINGS "${PROJECT_SOURCE_DIR}/cmake/public_headers.txt" public)
  foreach(header IN LISTS arg_HEADERS)
    cmake_path(RELATIVE_PATH header BASE_DIRECTORY "${PROJECT_SOURCE_DIR}")
    if(NOT header IN_LIST public)
      continue()
    endif()
    cmake_path(GET header PARENT_PATH folder)
    install(FILES "${PROJECT_SOURCE_DIR}/${header}" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/tact/${folder}")
  endforeach()
  install(TARGETS tact_${name} EXPORT tact-${name} ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
  if(arg_SOURCES)
    tact_isolate_installed(tact_${name})
  endif()
  install(EXPORT tact-${name} NAMESPACE tact:: FILE tact-${name}.cmake DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/tact")
endfunction()

# The installed library keeps its Eigen functions to itself (cmake/isolate.cmake); needs GNU's linker and objcopy. Not with
# sanitizers, whose programs are compiled alike.
function(tact_isolate_installed target)
  find_program(TACT_GNU_LINKER NAMES ld.bfd ld)
  if(NOT CMAKE_SYSTEM_NAME STREQUAL "Linux" OR NOT TACT_GNU_LINKER OR NOT CMAKE_OBJCOPY OR NOT CMAKE_NM OR TACT_SANITIZE OR TACT_COVERAGE)
    return()
  endif()
  install(CODE "execute_process(COMMAND \"${CMAKE_COMMAND}\" \"-DLINKER=${TACT_GNU_LINKER}\" \"-DOBJCOPY=${CMAKE_OBJCOPY}\"
    \"-DNM=${CMAKE_NM}\" \"-DAR=${CMAKE_AR}\" \"-DLIBRARY=\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/$<TARGET_FILE_NAME:${target}>\"
    -P \"${PROJECT_SOURCE_DIR}/cmake/isolate.cmake\" COMMAND_ERROR_IS_FATAL ANY)")
endfunction()

# Everything compiled here, component or not. Never -ffast-math: the certificates need infinities, NaN and the order of sums.
function(tact_compile_options target)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Wconversion -Wshadow $<$<BOOL:${TACT_WERROR}>:-Werror> -fno-math-errno
    -Wno-psabi  # vector types are passed between inlined kernels only, never across a compiled boundary
    # GCC 12 takes Eigen's copy of a Vector2d to a Vector, entry by entry up to an aligned one, for longer than it is.
    "$<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow;-Wno-array-bounds>"
    $<$<BOOL:${TACT_NATIVE}>:-march=native>)
  if(TACT_NATIVE AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # Its own AVX-512 intrinsics start from an undefined register; the other presets keep the warning.
    target_compile_options(${target} PRIVATE -Wno-uninitialized -Wno-maybe-uninitialized)
  endif()
  if(TACT_SANITIZE OR TACT_FUZZ)
    set(sanitizers -fsanitize=address,undefined$<$<BOOL:${TACT_FUZZ}>:,fuzzer-no-link> -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_compile_options(${target} PRIVATE ${sanitizers})
    target_link_options(${target} PUBLIC ${sanitizers})
  endif()
  if(TACT_COVERAGE)
    target_compile_options(${target} PRIVATE --coverage)
    target_link_options(${target} PUBLIC --coverage)
  endif()
endfunction()

# tact_files(prefix folders...): the .cpp and .hpp files lying in these folders, in prefix_SOURCES and prefix_HEADERS.
function(tact_files prefix)
  set(sources "")
  set(headers "")
  foreach(folder IN LISTS ARGN)
    cmake_path(ABSOLUTE_PATH folder NORMALIZE)
    cmake_path(APPEND folder "*" OUTPUT_VARIABLE files)
    file(GLOB cpp CONFIGURE_DEPENDS "${files}.cpp")
    file(GLOB hpp CONFIGURE_DEPENDS "${files}.hpp")
    list(APPEND sources ${cpp})
    list(APPEND headers ${hpp})
  endforeach()
  set(${prefix}_SOURCES "${sources}" PARENT_SCOPE)
  set(${prefix}_HEADERS "${headers}" PARENT_SCOPE)
endfunction()

# The package files of find_package(tact), one export per component, so that a user looks only for what a component needs.
function(tact_install_package)
  include(CMakePackageConfigHelpers)
  get_property(components GLOBAL PROPERTY TACT_COMPONENTS)
  set(table "")
  foreach(name IN LISTS components)
    get_property(uses GLOBAL PROPERTY TACT_${name}_USES)
    get_property(find GLOBAL PROPERTY TACT_${name}_FIND)
    string(APPEND table "set(_tact_${name}_USES \"${uses}\")\nset(_tact_${name}_FIND \"${find}\")\n")
  endforeach()
  set(package "${CMAKE_INSTALL_LIBDIR}/cmake/tact")
  configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/tactConfig.cmake.in" "${PROJECT_BINARY_DIR}/tactConfig.cmake"
                                INSTALL_DESTINATION "${package}")
  write_basic_package_version_file("${PROJECT_BINARY_DIR}/tactConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
  install(FILES "${PROJECT_BINARY_DIR}/tactConfig.cmake" "${PROJECT_BINARY_DIR}/tactConfigVersion.cmake"
                "${PROJECT_SOURCE_DIR}/cmake/FindSuiteSparse.cmake" "${PROJECT_SOURCE_DIR}/cmake/FindSerialHDF5.cmake"
          DESTINATION "${package}")
endfunction()
