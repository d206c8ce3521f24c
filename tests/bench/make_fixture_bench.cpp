// Writes fixtures/imu_at_rest.csv: a simulated gyroscope and accelerometer at rest with known
// coefficients (fixtures/README.md).
//   make_fixture_bench > fixtures/imu_at_rest.csv
#include <fmt/format.h>

#include <cstdio>

#include "tests/support/noise.hpp"

int main() {
  constexpr std::size_t samples = 50'000;  // 1000 s
  constexpr double rate_hz = 50;
  test::NoiseSource source(samples, rate_hz, 1);
  const auto gyro = source.record(4e-3, 4e-3, 1.5e-3);
  const auto accel = source.record(1e-4, 0, 0);
  fmt::print(
      "# Simulated at rest: gyro_z Q 0.004 deg/s*sqrt(s), B 0.004 deg/s, K 0.0015 deg/s/sqrt(s); accel_z Q 1e-4 "
      "g*sqrt(s)\n");
  fmt::print("t[s],gyro_z[deg/s],accel_z[g]\n");
  for (std::size_t i = 0; i < samples; ++i)
    fmt::print("{:.2f},{:.6f},{:.7f}\n", static_cast<double>(i) / rate_hz, 0.12 + gyro[i], 1.0013 + accel[i]);
}
