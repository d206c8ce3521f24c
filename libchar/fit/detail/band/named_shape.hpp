#pragma once
// Shapes of a spectrum that a filter or a control loop with a low corner gives it, by their corners.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/record/power_bins.hpp"

namespace libchar {

/// |H|² = (1 + s/s_z) (1 - s)^c / D,  s = sin²(pi f / rate), with c for zeros at half the rate and
/// what another filter does far above:
///   shelf:        D = 1 + s/s_p                           (one pole, one zero)
///   second_order: D = (1 - s/s_p)² + 4 zeta² s/s_p, no zero
///   third_order:  D = the same times 1 + s/s_r, no zero
///   loop:         the same with the zero                  (alpha-beta trackers, closed loops)
/// and high_pass:    |H|² = (s/s_p) / (1 + s/s_p)            (AC coupling, complementary outputs)
///     echo:         |H|² = (1 + g² + 2 g cos(2 pi f k / rate)) / (1 + g)², once more after k samples (combs, two taps)
struct NamedShape {
  enum class Family { none, shelf, second_order, third_order, loop, high_pass, echo };
  Family family = Family::none;
  double pole_hz = 0, zero_hz = 0;  ///< corners; above half the rate where the slope begins there
  double damping = 1;
  double tilt = 0;          ///< c
  double real_pole_hz = 0;  ///< of the third order
  double echo = 0;          ///< g
  int lag = 0;              ///< k; both corners are then where the gain is furthest from that at 0
  bool operator==(const NamedShape&) const = default;
};

/// Of g where its first extremum is at rate / (2 k).
NamedShape echo_shape(double echo, int lag, double rate_hz);
/// Mean of cos(2 pi f k / rate) over a bin.
double mean_cosine(const PowerBin& bin, int lag, double rate_hz);

/// Unknowns of a family: ln s_p, then ln zeta, then ln s_z or ln s_r, then c; of an echo artanh g.
std::size_t unknowns_of(NamedShape::Family family);
/// ln |H|², a mean over the bin.
double named_log_gain(const NamedShape& shape, const PowerBin& bin, double rate_hz);
/// Its derivatives by the unknowns.
std::array<double, 4> named_log_slopes(const NamedShape& shape, const PowerBin& bin, double rate_hz);

/// The likeliest shape of a family with all `terms` free; from the best of a grid where there is no
/// start (one of second order starts one of third), none where even that has a half deviance above `hopeless`.
std::optional<NamedShape> fit_named_shape(const std::vector<PowerBin>& inside, double rate_hz, const TermSet& terms,
                                          NamedShape::Family family, const std::optional<NamedShape>& start = {},
                                          double hopeless = 1e300);

/// Corners of high-passes to start from, an octave apart.
std::vector<NamedShape> high_pass_starts(double rate_hz, double duration_s);

/// "a second-order low-pass at 1.02 Hz, damping 0.71".
std::string named_shape_text(const NamedShape& shape);

}  // namespace libchar
