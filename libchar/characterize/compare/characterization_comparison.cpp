// Ratio of two independent coefficients, each with a 95 % interval [l, u] about its value c: in logarithms the interval of the
// difference from the distances to the ends that face each other (MOVER: Zou & Donner, Stat. Med. 27 (2008) 1693),
//   ln r -+ ...,   r = b / a:  lower  ln r - sqrt((ln b - ln l_b)² + (ln u_a - ln a)²),
//                              upper  ln r + sqrt((ln u_b - ln b)² + (ln a - ln l_a)²),
// and p from the distance to the end that faces r = 1, as if it were 1.96 standard deviations. An interval that reaches zero makes that
// distance infinite, and p 1: nothing is claimed. A value against an upper limit differs when the whole interval is above the limit.
#include "libchar/characterize/compare/characterization_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

bool relied_on(const Coefficient& c) {
  return c.status == Status::detected || c.status == Status::given ||
         c.status == Status::not_detected;
}

/// Distance in ln from the value to an end of its interval.
double below(const Coefficient& c) {
  return std::log(*c.value) - std::log(c.ci95.low);
}
double above(const Coefficient& c) {
  return std::log(c.ci95.high) - std::log(*c.value);
}

void compare_values(ComparedTerm& t) {
  const double log_ratio = std::log(*t.b.value / *t.a.value);
  const double down = std::hypot(below(t.b), above(t.a)), up = std::hypot(above(t.b), below(t.a));
  t.ratio = std::exp(log_ratio);
  t.ratio_ci95 = {std::exp(log_ratio - down), std::exp(log_ratio + up)};
  const double facing = log_ratio > 0 ? down : up;
  const double z = facing > 0 ? kNormal95 * std::abs(log_ratio) / facing : 0;
  t.p = std::erfc(z / std::sqrt(2.0));
}

Coefficient scaled(Coefficient c, double factor) {
  if (c.value) *c.value *= factor;
  if (c.upper95) *c.upper95 *= factor;
  c.ci95.low *= factor;
  c.ci95.high *= factor;
  return c;
}

TermDifference judged(const ComparedTerm& t, double share) {
  if (t.a.status == Status::not_fitted || t.b.status == Status::not_fitted)
    return TermDifference::only_one;
  if (!relied_on(t.a) || !relied_on(t.b)) return TermDifference::not_judged;
  if (t.p) {
    if (!(*t.p < share)) return TermDifference::not_resolved;
    return *t.ratio > 1 ? TermDifference::larger : TermDifference::smaller;
  }
  if (t.a.value && t.b.upper95)
    return t.a.ci95.low > *t.b.upper95 ? TermDifference::smaller : TermDifference::not_resolved;
  if (t.b.value && t.a.upper95)
    return t.b.ci95.low > *t.a.upper95 ? TermDifference::larger : TermDifference::not_resolved;
  return TermDifference::not_judged;
}

std::string of_values(const ComparedTerm& t) {
  const std::string ratio = fmt::format("B is {} times A [{}, {}], {}",
                                        number_text(*t.ratio),
                                        number_text(t.ratio_ci95.low),
                                        number_text(t.ratio_ci95.high),
                                        probability_text(*t.p));
  switch (t.difference) {
    case TermDifference::larger:
      return ratio + ": larger.";
    case TermDifference::smaller:
      return ratio + ": smaller.";
    case TermDifference::not_resolved:
      return ratio + ": no difference beyond chance.";
    case TermDifference::not_judged:
      return ratio + ": not judged.";
    case TermDifference::only_one:
      break;
  }
  return ratio;
}

std::string of_limits(const ComparedTerm& t) {
  if (!t.a.value && !t.b.value)
    return "not detected in either: two limits say nothing of a difference.";
  const std::string limited = t.a.value ? "B" : "A", valued = t.a.value ? "A" : "B";
  if (t.difference == TermDifference::not_judged)
    return fmt::format("not detected in {}: not judged.", limited);
  return t.difference == TermDifference::not_resolved
             ? fmt::format("not detected in {}, whose limit leaves room for the value of {}.",
                           limited,
                           valued)
             : fmt::format(
                   "not detected in {}, and the whole interval of {} is above its limit: {}.",
                   limited,
                   valued,
                   t.difference == TermDifference::smaller ? "smaller" : "larger");
}

std::string doubt_about(const ComparedTerm& t) {
  std::string out;
  for (const auto& [side, c] : {std::pair('A', &t.a), std::pair('B', &t.b)})
    if (!relied_on(*c) && c->status != Status::not_fitted)
      out +=
          fmt::format(" {} in {}.", c->status == Status::misfit ? "Misfit" : "Undetermined", side);
  return out;
}

void add_sentence(ComparedTerm& t) {
  if (t.difference == TermDifference::only_one)
    t.sentence = fmt::format("fitted in {} only.", t.a.status == Status::not_fitted ? "B" : "A");
  else
    t.sentence = (t.ratio ? of_values(t) : of_limits(t)) + doubt_about(t);
}

void remark_if(bool differ,
               const std::string& what,
               const std::string& a,
               const std::string& b,
               ComparedChannel& out) {
  if (differ) out.remarks.push_back(fmt::format("{}: {} in A, {} in B.", what, a, b));
}

