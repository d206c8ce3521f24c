#include "libchar/benchmark/detail/stress_records.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "libchar/simulate/random.hpp"

namespace libchar {
namespace {

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
    out_.push_back({name,
                    {plain_.begin(), plain_.begin() + static_cast<std::ptrdiff_t>(samples)},
                    0,
                    0,
                    false,
                    {}});
  }
  std::vector<StressRecord> take() { return std::move(out_); }

 private:
  std::vector<double> plain_;
  std::vector<StressRecord> out_;
};

}  // namespace

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

std::vector<StressRecord> stress_records(std::uint64_t seed) {
  StressRecords all(plain_record(seed, kSamples));
  all.add_scaled("a prime number of samples", 0);
  all.add_moved("offset 1e9, noise 1e-6", 1e9, 1e-6);
  all.add_moved("offset 9.81, noise 1e-3", 9.81, 1e-3);
  all.add_moved("offset 1e9, noise 1", 1e9, 1);
  all.add_scaled("denormal (1e-310)", -1030);
  all.add_scaled("scale 1e200", 664);
  all.add_scaled("scale 1e-200", -664);
  all.add("drift of 1e6 deviations", [](double y, double t) { return y + 1e6 * t; });
  all.drifts();
  all.add("constant", [](double, double) { return 9.81; });
  all.add("all zero", [](double, double) { return 0.0; });
  all.add("plus and minus zero", [](double y, double) { return std::copysign(0.0, y); });
  all.add("alternating +1, -1",
          [even = true](double, double) mutable { return (even = !even) ? 1.0 : -1.0; });
  all.add("one bit", [](double y, double) { return y > 0 ? 1.0 : -1.0; });
  all.add("saturated", [](double y, double) { return std::clamp(y, -1.0, 0.5); });
  all.add("float32", [](double y, double) {
    return static_cast<double>(static_cast<float>(9.81 + 1e-3 * y));
  });
  all.add("one spike of 1e300", [first = true](double y, double t) mutable {
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

std::vector<double> comfortable(const StressRecord& record) {
  std::vector<double> out = record.y;
  for (double& y : out) y = std::ldexp(y - record.shift, -record.power);
  return out;
}

}  // namespace libchar
