# The installed files: two libraries (shared and static) made of the folders' objects, the public headers, the program,
# scenes, documents, a CMake package, pkg-config files, and a Debian package (cpack -G DEB).
# The program itself links the folders' libraries: it runs from the build tree without any installation.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(SC_PUBLIC_INCLUDES "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>" "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/plugin/api/include>"
    "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/bridge/box2d/include>" "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")

# sc_ship(NAME LINKS ... FOLDERS ...): NAME (shared) and NAME_static from the objects of the folders' libraries.
function(sc_ship name)
  cmake_parse_arguments(ARG "" "OUTPUT" "LINKS;STATIC_LINKS;FOLDERS" ${ARGN})
  set(objects)
  foreach(folder IN LISTS ARG_FOLDERS)
    get_target_property(kind ${folder} TYPE)
    if(kind STREQUAL "STATIC_LIBRARY") # folders without sources are INTERFACE libraries
      list(APPEND objects $<TARGET_OBJECTS:${folder}>)
    endif()
  endforeach()
  foreach(kind SHARED STATIC)
    set(target sc_ship_${name})
    set(export ${name})
    if(kind STREQUAL "STATIC")
      string(APPEND target _static)
      string(APPEND export _static)
    endif()
    add_library(${target} ${kind} ${objects})
    add_library(supercircle::${export} ALIAS ${target})
    target_include_directories(${target} PUBLIC ${SC_PUBLIC_INCLUDES})
    target_compile_definitions(${target} PUBLIC ${SUPERCIRCLE_EIGEN_DEFINITIONS})
    target_compile_features(${target} PUBLIC cxx_std_20)
    set_target_properties(${target} PROPERTIES OUTPUT_NAME ${ARG_OUTPUT} EXPORT_NAME ${export} LINKER_LANGUAGE CXX
      VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  endforeach()
  # the flags of the sanitizers must reach the link of a shared library, too
  target_link_libraries(sc_ship_${name} PRIVATE $<BUILD_INTERFACE:sc_flags> PUBLIC ${ARG_LINKS})
  target_link_libraries(sc_ship_${name}_static PUBLIC ${ARG_STATIC_LINKS})
endfunction()

sc_ship(supercircle OUTPUT supercircle FOLDERS sc_support sc_rod sc_contact sc_coulomb sc_effects sc_step sc_api sc_scene sc_player)
target_link_libraries(sc_ship_supercircle PRIVATE TBB::tbb Threads::Threads PkgConfig::MUPARSER)
target_link_libraries(sc_ship_supercircle_static PRIVATE TBB::tbb Threads::Threads $<BUILD_INTERFACE:PkgConfig::MUPARSER>
                      $<INSTALL_INTERFACE:PkgConfig::supercircle_MUPARSER>)
sc_ship(box2d OUTPUT supercircle_box2d FOLDERS sc_box2d LINKS sc_ship_supercircle box2d::box2d
        STATIC_LINKS sc_ship_supercircle_static box2d::box2d)

# What a C++ program links, alone: `cmake --build build --target libraries`, `cmake --install build --component libraries`.
add_custom_target(libraries DEPENDS sc_ship_supercircle sc_ship_box2d sc_ship_supercircle_static sc_ship_box2d_static)
install(TARGETS sc_ship_supercircle EXPORT supercircleTargets COMPONENT libraries)
install(TARGETS sc_ship_box2d EXPORT supercircleBox2dTargets COMPONENT libraries)
install(TARGETS sc_ship_supercircle_static sc_ship_box2d_static EXPORT supercircleStaticTargets COMPONENT libraries)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/supercircle)
foreach(export supercircleTargets supercircleBox2dTargets supercircleStaticTargets)
  install(EXPORT ${export} NAMESPACE supercircle:: DESTINATION ${package_dir} COMPONENT libraries)
endforeach()

set(SCENES_DIR ${CMAKE_INSTALL_DATADIR}/supercircle/scenes)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/supercircleConfig.cmake.in
  ${PROJECT_BINARY_DIR}/supercircleConfig.cmake INSTALL_DESTINATION ${package_dir} PATH_VARS SCENES_DIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/supercircleConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/supercircleConfig.cmake ${PROJECT_BINARY_DIR}/supercircleConfigVersion.cmake
  DESTINATION ${package_dir} COMPONENT libraries)
file(RELATIVE_PATH up /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix) # the package may be moved: no absolute paths
string(REGEX REPLACE "/$" "" PC_PREFIX "\${pcfiledir}/${up}")
foreach(pc supercircle supercircle-box2d)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/${pc}.pc.in ${PROJECT_BINARY_DIR}/${pc}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${pc}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT libraries)
endforeach()

install(DIRECTORY ${PROJECT_SOURCE_DIR}/plugin/api/include/ ${PROJECT_SOURCE_DIR}/bridge/box2d/include/
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT libraries FILES_MATCHING PATTERN "*.hpp") # Box2D 3: from the source tree only
# The core's headers, for users of Shells::world(); they need Eigen 3.4.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/supercircle/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/supercircle
  COMPONENT libraries FILES_MATCHING PATTERN "*.h")
install(TARGETS supercircle supercircle-lab supercircle-identify supercircle-view) # the benchmarks need the source tree
# The Python package, where Debian's Python looks for it if the prefix is /usr; it finds the library by the system's loader.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/bridge/python/src/supercircle DESTINATION lib/python3/dist-packages
  FILES_MATCHING PATTERN "*.py" PATTERN "py.typed" PATTERN "__pycache__" EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes/ DESTINATION ${SCENES_DIR} COMPONENT libraries FILES_MATCHING PATTERN "*.json")
install(FILES ${PROJECT_SOURCE_DIR}/plugin/scene/scene.schema.json
  ${PROJECT_SOURCE_DIR}/plugin/lab/sweep/sweep.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/supercircle)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/tests/data/reference/
  DESTINATION ${CMAKE_INSTALL_DATADIR}/supercircle/reference FILES_MATCHING PATTERN "*.csv" PATTERN "README.md")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR})
# Examples that build on the installed package; the games need the source tree.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/embed/hello ${PROJECT_SOURCE_DIR}/examples/embed/hello_scene
        DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)

include(${CMAKE_CURRENT_LIST_DIR}/Package.cmake)
