#include "libchar/report/replay/fuse_report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/report/detail/json_pieces.hpp"

namespace libchar {
namespace {

double share(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

std::string percent(std::uint64_t part, std::uint64_t whole) {
  return percent_text(share(part, whole), 3);
}

Json faults_json(const FuseResult& result) {
  Json out = Json::array();
  for (const FoundFault& fault : result.faults)
    out.push_back({{"sensor", printable(result.sensors[fault.sensor].name)},
                   {"kind", fault.kind},
                   {"from_s", fault.from_s},
                   {"to_s", fault.to_s ? Json(*fault.to_s) : Json(nullptr)}});
  return out;
}

Json sensors_json(const FuseResult& result) {
  Json out = Json::array();
  for (const FusedSensor& sensor : result.sensors)
    out.push_back(
        {{"name", printable(sensor.name)},
         {"channel", sensor.channel.empty() ? Json(nullptr) : Json(printable(sensor.channel))},
         {"unit", printable(sensor.unit)},
         {"missing", share(sensor.missing, result.instants)},
         {"out", share(sensor.out, result.instants)}});
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

Json fuse_json(const FuseResult& result,
               const std::vector<std::string>& command,
               const std::vector<std::string>& files) {
  Json inputs = Json::array();
  for (const LearntInput& input : result.inputs)
    inputs.push_back({{"name", printable(input.name)}, {"unit", printable(input.unit)}});
  Json written = Json::array();
  for (const std::string& file : files) written.push_back(printable(file));
  Json out = document_head("fuse", command, {&result.log});
  for (const Json& warning : warnings_json(result.warnings)) out["warnings"].push_back(warning);
  out["with"] = {{"path", printable(result.file)}, {"sha256", result.file_sha256}};
  out["algorithm"] = printable(result.algorithm.label);
  out["rate_hz"] = result.rate_hz;
  out["rows"] = result.instants;
  out["estimated"] = share(result.estimates, result.instants);
  out["with_deviation"] = share(result.deviations, result.instants);
  out["inputs"] = inputs;
  out["sensors"] = sensors_json(result);
  out["faults"] = faults_json(result);
  out["output"] = written;
  return out;
}

}  // namespace libchar
