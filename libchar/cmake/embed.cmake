# Turns files into one C++ source that defines a string_view function for each, so that the pages need nothing at run time.
#   cmake -DOUTPUT=assets.cpp -DHEADER=libchar/report/detail/assets.hpp "-DNAMES=a|b" "-DFILES=/path/a|/path/b" -P embed.cmake
string(REPLACE "|" ";" names "${NAMES}")
string(REPLACE "|" ";" files "${FILES}")
set(source "// Written by libchar/cmake/embed.cmake at build time.\n#include \"${HEADER}\"\n\nnamespace libchar {\n")
foreach(name file IN ZIP_LISTS names files)
  file(READ "${file}" bytes HEX)
  # An empty array is not C++, and an empty asset is a mistake in any case.
  if(bytes STREQUAL "")
    message(FATAL_ERROR "${file} is empty and cannot be embedded")
  endif()
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
  string(APPEND source "namespace {\nconstexpr unsigned char k_${name}[] = {${bytes}};\n}\n"
                       "std::string_view ${name}() { return {reinterpret_cast<const char*>(k_${name}), sizeof k_${name}}; }\n")
endforeach()
string(APPEND source "}  // namespace libchar\n")
file(WRITE "${OUTPUT}" "${source}")
