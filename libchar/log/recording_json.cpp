#include "libchar/log/recording_json.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "libchar/core/document_file.hpp"
#include "libchar/core/sha256.hpp"
#include "libchar/core/version.hpp"

namespace libchar {
namespace {

Json texts(const std::vector<std::string>& list) {
  Json out = Json::array();
  for (const std::string& text : list) out.push_back(json_text(text));
  return out;
}

Json known_text(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

Json warning_json(const std::string& file, const Warning& w) {
  return {{"file", json_text(file)},
          {"code", w.code},
          {"message", json_text(w.message)},
          {"count", w.count},
          {"where", texts(w.places)}};
}

Json start_json(const TimeBase& time) {
  return time.start_ns ? Json(*time.start_ns) : Json(nullptr);
}

Json time_json(const TimeBase& time) {
  return {{"column", json_text(time.column)},
          {"unit", json_text(time.unit)},
          {"unit_guessed", time.unit_guessed},
          {"from_stamps", time.from_stamps},
          {"start_ns", start_json(time)}};
}

Json topic_json(const LogTopic& topic) {
  Json out = {{"name", json_text(topic.name)},
              {"type", json_text(topic.type)},
              {"rows", topic.rows},
              {"rate_hz", topic.rate_hz > 0 ? json_number(topic.rate_hz) : Json(nullptr)},
              {"why_not", json_text(topic.why_not)},
              {"fields", Json::array()}};
  for (const Channel& field : topic.fields)
    out["fields"].push_back({{"name", json_text(field.name)}, {"unit", json_text(field.unit)}});
  return out;
}

}  // namespace

Json document_head(std::string_view format,
                   const std::vector<std::string>& command,
                   const std::vector<const LogInfo*>& logs) {
  Json head = {{"format", format}, {"version", 1}};
  head["tool"] = {{"name", "sensorchar"}, {"version", std::string(version())}, {"build", build()}};
  head["command"] = texts(command);
  head["input"] = Json::array();
  head["warnings"] = Json::array();
  for (const LogInfo* log : logs) {
    head["input"].push_back({{"path", json_text(log->file)},
                             {"sha256", known_text(log->sha256)},
                             {"bytes", log->bytes}});
    for (const Warning& w : log->warnings.list())
      head["warnings"].push_back(warning_json(log->file, w));
  }
  return head;
}

LogInfo document_info(const std::string& path) {
  const std::string text = read_document_text(path);
  Sha256 hash;
  hash.update(text);
  LogInfo info;
  info.file = path;
  info.sha256 = hash.finish();
  info.bytes = text.size();
  return info;
}

Json channel_json(const Channel& channel, const ChannelQuality& q) {
  Json out = {{"name", json_text(channel.name)}, {"unit", json_text(channel.unit)}};
  out["missing"] = q.missing;
  out["beyond_range"] = q.beyond;
  out["samples"] = q.samples;
  out["integer"] = channel.integer;
  out["mean"] = json_number(q.mean);
  out["standard_deviation"] = json_number(q.standard_deviation);
  out["minimum"] = q.samples > 0 ? json_number(q.minimum) : Json(nullptr);
  out["maximum"] = q.samples > 0 ? json_number(q.maximum) : Json(nullptr);
  out["resolution"] = json_number(q.resolution);
  out["distinct_values"] = q.distinct_values;
  out["saturated"] = q.saturated;
  out["longest_stuck"] = q.longest_stuck;
  out["difference_kurtosis"] =
      q.minimum < q.maximum ? json_number(q.difference_kurtosis) : Json(nullptr);
  out["float32"] = q.float32;
  out["float32_step"] = json_number(q.float32_step);
  out["suggestions"] = texts(q.suggestions);
  return out;
}

// Some facts stand twice: under the keys of `inspect` and under those of reports.
Json recording_json(const LogInfo& log, const std::vector<ChannelQuality>& qualities) {
  const TimeBase& time = log.time;
  Json out = {{"file", json_text(log.file)},
              {"sha256", known_text(log.sha256)},
              {"bytes", log.bytes},
              {"log_format", log.format},
              {"format", log.format},
              {"rows", log.rows},
              {"rows_used", log.rows_used},
              {"rows_dropped", log.rows_dropped},
              {"rows_outside", log.rows_outside},
              {"samples", log.samples},
              {"channels", Json::array()}};
  for (std::size_t i = 0; i < std::min(log.channels.size(), qualities.size()); ++i)
    out["channels"].push_back(channel_json(log.channels[i], qualities[i]));
  out["rate_hz"] = time.rate_hz > 0 ? json_number(time.rate_hz) : Json(nullptr);
  out["jitter_s"] = json_number(time.jitter_s);
  out["max_deviation_s"] = json_number(time.max_deviation_s);
  out["gaps"] = time.gaps;
  out["missing_samples"] = time.missing_samples;
  out["time"] = time_json(time);
  out["time_column"] = json_text(time.column);
  out["time_unit"] = json_text(time.unit);
  out["time_unit_guessed"] = time.unit_guessed;
  out["rate_from_stamps"] = time.from_stamps;
  out["start_ns"] = start_json(time);
  out["repairs"] = Json::object();
  for (const Warning& w : log.warnings.list()) out["repairs"][w.code] = w.count;
  out["guesses"] = texts(log.guesses);
  out["dialect"] = texts(log.dialect);
  if (log.topics.empty()) return out;
  out["topic"] = json_text(log.topic);
  out["topics"] = Json::array();
  for (const LogTopic& topic : log.topics) out["topics"].push_back(topic_json(topic));
  return out;
}

}  // namespace libchar
