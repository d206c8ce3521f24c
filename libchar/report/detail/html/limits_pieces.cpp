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

Tint limit_tint(LimitStatus status) {
  return status == LimitStatus::pass   ? Tint::good
         : status == LimitStatus::fail ? Tint::bad
                                       : Tint::doubtful;
}

Table judgements(const LimitReport& report) {
  Table out("|");
  for (const LimitJudgement& j : report.judgements)
    out.add({Cell::word(limit_words(j.status), limit_tint(j.status)), j.sentence});
  return out;
}

}  // namespace

std::string limits_section(const LimitReport& report) {
  return "<section id=\"limits\">\n<h2>Limits" +
         (report.sensor.empty() ? std::string() : " of " + html_text(report.sensor)) +
         "</h2>\n<p>" + html_text(report.verdict) + "</p>\n" + html_table(judgements(report)) +
         "<p class=\"note\">From " + html_text(report.file) +
         ". A term passes or fails when its whole 95 % interval is within or above the "
         "limit; one that stands at the limit does either by chance in at most 2.5 % of "
         "recordings, "
         "and passes in 5 % where only an upper limit is known.</p>\n</section>\n";
}

std::string limits_text(const LimitReport& report, const TextLook& look) {
  return fmt::format("\nlimits{}: {}\n",
                     report.sensor.empty() ? "" : " of " + printable(report.sensor),
                     printable(report.verdict)) +
         terminal_table(judgements(report), look);
}

}  // namespace libchar
