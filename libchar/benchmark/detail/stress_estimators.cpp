// Estimators of records: every curve against its definition in long double, fits against themselves
// in comfortable numbers.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/benchmark/detail/stress_cells.hpp"
#include "libchar/core/numeric/moments.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "libchar/simulate/random.hpp"
#include "libchar/spectrum/fft.hpp"
#include "libchar/spectrum/welch.hpp"

namespace libchar {
namespace {

// Records that break what is careless with numbers.

struct StressRecord {
  std::string name;
  std::vector<double> y;
  /// (y - shift) 2^-power without rounding: the same record in comfortable numbers
  double shift = 0;
  int power = 0;
  bool drifts = false;
  /// as it was before samples went missing; empty: none is missing
  std::vector<double> whole;
};

inline constexpr double kStressRate = 100;

constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kSamples = 4001;  // a prime

class StressRecords {
 public:
  explicit StressRecords(std::vector<double> plain) : plain_(std::move(plain)) {}

  /// Every sample by a formula of the plain one and its place.
  void add(const char* name, const std::function<double(double, double)>& of) {
    StressRecord record{name, plain_, 0, 0, false, {}};
    for (std::size_t i = 0; i < plain_.size(); ++i)
      record.y[i] = of(plain_[i], static_cast<double>(i) / static_cast<double>(plain_.size()));
    out_.push_back(std::move(record));
  }
  void add_moved(const char* name, double shift, double factor) {
    add(name, [=](double y, double) { return shift + factor * y; });
    out_.back().shift = shift;
  }
  void add_scaled(const char* name, int power) {
    add(name, [=](double y, double) { return std::ldexp(y, power); });
    out_.back().power = power;
  }
  void drifts() { out_.back().drifts = true; }
  void add_missing(const char* name, std::size_t from, std::size_t count) {
    StressRecord record{name, plain_, 0, 0, false, plain_};
    std::fill_n(record.y.begin() + static_cast<std::ptrdiff_t>(from), count, kAbsent);
    out_.push_back(std::move(record));
  }
  void add_short(const char* name, std::size_t samples) {
    out_.push_back({name, {plain_.begin(), plain_.begin() + static_cast<std::ptrdiff_t>(samples)}, 0, 0, false, {}});
  }
  std::vector<StressRecord> take() { return std::move(out_); }

