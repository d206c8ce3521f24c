# Flags shared by every target of this project, as one interface target that is never installed.
add_library(libchar_flags INTERFACE)
target_compile_features(libchar_flags INTERFACE cxx_std_20)
# -ffp-contract=off: the same bits with and without fused multiply-add. -ffast-math is banned (NaN marks a missing sample).
target_compile_options(
  libchar_flags
  INTERFACE -ffp-contract=off
            $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess> # for ccache
            -Wall
            -Wextra
            -Wpedantic
            -Wshadow
            -Wconversion
            -Wno-sign-conversion
            # GCC 12 warns falsely inside std::string (GCC bug 105329) and Eigen; what comes from a precompiled header is no system header to it.
            $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict;-Wno-stringop-overflow;-Wno-stringop-overread;-Wno-array-bounds;-Wno-maybe-uninitialized>
            # float to double; clang means double to long double as well, which is what sums of squares do on purpose
            $<$<CXX_COMPILER_ID:GNU>:-Wdouble-promotion>
            -Wold-style-cast
            -Wnon-virtual-dtor
            -Woverloaded-virtual
            $<$<CXX_COMPILER_ID:GNU>:-Wduplicated-cond
            -Wlogical-op>)
if(LIBCHAR_UNITY)
  # GCC takes a private struct of a source for one in a header when it is compiled with others.
  target_compile_options(libchar_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()
if(LIBCHAR_WERROR)
  target_compile_options(libchar_flags INTERFACE -Werror)
endif()
if(LIBCHAR_SANITIZE)
  set(sanitizers address,undefined,float-cast-overflow)
  if(LIBCHAR_SANITIZE STREQUAL "thread")
    set(sanitizers thread)
  endif()
  target_compile_options(libchar_flags INTERFACE -fsanitize=${sanitizers} -fno-sanitize-recover=all
                                                 -fno-omit-frame-pointer -D_GLIBCXX_ASSERTIONS)
  target_link_options(libchar_flags INTERFACE -fsanitize=${sanitizers})
endif()
if(LIBCHAR_FUZZ)
  target_compile_options(libchar_flags INTERFACE $<$<CXX_COMPILER_ID:Clang>:-fsanitize=fuzzer-no-link>)
endif()
# What stands between a defect and an attacker's log (docs/security.md): for the library and the programs, not for tests. The
# sanitizers have their own.
add_library(libchar_hardening INTERFACE)
if(NOT LIBCHAR_SANITIZE AND NOT LIBCHAR_FUZZ AND NOT EMSCRIPTEN)
  target_compile_options(
    libchar_hardening INTERFACE -fstack-protector-strong -fstack-clash-protection -fcf-protection
                                $<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=3>) # needs optimization
  target_link_options(libchar_hardening INTERFACE -pie -Wl,-z,relro,-z,now,-z,noexecstack)
endif()
# Of what runs once a run: documents, verbs. Half the time to compile; a page asks for the smallest.
set(LIBCHAR_COLD -O1 CACHE STRING "optimisation of documents and verbs in a Release build")
mark_as_advanced(LIBCHAR_COLD)
find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  # The same objects for every checkout (paths relative to it), and hits where a precompiled header is used.
  set(CMAKE_CXX_COMPILER_LAUNCHER
      "${CMAKE_COMMAND}" -E env "CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}" CCACHE_NOHASHDIR=1
      CCACHE_SLOPPINESS=pch_defines,time_macros "${CCACHE_PROGRAM}")
endif()
