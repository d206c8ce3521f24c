// Recordings of rosbag2 in several parts: a folder whose metadata.yaml lists files of MCAP or
// SQLite, read as one log in that order. Source: ros2/rosbag2, rosbag2_storage (metadata_io).

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "libchar/core/file/log_files.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/detail/format.hpp"

namespace libchar {
namespace {

std::string name_of(const std::string& part) { return std::filesystem::path(part).filename().string(); }

const Format& format_of_part(const std::string& part) {
  const Format* const format = format_by_suffix(part);
  if (format != nullptr && (format->about.name == "mcap" || format->about.name == "db3")) return *format;
  throw input_error("E0449", part)
      .says("is a part of a recording of rosbag2 and neither .mcap nor .db3")
      .hint(part.ends_with(".zstd") ? "unpack it first (unzstd), and mend its name in metadata.yaml" : "");
}

// What a part is, as long as it is not read.
struct Part {
  std::string file;
  std::vector<LogTopic> topics;
  std::vector<std::vector<std::size_t>> usual;  // by topic
  std::vector<std::string> stamps;              // by topic
  std::uint64_t bytes = 0;
};

// A topic of the recording in its parts.
struct Merged {
  std::vector<std::optional<std::size_t>> in_part;
  std::vector<std::size_t> usual;
  std::string stamps;
  std::uint64_t most_rows = 0;
};

std::optional<std::size_t> place_of(const std::vector<Channel>& fields, const std::string& name) {
  for (std::size_t i = 0; i < fields.size(); ++i)
    if (fields[i].name == name) return i;
  return std::nullopt;
}

class Rosbag2Reader final : public TopicReader {
 public:
  Rosbag2Reader(const std::string& path, const ReadOptions& options) : options_(options) {
    const std::vector<std::string> files = files_of_log(named_log_file(path));
    for (std::size_t i = 1; i < files.size(); ++i) list_part(files[i]);
    for (std::size_t p = 0; p < parts_.size(); ++p)
      for (std::size_t t = 0; t < parts_[p].topics.size(); ++t) merge(p, t);
    for (LogTopic& topic : topics_)
      if (!topic.fields.empty()) topic.why_not.clear();
  }

  const std::vector<LogTopic>& topics() const override { return topics_; }
  std::vector<std::string> dialect() const override {
    std::vector<std::string> names;
    for (const Part& part : parts_) names.push_back(name_of(part.file));
    std::vector<std::string> lines = {
        fmt::format("recording of rosbag2, {}: {}", plural(parts_.size(), "part"), first_names(names))};
    lines.insert(lines.end(), dialect_.begin(), dialect_.end());
    return lines;
  }
  std::vector<std::size_t> usual_fields(std::size_t topic) const override { return merged_[topic].usual; }
  std::string stamps(std::size_t topic) const override { return merged_[topic].stamps; }
  std::uint64_t bytes_read() const override { return bytes_done_ + (reader_ ? reader_->bytes_read() : 0); }

  void select(std::size_t topic, const std::vector<std::size_t>& fields, std::optional<std::size_t> time,
              StampUnit unit) override {
    selected_ = true;
    topic_ = topic;
    fields_ = fields;
    time_ = time;
    unit_ = unit;
  }

  bool next(RowBlock& block, std::size_t most, Findings& warnings) override {
    while (reader_ || open_part(warnings)) {
      RowBlock rows;
      rows.columns.resize(here_.size());
      Findings found;
      const bool more = reader_->next(rows, most, found);
      add(found, warnings);
      if (more) {
        hand_over(rows, block);
        return true;
      }
      close_part(warnings);
    }
    return false;
  }

  void finish(Findings& warnings) override {
    if (!selected_)
      warnings.merge(listing_);
    else if (reader_)
      close_part(warnings);
  }

 private:
  void list_part(const std::string& file) {
    const auto reader = format_of_part(file).topics(file, options_);
    Part part;
    part.file = file;
    part.topics = reader->topics();
    for (std::size_t t = 0; t < part.topics.size(); ++t) {
      part.usual.push_back(reader->usual_fields(t));
      part.stamps.push_back(stamps_in(*reader, part.topics[t], t));
    }
    std::error_code none;
    part.bytes = std::filesystem::file_size(file, none);
    if (parts_.empty()) dialect_ = reader->dialect();
    Findings found;
    reader->finish(found);
    parts_.push_back(std::move(part));
    at_ = parts_.size() - 1;
    add(found, listing_);
  }

  // A topic without messages in this part may have no stamps to choose from.
  static std::string stamps_in(const TopicReader& reader, const LogTopic& topic, std::size_t t) {
    return topic.fields.empty() ? "" : reader.stamps(t);
  }

  void merge(std::size_t p, std::size_t t) {
    const LogTopic& from = parts_[p].topics[t];
    const std::size_t at = merged_place(from);
    LogTopic& to = topics_[at];
    Merged& merged = merged_[at];
    merged.in_part.resize(parts_.size());
    merged.in_part[p] = t;
    to.rows += from.rows;
    to.sensor = to.sensor || from.sensor;
    if (from.rows > merged.most_rows) {
      merged.most_rows = from.rows;
      to.rate_hz = from.rate_hz;
      if (!from.why_not.empty()) to.why_not = from.why_not;
    }
    if (from.fields.empty() || !from.why_not.empty()) return;
    if (to.fields.empty()) merged.stamps = parts_[p].stamps[t];
    for (std::size_t f = 0; f < from.fields.size(); ++f) {
      const auto known = place_of(to.fields, from.fields[f].name);
      const std::size_t place = known.value_or(to.fields.size());
      if (!known) to.fields.push_back(from.fields[f]);
      const std::vector<std::size_t>& usual = parts_[p].usual[t];
      if (std::find(usual.begin(), usual.end(), f) != usual.end() &&
          std::find(merged.usual.begin(), merged.usual.end(), place) == merged.usual.end())
        merged.usual.push_back(place);
    }
  }

