// Properties of the Allan family (reliability notes, 4): scaling, offsets, drift, gaps, threads, bad input.

#include "libchar/allan/allan_deviation.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <string>

#include "libchar/allan/detail/anchored_phase.hpp"
#include "libchar/core/error.hpp"
#include "tests/allan/present_reference.hpp"
#include "tests/support/places.hpp"

using namespace libchar;

namespace {

__extension__ typedef __float128 Quad;

const std::vector<DeviationType> kAll = {DeviationType::adev,  DeviationType::oadev, DeviationType::mdev,
                                         DeviationType::tdev,  DeviationType::hdev,  DeviationType::ohdev,
                                         DeviationType::totdev};

std::vector<double> white(std::size_t n, unsigned seed, double offset = 0, double sigma = 1) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<double> y(n);
  for (double& v : y) v = offset + sigma * normal(engine);
  return y;
}

std::vector<double> integers(std::size_t n, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::vector<double> y(n);
  for (double& v : y) v = double(engine() % 2001) - 1000;
  return y;
}

AllanCurve curve_of(const std::vector<double>& y, DeviationType type, TauGrid grid = TauGrid::octave, int threads = 0) {
  AllanOptions options;
  options.type = type;
  options.grid = grid;
  options.threads = threads;
  return allan_deviation(y, 0.5, options);
}

/// Overlapping Allan or modified deviation of the doubles as they are, in 113 bits.
double reference(const std::vector<double>& y, std::size_t m, bool modified) {
  std::vector<Quad> x(y.size() + 1, Quad(0));
  for (std::size_t i = 0; i < y.size(); ++i) x[i + 1] = x[i] + Quad(y[i]);
  std::vector<Quad> d;
  for (std::size_t i = 0; i + 2 * m < x.size(); ++i) d.push_back(x[i + 2 * m] - 2 * x[i + m] + x[i]);
  Quad sum = 0;
  std::size_t terms = d.size();
  if (modified) {
    terms = d.size() - m + 1;
    Quad window = 0;
    for (std::size_t i = 0; i < d.size(); ++i) {
      window += d[i];
      if (i + 1 >= m) {
        sum += window * window / (Quad(m) * Quad(m));
        window -= d[i + 1 - m];
      }
    }
  } else {
    for (const Quad& v : d) sum += v * v;
  }
  return std::sqrt(static_cast<double>(sum / (2 * Quad(m) * Quad(m) * Quad(terms))));
}

double at(const AllanCurve& curve, std::uint64_t m) {
  for (const AllanPoint& p : curve.points)
    if (p.m == m) return p.deviation;
  return std::nan("");
}

void check_same_bits(const AllanCurve& a, const AllanCurve& b, double factor) {
  REQUIRE(a.points.size() == b.points.size());
  for (std::size_t k = 0; k < a.points.size(); ++k) {
    INFO(name_of(a.type) << " m " << a.points[k].m);
    CHECK(a.points[k].deviation * factor == b.points[k].deviation);
    CHECK(a.points[k].terms == b.points[k].terms);
  }
}

}  // namespace

TEST_CASE("names and types") {
  for (const DeviationType type : kAll) CHECK(deviation_type(name_of(type)) == type);
  CHECK_FALSE(deviation_type("allan"));
}

TEST_CASE("the table of deviations stands in the order of its enum, and the page has each word") {
  std::ifstream file(test::source_folder() / "docs" / "theory" / "allan.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  const auto rows = deviation_rows();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    CAPTURE(rows[i].word);
    CHECK(static_cast<std::size_t>(rows[i].type) == i);
    CHECK(&deviation_row(rows[i].type) == &rows[i]);
    CHECK(page.find('`' + std::string(rows[i].word) + '`') != std::string::npos);
    CHECK(deviation_words()[i] == rows[i].word);
  }
}

TEST_CASE("as many samples as one term spans make one point, one fewer none") {
  for (const DeviationRow& row : deviation_rows()) {
    CAPTURE(row.word);
    AllanOptions options;
    options.type = row.type;
    std::vector<double> record(row.span(1));
    options.grid = TauGrid::all;
    options.tau_max_s = 1000;
    for (std::size_t i = 0; i < record.size(); ++i) record[i] = static_cast<double>(i * i);
    CHECK(allan_deviation(record, 1, options).points.size() >= 1);
    record.pop_back();
    CHECK_THROWS_AS(allan_deviation(record, 1, options), Error);
  }
}

