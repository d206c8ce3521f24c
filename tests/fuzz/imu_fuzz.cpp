// Any bytes as a .imu file of any preset: a sentence or rows, the same at every block size.

#include <array>
#include <cstring>

#include "libchar/log/detail/format.hpp"
#include "tests/fuzz/fuzz_support.hpp"
#include "tests/support/memory_log.hpp"

namespace {

std::string read(const std::string& path, const char* preset, std::size_t block_bytes) {
  libchar::ReadOptions options;
  options.block_bytes = block_bytes;
  options.hash = false;
  options.unsaid.preset = preset;
  try {
    const auto source = libchar::find_format("imu")->open(path, options);
    libchar::RowBlock block;
    libchar::Findings warnings;
    std::uint64_t rows = 0, hash = 0;
    while (source->next(block, warnings)) {
      for (std::size_t c = 0; c < block.columns.size(); ++c)
        for (std::size_t i = 0; i < block.rows; ++i) {
          std::uint64_t bits = 0;
          std::memcpy(&bits, &block.columns[c][i], sizeof bits);
          hash += bits * (2 * c + 1);
        }
      rows += block.rows;
    }
    fuzz::expect(rows == source->info().rows, "another number of rows than announced");
    return std::to_string(rows) + " " + std::to_string(hash);
  } catch (const libchar::Error& error) {
    return error.problem().code;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  constexpr std::array kPresets = {"IMAR", "LN200", "LN200IG", "IXSEA", "NAVCHIP_INT", "NAVCHIP_FLT", "", "NAVCHIP"};
  const char* const preset = kPresets[data[0] % kPresets.size()];
  const test::MemoryLog log({reinterpret_cast<const char*>(data) + 2, size - 2});
  fuzz::expect_same("blocks of another size give other rows", read(log.path(), preset, std::size_t{1} << 22U),
                    read(log.path(), preset, 1 + data[1] * data[1]));
  return 0;
}
