# Text files (CSS, JavaScript, HTML) as constants of a library, so that pages are self-contained and their parts are
# edited as files.
#
# sc_embed(TARGET NAMESPACE FILE...): adds to TARGET a generated source that defines, for every FILE (relative to the
# current folder), a `const std::string_view` in `supercircle::NAMESPACE`: page.css -> kPageCss. A changed file
# rebuilds the source.
#
# As a script (cmake -P) it writes OUT from FILES, a list separated by |. Compilers accept string literals of about
# 16 kB, so that longer texts are split into several at line ends.

if(CMAKE_SCRIPT_MODE_FILE)
  set(limit 15000) # bytes of one literal
  set(code "#include <string_view>\n\nnamespace supercircle::${NAMESPACE} {\n")
  string(REPLACE "|" ";" files "${FILES}")
  foreach(file IN LISTS files)
    get_filename_component(base ${file} NAME)
    string(REGEX REPLACE "[^A-Za-z0-9]+" ";" words ${base})
    set(name k)
    foreach(word IN LISTS words)
      string(SUBSTRING ${word} 0 1 first)
      string(SUBSTRING ${word} 1 -1 rest)
      string(TOUPPER ${first} first)
      string(APPEND name ${first}${rest})
    endforeach()
    file(READ ${file} text)
    string(APPEND code "\nextern const std::string_view ${name};\nconst std::string_view ${name} =")
    string(LENGTH "${text}" length)
    if(length EQUAL 0)
      message(FATAL_ERROR "${file} is empty")
    endif()
    while(length GREATER 0)
      set(part ${length})
      if(length GREATER limit)
        string(SUBSTRING "${text}" 0 ${limit} start)
        string(FIND "${start}" "\n" part REVERSE)
        if(part LESS 0)
          message(FATAL_ERROR "${file}: a line is longer than ${limit} bytes")
        endif()
        math(EXPR part "${part} + 1")
      endif()
      string(SUBSTRING "${text}" 0 ${part} start)
      string(SUBSTRING "${text}" ${part} -1 text)
      string(APPEND code "\n    R\"sc(${start})sc\"")
      string(LENGTH "${text}" length)
    endwhile()
    string(APPEND code ";\n")
  endforeach()
  file(WRITE ${OUT} "${code}\n} // namespace supercircle::${NAMESPACE}\n")
  return()
endif()

set(SC_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_FILE})

function(sc_embed target namespace)
  set(files)
  foreach(file IN LISTS ARGN)
    list(APPEND files ${CMAKE_CURRENT_SOURCE_DIR}/${file})
  endforeach()
  string(REPLACE ";" "|" list "${files}")
  set(out ${CMAKE_CURRENT_BINARY_DIR}/${target}_texts.cpp)
  add_custom_command(OUTPUT ${out}
    COMMAND ${CMAKE_COMMAND} "-DFILES=${list}" -DNAMESPACE=${namespace} -DOUT=${out} -P ${SC_EMBED_SCRIPT}
    DEPENDS ${files} ${SC_EMBED_SCRIPT} VERBATIM)
  target_sources(${target} PRIVATE ${out})
endfunction()
