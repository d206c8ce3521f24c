#include "libchar/replay/view/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/units.hpp"
#include "libchar/replay/detail/plan/preparation.hpp"

namespace libchar {

std::vector<std::string> needs_in_words(const fusion::Description& description) {
  const fusion::Needs& n = description.needs;
  std::vector<std::string> out;
  if (n.reference_throughout) out.emplace_back("the reference of the run itself");
  if (n.reference) out.emplace_back("a reference in a learning window");
  if (n.reference_helps) out.emplace_back("nothing; a reference in a learning window helps");
  if (n.learning_samples > 0) out.push_back(fmt::format("at least {} learning instants", n.learning_samples));
  if (n.noise_levels) out.emplace_back("noise levels");
  if (n.noise_models) out.emplace_back("noise models");
  if (n.fault_free_start) out.emplace_back("a start without faults");
  if (n.tilt) out.emplace_back("one gyroscope axis and two accelerometer axes");
  if (n.rate) out.emplace_back("the sampling rate");
  if (n.min_channels > 1) out.push_back(fmt::format("at least {} sensors", n.min_channels));
  if (n.max_channels > 0) out.push_back(fmt::format("at most {} sensors", n.max_channels));
  if (n.more_than_inputs > 0)
    out.push_back(n.more_than_inputs == 1 ? std::string("more than one sensor per input")
                                          : fmt::format("more than {} sensors per input", n.more_than_inputs));
  if (!n.observation_matrix && !n.tilt) out.emplace_back("one input, seen alike by all");
  if (!n.accepts_missing) out.emplace_back("no missing samples");
  return out;
}

std::string settings_in_words(const fusion::Settings& settings) {
  std::string out;
  for (std::size_t i = 0; i < settings.table().size(); ++i) {
    const fusion::Option& option = settings.table()[i];
    if (settings.values()[i] != option.standard)
      out += fmt::format("{}{} = {}{}{}", out.empty() ? "" : ", ", option.name, shortest(settings.values()[i]),
                         option.unit.empty() ? "" : " ", option.unit);
  }
  return out;
}

namespace {

constexpr std::string_view kPartNames[] = {"offset", "gain", "cross", "delay", "jitter", "noise"};

// "0.31 ± 0.02": the digits that the error leaves.
Cell with_error(double value, double error, double scale = 1) {
  if (!std::isfinite(error)) return Cell::shown(value == 0 ? "–" : brief_text(scale * value, 3), value);
  return Cell::shown(detail::plus_minus_text(scale * value, scale * error), value);
}

std::string share_text(const fusion::PartShare& part) {
  const auto percent = [](double share) { return fmt::format("{:.1f}", 100 * share); };
  if (!std::isfinite(part.ci95.low)) return percent(part.share) + " %";
  return fmt::format("{} % ({} … {})", percent(part.share), percent(part.ci95.low), percent(part.ci95.high));
}

std::string with_unit_of(const ReplayResult& r, const char* head) {
  const std::string unit = detail::usual_unit(r.inputs[0].unit);
  return unit.empty() ? head : fmt::format("{}, {}", head, unit);
}

Table learnt_table(const ReplayResult& r, const AlignmentResult& a) {
  Table out("sensor|delay, samples||gain, %");
  out.columns[2].head = with_unit_of(r, "bias");
  const std::size_t axes = a.learnt.channels[0].cross.size();
  for (std::size_t k = 0; k < axes; ++k)
    out.columns.push_back({axes == 1 ? "cross-axis, %" : fmt::format("cross-axis {}, %", k + 1)});
  for (std::size_t i = 0; i < a.learnt.channels.size(); ++i) {
    const fusion::ChannelAlignment& c = a.learnt.channels[i];
    std::vector<Cell> row = {r.sensors[i].name, with_error(c.delay, c.delay_se), with_error(c.bias, c.bias_se),
                             with_error(c.gain, c.gain_se, 100)};
    for (std::size_t k = 0; k < axes; ++k) row.push_back(with_error(c.cross[k], c.cross_se[k], 100));
    out.add(std::move(row));
  }
  return out;
}

Table budget_table(const ReplayResult& r, const AlignmentResult& a) {
  Table out("sensor||offset|gain|cross|delay|jitter|noise");
  out.title = "Error budget, shares of the mean square";
  out.columns[1].head = with_unit_of(r, "RMS");
  for (std::size_t k = 0; k < a.budget.channels.size(); ++k) {
    const fusion::ChannelBudget& c = a.budget.channels[k];
    std::vector<Cell> row = {r.sensors[a.budgeted[k]].name, brief_text(c.rms, 4)};
    for (const fusion::PartShare& part : c.parts) row.push_back(Cell::shown(share_text(part), part.share));
    out.add(std::move(row));
  }
  if (a.budget.instants < 1) return out;
  std::vector<Cell> all = {"fused, without this part", ""};
  for (const double saving : a.budget.savings)
    all.push_back(Cell::shown(std::abs(saving) < 5e-4 ? "0.0 %" : fmt::format("{:+.1f} %", -100 * saving), saving));
  out.add(std::move(all));
  return out;
}

std::string how(const AlignmentResult& a) {
  return fmt::format("Alignment learnt from {} to {} s ({} instants; {} is the truth), {}.",
                     brief_text(a.window.from_s, 6), brief_text(a.window.to_s, 6), a.learnt.instants,
                     a.by_reference ? "the reference" : "the mean of the sensors",
                     a.applied ? "taken out of the sensors before they are fused"
                               : "reported only: the sensors are fused as recorded");
}

std::string effect(const ReplayResult& r, const AlignmentResult& a) {
  if (!(a.budget.before > 0))
    return "Too few instants of the evaluation have samples of all sensors for an error budget.";
  const std::string usual = detail::usual_unit(r.inputs[0].unit), unit = usual.empty() ? "" : " " + usual;
  return fmt::format(
      "{}: {}{} as recorded, {}{} aligned (× {:.3f}), on {} instants with samples of all sensors below their limits.",
      a.by_reference ? "RMSE of the mean" : "Leave-one-out RMS of the mean", brief_text(a.budget.before, 4), unit,
      brief_text(a.budget.after, 4), unit, a.budget.after / a.budget.before, a.budget.instants);
}

}  // namespace

std::string_view name_of(fusion::ErrorPart part) { return kPartNames[static_cast<std::size_t>(part)]; }

AlignmentWords alignment_words(const ReplayResult& r, const AlignmentResult& a) {
  AlignmentWords out;
  out.sentences = {how(a), effect(r, a)};
  if (a.overlaps)
    out.sentences.emplace_back("It was learnt and judged on the same stretch: it looks better than it is.");
  for (const std::string& note : a.learnt.notes) {
    std::string sentence = note + ".";
    sentence[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(sentence[0])));
    out.sentences.push_back(std::move(sentence));
  }
  out.learnt = learnt_table(r, a);
  out.budget = budget_table(r, a);
  return out;
}

