# cpack -G DEB: one package with program, libraries, headers and scenes. What programs and shared libraries need at run
# time is found by dpkg-shlibdeps; what a compiler needs on top is named here. .ci/package does all of it.
set(CPACK_PACKAGE_NAME supercircle)
set(CPACK_PACKAGE_VENDOR "Supercircle")
set(CPACK_PACKAGE_CONTACT "Supercircle <dev@supercircle.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Flexible open shells for Box2D, and a laboratory for them")
set(CPACK_PACKAGE_DESCRIPTION "Flexible open shells (inextensible elastic rods of circular arcs) with exact Coulomb
friction in 2D: a C++20 library for Box2D 2.4.1 worlds, and the program
supercircle, which drops, squeezes and measures them. C interface and Python
package included.")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_GENERATOR DEB)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libbox2d-dev (>= 2.4.1), libbox2d-dev (<< 2.4.2~)")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libeigen3-dev (>= 3.4), python3-numpy")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libtbb-dev, libmuparser-dev, cmake, pkg-config")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
include(CPack)
