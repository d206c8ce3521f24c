#include "libchar/report/detail/html/limits_pieces.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "libchar/core/text/text.hpp"
#include "libchar/core/text/text_table.hpp"
#include "libchar/core/units.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/text/limits_text.hpp"

namespace libchar {
namespace {

std::string_view limit_words(LimitStatus status) {
  switch (status) {
    case LimitStatus::pass:
      return "pass";
    case LimitStatus::fail:
      return "fail";
    case LimitStatus::not_decided:
      return "not decided";
  }
  return "";
}

std::string_view limit_chip(LimitStatus status) {
  switch (status) {
    case LimitStatus::pass:
      return "detected";
    case LimitStatus::fail:
      return "alarm";
    case LimitStatus::not_decided:
      return "unsure";
  }
  return "";
}

std::string judgement_word(LimitStatus status, bool colours) {
  const Tint tint = status == LimitStatus::pass   ? Tint::good
                    : status == LimitStatus::fail ? Tint::bad
                                                  : Tint::doubtful;
  return tinted(fmt::format("{:<12}", limit_words(status)), tint, colours);
}

std::string limit_row(const LimitJudgement& j) {
  return fmt::format(
      "<tr><td><span class=\"chip {}\">{}</span></td><td class=\"text\">{}</td></tr>\n",
      limit_chip(j.status),
      limit_words(j.status),
      html_text(j.sentence));
}

}  // namespace

std::string limits_section(const LimitReport& report) {
  std::string out = "<section id=\"limits\">\n<h2>Limits" +
                    (report.sensor.empty() ? std::string() : " of " + html_text(report.sensor)) +
                    "</h2>\n<p>" + html_text(report.verdict) +
                    "</p>\n<div class=\"wide\"><table>\n" + table_head({"Judgement", "Why"});
  for (const LimitJudgement& j : report.judgements) out += limit_row(j);
  return out + "</tbody></table></div>\n<p class=\"note\">From " + html_text(report.file) +
         ". A term passes or fails when its whole 95 % interval is within or above the "
         "limit; one that stands at the limit does either by chance in at most 2.5 % of "
         "recordings, "
         "and passes in 5 % where only an upper limit is known.</p>\n</section>\n";
}

std::string limits_text(const LimitReport& report, bool colours) {
  std::string out = fmt::format("\nlimits{}: {}\n",
                                report.sensor.empty() ? "" : " of " + printable(report.sensor),
                                printable(report.verdict));
  for (const LimitJudgement& j : report.judgements)
    out += fmt::format("  {} {}\n", judgement_word(j.status, colours), printable(j.sentence));
  return out;
}

}  // namespace libchar
