# Modules: a folder with sources is one static library. Its links are the only dependencies; tests/architecture checks
# the #include lines as well.

# sc_glob(VARIABLE [FLAT] PATTERN...): the files that match, without FLAT in sub-folders too. No match is an error: a folder that was
# moved must not become an empty library in silence.
function(sc_glob variable)
  cmake_parse_arguments(ARG "FLAT" "" "" ${ARGN})
  if(ARG_FLAT)
    file(GLOB found CONFIGURE_DEPENDS ${ARG_UNPARSED_ARGUMENTS})
  else()
    file(GLOB_RECURSE found CONFIGURE_DEPENDS ${ARG_UNPARSED_ARGUMENTS})
  endif()
  if(NOT found)
    message(FATAL_ERROR "no file matches ${ARGN}")
  endif()
  set(${variable} ${found} PARENT_SCOPE)
endfunction()

include(${CMAKE_CURRENT_LIST_DIR}/EmbedText.cmake)

# Headers that most sources read are compiled once; every library reuses the result. The sources of programs, which read
# arguments and write results once, are optimised less and have their own: a precompiled header brings back the level of
# optimisation it was made with.
set(SUPERCIRCLE_PROGRAM_OPTIMISATION $<$<NOT:$<CONFIG:Debug>>:-O1>)
function(sc_precompiled name)
  add_library(${name} OBJECT ${PROJECT_SOURCE_DIR}/plugin/cmake/precompiled.cpp)
  target_link_libraries(${name} PRIVATE sc_flags)
  target_compile_options(${name} PRIVATE ${ARGN})
  target_include_directories(${name} SYSTEM PRIVATE ${EIGEN3_INCLUDE_DIRS})
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_precompile_headers(${name} PRIVATE <Eigen/Core> <Eigen/Cholesky> <algorithm> <array> <atomic> <chrono> <cmath> <cstdint>
    <cstdio> <deque> <filesystem> <fstream> <functional> <limits> <map> <memory> <mutex> <numeric> <optional> <set> <span> <sstream>
    <string> <string_view> <tuple> <utility> <variant> <vector>)
endfunction()
if(SUPERCIRCLE_PRECOMPILE)
  sc_precompiled(sc_precompiled_libraries)
  sc_precompiled(sc_precompiled_programs ${SUPERCIRCLE_PROGRAM_OPTIMISATION})
endif()

# sc_precompile(TARGET): the target reuses the precompiled headers, which are compiled for position-independent code.
function(sc_precompile target)
  if(SUPERCIRCLE_PRECOMPILE)
    target_compile_options(${target} PRIVATE -fPIC)
    target_precompile_headers(${target} REUSE_FROM sc_precompiled_libraries)
  endif()
endfunction()

# sc_program_sources(TARGET): the same for the sources of programs.
function(sc_program_sources target)
  target_compile_options(${target} PRIVATE ${SUPERCIRCLE_PROGRAM_OPTIMISATION})
  if(SUPERCIRCLE_PRECOMPILE)
    target_compile_options(${target} PRIVATE -fPIC)
    target_precompile_headers(${target} REUSE_FROM sc_precompiled_programs)
  endif()
endfunction()