std::string band_text(const ReportedChannel& c) {
  return c.band.whole ? "the whole spectrum"
                      : fmt::format("up to {} Hz", number_text(c.band.top_hz, 3));
}

std::string unit_or_none(const std::string& unit) {
  return unit.empty() ? "no unit" : unit;
}

void add_remarks(const ReportedChannel& a, const ReportedChannel& b, ComparedChannel& out) {
  remark_if(a.unit != b.unit, "Unit", unit_or_none(a.unit), unit_or_none(b.unit), out);
  if (!a.fitted || !b.fitted) {
    out.remarks.push_back(fmt::format("Without a fit in {}.",
                                      a.fitted   ? "B"
                                      : b.fitted ? "A"
                                                 : "both"));
    return;
  }
  remark_if(std::abs(a.rate_hz - b.rate_hz) > 0.01 * a.rate_hz,
            "Sampling rate, Hz",
            brief_text(a.rate_hz, 6),
            brief_text(b.rate_hz, 6),
            out);
  const bool bands =
      a.band.whole != b.band.whole || std::abs(std::log(a.band.top_hz / b.band.top_hz)) > 0.4;
  remark_if(bands, "Band of the fit", band_text(a), band_text(b), out);
  remark_if(a.shape != b.shape, "Shape", a.shape, b.shape, out);
  remark_if(a.events != b.events,
            "Steps, warm-up and ramps taken out",
            fmt::format("{}", a.events),
            fmt::format("{}", b.events),
            out);
}

/// What values of B are multiplied by to be in the unit of A; none: they cannot be compared.
std::optional<double> unit_factor(const std::string& a, const std::string& b) {
  if (a == b) return 1.0;
  const auto one = find_unit(a), other = find_unit(b);
  if (!one || !other || one->quantity != other->quantity) return std::nullopt;
  return other->to_si / one->to_si;
}

ComparedChannel compared_channel(const ReportedChannel& a, const ReportedChannel& b) {
  ComparedChannel out;
  out.name = a.name;
  out.unit = a.unit;
  add_remarks(a, b, out);
  const auto factor = unit_factor(a.unit, b.unit);
  if (!factor) out.remarks.push_back("Unlike quantities are not compared.");
  if (!factor || !a.fitted || !b.fitted) return out;
  for (std::size_t t = 0; t < kTerms; ++t) {
    ComparedTerm term;
    term.term = static_cast<Term>(t);
    term.a = a.term[t];
    term.b = scaled(b.term[t], *factor);
    if (term.a.status == Status::not_fitted && term.b.status == Status::not_fitted) continue;
    if (term.a.value && term.b.value && *term.a.value > 0 && *term.b.value > 0)
      compare_values(term);
    out.terms.push_back(std::move(term));
  }
  return out;
}

std::string comparison_verdict(const CharacterizationComparison& comparison) {
  std::size_t both = 0, judged = 0, open = 0;
  std::vector<std::string> differ;
  for (const ComparedChannel& c : comparison.channels) {
    both += c.in_a && c.in_b ? 1 : 0;
    for (const ComparedTerm& t : c.terms) {
      const bool is_open =
          t.difference == TermDifference::not_judged || t.difference == TermDifference::only_one;
      (is_open ? open : judged) += 1;
      if (t.difference != TermDifference::larger && t.difference != TermDifference::smaller)
        continue;
      std::string title = term_title(t.term);
      title[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(title[0])));
      differ.push_back(fmt::format("{} of {} is {}", title, c.name, name_of(t.difference)));
    }
  }
  if (both == 0) return "No channel is in both.";
  if (judged == 0) return "No term is known in both well enough to be compared.";
  std::string out =
      differ.empty()
          ? fmt::format("No difference beyond chance in {} term{}.", judged, judged == 1 ? "" : "s")
          : fmt::format("{} of {} terms differ beyond chance: in B {}.",
                        differ.size(),
                        judged,
                        fmt::join(differ, ", "));
  if (open > 0) out += fmt::format(" {} could not be judged.", open);
  return out;
}

}  // namespace

CharacterizationComparison compare_characterizations(
    ReportedCharacterization a,
    ReportedCharacterization b,
    const CharacterizationCompareOptions& options) {
  CharacterizationComparison out;
  out.a = std::move(a);
  out.b = std::move(b);
  for (const ReportedChannel& one : out.a.channels) {
    const ReportedChannel* const other = out.b.find(one.name);
    if (other != nullptr)
      out.channels.push_back(compared_channel(one, *other));
    else
      out.channels.push_back({one.name, one.unit, true, false, {}, {}});
  }
  for (const ReportedChannel& one : out.b.channels)
    if (out.a.find(one.name) == nullptr)
      out.channels.push_back({one.name, one.unit, false, true, {}, {}});
  std::size_t judgements = 0;
  for (const ComparedChannel& c : out.channels) judgements += c.terms.size();
  const double share =
      options.probability / static_cast<double>(std::max<std::size_t>(1, judgements));
  for (ComparedChannel& c : out.channels)
    for (ComparedTerm& t : c.terms) {
      t.difference = judged(t, share);
      add_sentence(t);
    }
  out.verdict = comparison_verdict(out);
  return out;
}

}  // namespace libchar
