#pragma once
// A characterization made from formulas and a seed instead of a recording: what a report has to be able to show.

#include <random>
#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"

namespace test {

using namespace libchar;

struct Truth {
  double q = 5e-3, b = 1e-3, k = 1e-4;  ///< 0 = absent, and then reported as not detected
  double rate_hz = 200;
  std::uint64_t samples = 200000;
};

Interval chi_square_band(double value, double dof, double confidence, double power);

double scattered(double value, double dof, std::mt19937_64& random);

AllanCurve synthetic_allan(const Truth& t, std::mt19937_64& random);

double density(const Truth& t, double f);

Spectrum synthetic_spectrum(const Truth& t, std::mt19937_64& random);

Coefficient synthetic_coefficient(double truth, double relative_sd, double limit, std::mt19937_64& random);

NoiseFit synthetic_fit(const Truth& t, std::mt19937_64& random);

ChannelResult synthetic_channel(const std::string& name, const std::string& unit, const Truth& t, std::uint64_t seed);

/// A log of three gyroscope and three accelerometer axes; the last gyroscope axis shows no random
/// walk, the last accelerometer axis is troubled.
Characterization synthetic_imu();

/// Names that try to become part of the page.
const std::vector<std::string>& hostile_names();

Characterization hostile();

/// As many channels as a large log has.
Characterization many_channels(std::size_t count);

/// Values and ranges whose squares, steps or differences are not numbers any more.
Characterization at_the_ends_of_doubles();

/// What is left when nothing could be computed.
Characterization barely_anything();

}  // namespace test
