#include "libchar/report/lot_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "libchar/core/readable.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/text_table.hpp"
#include "libchar/core/units.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html_tables.hpp"
#include "libchar/report/detail/json_pieces.hpp"
#include "libchar/report/detail/many_pieces.hpp"
#include "libchar/report/detail/svg_curves.hpp"

namespace libchar {
namespace {

std::vector<Recorded> recorded_devices(const LotReport& report) {
  std::vector<Recorded> out;
  for (std::size_t d = 0; d < report.devices.size(); ++d)
    out.push_back({report.lot->devices[d], report.folders[d]});
  return out;
}

std::string in_brackets(const Interval& i, double factor, int digits = 3) {
  return fmt::format(
      "[{}, {}]", number_text(factor * i.low, digits), number_text(factor * i.high, digits));
}

/// Group, what, mean, spread, of how many, why not all: texts of a row.
std::vector<std::string> lot_cells(const LotStatistic& s) {
  const auto& figures = s.figures;
  std::string mean = "–", spread = "–";
  if (figures) {
    mean = number_text(figures->mean) + " " + in_brackets(figures->mean_ci95, 1, 4) + " " + s.unit;
    if (s.in_figures > s.counted.size()) mean += fmt::format(", of {}", s.in_figures);
    const double factor = s.term ? 100 : 1;
    const std::string unit = s.term ? " %" : " " + s.unit;
    spread = figures->spread_ci95.low > 0
                 ? number_text(factor * figures->spread, 3) + unit + " " +
                       in_brackets(figures->spread_ci95, factor)
                 : "≤ " + number_text(factor * figures->spread_ci95.high, 3) + unit;
  }
  std::string rest;
  if (s.not_detected > 0) rest += fmt::format("{} not detected", s.not_detected);
  if (s.doubtful > 0) rest += fmt::format("{}{} doubtful", rest.empty() ? "" : ", ", s.doubtful);
  if (!figures && s.counted.size() >= 2) rest += ": too few for a mean";
  return {s.group,
          lot_title(s),
          mean,
          spread,
          fmt::format("{} of {}", s.counted.size(), s.members),
          rest};
}

const std::vector<std::string> kLotHeads = {
    "Group", "What", "Mean over the lot", "Spread (sd)", "Counted", "Not counted"};

/// Rows of those that something is known of.
std::string statistics_table(const std::vector<LotStatistic>& statistics) {
  std::string out = "<div class=\"wide\"><table class=\"many\">\n" + table_head(kLotHeads);
  for (const LotStatistic& s : statistics)
    if (!s.counted.empty()) out += table_row(lot_cells(s));
  return out + "</tbody></table></div>\n";
}

/// Those of kinds, and the rest folded; where there are no kinds the rest is what there is.
std::string statistics_part(const Lot& lot) {
  std::vector<LotStatistic> kinds, channels;
  for (const LotStatistic& s : lot.statistics) (s.of_kind ? kinds : channels).push_back(s);
  std::string out = "<h2>The lot</h2>\n" + statistics_table(kinds.empty() ? channels : kinds);
  if (!kinds.empty() && !channels.empty())
    out += "<details><summary>Channel by channel over the recordings</summary>\n" +
           statistics_table(channels) + "</details>\n";
  return out +
         "<p class=\"note\">Means of coefficients are geometric. Spread: from member to member, "
         "what the "
         "uncertainty of each alone would make is taken out; ≤: none beyond that, 97.5 % limit. In "
         "brackets: 95 % intervals. \"Of\" more than are counted: those not detected or doubtful "
         "too, by "
         "what their records show of the square. Else no mean is given where under two thirds "
         "count; a term detected in no member has no row.</p>\n";
}

std::vector<std::string> outlier_sentences(const Lot& lot) {
  std::vector<std::string> out;
  for (const LotStatistic& s : lot.statistics)
    for (const LotOutlier& o : s.outliers) out.push_back(s.group + ": " + o.sentence);
  return out;
}

bool stands_out(const Lot& lot, std::size_t device, std::size_t channel) {
  for (const LotStatistic& s : lot.statistics)
    for (const LotOutlier& o : s.outliers)
      if (o.member.device == device && o.member.channel == channel) return true;
  return false;
}

std::string kind_of(const Channel& channel) {
  const auto unit = find_unit(channel.unit);
  if (unit) return std::string(name_of(unit->quantity)) + " in " + unit->symbol;
  return channel.unit.empty() ? "no unit" : "in " + channel.unit;
}

SvgCurve curve_of_member(const LotReport& report,
                         std::size_t d,
                         std::size_t c,
                         std::size_t colour) {
  const ChannelResult& channel = report.devices[d].channels[c];
  SvgCurve out;
  out.name = channel.channel.name + " · " + report.lot->devices[d];
  out.colour = colour;
  out.strong = stands_out(*report.lot, d, c);
  if (out.strong) out.name += " (stands out)";
  for (const AllanPoint& point : channel.allan.points) {
    if (!point.reliable) continue;
    out.x.push_back(point.tau_s);
    out.y.push_back(point.deviation);
  }
  return out;
}

/// One drawing a kind of channel.
std::string overlaid_curves(const LotReport& report) {
  std::vector<std::pair<std::string, std::vector<SvgCurve>>> kinds;
  std::string type = "oadev";
  for (std::size_t d = 0; d < report.devices.size(); ++d)
    for (std::size_t c = 0; c < report.devices[d].channels.size(); ++c) {
      const ChannelResult& channel = report.devices[d].channels[c];
      const std::string kind = kind_of(channel.channel);
      auto at =
          std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.first == kind; });
      if (at == kinds.end()) at = kinds.insert(kinds.end(), {kind, {}});
      at->second.push_back(curve_of_member(report, d, c, at->second.size()));
      type = name_of(channel.allan.type);
    }
  std::string out;
  for (const auto& [kind, curves] : kinds) {
    const std::string drawing = svg_curves(
        curves,
        {"averaging time τ, s", type + ", " + kind, "Allan curves of all channels, " + kind});
    if (!drawing.empty()) out += "<h3>" + html_text(kind) + "</h3>\n" + drawing;
  }
  return out;
}