# sc_batch(TARGET SOURCE...): sources of one folder are compiled several at a time, because most of a source's time goes into
# the headers it shares with its neighbours. Names in anonymous namespaces differ within a folder therefore.
# SUPERCIRCLE_BATCH files make one. Half as many cost the compiler 17 % more time, twice as many save 7 %, and an edit
# compiles more (decision 0232). 1: each by itself, as the web build and packages are compiled.
function(sc_batch target)
  if(SUPERCIRCLE_BATCH LESS 2)
    return()
  endif()
  foreach(source ${ARGN})
    file(STRINGS ${source} directives REGEX "^using namespace ") # of one file would be in force in the next one
    string(MD5 directives "${directives}")
    string(SUBSTRING ${directives} 0 4 directives)
    cmake_path(GET source PARENT_PATH folder)
    cmake_path(ABSOLUTE_PATH folder BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
    string(MAKE_C_IDENTIFIER "${folder}_${directives}" key)
    if(NOT DEFINED count_${key})
      set(count_${key} 0)
    endif()
    math(EXPR batch "${count_${key}} / ${SUPERCIRCLE_BATCH}")
    math(EXPR count_${key} "${count_${key}} + 1")
    set_property(SOURCE ${source} PROPERTY UNITY_GROUP ${key}_${batch})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # g++ takes what an included source defines for a header's.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()

# sc_module(NAME FOLDER [FLAT] [COLD] [LINKS ...] [PRIVATE ...]): library NAME of all sources under FOLDER, with FLAT of those in the
# folder itself. LINKS are visible to whoever links it, PRIVATE libraries are not. COLD: its time is spent in the modules that it
# calls, so it is optimised as programs are.
function(sc_module name folder)
  cmake_parse_arguments(ARG "FLAT;COLD" "" "LINKS;PRIVATE" ${ARGN})
  if(ARG_FLAT)
    sc_glob(sources FLAT ${PROJECT_SOURCE_DIR}/${folder}/*.cpp)
  else()
    sc_glob(sources ${PROJECT_SOURCE_DIR}/${folder}/*.cpp)
  endif()
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.h ${PROJECT_SOURCE_DIR}/${folder}/*.hpp)
  add_library(${name} STATIC ${sources})
  sc_batch(${name} ${sources})
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_include_directories(${name} SYSTEM PUBLIC ${EIGEN3_INCLUDE_DIRS})
  target_link_libraries(${name} PRIVATE sc_flags ${ARG_PRIVATE} PUBLIC ${ARG_LINKS})
  if(NOT EMSCRIPTEN) # one module: addresses through tables would make it larger and slower
    set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  endif()
  set_property(TARGET ${name} PROPERTY SC_FILES ${sources} ${headers})
  if(ARG_COLD AND NOT EMSCRIPTEN) # the web build has its own levels
    sc_program_sources(${name})
  elseif(SUPERCIRCLE_PRECOMPILE)
    target_precompile_headers(${name} REUSE_FROM sc_precompiled_libraries)
  endif()
endfunction()

# sc_brought(HEADER): the expensive headers that this one of ours includes by itself or through ours, as the global property
# SC_BROUGHT_<path>. A header with an #include below its first namespace counts as one that brings none. More headers here
# make more groups: with our own ones among them, 24 precompiled headers cost more than they save.
set(SUPERCIRCLE_EXPENSIVE_HEADERS Eigen/Core string vector optional)
function(sc_brought header)
  get_property(known GLOBAL PROPERTY SC_BROUGHT_${header} SET)
  if(known)
    return()
  endif()
  set_property(GLOBAL PROPERTY SC_BROUGHT_${header} "") # of headers that include each other
  file(READ ${header} text)
  string(FIND "${text}" "\nnamespace " namespace)
  string(FIND "${text}" "\n#include " include REVERSE)
  if(include GREATER namespace)
    return()
  endif()
  get_filename_component(folder ${header} DIRECTORY)
  set(brought)
  file(STRINGS ${header} lines REGEX "^#include ")
  foreach(line ${lines})
    string(REGEX REPLACE "^#include [<\"]([^>\"]+)[>\"].*" "\\1" name "${line}")
    if(line MATCHES "<" AND name IN_LIST SUPERCIRCLE_EXPENSIVE_HEADERS)
      list(APPEND brought ${name})
    endif()
    foreach(file ${folder}/${name} ${PROJECT_SOURCE_DIR}/${name})
      if(line MATCHES "\"" AND EXISTS ${file})
        sc_brought(${file})
        get_property(more GLOBAL PROPERTY SC_BROUGHT_${file})
        list(APPEND brought ${more})
        break()
      endif()
    endforeach()
  endforeach()
  list(REMOVE_DUPLICATES brought)
  list(SORT brought)
  set_property(GLOBAL PROPERTY SC_BROUGHT_${header} "${brought}")
endfunction()

# sc_first_includes(VARIABLE SOURCE...): the headers that these sources include before all others, as paths from the root.
function(sc_first_includes variable)
  set(found)
  foreach(source ${ARGN})
    file(STRINGS ${source} line REGEX "^#include " LIMIT_COUNT 1)
    if(line MATCHES "^#include \"([^\"]+)\"")
      list(APPEND found ${CMAKE_MATCH_1})
    endif()
  endforeach()
  set(${variable} ${found} PARENT_SCOPE)
endfunction()

# sc_headers_alone(): target `headers_alone`, which compiles headers by themselves, without the precompiled ones of the
# libraries, so that a missing #include is found. A header that a source includes first is compiled by that source; what
# precompiled headers hide of it, tests/architecture finds in its text. Headers that bring the same expensive headers
# share these precompiled: a header sees nothing that it does not bring. Not part of `all`; .ci/run builds it.
function(sc_headers_alone)
  sc_glob(headers ${PROJECT_SOURCE_DIR}/supercircle/*.h ${PROJECT_SOURCE_DIR}/bridge/box2d/*.h ${PROJECT_SOURCE_DIR}/bridge/box2d/*.hpp
          ${PROJECT_SOURCE_DIR}/bridge/c/*.h ${PROJECT_SOURCE_DIR}/plugin/*.h ${PROJECT_SOURCE_DIR}/plugin/*.hpp)
  sc_glob(sources ${PROJECT_SOURCE_DIR}/supercircle/*.cpp ${PROJECT_SOURCE_DIR}/bridge/box2d/*.cpp ${PROJECT_SOURCE_DIR}/bridge/c/*.cpp
          ${PROJECT_SOURCE_DIR}/plugin/*.cpp)
  sc_first_includes(compiled ${sources})
  set(groups)
  foreach(header ${headers})
    file(RELATIVE_PATH path ${PROJECT_SOURCE_DIR} ${header})
    if(path IN_LIST compiled)
      continue()
    endif()
    string(MAKE_C_IDENTIFIER ${path} name)
    set(source ${PROJECT_BINARY_DIR}/headers_alone/${name}.cpp)
    file(CONFIGURE OUTPUT ${source} CONTENT "#include \"${path}\"\n#include \"${path}\"\n")
    sc_brought(${header})
    get_property(brought GLOBAL PROPERTY SC_BROUGHT_${header})
    string(MAKE_C_IDENTIFIER "headers_alone_${brought}" group)
    list(APPEND groups ${group})
    list(APPEND sources_${group} ${source})
    set(brought_${group} ${brought})
  endforeach()
  list(REMOVE_DUPLICATES groups)
  add_custom_target(headers_alone DEPENDS ${groups})
  foreach(group ${groups})
    add_library(${group} OBJECT EXCLUDE_FROM_ALL ${sources_${group}})
    target_link_libraries(${group} PRIVATE sc_flags sc_box2d sc_graphics nlohmann_json::nlohmann_json CLI11::CLI11 PkgConfig::CAIRO)
    target_compile_options(${group} PRIVATE -O0 -Wno-unused)
    list(LENGTH sources_${group} count)
    if(brought_${group} AND count GREATER 3)
      list(TRANSFORM brought_${group} REPLACE "^(.+)$" "<\\1>")
      target_precompile_headers(${group} PRIVATE ${brought_${group}})
    endif()
  endforeach()
endfunction()
