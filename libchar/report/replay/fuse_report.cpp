#include "libchar/report/replay/fuse_report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "libchar/core/not_known.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/replay/report/replay_report.hpp"
#include "libchar/report/detail/json_pieces.hpp"
#include "libchar/report/detail/report_rows.hpp"

namespace libchar {
namespace {

double share(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

std::string percent(std::uint64_t part, std::uint64_t whole) {
  return percent_text(share(part, whole), 3);
}

struct ReportedUse {
  std::string name, channel, unit;
  double missing = 0, out = 0;
};

std::vector<ReportedUse> uses_of(const FuseResult& result) {
  std::vector<ReportedUse> out;
  for (const FusedSensor& sensor : result.sensors)
    out.push_back({sensor.name,
                   sensor.channel,
                   sensor.unit,
                   share(sensor.missing, result.instants),
                   share(sensor.out, result.instants)});
  return out;
}

std::vector<ReplayReport::Fault> faults_of(const FuseResult& result) {
  std::vector<ReplayReport::Fault> out;
  for (const FoundFault& fault : result.faults)
    out.push_back({result.sensors[fault.sensor].name,
                   fault.kind,
                   kNone,
                   fault.from_s,
                   fault.to_s.value_or(kNone)});
  return out;
}

}  // namespace

std::string fuse_text(const FuseResult& result, const std::vector<std::string>& files) {
  std::string out = fmt::format("{}: {} instants at {} Hz fused by {}, {} with an estimate",
                                printable(result.log.file),
                                result.instants,
                                brief_text(result.rate_hz, 6),
                                result.algorithm.label,
                                percent(result.estimates, result.instants));
  out += result.deviations == 0
             ? fmt::format("; {} states no standard deviation\n", result.algorithm.label)
             : fmt::format(", {} with a standard deviation\n",
                           percent(result.deviations, result.instants));
  for (const FusedSensor& sensor : result.sensors) {
    if (sensor.missing == 0 && sensor.out == 0) continue;
    out += fmt::format("{}: missing {} of the time",
                       printable(sensor.name),
                       percent(sensor.missing, result.instants));
    out += sensor.out > 0 ? fmt::format(", taken out {}\n", percent(sensor.out, result.instants))
                          : "\n";
  }
  out += "wrote";
  for (const std::string& file : files) out += " " + printable(file);
  return out + "\n";
}

const Fields<FuseResult>& fuse_fields() {
  using T = FuseResult;
  using U = ReportedUse;
  static const Fields<T> with = always(Fields<T>{
      field<&T::file>("path"),
      field<&T::file_sha256>("sha256"),
  });
  static const Fields<LearntInput> inputs = always(Fields<LearntInput>{
      field<&LearntInput::name>("name"),
      field<&LearntInput::unit>("unit"),
  });
  static const Fields<U> sensors = always(Fields<U>{
      field<&U::name>("name"),
      field_or_null<&U::channel>("channel"),
      field<&U::unit>("unit"),
      field<&U::missing>("missing", {.meaning = "share of the instants without a sample"}),
      field<&U::out>("out", {.meaning = "share at which the algorithm had it out"}),
  });
  static const Fields<T> rows = always(Fields<T>{
      level<T>("with", with),
      field<&T::algorithm, &LearntAlgorithm::label>("algorithm"),
      field<&T::rate_hz>("rate_hz"),
      field<&T::instants>("rows"),
      computed<[](const T& r) { return share(r.estimates, r.instants); }>("estimated"),
      computed<[](const T& r) { return share(r.deviations, r.instants); }>("with_deviation"),
      list_of<&T::inputs>("inputs", inputs),
      computed_list<uses_of>("sensors", sensors),
      computed_list<faults_of>("faults", ReplayReport::Fault::found_fields()),
  });
  return rows;
}

Json fuse_json(const FuseResult& result,
               const std::vector<std::string>& command,
               const std::vector<std::string>& files) {
  Json out = document_head("fuse", command, {&result.log}, result.warnings);
  out.update(document_of(fuse_fields(), result));
  out["output"] = texts_json(files);
  return out;
}

}  // namespace libchar
