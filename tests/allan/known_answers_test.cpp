// Deviations of published and exact sets (fixtures/README.md): values and numbers of terms.

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/document/json.hpp"
#include "tests/support/npy.hpp"
#include "tests/support/shared.hpp"
#include "tests/support/table.hpp"

using namespace libchar;

namespace {

const std::vector<double> kNbs9 = {892, 809, 823, 798, 671, 644, 883, 903, 677};

std::vector<double> nist1000() {
  std::vector<double> y;
  std::uint64_t n = 1234567890;
  for (int i = 0; i < 1000; ++i, n = 16807 * n % 2147483647) y.push_back(double(n) / 2147483647);
  return y;
}

AllanOptions asking(DeviationType type, double tau, DataKind data = DataKind::rate) {
  AllanOptions options;
  options.type = type;
  options.data = data;
  options.grid = TauGrid::list;
  options.taus_s = {tau};
  options.tau_max_s = 1e9;
  return options;
}

/// The rate samples summed to phase points, in units of dt = 1.
std::vector<double> phase_of(const std::vector<double>& rate) {
  std::vector<double> x = {0};
  for (const double y : rate) x.push_back(x.back() + y);
  return x;
}

Json read(const std::string& name) { return Json::parse(test::slurp(test::known(name))); }

void check_against(const Json& table, const std::vector<double>& rate, double limit) {
  for (const auto& [m, row] : table.items())
    for (const auto& [name, answer] : row.items()) {
      INFO(name << " m = " << m);
      const auto type = deviation_type(name);
      REQUIRE(type);
      const double truth = std::stod(answer.at(0).get<std::string>());
      const AllanCurve curve = allan_deviation(rate, 1, asking(*type, std::stod(m)));
      REQUIRE(curve.points.size() == 1);
      CHECK(std::fabs(curve.points[0].deviation / truth - 1) <= limit);
      CHECK(curve.points[0].terms == answer.at(1).get<std::uint64_t>());
      const AllanCurve phase = allan_deviation(phase_of(rate), 1, asking(*type, std::stod(m), DataKind::phase));
      CHECK(std::fabs(phase.points[0].deviation / truth - 1) <= 1e-11);  // x itself is rounded
      CHECK(phase.points[0].terms == answer.at(1).get<std::uint64_t>());
    }
}

}  // namespace

TEST_CASE("NBS nine points and NIST 1000 points to 24 digits") {
  check_against(read("allan/nbs9_exact.json")["devs"], kNbs9, 1e-13);
  check_against(read("allan/nist1000_exact.json")["devs"], nist1000(), 1e-13);
}

TEST_CASE("SP 1065 1000-point suite, second computation") {
  const Json sets = read("allan/sp1065_1000pt_devs.json")["dev"];
  const auto rate = nist1000();
  int checked = 0;
  for (const auto& [name, rows] : sets.items()) {
    std::string lower = name;
    for (char& c : lower) c = static_cast<char>(std::tolower(c));
    const auto type = deviation_type(lower);
    if (!type) continue;
    for (const auto& [m, answer] : rows.items()) {
      INFO(name << " m = " << m);
      const AllanCurve curve = allan_deviation(rate, 1, asking(*type, std::stod(m)));
      CHECK(std::fabs(curve.points[0].deviation / std::stod(answer["dev"].get<std::string>()) - 1) <= 1e-13);
      CHECK(curve.points[0].terms == answer["n"].get<std::uint64_t>());
      ++checked;
    }
  }
  CHECK(checked == 70);
}

TEST_CASE("Stable32 tables of PHASE.DAT, every averaging time") {
  NEEDS_SHARED("oracle/allan/phasedat/PHASE.DAT");
  std::vector<double> phase;
  std::istringstream text(test::slurp(test::shared("oracle/allan/phasedat/PHASE.DAT")));
  for (std::string line; std::getline(text, line);)
    if (!line.empty() && line[0] != '#') phase.push_back(std::stod(line));
  REQUIRE(phase.size() == 1001);
  int rows = 0;
  for (const char* name : {"adev", "oadev", "mdev", "tdev", "hdev", "ohdev", "totdev"})
    for (const char* suffix : {"", "_octave"}) {
      const auto path = test::shared(std::string("oracle/allan/phasedat/phase_dat_") + name + suffix + ".txt");
      std::istringstream lines(test::slurp(path));
      for (std::string line; std::getline(lines, line);) {
        std::istringstream cells(line);
        std::uint64_t m = 0, terms = 0;
        double tau = 0, alpha = 0, low = 0, sigma = 0;
        if (!(cells >> m >> tau >> terms >> alpha >> low >> sigma)) continue;
        INFO(path.filename().string() << " m = " << m);
        const AllanCurve curve = allan_deviation(phase, 1, asking(*deviation_type(name), double(m), DataKind::phase));
        CHECK(curve.points.at(0).deviation == Approx(sigma).epsilon(1e-4));
        CHECK(curve.points.at(0).terms == terms);
        ++rows;
      }
    }
  CHECK(rows > 1000);
}

