// Any bytes as a .npy file: an Error or rows, the same rows at every block size, and every byte accounted for.

#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "libchar/core/error.hpp"
#include "libchar/log/detail/format.hpp"
#include "tests/support/memory_log.hpp"

namespace {

struct Sum {
  std::uint64_t rows = 0, values = 0, hash = 0;
};

Sum read(const std::string& path, std::size_t block_bytes) {
  libchar::ReadOptions options;
  options.block_bytes = block_bytes;
  options.hash = false;
  const auto source = libchar::find_format("npy")->open(path, options);
  libchar::RowBlock block;
  libchar::Findings warnings;
  Sum sum;
  while (source->next(block, warnings)) {
    sum.rows += block.rows;
    for (std::size_t c = 0; c < block.columns.size(); ++c) {
      if (block.columns[c].size() < block.rows) std::abort();
      for (std::size_t i = 0; i < block.rows; ++i) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &block.columns[c][i], sizeof bits);
        sum.hash += bits * (2 * c + 1);
        ++sum.values;
      }
    }
  }
  if (sum.rows > source->info().rows || source->bytes_read() > source->bytes_total()) std::abort();
  return sum;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::size_t block_bytes = 1 + data[0] * data[0];  // the seams are an input too
  const test::MemoryLog log({reinterpret_cast<const char*>(data) + 1, size - 1});
  try {
    const Sum whole = read(log.path(), std::size_t{1} << 22U);
    const Sum parts = read(log.path(), block_bytes);
    if (whole.rows != parts.rows || whole.values != parts.values || whole.hash != parts.hash) std::abort();
  } catch (const libchar::Error&) {
  }
  return 0;
}