TEST_CASE("numbers of terms follow the formulas") {
  const auto y = white(1000, 1);
  const auto terms = [&](DeviationType type) { return curve_of(y, type).points.at(3).terms; };  // m = 8
  CHECK(terms(DeviationType::adev) == 124);
  CHECK(terms(DeviationType::oadev) == 985);
  CHECK(terms(DeviationType::mdev) == 978);
  CHECK(terms(DeviationType::hdev) == 123);
  CHECK(terms(DeviationType::ohdev) == 977);
  CHECK(terms(DeviationType::totdev) == 999);
}

TEST_CASE("the total deviation may go to nearly the whole record") {
  AllanOptions options;
  options.type = DeviationType::totdev;
  options.grid = TauGrid::list;
  options.taus_s = {60, 98};
  options.tau_max_s = 100;
  const AllanCurve curve = allan_deviation(white(100, 6), 1, options);
  REQUIRE(curve.points.size() == 2);
  CHECK(curve.points[0].m == 60);
  CHECK(curve.points[1].m == 98);
}

TEST_CASE("the scale that balances a record is that of its deviations, whatever the offset") {
  CHECK(balancing_scale(std::vector<double>(11, 5.0)) == 1);
  const auto y = white(1003, 7);
  for (const double factor : {1.0, 0x1p-500, 0x1p900})
    for (const double offset : {0.0, 64.0, -1048576.0}) {
      std::vector<double> x;
      for (const double v : y) x.push_back(factor * (v + offset));
      const double scale = balancing_scale(x);
      CAPTURE(factor, offset);
      double largest = 0;
      for (const double v : x) largest = std::max(largest, std::fabs(v * 0.5 - x[0] * 0.5) * scale);
      CHECK(largest >= 1);
      CHECK(largest < 2);
    }
}

TEST_CASE("grids") {
  const auto y = white(5000, 2);
  const auto factors = [&](TauGrid grid) {
    std::vector<std::uint64_t> m;
    for (const auto& p : curve_of(y, DeviationType::oadev, grid).points) m.push_back(p.m);
    return m;
  };
  CHECK(factors(TauGrid::octave) == std::vector<std::uint64_t>{1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048});
  CHECK(factors(TauGrid::decade) == std::vector<std::uint64_t>{1, 2, 4, 10, 20, 40, 100, 200, 400, 1000, 2000});
  const auto dense = factors(TauGrid::dense);
  CHECK(dense[998] == 999);
  CHECK(dense.size() > 1050);
  CHECK(std::is_sorted(dense.begin(), dense.end()));
  CHECK(dense.back() <= 2500);
  // Beyond 1000 the factors are even on a logarithmic axis: ten times as long is one of them.
  AllanOptions long_grid;
  long_grid.grid = TauGrid::dense;
  long_grid.tau_min_s = 900;
  const auto far = allan_deviation(white(20001, 3), 1, long_grid).points;
  REQUIRE(far.back().m == 10000);
  for (std::size_t k = 101; k < far.size(); ++k)
    CHECK(static_cast<double>(far[k].m) / static_cast<double>(far[k - 1].m) ==
          Approx(static_cast<double>(far[101].m) / static_cast<double>(far[100].m)).epsilon(2e-3));

  AllanOptions options;
  options.grid = TauGrid::list;
  options.taus_s = {3.1, 0.5, 2.9, 1e9, 1e-9};
  const AllanCurve curve = allan_deviation(y, 0.5, options);
  REQUIRE(curve.points.size() == 2);  // 0.5 and 1e-9 are both m = 1; 3.1 and 2.9 both m = 6
  CHECK(curve.points[1].m == 6);
  REQUIRE(curve.notes.size() == 2);
  CHECK(curve.notes[0].find("longer than the record") != std::string::npos);
  CHECK(curve.notes[1].find("nearest multiple") != std::string::npos);
  options = {};
  options.tau_min_s = 2;
  options.tau_max_s = 16;
  const AllanCurve part = allan_deviation(y, 0.5, options);
  CHECK(part.points.front().m == 4);
  CHECK(part.points.back().m == 32);
}

TEST_CASE("averaging times reach as far as a term does, of the total deviation over the whole record") {
  const auto y = white(101, 4);
  for (const DeviationRow& row : deviation_rows()) {
    CAPTURE(row.word);
    AllanOptions options;
    options.type = row.type;
    options.grid = TauGrid::dense;
    options.tau_max_s = 1000;
    const std::uint64_t last = allan_deviation(y, 1, options).points.back().m;
    CHECK(row.span(last) <= 101);
    const bool even = row.family == DeviationFamily::theo;  // the next one has two more
    CHECK(row.span(last + (even ? 2 : 1)) > 101);
  }
}