namespace {

std::string with_unit(double value, int digits, const std::string& unit) {
  return brief_text(value, digits) + (unit.empty() ? "" : " " + detail::usual_unit(unit));
}

std::string window_words(const TimeWindow& w) {
  return fmt::format("from {} to {} s", brief_text(w.from_s, 6), brief_text(w.to_s, 6));
}

std::string offset_words(const ReplayResult& r, const FoundOffset& offset) {
  const std::string& unit = r.inputs[0].unit;
  const std::string interval =
      std::isfinite(offset.ci95.low)
          ? fmt::format(" (95 %: {} to {})", brief_text(offset.ci95.low, 4), with_unit(offset.ci95.high, 4, unit))
          : "";
  std::string out = fmt::format(
      "The reference reads {}{} more than the sensors: found {}, {}, and subtracted from it. Errors no longer contain "
      "this offset.",
      with_unit(offset.value, 4, unit), interval,
      offset.in_learning ? "in the learning window" : "on the evaluation itself", window_words(offset.window));
  if (offset.drifts) out += " The difference drifts: it may differ elsewhere.";
  return out;
}

}  // namespace

double settling_s(const ScenePreparation& p) { return p.filters() ? kSettlingPeriods / p.from_hz : 0; }

std::vector<std::string> preparation_words(const Scene& scene) {
  const ScenePreparation& p = scene.preparation;
  const char* reference = scene.reference ? " and the reference" : "";
  std::vector<std::string> out;
  if (p.detrend != "none")
    out.push_back(fmt::format("The {1} of each sensor{0} over the whole recording is subtracted from it.", reference,
                              p.detrend == "mean" ? "mean" : "line of least squares"));
  if (!p.filters()) return out;
  const std::string band = p.to_hz > 0 ? fmt::format(" and a low-pass at {}", detail::frequency_text(p.to_hz, 6)) : "";
  out.push_back(fmt::format(
      "All sensors{} go through one filter: a Butterworth high-pass of second order at {}{}, causal. Its first {} are "
      "neither learnt from nor scored; noise levels are those after it, and noise models are not used.",
      reference, detail::frequency_text(p.from_hz, 6), band, duration_text(settling_s(p))));
  return out;
}

std::vector<std::string> preparation_words(const ReplayResult& r) {
  std::vector<std::string> out = preparation_words(r.scene);
  if (r.reference_offset)
    out.push_back(offset_words(r, *r.reference_offset));
  else if (r.scene.reference && r.scene.reference->offset != 0)
    out.push_back(
        fmt::format("From the reference {} is subtracted.", with_unit(r.scene.reference->offset, 6, r.inputs[0].unit)));
  return out;
}

}  // namespace libchar
