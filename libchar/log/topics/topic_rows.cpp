#include "libchar/log/topics/topic_rows.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "libchar/core/file/log_files.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/binary/file.hpp"
#include "libchar/log/detail/channel_choice.hpp"
#include "libchar/log/detail/odd_values.hpp"
#include "libchar/log/tables/table_reader.hpp"

namespace libchar {

namespace {

bool readable(const LogTopic& topic) { return topic.why_not.empty() && !topic.fields.empty(); }

/// Of these that can be read. A table of one row beside recordings, such as a phone's Metadata.csv, is none.
std::vector<std::size_t> recordings_of(const std::vector<LogTopic>& topics, std::vector<std::size_t> some) {
  std::erase_if(some, [&](std::size_t t) { return !readable(topics[t]); });
  const auto one_row = [&](std::size_t t) { return topics[t].rows == 1; };
  if (!std::all_of(some.begin(), some.end(), one_row)) std::erase_if(some, one_row);
  return some;
}

std::vector<std::string> readable_names(const std::vector<LogTopic>& topics) {
  std::vector<std::string> names;
  for (const LogTopic& topic : topics)
    if (readable(topic)) names.push_back(topic.name);
  return names;
}

std::string way_to_read(const LogTopic& topic) {
  return topic.why_not.find("definition of") == std::string::npos
             ? "inspect lists the topics"
             : "`msg` DIR names a folder of its .msg files and of all types in them";
}

void refuse_unreadable(const LogTopic& topic, const std::string& file) {
  if (readable(topic)) return;
  throw usage_error("E0425", file)
      .says(topic.why_not.empty() ? "this topic holds no numbers"
                                  : fmt::format("this topic cannot be read: {}", topic.why_not))
      .got(topic.name)
      .hint(way_to_read(topic));
}

// "/imu0/angular_velocity.x" and "/imu0.angular_velocity.x" are a field of /imu0; the longest topic that fits is meant.
std::optional<std::pair<std::size_t, std::string>> qualified(const std::vector<LogTopic>& topics,
                                                             const std::string& word) {
  std::optional<std::size_t> found;
  for (std::size_t t = 0; t < topics.size(); ++t) {
    const std::string& name = topics[t].name;
    const bool fits = !name.empty() && word.size() > name.size() + 1 && word.starts_with(name) &&
                      (word[name.size()] == '/' || word[name.size()] == '.');
    if (fits && (!found || name.size() > topics[*found].name.size())) found = t;
  }
  if (!found) return std::nullopt;
  return std::pair(*found, word.substr(topics[*found].name.size() + 1));
}

bool field_fits(const std::string& word, const LogTopic& topic, const Channel& field) {
  if (word == field.name) return true;
  if (!is_pattern(word)) return false;
  return matches(word, field.name) || matches(word, topic.name + "/" + field.name) ||
         matches(word, topic.name + "." + field.name);
}

// The topics that hold what a word of `channels` names.
std::set<std::size_t> topics_of(const std::vector<LogTopic>& topics, const std::string& word) {
  if (const auto whole = qualified(topics, word)) return {whole->first};
  std::set<std::size_t> found;
  for (std::size_t t = 0; t < topics.size(); ++t)
    if (std::any_of(topics[t].fields.begin(), topics[t].fields.end(),
                    [&](const Channel& field) { return field_fits(word, topics[t], field); }))
      found.insert(t);
  return found;
}

// The fields that a word means in one topic, by their own names; the word itself when that is for
// the reader to say (c0, a slip).
std::vector<std::string> fields_of(const LogTopic& topic, const std::string& word) {
  std::vector<std::string> fields;
  for (const Channel& field : topic.fields)
    if (field_fits(word, topic, field)) fields.push_back(field.name);
  if (fields.empty()) fields.push_back(word);
  return fields;
}

TopicChoice choice_of(const std::vector<LogTopic>& topics, std::size_t topic, const ReadOptions& options) {
  TopicChoice choice;
  choice.topic = topic;
  for (const std::string& word : options.channels) {
    const std::string name = word.substr(excludes(word) ? 1 : 0);
    const auto whole = qualified(topics, name);
    for (const std::string& field : fields_of(topics[topic], whole && whole->first == topic ? whole->second : name))
      choice.channels.push_back((excludes(word) ? "!" : "") + field);
  }
  return choice;
}

// "sensor_gyro 0" and "GYR 1" are streams of one name, which is enough where there is one.
bool is_instance_of(const std::string& name, const std::string& wanted) {
  const std::size_t front = wanted.size() + 1;
  return name.size() > front && name.starts_with(wanted) && name[wanted.size()] == ' ' &&
         name.find_first_not_of("0123456789", front) == std::string::npos;
}

/// Those that can be read.
std::vector<std::size_t> topics_named(const std::vector<LogTopic>& topics, const std::string& wanted) {
  std::vector<std::size_t> found;
  for (std::size_t t = 0; t < topics.size(); ++t) {
    if (topics[t].name == wanted) return {t};
    if (is_pattern(wanted) ? matches(wanted, topics[t].name) : is_instance_of(topics[t].name, wanted))
      found.push_back(t);
  }
  return recordings_of(topics, std::move(found));
}

std::size_t named_topic(const std::vector<LogTopic>& topics, const std::string& wanted, const std::string& file) {
  const std::vector<std::size_t> found = topics_named(topics, wanted);
  if (!found.empty()) return found[0];
  const std::vector<std::string> names = readable_names(topics);
  throw usage_error("E0425", file)
      .says("there is no topic of this name")
      .got(wanted)
      .hint(did_you_mean(nearest(wanted, names), "it has " + first_names(names)));
}

std::size_t topic_of_channels(const std::vector<LogTopic>& topics, const ReadOptions& options,
                              const std::string& file) {
  std::optional<std::set<std::size_t>> common;
  for (const std::string& word : options.channels) {
    if (excludes(word)) continue;
    const std::set<std::size_t> found = topics_of(topics, word);
    if (found.empty())
      throw usage_error("E0425", file)
          .says("no topic has a channel of this name")
          .got(word)
          .hint("inspect lists topics and their fields; `topic` chooses one");
    if (!common) {
      common = found;
      continue;
    }
    std::erase_if(*common, [&](std::size_t t) { return found.count(t) == 0; });
    if (common->empty())
      throw usage_error("E0425", file)
          .says("these channels are of several topics, and each topic has its own clock")
          .got("{}", fmt::join(options.channels, ","))
          .hint("read one topic at a time, or all side by side: `topic` '*'");
  }
  if (common->size() == 1) return *common->begin();
  std::vector<std::string> names;
  for (const std::size_t t : *common) names.push_back(topics[t].name);
  throw usage_error("E0425", file)
      .says("several topics have this channel: {}", first_names(names))
      .got(options.channels.front())
      .hint("`topic` {} chooses one", names.front());
}

// What a log lost says why nothing of it can be read.
[[noreturn]] void refuse_unreadable_log(const std::vector<LogTopic>& topics, const std::string& file,
                                        const Findings& losses) {
  std::string what, got, hint;
  if (!topics.empty()) {
    const std::string& why = topics.front().why_not;
    what = "none of its topics holds numbers that can be read";
    got = topics.front().name + (why.empty() ? "" : ": " + why);
    if (!why.empty()) hint = way_to_read(topics.front());
  } else if (losses.empty()) {
    what = "holds no messages and no arrays";
    hint = "if it should hold some, it was cut after its beginning: copy it again";
  } else {
    what = "holds no whole message";
  }
  if (!losses.empty()) {
    const Finding& first = losses.list().front();
    what += ": " + first.sentence;
    if (!first.where.rows.empty()) what += fmt::format(" ({})", first.where.rows.front());
  }
  throw input_error("E0426", file).says(std::move(what)).got(std::move(got)).hint(std::move(hint));
}

}  // namespace

std::optional<TopicChoice> choose_topic(const std::vector<LogTopic>& topics, const ReadOptions& options,
                                        const std::string& file) {
  if (!options.topic.empty()) {
    const std::size_t t = named_topic(topics, options.topic, file);
    refuse_unreadable(topics[t], file);
    return choice_of(topics, t, options);
  }
  std::vector<std::size_t> all(topics.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const std::vector<std::size_t> usable = recordings_of(topics, std::move(all));
  std::vector<std::size_t> sensors;
  std::copy_if(usable.begin(), usable.end(), std::back_inserter(sensors),
               [&](std::size_t t) { return topics[t].sensor; });
  if (usable.size() == 1) return choice_of(topics, usable[0], options);
  if (chooses(options) && !usable.empty()) {
    const std::size_t t = topic_of_channels(topics, options, file);
    refuse_unreadable(topics[t], file);
    return choice_of(topics, t, options);
  }
  if (sensors.size() != 1) return std::nullopt;
  TopicChoice choice = choice_of(topics, sensors[0], options);
  choice.guess = fmt::format("topic: {}, the only one of {} that is a sensor's (`topic` takes another one)",
                             printable(topics[sensors[0]].name), usable.size());
  return choice;
}

std::vector<TopicChoice> choose_topics(const std::vector<LogTopic>& topics, const ReadOptions& options,
                                       const std::string& file) {
  const std::vector<std::size_t> named = topics_named(topics, options.topic);
  if (options.topic.empty() || named.size() < 2) return {};
  std::vector<ReadOptions> parts(named.size(), options);
  for (ReadOptions& part : parts) part.channels.clear();
  for (const std::string& word : options.channels) {
    const std::set<std::size_t> having = topics_of(topics, word.substr(excludes(word) ? 1 : 0));
    bool known = false;
    for (std::size_t k = 0; k < named.size(); ++k)
      if (having.contains(named[k])) {
        parts[k].channels.push_back(word);
        known = true;
      }
    if (known) continue;
    std::vector<std::string> names;
    for (const std::size_t t : named)
      for (const Channel& field : topics[t].fields) names.push_back(topics[t].name + "/" + field.name);
    refuse_channel(word, names, options, file);
  }
  std::vector<TopicChoice> chosen;
  for (std::size_t k = 0; k < named.size(); ++k)
    if (!chooses(options) || chooses(parts[k])) chosen.push_back(choice_of(topics, named[k], parts[k]));
  return chosen;
}

const LogTopic& likely_topic(const std::vector<LogTopic>& topics) {
  return *std::max_element(topics.begin(), topics.end(), [](const LogTopic& a, const LogTopic& b) {
    return std::tuple(readable(a), a.sensor, a.rows) < std::tuple(readable(b), b.sensor, b.rows);
  });
}

void refuse_without_topic(const std::vector<LogTopic>& topics, const std::string& file, const Findings& losses) {
  const std::vector<std::string> names = readable_names(topics);
  if (names.empty()) refuse_unreadable_log(topics, file, losses);
  throw usage_error("E0427", file)
      .says("holds {} topics, each with a clock of its own: {}", names.size(), first_names(names))
      .hint("`topic` {} chooses one, `topic` '*' reads all side by side", likely_topic(topics).name);
}

namespace {

class TopicRows final : public RowSource {
 public:
  TopicRows(std::unique_ptr<TopicReader> reader, const std::string& path, std::string_view format,
            const ReadOptions& options)
      : reader_(std::move(reader)), files_(open_all(path)), hash_(pointers(), options.hash) {
    info_.file = path;
    info_.format = format;
    for (const auto& file : files_) info_.bytes += file->size();
    info_.topics = reader_->topics();
    info_.dialect = reader_->dialect();
    const auto choice = info_.topics.empty() ? std::nullopt : choose_topic(info_.topics, options, path);
    if (!choice) {
      Findings losses;
      reader_->finish(losses);
      refuse_without_topic(info_.topics, path, losses);
    }
    topic_ = choice->topic;
    describe_topic(*choice);
    ReadOptions chosen = options;
    chosen.channels = choice->channels;
    choose_fields(chosen);
  }

  const LogInfo& info() const override { return info_; }
  std::uint64_t bytes_read() const override { return reader_->bytes_read(); }
  std::uint64_t bytes_total() const override { return info_.bytes; }
  std::string sha256() override { return hash_.finish(); }

  bool next(RowBlock& block, Findings& warnings) override {
    if (rows_ == 0) hash_.start();
    block.rows = 0;
    block.columns.resize(info_.channels.size());
    for (std::vector<double>& column : block.columns) column.clear();
    block.time_ns.clear();
    block.first_line = 0;
    block.line_offset.clear();
    if (!reader_->next(block, rows_per_block_, warnings)) return false;
    if (ignore_stamps_) block.time_ns.clear();
    for (std::size_t c = 0; c < block.columns.size(); ++c) drop_non_finite(c, block.columns[c], warnings);
    rows_ += block.rows;
    return true;
  }

  void finish(Findings& warnings) override {
    reader_->finish(warnings);
    std::uint64_t count = 0;
    for (const std::uint64_t n : missing_per_channel_) count += n;
    if (count == 0) return;
    const std::string message = missing_cells(info_.channels, missing_per_channel_);
    for (const std::string& place : missing_places_) warnings.add("missing_cell", message, place);
    if (count > missing_places_.size()) warnings.add("missing_cell", message, "", count - missing_places_.size());
  }

  std::string place(const RowBlock&, std::size_t i, std::uint64_t rows_before) const override {
    return place_of(rows_before + i);
  }

 private:
  static std::vector<std::unique_ptr<BinaryFile>> open_all(const std::string& path) {
    std::vector<std::unique_ptr<BinaryFile>> files;
    for (const std::string& file : files_of_log(path)) files.push_back(std::make_unique<BinaryFile>(file));
    return files;
  }
  std::vector<const BinaryFile*> pointers() const {
    std::vector<const BinaryFile*> all;
    for (const auto& file : files_) all.push_back(file.get());
    return all;
  }

  const LogTopic& topic() const { return info_.topics[topic_]; }

  std::string place_of(std::uint64_t row) const {
    return topic().name.empty() ? fmt::format("row {}", row)
                                : fmt::format("row {} of {}", row, printable(topic().name));
  }

  void describe_topic(const TopicChoice& choice) {
    info_.topic = topic().name;
    info_.rows = topic().rows;
    if (!topic().name.empty())
      info_.dialect.push_back(topic().type.empty() ? fmt::format("topic {}", topic().name)
                                                   : fmt::format("topic {}, {}", topic().name, topic().type));
    if (!choice.guess.empty()) info_.guesses.push_back(choice.guess);
  }

  void choose_fields(const ReadOptions& options) {
    const std::vector<Channel>& fields = topic().fields;
    const std::string stamps = reader_->stamps(topic_);
    const bool own_stamps = !stamps.empty() && options.time_column == "auto";
    TableColumns columns;
    for (const Channel& field : fields) columns.names.push_back(field.name);
    const TableFront table = front();
    if (!own_stamps && (stamps.empty() || options.time_column != "none"))
      columns.time = find_time_column(table, options, info_);
    StampUnit unit{1};
    if (columns.time) {
      info_.time.column = fields[*columns.time].name;
      unit = find_time_unit(table, *columns.time, options, info_);
    } else if (own_stamps) {
      info_.time.column = stamps;
      info_.time.unit = "ns";
      info_.time.unit_ns = 1;
    } else {
      info_.time.rate_hz = reader_->stated_rate_hz(topic_);
    }
    ignore_stamps_ = !own_stamps && !columns.time;
    const std::vector<std::size_t> chosen = chosen_fields(columns, options);
    for (const std::size_t i : chosen) info_.channels.push_back(fields[i]);
    missing_per_channel_.assign(chosen.size(), 0);
    rows_per_block_ = std::max<std::size_t>(1, options.block_bytes / (sizeof(double) * (chosen.size() + 1)));
    reader_->select(topic_, chosen, columns.time, unit);
  }

  // Those asked for, or the usual ones; fields that are left out by default are said.
  std::vector<std::size_t> chosen_fields(const TableColumns& columns, const ReadOptions& options) {
    std::vector<std::size_t> chosen = choose_channels(columns, options, info_.file);
    if (chooses(options)) return chosen;
    const std::vector<std::size_t> usual = reader_->usual_fields(topic_);
    std::vector<std::size_t> kept;
    for (const std::size_t i : chosen)
      if (std::find(usual.begin(), usual.end(), i) != usual.end()) kept.push_back(i);
    if (kept.empty() || kept.size() == chosen.size()) return chosen;
    info_.dialect.push_back(fmt::format("{} left out that no sensor measures, such as {} (`channels` reads them)",
                                        plural(chosen.size() - kept.size(), "field"),
                                        printable(left_out(chosen, kept, columns))));
    return kept;
  }

  static std::string left_out(const std::vector<std::size_t>& all, const std::vector<std::size_t>& kept,
                              const TableColumns& columns) {
    for (const std::size_t i : all)
      if (std::find(kept.begin(), kept.end(), i) == kept.end()) return columns.names[i];
    return "";
  }

  TableFront front() const {
    TableFront table;
    table.named = true;
    if (const double rate = reader_->stated_rate_hz(topic_); rate > 0) table.stated_rate_hz = rate;
    for (const Channel& field : topic().fields) table.columns.push_back({field.name, field.unit});
    table.first_values = [this](std::size_t field) { return reader_->first_values(topic_, field); };
    return table;
  }

  // Infinity is no sample; every NaN becomes the one that means "missing".
  void drop_non_finite(std::size_t channel, std::vector<double>& values, Findings& warnings) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (std::isfinite(values[i])) continue;
      const std::string place =
          fmt::format("{}, field {}", place_of(rows_ + i), printable(info_.channels[channel].name));
      if (std::isinf(values[i])) {
        warnings.add("infinite_value", kInfiniteValues, place);
      } else {
        ++missing_per_channel_[channel];
        if (missing_places_.size() < 3) missing_places_.push_back(place);
      }
      values[i] = kMissing;
    }
  }

  std::unique_ptr<TopicReader> reader_;
  std::vector<std::unique_ptr<BinaryFile>> files_;
  FileHash hash_;
  LogInfo info_;
  std::size_t topic_ = 0;
  bool ignore_stamps_ = false;
  std::size_t rows_per_block_ = 1;
  std::uint64_t rows_ = 0;
  std::vector<std::uint64_t> missing_per_channel_;
  std::vector<std::string> missing_places_;
};

}  // namespace

std::unique_ptr<RowSource> open_topic_rows(std::unique_ptr<TopicReader> reader, const std::string& path,
                                           std::string_view format, const ReadOptions& options) {
  if (auto* tables = dynamic_cast<TableReader*>(reader.get())) {
    static_cast<void>(reader.release());
    return open_table_rows(std::unique_ptr<TableReader>(tables), path, format, options);
  }
  return std::make_unique<TopicRows>(std::move(reader), path, format, options);
}

}  // namespace libchar
