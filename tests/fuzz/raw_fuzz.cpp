// Any bytes as a sidecar (JSON or YAML by the first byte) and as the raw file it describes; the two
// are parted by a NUL.

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "libchar/core/error.hpp"
#include "libchar/log/binary/sidecar.hpp"
#include "libchar/log/detail/format.hpp"

namespace {

// open_raw finds the sidecar by its name, so that this one needs names: in memory (/dev/shm), one pair a process.
const std::string& base() {
  static const std::string path = "/dev/shm/libchar-raw-fuzz-" + std::to_string(::getpid()) + ".bin";
  return path;
}

void put(const std::string& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

std::uint64_t read(std::size_t block_bytes) {
  libchar::ReadOptions options;
  options.block_bytes = block_bytes;
  options.hash = false;
  const auto source = libchar::find_format("raw")->open(base(), options);
  libchar::RowBlock block;
  libchar::Findings warnings;
  std::uint64_t sum = 0;
  while (source->next(block, warnings)) {
    sum += block.rows;
    for (std::size_t c = 0; c < block.columns.size(); ++c) {
      if (block.columns[c].size() < block.rows) std::abort();
      for (std::size_t i = 0; i < block.rows; ++i) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &block.columns[c][i], sizeof bits);
        sum += bits * (2 * c + 3);
      }
    }
  }
  return sum;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const bool json = (data[0] & 1U) != 0;
  const std::string_view all(reinterpret_cast<const char*>(data) + 1, size - 1);
  const std::size_t nul = all.find('\0');
  const std::string_view sidecar = all.substr(0, nul);
  try {
    const libchar::Sidecar parsed = libchar::parse_sidecar(sidecar, "sidecar", json);
    // What is written reads back to the same document.
    const std::string text = libchar::sidecar_json(parsed);
    if (libchar::sidecar_json(libchar::parse_sidecar(text, "again", true)) != text) std::abort();
    put(base(), nul == std::string_view::npos ? std::string_view() : all.substr(nul + 1));
    put(base() + ".json", text);
    if (read(std::size_t{1} << 22U) != read(1 + data[0] * data[0])) std::abort();
  } catch (const libchar::Error&) {
  }
  return 0;
}
