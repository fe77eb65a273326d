# Plays SCRIPT on level LEVEL of PROGRAM twice: it must end as END says, and both times in the same state.
foreach(turn 1 2)
  execute_process(COMMAND ${PROGRAM} ${LEVEL} --headless --script ${SCRIPT} --expect ${END} RESULT_VARIABLE code
                  OUTPUT_VARIABLE said${turn} ERROR_VARIABLE complained)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "exit code ${code}: ${said${turn}}${complained}")
  endif()
endforeach()
if(NOT said1 STREQUAL said2)
  message(FATAL_ERROR "two plays of one script differ: ${said1}${said2}")
endif()
message(STATUS "${said1}")
