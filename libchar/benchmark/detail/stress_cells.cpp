#include "libchar/benchmark/detail/stress_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/error.hpp"

namespace libchar {
namespace {

constexpr double kMostDigits = 16;

double digits_of(Exact relative) {
  if (!(relative == relative)) return 0;
  return std::clamp(static_cast<double>(-std::log10(relative)), 0.0, kMostDigits);
}

bool sizes_differ(std::span<const double> a, std::span<const Exact> b) { return a.size() != b.size(); }

}  // namespace

double right_digits(std::span<const double> values, std::span<const Exact> expected) {
  if (sizes_differ(values, expected)) return 0;
  Exact largest = 0;
  for (const Exact e : expected) largest = std::max(largest, std::abs(e));
  double out = kMostDigits;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Exact apart = std::abs(Exact(values[i]) - expected[i]);
    if (apart == 0) continue;
    out = std::min(out, digits_of(apart / (expected[i] != 0 ? std::abs(expected[i]) : largest)));
  }
  return out;
}

double right_digits_together(std::span<const double> values, std::span<const Exact> expected) {
  if (sizes_differ(values, expected)) return 0;
  Exact apart = 0, length = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    apart += (Exact(values[i]) - expected[i]) * (Exact(values[i]) - expected[i]);
    length += expected[i] * expected[i];
  }
  return apart == 0 ? kMostDigits : digits_of(std::sqrt(apart / length));
}

StressCell stress_cell(const std::string& subject, const std::string& input,
                       const std::function<void(StressCell&)>& run) {
  StressCell cell;
  cell.subject = subject;
  cell.input = input;
  try {
    run(cell);
  } catch (const Error& error) {
    judge_refused(error.problem().what, cell);
  }
  return cell;
}

void judge_digits(double digits, double stated, StressCell& cell) {
  cell.digits = digits;
  cell.stated = stated;
  cell.outcome = digits < stated ? StressOutcome::wrong : StressOutcome::digits;
  if (digits < stated) cell.what = fmt::format("{:.1f} digits, {:.0f} are stated", digits, stated);
}

void judge_refused(const std::string& sentence, StressCell& cell) {
  cell.outcome = sentence.empty() ? StressOutcome::wrong : StressOutcome::refused;
  cell.what = sentence;
}

void judge_held(bool held, const std::string& otherwise, StressCell& cell) {
  cell.outcome = held ? StressOutcome::held : StressOutcome::wrong;
  if (!held) cell.what = otherwise;
}

}  // namespace libchar
