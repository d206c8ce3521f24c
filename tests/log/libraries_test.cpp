// What a build without a library says of the files that need it: one sentence that names the library, and what to do.

#include "tests/log/libraries.hpp"

#include <catch2/catch.hpp>

#include "libchar/core/error.hpp"
#include "libchar/log/read.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

struct NeedyFile {
  const char* file;
  const char* topic;
  bool here;
  const char* library;
};

constexpr NeedyFile kNeedy[] = {
    {"packed/table.csv.gz", "", LIBCHAR_HAVE_ZLIB, "zlib"},
    {"packed/table.csv.zst", "", LIBCHAR_HAVE_ZSTD, "zstd"},
    {"packed/table.csv.xz", "", LIBCHAR_HAVE_LZMA, "lzma"},
    {"arrays/log.h5", "", LIBCHAR_HAVE_HDF5, "HDF5"},
    {"arrays/log_v73.mat", "", LIBCHAR_HAVE_HDF5, "HDF5"},
    {"arrays/compressed.npz", "", LIBCHAR_HAVE_ZLIB, "zlib"},
    {"arrays/log_v5_compressed.mat", "", LIBCHAR_HAVE_ZLIB, "zlib"},
    {"ros/ros2_lz4.mcap", "/imu0/data", LIBCHAR_HAVE_LZ4, "lz4"},
    {"ros/ros2_zstd.mcap", "/imu0/data", LIBCHAR_HAVE_ZSTD, "zstd"},
    {"ros/ros1_lz4.bag", "/imu/data_raw", LIBCHAR_HAVE_LZ4, "lz4"},
    {"ros/ros1_bz2.bag", "/imu/data_raw", LIBCHAR_HAVE_BZIP2, "bz2"},
    {"ros/humble.db3", "/imu0/data", LIBCHAR_HAVE_SQLITE, "sqlite"},
};

}  // namespace

TEST_CASE("a file that needs a library is read, or refused in a sentence that names the library") {
  for (const NeedyFile& one : kNeedy) {
    INFO(one.file);
    ReadOptions options;
    options.topic = one.topic;
    options.rate_hz = 100;
    try {
      const Recording log = read_recording(test::fixture(one.file).string(), options);
      CHECK(one.here);
      CHECK(!log.samples.empty());
    } catch (const Error& error) {
      INFO(error.what());
      CHECK_FALSE(one.here);
      CHECK(error.problem().kind == ErrorKind::input);
      CHECK_THAT(error.what(), Catch::Contains(one.library) &&
                                   (Catch::Contains("built without") || Catch::Contains("cannot unpack")));
      CHECK(!error.problem().hint.empty());
    }
  }
}
