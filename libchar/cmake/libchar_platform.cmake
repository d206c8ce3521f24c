# What differs between platforms, each with one owner in libchar/core:
#                         everywhere else            LIBCHAR_SERIAL: a web page, which can be built natively as well
#   parallel/             threads.cpp (oneTBB)       serial.cpp: one thing after the other
#   file/sha256           sha256_openssl.cpp         sha256_portable.cpp
#   text/double_text      the C++ library            fast_float and fmt
#   log/arrays            child_process.cpp          in_process.cpp: HDF5 in this process
add_library(libchar_platform INTERFACE)
if(LIBCHAR_SERIAL)
  set(LIBCHAR_THREADING serial)
  set(LIBCHAR_DIGEST portable)
  set(LIBCHAR_OTHER_PARSERS child_process)
  set(platform_links "")
  target_compile_definitions(libchar_platform INTERFACE LIBCHAR_SERIAL)
  find_path(FAST_FLOAT_INCLUDE fast_float/fast_float.h REQUIRED)
  target_include_directories(libchar_platform SYSTEM INTERFACE "${FAST_FLOAT_INCLUDE}")
else()
  set(LIBCHAR_THREADING threads)
  set(LIBCHAR_DIGEST openssl)
  set(LIBCHAR_OTHER_PARSERS in_process)
  find_package(OpenSSL 3 REQUIRED COMPONENTS Crypto)
  find_package(TBB 2021 REQUIRED)
  set(platform_links OpenSSL::Crypto TBB::tbb)
endif()
