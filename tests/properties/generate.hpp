#pragma once
// What properties are tried on. `RC_PARAMS="seed=N max_success=M"` in the environment changes seed and number of cases.

#include <rapidcheck.h>
#include <rapidcheck/catch.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace props {

using Record = std::vector<double>;

template <class Property>
void holds(Property&& property) {
  rc::prop("holds", std::forward<Property>(property));
}

/// Multiples of 2^-10 up to 1024: sums and differences of a few thousand of them are exact.
inline rc::Gen<double> on_grid() {
  return rc::gen::map(rc::gen::inRange(-(1 << 20), 1 << 20), [](int k) { return std::ldexp(k, -10); });
}

/// Any finite double, all exponents alike.
inline rc::Gen<double> any_finite() {
  return rc::gen::suchThat(rc::gen::map(rc::gen::arbitrary<std::uint64_t>(),
                                        [](std::uint64_t bits) {
                                          double value = 0;
                                          std::memcpy(&value, &bits, sizeof value);
                                          return value;
                                        }),
                           [](double value) { return std::isfinite(value); });
}

inline rc::Gen<double> between(double low, double high) {
  return rc::gen::map(rc::gen::inRange(0, 1 << 20), [=](int k) { return low + (high - low) * std::ldexp(k, -20); });
}

template <class T>
rc::Gen<std::vector<T>> several(int least, int most, const rc::Gen<T>& each) {
  return rc::gen::mapcat(rc::gen::inRange(least, most + 1), [each](int n) {
    return rc::gen::container<std::vector<T>>(static_cast<std::size_t>(n), each);
  });
}

inline Record record(int least, int most) { return *several(least, most, on_grid()); }

/// One in `rarity` is missing.
inline Record with_gaps(Record y, int rarity) {
  for (double& v : y)
    if (*rc::gen::inRange(0, rarity) == 0) v = std::numeric_limits<double>::quiet_NaN();
  return y;
}

/// Calls `take` with the record in pieces of any size.
template <class Take>
void in_pieces(const Record& y, Take take) {
  std::span<const double> rest = y;
  while (!rest.empty()) {
    const auto n = static_cast<std::size_t>(*rc::gen::inRange(1, static_cast<int>(rest.size()) + 1));
    take(rest.first(n));
    rest = rest.subspan(n);
  }
}

inline Record scaled(Record y, int power) {
  for (double& v : y) v = std::ldexp(v, power);
  return y;
}
inline Record shifted(Record y, double by) {
  for (double& v : y) v += by;
  return y;
}
inline Record turned(const Record& y) { return {y.rbegin(), y.rend()}; }

inline bool same_bits(const Record& a, const Record& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}
inline bool near(double a, double b, double relative) {
  return a == b || std::abs(a - b) <= relative * std::max(std::abs(a), std::abs(b));
}
/// Each within `relative` of the largest of all.
inline bool near(const Record& a, const Record& b, double relative) {
  double largest = 0;
  for (const double v : b) largest = std::max(largest, std::abs(v));
  bool out = a.size() == b.size();
  for (std::size_t i = 0; out && i < a.size(); ++i) out = std::abs(a[i] - b[i]) <= relative * largest;
  return out;
}

}  // namespace props