TEST_CASE("powers of two scale bit-exactly, from denormals to 1e200") {
  const auto y = white(3000, 3, 7.5);
  for (const DeviationType type : kAll) {
    const AllanCurve base = curve_of(y, type);
    for (const int k : {-900, -300, -7, 1, 30, 600, 1000}) {
      auto scaled = y;
      for (double& v : scaled) v = std::ldexp(v, k);
      check_same_bits(base, curve_of(scaled, type), std::ldexp(1.0, k));
    }
    auto tiny = y;
    for (double& v : tiny) v *= 1e-310;
    const AllanCurve denormal = curve_of(tiny, type);
    for (std::size_t k = 0; k < base.points.size(); ++k)
      CHECK(denormal.points[k].deviation == Approx(base.points[k].deviation * 1e-310).epsilon(1e-5).margin(3e-323));
  }
}

TEST_CASE("an offset changes no bit of integer data") {
  const auto y = integers(5000, 4);
  for (const DeviationType type : kAll)
    for (const double c : {1.0, 9.0e9, 1.0e12}) {
      auto shifted = y;
      for (double& v : shifted) v += c;
      check_same_bits(curve_of(y, type), curve_of(shifted, type), 1);
    }
}

TEST_CASE("constants give exactly zero, whatever they are") {
  for (const double c : {0.0, -0.0, 9.81, 1e9, -1e200, 1e-310})
    for (const DeviationType type : kAll)
      for (const auto& p : curve_of(std::vector<double>(3000, c), type).points) CHECK(p.deviation == 0);
}

TEST_CASE("offset 1e9 sigma and strong drift, against 113 bits") {
  const std::size_t n = 50000;
  auto offset = white(n, 5, 987654321.123456, 1), drift = white(n, 6), gravity = white(n, 7, 9.81, 1e-3);
  for (std::size_t i = 0; i < n; ++i) drift[i] += 1e6 * double(i) / double(n);
  const auto worst = [&](const std::vector<double>& y, bool modified) {
    const AllanCurve curve = curve_of(y, modified ? DeviationType::mdev : DeviationType::oadev, TauGrid::decade);
    double w = 0;
    for (const auto& p : curve.points) w = std::max(w, std::fabs(p.deviation / reference(y, p.m, modified) - 1));
    return w;
  };
  for (const bool modified : {false, true}) {
    INFO((modified ? "mdev" : "oadev"));
    CHECK(worst(offset, modified) <= (modified ? 1e-12 : 1e-13));
    CHECK(worst(gravity, modified) <= (modified ? 1e-12 : 1e-13));
    CHECK(worst(drift, modified) <= 1e-10);
  }
}

TEST_CASE("records that end where a block of the phase does, and a sample beside it") {
  // 8191 samples have 8192 points of the phase: a third block begins behind the last sample. Read
  // there, garbage and a broken heap came.
  for (const std::size_t whole : {4096U, 8192U, 12288U})
    for (const std::size_t n : {whole - 2, whole - 1, whole, whole + 1}) {
      const std::vector<double> y = white(n, 11, 3.0);
      for (const bool modified : {false, true})
        for (const auto& p : curve_of(y, modified ? DeviationType::mdev : DeviationType::oadev).points)
          CHECK(p.deviation == Approx(reference(y, p.m, modified)).epsilon(1e-12));
    }
}

TEST_CASE("closed forms: ramp, alternation, block means, one octave of identities") {
  std::vector<double> ramp(4000), alternating(4000);
  for (std::size_t i = 0; i < ramp.size(); ++i) {
    ramp[i] = double(i) * 0.5 * 3;  // 3 units a second at dt = 0.5 s
    alternating[i] = i % 2 ? -1 : 1;
  }
  for (const auto& p : curve_of(ramp, DeviationType::oadev).points)
    CHECK(p.deviation == Approx(3 * p.tau_s / std::sqrt(2.0)).epsilon(1e-14));
  for (const auto& p : curve_of(ramp, DeviationType::ohdev).points) CHECK(std::fabs(p.deviation) <= 1e-9);
  for (const auto& p : curve_of(alternating, DeviationType::oadev).points)
    CHECK(p.deviation == (p.m == 1 ? std::sqrt(2.0) : 0));

  const auto y = white(4096, 8, 3.3);
  const AllanCurve plain = curve_of(y, DeviationType::adev);
  CHECK(at(plain, 1) == at(curve_of(y, DeviationType::oadev), 1));
  CHECK(at(plain, 1) == Approx(at(curve_of(y, DeviationType::mdev), 1)).epsilon(1e-13));
  const AllanCurve modified = curve_of(y, DeviationType::mdev), time = curve_of(y, DeviationType::tdev);
  for (std::size_t k = 0; k < modified.points.size(); ++k)
    CHECK(time.points[k].deviation ==
          Approx(modified.points[k].tau_s * modified.points[k].deviation / std::sqrt(3.0)).epsilon(1e-15));
  for (const std::size_t m : {2U, 16U, 128U}) {
    std::vector<double> means(y.size() / m);
    for (std::size_t i = 0; i < y.size(); ++i) means[i / m] += y[i] / double(m);
    CHECK(at(plain, m) == Approx(at(curve_of(means, DeviationType::adev), 1)).epsilon(1e-12));
  }
}

