#pragma once
// Records that break what is careless with numbers.

#include <cstdint>
#include <string>
#include <vector>

namespace libchar {

struct StressRecord {
  std::string name;
  std::vector<double> y;
  /// (y - shift) 2^-power without rounding: the same record in comfortable numbers
  double shift = 0;
  int power = 0;
  bool drifts = false;
  /// as it was before samples went missing; empty: none is missing
  std::vector<double> whole;
};

inline constexpr double kStressRate = 100;  ///< of all of them, Hz

std::vector<StressRecord> stress_records(std::uint64_t seed);

/// White noise and a random walk of deviation one each over ten thousand samples, multiples of 2^-20.
std::vector<double> plain_record(std::uint64_t seed, std::size_t samples);

/// (y - shift) 2^-power.
std::vector<double> comfortable(const StressRecord& record);

}  // namespace libchar
