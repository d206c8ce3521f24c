// Writes a CSV log of seven columns (time, three gyroscope and three accelerometer axes) for the speed benchmark:
//   make_log_bench FILE [ROWS = 10000000]        (10^7 rows are about 0.95 GB)
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <numbers>
#include <random>

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: make_log_bench FILE [ROWS]\n");
    return 2;
  }
  const std::uint64_t rows = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 10'000'000;
  std::FILE* out = std::fopen(argv[1], "wb");
  if (out == nullptr) return 5;
  std::mt19937_64 bits(20261121);
  const auto uniform = [&] { return (static_cast<double>(bits() >> 11U) + 0.5) * 0x1p-53; };
  const auto normal = [&] { return std::sqrt(-2 * std::log(uniform())) * std::cos(2 * std::numbers::pi * uniform()); };
  double walk[6] = {};
  fmt::memory_buffer line;
  line.append(std::string_view(
      "t[s],gyro_x[rad/s],gyro_y[rad/s],gyro_z[rad/s],accel_x[m/s^2],accel_y[m/s^2],accel_z[m/s^2]\n"));
  for (std::uint64_t row = 0; row < rows; ++row) {
    fmt::format_to(std::back_inserter(line), "{:.3f}", static_cast<double>(row) * 0.005);
    for (int c = 0; c < 6; ++c) {
      walk[c] += 7e-6 * normal();
      const double offset = c == 5 ? 9.80665 : 0.01 * (c + 1);
      fmt::format_to(std::back_inserter(line), ",{:.10g}", offset + walk[c] + (c < 3 ? 0.07 : 0.05) * normal());
    }
    line.push_back('\n');
    if (line.size() > (1U << 20U)) {
      std::fwrite(line.data(), 1, line.size(), out);
      line.clear();
    }
  }
  std::fwrite(line.data(), 1, line.size(), out);
  return std::fclose(out) == 0 ? 0 : 5;
}
