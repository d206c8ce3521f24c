// Any bytes as what becomes a table of text or stands beside it: JSON lines, messages that ROS printed, LabVIEW's and
// inertial units' lines, sound; and as the members of a workbook or an archive of CSV files, which is packed here so
// that its checksums hold. Read whole and in small blocks: the same samples, findings and errors.

#include <array>

#include "tests/fuzz/log_outcome.hpp"
#include "tests/support/memory_log.hpp"

using namespace libchar;

namespace {

std::uint32_t crc32_of(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1U ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

std::string little(std::uint64_t value, std::size_t bytes) {
  std::string out;
  for (std::size_t i = 0; i < bytes; ++i) out += static_cast<char>(value >> (8 * i) & 0xFFU);
  return out;
}

// The pieces of the input, which NUL bytes part, stored under these names; the last takes what is left.
template <std::size_t n>
std::string archive(std::string_view input, const std::array<std::string_view, n>& names) {
  std::string out, directory;
  std::size_t members = 0;
  for (const std::string_view name : names) {
    const std::size_t end = name == names.back() ? input.size() : std::min(input.find('\0'), input.size());
    const std::string_view content = input.substr(0, end);
    input.remove_prefix(std::min(end + 1, input.size()));
    const std::string head = little(20, 2) + std::string(8, '\0') + little(crc32_of(content), 4) +
                             little(content.size(), 4) + little(content.size(), 4) + little(name.size(), 2) +
                             little(0, 2);
    directory += "PK\1\2" + little(20, 2) + head + std::string(10, '\0') + little(out.size(), 4) + std::string(name);
    out += "PK\3\4" + head + std::string(name) + std::string(content);
    ++members;
  }
  const std::size_t at = out.size();
  return out + directory + "PK\5\6" + little(0, 4) + little(members, 2) + little(members, 2) +
         little(directory.size(), 4) + little(at, 4) + little(0, 2);
}

constexpr std::array<std::string_view, 5> kBook = {"xl/workbook.xml", "xl/_rels/workbook.xml.rels", "xl/styles.xml",
                                                   "xl/sharedStrings.xml", "xl/worksheets/sheet1.xml"};
constexpr std::array<std::string_view, 2> kTables = {"Gyroscope.csv", "Accelerometer.csv"};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::string_view input(reinterpret_cast<const char*>(data) + 2, size - 2);
  constexpr std::array<const char*, 6> kFormats = {"jsonl", "csv", "wav", "xlsx", "tables", "auto"};
  ReadOptions options;
  options.format = kFormats[data[1] % kFormats.size()];
  const bool packed = (data[1] & 128U) != 0;
  if (options.format == "tables" && (data[1] & 64U) != 0) options.topic = "*";
  const test::MemoryLog log(options.format == "xlsx" && packed     ? archive(input, kBook)
                            : options.format == "tables" && packed ? archive(input, kTables)
                                                                   : std::string(input));
  options.threads = 1;
  const std::string whole = fuzz::outcome(log.path(), options);
  options.block_bytes = data[0] % 64U + 1U + (data[0] >= 192 ? 4000U : 0U);
  fuzz::expect_same("whole, and in blocks", whole, fuzz::outcome(log.path(), options));
  return 0;
}
