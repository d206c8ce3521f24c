#include "libchar/log/time/delays/clock_behind.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>

#include "libchar/core/numeric/median.hpp"

namespace libchar {
namespace {

using Phase = std::complex<double>;

double power(std::span<const double> times, double frequency) {
  Phase sum = 0;
  for (const double t : times) sum += std::polar(1.0, 2 * std::numbers::pi * frequency * t);
  return std::norm(sum) / (static_cast<double>(times.size()) * static_cast<double>(times.size()));
}

/// The highest of the powers at first, first + step, …, which are found by turning each phase on.
double highest(std::span<const double> times, double first, double last, double step) {
  std::vector<Phase> phases, turns;
  for (const double t : times) {
    phases.push_back(std::polar(1.0, 2 * std::numbers::pi * first * t));
    turns.push_back(std::polar(1.0, 2 * std::numbers::pi * step * t));
  }
  double best = first, most = 0;
  for (double frequency = first; frequency < last; frequency += step) {
    double real = 0, imaginary = 0;
    for (std::size_t i = 0; i < phases.size(); ++i) {
      const double re = phases[i].real(), im = phases[i].imag(), cosine = turns[i].real(), sine = turns[i].imag();
      real += re;
      imaginary += im;
      phases[i] = {re * cosine - im * sine, re * sine + im * cosine};
    }
    const double here = real * real + imaginary * imaginary;
    if (here <= most) continue;
    most = here;
    best = frequency;
  }
  return best;
}

/// The peak near `frequency`, by ever smaller steps to both sides.
double refined(std::span<const double> times, double frequency, double step) {
  for (; step > 1e-9 * frequency; step /= 2)
    for (const double side : {-step, step})
      if (power(times, frequency + side) > power(times, frequency)) frequency += side;
  return frequency;
}

/// Phases that agree over all rows as they do within parts: a clock that wanders, as one that sleeps between rows does,
/// keeps them for a while only.
bool lasts(std::span<const double> times, double frequency) {
  constexpr double kKept = 0.6;
  const double whole = power(times, frequency);
  for (const std::size_t parts : {8U, 32U}) {
    const std::size_t rows = times.size() / parts;
    double within = 0;
    for (std::size_t part = 0; part < parts; ++part)
      within += (power(times.subspan(part * rows, rows), frequency) - 1 / static_cast<double>(rows)) /
                static_cast<double>(parts);
    if (whole < kKept * within) return false;
  }
  return true;
}

/// All over the rows a tenth of the steps and more are off by a quarter and more from each multiple of the usual one
/// there: rates that follow each other have steps of their own.
bool off_multiples(std::span<const double> times) {
  constexpr double kOff = 0.25, kShare = 0.1;
  constexpr std::size_t kQuarters = 4;
  const std::size_t rows = times.size() / kQuarters;
  for (std::size_t quarter = 0; quarter < kQuarters; ++quarter) {
    std::vector<double> steps;
    for (std::size_t i = quarter * rows + 1; i < (quarter + 1) * rows; ++i) steps.push_back(times[i] - times[i - 1]);
    std::vector<double> sorted = steps;
    const double usual = median_in_place(sorted, Middle::lower);
    const auto off = std::count_if(steps.begin(), steps.end(), [usual](double step) {
      const double multiple = step / usual;
      return !(std::fabs(multiple - std::max(1.0, std::round(multiple))) <= kOff);
    });
    if (static_cast<double>(off) <= kShare * static_cast<double>(steps.size())) return false;
  }
  return true;
}

/// Rows that keep to one line, however they scatter about it.
bool on_line(std::span<const double> times) {
  constexpr double kOff = 1.5;
  const double step = times.back() / static_cast<double>(times.size() - 1);
  for (std::size_t i = 0; i < times.size(); ++i)
    if (std::fabs(times[i] - step * static_cast<double>(i)) > kOff * step) return false;
  return true;
}

}  // namespace

EvenClock clock_behind(const std::vector<std::int64_t>& stamps, double ns) {
  constexpr double kLowest = 0.8, kHighest = 1.3, kStep = 0.2;  // of the usual rate; of one over the time
  constexpr double kChance = 25;                                // e^-25 for each that is tried
  constexpr double kTidy = 0.75;                                // phases within a twelfth: steps tell them apart
  constexpr std::size_t kFewest = 256, kMost = 1025;
  std::vector<double> times;
  for (std::size_t i = 0; i < std::min(stamps.size(), kMost); ++i)
    times.push_back(static_cast<double>(stamps[i] - stamps.front()) / ns);
  if (times.size() < kFewest || !(times.back() > 0) || !off_multiples(times)) return {};
  const double step = kStep / times.back();
  const double frequency = refined(times, highest(times, kLowest, kHighest, step), step / 2);
  const double found = power(times, frequency);
  if (found * static_cast<double>(times.size()) < kChance || !lasts(times, frequency)) return {!on_line(times), {}};
  if (found > kTidy) return {};
  return {true, ns / frequency};
}

}  // namespace libchar