TEST_CASE("Stable32 1.62: sigma to its four digits, terms exactly") {
  NEEDS_SHARED("oracle/allan/stable32_1.62/PHASE_a.tau");
  std::vector<double> phase;
  std::istringstream text(test::slurp(test::shared("oracle/allan/phasedat/PHASE.DAT")));
  for (std::string line; std::getline(text, line);)
    if (!line.empty() && line[0] != '#') phase.push_back(std::stod(line));
  const std::vector<std::tuple<const char*, DeviationType, std::vector<double>>> sets = {
      {"PHASE_a.tau", DeviationType::oadev, phase},         {"PHASE_m.tau", DeviationType::mdev, phase},
      {"PHASE_h.tau", DeviationType::ohdev, phase},         {"PHASE_tot.tau", DeviationType::totdev, phase},
      {"TST_SUIT_a.tau", DeviationType::oadev, nist1000()}, {"TST_SUIT_m.tau", DeviationType::mdev, nist1000()}};
  for (const auto& [name, type, data] : sets) {
    std::ifstream in(test::shared(std::string("oracle/allan/stable32_1.62/") + name));
    double tau = 0, sigma = 0, low = 0, high = 0, edf = 0;
    std::uint64_t terms = 0;
    int rows = 0;
    while (in >> tau >> terms >> sigma >> low >> high >> edf) {
      INFO(name << " tau " << tau);
      const AllanCurve curve = allan_deviation(data, 1, asking(type, tau, DataKind::phase));
      CHECK(curve.points.at(0).deviation == Approx(sigma).epsilon(6e-4));
      CHECK(curve.points.at(0).terms == terms);
      ++rows;
    }
    CHECK(rows >= 8);
  }
}

TEST_CASE("clock recordings against Stable32") {
  NEEDS_SHARED("data/clock_cs5071a_vs_hmaser_phase.npy");
  // Stable32 divides the total variance by its expected bias 1 - a tau/T (a = 0.481 flicker, 0.75 walk; SP 1065, 5.11).
  const auto bias = [](const std::vector<std::string>& row, std::size_t n) {
    const double alpha = std::stod(row[4]);
    const double a = row[0] != "totdev" || alpha > -0.5 ? 0 : alpha > -1.5 ? 0.481 : 0.75;
    return std::sqrt(1 - a * std::stod(row[2]) / static_cast<double>(n));
  };
  const auto check_table = [&](const std::string& name, DataKind data, double limit, bool normalise) {
    auto record = test::npy(test::shared("data/" + name + ".npy")).values;
    if (normalise)
      for (double& y : record) y = (y - 1e7) / 1e7;
    int rows = 0;
    double worst = 0;
    for (const auto& row : test::table(test::shared("data/" + name + ".stable32.csv"))) {
      const auto type = deviation_type(row[0]);
      if (!type) continue;
      const AllanCurve curve = allan_deviation(record, 1, asking(*type, std::stod(row[2]), data));
      INFO(name << " " << row[0] << " " << row[1]);
      const double error = std::fabs(curve.points.at(0).deviation / bias(row, record.size()) / std::stod(row[6]) - 1);
      CHECK(error <= limit);
      CHECK(curve.points.at(0).terms == std::stoul(row[3]));
      worst = std::max(worst, error);
      ++rows;
    }
    INFO(name << ": worst relative difference " << worst);
    CHECK(rows >= 90);
  };
  check_table("clock_cs5071a_vs_hmaser_phase", DataKind::phase, 1e-4, false);
  check_table("clock_ocxo10mhz_freq", DataKind::rate, 2e-3, true);
}

TEST_CASE("all 108 published values of the ADIS16405 run") {
  NEEDS_SHARED("data/static_adis16405_run1.npy");
  const test::Array array = test::npy(test::shared("data/static_adis16405_run1.npy"));
  REQUIRE(array.columns == 6);
  std::map<std::string, std::size_t> channel;
  double worst = 0;
  int rows = 0;
  AllanCurve curve;
  for (const auto& row : test::table(test::shared("data/static_adis16405_run1.published_oadev.csv"))) {
    if (row[0] == "channel") continue;
    if (!channel.contains(row[0])) {
      channel[row[0]] = channel.size() - (channel.contains(row[0]) ? 1 : 0);
      curve = allan_deviation(array.column(channel.size() - 1), 0.01);
    }
    const double tau = std::stod(row[1]);
    const auto point = std::find_if(curve.points.begin(), curve.points.end(),
                                    [&](const AllanPoint& p) { return std::fabs(p.tau_s / tau - 1) < 1e-6; });
    REQUIRE(point != curve.points.end());
    worst = std::max(worst, std::fabs(point->deviation / std::stod(row[3]) - 1));
    ++rows;
  }
  CHECK(rows == 108);
  CHECK(worst <= 1e-5);
}

TEST_CASE("50-digit Allan vectors to double precision") {
  std::vector<double> y;
  for (const auto& row : test::table(test::known("fusion/adev_input.csv")))
    if (row[0] != "k") y.push_back(std::stod(row[1]));
  for (const auto& row : test::table(test::known("fusion/adev.csv"))) {
    if (row[0] == "m") continue;
    const double m = std::stod(row[0]);
    const AllanPoint plain = allan_deviation(y, 1, asking(DeviationType::adev, m)).points.at(0);
    const AllanPoint overlapping = allan_deviation(y, 1, asking(DeviationType::oadev, m)).points.at(0);
    CHECK(plain.deviation == Approx(std::stod(row[1])).epsilon(4e-15));
    CHECK(plain.terms == std::stoul(row[2]));
    CHECK(overlapping.deviation == Approx(std::stod(row[3])).epsilon(4e-15));
    CHECK(overlapping.terms == std::stoul(row[4]));
  }
}
