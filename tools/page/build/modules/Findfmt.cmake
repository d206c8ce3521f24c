# Its headers alone, from the folder of the page's libraries (tools/page/build/libraries): the same for the other files here.
add_library(fmt::fmt INTERFACE IMPORTED)
target_compile_definitions(fmt::fmt INTERFACE FMT_HEADER_ONLY)
set(fmt_FOUND TRUE)
