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

namespace {

std::string table_of(const test::TemporaryFolder& folder, const std::string& text) {
  const std::string path = (folder / "table.csv").string();
  std::ofstream(path) << text;
  return path;
}

// One-sided density of white noise with N = 0.01 U·√s: 2e-4 U²/Hz; a row at 0 Hz, and those below it if two-sided.
std::string spectrum_table(const std::string& header, double value, bool two_sided = false) {
  std::string rows = header + "\n";
  for (int k = two_sided ? -199 : 0; k < 200; ++k) rows += fmt::format("{},{}\n", 0.05 * k, k == 0 ? 1e-9 : value);
  return rows;
}

}  // namespace

TEST_CASE("fit_curve_table: the program's own spectra are read as they are, without their value at 0 Hz") {
  const test::TemporaryFolder folder;
  CurveTableOptions options;
  options.is_allan = false;
  const auto fitted = [&](const std::string& text) { return fit_curve_table(table_of(folder, text), options); };
  const double density = 2e-4, root = std::sqrt(density);
  for (const std::string& text :
       {spectrum_table("frequency_hz,gyro_z[(deg/s)²/Hz]", density),
        spectrum_table("frequency_hz,gyro_z[(deg/s)/√Hz]", root),
        spectrum_table("frequency_hz,gyro_z[(deg/s)²/Hz]", density / 2, true),
        spectrum_table("frequency_hz,gyro_z[(deg/s)/√Hz]", root / std::sqrt(2), true),
        spectrum_table("f (Hz),gyro_z (deg²/s²/Hz)", density), spectrum_table("f,psd[(deg/s)^2/Hz]", density),
        spectrum_table("f,PSD [deg/s/√Hz]", root)}) {
    CAPTURE(text.substr(0, 40));
    const CurveTableFit read = fitted(text);
    REQUIRE(read.channels.size() == 1);
    CHECK(read.channels[0].channel.unit == "deg/s");
    CHECK(white_of(read.channels[0]) == Approx(0.01));
    REQUIRE(read.table.warnings.find("zero_frequency"));
    CHECK(read.table.warnings.find("zero_frequency")->count == 1);
  }
  CHECK(fitted(spectrum_table("frequency_hz,a[U²/Hz]", density)).channels[0].channel.unit.empty());
  CHECK(fitted(spectrum_table("frequency_hz,a", density)).channels[0].channel.unit.empty());
  CHECK_FALSE(fitted("f,a[g²/Hz]\n1,2\n2,2\n3,2\n4,2\n5,2\n6,2\n7,2\n8,2\n").table.warnings.find("zero_frequency"));
}

TEST_CASE("fit_curve_table: a power spectrum is no density, unless somebody says so") {
  const test::TemporaryFolder folder;
  CurveTableOptions options;
  options.is_allan = false;
  for (const char* header : {"frequency_hz,a[(m/s²)²]", "frequency_hz,a[m/s²]", "frequency_hz,a[V]"}) {
    options.root.reset();
    const std::string path = table_of(folder, spectrum_table(header, 2e-4));
    CHECK_THROWS_WITH(fit_curve_table(path, options), Catch::Contains("E0803") && Catch::Contains("`scaling` psd"));
    options.root = false;
    CHECK(white_of(fit_curve_table(path, options).channels[0]) == Approx(0.01));
  }
  options.root.reset();
  const std::string head = "curve,channel,unit,x,value\n";
  CHECK_THROWS_WITH(fit_curve_table(table_of(folder, head + "ps_one_sided,a,V²,1,2\n"), options),
                    Catch::Contains("E0803"));
}

TEST_CASE("fit_curve_table: sides and kind of curve are those that a table states") {
  const test::TemporaryFolder folder;
  std::string two = "curve,channel,unit,x,value\n", hadamard = "channel,unit,tau_s,deviation,curve\n";
  for (int k = 1; k < 200; ++k) two += fmt::format("psd_two_sided,a,V²/Hz,{},1e-4\n", 0.05 * k);
  for (double tau = 0.01; tau < 200; tau *= 1.5)
    hadamard += fmt::format("a,V,{},{},hdev\n", tau, 0.01 / std::sqrt(tau));
  CurveTableOptions options;
  CHECK_THROWS_WITH(fit_curve_table(table_of(folder, hadamard), options),
                    Catch::Contains("E0802") && Catch::Contains("but hdev"));
  options.is_allan = false;
  CHECK(white_of(fit_curve_table(table_of(folder, two), options).channels[0]) == Approx(0.01));
}

TEST_CASE("fit_curve_table: averaging times and frequencies in the unit behind their name") {
  const test::TemporaryFolder folder;
  std::string wide = "tau[ms],a[V]\n", named = "tau (min),adev (V)\n";
  for (double tau = 0.01; tau < 200; tau *= 1.5) {
    wide += fmt::format("{},{}\n", 1e3 * tau, 0.01 / std::sqrt(tau));
    named += fmt::format("{},{}\n", tau / 60, 0.01 / std::sqrt(tau));
  }
  for (const std::string& text : {wide, named}) {
    const CurveTableFit fitted = fit_curve_table(table_of(folder, text));
    CHECK(white_of(fitted.channels.at(0)) == Approx(0.01));
    CHECK(fitted.channels[0].channel.unit == "V");
  }
}
