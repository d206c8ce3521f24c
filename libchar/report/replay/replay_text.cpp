#include "libchar/report/replay/replay_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/replay/view/words.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/detail/report_rows.hpp"
#include "libchar/report/detail/tables/replay_tables.hpp"

namespace libchar {

std::string replay_text(const ReplayView& view, std::size_t width) {
  std::string text = printable(view.title) + ": ";
  for (const std::string& fact : run_facts(view)) text += printable(fact) + "\n";
  text += "\n" + terminal_table(algorithms_table(view), {width}, "") + kStarNote + "\n";
  for (const std::string& skipped : skipped_words(view)) text += "skipped " + printable(skipped) + "\n";
  text += alignment_text(view, {width});
  text += "\n";
  for (const std::string& sentence : view.shown_verdict) text += printable(sentence) + "\n";
  return text;
}

namespace {

std::string option_text(const fusion::Option& option) {
  return fmt::format("{:<28}   {} = {}{}  {}\n", "", option.name, brief_text(option.standard, 6),
                     option.unit.empty() ? "" : " " + std::string(option.unit), option.meaning);
}

}  // namespace

std::string algorithms_text() {
  std::string text;
  std::vector<std::string_view> watched;
  std::span<const fusion::Option> watching;
  for (const fusion::Entry& entry : fusion::algorithms()) {
    if (entry.own_options < entry.options.size()) {
      watched.push_back(entry.description->name);
      watching = entry.options.subspan(entry.own_options);
    }
    text += fmt::format("{:<28} {}\n", entry.description->name, entry.description->title);
    for (const std::string& need : needs_in_words(*entry.description))
      text += fmt::format("{:<28}   needs {}\n", "", need);
    for (const fusion::Option& option : entry.options.first(entry.own_options)) text += option_text(option);
  }
  if (watched.empty()) return text;
  text += fmt::format("\n  as well as their own options {} have\n", fmt::join(watched, ", "));
  for (const fusion::Option& option : watching) text += option_text(option);
  return text;
}

namespace {

std::string section(const char* head, const Table& table) {
  return table.rows.empty() ? "" : fmt::format("\n## {}\n\n", head) + table_text(table);
}

std::string several_inputs(const ReplayView& view) {
  std::string out;
  for (const Table& table : input_tables(view)) out += "\n" + table_text(table);
  return out;
}

std::string faults_section(const ReplayView& view) {
  if (view.result->faults.empty()) return "";
  const Table detection = detection_table(view);
  return section("Faults", faults_table(view)) + (detection.rows.empty() ? "" : "\n" + table_text(detection));
}

std::string markdown_list(const char* head, const std::vector<std::string>& items) {
  std::string out;
  for (const std::string& item : items) out += "- " + markdown_text(item) + "\n";
  return out.empty() ? "" : fmt::format("\n## {}\n\n", head) + out;
}

std::vector<std::string> warning_words(const ReplayView& view) {
  std::vector<std::string> out;
  const auto add = [&](const std::string& of, const Findings& warnings) {
    for (const Finding& w : warnings.list())
      out.push_back(of + w.sentence + (w.count > 1 ? fmt::format(" ({} ×)", w.count) : ""));
  };
  add("", view.result->warnings);
  for (const LogInfo& log : view.result->logs) add(log.file + ": ", log.warnings);
  for (std::string& remark : remark_words(view)) out.push_back(std::move(remark));
  return out;
}

}  // namespace

std::string replay_markdown(const ReplayView& view) {
  std::string out = fmt::format("# {}\n\n{}\n\n", markdown_text(view.title),
                                markdown_text(fmt::format("{}", fmt::join(view.shown_verdict, " "))));
  out += markdown_text(fmt::format("{}", fmt::join(run_facts(view), " "))) + "\n\n" +
         table_text(algorithms_table(view)) + "\n" + markdown_text(kStarNote) + "\n";
  return out + markdown_list("Skipped", skipped_words(view)) + several_inputs(view) + alignment_markdown(view) +
         section("Sensors", sensors_table(view)) + faults_section(view) +
         markdown_list("Warnings", warning_words(view));
}

std::string replay_markdown(const ReplayResult& result) { return replay_markdown(replay_view(result)); }

namespace {

double share(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

std::string percent(std::uint64_t part, std::uint64_t whole) { return percent_text(share(part, whole), 3); }

struct ReportedUse {
  std::string name, channel, unit;
  double missing = 0, out = 0;
};

std::vector<ReportedUse> uses_of(const FuseResult& result) {
  std::vector<ReportedUse> out;
  for (const FusedSensor& sensor : result.sensors)
    out.push_back({sensor.name, sensor.channel, sensor.unit, share(sensor.missing, result.instants),
                   share(sensor.out, result.instants)});
  return out;
}

std::vector<ReplayReport::Fault> faults_of(const FuseResult& result) {
  std::vector<ReplayReport::Fault> out;
  for (const FoundFault& fault : result.faults)
    out.push_back({result.sensors[detail::in_memory(fault.sensor)].name, fault.kind, kNone, fault.from_s,
                   fault.to_s.value_or(kNone)});
  return out;
}

}  // namespace

std::string fuse_text(const FuseResult& result, const std::vector<std::string>& files) {
  std::string out = fmt::format("{}: {} instants at {} fused by {}, {} with an estimate", printable(result.log.file),
                                result.instants, detail::frequency_text(result.rate_hz, 6), result.algorithm.label,
                                percent(result.estimates, result.instants));
  out += result.deviations == 0
             ? fmt::format("; {} states no standard deviation\n", result.algorithm.label)
             : fmt::format(", {} with a standard deviation\n", percent(result.deviations, result.instants));
  for (const FusedSensor& sensor : result.sensors) {
    if (sensor.missing == 0 && sensor.out == 0) continue;
    out += printable(sensor.name) + ":";
    if (sensor.missing > 0) out += fmt::format(" missing {} of the time", percent(sensor.missing, result.instants));
    if (sensor.missing > 0 && sensor.out > 0) out += ",";
    if (sensor.out > 0) out += fmt::format(" taken out {} of the time", percent(sensor.out, result.instants));
    out += "\n";
  }
  for (const LearntInput& input : result.inputs)
    if (input.reference_offset)
      out += fmt::format("{}: as the sensors read it; the reference of the replay read {} more\n",
                         printable(input.name), with_unit(*input.reference_offset, 4, input.unit));
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
      field<&LearntInput::reference_offset>("reference_offset", {.written = Written::when_set}),
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

Json fuse_json(const FuseResult& result, const std::vector<std::string>& command,
               const std::vector<std::string>& files) {
  Json out = document_head("fuse", command, {&result.log}, result.warnings);
  out.update(document_of(fuse_fields(), result));
  out["output"] = texts_json(files);
  return out;
}

}  // namespace libchar
