# Man pages (compressed, as they are installed) and completions of the program, by the program.
#   cmake -DPROGRAM=sensorchar "-DVERBS=allan|psd" -DFOLDER=pages -P write_pages.cmake
string(REPLACE "|" ";" verbs "${VERBS}")
find_program(GZIP gzip REQUIRED)
file(REMOVE_RECURSE "${FOLDER}")
file(MAKE_DIRECTORY "${FOLDER}/man1")

function(write_page file)
  execute_process(COMMAND "${PROGRAM}" --generate ${ARGN} OUTPUT_FILE "${FOLDER}/${file}" RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "${PROGRAM} --generate ${ARGN}: ${failed}")
  endif()
endfunction()

write_page(man1/sensorchar.1 man)
foreach(verb IN LISTS verbs)
  write_page("man1/sensorchar-${verb}.1" man ${verb})
endforeach()
file(GLOB pages "${FOLDER}/man1/*.1")
execute_process(COMMAND "${GZIP}" -9n ${pages} COMMAND_ERROR_IS_FATAL ANY)
foreach(shell bash zsh fish)
  write_page(sensorchar.${shell} ${shell})
endforeach()
file(TOUCH "${FOLDER}/made")
