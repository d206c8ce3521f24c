// What holds for numbers, texts, statistics and small matrices, whatever they are.

#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>
#include <set>

#include "libchar/core/document/document.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/moments.hpp"
#include "libchar/core/numeric/present.hpp"
#include "libchar/core/numeric/random_effects.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/markup.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "tests/properties/generate.hpp"

using namespace libchar;
using namespace props;

namespace {

Moments moments_of(const Record& y) {
  Moments out;
  out.push(y);
  return out;
}

Record all_of(const Moments& m) {
  return {m.mean(), m.variance(), m.skewness(), m.kurtosis(), m.minimum(), m.maximum()};
}

std::string any_text() { return *rc::gen::string<std::string>(); }

Eigen::MatrixXd matrix(int rows, int columns) {
  const Record values = *rc::gen::container<Record>(static_cast<std::size_t>(rows * columns), between(-4, 4));
  return Eigen::Map<const Eigen::MatrixXd>(values.data(), rows, columns);
}

double norm(const Eigen::MatrixXd& m) { return m.size() == 0 ? 0 : m.cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("property: the shortest decimal of a double reads back to its bits") {
  holds([] {
    const double x = *any_finite();
    RC_ASSERT(same_bits({parse_double(shortest(x)).value()}, {x}));
  });
}
TEST_CASE("property: a decimal for YAML reads back to its bits and has a point") {
  holds([] {
    const double x = *any_finite();
    const std::string text = shortest_yaml(x);
    RC_ASSERT(text.find('.') != std::string::npos);
    RC_ASSERT(same_bits({parse_double(text).value()}, {x}));
  });
}
TEST_CASE("property: seventeen digits read back to the bits") {
  holds([] {
    const double x = *any_finite();
    RC_ASSERT(same_bits({rounded(x, 17)}, {x}));
  });
}
TEST_CASE("property: a number with anything behind it is no number") {
  holds([] {
    const std::string tail = *rc::gen::nonEmpty(rc::gen::string<std::string>());
    RC_PRE(tail.find_first_of("0123456789eE.") != 0);
    RC_ASSERT(!parse_double("1.5" + tail));
  });
}
TEST_CASE("property: significant digits are as near as they say") {
  holds([](unsigned char digits) {
    const double x = *between(1e-3, 1e3);
    const int n = 1 + digits % 15;
    RC_ASSERT(near(rounded(x, n), x, 0.51 * std::pow(10, 1 - n)));
  });
}
TEST_CASE("property: moments do not depend on the pieces of a record") {
  holds([] {
    const Record y = with_gaps(record(0, 300), 5);
    Moments parts;
    in_pieces(y, [&](std::span<const double> piece) { parts.push(piece); });
    RC_ASSERT(same_bits(all_of(parts), all_of(moments_of(y))));
  });
}
TEST_CASE("property: an offset moves the mean and nothing else, as far as sums are exact") {
  holds([] {
    const Record y = record(2, 200);
    const Moments plain = moments_of(y), moved = moments_of(shifted(y, 0x1p30));
    RC_ASSERT(near(moved.mean() - 0x1p30, plain.mean(), 1e-6) || std::abs(plain.mean()) < 1e-5);
    RC_ASSERT(same_bits({moved.variance(), moved.skewness()}, {plain.variance(), plain.skewness()}));
  });
}
TEST_CASE("property: a power of two scales mean and deviation exactly") {
  holds([] {
    const Record y = record(2, 200);
    const int power = *rc::gen::inRange(-60, 60);
    const Moments plain = moments_of(y), big = moments_of(scaled(y, power));
    RC_ASSERT(
        same_bits({big.mean(), big.standard_deviation(), big.kurtosis()},
                  {std::ldexp(plain.mean(), power), std::ldexp(plain.standard_deviation(), power), plain.kurtosis()}));
  });
}
TEST_CASE("property: a mirrored record has the mirrored mean and the same spread") {
  holds([] {
    Record y = record(2, 200);
    const Moments plain = moments_of(y);
    for (double& v : y) v = -v;
    const Moments mirrored = moments_of(y);
    RC_ASSERT(same_bits({mirrored.mean(), mirrored.variance(), mirrored.maximum()},
                        {-plain.mean(), plain.variance(), -plain.minimum()}) ||
              plain.mean() == 0);
  });
}
TEST_CASE("property: what is counted and what is missing are all there is") {
  holds([] {
    const Record y = with_gaps(record(0, 300), 3);
    const Moments moments = moments_of(y);
    RC_ASSERT(moments.count() + moments.missing() == y.size());
    RC_ASSERT(moments.missing() == count_missing(y));
  });
}
TEST_CASE("property: a mean lies between the extremes, a variance is not negative") {
  holds([] {
    const Moments m = moments_of(*several(1, 50, between(-1e6, 1e6)));
    const double slack = 1e-9 * std::max(std::abs(m.minimum()), std::abs(m.maximum()));
    RC_ASSERT(m.mean() >= m.minimum() - slack);
    RC_ASSERT(m.mean() <= m.maximum() + slack);
    RC_ASSERT(m.variance() >= 0);
    RC_ASSERT(m.kurtosis() >= 0);
  });
}
TEST_CASE("property: a median has half of the values on either side, in any order") {
  holds([] {
    Record y = record(1, 60);
    Record other = turned(y);
    const double median = median_in_place(y);
    RC_ASSERT(median == median_in_place(other));
    const auto below = std::count_if(y.begin(), y.end(), [&](double v) { return v < median; });
    const auto above = std::count_if(y.begin(), y.end(), [&](double v) { return v > median; });
    RC_ASSERT(2 * static_cast<std::size_t>(below) <= y.size());
    RC_ASSERT(2 * static_cast<std::size_t>(above) <= y.size());
  });
}
TEST_CASE("property: lower and upper middle are values, and the mean of them is the median") {
  holds([] {
    Record y = record(1, 60);
    const double lower = median_in_place(y, Middle::lower), upper = median_in_place(y, Middle::upper);
    RC_ASSERT(std::count(y.begin(), y.end(), lower) > 0);
    RC_ASSERT(std::count(y.begin(), y.end(), upper) > 0);
    RC_ASSERT((lower + upper) / 2 == median_in_place(y));
  });
}
TEST_CASE("property: runs of present samples end at the first missing one") {
  holds([] {
    const Record y = with_gaps(record(0, 200), 50);
    std::size_t n = 0;
    while (n < y.size() && !std::isnan(y[n])) ++n;
    RC_ASSERT(present_run(y) == n);
    RC_ASSERT(finite_run(y) == n);
  });
}
TEST_CASE("property: the mean of random effects lies among the values and moves with them") {
  holds([] {
    const Record value = record(2, 12);
    const Record variance = *rc::gen::container<Record>(value.size(), between(0.1, 4));
    const RandomEffects plain = random_effects(value, variance), moved = random_effects(shifted(value, 1024), variance);
    const auto [low, high] = std::minmax_element(value.begin(), value.end());
    RC_ASSERT(plain.mean >= *low - 1e-9 * std::abs(*low));
    RC_ASSERT(plain.mean <= *high + 1e-9 * std::abs(*high));
    RC_ASSERT(std::abs(moved.mean - 1024 - plain.mean) < 1e-6);
    RC_ASSERT(std::abs(moved.spread - plain.spread) <= 1e-6 * (1 + plain.spread));
    RC_ASSERT(plain.spread_ci95.low <= plain.spread * (1 + 1e-9));
  });
}
TEST_CASE("property: a chi-square quantile is undone by its distribution") {
  holds([] {
    const double dof = *between(0.5, 400), p = *between(0.001, 0.999);
    RC_ASSERT(near(chi_square_cdf(chi_square_quantile(p, dof), dof), p, 1e-10));
    RC_ASSERT(near(chi_square_tail(chi_square_upper_quantile(p, dof), dof), p, 1e-10));
  });
}
TEST_CASE("property: an interval of a deviation holds it and grows with the confidence") {
  holds([] {
    const double edf = *between(1, 1000), deviation = *between(0.01, 100);
    const Interval narrow = chi_square_interval(deviation, edf, 0.5), wide = chi_square_interval(deviation, edf, 0.99);
    RC_ASSERT(wide.low < narrow.low);
    RC_ASSERT(wide.high > narrow.high);
    RC_ASSERT(wide.low < deviation);
    RC_ASSERT(wide.high > deviation);
  });
}
TEST_CASE("property: Student's quantile is odd, and its tail gives the probability back") {
  holds([] {
    const double dof = *between(1, 200), p = *between(0.01, 0.49);
    RC_ASSERT(near(student_quantile(p, dof), -student_quantile(1 - p, dof), 1e-9));
    RC_ASSERT(near(student_tail(student_quantile(1 - p, dof), dof), p, 1e-9));
  });
}
TEST_CASE("property: a binomial distribution and its tail sum to one") {
  holds([] {
    const double trials = *rc::gen::inRange(1, 500), each = *between(0.01, 0.99);
    const double k = *rc::gen::inRange(0, static_cast<int>(trials) + 1);
    RC_ASSERT(std::abs(binomial_cdf(k, trials, each) + binomial_tail(k, trials, each) - 1) < 1e-12);
  });
}
TEST_CASE("property: the residual of least squares is orthogonal to the columns") {
  holds([] {
    const int columns = *rc::gen::inRange(1, 5), rows = columns + *rc::gen::inRange(1, 12);
    const Eigen::MatrixXd a = matrix(rows, columns) + 9 * Eigen::MatrixXd::Identity(rows, columns), b = matrix(rows, 1);
    const Eigen::MatrixXd x = least_squares(a, b);
    RC_ASSERT(norm(a.transpose() * (a * x - b)) < 1e-10 * (1 + norm(b)) * norm(a) * rows);
    const PivotedSolution pivoted = pivoted_least_squares(a, b.col(0));
    RC_ASSERT(pivoted.rank == columns);
    RC_ASSERT(norm(pivoted.x - x) < 1e-10 * (1 + norm(x)));
  });
}
TEST_CASE("property: a column twice costs a rank and no accuracy of the sum") {
  holds([] {
    Eigen::MatrixXd a = matrix(12, 3) + 9 * Eigen::MatrixXd::Identity(12, 3);
    const Eigen::MatrixXd b = matrix(12, 1);
    Eigen::MatrixXd twice(12, 4);
    twice << a, a.col(1);
    const PivotedSolution one = pivoted_least_squares(a, b.col(0)), two = pivoted_least_squares(twice, b.col(0));
    RC_ASSERT(two.rank == 3);
    RC_ASSERT(norm(twice * two.x - a * one.x) < 1e-9);
    const PivotedSolution shortest = shortest_least_squares(twice, b.col(0), 1e-12);
    RC_ASSERT(std::abs(shortest.x[1] - shortest.x[3]) < 1e-9);
  });
}
TEST_CASE("property: a Cholesky factor gives its matrix back, and solves with it") {
  holds([] {
    const int n = *rc::gen::inRange(1, 6);
    const Eigen::MatrixXd root = matrix(n, n), a = root * root.transpose() + Eigen::MatrixXd::Identity(n, n);
    const auto l = cholesky_factor(a);
    RC_ASSERT(l.has_value());
    RC_ASSERT(norm(*l * l->transpose() - a) < 1e-12 * norm(a) * n);
    RC_ASSERT(norm(a * cholesky_inverse(a) - Eigen::MatrixXd::Identity(n, n)) < 1e-9 * norm(a));
    RC_ASSERT(norm(inverse_cholesky_factor(a) * *l - Eigen::MatrixXd::Identity(n, n)) < 1e-9 * norm(a));
  });
}
TEST_CASE("property: a matrix with a negative eigenvalue has no Cholesky factor") {
  holds([] {
    const int n = *rc::gen::inRange(1, 6);
    const Eigen::MatrixXd root = matrix(n, n);
    RC_ASSERT(!cholesky_factor(-(root * root.transpose()) - Eigen::MatrixXd::Identity(n, n)));
  });
}
TEST_CASE("property: eigenvalues ascend and eigenvectors give the matrix back") {
  holds([] {
    const int n = *rc::gen::inRange(1, 7);
    const Eigen::MatrixXd half = matrix(n, n), a = half + half.transpose();
    const SymmetricEigen eigen = symmetric_eigen(a);
    for (int i = 1; i < n; ++i) RC_ASSERT(eigen.values[i] >= eigen.values[i - 1]);
    RC_ASSERT(norm(eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose() - a) < 1e-10 * (1 + norm(a)));
  });
}
TEST_CASE("property: a projector off columns leaves nothing of them, twice is once") {
  holds([] {
    const Eigen::MatrixXd a = matrix(8, 2) + 9 * Eigen::MatrixXd::Identity(8, 2), q = thin_qr(a).q,
                          p = complement_projector(q);
    RC_ASSERT(norm(p * a) < 1e-10 * norm(a));
    RC_ASSERT(norm(p * p - p) < 1e-12);
    const Eigen::MatrixXd y = matrix(8, 3);
    RC_ASSERT(norm(without_columns_of(q, y) - p * y) < 1e-11 * (1 + norm(y)));
  });
}
TEST_CASE("property: a digest does not depend on the pieces of a text") {
  holds([] {
    const std::string text = any_text() + any_text();
    Sha256 whole, parts;
    whole.update(text);
    std::string_view rest = text;
    while (!rest.empty()) {
      const auto n = static_cast<std::size_t>(*rc::gen::inRange(1, static_cast<int>(rest.size()) + 1));
      parts.update(rest.substr(0, n));
      rest.remove_prefix(n);
    }
    RC_ASSERT(whole.finish() == parts.finish());
  });
}
TEST_CASE("property: a text for the terminal has no control characters, and printing it twice is once") {
  holds([] {
    const std::string shown = printable(any_text());
    for (const char c : shown) RC_ASSERT(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f);
    RC_ASSERT(first_invalid_utf8(shown) == std::string::npos);
    RC_ASSERT(printable(shown) == shown);
  });
}
TEST_CASE("property: a quoted text reads back from YAML") {
  holds([] {
    const std::string text = latin1_to_utf8(any_text());
    RC_PRE(text.find('\0') == std::string::npos);
    const Document read = parse_yaml_document("key: " + quoted_yaml(text) + "\n", "x.yaml");
    RC_ASSERT(read.find("key")->value.text == text);
  });
}
TEST_CASE("property: no cell of a table is a formula") {
  holds([] {
    const std::string text = *rc::gen::elementOf(std::string("=+-@\t\rx ")) + any_text();
    const std::string cell = csv_cell(text);
    const char first = cell[0] == '"' ? cell[1] : cell[0];
    RC_ASSERT(std::string("=+-@\t\r").find(first) == std::string::npos);
  });
}
TEST_CASE("property: a channel's file name is short, visible and one of its own") {
  holds([] {
    std::set<std::string> taken;
    const std::string name = any_text();
    const std::string first = unused_file_name_for(name, taken), second = unused_file_name_for(name, taken);
    RC_ASSERT(first != second);
    RC_ASSERT(!first.empty() && first.size() <= 100 && first[0] != '.');
    RC_ASSERT(first.find('/') == std::string::npos);
  });
}
TEST_CASE("property: a word is its own nearest, and distances are those of a metric") {
  holds([] {
    const std::string a = any_text(), b = any_text(), c = any_text();
    RC_ASSERT(edit_distance(a, a) == 0);
    RC_ASSERT(edit_distance(a, b) == edit_distance(b, a));
    RC_ASSERT(edit_distance(a, b) <= std::max(a.size(), b.size()));
    RC_ASSERT(nearest(a, {b, a, c}) == (edit_distance(a, b) == 0 ? b : a) || a.empty());
  });
}
TEST_CASE("property: a star matches everything, a name without signs itself alone") {
  holds([] {
    const std::string text = any_text();
    RC_ASSERT(matches("*", text));
    if (!is_pattern(text)) RC_ASSERT(matches(text, text));
    RC_ASSERT(matches("*" + std::string(is_pattern(text) ? "" : text), text));
    if (!is_pattern(text) && !text.empty()) RC_ASSERT(!matches(text, ""));
  });
}
TEST_CASE("property: the order of names is strict and total") {
  holds([] {
    const auto name = [] { return *rc::gen::container<std::string>(rc::gen::elementOf(std::string("a0129b"))); };
    const std::string a = name(), b = name(), c = name();
    RC_ASSERT(!comes_before(a, a));
    RC_ASSERT((a == b) == (!comes_before(a, b) && !comes_before(b, a)));
    if (comes_before(a, b) && comes_before(b, c)) RC_ASSERT(comes_before(a, c));
  });
}
TEST_CASE("property: numbers in JSON read back to their bits") {
  holds([] {
    const Record y = *several(0, 20, any_finite());
    const Json read = parse_json(dump_json(Json(y)), "x.json");
    RC_ASSERT(same_bits(read.get<Record>(), y));
  });
}