Json statistic_json(const LotReport& report, const LotStatistic& s) {
  const auto& figures = s.figures;
  Json out = {
      {"group", json_text(s.group)},
      {"what", s.term ? std::string(kTermNames[static_cast<std::size_t>(*s.term)].key) : "mean"},
      {"unit", json_text(s.unit)},
      {"members", s.members},
      {"counted", s.counted.size()},
      {"not_detected", s.not_detected},
      {"doubtful", s.doubtful}};
  out["mean"] = figures ? json_number(figures->mean) : Json(nullptr);
  out["mean_ci95"] = figures ? interval_json(figures->mean_ci95) : Json(nullptr);
  out["spread"] = figures ? json_number(figures->spread) : Json(nullptr);
  out["spread_ci95"] = figures ? interval_json(figures->spread_ci95) : Json(nullptr);
  out["spread_is"] = s.term ? "relative" : "absolute";
  out["of_all"] = s.in_figures > s.counted.size();
  out["p"] = s.effects ? json_number(s.effects->p) : Json(nullptr);
  out["outliers"] = Json::array();
  for (const LotOutlier& o : s.outliers)
    out["outliers"].push_back(
        {{"recording", o.member.device},
         {"channel",
          json_text(report.devices[o.member.device].channels[o.member.channel].channel.name)},
         {"p", json_number(o.p)},
         {"sentence", json_text(o.sentence)}});
  return out;
}

}  // namespace

Json lot_json(const LotReport& report) {
  Json out = many_head("lot", report.devices, report.command);
  if (!report.devices.empty()) out["config"] = json_of(report.devices[0].settings);
  out["verdict"] = json_text(report.lot->verdict);
  out["recordings"] = recordings_json(report.devices, recorded_devices(report));
  out["statistics"] = Json::array();
  for (const LotStatistic& s : report.lot->statistics)
    out["statistics"].push_back(statistic_json(report, s));
  return out;
}

std::string lot_html(const LotReport& report) {
  const Lot& lot = *report.lot;
  const std::string body =
      "<section id=\"overview\">\n<p class=\"verdict\">" + html_text(lot.verdict) + "</p>\n" +
      bullet_list(outlier_sentences(lot), "cautions") + statistics_part(lot) +
      "</section>\n<section class=\"channel\">\n<h2>Allan curves</h2>\n" + overlaid_curves(report) +
      "</section>\n<section class=\"channel\">\n<h2>Channel by channel</h2>\n" +
      recordings_table(report.devices, recorded_devices(report)) + "</section>\n" +
      many_provenance(report.devices, report.command);
  const std::size_t n = lot.devices.size();
  return many_page("A lot of sensors",
                   n == 1 ? lot.devices[0] : fmt::format("{} recordings", n),
                   body,
                   lot_json(report));
}

std::string lot_text(const LotReport& report, std::size_t width) {
  const Lot& lot = *report.lot;
  std::string out = printable(lot.verdict) + "\n";
  for (const std::string& sentence : outlier_sentences(lot))
    out += "  " + printable(sentence) + "\n";
  std::vector<std::vector<std::string>> rows = {{"channel", "recording", "N", "B", "K", "fit"}};
  for (std::size_t d = 0; d < report.devices.size(); ++d)
    for (const ChannelResult& c : report.devices[d].channels) {
      std::vector<std::string> row = {printable(c.channel.name), printable(lot.devices[d])};
      for (const std::string& cell : coefficient_cells(c.channel, c.fit ? &*c.fit : nullptr))
        row.push_back(printable(cell));
      rows.push_back(std::move(row));
    }
  out += "\n" + text_table(rows, "  ", false, width);
  rows = {{"group", "what", "mean", "spread (sd)", "counted", "not counted"}};
  for (const LotStatistic& s : lot.statistics) {
    if (s.counted.empty()) continue;
    rows.push_back(lot_cells(s));
    for (std::string& cell : rows.back()) cell = printable(cell);
  }
  return out + "\n" + text_table(rows, "  ", true, width);
}

std::vector<OutputFile> lot_files(const LotReport& report, const std::filesystem::path& folder) {
  std::vector<OutputFile> out = {{(folder / "lot.html").string(), lot_html(report)},
                                 {(folder / "lot.json").string(), ""}};
  Json document = lot_json(report);
  name_files(document, out);
  out[1].text = dump_json(document);
  return out;
}

}  // namespace libchar
