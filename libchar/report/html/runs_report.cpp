#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "libchar/characterize/curves/model_curve.hpp"
#include "libchar/characterize/model_from_fit.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fit/fit_json.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/charts.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/detail/report_rows.hpp"
#include "libchar/report/html/fleet_report.hpp"
#include "libchar/report/text/characterization_text.hpp"

namespace libchar {
namespace {

/// The channels of each run by itself.
Table single_runs(const RunsReport& report) {
  Table out = channels_table("run");
  out.note = kHeadlineNote;
  for (std::size_t r = 0; r < report.runs.size(); ++r) {
    DeviceRecord record = record_of(report.runs[r]);
    record.report = report.folders[r];
    add_channels(out, record, report.pooled->runs[r].file);
  }
  return out;
}

Json run_links_json(const RunsReport& report) {
  Json out = Json::array();
  for (std::size_t r = 0; r < report.runs.size(); ++r) {
    const LogInfo& log = report.runs[r].log;
    const std::string& folder = report.folders[r];
    out.push_back({{"name", json_text(report.pooled->runs[r].file)},
                   {"file", json_text(log.file)},
                   {"samples", log.samples},
                   {"rate_hz", json_number(log.time.rate_hz)},
                   {"report", folder.empty() ? Json(nullptr) : Json(json_text(folder + "/report.json"))}});
  }
  return out;
}

const ChannelResult& channel_in(const RunsReport& report, const PooledChannel& c, std::size_t run) {
  for (const ChannelResult& one : report.runs[run].channels)
    if (one.channel.name == c.channel.name) return one;
  return report.runs[run].channels.front();
}

Json effects_json(const RandomEffects& e) {
  return {{"mean", json_number(e.mean)},     {"mean_ci95", interval_json(e.mean_ci95)},
          {"spread", json_number(e.spread)}, {"spread_ci95", interval_json(e.spread_ci95)},
          {"p", json_number(e.p)},           {"count", e.count}};
}

Json consistency_json(const PooledChannel& c) {
  Json out = {{"name", json_text(c.channel.name)},
              {"unit", json_text(c.channel.unit)},
              {"consistent", c.consistent},
              {"likelihood_ratio", json_number(c.ratio)},
              {"p", json_number(c.p)},
              {"simulations", c.simulations}};
  out["turn_on_bias"] = c.bias ? effects_json(*c.bias) : Json(nullptr);
  out["runs"] = list_json(c.runs, [&](const ChannelRun& run) {
    return Json({{"run", run.run},
                 {"mean", json_number(run.mean)},
                 {"mean_sd", json_number(run.mean_sd)},
                 {"likelihood_ratio", json_number(run.ratio)},
                 {"p", json_number(run.p)},
                 {"differs", run.differs}});
  });
  out["sentences"] = texts_json(c.sentences);
  return out;
}

const AllanCurve& longest_curve(const RunsReport& report, const PooledChannel& c) {
  const AllanCurve* longest = &channel_in(report, c, c.runs[0].run).allan;
  for (const ChannelRun& run : c.runs) {
    const AllanCurve& one = channel_in(report, c, run.run).allan;
    if (one.points.size() > longest->points.size()) longest = &one;
  }
  return *longest;
}

std::string curves_of(const RunsReport& report, const PooledChannel& c) {
  const AllanCurve& longest = longest_curve(report, c);
  FigureSeries model;
  model.name = model.tip = "the pooled model";
  model.look = {.ink = Ink::black, .dash = 1, .width = 2};
  for (const AllanPoint& point : longest.points)
    if (const auto value = model_deviation(c.fit, longest.type, static_cast<double>(point.m), longest.dt_s)) {
      model.x.push_back(point.tau_s);
      model.y.push_back(*value);
    }
  std::vector<FigureSeries> curves = {std::move(model)};
  for (const ChannelRun& run : c.runs) {
    const std::string& name = report.pooled->runs[run.run].file;
    curves.push_back(allan_series(channel_in(report, c, run.run).allan, run.run,
                                  name + (run.differs ? " (differs)" : ""), run.differs));
  }
  const std::string unit = c.channel.unit.empty() ? "U" : c.channel.unit;
  return curves_figure(std::move(curves), std::string(deviation_row(longest.type).title) + ", " + unit,
                       "Allan curves of all runs of " + c.channel.name);
}

Table runs_table(const RunsReport& report, const PooledChannel& c) {
  Table out("run|mean|moved by noise|2 ln L|p|");
  for (const ChannelRun& run : c.runs)
    out.add({report.pooled->runs[run.run].file, number_text(run.mean), "±" + number_text(run.mean_sd, 2),
             number_text(run.ratio, 3), probability_text(run.p, c.simulations),
             run.differs ? Cell::word("differs", Tint::bad) : Cell()});
  return out;
}

std::string channel_part(const RunsReport& report, const PooledChannel& c) {
  Table pooled(kHeadlines);
  pooled.add(headline_cells(c.channel, c.fit));
  return "<section class=\"channel\">\n<h2>" + html_text(c.channel.name) + " <span class=\"unit\">" +
         html_text(c.channel.unit) + "</span></h2>\n" + bullet_list(c.sentences, "plain") +
         html_table(pooled, {.css = "many"}) + findings_list(c.fit.findings) + curves_of(report, c) +
         folded("The runs one by one", html_table(runs_table(report, c))) + "</section>\n";
}

SensorModel model_of(const RunsReport& report, const PooledChannel& c) {
  const ChannelResult& first = channel_in(report, c, c.runs[0].run);
  ChannelResult pooled = first;
  pooled.channel = c.channel;
  pooled.fit = c.fit;
  SensorModel model = sensor_model_from(pooled, report.runs[c.runs[0].run].log);
  model.obtained = fmt::format("fit of {} recordings together", c.runs.size());
  // One hash is that of one file.
  model.recording.file = fmt::format("{} and {} more", report.pooled->runs[c.runs[0].run].file, c.runs.size() - 1);
  model.recording.sha256.clear();
  for (const ChannelRun& run : c.runs) model.remarks.push_back("run: " + report.pooled->runs[run.run].file);
  if (c.bias && c.bias->spread_ci95.low > 0) model.bias.spread = c.bias->spread;
  if (c.bias) model.mean = c.bias->mean;
  for (const std::string& sentence : c.sentences) model.remarks.push_back(sentence);
  return model;
}

}  // namespace

Json runs_json(const RunsReport& report) {
  Json out = many_head("pooled-runs", report.runs, report.command);
  out["verdict"] = json_text(report.pooled->verdict);
  out["runs"] = run_links_json(report);
  Json fits = Json::array(), channels = Json::array();
  for (const PooledChannel& c : report.pooled->channels) {
    fits.push_back(noise_fit_json(json_text(c.channel.name), json_text(c.channel.unit), c.fit, true));
    channels.push_back(consistency_json(c));
  }
  out["fit"] = noise_fit_document(std::move(fits));
  out["consistency"] = {{"channels", std::move(channels)}};
  out["findings"] = Json::array();
  for (const Finding& one : report.pooled->findings) out["findings"].push_back(document_of(finding_fields(), one));
  if (report.limits != nullptr) out["limits"] = document_of(limit_report_fields(), *report.limits);
  return out;
}

std::string runs_html(const RunsReport& report) {
  std::string body = "<section id=\"overview\">\n<p class=\"verdict\">" + html_text(report.pooled->verdict) + "</p>\n" +
                     findings_list(report.pooled->findings) + "</section>\n";
  if (report.limits != nullptr) body += limits_section(*report.limits);
  for (const PooledChannel& c : report.pooled->channels) body += channel_part(report, c);
  body += "<section class=\"channel\">\n<h2>Each run by itself</h2>\n" +
          html_table(single_runs(report), {.css = "many"}) + "</section>\n" +
          many_provenance(report.runs, report.command);
  return html_page({"Runs of a sensor", fmt::format("{} runs", report.runs.size()),
                    "reportPage.start({}, () => 320);\n", std::string(page_css()) + std::string(many_page_css())},
                   body, json_in_script(runs_json(report)));
}

std::string runs_text(const RunsReport& report, const TextLook& look) {
  std::string out = printable(report.pooled->verdict) + "\n";
  for (const PooledChannel& c : report.pooled->channels) {
    out += "\n" + fit_text(c.channel, c.fit, look) + findings_text(c.fit.findings, 5, look.colours);
    for (const std::string& sentence : c.sentences) out += "  " + printable(sentence) + "\n";
  }
  out += findings_text(report.pooled->findings, 5, look.colours);
  if (report.limits != nullptr) out += limits_text(*report.limits, look);
  return out;
}

std::vector<OutputFile> runs_files(const RunsReport& report, const std::filesystem::path& folder) {
  std::vector<OutputFile> out = {{(folder / "runs.html").string(), runs_html(report)},
                                 {(folder / "runs.json").string(), ""}};
  std::set<std::string> taken;
  for (const PooledChannel& c : report.pooled->channels)
    out.push_back({(folder / (unused_file_name_for(c.channel.name, taken) + ".sensor.yaml")).string(),
                   model_yaml(model_of(report, c))});
  Json document = runs_json(report);
  name_files(document, out);
  out[1].text = dump_json(document);
  return out;
}

}  // namespace libchar
