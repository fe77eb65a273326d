# What sc_diagnosis needs besides its own folder, in a native build and in that of the page alike.

# Quantiles in double, as everywhere: Boost would take long double, which has other digits on each kind of processor, and
# fails while the library is loaded where it has those of double, as under valgrind.
set(SC_QUANTILES_IN_DOUBLE BOOST_MATH_PROMOTE_DOUBLE_POLICY=false)
target_compile_definitions(sc_diagnosis PRIVATE ${SC_QUANTILES_IN_DOUBLE})

# Runs that a diagnosis keeps are those of one simulator: a checksum of its sources goes into their key, of what reads
# descriptions and of what makes effects out of a fit's numbers too. The lists are those of the libraries themselves.
set(stamp_script ${CMAKE_CURRENT_LIST_DIR}/SimulatorStamp.cmake)
set(simulator_files)
foreach(module sc_support sc_rod sc_contact sc_coulomb sc_effects sc_step sc_scene sc_experiment sc_replay)
  get_property(files TARGET ${module} PROPERTY SC_FILES)
  if(NOT files)
    message(FATAL_ERROR "the stamp of the simulator: ${module} has no files")
  endif()
  list(APPEND simulator_files ${files})
endforeach()
get_property(files TARGET sc_diagnosis PROPERTY SC_FILES)
list(FILTER files INCLUDE REGEX "/(candidate_builder|candidate_effects|own_law|replay_model)\\.(h|cpp)$")
list(LENGTH files count)
if(NOT count EQUAL 8)
  message(FATAL_ERROR "the stamp of the simulator: expected 8 files of the diagnosis, found ${count}")
endif()
list(APPEND simulator_files ${files})
string(REPLACE ";" "|" simulator_list "${simulator_files}")
add_custom_command(OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/simulator_stamp.cpp
  COMMAND ${CMAKE_COMMAND} "-DFILES=${simulator_list}" -DOUT=${CMAKE_CURRENT_BINARY_DIR}/simulator_stamp.cpp
          -P ${stamp_script}
  DEPENDS ${simulator_files} ${stamp_script} VERBATIM)
target_sources(sc_diagnosis PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/simulator_stamp.cpp)
