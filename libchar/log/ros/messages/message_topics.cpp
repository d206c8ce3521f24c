#include "libchar/log/ros/messages/message_topics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/detail/odd_values.hpp"
#include "libchar/log/ros/messages/message_definition.hpp"

namespace libchar {
namespace {

bool whole_number(Primitive kind) { return kind <= Primitive::u64; }

// Fields whose covariance begins with -1 are not measured, says sensor_msgs.
bool not_measured(const MessageDecoder& decoder, const std::vector<double>& example, std::size_t i) {
  const std::string& name = decoder.fields()[i].name;
  const std::string front = name.substr(0, name.find('.')) + "_covariance[0]";
  for (std::size_t k = 0; k < decoder.fields().size(); ++k)
    if (decoder.fields()[k].name == front) return example[k] == -1;
  return false;
}

}  // namespace

std::size_t RawTopics::add(RawTopic topic) {
  const MessageFormat& format = topic.format;
  const std::string other_name = fmt::format("{} ({})", topic.name, format.type);
  std::size_t place = topics_.size();
  for (const std::string& name : {topic.name, other_name})
    if (const auto found = places_.find({name, format.type, format.message_encoding, format.definition});
        found != places_.end())
      place = std::min(place, found->second);
  if (place == topics_.size()) {
    if (names_.contains(topic.name) || names_.contains(other_name)) topic.name = other_name;
    names_.insert(topic.name);
    places_.emplace(std::array{topic.name, format.type, format.message_encoding, format.definition}, place);
    topics_.push_back(std::move(topic));
    return place;
  }
  RawTopic& known = topics_[place];
  if (topic.rows > 0) {
    known.first_ns = known.rows == 0 ? topic.first_ns : std::min(known.first_ns, topic.first_ns);
    known.last_ns = known.rows == 0 ? topic.last_ns : std::max(known.last_ns, topic.last_ns);
  }
  known.rows += topic.rows;
  if (known.format.example.empty()) known.format.example = std::move(topic.format.example);
  return place;
}

MessageTopics::MessageTopics(std::string path, const ReadOptions& options, bool publishes)
    : path_(std::move(path)), time_source_(options.time_source), files_(options.unsaid.msg), publishes_(publishes) {}

std::string MessageTopics::place(const RawMessage& message) const { return fmt::format("byte {}", message.at); }

void MessageTopics::set_topics(std::vector<RawTopic> raw) {
  for (RawTopic& one : raw) add_topic(one);
}

// Of a type that the log does not define: as in the folder of the user, else, of unknown types, as in an installed ROS.
void MessageTopics::define(MessageFormat& format) const {
  if (!format.definition.empty() || format.message_encoding != "cdr") return;
  format.definition = files_.given(format.type);
  if (format.definition.empty() && known_definitions(plain_type_name(format.type)).empty())
    format.definition = MessageFiles::installed(format.type);
  if (!format.definition.empty()) format.definition_encoding = "ros2msg";
}

void MessageTopics::add_topic(RawTopic& raw) {
  define(raw.format);
  LogTopic topic;
  topic.name = raw.name;
  topic.type = raw.format.type;
  topic.rows = raw.rows;
  const double seconds = (static_cast<double>(raw.last_ns) - static_cast<double>(raw.first_ns)) * 1e-9;
  topic.rate_hz = raw.rate_hz;
  if (topic.rate_hz == 0 && raw.rows > 1 && seconds > 0) topic.rate_hz = static_cast<double>(raw.rows - 1) / seconds;
  topic.sensor = sensor_type(plain_type_name(raw.format.type));
  Topic mine;
  const std::vector<std::byte> example = raw.format.example;
  DecoderOrReason made = raw.rows > 0 ? make_decoder(raw.format) : DecoderOrReason{nullptr, "no messages"};
  topic.why_not = made.why_not;
  mine.decoder = std::move(made.decoder);
  if (mine.decoder) {
    const auto& fields = mine.decoder->fields();
    std::vector<double> row(fields.size(), 0);
    std::int64_t stamp = 0;
    std::uint64_t rounded = 0;
    std::vector<std::size_t> all(fields.size());
    for (std::size_t i = 0; i < fields.size(); ++i) all[i] = i;
    mine.decoder->select(all, mine.decoder->stamp());
    const bool seen = !example.empty() && mine.decoder->decode(example, row, stamp, rounded) != Decoded::misfit;
    mine.stamped = mine.decoder->stamp() && (!seen || stamp != 0);
    for (std::size_t i = 0; i < fields.size(); ++i) {
      topic.fields.push_back({fields[i].name, fields[i].unit, whole_number(fields[i].kind)});
      if (fields[i].usual && !(seen && not_measured(*mine.decoder, row, i))) mine.usual.push_back(i);
    }
  }
  topics_.push_back(std::move(topic));
  decoders_.push_back(std::move(mine));
}

std::vector<std::size_t> MessageTopics::usual_fields(std::size_t topic) const { return decoders_[topic].usual; }

void MessageTopics::refuse_source(std::size_t topic, std::string what) const {
  throw usage_error("E0440", path_)
      .says("messages of {} {}", printable(topics_[topic].name), what)
      .got(time_source_)
      .hint("`time_source` log takes the time at which they were recorded");
}

MessageTopics::Source MessageTopics::source_of(std::size_t topic) const {
  const Topic& mine = decoders_[topic];
  if (time_source_ == "log") return Source::log;
  if (time_source_ == "publish") {
    if (!publishes_) refuse_source(topic, "have no time of publication");
    return Source::publish;
  }
  if (time_source_ == "header") {
    if (!mine.decoder || !mine.decoder->stamp()) refuse_source(topic, "have no stamp of their own");
    return Source::header;
  }
  return mine.stamped ? Source::header : Source::log;
}

std::string MessageTopics::stamps(std::size_t topic) const {
  const Source source = source_of(topic);
  if (source == Source::header) {
    const MessageDecoder& decoder = *decoders_[topic].decoder;
    return decoder.fields()[*decoder.stamp()].name;
  }
  return source == Source::log ? "log time" : "publish time";
}

void MessageTopics::select(std::size_t topic, const std::vector<std::size_t>& fields, std::optional<std::size_t> time,
                           StampUnit unit) {
  selected_ = true;
  topic_ = topic;
  fields_ = fields.size();
  source_ = source_of(topic);
  MessageDecoder& decoder = *decoders_[topic].decoder;
  time_field_ = time && time != decoder.stamp();
  unit_ns_ = unit.ns;
  if (time && !time_field_) source_ = Source::header;
  if (!time && source_ == Source::log && time_source_ == "auto" && decoder.stamp())
    early_.add("zero_stamp", "stamps of messages that are 0: the time of recording is taken instead");
  std::vector<std::size_t> slots = fields;
  if (time_field_) slots.push_back(*time);
  row_.assign(slots.size(), kMissing);
  std::optional<std::size_t> stamp;
  if (source_ == Source::header && !time_field_) stamp = decoder.stamp();
  decoder.select(slots, stamp);
  start(topic);
}

// The stamp and, in row_, the numbers of a message. False when it has none that can be used.
bool MessageTopics::row_of(const RawMessage& message, Findings& warnings) {
  stamp_ = source_ == Source::publish ? message.publish_ns : message.log_ns;
  std::uint64_t rounded = 0;
  const Decoded result = decoders_[topic_].decoder->decode(message.data, row_, stamp_, rounded);
  if (result == Decoded::misfit) {
    warnings.add("unreadable_message", "messages that are not of their topic's type were left out", place(message));
    return false;
  }
  if (result == Decoded::other_length)
    warnings.add("array_length",
                 "messages with a longer or shorter array than in the first one: elements beyond it are left out, "
                 "those they lack are missing",
                 place(message));
  if (rounded > 0) warnings.add("rounded_integer", kRoundedIntegers, place(message), rounded);
  if (!time_field_) return true;
  const double ns = row_.back() * static_cast<double>(unit_ns_);
  if (!(std::abs(ns) < 0x1p62)) {
    warnings.add("unreadable_message", "messages without a stamp were left out", place(message));
    return false;
  }
  stamp_ = clamped_whole<std::int64_t>(std::round(ns));
  return true;
}

bool MessageTopics::next(RowBlock& block, std::size_t most, Findings& warnings) {
  warnings.merge(std::exchange(early_, {}));
  std::size_t room = 0;
  const auto make_room = [&](std::size_t rows) {
    for (std::vector<double>& column : block.columns) column.resize(rows);
    block.time_ns.resize(rows);
    room = rows;
  };
  RawMessage message;
  while (block.rows < most && next_message(message, warnings)) {
    if (!row_of(message, warnings)) continue;
    if (block.rows == room) make_room(std::min(most, std::max<std::size_t>(256, 4 * room)));
    for (std::size_t c = 0; c < fields_; ++c) block.columns[c][block.rows] = row_[c];
    block.time_ns[block.rows] = stamp_;
    ++block.rows;
  }
  make_room(block.rows);
  return block.rows > 0;
}

void MessageTopics::finish(Findings& warnings) {
  warnings.merge(std::exchange(early_, {}));
  if (listed_only()) warnings.merge(listing_);
}

}  // namespace libchar
