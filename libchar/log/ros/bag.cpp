// Bags of ROS 1, version 2.0: any message by the definition that its connection carries.
// Source: ROS wiki "Bags/Format/2.0".

#include <fmt/format.h>

#include "libchar/log/detail/format.hpp"
#include "libchar/log/ros/bag_scan.hpp"

namespace libchar {
namespace {

class BagReader final : public ChunkedTopics {
 public:
  BagReader(const std::string& path, const ReadOptions& options)
      : ChunkedTopics(path, options.time_source, false), file_(path), scan_(file_, catalog_) {
    check_bag(file_);
    if (auto index = read_bag_index(file_)) {
      indexed_ = true;
      catalog_ = std::move(index->catalog);
      chunks() = std::move(index->chunks);
      counts() = std::move(index->counts);
      scan_.end_at(index->at);
      find_examples();
    } else {
      count_messages();
    }
    list();
  }

  std::vector<std::string> dialect() const override {
    const std::string& packed = scan_.packed_with();
    return {fmt::format("bag 2.0{}{}",
                        packed.empty() ? "" : ", chunks packed with " + packed,
                        indexed_ ? "" : ", no index")};
  }

 protected:
  MessageScan& scan() override { return scan_; }
  const MessageScan& scan() const override { return scan_; }
  std::uint64_t first_record() const override { return kFirstBagRecord; }

 private:
  void list() {
    std::vector<std::pair<StreamId, RawTopic>> streams;
    for (const auto& [id, connection] : catalog_.connections) {
      RawTopic topic;
      topic.name = connection.topic;
      topic.format.type = connection.type;
      topic.format.message_encoding = "ros1";
      topic.format.definition_encoding = "ros1msg";
      topic.format.definition = connection.definition;
      streams.emplace_back(id, std::move(topic));
    }
    list_topics(std::move(streams));
  }

  FileWindow file_;
  BagCatalog catalog_;
  BagScan scan_;
  bool indexed_ = false;
};

std::unique_ptr<TopicReader> open_bag(const std::string& path, const ReadOptions& options) {
  return std::make_unique<BagReader>(path, options);
}

bool certain_bag(std::string_view first_bytes) {
  return first_bytes.starts_with(kBagMagic);
}

bool sniff_bag(const std::string&, std::string_view first_bytes) {
  return certain_bag(first_bytes);
}

}  // namespace

Format bag_format() {
  Format row;
  row.about.name = "bag";
  row.about.title = "ROS 1 bag";
  row.about.suffixes = {".bag"};
  row.about.names = "yes";
  row.about.units = "of ROS types";
  row.about.rate = "by stamps";
  row.about.start = "yes";
  row.about.topics = true;
  row.certain = certain_bag;
  row.sniff = sniff_bag;
  row.topics = open_bag;
  return row;
}

}  // namespace libchar
