# libchar_optional(WORD HEADER LIBRARY): a library that a reader uses where it is installed. LIBCHAR_HAVE_WORD in libchar_have.hpp is 1 or 0; a
# library that is there is linked by its plain name, so that who links the installed archive needs nothing but the library.
# libchar_optional_header() writes that header when all have been asked for.
function(libchar_optional word header library)
  find_path(LIBCHAR_${word}_INCLUDE ${header})
  find_library(LIBCHAR_${word}_LIBRARY ${library})
  mark_as_advanced(LIBCHAR_${word}_INCLUDE LIBCHAR_${word}_LIBRARY)
  set(have 0)
  if(LIBCHAR_${word}_INCLUDE AND LIBCHAR_${word}_LIBRARY)
    set(have 1)
    target_link_libraries(libchar_curves PRIVATE ${library})
  else()
    message(STATUS "built without ${library}: ${header} is not installed")
  endif()
  set_property(GLOBAL APPEND_STRING PROPERTY LIBCHAR_HAVE "#define LIBCHAR_HAVE_${word} ${have}\n")
endfunction()

function(libchar_optional_header)
  get_property(lines GLOBAL PROPERTY LIBCHAR_HAVE)
  file(CONFIGURE OUTPUT "${CMAKE_CURRENT_BINARY_DIR}/have/libchar_have.hpp" CONTENT "#pragma once\n${lines}" @ONLY)
  foreach(objects libchar_curves libchar_curves_documents)
    target_include_directories(${objects} PRIVATE "${CMAKE_CURRENT_BINARY_DIR}/have")
  endforeach()
endfunction()
