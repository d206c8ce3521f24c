# libchar_late(WORD LIBRARY...): shared libraries that the program loads when it needs them (core/process/late_library.hpp) instead of at its start.
# LIBCHAR_LATE_WORD becomes the file that the loader is asked for; it stays unset where a library has to be linked: an archive, or LIBCHAR_SERIAL.
# What packages must still bring is in late_libraries of the build folder, the path of one library a line.
function(libchar_late word library)
  set(soname "")
  if(NOT LIBCHAR_SERIAL AND CMAKE_READELF)
    execute_process(COMMAND "${CMAKE_READELF}" -d "${library}" OUTPUT_VARIABLE about ERROR_QUIET)
    if(about MATCHES "\\(SONAME\\)[^[]*\\[([^]]+)\\]")
      set(soname "${CMAKE_MATCH_1}")
      get_filename_component(folder "${library}" DIRECTORY)
      set_property(GLOBAL APPEND PROPERTY LIBCHAR_LATE_LIBRARIES "${folder}/${soname}")
    endif()
  endif()
  set(LIBCHAR_LATE_${word} "${soname}" PARENT_SCOPE)
endfunction()