  // One of the same name and type, or a new one.
  std::size_t merged_place(const LogTopic& topic) {
    bool taken = false;
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      if (topics_[i].name != topic.name) continue;
      if (topics_[i].type == topic.type) return i;
      taken = true;
    }
    LogTopic fresh;
    fresh.name = taken ? fmt::format("{} ({})", topic.name, topic.type) : topic.name;
    fresh.type = topic.type;
    fresh.why_not = topic.why_not;
    for (std::size_t i = 0; taken && i < topics_.size(); ++i)
      if (topics_[i].name == fresh.name) return i;
    topics_.push_back(std::move(fresh));
    merged_.emplace_back();
    return topics_.size() - 1;
  }

  // The next part that has rows of the topic; false behind the last one.
  bool open_part(Findings& warnings) {
    for (; next_part_ < parts_.size(); bytes_done_ += parts_[next_part_++].bytes) {
      const Part& part = parts_[next_part_];
      const auto topic = merged_[topic_].in_part[next_part_];
      if (!topic || part.topics[*topic].rows == 0) continue;
      const LogTopic& about = part.topics[*topic];
      const auto time = time_ ? place_of(about.fields, topics_[topic_].fields[*time_].name) : time_;
      if (!about.why_not.empty() || about.fields.empty() || (time_ && !time)) {
        warnings.add("unreadable_part", "messages of parts of the recording in which the topic cannot be read",
                     fmt::format("{}: {}", name_of(part.file), about.why_not.empty() ? "no stamps" : about.why_not),
                     about.rows);
        continue;
      }
      at_ = next_part_++;
      begin_part(part, *topic, time);
      return true;
    }
    return false;
  }

  void begin_part(const Part& part, std::size_t topic, std::optional<std::size_t> time) {
    // The stamps are those of the first part: a driver that leaves them 0 in one part has them in
    // none, or the rows would jump.
    ReadOptions options = options_;
    const std::string& stamps = merged_[topic_].stamps;
    if (options.time_source == "auto" && part.stamps[topic] != stamps)
      options.time_source = stamps == "log time" ? "log" : "header";
    reader_ = format_of_part(part.file).topics(part.file, options);
    here_.clear();
    chosen_.clear();
    for (std::size_t c = 0; c < fields_.size(); ++c)
      if (const auto field = place_of(part.topics[topic].fields, topics_[topic_].fields[fields_[c]].name)) {
        here_.push_back(c);
        chosen_.push_back(*field);
      }
    reader_->select(topic, chosen_, time, unit_);
  }

  void close_part(Findings& warnings) {
    Findings found;
    reader_->finish(found);
    add(found, warnings);
    bytes_done_ += parts_[at_].bytes;
    reader_.reset();
  }

  // Fields that this part does not have are missing in its rows.
  void hand_over(RowBlock& rows, RowBlock& block) const {
    for (std::vector<double>& column : block.columns) column.assign(rows.rows, kMissing);
    for (std::size_t i = 0; i < here_.size(); ++i) block.columns[here_[i]] = std::move(rows.columns[i]);
    block.time_ns = std::move(rows.time_ns);
    block.rows = rows.rows;
  }

  // With the part in front of every place.
  void add(const Findings& found, Findings& warnings) const {
    const std::string name = name_of(parts_[at_].file);
    for (const Finding& one : found.list()) {
      const std::uint64_t places = one.where.rows.size();
      for (const std::string& place : one.where.rows)
        warnings.add(one.code, one.sentence, place.empty() ? name : name + ", " + place);
      if (one.count > places) warnings.add(one.code, one.sentence, places == 0 ? name : "", one.count - places);
    }
  }

  ReadOptions options_;
  std::vector<Part> parts_;
  std::vector<LogTopic> topics_;
  std::vector<Merged> merged_;
  std::vector<std::string> dialect_;
  Findings listing_;

  bool selected_ = false;
  std::size_t topic_ = 0;
  std::vector<std::size_t> fields_;
  std::optional<std::size_t> time_;
  StampUnit unit_{1};

  std::size_t next_part_ = 0, at_ = 0;
  std::unique_ptr<TopicReader> reader_;     // of the part that is read
  std::vector<std::size_t> here_, chosen_;  // columns that it has, and their fields in it
  std::uint64_t bytes_done_ = 0;
};

}  // namespace

Format rosbag2_format() {
  Format row;
  row.about.name = "rosbag2";
  row.about.title = "ROS 2 recording";
  row.about.topics = true;
  row.about.time_sources = true;
  row.topics = open_topics<Rosbag2Reader>;
  row.about.brief = "folders of rosbag2";
  row.about.otherwise = "a folder of rosbag2, or its `metadata.yaml`";
  row.about.units = "of ROS types";
  row.sniff = [](const std::string& path, std::string_view) { return is_rosbag2(path); };
  return row;
}

}  // namespace libchar
