# cmake -DBUILD=... -DSOURCE=... -DWORK=... -DGENERATOR=... -DCOMPILER=... -P run.cmake
# Installs the project into an empty folder, then configures, builds and runs a project that uses it.
function(step what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${what} failed (${code}):\n${out}")
  endif()
  set(out "${out}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
# The libraries alone, as the tutorial installs them: a program finds and links them.
step("installing the libraries" ${CMAKE_COMMAND} --install ${BUILD} --component libraries --prefix ${WORK}/libraries)
step("configuring the tutorial's program" ${CMAKE_COMMAND} -S ${SOURCE}/../../examples/embed/hello -B ${WORK}/hello -G ${GENERATOR}
     -DCMAKE_PREFIX_PATH=${WORK}/libraries -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_CXX_FLAGS=${FLAGS})
step("building it" ${CMAKE_COMMAND} --build ${WORK}/hello)
step("running it" ${WORK}/hello/hello)

step("installing" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
step("configuring" ${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${WORK}/prefix
     -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS=${FLAGS}
     -DEXAMPLES_DIR=${WORK}/prefix/share/doc/supercircle/examples)
step("building" ${CMAKE_COMMAND} --build ${WORK}/build)
foreach(program consumer_box2d consumer_box2d_static shells_only core_headers_supercircle core_headers_supercircle_static
        program_c program_cpp hello/hello)
  step("running ${program}" ${WORK}/build/${program})
endforeach()
step("hello_scene" ${WORK}/build/hello_scene/hello_scene ${WORK}/prefix/share/supercircle/scenes/ramp.json time=0.1)
# The installed program finds its files from any folder.
step("the installed program" ${CMAKE_COMMAND} -E chdir ${WORK} ${WORK}/prefix/bin/supercircle check
     ${WORK}/prefix/share/supercircle/scenes/ramp.json)
# The Python package, by the system's loader.
find_program(SYSTEM_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
if(SYSTEM_PYTHON)
  step("Python" ${CMAKE_COMMAND} -E chdir ${WORK} ${CMAKE_COMMAND} -E env --unset=SUPERCIRCLE_LIBRARY LD_LIBRARY_PATH=${LIBRARIES}
       PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=${WORK}/prefix/lib/python3/dist-packages ${SYSTEM_PYTHON} -c
       "import supercircle as sc, sys\nsys.exit(sc.library_path() != 'libsupercircle_c.so.0' or sc.run('${WORK}/prefix/share/supercircle/scenes/two_shells.json').status != 'done')")
endif()
# pkg-config: the same program by hand.
find_program(PKG_CONFIG pkg-config)
if(PKG_CONFIG)
  set(ENV{PKG_CONFIG_PATH} ${LIBRARIES}/pkgconfig)
  step("pkg-config" ${PKG_CONFIG} --cflags --libs supercircle-box2d)
  separate_arguments(flags UNIX_COMMAND "${out}")
  step("compiling with pkg-config" ${COMPILER} -std=c++20 ${SOURCE}/../../examples/embed/hello/main.cpp -o ${WORK}/hello_pc ${flags}
       -Wl,-rpath,${LIBRARIES})
  step("running it" ${WORK}/hello_pc)
  step("pkg-config" ${PKG_CONFIG} --cflags --libs supercircle_c supercircle_lab_c)
  separate_arguments(flags UNIX_COMMAND "${out}")
  find_program(CC NAMES cc gcc clang REQUIRED)
  step("compiling C with pkg-config" ${CC} -std=c99 -pedantic -Wall -Wextra -Werror -DWITH_LAB ${SOURCE}/program.c -o ${WORK}/program_pc ${flags}
       -lm -Wl,-rpath,${LIBRARIES})
  step("running it" ${WORK}/program_pc)
endif()
