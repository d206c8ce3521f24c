// NIST's linear and one-way problems (StRD, ../shared/oracle/strd): least squares to the digits
// that a QR of scaled columns gives, mean squares to what their decimal inputs allow.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/numeric/moments.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

std::filesystem::path strd_folder() { return test::shared_folder() / "oracle/strd"; }

/// Rows of the table at the end: behind the last line that begins with "Data:", or from a line on
/// (rules of minus signs apart).
std::vector<std::vector<double>> strd_table(const std::string& name, std::size_t from_line) {
  std::istringstream in(test::slurp(strd_folder() / (name + ".dat")));
  std::vector<std::vector<double>> out;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    std::istringstream cells(line);
    std::vector<double> row;
    for (double v = 0; cells >> v;) row.push_back(v);
    if (number >= from_line && !row.empty()) out.push_back(row);
  }
  return out;
}

double off(double value, double certified) {
  const double relative = std::abs(value - certified) / (certified == 0 ? 1 : std::abs(certified));
  return relative > 0 ? std::min(15.0, -std::log10(relative)) : 15.0;
}

double number_in(const nlohmann::ordered_json& text) { return std::stod(text.get<std::string>()); }

/// The columns that the model's words name: powers of x, x alone, or one and all x.
Eigen::MatrixXd design_of(const std::vector<std::vector<double>>& rows, const std::string& model,
                          std::size_t coefficients) {
  Eigen::MatrixXd out(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(coefficients));
  for (Eigen::Index i = 0; i < out.rows(); ++i) {
    const std::vector<double>& row = rows[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < out.cols(); ++j)
      out(i, j) = model.starts_with("polynomial")                   ? std::pow(row[1], static_cast<double>(j))
                  : model.find("no intercept") != std::string::npos ? row[1]
                  : j == 0                                          ? 1
                                                                    : row[static_cast<std::size_t>(j)];
  }
  return out;
}

/// Digits that reliability is asked of a scaled QR (Eigen 3.4, double).
const std::map<std::string, double> kLinearDigits = {
    {"Norris", 12},  {"Pontius", 12},  {"NoInt1", 14},  {"NoInt2", 14},  {"Longley", 10.5}, {"Filip", 7},
    {"Wampler1", 9}, {"Wampler2", 12}, {"Wampler3", 9}, {"Wampler4", 8}, {"Wampler5", 6}};

/// Half a digit below what exact arithmetic on the rounded decimals gives, of mean squares between and within.
const std::map<std::string, double> kAnovaDigits = {
    {"SiRstvt", 12.6}, {"AtmWtAgt", 9.7}, {"SmLs01t", 14},  {"SmLs02t", 12.9}, {"SmLs03t", 12.4}, {"SmLs04t", 9.4},
    {"SmLs05t", 9.4},  {"SmLs06t", 9.4},  {"SmLs07t", 3.4}, {"SmLs08t", 3.4},  {"SmLs09t", 3.4}};

nlohmann::ordered_json certified() {
  return nlohmann::ordered_json::parse(test::slurp(strd_folder() / "certified.json"));
}

}  // namespace

TEST_CASE("NIST's eleven linear problems: scaled QR with pivoting, full rank, digits as measured") {
  if (!std::filesystem::exists(strd_folder())) {
    WARN("SKIPPED: ../shared/oracle/strd is not there");
    return;
  }
  std::size_t tried = 0;
  const nlohmann::ordered_json all = certified();
  for (const auto& [name, known] : all["linear"].items()) {
    CAPTURE(name);
    const auto rows = strd_table(name, known["first_data_line"].get<std::size_t>());
    REQUIRE(rows.size() == known["n"].get<std::size_t>());
    const Eigen::MatrixXd a = design_of(rows, known["model"], known["coef"].size());
    Eigen::VectorXd y(a.rows());
    for (Eigen::Index i = 0; i < a.rows(); ++i) y[i] = rows[static_cast<std::size_t>(i)][0];
    const PivotedSolution solution = pivoted_least_squares(a, y);
    CHECK(solution.rank == a.cols());
    double digits = 15, plain = 15;
    const Eigen::VectorXd by_qr = least_squares(a, y);
    for (Eigen::Index j = 0; j < a.cols(); ++j) {
      const double value = number_in(known["coef"][static_cast<std::size_t>(j)]);
      digits = std::min(digits, off(solution.x[j], value));
      plain = std::min(plain, off(by_qr[j], value));
    }
    CHECK(digits >= kLinearDigits.at(name));
    CHECK(plain >= std::min(kLinearDigits.at(name), 6.5) - 0.5);
    ++tried;
  }
  CHECK(tried == 11);
}

TEST_CASE("NIST's eleven one-way analyses of variance from moments of groups") {
  if (!std::filesystem::exists(strd_folder())) {
    WARN("SKIPPED: ../shared/oracle/strd is not there");
    return;
  }
  std::size_t tried = 0;
  const nlohmann::ordered_json all = certified();
  for (const auto& [name, known] : all["anova"].items()) {
    CAPTURE(name);
    const auto rows = strd_table(name, known["first_data_line"].get<std::size_t>());
    const auto groups = known["treatments"].get<std::size_t>();
    // Means less the very first value: 13 equal digits in front would cost as many behind.
    const double origin = rows[0][0];
    Moments between;
    double within = 0, size = 0;
    for (std::size_t g = 0; g < groups; ++g) {
      Moments group;
      for (const auto& row : rows)
        if (row.size() > g) group.push(std::vector<double>{row[g] - origin});
      size = static_cast<double>(group.count());
      within += group.variance() / static_cast<double>(groups);
      between.push(std::vector<double>{group.mean()});
    }
    CHECK(off(size * between.variance(), number_in(known["ms_between"])) >= kAnovaDigits.at(name));
    CHECK(off(within, number_in(known["ms_within"])) >= kAnovaDigits.at(name));
    ++tried;
  }
  CHECK(tried == 11);
}
