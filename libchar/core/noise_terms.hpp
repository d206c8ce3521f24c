#pragma once
// The five noise terms (docs/theory/allan.md), by index, name and letter; and a mixture of them.

#include <array>
#include <cstddef>
#include <string_view>

namespace libchar {

enum class Term : std::size_t { white = 0, flicker = 1, walk = 2, quantization = 3, ramp = 4 };
inline constexpr std::size_t kTerms = 5;

struct TermName {
  /// in files: "white_noise", "bias_instability", "random_walk", "quantization", "rate_ramp"
  std::string_view key;
  std::string_view letter;  ///< in texts, with the long name; of IEEE 952
};
inline constexpr std::array<TermName, kTerms> kTermNames = {
    {{"white_noise", "N"}, {"bias_instability", "B"}, {"random_walk", "K"}, {"quantization", "Q"}, {"rate_ramp", "R"}}};

/// Squared coefficients theta = (N^2, B^2, K^2, Q^2, R^2), each >= 0; every curve is linear in them.
using Mixture = std::array<double, kTerms>;

/// Some of the terms, by index.
using TermSet = std::array<bool, kTerms>;

}  // namespace libchar
