#include "libchar/characterize/curves/curve_table_fit.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "libchar/core/error.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

// White noise of 0.01 U/√Hz (two-sided density) alone: deviation N / √tau.
std::string white_curves(const test::TemporaryFolder& folder, const std::string& header) {
  const std::string path = (folder / "curve.csv").string();
  std::ofstream out(path);
  out << header;
  for (double tau = 0.01; tau < 200; tau *= 1.5)
    out << fmt::format("{},{},{}\n", tau, 0.01 / std::sqrt(tau), 0.02 / std::sqrt(tau));
  return path;
}

double white_of(const ChannelFit& channel) { return channel.fit[Term::white].value.value(); }

}  // namespace

TEST_CASE("fit_curve_table: every column behind the first is a curve, named or not") {
  const test::TemporaryFolder folder;
  for (const char* header : {"tau[s],a[V],b[V]\n", ""}) {
    const CurveTableFit fitted = fit_curve_table(white_curves(folder, header));
    REQUIRE(fitted.channels.size() == 2);
    CHECK(white_of(fitted.channels[1]) == Approx(2 * white_of(fitted.channels[0])));
  }
}

TEST_CASE("fit_curve_table: powers and roots of one curve give one coefficient") {
  const test::TemporaryFolder folder;
  CurveTableOptions options;
  const double root = white_of(fit_curve_table(white_curves(folder, "tau[s],a[V],b[V]\n"), options).channels[0]);
  const std::string powers = (folder / "powers.csv").string();
  std::ofstream out(powers);
  out << "tau[s],a[V]\n";
  for (double tau = 0.01; tau < 200; tau *= 1.5) out << fmt::format("{},{}\n", tau, 1e-4 / tau);
  out.close();
  options.root = false;
  CHECK(white_of(fit_curve_table(powers, options).channels[0]) == Approx(root));
}

TEST_CASE("fit_curve_table: curves by name and by pattern, a slip is told") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "named.csv").string();
  std::ofstream out(path);
  out << "channel,unit,tau_s,deviation\n";
  for (const char* name : {"gyro_x", "gyro_y", "accel_x"})
    for (double tau = 0.01; tau < 200; tau *= 1.5) out << fmt::format("{},V,{},{}\n", name, tau, 0.01 / std::sqrt(tau));
  out.close();
  const auto names = [&](std::vector<std::string> wanted) {
    CurveTableOptions options;
    options.reading.channels = std::move(wanted);
    std::string all;
    for (const ChannelFit& one : fit_curve_table(path, options).channels) all += one.channel.name + " ";
    return all;
  };
  CHECK(names({"gyro*"}) == "gyro_x gyro_y ");
  CHECK(names({"*_x"}) == "gyro_x accel_x ");
  CHECK(names({"accel_x", "gyro_y"}) == "gyro_y accel_x ");
  CHECK_THROWS_WITH(names({"gyro*", "acel_x"}), Catch::Contains("E0320") && Catch::Contains("did you mean accel_x"));
  CHECK_THROWS_WITH(names({"mag*"}), Catch::Contains("it has gyro_x, gyro_y, accel_x"));
}

TEST_CASE("fit_curve_table: a table of one column is no curve") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "one.csv").string();
  std::ofstream(path) << "1\n2\n3\n";
  CHECK_THROWS_AS(fit_curve_table(path), Error);
}