 private:
  std::vector<double> plain_;
  std::vector<StressRecord> out_;
};

/// White noise and a random walk of deviation one each over ten thousand samples, multiples of 2^-20.
std::vector<double> plain_record(std::uint64_t seed, std::size_t samples) {
  DeviateStream white({seed, 0, Purpose::white}), walk({seed, 0, Purpose::walk});
  std::vector<double> out(samples);
  double position = 0;
  for (double& y : out) {
    position += 0.01 * walk.normal();
    y = std::ldexp(std::round(std::ldexp(white.normal() + position, 20)), -20);
  }
  return out;
}

///< of all of them, Hz
std::vector<StressRecord> stress_records(std::uint64_t seed) {
  StressRecords all(plain_record(seed, kSamples));
  all.add_scaled("a prime number of samples", 0);
  all.add_moved("offset 10⁹, noise 10⁻⁶", 1e9, 1e-6);
  all.add_moved("offset 9.81, noise 0.001", 9.81, 1e-3);
  all.add_moved("offset 10⁹, noise 1", 1e9, 1);
  all.add_scaled("denormal (10⁻³¹⁰)", -1030);
  all.add_scaled("scale 10²⁰⁰", 664);
  all.add_scaled("scale 10⁻²⁰⁰", -664);
  all.add("drift of 10⁶ deviations", [](double y, double t) { return y + 1e6 * t; });
  all.drifts();
  all.add("constant", [](double, double) { return 9.81; });
  all.add("all zero", [](double, double) { return 0.0; });
  all.add("plus and minus zero", [](double y, double) { return std::copysign(0.0, y); });
  all.add("alternating +1, -1", [even = true](double, double) mutable { return (even = !even) ? 1.0 : -1.0; });
  all.add("one bit", [](double y, double) { return y > 0 ? 1.0 : -1.0; });
  all.add("saturated", [](double y, double) { return std::clamp(y, -1.0, 0.5); });
  all.add("float32", [](double y, double) { return static_cast<double>(static_cast<float>(9.81 + 1e-3 * y)); });
  all.add("one spike of 10³⁰⁰", [first = true](double y, double t) mutable {
    const bool here = first && t >= 0.4;
    first = first && !here;
    return here ? 1e300 : y;
  });
  all.add_missing("first sample missing", 0, 1);
  all.add_missing("last sample missing", kSamples - 1, 1);
  all.add_missing("burst of missing samples", 1500, 60);
  all.add_short("1 sample", 1);
  all.add_short("2 samples", 2);
  all.add_short("3 samples", 3);
  return all.take();
}

/// (y - shift) 2^-power.
std::vector<double> comfortable(const StressRecord& record) {
  std::vector<double> out = record.y;
  for (double& y : out) y = std::ldexp(y - record.shift, -record.power);
  return out;
}

// Stated digits (docs/reliability.md).
constexpr double kMomentDigits = 13, kAllanDigits = 12, kSpectrumDigits = 11, kFitDigits = 6;
/// Results near the end of the range of a double have no more; a third difference of a drift of 1e6
/// deviations cancels as many.
constexpr double kDenormalDigits = 10, kDriftDigits = 9;
constexpr std::size_t kSegment = 256;

using Values = std::vector<double>;
using ExactValues = std::vector<Exact>;

AllanCurve curve_of(DeviationType type, std::span<const double> y) {
  AllanOptions options;
  options.type = type;
  options.grid = TauGrid::decade;
  options.threads = 1;
  return allan_deviation(y, 1 / kStressRate, options);
}

Values deviations(const AllanCurve& curve) {
  Values out;
  for (const AllanPoint& p : curve.points) out.push_back(p.deviation);
  return out;
}

ExactValues exact_deviations(const AllanCurve& curve, std::span<const double> y) {
  ExactValues out;
  for (const AllanPoint& p : curve.points) {
    const std::uint64_t stride =
        curve.stride_divisor > 0 && p.m >= 2 * curve.stride_divisor ? p.m / curve.stride_divisor : 1;
    out.push_back(exact_deviation(y, curve.dt_s, curve.type, p.m, stride));
  }
  return out;
}

Spectrum spectrum_of(std::span<const double> y) {
  WelchOptions options;
  options.segment = kSegment;
  options.threads = 1;
  return welch(y, kStressRate, options);
}

/// A record that lacks samples: what is asked of curves is that they stay near those of the whole record.
void judge_near(const Values& found, const Values& whole, double factor, StressCell& cell) {
  bool held = !found.empty() && found.size() <= whole.size();
  for (std::size_t i = 0; held && i < found.size(); ++i)
    held = found[i] > whole[i] / factor && found[i] < whole[i] * factor;
  judge_held(held, fmt::format("not within a factor of {} of the whole record", factor), cell);
}

double stated(double digits, const StressRecord& record) {
  if (record.power < -1000) digits = std::min(digits, kDenormalDigits);
  if (record.drifts) digits = std::min(digits, kDriftDigits);
  return digits;
}

bool lacks(const StressRecord& record) { return !record.whole.empty(); }

void stress_moments(const StressRecord& record, StressCell& cell) {
  const auto found = [](const Values& y) {
    Moments moments;
    moments.push(y);
    return Values{moments.mean(), moments.standard_deviation()};
  };
  Values present;
  for (const double y : record.y)
    if (!std::isnan(y)) present.push_back(y);
  if (present.size() < 2) return judge_held(found(present)[1] == 0, "one sample has no deviation", cell);
  judge_digits(right_digits(found(record.y), exact_moments(present)), stated(kMomentDigits, record), cell);
}

/// Exact sums of these take operations by the square of the length and more: of their beginning.
Values beginning(DeviationType type, const Values& y) {
  constexpr std::size_t kFew = 200;
  const DeviationFamily family = deviation_row(type).family;
  if (family != DeviationFamily::theo && family != DeviationFamily::extended) return y;
  return {y.begin(), y.begin() + static_cast<std::ptrdiff_t>(std::min(kFew, y.size()))};
}

void stress_deviation(DeviationType type, const StressRecord& record, StressCell& cell) {
  if (lacks(record)) {
    const AllanCurve of_part = curve_of(type, record.y), of_all = curve_of(type, record.whole);
    Values found = deviations(of_part), whole = deviations(of_all);
    // Of the longest stretch there are fewer averaging times.
    whole.resize(std::min(found.size(), whole.size()));
    if (found.size() > whole.size()) found.resize(whole.size());
    return judge_near(found, whole, 3, cell);
  }
  const Values y = beginning(type, record.y);
  const AllanCurve curve = curve_of(type, y);
  judge_digits(right_digits(deviations(curve), exact_deviations(curve, y)), stated(kAllanDigits, record), cell);
}

void stress_pyramid(const StressRecord& record, StressCell& cell) {
  const auto curve_of_pyramid = [](const Values& y) { return pyramid_deviation(y, 1 / kStressRate); };
  const AllanCurve curve = curve_of_pyramid(record.y);
  if (lacks(record)) {
    // Its longest averages are of one or two terms.
    Values found = deviations(curve), whole = deviations(curve_of_pyramid(record.whole));
    return judge_near(found, whole, 3, cell);
  }
  judge_digits(right_digits(deviations(curve), exact_deviations(curve, record.y)), stated(kAllanDigits, record), cell);
}

void stress_welch(const StressRecord& record, StressCell& cell) {
  const Spectrum spectrum = spectrum_of(record.y);
  if (lacks(record)) {
    const auto level = [](const Spectrum& s) { return Values{std::accumulate(s.value.begin(), s.value.end(), 0.0)}; };
    return judge_near(level(spectrum), level(spectrum_of(record.whole)), 1.5, cell);
  }
  judge_digits(
      right_digits_together(spectrum.value, exact_welch(record.y, kStressRate, detail::in_memory(spectrum.segment))),
      stated(kSpectrumDigits, record), cell);
}

void stress_cosines(const StressRecord& record, StressCell& cell) {
  if (lacks(record)) return judge_refused("it takes whole records only", cell);
  Dct transform(record.y.size());
  const auto found = transform.transform(record.y);
  Values without_mean(found.begin(), found.end());
  without_mean[0] = 0;
  judge_digits(right_digits_together(without_mean, exact_cosine_transform(record.y)), stated(kSpectrumDigits, record),
               cell);
}

/// Values of all terms; a term without one is zero.
Values coefficients(std::span<const double> y) {
  const NoiseFit fit = fit_record(y, kStressRate, nullptr);
  Values out;
  for (const Coefficient& c : fit.term) out.push_back(c.value.value_or(0));
  return out;
}

void stress_fit(const StressRecord& record, StressCell& cell) {
  const Values found = coefficients(record.y);
  if (lacks(record)) {
    const Values whole = coefficients(record.whole);
    return judge_near({found[0]}, {whole[0]}, 1.5, cell);
  }
  StressRecord other = record;
  if (other.shift == 0 && other.power == 0) other.power = -10;
  ExactValues expected;
  for (const double c : coefficients(comfortable(other))) expected.push_back(std::ldexp(Exact(c), other.power));
  judge_digits(right_digits(found, expected), stated(kFitDigits, record), cell);
}

struct Subject {
  std::string name;
  std::function<void(const StressRecord&, StressCell&)> run;
};

std::vector<Subject> subjects() {
  std::vector<Subject> out = {{"moments", stress_moments}};
  for (const DeviationRow& row : deviation_rows())
    out.push_back({std::string(row.word), [type = row.type](const StressRecord& record, StressCell& cell) {
                     stress_deviation(type, record, cell);
                   }});
  out.push_back({"oadev, streamed", stress_pyramid});
  out.push_back({"spectrum (Welch)", stress_welch});
  out.push_back({"cosine transform", stress_cosines});
  out.push_back({"fit of noise terms", stress_fit});
  return out;
}

/// Terms of the streamed Allan deviation from sums of a quarter of m, as they come.
class ExactStream {
 public:
  explicit ExactStream(std::uint64_t m) : part_(std::max<std::uint64_t>(1, m / 4)), parts_(2 * m / part_), m_(m) {}
  void push(Exact y) {
    sum_ += y;
    if (++in_part_ < part_) return;
    recent_.push_back(sum_);
    sum_ = 0;
    in_part_ = 0;
    if (recent_.size() < parts_) return;
    Exact term = 0;
    for (std::size_t i = 0; i < parts_; ++i) term += i < parts_ / 2 ? -recent_[i] : recent_[i];
    squares_ += term * term;
    ++terms_;
    recent_.erase(recent_.begin());
  }
  Exact deviation() const { return std::sqrt(squares_ / static_cast<Exact>(terms_) / 2) / Exact(m_); }

