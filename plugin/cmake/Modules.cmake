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
  target_precompile_headers(${name} PRIVATE <Eigen/Core> <Eigen/Cholesky> <algorithm> <array> <cmath> <cstdint>
    <cstdio> <functional> <limits> <map> <memory> <optional> <string> <string_view> <utility> <vector>)
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

# sc_module(NAME FOLDER [LINKS ...] [PRIVATE ...]): library NAME of all sources under FOLDER. LINKS are visible to whoever
# links it, PRIVATE libraries are not.
function(sc_module name folder)
  cmake_parse_arguments(ARG "" "" "LINKS;PRIVATE" ${ARGN})
  sc_glob(sources ${PROJECT_SOURCE_DIR}/${folder}/*.cpp)
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.h ${PROJECT_SOURCE_DIR}/${folder}/*.hpp)
  add_library(${name} STATIC ${sources})
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_include_directories(${name} SYSTEM PUBLIC ${EIGEN3_INCLUDE_DIRS})
  target_link_libraries(${name} PRIVATE sc_flags ${ARG_PRIVATE} PUBLIC ${ARG_LINKS})
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  set_property(TARGET ${name} PROPERTY SC_FILES ${sources} ${headers})
  if(SUPERCIRCLE_PRECOMPILE)
    target_precompile_headers(${name} REUSE_FROM sc_precompiled_libraries)
  endif()
endfunction()

# sc_headers_alone(): target `headers_alone`, which compiles each header by itself and without the precompiled ones, so
# that a missing #include is found. Not part of `all`; .ci/run builds it.
function(sc_headers_alone)
  sc_glob(headers ${PROJECT_SOURCE_DIR}/supercircle/*.h ${PROJECT_SOURCE_DIR}/bridge/box2d/*.h ${PROJECT_SOURCE_DIR}/bridge/box2d/*.hpp
          ${PROJECT_SOURCE_DIR}/plugin/*.h ${PROJECT_SOURCE_DIR}/plugin/*.hpp)
  set(sources)
  foreach(header ${headers})
    file(RELATIVE_PATH path ${PROJECT_SOURCE_DIR} ${header})
    string(MAKE_C_IDENTIFIER ${path} name)
    set(source ${PROJECT_BINARY_DIR}/headers_alone/${name}.cpp)
    file(CONFIGURE OUTPUT ${source} CONTENT "#include \"${path}\"\n#include \"${path}\"\n")
    list(APPEND sources ${source})
  endforeach()
  add_library(headers_alone OBJECT EXCLUDE_FROM_ALL ${sources})
  target_link_libraries(headers_alone PRIVATE sc_flags sc_box2d sc_graphics nlohmann_json::nlohmann_json CLI11::CLI11 PkgConfig::CAIRO)
  target_compile_options(headers_alone PRIVATE -O0 -Wno-unused)
endfunction()
