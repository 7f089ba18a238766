# teleop_embed(report_page core/reporting/page.hpp teleop::page
#              style=/path/page.css script=/path/page.js)
#
# makes a source file that defines, for each NAME=FILE, the constant that HEADER declares as
# `extern const std::string_view NAME` in NAMESPACE: the file's text, so that a program carries it.
# The path of the source is stored in the variable of the first argument. What names another place
# on the net or disk is taken out (source maps, the scheme of addresses in licence comments): the
# text must stand alone.

if(CMAKE_SCRIPT_MODE_FILE)
  set(text "#include \"${HEADER}\"\n\nnamespace ${NAMESPACE} {\n")
  foreach(pair IN LISTS PAIRS)
    string(REGEX MATCH "^([^=]+)=(.*)$" pair "${pair}")
    set(name ${CMAKE_MATCH_1})
    file(READ ${CMAKE_MATCH_2} content)
    string(REGEX REPLACE "/[/*]# sourceMappingURL=[^\n*]*(\\*/)?" "" content "${content}")
    string(REGEX REPLACE "https?://" "" content "${content}")
    string(APPEND text "const std::string_view ${name}{R\"embedded(${content})embedded\"};\n")
  endforeach()
  string(APPEND text "}  // namespace ${NAMESPACE}\n")
  file(WRITE ${OUTPUT} "${text}")
  return()
endif()

function(teleop_embed variable header namespace)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/${variable}.cpp)
  set(files ${ARGN})
  list(TRANSFORM files REPLACE "^[^=]+=" "")
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} "-DOUTPUT=${output}" "-DHEADER=${header}" "-DNAMESPACE=${namespace}"
            "-DPAIRS=${ARGN}" -P ${PROJECT_SOURCE_DIR}/cmake/embed.cmake
    DEPENDS ${files} ${PROJECT_SOURCE_DIR}/cmake/embed.cmake
    COMMENT "Embedding ${variable}" VERBATIM)
  set(${variable} ${output} PARENT_SCOPE)
endfunction()

# teleop_find_dygraphs(NAME FILE): the path of a file of Debian's libjs-dygraphs.
function(teleop_find_dygraphs variable file)
  find_file(${variable} ${file} PATHS /usr/share/javascript/dygraphs NO_DEFAULT_PATH)
  if(NOT ${variable})
    message(FATAL_ERROR "${file} is missing: install the package libjs-dygraphs, or set ${variable}")
  endif()
endfunction()
