// A test report on paper, with the parts that IEEE Std 952 and 1554 ask of one: what was tested, under which
// conditions, how, with which results against which limits, what is to be known, and who answers for it. What no
// recording says (type, serial number, mounting, names) is a line to be filled in.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "libchar/allan/deviation_types.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/figure/draw_figure.hpp"
#include "libchar/figure/make_figure.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/text/report_table.hpp"

namespace libchar {
namespace {

constexpr const char* kToFill = "______________________________";

/// Null where the document, which somebody may have changed, has no such place.
const Json& found(const Json& in, const char* pointer) {
  static const Json none;
  const Json::json_pointer place(pointer);
  return in.contains(place) ? in.at(place) : none;
}
std::string text_at(const Json& in, const char* pointer) {
  const Json& value = found(in, pointer);
  return value.is_string() ? value.get<std::string>() : "";
}
double number_at(const Json& in, const char* pointer) {
  const Json& value = found(in, pointer);
  return value.is_number() ? value.get<double>() : 0;
}

/// "N white noise" of white_noise; a term of a later version stays as written.
std::string term_in_words(const std::string& key) {
  const auto known =
      std::find_if(kTermNames.begin(), kTermNames.end(), [&](const TermName& t) { return t.key == key; });
  if (known == kTermNames.end()) return key;
  std::string words = fmt::format("{} {}", known->letter, key);
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

/// "Overlapping Allan deviation" of oadev.
std::string deviation_in_words(const std::string& name) {
  const std::optional<DeviationType> type = deviation_type(name);
  return type ? std::string(deviation_row(*type).title) : name;
}

std::string part(int number, const char* head, const std::string& body) {
  return fmt::format("<section class=\"form\">\n<h2>{}. {}</h2>\n{}</section>\n", number, head, body);
}

std::string facts(const Table& table) { return html_table(table, {.css = "facts"}); }

Table conditions(const Json& document, const ReportedCharacterization& report) {
  Table out("|");
  out.add({"Recording", text_at(document, "/recording/file")});
  out.add({"SHA-256", text_at(document, "/recording/sha256")});
  const double rate_hz = number_at(document, "/recording/rate_hz"), samples = number_at(document, "/recording/samples");
  double blank = 0;
  for (const Json& channel : found(document, "/quality/channels"))
    blank = std::max(blank, number_at(channel, "/missing"));
  const auto count_at = [&](const char* place) { return clamped_whole<std::uint64_t>(number_at(document, place)); };
  if (rate_hz > 0)
    out.add({"Duration",
             fmt::format("{}: {} samples at {}, {}", duration_text(samples / rate_hz),
                         count_text(clamped_whole<std::uint64_t>(samples)), detail::frequency_text(rate_hz, 9),
                         detail::missing_text({count_at("/recording/gaps"), count_at("/recording/missing_samples"),
                                               clamped_whole<std::uint64_t>(blank)}))});
  for (const ReportedChannel& c : report.channels)
    if (c.events > 0) out.add({c.name, plural(c.events, "event") + " taken out before the fit"});
  for (const char* asked : {"Temperature", "Supply, warm-up time", "Mounting, orientation", "Equipment"})
    out.add({asked, kToFill});
  return out;
}

Table method(const Json& document) {
  std::vector<std::string> fits, terms, words;
  for (const Json& channel : found(document, "/fit/channels"))
    if (const std::string how = text_at(channel, "/method"); !how.empty())
      fits.push_back(text_at(channel, "/name") + ": " + how);
  for (const Json& term : found(document, "/config/fit/terms")) terms.push_back(term_in_words(text_at(term, "")));
  for (const Json& word : found(document, "/command")) words.push_back(text_at(word, ""));
  Table out("|");
  out.add({"Coefficients", fmt::format("{}", fmt::join(fits, "; "))});
  if (!terms.empty()) out.add({"Terms offered to the fit", fmt::format("{}", fmt::join(terms, ", "))});
  out.add({"Allan curve", deviation_in_words(text_at(document, "/allan/type")) + ", 95 % intervals"});
  add_program(out, words);
  return out;
}

std::string limits(const Json& document) {
  if (!document.contains("limits")) return "<p>None were given.</p>\n";
  Table out("channel|term|limit|judgement|");
  for (const Json& term : found(document, "/limits/terms")) {
    const std::string word = text_at(term, "/judgement");
    std::string name = text_at(term, "/term");
    std::replace(name.begin(), name.end(), '_', ' ');
    out.add({text_at(term, "/channel"), name, text_at(term, "/limit_as_given"),
             Cell::word(word, word == "pass"   ? Tint::good
                              : word == "fail" ? Tint::bad
                                               : Tint::doubtful),
             text_at(term, "/sentence")});
  }
  return "<p>" + html_text(text_at(document, "/limits/verdict")) + "</p>\n" + html_table(out);
}

std::string signatures() {
  Table out("|name|date|signature");
  for (const char* who : {"Tested by", "Checked by", "Released by"}) out.add({who, kToFill, "______________", kToFill});
  return html_table(out, {.css = "facts"});
}

/// One figure for each unit: an axis has one.
std::string figures(const ReportedCharacterization& report, const FigureSource& source,
                    const std::vector<std::string>& channels) {
  std::vector<std::string> units;
  std::string out = "<div class=\"figures\">\n";
  for (const ReportedChannel* first : detail::chosen_channels(report, channels)) {
    if (std::find(units.begin(), units.end(), first->unit) != units.end()) continue;
    units.push_back(first->unit);
    FigureOptions options;
    options.kind = "allan";
    for (const ReportedChannel* c : detail::chosen_channels(report, channels))
      if (c->unit == first->unit && options.channels.size() < detail::kMostCurves) options.channels.push_back(c->name);
    const Chart chart = make_figure({&source, 1}, options);
    out += "<figure class=\"curves\">" + draw_figure(chart, {.width_mm = 90, .shape = 0.6}) + "</figure>\n";
  }
  return out + "</div>\n";
}

constexpr const char* kStyle =
    "\n.form h2 { font-size: 1.05rem; margin: 14px 0 2px; }\n.figures { display: flex; flex-wrap: wrap; gap: 4px 16px; "
    "}\n.form figure { margin: 8px 0; flex: 1 1 300px; max-width: 520px; }\n"
    "@media print { @page { size: A4; margin: 11mm 12mm; } .form figure { flex: none; width: 8.8cm; margin: 2px 0; }\n"
    "  .form h2 { margin: 7px 0 1px; }\n"
    "  .form ul.cautions li { font-size: 7.5pt; line-height: 1.2; margin: 1px 0; padding: 1px 6px; } }\n";

}  // namespace

std::string detail::test_form_html(const ReportedCharacterization& report, const Json& document,
                                   const FigureSource& source, const std::vector<std::string>& channels) {
  const std::string sensor = text_at(document, "/limits/sensor");
  std::vector<std::string> names;
  for (const ReportedChannel* c : detail::chosen_channels(report, channels))
    names.push_back(c->unit.empty() ? c->name : c->name + " [" + c->unit + "]");
  Table object("|");
  object.add({"Sensor", sensor.empty() ? kToFill : sensor});
  object.add({"Type, serial number", kToFill});
  object.add({"Channels", fmt::format("{}", fmt::join(names, ", "))});
  // On paper nothing can be unfolded: all of them, each with its channel.
  std::vector<std::string> findings;
  const auto chosen = detail::chosen_channels(report, channels);
  for (const Finding& one : report.findings) {
    const ReportedChannel* const of = report.find(one.subject);
    if (of == nullptr || std::find(chosen.begin(), chosen.end(), of) != chosen.end())
      findings.push_back(one.subject + ": " + one.sentence);
  }
  const std::string known =
      "<p>" + html_text(text_at(document, "/verdict")) + "</p>\n" + bullet_list(findings, "cautions");
  const std::string body =
      part(1, "Object", facts(object)) + part(2, "Conditions", facts(conditions(document, report))) +
      part(3, "Method", facts(method(document))) +
      part(4, "Results", html_table(detail::coefficient_rows(report, channels)) + figures(report, source, channels)) +
      part(5, "Limits", limits(document)) + part(6, "Remarks", known) + part(7, "Signatures", signatures());
  return html_page({"Test report: sensor noise", text_at(document, "/recording/file"),
                    "reportPage.start({}, () => 320);\n", std::string(page_css()) + kStyle, false},
                   body, "{}");
}

}  // namespace libchar
