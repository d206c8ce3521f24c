#include "libchar/report/html/fleet_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "libchar/core/file/sha256.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/charts.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/detail/report_rows.hpp"

namespace libchar {
namespace {

/// Figures of more quantities than that are left to lot.json: the page has to open in a second.
constexpr std::size_t kMostFigures = 150;
constexpr std::size_t kFailedOnPage = 100;

std::vector<std::string> known_words(const FleetLot& lot) {
  std::vector<std::string> out;
  for (const Finding& one : lot.findings) out.push_back(std::string(name_of(one.severity)) + ": " + one.sentence);
  return out;
}

std::string facts(const FleetReport& report) {
  const FleetLot& lot = *report.lot;
  return "<p class=\"verdict\">" + html_text(lot.verdict) + "</p>\n" + bullet_list(lot.notes, "cautions") +
         bullet_list(known_words(lot), "cautions") + next_part(report.next);
}

std::string recordings_part(const FleetReport& report, const std::vector<std::size_t>& recordings,
                            const std::string& title) {
  if (recordings.empty()) return "";
  Table out("device|log|why");
  for (const std::size_t r : first_of(recordings, kFailedOnPage)) {
    const DeviceRecord& one = report.records[r];
    out.add({one.device, one.log, one.problem});
  }
  return folded(html_text(title),
                html_table(out, {.css = "many", .of = recordings.size(), .rest = "the list of devices below"}));
}

std::string failed_part(const FleetReport& report) {
  const FleetLot& lot = *report.lot;
  return recordings_part(report, lot.failed, plural(lot.failed.size(), "recording") + " could not be characterized") +
         recordings_part(report, lot.awaited, plural(lot.awaited.size(), "recording") + " without a result yet");
}

Cell reasons_cell(const std::vector<std::string>& reasons) {
  constexpr std::size_t kMost = 5;
  Cell out;
  for (std::size_t i = 0; i < std::min(kMost, reasons.size()); ++i) out.lines.emplace_back(reasons[i]);
  if (reasons.size() > kMost) out.lines.emplace_back(fmt::format("and {} more", reasons.size() - kMost));
  return out;
}

std::string worst_table(const FleetReport& report, std::size_t first, std::size_t end) {
  Table out("device|type|batch|why");
  for (std::size_t i = first; i < end; ++i) {
    const WorstDevice& w = report.lot->worst[i];
    const DeviceRecord& r = report.records[w.recording];
    out.add({report_cell(r.device, r.report), r.type, batch_of(*report.lot, w.recording), reasons_cell(w.reasons)});
  }
  return html_table(out, {.css = "many"});
}

std::string worst_part(const FleetReport& report) {
  constexpr std::size_t kOpen = 20;
  const std::size_t count = report.lot->worst.size(), open = std::min(kOpen, count);
  if (count == 0) return "";
  std::string out = "<section class=\"channel\">\n<h2>The worst first</h2>\n" + worst_table(report, 0, open);
  if (count > open) out += folded(fmt::format("The next {}", count - open), worst_table(report, open, count));
  return out +
         "<p class=\"note\">Sorted by the probability of the reason: of such a deviation from the others in any device "
         "of the fleet, or of such a high value in a device that is exactly at its limit.</p>\n</section>\n";
}

std::string quantities_part(const FleetLot& lot) {
  constexpr PageTable kLook{.css = "many cards", .cards = true};
  const Table kinds = quantities_table(lot, true), channels = quantities_table(lot, false);
  const bool has_kinds = !kinds.rows.empty();
  std::string out = "<h2>What the devices have in common</h2>\n";
  if (has_kinds || !channels.rows.empty()) out += html_table(has_kinds ? kinds : channels, kLook);
  if (has_kinds) out += folded("The same of each channel", html_table(channels, kLook));
  return out +
         "<p class=\"note\">Means of coefficients are geometric. In brackets: 95 % intervals. Spread between devices, "
         "measurement uncertainty removed (≤: upper 97.5 % limit). 95 % of devices: values as measured. A mean \"of\" "
         "more devices than are counted includes undetected or doubtful ones, by the squares measured in their "
         "recordings. "
         "Otherwise only detected values count, and no mean is given if fewer than two thirds of the devices were "
         "detected. “Too large by up to” is the bias if all other devices are smaller.</p>\n";
}

std::string figures_part(const FleetReport& report) {
  const FleetLot& lot = *report.lot;
  std::string out;
  std::size_t drawn = 0, left_out = 0;
  for (std::size_t q = 0; q < lot.quantities.size();) {
    const QuantityLot& first = lot.quantities[q];
    std::string body;
    for (; q < lot.quantities.size() && lot.quantities[q].group == first.group &&
           lot.quantities[q].type == first.type && lot.quantities[q].of_kind == first.of_kind;
         ++q) {
      if (first.of_kind) continue;
      if (drawn >= kMostFigures) {
        ++left_out;
        continue;
      }
      const std::string figures = quantity_figures(report, lot.quantities[q]);
      drawn += !figures.empty();
      body += figures;
    }
    if (!body.empty())
      out += "<details class=\"channel\"" + std::string(out.empty() ? " open" : "") + ">\n<summary>" +
             html_text(group_title(first, lot)) + " <span class=\"unit\">" + html_text(first.channel_unit) +
             "</span></summary>\n" + body + "</details>\n";
  }
  if (out.empty()) return "";
  if (left_out > 0)
    out += fmt::format(
        "<p class=\"note\">Figures of {} more quantities are left out; their numbers are in lot.json.</p>\n", left_out);
  return "<section id=\"channels\">\n<h2>Distributions and control charts</h2>\n" + out + "</section>\n";
}

bool has_several_recordings(const FleetLot& lot) { return lot.order.size() > lot.devices; }

bool says_anything(const std::vector<std::string>& words) {
  return std::any_of(words.begin(), words.end(), [](const auto& word) { return !word.empty(); });
}

bool anything_is_the_matter(const FleetLot& lot) {
  const auto any = [](const std::vector<bool>& of) { return std::find(of.begin(), of.end(), true) != of.end(); };
  return any(lot.stands_out) || any(lot.fails) || !lot.failed.empty() || !lot.awaited.empty();
}

/// Where the table of coefficients has every device, a list that only names them again is left out.
std::string devices_part(const FleetLot& lot, bool in_table) {
  Table devices("device");
  for (const auto& [head, shown] :
       {std::pair("recording", has_several_recordings(lot)), std::pair("type", says_anything(lot.types)),
        std::pair("batch", says_anything(lot.batches)), std::pair("what is the matter", anything_is_the_matter(lot))})
    if (shown) devices.columns.push_back({head});
  if (in_table && devices.columns.size() == 1) return "";
  return "<section class=\"channel\">\n<h2>All devices</h2>\n<div class=\"controls\" hidden>\n"
         "<label>Find <input type=\"search\" id=\"device-search\" placeholder=\"device, log, type, batch\"></label>\n"
         "<label>Show <select id=\"device-state\"><option value=\"0\">all</option><option value=\"1\">"
         "outliers</option><option value=\"2\">that fail a limit</option><option value=\"4\">not "
         "characterized</option><option value=\"8\">without a result yet</option></select></label>\n<button "
         "type=\"button\" id=\"device-before\">‹ before</button><button type=\"button\" id=\"device-next\">next "
         "›</button>\n<span id=\"device-place\" class=\"dim\"></span>\n"
         "</div>\n<div id=\"devices\">" +
         html_table(devices, {.css = "devices"}) +
         "</div>\n<p class=\"note\">Every coefficient of every device is in coefficients.csv and coefficients.npz, "
         "next to this page.</p>\n</section>\n";
}

/// Folders of reports: what stands before each device's name where that is all, so that a hundred thousand names stand
/// there once.
Json reports_json(std::span<const DeviceRecord> records, const std::vector<std::size_t>& order) {
  std::optional<std::string> before;
  bool none = true, simple = true;
  for (const std::size_t r : order) {
    const DeviceRecord& one = records[r];
    none = none && one.report.empty();
    const bool ends = one.report.ends_with(one.device);
    const std::string start = ends ? one.report.substr(0, one.report.size() - one.device.size()) : "";
    if (!before) before = start;
    simple = simple && ends && start == *before && !one.report.empty();
  }
  if (none) return nullptr;
  if (simple) return json_text(*before);
  Json out = Json::array();
  for (const std::size_t r : order) out.push_back(json_text(records[r].report));
  return out;
}

/// What tells the recordings of one device apart: the log's name and its temperature; "" where a device has one. In the
/// order of the lot.
std::vector<std::string> recording_names(const FleetReport& report) {
  const FleetLot& lot = *report.lot;
  std::map<std::pair<std::string_view, std::string_view>, std::size_t> count;
  const auto device = [&](std::size_t r) -> std::size_t& {
    return count[{report.records[r].type, report.records[r].device}];
  };
  for (const std::size_t r : lot.order) ++device(r);
  std::vector<std::string> out;
  for (const std::size_t r : lot.order) {
    const DeviceRecord& one = report.records[r];
    std::string& text = out.emplace_back();
    if (device(r) > 1) text = std::filesystem::path(one.log).filename().string();
    if (device(r) > 1 && one.temperature_c) text += ", " + celsius_text(*one.temperature_c);
  }
  return out;
}

Json recordings_json(const FleetReport& report) {
  return has_several_recordings(*report.lot) ? texts_json(recording_names(report)) : Json(nullptr);
}

/// Of a lot that is small enough for a table of all its channels.
Table all_channels(const FleetReport& report) {
  constexpr std::size_t kMost = 200;
  Table out = channels_table("device");
  out.note = kHeadlineNote;
  const std::vector<std::size_t>& order = report.lot->order;
  std::size_t channels = 0;
  for (const std::size_t r : order) channels += report.records[r].channels.size();
  if (channels > kMost) return out;
  const std::vector<std::string> names = recording_names(report);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const DeviceRecord& record = report.records[order[i]];
    add_channels(out, record, record.device + (names[i].empty() ? "" : " (" + names[i] + ")"));
  }
  return out;
}

std::string channels_part(const FleetReport& report) {
  const Table channels = all_channels(report);
  return channels.rows.empty() ? ""
                               : "<section class=\"channel\">\n<h2>Each device</h2>\n" +
                                     html_table(channels, {.css = "many cards", .cards = true}) + "</section>\n";
}

std::string curves_part(const FleetReport& report) {
  const std::string figures = allan_figures(report);
  return figures.empty() ? "" : "<section class=\"channel\">\n<h2>Allan curves</h2>\n" + figures + "</section>\n";
}

/// What the list of devices shows: columns, types and batches by number.
Json index_json(const FleetReport& report) {
  const FleetLot& lot = *report.lot;
  const auto place = [](const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) - words.begin();
  };
  Json device = Json::array(), type = Json::array(), batch = Json::array(), state = Json::array();
  for (const std::size_t r : lot.order) {
    const DeviceRecord& one = report.records[r];
    device.push_back(json_text(one.device));
    type.push_back(place(lot.types, one.type));
    batch.push_back(lot.batch_of[r]);
    state.push_back((lot.stands_out[r] ? 1 : 0) + (lot.fails[r] ? 2 : 0) +
                    (one.problem.empty() ? 0
                     : one.awaited       ? 8
                                         : 4));
  }
  return {{"types", texts_json(lot.types)},
          {"batches", texts_json(lot.batches)},
          {"report", reports_json(report.records, lot.order)},
          {"device", std::move(device)},
          {"recording", recordings_json(report)},
          {"type", std::move(type)},
          {"batch", std::move(batch)},
          {"state", std::move(state)}};
}

