#include <algorithm>
#include <cmath>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/quantity_text.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/replay/replay.hpp"

namespace libchar {
namespace {

constexpr std::size_t kRangeValues = 12;

Refusal sweep_refusal(const std::string& where) {
  return usage_error("E0963", where)
      .says("expected ALGORITHM.OPTION=NUMBER, or where several are taken NUMBER,NUMBER… or FROM..TO of whole numbers")
      .hint(where + " minque.gamma=0.99");
}

bool is_whole(double value) { return std::floor(value) == value && std::abs(value) < 1e9; }

/// All of a short range; of a longer one the ends and what stands at about equal ratios (differences from zero on).
std::vector<double> range_values(double from, double to) {
  std::vector<double> out;
  if (to - from < static_cast<double>(kRangeValues)) {
    for (double v = from; v <= to; ++v) out.push_back(v);
    return out;
  }
  for (std::size_t i = 0; i < kRangeValues; ++i) {
    const double share = static_cast<double>(i) / (kRangeValues - 1);
    const double value = from > 0 ? from * std::pow(to / from, share) : from + (to - from) * share;
    if (out.empty() || std::round(value) > out.back()) out.push_back(std::round(value));
  }
  return out;
}

std::vector<double> values_in(const std::string& list, const std::string& where, const std::string& text) {
  std::vector<double> out;
  if (list.find("..") != std::string::npos) {
    const Interval range = parse_range(list, RangeOf::number, where);
    if (!is_whole(range.low) || !is_whole(range.high)) throw sweep_refusal(where).got(text);
    return range_values(range.low, range.high);
  }
  for (std::size_t at = 0; at <= list.size();) {
    const std::size_t comma = std::min(list.find(',', at), list.size());
    const auto value = parse_double(list.substr(at, comma - at));
    if (!value) throw sweep_refusal(where).got(text);
    out.push_back(*value);
    at = comma + 1;
  }
  return out;
}

SceneAlgorithm with_option(SceneAlgorithm algorithm, const std::string& option, double value) {
  std::erase_if(algorithm.options, [&](const auto& o) { return o.first == option; });
  algorithm.options.emplace_back(option, value);
  return algorithm;
}

}  // namespace

Sweep parse_sweep(const std::string& text, const std::string& where, std::size_t most) {
  const std::size_t equals = text.find('='), dot = text.rfind('.', equals);
  if (equals == std::string::npos || dot == std::string::npos) throw sweep_refusal(where).got(text);
  Sweep out{text.substr(0, dot), text.substr(dot + 1, equals - dot - 1),
            values_in(text.substr(equals + 1), where, text)};
  if (out.values.size() > most) throw sweep_refusal(where).got(text);
  fusion::Settings settings(fusion::algorithm(out.algorithm).options);
  for (const double value : out.values) settings.set(out.option, value);
  return out;
}

std::vector<SceneAlgorithm> swept(const std::vector<Sweep>& sweeps, const std::vector<SceneAlgorithm>& algorithms) {
  std::vector<SceneAlgorithm> out = algorithms;
  for (const Sweep& sweep : sweeps) {
    std::vector<SceneAlgorithm> next;
    bool found = false;
    for (const SceneAlgorithm& algorithm : out) {
      if (algorithm.name != sweep.algorithm) {
        next.push_back(algorithm);
        continue;
      }
      found = true;
      for (const double value : sweep.values) next.push_back(with_option(algorithm, sweep.option, value));
    }
    for (std::size_t i = 0; i < sweep.values.size() && !found; ++i)
      next.push_back(with_option({sweep.algorithm, {}, 0, 0}, sweep.option, sweep.values[i]));
    out = std::move(next);
  }
  return out;
}

}  // namespace libchar
