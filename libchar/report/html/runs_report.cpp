#include "libchar/report/html/runs_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/characterize/curves/model_curve.hpp"
#include "libchar/characterize/model_from_fit.hpp"
#include "libchar/core/file/file_name.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/text/text_table.hpp"
#include "libchar/fit/fit_json.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html/html_page.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/detail/html/limits_pieces.hpp"
#include "libchar/report/detail/html/many_pieces.hpp"
#include "libchar/report/detail/json_pieces.hpp"
#include "libchar/report/detail/report_rows.hpp"
#include "libchar/report/detail/svg/svg_curves.hpp"
#include "libchar/report/text/fit_text.hpp"
#include "libchar/report/text/limits_text.hpp"

namespace libchar {
namespace {

/// The channels of each run by itself.
std::vector<ChannelRow> single_rows(const RunsReport& report) {
  std::vector<ChannelRow> out;
  for (std::size_t r = 0; r < report.runs.size(); ++r) {
    DeviceRecord record = record_of(report.runs[r]);
    record.report = report.folders[r];
    for (ChannelRow& row : channel_rows(record, report.pooled->runs[r].file))
      out.push_back(std::move(row));
  }
  return out;
}

Json run_links_json(const RunsReport& report) {
  Json out = Json::array();
  for (std::size_t r = 0; r < report.runs.size(); ++r) {
    const LogInfo& log = report.runs[r].log;
    const std::string& folder = report.folders[r];
    out.push_back(
        {{"name", json_text(report.pooled->runs[r].file)},
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
  return {{"mean", json_number(e.mean)},
          {"mean_ci95", interval_json(e.mean_ci95)},
          {"spread", json_number(e.spread)},
          {"spread_ci95", interval_json(e.spread_ci95)},
          {"p", json_number(e.p)},
          {"count", e.count}};
}

Json consistency_json(const PooledChannel& c) {
  Json out = {{"name", json_text(c.channel.name)},
              {"unit", json_text(c.channel.unit)},
              {"consistent", c.consistent},
              {"likelihood_ratio", json_number(c.ratio)},
              {"p", json_number(c.p)},
              {"simulations", c.simulations}};
  out["turn_on_bias"] = c.bias ? effects_json(*c.bias) : Json(nullptr);
  out["runs"] = Json::array();
  for (const ChannelRun& run : c.runs)
    out["runs"].push_back({{"run", run.run},
                           {"mean", json_number(run.mean)},
                           {"mean_sd", json_number(run.mean_sd)},
                           {"likelihood_ratio", json_number(run.ratio)},
                           {"p", json_number(run.p)},
                           {"differs", run.differs}});
  out["sentences"] = Json::array();
  for (const std::string& sentence : c.sentences) out["sentences"].push_back(json_text(sentence));
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
  std::vector<SvgCurve> curves;
  for (const ChannelRun& run : c.runs) {
    const AllanCurve& allan = channel_in(report, c, run.run).allan;
    SvgCurve curve = allan_svg(allan);
    curve.name = run.differs ? report.pooled->runs[run.run].file + " (differs)"
                             : report.pooled->runs[run.run].file;
    curve.colour = run.run;
    curve.strong = run.differs;
    curves.push_back(std::move(curve));
  }
  SvgCurve model;
  model.name = "the pooled model";
  model.model = true;
  const AllanCurve& longest = longest_curve(report, c);
  for (const AllanPoint& point : longest.points)
    if (const auto value =
            model_deviation(c.fit, longest.type, static_cast<double>(point.m), longest.dt_s)) {
      model.x.push_back(point.tau_s);
      model.y.push_back(*value);
    }
  curves.insert(curves.begin(), std::move(model));
  const std::string unit = c.channel.unit.empty() ? "U" : c.channel.unit;
  return svg_curves(curves,
                    {"averaging time τ, s",
                     std::string(name_of(longest.type)) + ", " + unit,
                     "Allan curves of all runs of " + c.channel.name});
}

std::string runs_rows(const RunsReport& report, const PooledChannel& c) {
  std::string out =
      "<details><summary>The runs one by one</summary>\n<div class=\"wide\"><table>\n" +
      table_head({"Run", "Mean", "moved by noise", "2 ln L", "p", ""});
  for (const ChannelRun& run : c.runs)
    out += fmt::format(
        "<tr><th "
        "scope=\"row\">{}</th><td>{}</td><td>±{}</td><td>{}</td><td>{}</td><td{}</td></tr>\n",
        html_text(report.pooled->runs[run.run].file),
        html_text(number_text(run.mean)),
        html_text(number_text(run.mean_sd, 2)),
        html_text(number_text(run.ratio, 3)),
        html_text(probability_text(run.p, c.simulations)),
        run.differs ? " class=\"out\">differs" : ">");
  return out + "</tbody></table></div>\n</details>\n";
}

std::string channel_part(const RunsReport& report, const PooledChannel& c) {
  std::string out = "<section class=\"channel\">\n<h2>" + html_text(c.channel.name) +
                    " <span class=\"unit\">" + html_text(c.channel.unit) + "</span></h2>\n" +
                    bullet_list(c.sentences, "plain");
  std::vector<std::string> heads = coefficient_heads();
  out += "<div class=\"wide\"><table class=\"many\">\n" + table_head(heads) + "<tr>";
  for (const std::string& cell : coefficient_cells(c.channel, c.fit))
    out += "<td class=\"n\">" + html_text(cell) + "</td>";
  out += "</tr></tbody></table></div>\n" + findings_list(c.fit.findings);
  return out + curves_of(report, c) + runs_rows(report, c) + "</section>\n";
}

SensorModel model_of(const RunsReport& report, const PooledChannel& c) {
  const ChannelResult& first = channel_in(report, c, c.runs[0].run);
  ChannelResult pooled = first;
  pooled.channel = c.channel;
  pooled.fit = c.fit;
  SensorModel model = sensor_model_from(pooled, report.runs[c.runs[0].run].log);
  model.obtained = fmt::format("fit of {} recordings together", c.runs.size());
  // One hash is that of one file.
  model.recording_file =
      fmt::format("{} and {} more", report.pooled->runs[c.runs[0].run].file, c.runs.size() - 1);
  model.recording_sha256.clear();
  for (const ChannelRun& run : c.runs)
    model.remarks.push_back("run: " + report.pooled->runs[run.run].file);
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
  Json fits = Json::array(), channels = Json::array(), problems = Json::array();
  for (const PooledChannel& c : report.pooled->channels) {
    fits.push_back(
        noise_fit_json(json_text(c.channel.name), json_text(c.channel.unit), c.fit, true));
    channels.push_back(consistency_json(c));
  }
  for (const std::string& problem : report.pooled->problems) problems.push_back(json_text(problem));
  out["fit"] = noise_fit_document(std::move(fits));
  out["consistency"] = {{"channels", std::move(channels)}};
  out["problems"] = std::move(problems);
  if (report.limits != nullptr) out["limits"] = document_of(limit_report_fields(), *report.limits);
  return out;
}

std::string runs_html(const RunsReport& report) {
  std::string body = "<section id=\"overview\">\n<p class=\"verdict\">" +
                     html_text(report.pooled->verdict) + "</p>\n" +
                     bullet_list(report.pooled->problems, "cautions") + "</section>\n";
  if (report.limits != nullptr) body += limits_section(*report.limits);
  for (const PooledChannel& c : report.pooled->channels) body += channel_part(report, c);
  body += "<section class=\"channel\">\n<h2>Each run by itself</h2>\n" +
          channels_table("Run", single_rows(report)) + "</section>\n" +
          many_provenance(report.runs, report.command);
  return html_page({"Runs of a sensor",
                    fmt::format("{} runs", report.runs.size()),
                    "reportPage.start({}, () => 320);\n",
                    std::string(page_css()) + std::string(many_page_css())},
                   body,
                   json_in_script(runs_json(report)));
}

std::string runs_text(const RunsReport& report, const TextLook& look) {
  std::string out = printable(report.pooled->verdict) + "\n";
  for (const PooledChannel& c : report.pooled->channels) {
    out += "\n" + fit_text(c.channel, c.fit, look) + findings_text(c.fit.findings, 5, look.colours);
    for (const std::string& sentence : c.sentences) out += "  " + printable(sentence) + "\n";
  }
  for (const std::string& problem : report.pooled->problems)
    out += "\n" + printable(problem) + "\n";
  if (report.limits != nullptr) out += limits_text(*report.limits, look.colours);
  return out;
}

std::vector<OutputFile> runs_files(const RunsReport& report, const std::filesystem::path& folder) {
  std::vector<OutputFile> out = {{(folder / "runs.html").string(), runs_html(report)},
                                 {(folder / "runs.json").string(), ""}};
  std::set<std::string> taken;
  for (const PooledChannel& c : report.pooled->channels)
    out.push_back(
        {(folder / (unused_file_name_for(c.channel.name, taken) + ".sensor.yaml")).string(),
         model_yaml(model_of(report, c))});
  Json document = runs_json(report);
  name_files(document, out);
  out[1].text = dump_json(document);
  return out;
}

}  // namespace libchar