/// A table is too large for memory.
WrittenFile written_table(const FleetReport& report,
                          void (*write)(std::span<const DeviceRecord>, const FleetLot&, const TakeBytes&),
                          WholeFile& file) {
  Sha256 hash;
  write(report.records, *report.lot, [&](std::string_view piece) {
    hash.update(piece);
    file.write(piece);
  });
  return {file.path(), hash.finish()};
}

/// The first of those that could not be characterized, and why.
std::string failed_text(const FleetReport& report) {
  constexpr std::size_t kNamed = 5;
  const std::vector<std::size_t>& failed = report.lot->failed;
  if (failed.empty()) return "";
  std::string out = "\ncould not be characterized:\n";
  for (std::size_t i = 0; i < std::min(kNamed, failed.size()); ++i) {
    const DeviceRecord& r = report.records[failed[i]];
    out += "  " + printable(r.device) + "  " + printable(r.problem) + "\n";
  }
  if (failed.size() > kNamed) out += fmt::format("  and {} more\n", failed.size() - kNamed);
  return out;
}

}  // namespace

std::string fleet_html(const FleetReport& report) {
  const FleetLot& lot = *report.lot;
  const std::string body = "<section id=\"overview\">\n" + facts(report) + failed_part(report) + quantities_part(lot) +
                           "</section>\n" + worst_part(report) + channels_part(report) + curves_part(report) +
                           figures_part(report) + devices_part(*report.lot, !all_channels(report).rows.empty()) +
                           many_provenance(report.recordings, report.command);
  PageParts parts;
  parts.title = "A lot of sensors";
  parts.subject = report.name.empty() ? plural(lot.devices, "device") : report.name;
  parts.script = std::string(fleet_page_js());
  parts.style = std::string(page_css()) + std::string(many_page_css()) + std::string(fleet_page_css());
  parts.all_numbers = false;
  return html_page(parts, body, json_in_script(index_json(report)));
}

