#include "libchar/report/replay_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/readable.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

std::vector<bool> front(const ReplayResult& result,
                        double (*cost)(const AlgorithmResult& algorithm)) {
  const auto& all = result.algorithms;
  const auto candidate = [&](const AlgorithmResult& a) {
    return a.ran && !a.bound && std::isfinite(a.rmse) && std::isfinite(cost(a));
  };
  std::vector<bool> out(all.size(), false);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!candidate(all[i])) continue;
    out[i] = std::none_of(all.begin(), all.end(), [&](const AlgorithmResult& other) {
      return candidate(other) && other.rmse <= all[i].rmse && cost(other) <= cost(all[i]) &&
             (other.rmse < all[i].rmse || cost(other) < cost(all[i]));
    });
  }
  return out;
}

}  // namespace

std::string score_name(const ReplayResult& result) {
  return result.has_reference ? "RMSE" : "Leave-one-out RMS";
}

std::string usual_unit(const std::string& unit) {
  const auto known = find_unit(unit);
  return known && known->symbol != "1" ? std::string(known->symbol) : unit;
}

std::string score_unit(const ReplayResult& result) {
  return result.inputs.empty() ? "" : usual_unit(result.inputs[0].unit);
}

std::string with_unit(double value, int digits, const std::string& unit) {
  const std::string number = people(value, digits);
  return unit.empty() || !std::isfinite(value) ? number : number + " " + unit;
}

std::string people_percent(double share, int digits) {
  if (!std::isfinite(share)) return "–";
  const double percent = 100 * share;
  // A regret of 3e-7 is none: it would be written as a power of ten.
  if (std::fabs(percent) < 0.005) return "0.00 %";
  if (std::fabs(percent) >= 1000) return people(percent, 4) + " %";
  return fmt::format("{:.{}f} %", percent, std::fabs(percent) < 10 ? digits : digits > 1 ? 1 : 0);
}

std::string people_instant(double seconds) {
  return std::isfinite(seconds) ? significant(seconds, 8) + " s" : "–";
}

std::string people_stretch(double from_s, double to_s) {
  return people_instant(from_s) + " … " + (std::isfinite(to_s) ? people_instant(to_s) : "the end");
}

std::string people_interval(const Interval& interval, int digits) {
  if (!std::isfinite(interval.low) || !std::isfinite(interval.high)) return "–";
  return people(interval.low, digits) + " … " + people(interval.high, digits);
}

std::vector<std::string> needs_in_words(const fusion::Card& card) {
  const fusion::Needs& n = card.needs;
  std::vector<std::string> out;
  if (n.reference_throughout) out.emplace_back("the reference of the run itself");
  if (n.reference) out.emplace_back("a reference in a learning window");
  if (n.learning_samples > 0)
    out.push_back(fmt::format("at least {} learning instants", n.learning_samples));
  if (n.noise_levels) out.emplace_back("noise levels");
  if (n.fault_free_start) out.emplace_back("a start without faults");
  if (n.tilt) out.emplace_back("one gyroscope axis and two accelerometer axes");
  if (n.rate) out.emplace_back("the sampling rate");
  if (n.min_channels > 1) out.push_back(fmt::format("at least {} sensors", n.min_channels));
  if (n.more_than_inputs > 0)
    out.push_back(fmt::format("more than {} sensors an input", n.more_than_inputs));
  if (!n.observation_matrix && !n.tilt) out.emplace_back("one input, seen alike by all");
  if (!n.accepts_missing) out.emplace_back("no missing samples");
  return out;
}

std::string settings_in_words(const fusion::Settings& settings) {
  std::string out;
  for (std::size_t i = 0; i < settings.table().size(); ++i) {
    const fusion::Option& option = settings.table()[i];
    if (settings.values()[i] != option.standard)
      out += fmt::format("{}{} = {}{}{}",
                         out.empty() ? "" : ", ",
                         option.name,
                         shortest(settings.values()[i]),
                         option.unit.empty() ? "" : " ",
                         option.unit);
  }
  return out;
}

ParetoFront pareto_front(const ReplayResult& result) {
  return {front(result, [](const AlgorithmResult& a) { return a.ns_per_sample; }),
          front(result, [](const AlgorithmResult& a) {
            return a.peak_bytes ? static_cast<double>(*a.peak_bytes)
                                : std::numeric_limits<double>::quiet_NaN();
          })};
}

std::size_t index_of(const ReplayResult& result, const AlgorithmResult& algorithm) {
  return static_cast<std::size_t>(&algorithm - result.algorithms.data());
}

}  // namespace libchar