 private:
  std::uint64_t part_, parts_, m_, in_part_ = 0, terms_ = 0;
  Exact sum_ = 0, squares_ = 0;
  std::vector<Exact> recent_;
};

/// White noise of deviation one with an offset and a drift, a hundred million samples, none of them kept.
void stress_long_stream(double offset, double drift, std::uint64_t seed, Progress& progress, StressCell& cell) {
  constexpr std::uint64_t kDriftSamples = 100'000'000;
  constexpr std::size_t kBlock = 1U << 16U;
  DeviateStream noise({seed, 0, Purpose::white});
  AllanPyramid pyramid;
  std::vector<ExactStream> exact = {ExactStream(1), ExactStream(4), ExactStream(1024), ExactStream(1U << 20U)};
  Values block(kBlock);
  Exact first = 0;
  for (std::uint64_t done = 0; done < kDriftSamples; done += block.size()) {
    progress.update(static_cast<double>(done) / kDriftSamples, "stress: " + cell.input);
    block.resize(std::min(kBlock, detail::in_memory(kDriftSamples - done)));
    noise.fill_normal(block);
    for (std::size_t i = 0; i < block.size(); ++i)
      block[i] += offset + drift * static_cast<double>(done + i) / kDriftSamples;
    if (done == 0) first = block[0];
    pyramid.push(block);
    for (ExactStream& stream : exact)
      for (const double y : block) stream.push(Exact(y) - first);
  }
  const AllanCurve curve = std::move(pyramid).finish(1 / kStressRate);
  Values found;
  ExactValues expected;
  for (std::size_t i = 0; const std::uint64_t m : {1U, 4U, 1024U, 1U << 20U}) {
    for (const AllanPoint& p : curve.points)
      if (p.m == m) found.push_back(p.deviation);
    expected.push_back(exact[i++].deviation());
  }
  judge_digits(right_digits(found, expected), drift != 0 ? 10 : kAllanDigits, cell);
}

}  // namespace

std::vector<StressCell> stress_estimators(const StressBenchOptions& options, Progress& progress) {
  std::vector<StressCell> out;
  const std::vector<StressRecord> records = stress_records(options.seed);
  const std::vector<Subject> all = subjects();
  for (std::size_t i = 0; i < records.size(); ++i)
    for (const Subject& subject : all) {
      progress.update(static_cast<double>(i) / static_cast<double>(records.size()), "stress: " + subject.name);
      out.push_back(
          stress_cell(subject.name, records[i].name, [&](StressCell& cell) { subject.run(records[i], cell); }));
    }
  if (options.quick) return out;
  struct Long {
    const char* name;
    double offset, drift;
  };
  for (const Long& one :
       {Long{"10⁸ samples, offset of 10⁹ deviations", 1e9, 0}, Long{"10⁸ samples, drift of 10⁶ deviations", 0, 1e6}})
    out.push_back(stress_cell("oadev, streamed", one.name, [&](StressCell& cell) {
      stress_long_stream(one.offset, one.drift, options.seed, progress, cell);
    }));
  return out;
}

}  // namespace libchar
