// Reading a report.json of `replay` back: only what a comparison needs, each refusal with its place
// in the document.

#include <fmt/format.h>

#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"
#include "libchar/report/comparison.hpp"

namespace libchar {
namespace {

constexpr int kNewest = 1;

// A value and where it stands.
class Node {
 public:
  Node(const Json& json, std::string file, std::string path)
      : json_(&json), file_(std::move(file)), path_(std::move(path)) {}

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error({ErrorKind::input,
                 "E0922",
                 file_ + (path_.empty() ? "" : " (at " + path_ + ")"),
                 what,
                 "",
                 "compare takes the report.json that `sensorchar replay` wrote"});
  }

  Node operator[](const std::string& key) const {
    if (!json_->is_object()) refuse("expected an object");
    const std::string path = path_.empty() ? key : path_ + "." + key;
    const auto found = json_->find(key);
    if (found == json_->end()) Node(*json_, file_, path).refuse("this key is missing");
    return {*found, file_, path};
  }
  bool null() const { return json_->is_null(); }
  const Json& json() const { return *json_; }

  std::vector<Node> list() const {
    if (!json_->is_array()) refuse("expected a list");
    std::vector<Node> out;
    for (std::size_t i = 0; i < json_->size(); ++i)
      out.emplace_back((*json_)[i], file_, fmt::format("{}[{}]", path_, i));
    return out;
  }
  std::string text() const {
    if (!json_->is_string()) refuse("expected a text");
    return json_->get<std::string>();
  }
  bool truth() const {
    if (!json_->is_boolean()) refuse("expected true or false");
    return json_->get<bool>();
  }
  std::optional<double> number() const {
    if (null()) return std::nullopt;
    if (!json_->is_number()) refuse("expected a number or null");
    return json_->get<double>();
  }
  std::optional<Interval> interval() const {
    if (null()) return std::nullopt;
    const auto ends = list();
    if (ends.size() != 2) refuse("expected two numbers");
    const auto low = ends[0].number(), high = ends[1].number();
    if (!low || !high) return std::nullopt;
    return Interval{*low, *high};
  }

 private:
  const Json* json_;
  std::string file_, path_;
};

void refuse_format(const Json& document, const std::string& file) {
  const auto format = document.is_object() ? document.find("format") : document.end();
  const bool named = document.is_object() && format != document.end() && format->is_string();
  if (!named || *format != "replay-report")
    throw Error({ErrorKind::input,
                 "E0920",
                 file,
                 named ? "this is a document of another format; compare takes replay-report"
                       : "this JSON does not say that it is a replay-report",
                 named ? format->get<std::string>() : "",
                 "compare takes the report.json that `sensorchar replay` wrote"});
  const auto version = document.find("version");
  if (version == document.end() || !version->is_number_integer() || *version < 1)
    throw Error({ErrorKind::input,
                 "E0922",
                 file + " (at version)",
                 "expected a whole number from 1",
                 "",
                 ""});
  if (*version > kNewest)
    throw Error({ErrorKind::input,
                 "E0921",
                 file,
                 fmt::format("replay-report of version {} is newer than this program reads ({})",
                             version->dump(),
                             kNewest),
                 "",
                 "use the sensorchar that wrote it"});
}

ReportedAlgorithm algorithm(const Node& node, bool reference) {
  ReportedAlgorithm out;
  out.label = node["label"].text();
  const std::string status = node["status"].text();
  if (status != "ran" && status != "skipped") node["status"].refuse("expected ran or skipped");
  out.ran = status == "ran";
  out.bound = node["bound"].truth();
  if (!out.ran) out.why = node["why"].text();
  const Node blind = node["without_reference"];
  if (reference) {
    out.score = node["rmse"].number();
    out.score_ci95 = node["rmse_ci95"].interval();
  } else if (!blind.null()) {
    out.score = blind["leave_one_out_rms"].number();
    out.score_ci95 = blind["leave_one_out_ci95"].interval();
  }
  out.regret = node["regret"].number();
  out.ns_per_sample = node["ns_per_sample"].number();
  out.peak_bytes = node["peak_bytes"].number();
  return out;
}

std::string listed(const std::vector<std::string>& texts) {
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::string of_stretch(const Node& document) {
  return fmt::format("{} instants at {} Hz from {} s",
                     document["instants"].json().dump(),
                     document["rate_hz"].json().dump(),
                     document["start_s"].json().dump());
}

std::string of_reference(const Node& reference) {
  if (reference.null()) return "none";
  std::vector<std::string> channels;
  for (const Node& channel : reference["channels"].list()) channels.push_back(channel.text());
  return listed(channels) + (reference["mean"].truth() ? " (their mean)" : "") + ", " +
         reference["use"].text();
}

std::vector<std::pair<std::string, std::string>> identity(const Node& document) {
  std::vector<std::string> recordings, sensors, inputs, faults;
  for (const Node& input : document["input"].list())
    recordings.push_back("SHA-256 " + input["sha256"].text());
  const Node scene = document["scene"];
  const bool simulated = scene["simulated"].truth();
  for (const Node& sensor : document["sensors"].list())
    sensors.push_back(sensor["name"].text() + " [" + sensor["unit"].text() + "]");
  for (const Node& input : document["inputs"].list())
    inputs.push_back(input["name"].text() + " [" + input["unit"].text() + "]");
  for (const Node& fault : document["faults"].list())
    faults.push_back(fault["sensor"].text() + " " + fault["kind"].text() + " " +
                     fault["value"].json().dump() + " from " + fault["from_s"].json().dump() +
                     " to " + fault["to_s"].json().dump() + " s");
  return {{"recording", recordings.empty() ? "none (simulated)" : listed(recordings)},
          {"seed of the simulation", simulated ? scene["seed"].json().dump() : "none"},
          {"list of sensors and units", listed(sensors)},
          {"list of inputs and units", listed(inputs)},
          {"reference", of_reference(document["reference"])},
          {"evaluation", of_stretch(document)},
          {"list of faults", faults.empty() ? "none" : listed(faults)},
          {"simulation (models, signals or their options)",
           simulated ? "SHA-256 " + scene["identity"].text() : "none"}};
}

}  // namespace

ReportedReplay read_reported_replay(std::string_view text, const std::string& file) {
  const Json json = parse_json(text, file);
  refuse_format(json, file);
  const Node document(json, file, "");
  ReportedReplay out;
  out.file = file;
  out.scene = document["scene"]["name"].text();
  if (out.scene.empty()) out.scene = document["scene"]["file"].text();
  out.score = document["score"].text();
  if (out.score != "rmse" && out.score != "leave_one_out_rms")
    document["score"].refuse("expected rmse or leave_one_out_rms");
  const auto inputs = document["inputs"].list();
  if (!inputs.empty()) out.unit = inputs[0]["unit"].text();
  out.identity = identity(document);
  for (const Node& node : document["algorithms"].list()) {
    out.algorithms.push_back(algorithm(node, out.score == "rmse"));
    for (std::size_t i = 0; i + 1 < out.algorithms.size(); ++i)
      if (out.algorithms[i].label == out.algorithms.back().label)
        node["label"].refuse("two algorithms have this label");
  }
  return out;
}

}  // namespace libchar
