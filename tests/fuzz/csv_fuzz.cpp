// libFuzzer target of the CSV reader: the first two bytes choose block size and options, the rest is the file. It is
// read in small blocks and in one, with one thread and sometimes more: values, counts, warnings and errors must agree.
// The reader itself throws std::logic_error when its account of bytes and cells does not balance.
//   csv_fuzz -max_total_time=60 -max_len=4096 -timeout=5 -rss_limit_mb=1024 corpus
//   fixtures/known/badinputs/csv
#include <sys/mman.h>
#include <unistd.h>

#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "libchar/core/error.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/log/read.hpp"

using namespace libchar;

namespace {

struct Enough {};

// A digest of what the sink sees; long gaps are cut off at the same sample whatever the blocks.
struct Digest final : BlockSink {
  void begin(const LogInfo& so_far) override {
    channels = so_far.channels.size();
    lanes.assign(channels, 0xCBF29CE484222325U);
  }
  void block(const SampleBlock& samples) override {
    if (samples.first != rows) std::abort();
    for (std::size_t i = 0; i < samples.rows; ++i) {
      if (rows == 20000) throw Enough{};
      ++rows;
      for (std::size_t c = 0; c < channels; ++c)
        lanes[c] = (lanes[c] ^ std::bit_cast<std::uint64_t>(samples.channels[c][i])) * 0x100000001B3U;
    }
  }
  std::size_t channels = 0;
  std::uint64_t rows = 0;
  std::vector<std::uint64_t> lanes;
};

std::string outcome(const std::string& path, const ReadOptions& options) {
  Digest digest;
  std::string said;
  try {
    const LogInfo info = read_log(path, options, digest);
    for (const Finding& warning : info.warnings.list()) said += one_line(warning, "") + "\n";
    for (const auto* notes : {&info.guesses, &info.dialect})
      for (const std::string& note : *notes) said += note + "\n";
    for (const Channel& channel : info.channels)
      said += channel.name + "|" + channel.unit + "|" + (channel.integer ? "i\n" : "\n");
    said += std::to_string(info.rows) + " " + std::to_string(info.samples) + " " +
            std::to_string(std::bit_cast<std::uint64_t>(info.time.rate_hz)) + " " +
            std::to_string(std::bit_cast<std::uint64_t>(info.time.max_deviation_s)) + " " + info.sha256;
  } catch (const Error& error) {
    said = error.what();
    if (said.find('\n') != std::string::npos) std::abort();
  } catch (const Enough&) {
    said = "enough";
  }
  for (const std::uint64_t lane : digest.lanes) said += " " + std::to_string(lane);
  return said;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const unsigned choice = data[1];
  ReadOptions options;
  options.format = "csv";
  options.header = choice % 8 == 1 ? "yes" : choice % 8 == 2 ? "no" : "auto";
  options.time_column = choice % 8 == 3 ? "none" : "auto";
  options.decimal = choice % 8 == 4 ? "comma" : "auto";
  options.delimiter = choice % 8 == 5 ? ";" : choice % 8 == 6 ? "space" : "auto";
  options.skip_repeated_header = (choice & 8U) != 0;
  options.missing.overflow = (choice & 16U) != 0;
  if ((choice & 32U) != 0) options.rate_hz = 100;
  options.hash = (choice & 64U) != 0;
  const int file = ::memfd_create("csv", 0);
  const char* const text = reinterpret_cast<const char*>(data + 2);
  if (::write(file, text, size - 2) != static_cast<ssize_t>(size - 2)) std::abort();
  const std::string path = "/proc/self/fd/" + std::to_string(file);
  options.threads = 1;
  const std::string whole = outcome(path, options);
  options.block_bytes = data[0] % 64U + 1U + (data[0] >= 192 ? 4000U : 0U);
  options.threads = choice >= 240 ? 3 : 1;
  const std::string blocks = outcome(path, options);
  ::close(file);
  if (whole != blocks) {
    std::fprintf(stderr, "whole:\n%s\nblocks of %zu:\n%s\n", whole.c_str(), options.block_bytes, blocks.c_str());
    std::abort();
  }
  return 0;
}