TEST_CASE("time reversal") {
  auto y = white(4000, 9, 100);
  for (const DeviationType type : kAll) {
    const AllanCurve forward = curve_of(y, type);
    std::reverse(y.begin(), y.end());
    const AllanCurve backward = curve_of(y, type);
    for (const auto& p : forward.points)
      if (type == DeviationType::oadev || type == DeviationType::mdev || type == DeviationType::ohdev)
        CHECK(at(backward, p.m) == Approx(p.deviation).epsilon(1e-13));
  }
}

TEST_CASE("means are over what is present of a window that is more than half there") {
  auto y = white(3000, 10, 50);
  std::mt19937_64 engine(12);
  for (const std::size_t gap : {0UL, 17UL, 1023UL, 1024UL, 2001UL, 2002UL, 2999UL}) y[gap] = std::nan("");
  y[2500] = std::numeric_limits<double>::infinity();
  for (const int missing : {0, 1000}) {
    for (int i = 0; i < missing; ++i) y[engine() % y.size()] = std::nan("");
    const test::PresentReference reference(y, [](std::uint64_t) { return 1; });
    for (const DeviationType type :
         {DeviationType::adev, DeviationType::oadev, DeviationType::hdev, DeviationType::ohdev}) {
      const AllanCurve curve = curve_of(y, type);
      const bool every = deviation_row(type).overlapping;
      CHECK(curve.points.size() == (deviation_row(type).order == 2 ? 11 : 10));
      for (const auto& p : curve.points) {
        INFO(name_of(type) << " m " << p.m);
        const auto t = reference.at(p.m, deviation_row(type).order, every ? 1 : p.m);
        CHECK(p.terms == t.terms);
        CHECK(p.deviation == Approx(std::sqrt(static_cast<double>(t.variance))).epsilon(1e-12));
        CHECK(p.inflation == Approx(static_cast<double>(t.inflation)).epsilon(1e-12));
      }
    }
  }
}

TEST_CASE("modified deviations average the terms of means over what is present") {
  auto y = white(1500, 14, 50);
  std::mt19937_64 engine(15);
  for (const int missing : {1, 200}) {
    for (int i = 0; i < missing; ++i) y[engine() % y.size()] = std::nan("");
    const test::PresentReference reference(y, [](std::uint64_t) { return 1; });
    const AllanCurve curve = curve_of(y, DeviationType::mdev), time = curve_of(y, DeviationType::tdev);
    REQUIRE(time.points.size() == curve.points.size());
    CHECK(curve.points.back().m == 256);
    for (std::size_t k = 0; k < curve.points.size(); ++k) {
      const AllanPoint& p = curve.points[k];
      INFO("m " << p.m);
      const auto t = reference.modified(p.m);
      CHECK(p.terms == t.terms);
      CHECK(p.deviation == Approx(std::sqrt(static_cast<double>(t.variance))).epsilon(1e-12));
      CHECK(p.inflation == Approx(static_cast<double>(t.inflation)).epsilon(1e-12));
      CHECK(time.points[k].deviation == Approx(p.deviation * p.tau_s / std::sqrt(3.0)).epsilon(1e-14));
    }
  }
}

TEST_CASE("phase data drop exactly the terms that touch a missing point, total deviation takes a stretch") {
  const std::size_t n = 6000;
  auto y = white(n, 10, 50);
  for (const std::size_t gap : {0UL, 17UL, 1023UL, 1024UL, 3000UL, 3001UL, 3002UL, 5999UL}) y[gap] = std::nan("");
  y[2500] = std::numeric_limits<double>::infinity();
  AllanOptions phase;
  phase.data = DataKind::phase;
  for (const auto& p : allan_deviation(y, 1, phase).points) {
    std::uint64_t terms = 0;
    long double sum = 0;
    for (std::size_t i = 0; i + 2 * p.m < n; ++i) {
      const auto first = y.begin() + static_cast<std::ptrdiff_t>(i);
      if (!std::all_of(first, first + static_cast<std::ptrdiff_t>(2 * p.m + 1),
                       [](double v) { return std::isfinite(v); }))
        continue;
      const auto d = static_cast<long double>((y[i + 2 * p.m] - y[i + p.m]) - (y[i + p.m] - y[i]));
      ++terms;
      sum += d * d;
    }
    const auto count = 2 * static_cast<long double>(terms);
    INFO("m " << p.m);
    CHECK(p.terms == terms);
    CHECK(p.deviation * p.tau_s == Approx(std::sqrt(static_cast<double>(sum / count))).epsilon(1e-12));
  }
  const AllanCurve total = curve_of(y, DeviationType::totdev);
  REQUIRE_FALSE(total.notes.empty());
  CHECK(total.notes[0].find("longest stretch") != std::string::npos);
  const std::vector<double> piece(y.begin() + 3003, y.begin() + 5999);
  check_same_bits(curve_of(piece, DeviationType::totdev), total, 1);
}

