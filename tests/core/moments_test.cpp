#include "libchar/core/numeric/moments.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>
#include <vector>

#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

// The numbers behind the line of dashes of a NIST StRD file.
std::vector<double> strd(const std::string& name) {
  std::ifstream in(test::known("strd/" + name + ".dat"));
  std::vector<double> y;
  bool data = false;
  for (std::string line; std::getline(in, line);) {
    if (data && line.find_first_of("0123456789") != std::string::npos) y.push_back(std::stod(line));
    data = data || line.rfind("-------", 0) == 0;
  }
  return y;
}

double lre(double got, double certified) {
  if (got == certified) return 15;
  return std::min(15.0, -std::log10(std::abs(got - certified) / std::abs(certified)));
}

Moments of(const std::vector<double>& x) {
  Moments m;
  m.push(x);
  return m;
}

std::vector<double> gaussian(std::size_t n, double offset) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  std::vector<double> y(n);
  for (double& v : y) v = offset + normal(generator);
  return y;
}

}  // namespace

TEST_CASE("NIST StRD univariate sets within half a digit of what binary64 input allows") {
  struct Row {
    const char* name;
    std::size_t n;
    double mean, deviation, mean_digits, deviation_digits;
  };
  // Certified values from the files; digits: what binary64 input allows, less 0.5, at most 14.5.
  const Row rows[] = {
      {"Lew", 200, -177.435, 277.332168044316, 14.5, 14.4},
      {"Lottery", 218, 518.958715596330, 291.699727470969, 14.3, 14.4},
      {"Mavro", 50, 2.00185600000000, 0.000429123454003053, 14.5, 12.6},
      {"Michelso", 100, 299.852400000000, 0.0790105478190518, 14.5, 13.3},
      {"NumAcc1", 3, 10000002, 1, 14.5, 14.5},
      {"NumAcc2", 1001, 1.2, 0.1, 14.0, 14.0},
      {"NumAcc3", 1001, 1000000.2, 0.1, 14.5, 9.0},
      {"NumAcc4", 1001, 10000000.2, 0.1, 14.0, 7.8},
      {"PiDigits", 5000, 4.53480000000000, 2.86733906028871, 14.0, 14.0},
  };
  for (const Row& row : rows) {
    CAPTURE(row.name);
    const auto y = strd(row.name);
    REQUIRE(y.size() == row.n);
    const Moments m = of(y);
    const double mean_digits = lre(m.mean(), row.mean), deviation_digits = lre(m.standard_deviation(), row.deviation);
    CHECK(mean_digits >= row.mean_digits);
    CHECK(deviation_digits >= row.deviation_digits);
  }
}

