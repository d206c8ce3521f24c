#include "libchar/report/detail/html/alignment_pieces.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "libchar/core/text/text.hpp"
#include "libchar/replay/view/alignment_words.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/detail/json_pieces.hpp"

namespace libchar {
namespace {

/// More sensors than these fill a terminal.
constexpr std::size_t kMostTextRows = 16;

Json term_json(double value, double error) {
  return {{"value", json_number(value)}, {"standard_error", json_number(error)}};
}

Json channel_json(const ReplayResult& r, std::size_t i) {
  const fusion::ChannelAlignment& c = r.alignment->learnt.channels[i];
  Json cross = Json::array();
  for (std::size_t k = 0; k < c.cross.size(); ++k)
    cross.push_back(term_json(c.cross[k], c.cross_se[k]));
  return {{"sensor", json_text(r.sensors[i].name)},
          {"aligned", c.used},
          {"delay_s", term_json(c.delay / r.rate_hz, c.delay_se / r.rate_hz)},
          {"bias", term_json(c.bias, c.bias_se)},
          {"gain", term_json(c.gain, c.gain_se)},
          {"cross", std::move(cross)},
          {"low_limit", json_number(r.alignment->learnt.limits[i].low)},
          {"high_limit", json_number(r.alignment->learnt.limits[i].high)}};
}

Json budget_json(const ReplayResult& r) {
  const fusion::ErrorBudget& budget = r.alignment->budget;
  Json sensors = Json::array(), savings = Json::object();
  for (std::size_t k = 0; k < budget.channels.size(); ++k) {
    Json parts = Json::object();
    for (std::size_t p = 0; p < budget.channels[k].parts.size(); ++p) {
      const fusion::PartShare& part = budget.channels[k].parts[p];
      parts[std::string(name_of(static_cast<fusion::ErrorPart>(p)))] = {
          {"share", json_number(part.share)},
          {"share_ci95", interval_json(part.ci95)},
          {"saving", json_number(part.saving)}};
    }
    sensors.push_back({{"sensor", json_text(r.sensors[r.alignment->budgeted[k]].name)},
                       {"rms", json_number(budget.channels[k].rms)},
                       {"parts", std::move(parts)}});
  }
  for (std::size_t p = 0; p < budget.savings.size(); ++p)
    savings[std::string(name_of(static_cast<fusion::ErrorPart>(p)))] =
        json_number(budget.savings[p]);
  return {{"instants", budget.instants},
          {"rms_as_recorded", json_number(budget.before)},
          {"rms_aligned", json_number(budget.after)},
          {"savings", std::move(savings)},
          {"sensors", std::move(sensors)}};
}

}  // namespace

std::string alignment_text(const ReplayView& view, const TextLook& look) {
  const ReplayResult& r = *view.result;
  if (!r.alignment) return "";
  const AlignmentWords words = alignment_words(r, *r.alignment);
  std::string out = "\n" + printable(fmt::format("{}", fmt::join(words.sentences, " "))) + "\n";
  if (r.sensors.size() > kMostTextRows) return out;
  return out + "\n" + terminal_table(words.learnt, look, "") + "\n" +
         terminal_table(words.budget, look, "");
}

std::string alignment_markdown(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  if (!r.alignment) return "";
  const AlignmentWords words = alignment_words(r, *r.alignment);
  return "\n## Alignment\n\n" + markdown_text(fmt::format("{}", fmt::join(words.sentences, " "))) +
         "\n\n" + table_text(words.learnt) + "\n" + table_text(words.budget);
}

std::string alignment_html(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  if (!r.alignment) return "";
  const AlignmentWords words = alignment_words(r, *r.alignment);
  std::string out = "<section class=\"part\" id=\"alignment\">\n<h2>Alignment</h2>\n";
  for (const std::string& sentence : words.sentences) out += "<p>" + html_text(sentence) + "</p>\n";
  return out + "<div class=\"copy-place\" data-copy=\"alignment\"></div>\n" +
         html_table(words.learnt) + html_table(words.budget) +
         "<p class=\"note\">Shares are of each sensor’s mean square error over the evaluation, "
         "with "
         "95 % intervals; last row: what the fused error would lose. Jitter: the part of what "
         "alignment leaves that follows the square of the input’s slope.</p>\n</section>\n";
}

Json alignment_json(const ReplayResult& r) {
  const AlignmentResult& a = *r.alignment;
  Json sensors = Json::array(), notes = Json::array();
  for (std::size_t i = 0; i < a.learnt.channels.size(); ++i) sensors.push_back(channel_json(r, i));
  for (const std::string& note : a.learnt.notes) notes.push_back(json_text(note));
  return {
      {"from_s", json_number(a.window.from_s)},
      {"to_s", json_number(a.window.to_s)},
      {"instants", a.learnt.instants},
      {"taught", a.by_reference},
      {"applied", a.applied},
      {"judged_where_learnt", a.overlaps},
      {"interpolation", a.learnt.interpolation == fusion::Interpolation::sinc ? "sinc" : "cubic"},
      {"notes", std::move(notes)},
      {"sensors", std::move(sensors)},
      {"budget", budget_json(r)}};
}

}  // namespace libchar