TEST_CASE("one missing sample ends no curve, a long gap leaves long times without terms, noted") {
  auto y = white(2000, 11);
  const AllanCurve whole = curve_of(y, DeviationType::oadev);
  y[1000] = std::nan("");
  const AllanCurve holed = curve_of(y, DeviationType::oadev);
  REQUIRE(holed.points.size() == whole.points.size());
  for (std::size_t k = 2; k < whole.points.size(); ++k) {
    CHECK(holed.points[k].terms == whole.points[k].terms);
    CHECK(holed.points[k].deviation == Approx(whole.points[k].deviation).epsilon(0.03));
  }
  CHECK(holed.notes.empty());
  std::fill(y.begin() + 700, y.begin() + 1300, std::nan(""));
  const AllanCurve gap = curve_of(y, DeviationType::oadev);
  CHECK(gap.points.back().m == 256);
  REQUIRE(gap.notes.size() == 2);
  CHECK(gap.notes[0].find("are missing") != std::string::npos);
  CHECK(gap.notes[1].find("gaps leave no term") != std::string::npos);
}

TEST_CASE("missing samples are worth a note from more than one in a hundred on") {
  auto y = white(1000, 14);
  for (std::size_t k = 0; k < 10; ++k) y[50 + 100 * k] = std::nan("");
  CHECK(curve_of(y, DeviationType::oadev, TauGrid::octave).notes.empty());
  y[7] = std::nan("");
  const AllanCurve more = curve_of(y, DeviationType::oadev, TauGrid::octave);
  REQUIRE(more.notes.size() == 1);
  CHECK(more.notes[0].find("1.1 % of the samples are missing") == 0);
}

TEST_CASE("the number of threads changes no bit") {
  auto y = white(300000, 12, 9.81);
  y[123456] = std::nan("");
  for (const DeviationType type : kAll) {
    const AllanCurve one = curve_of(y, type, TauGrid::octave, 1);
    for (const int threads : {2, 3, 8}) check_same_bits(one, curve_of(y, type, TauGrid::octave, threads), 1);
  }
}

TEST_CASE("short and bad records are refused in a sentence") {
  const auto fails = [](const std::vector<double>& y, double dt, AllanOptions options) {
    try {
      allan_deviation(y, dt, options);
    } catch (const Error& e) {
      return e.problem().kind;
    }
    return ErrorKind::check;
  };
  AllanOptions options;
  CHECK(fails({}, 1, options) == ErrorKind::numeric);
  CHECK(fails({1}, 1, options) == ErrorKind::numeric);
  CHECK(fails({1, std::nan(""), 2, std::nan("")}, 1, options) == ErrorKind::numeric);
  CHECK(fails({1, 2}, 0, options) == ErrorKind::usage);
  CHECK(fails({1, 2}, std::nan(""), options) == ErrorKind::usage);
  CHECK(allan_deviation(std::vector<double>{1, 2}, 1).points.size() == 1);
  options.grid = TauGrid::list;
  CHECK(fails({1, 2, 3}, 1, options) == ErrorKind::usage);
  for (const double tau : {0.0, -1.0, double(NAN), double(INFINITY)}) {
    options.taus_s = {tau};
    CHECK(fails({1, 2, 3}, 1, options) == ErrorKind::usage);
  }
  options.taus_s = {100};
  CHECK(fails({1, 2, 3}, 1, options) == ErrorKind::numeric);
  options = {};
  options.type = DeviationType::ohdev;
  CHECK(fails({1, 2}, 1, options) == ErrorKind::numeric);
  try {
    allan_deviation(std::vector<double>{1, 2}, 1, options);
  } catch (const Error& e) {
    CHECK(std::string(e.what()).find("at least 3") != std::string::npos);
  }
}
