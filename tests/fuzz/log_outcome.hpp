#pragma once
// What reading a log of any bytes ends with, as one text: values, names, units, findings or the refusal.

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "libchar/core/error.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/log/read.hpp"
#include "tests/fuzz/fuzz_support.hpp"

namespace fuzz {

struct Enough {};

/// A digest of what the sink sees; long gaps are cut off at the same sample whatever the blocks.
struct Digest final : libchar::BlockSink {
  void begin(const libchar::LogInfo& so_far) override {
    channels = so_far.channels.size();
    lanes.assign(channels, 0xCBF29CE484222325U);
  }
  void block(const libchar::SampleBlock& samples) override {
    expect(samples.first == rows, "blocks that do not follow each other");
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

inline std::string outcome(const std::string& path, const libchar::ReadOptions& options) {
  Digest digest;
  std::string text;
  try {
    const libchar::LogInfo info = libchar::read_log(path, options, digest);
    for (const libchar::Finding& warning : info.warnings.list()) text += one_line(warning, "") + "\n";
    for (const auto* notes : {&info.guesses, &info.dialect})
      for (const std::string& note : *notes) text += note + "\n";
    for (const libchar::Channel& channel : info.channels)
      text += channel.name + "|" + channel.unit + "|" + (channel.integer ? "i\n" : "\n");
    text += std::to_string(info.rows) + " " + std::to_string(info.samples) + " " + bits(info.time.rate_hz) + " " +
            bits(info.time.max_deviation_s) + " " + info.sha256;
  } catch (const libchar::Error& error) {
    text = said(error);
  } catch (const Enough&) {
    text = "enough";
  }
  for (const std::uint64_t lane : digest.lanes) text += " " + std::to_string(lane);
  return text;
}

}  // namespace fuzz
