// MCAP, the container of ROS 2 since Iron and of Foxglove: any message that the file itself
// describes in ROS's terms, or JSON. Source: mcap.dev/spec and its registry of profiles and
// encodings.

#include <fmt/format.h>

#include <algorithm>

#include "libchar/core/text/text.hpp"
#include "libchar/log/detail/format.hpp"
#include "libchar/log/ros/mcap_scan.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kFirstMcapRecord = 8;

class McapReader final : public ChunkedTopics {
 public:
  McapReader(const std::string& path, const ReadOptions& options)
      : ChunkedTopics(path, options, true, scan_, kFirstMcapRecord), scan_(file(), catalog_) {
    check_mcap_magic(file());
    read_profile();
    if (auto summary = read_mcap_summary(file(), found_early())) {
      take_summary(std::move(*summary));
      find_examples();
    } else {
      count_messages();
    }
    list();
  }

  std::vector<std::string> dialect() const override {
    return {fmt::format("MCAP{}{}{}",
                        profile_.empty() ? "" : ", profile " + printable(profile_, 40),
                        packing(),
                        summary_ ? "" : ", no summary")};
  }

 private:
  void read_profile() {
    const std::uint64_t left = file().left(kFirstMcapRecord);
    const auto bytes = file().view(kFirstMcapRecord,
                                   static_cast<std::size_t>(std::min<std::uint64_t>(left, 4096)));
    if (bytes.size() > kMcapFront && bytes[0] == std::byte{1})
      profile_ = read_mcap_profile(bytes.subspan(kMcapFront)).value_or("");
  }

  void take_summary(McapSummary summary) {
    summary_ = true;
    catalog_ = std::move(summary.catalog);
    for (McapChunkIndex& chunk : summary.chunks)
      chunks().push_back({chunk.at, std::move(chunk.channels)});
    for (const auto& [id, rows] : summary.statistics.messages)
      counts()[id] = {rows,
                      static_cast<std::int64_t>(summary.statistics.first_ns),
                      static_cast<std::int64_t>(summary.statistics.last_ns),
                      {}};
    // A channel is in some chunks only: their times tell its rate better than those of the file.
    std::map<StreamId, std::pair<std::uint64_t, std::uint64_t>> spans;
    for (std::size_t i = 0; i < chunks().size(); ++i)
      for (const StreamId id : chunks()[i].streams) {
        const McapChunkIndex& chunk = summary.chunks[i];
        const auto [at, added] = spans.try_emplace(id, chunk.first_ns, chunk.last_ns);
        at->second.first = std::min(at->second.first, chunk.first_ns);
        at->second.second = std::max(at->second.second, chunk.last_ns);
      }
    for (const auto& [id, span] : spans) {
      counts()[id].first_ns = static_cast<std::int64_t>(span.first);
      counts()[id].last_ns = static_cast<std::int64_t>(span.second);
    }
  }

  void list() {
    std::vector<std::pair<StreamId, RawTopic>> streams;
    for (const StreamId id : catalog_.order) {
      const McapChannel& channel = catalog_.channels.at(id);
      RawTopic topic;
      topic.name = channel.topic;
      topic.format.message_encoding = channel.encoding;
      const auto schema = catalog_.schemas.find(channel.schema);
      if (schema != catalog_.schemas.end()) {
        topic.format.type = schema->second.name;
        topic.format.definition_encoding = schema->second.encoding;
        topic.format.definition = schema->second.text;
      }
      streams.emplace_back(id, std::move(topic));
    }
    list_topics(std::move(streams));
  }

  McapCatalog catalog_;
  McapScan scan_;
  std::string profile_;
  bool summary_ = false;
};

}  // namespace

Format mcap_format() {
  Format row;
  row.about.name = "mcap";
  row.about.title = "MCAP";
  row.about.suffixes = {".mcap"};
  row.about.topics = true;
  row.about.time_sources = true;
  row.topics = open_topics<McapReader>;
  row.about.units = "of ROS types";
  row.certain = [](std::string_view first_bytes) { return first_bytes.starts_with(kMcapMagic); };
  return row;
}

}  // namespace libchar
