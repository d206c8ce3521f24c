#pragma once
// Libraries that a build may be without (libchar_optional): what a test of their readers begins with.

#include <catch2/catch.hpp>

#include "libchar_have.hpp"

/// The test says SKIPPED in a build without the library: LZ4, ZSTD, BZIP2, ZLIB, LZMA, HDF5, SQLITE.
#define NEEDS_LIBRARY(WORD)                    \
  if (!LIBCHAR_HAVE_##WORD) {                  \
    WARN("SKIPPED: this build has no " #WORD); \
    return;                                    \
  }                                            \
  REQUIRE(LIBCHAR_HAVE_##WORD)