std::string fleet_text(const FleetReport& report, std::size_t width, std::size_t worst) {
  const FleetLot& lot = *report.lot;
  std::string out = printable(lot.verdict) + "\n";
  for (const std::string& note : lot.notes) out += "  " + printable(note) + "\n";
  out += findings_text(lot.findings) + failed_text(report);
  for (const Table& table : {all_channels(report), quantities_table(lot)})
    if (!table.rows.empty()) out += "\n" + terminal_table(table, {width});
  if (lot.worst.empty()) return out;
  out += "\nthe worst first:\n";
  for (std::size_t i = 0; i < std::min(worst, lot.worst.size()); ++i) {
    const WorstDevice& w = lot.worst[i];
    out += "  " + printable(report.records[w.recording].device) + "  " + printable(w.reasons[0]);
    if (w.reasons.size() > 1) out += fmt::format(" And {} more.", w.reasons.size() - 1);
    out += "\n";
  }
  if (lot.worst.size() > worst) out += fmt::format("  and {} more\n", lot.worst.size() - worst);
  return out;
}

std::vector<std::string> fleet_report_files(const std::filesystem::path& folder) {
  std::vector<std::string> out;
  for (const char* name : {"index.html", "coefficients.csv", "coefficients.npz", "lot.json"})
    out.push_back((folder / name).string());
  return out;
}

std::vector<std::string> write_fleet_report(const FleetReport& report, const std::filesystem::path& folder,
                                            bool force) {
  const std::vector<std::string> paths = fleet_report_files(folder);
  check_outputs(paths, folder, {}, force);
  std::vector<OutputFile> texts = {{paths[0], fleet_html(report)}, {paths[3], ""}};
  WholeFile csv(paths[1], force), npz(paths[2], force);
  std::vector<WrittenFile> files = {detail::as_written(texts[0]),
                                    written_table(report, write_coefficients_csv, csv),
                                    written_table(report, write_coefficients_npz, npz),
                                    {paths[3], ""}};
  Json document = fleet_json(report);
  name_files(document, files);
  texts[1].text = dump_json(document);
  write_outputs(texts, folder, {}, force, {&csv, &npz});
  return paths;
}

}  // namespace libchar
