#include "libchar/characterize/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "libchar/characterize/compare/characterization_comparison.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

std::string reason_of(const LimitJudgement& j) {
  switch (j.measured.status) {
    case Status::not_fitted:
      return "it was not fitted";
    case Status::misfit:
      return "the noise terms do not describe the recording";
    case Status::undetermined:
      return "the recording cannot tell the term from another, or contradicts it";
    case Status::not_detected:
      return j.status == LimitStatus::pass
                 ? "not detected, and its upper limit is within"
                 : "not detected, and its upper limit is above: a longer recording can decide";
    case Status::detected:
    case Status::given:
      break;
  }
  switch (j.status) {
    case LimitStatus::pass:
      return "the whole 95 % interval is within";
    case LimitStatus::fail:
      return "the whole 95 % interval is above";
    case LimitStatus::not_decided:
      return "the 95 % interval holds the limit";
  }
  return "";
}

std::string sentence_of(const LimitJudgement& j) {
  const std::string own = term_unit(kTermNames[static_cast<std::size_t>(j.term)].key, j.unit);
  const bool known = j.measured.value || j.measured.upper95;
  return fmt::format("{} of {}: {}, allowed {}: {}.", term_title(j.term), j.channel,
                     known ? coefficient_text(j.measured) + " " + own : "no value", limit_text(j.text, j.most, own),
                     reason_of(j));
}

std::string list_of_failures(const LimitReport& report) {
  constexpr std::size_t kShown = 6;
  std::string out;
  std::size_t seen = 0;
  for (const LimitJudgement& j : report.judgements) {
    if (j.status != LimitStatus::fail) continue;
    if (++seen > kShown) continue;
    std::string title = term_title(j.term);
    title[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(title[0])));
    out += (out.empty() ? "" : ", ") + title + " of " + j.channel;
  }
  return seen > kShown ? out + fmt::format(" and {} more", seen - kShown) : out;
}

std::string limits_verdict(const LimitReport& report) {
  const std::size_t all = report.judgements.size(), failed = report.count(LimitStatus::fail),
                    open = report.count(LimitStatus::not_decided);
  const std::string limits = all == 1 ? "limit" : "limits";
  std::string out;
  if (failed > 0)
    out = fmt::format("{} of {} {} fail{}: {}.", failed, all, limits, failed == 1 ? "s" : "", list_of_failures(report));
  else if (open > 0)
    out = fmt::format("No limit fails; {} of {} {} kept.", all - open, all, all - open == 1 ? "is" : "are");
  else
    out = all == 1 ? "The limit is kept." : fmt::format("All {} limits are kept.", all);
  if (open > 0) out += fmt::format(" {} {} not decided.", open, open == 1 ? "is" : "are");
  return out;
}

}  // namespace

std::string limit_text(const std::string& text, double most, const std::string& unit) {
  return fmt::format("{} ({} {})", text, number_text(most), unit);
}

std::size_t LimitReport::count(LimitStatus status) const {
  return static_cast<std::size_t>(
      std::count_if(judgements.begin(), judgements.end(), [&](const LimitJudgement& j) { return j.status == status; }));
}

LimitStatus judge_limit(const Coefficient& measured, double most) {
  if (!detail::relied_on(measured)) return LimitStatus::not_decided;
  if (!measured.value)
    return measured.upper95 && *measured.upper95 <= most ? LimitStatus::pass : LimitStatus::not_decided;
  if (measured.ci95.high <= most) return LimitStatus::pass;
  return measured.ci95.low > most ? LimitStatus::fail : LimitStatus::not_decided;
}

LimitReport judge_limits(const std::vector<LimitSubject>& subjects, const NoiseLimits& limits) {
  LimitReport report;
  report.file = limits.file;
  report.sensor = limits.sensor;
  std::vector<NamedChannel> names;
  names.reserve(subjects.size());
  for (const LimitSubject& s : subjects) names.push_back({s.channel.name, s.channel.unit});
  for (const ChannelLimit& limit : limits_for(limits, names)) {
    const LimitSubject& subject = subjects[limit.channel];
    LimitJudgement j;
    j.channel = subject.channel.name;
    j.unit = subject.channel.unit;
    j.term = limit.term;
    j.most = limit.most;
    j.text = limit.text;
    if (subject.fit != nullptr) j.measured = (*subject.fit)[limit.term];
    j.status = judge_limit(j.measured, j.most);
    j.sentence = sentence_of(j);
    report.judgements.push_back(std::move(j));
  }
  report.verdict = limits_verdict(report);
  return report;
}

LimitReport judge_limits(const Characterization& result, const NoiseLimits& limits) {
  std::vector<LimitSubject> subjects;
  for (const ChannelResult& c : result.channels) subjects.push_back({c.channel, c.fit ? &*c.fit : nullptr});
  return judge_limits(subjects, limits);
}

}  // namespace libchar
