#pragma once
// Topics of logs of ROS messages: what MCAP, bags and rosbag2's databases have in common once their messages are found.

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libchar/log/read.hpp"
#include "libchar/log/ros/messages/message_decoder.hpp"
#include "libchar/log/ros/messages/message_files.hpp"
#include "libchar/log/topics/topic_reader.hpp"

namespace libchar {

/// A topic as its log describes it.
struct RawTopic {
  std::string name;
  MessageFormat format;
  std::uint64_t rows = 0;
  std::int64_t first_ns = 0,
               last_ns = 0;  ///< of its messages, when they were recorded; equal = not known
  double rate_hz = 0;        ///< where it is known better than by these
};

/// The topics of a log, each once.
class RawTopics {
 public:
  /// Adds a topic to one of the same name and type where there is one; its place. Of one name with another type the
  /// second is called "NAME (TYPE)".
  std::size_t add(RawTopic topic);
  std::vector<RawTopic> take() { return std::move(topics_); }

 private:
  std::vector<RawTopic> topics_;
  std::set<std::string> names_;
  std::map<std::array<std::string, 4>, std::size_t> places_;  ///< by name, type, encoding, definition
};

struct RawMessage {
  std::span<const std::byte> data;
  std::int64_t log_ns = 0, publish_ns = 0;
  std::uint64_t at = 0;  ///< byte of the file, or number, for messages
};

class MessageTopics : public TopicReader {
 public:
  const std::vector<LogTopic>& topics() const override { return topics_; }
  std::vector<std::size_t> usual_fields(std::size_t topic) const override;
  std::string stamps(std::size_t topic) const override;
  void select(std::size_t topic, const std::vector<std::size_t>& fields, std::optional<std::size_t> time,
              StampUnit unit) override;
  bool next(RowBlock& block, std::size_t most, Findings& warnings) override;
  /// What was found when topics were listed, unless rows were read, whose warnings say it too.
  void finish(Findings& warnings) override;

 protected:
  /// `publishes`: messages have a time of publication too.
  MessageTopics(std::string path, const ReadOptions& options, bool publishes);
  /// Called once, when all topics of the log are known.
  void set_topics(std::vector<RawTopic> raw);
  /// Before the first `next_message`: only messages of this topic are wanted.
  virtual void start(std::size_t topic) = 0;
  /// The next message of the topic, false at the end; what is lost on the way is counted.
  virtual bool next_message(RawMessage& message, Findings& warnings) = 0;
  /// Where a message stands, for warnings.
  virtual std::string place(const RawMessage& message) const;

  /// Said with the listing and with the rows.
  Findings& found_early() { return early_; }
  /// Said with the listing; found again where rows are read.
  Findings& found_listing() { return listing_; }
  bool listed_only() const { return !selected_; }
  const std::string& path() const { return path_; }

 private:
  enum class Source { header, log, publish };
  struct Topic {
    std::unique_ptr<MessageDecoder> decoder;
    std::vector<std::size_t> usual;
    bool stamped = false;  // by the sensor, in every message for all that is known
  };

  void add_topic(RawTopic& raw);
  void define(MessageFormat& format) const;
  Source source_of(std::size_t topic) const;
  [[noreturn]] void refuse_source(std::size_t topic, std::string what) const;
  bool row_of(const RawMessage& message, Findings& warnings);

  std::string path_, time_source_;
  MessageFiles files_;
  bool publishes_ = false;
  std::vector<LogTopic> topics_;
  std::vector<Topic> decoders_;
  Findings early_, listing_;
  bool selected_ = false;
  std::size_t topic_ = 0, fields_ = 0;
  Source source_ = Source::log;
  bool time_field_ = false;
  std::int64_t unit_ns_ = 1;
  std::vector<double> row_;
  std::int64_t stamp_ = 0;
};

}  // namespace libchar
