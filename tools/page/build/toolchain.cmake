# The program as WebAssembly, by Debian's emscripten: cmake -DCMAKE_TOOLCHAIN_FILE=tools/page/build/toolchain.cmake -DPAGE_LIBRARIES=FOLDER
# FOLDER: what tools/page/build/libraries made.
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES PAGE_LIBRARIES)
include(/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake)
set(LIBCHAR_SERIAL ON CACHE BOOL "" FORCE)
set(CMAKE_DISABLE_FIND_PACKAGE_PkgConfig ON)
list(APPEND CMAKE_MODULE_PATH "${CMAKE_CURRENT_LIST_DIR}/modules")
list(PREPEND CMAKE_FIND_ROOT_PATH "${PAGE_LIBRARIES}")
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH)
set(Eigen3_DIR /usr/share/eigen3/cmake)
# What pages have inside is the same for every machine.
set(CHART_JS /usr/share/javascript/chart.js/chart.min.js CACHE FILEPATH "" FORCE)
set(CHART_JS_COPYRIGHT /usr/share/doc/libjs-chart.js/copyright CACHE FILEPATH "" FORCE)

string(JOIN " " CMAKE_CXX_FLAGS_INIT
  -msimd128 -fwasm-exceptions
  # A size is 32 bits here: a number of 64 becomes one in words.
  -Werror=shorten-64-to-32
  -isystem "${PAGE_LIBRARIES}/include"
  # What its C++ library lacks.
  -include "${CMAKE_CURRENT_LIST_DIR}/compatible.hpp"
  # A long double is 113 bits of software there: special functions stay with doubles.
  -DBOOST_MATH_PROMOTE_DOUBLE_POLICY=false
  # Products of 128 bits, and no instruction of a processor that Random123 knows.
  -DR123_USE_GNU_UINT128=1 -DR123_USE_MULHILO64_ASM=0 -DR123_USE_SSE=0)
set(CMAKE_C_FLAGS_INIT "-msimd128")
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG" CACHE STRING "") # -O3 is larger and no faster there
set(LIBCHAR_COLD -Oz CACHE STRING "")
string(JOIN " " CMAKE_EXE_LINKER_FLAGS_INIT
  -fwasm-exceptions -msimd128 "-L${PAGE_LIBRARIES}/lib")
