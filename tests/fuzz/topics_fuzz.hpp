#pragma once
// Any bytes as a log of topics: an Error or rows, the same rows in any blocks, of every topic that
// is listed as readable.

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

#include "libchar/core/error.hpp"
#include "libchar/log/detail/format.hpp"

namespace test {

struct TopicSum {
  std::uint64_t rows = 0, hash = 0;
  bool operator==(const TopicSum&) const = default;
};

inline TopicSum read_topic(const libchar::Format& format, const std::string& path, std::size_t topic,
                           std::size_t most) {
  libchar::ReadOptions options;
  options.hash = false;
  options.block_bytes = most * 40;
  const auto reader = format.topics(path, options);
  const std::size_t fields = reader->topics()[topic].fields.size();
  std::vector<std::size_t> all(fields);
  for (std::size_t i = 0; i < fields; ++i) all[i] = i;
  for (const std::size_t i : reader->usual_fields(topic))
    if (i >= fields) std::abort();
  const bool stamped = !reader->stamps(topic).empty();
  reader->select(topic, all, std::nullopt, 1);
  TopicSum sum;
  libchar::Findings warnings;
  for (;;) {
    libchar::RowBlock block;
    block.columns.resize(fields);
    if (!reader->next(block, most, warnings)) break;
    if (block.rows == 0 || block.rows > most) std::abort();
    if (stamped && block.time_ns.size() < block.rows) std::abort();
    for (std::size_t c = 0; c < fields; ++c) {
      if (block.columns[c].size() < block.rows) std::abort();
      for (std::size_t i = 0; i < block.rows; ++i) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &block.columns[c][i], sizeof bits);
        sum.hash += bits * (2 * c + 1) * (2 * (sum.rows + i) + 1);  // of blocks of any size
      }
    }
    if (stamped)
      for (std::size_t i = 0; i < block.rows; ++i)
        sum.hash += static_cast<std::uint64_t>(block.time_ns[i]) * (2 * (sum.rows + i) + 1);
    sum.rows += block.rows;
  }
  reader->finish(warnings);
  return sum;
}

/// Every topic of the file, in one block and in blocks of `most` rows.
inline void read_any_topics(const char* format_name, const std::string& path, std::size_t most) {
  const libchar::Format& format = *libchar::find_format(format_name);
  try {
    libchar::ReadOptions options;
    options.hash = false;
    const auto topics = format.topics(path, options)->topics();
    for (std::size_t t = 0; t < topics.size() && t < 16; ++t) {
      if (!topics[t].why_not.empty() || topics[t].fields.empty()) continue;
      if (!(read_topic(format, path, t, 100000) == read_topic(format, path, t, most))) std::abort();
    }
  } catch (const libchar::Error&) {
  }
}

}  // namespace test
