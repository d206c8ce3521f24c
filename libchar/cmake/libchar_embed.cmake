# libchar_embed(TARGET ARCHIVE HEADER header NAMES name… FILES file…): the files as string_view functions of these names, declared in
# the header, in an object of the archive that is compiled again when one of them changes.
function(libchar_embed target archive)
  cmake_parse_arguments(PARSE_ARGV 2 embedded "" HEADER "NAMES;FILES")
  set(source "${CMAKE_CURRENT_BINARY_DIR}/${target}.cpp")
  set(script "${PROJECT_SOURCE_DIR}/libchar/cmake/embed.cmake")
  list(JOIN embedded_NAMES "|" names)
  list(JOIN embedded_FILES "|" files)
  add_custom_command(
    OUTPUT "${source}"
    COMMAND "${CMAKE_COMMAND}" "-DOUTPUT=${source}" "-DHEADER=${embedded_HEADER}" "-DNAMES=${names}" "-DFILES=${files}" -P "${script}"
    DEPENDS ${embedded_FILES} "${script}"
    COMMENT "" VERBATIM)
  # A custom command serves targets of its own folder only, so the source is compiled here.
  add_library(${target} OBJECT "${source}")
  target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}")
  target_link_libraries(${target} PRIVATE libchar_flags)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_sources(${archive} PRIVATE $<TARGET_OBJECTS:${target}>)
endfunction()