TEST_CASE("an offset of 10⁹ standard deviations costs nothing") {
  const auto high = gaussian(300'000, 1e9);
  auto low = high;
  for (double& v : low) v -= 1e9;
  const Moments a = of(high), b = of(low);
  CHECK(std::abs(a.variance() / b.variance() - 1) < 1e-13);
  CHECK(a.mean() - 1e9 == Approx(b.mean()).margin(2e-7));
  CHECK(a.skewness() == Approx(b.skewness()).margin(1e-10));
  CHECK(a.kurtosis() == Approx(b.kurtosis()).epsilon(1e-10));
}

TEST_CASE("moments of every order agree with sums in long double") {
  const auto x = gaussian(50'001, 3);
  long double n = x.size(), mean = 0, m2 = 0, m3 = 0, m4 = 0;
  for (const double v : x) mean += static_cast<long double>(v) / n;
  for (const double v : x) {
    const long double d = static_cast<long double>(v) - mean;
    m2 += d * d;
    m3 += d * d * d;
    m4 += d * d * d * d;
  }
  const Moments m = of(x);
  CHECK(m.mean() == Approx(static_cast<double>(mean)).epsilon(1e-15));
  CHECK(m.variance() == Approx(static_cast<double>(m2 / (n - 1))).epsilon(1e-14));
  CHECK(m.skewness() == Approx(static_cast<double>(std::sqrt(n) * m3 / std::pow(m2, 1.5L))).epsilon(1e-10));
  CHECK(m.kurtosis() == Approx(static_cast<double>(n * m4 / (m2 * m2))).epsilon(1e-12));
  CHECK(m.minimum() == *std::min_element(x.begin(), x.end()));
  CHECK(m.maximum() == *std::max_element(x.begin(), x.end()));
}

TEST_CASE("the bits do not depend on how samples are pushed, missing ones included") {
  auto x = gaussian(20'011, 5);
  x[0] = x[4095] = x[4096] = x[9000] = x[20'010] = std::numeric_limits<double>::quiet_NaN();
  const Moments whole = of(x);
  CHECK(whole.count() == 20'006);
  CHECK(whole.missing() == 5);
  for (const std::size_t block : {1U, 2U, 7U, 63U, 4095U, 4096U, 4097U, 10'000U}) {
    Moments m;
    for (std::size_t i = 0; i < x.size(); i += block) m.push({x.data() + i, std::min(block, x.size() - i)});
    CAPTURE(block);
    CHECK(m.count() == whole.count());
    CHECK(m.missing() == whole.missing());
    CHECK(m.mean() == whole.mean());
    CHECK(m.variance() == whole.variance());
    CHECK(m.skewness() == whole.skewness());
    CHECK(m.kurtosis() == whole.kurtosis());
    CHECK(m.minimum() == whole.minimum());
    CHECK(m.maximum() == whole.maximum());
  }
}

TEST_CASE("none, one, constant and only missing samples give numbers, not NaN") {
  const double missing = std::numeric_limits<double>::quiet_NaN();
  for (const std::vector<double>& x : {std::vector<double>{}, {missing, missing}}) {
    const Moments m = of(x);
    CHECK(m.count() == 0);
    CHECK(m.mean() == 0);
    CHECK(m.variance() == 0);
    CHECK(m.kurtosis() == 0);
    CHECK(std::isinf(m.minimum()));
  }
  CHECK(of({5}).mean() == 5);
  CHECK(of({5}).variance() == 0);
  const Moments constant = of(std::vector<double>(10'000, 0.1));
  CHECK(constant.mean() == 0.1);
  CHECK(constant.variance() == 0);
  CHECK(constant.skewness() == 0);
  CHECK(constant.kurtosis() == 0);
}

TEST_CASE("moments: deviations of any size that a double has, also where they change on the way") {
  std::vector<double> plain(10000);
  for (std::size_t i = 0; i < plain.size(); ++i) plain[i] = std::sin(static_cast<double>(i) * static_cast<double>(i));
  const auto of = [](const std::vector<double>& y) {
    Moments moments;
    moments.push(y);
    return moments;
  };
  const Moments expected = of(plain);
  for (const int power : {-900, -400, 400, 900}) {
    INFO(power);
    std::vector<double> scaled = plain;
    for (double& y : scaled) y = std::ldexp(y, power);
    const Moments moments = of(scaled);
    CHECK(std::ldexp(moments.standard_deviation(), -power) == Approx(expected.standard_deviation()).epsilon(1e-14));
    CHECK(moments.kurtosis() == Approx(expected.kurtosis()).epsilon(1e-12));
    CHECK(moments.skewness() == Approx(expected.skewness()).margin(1e-12));
    CHECK(std::ldexp(moments.mean(), -power) == Approx(expected.mean()).margin(1e-14));
  }
  std::vector<double> spike = plain;
  spike[8000] = 1e300;
  CHECK(of(spike).standard_deviation() == Approx(1e300 / std::sqrt(10000.0)).epsilon(1e-3));
  CHECK(of(spike).kurtosis() == Approx(10000.0).epsilon(1e-3));
  CHECK(of({1e308, -1e308, 1e308, -1e308}).standard_deviation() == Approx(1e308 * std::sqrt(4 / 3.0)).epsilon(1e-14));
}
