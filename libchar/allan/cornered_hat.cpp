// J. E. Gray, D. W. Allan, "A method for estimating the frequency stability of an individual oscillator", 28th Ann.
// Symp. Frequency Control (1974); for n devices: C. R. Ekstrom, P. A. Koppang, "Error bars for three-cornered hats",
// IEEE Trans. UFFC 53 (2006) 876. The variances of pairwise differences of independent devices are sums,
// s_ij = v_i + v_j; least squares over all pairs gives
//
//   v_i = ( S_i - T/(n-1) ) / (n-2),     S_i = sum_{j != i} s_ij,   T = sum_{i<j} s_ij
//
// (n = 3: (s_12 + s_13 - s_23)/2). v_i may be negative; it is said, and never clipped. With nu degrees of freedom each,
// Cov(s_ij, s_kl) = 2 c^2/nu, c the covariance of the two differences: v_i + v_j for one pair, v_i
// for two that share device i.
//
// J. Groslambert, D. Fest, M. Olivier, J. J. Gagnepain, "Characterization of frequency fluctuations
// by crosscorrelations and by using three or more oscillators", 35th Ann. Freq. Control Symp.
// (1981); Vernotte, Calosso, Rubiola, IFCS 2016: from three logs of differences
// x = a - b, y = b - c, z = c - a with measurement noises of their own, d the second differences,
//   v_a = - <d_x d_z> / (2 tau^2)
// as their noises have no covariance. Without such noise x + y + z = 0, and it is the
// three-cornered hat. The variance of a mean product of nu degrees of freedom is
//   ( v_x v_z + v_a^2 ) / nu,    v_x = <d_x^2> / (2 tau^2): the noise of the measurements is in these,
// nu that of the power law that the difference follows at tau (noise_type.hpp): a counter's white
// phase has many more than a device's white frequency.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/detail/equivalent_dof.hpp"
#include "libchar/allan/noise_type.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostDevices = 64;
constexpr double kResolved = 2;  // standard deviations

void check_records(std::span<const std::vector<double>> records) {
  if (records.size() < 3)
    throw usage_error("E0870")
        .says("a cornered hat needs three devices or more; there are {}", records.size())
        .hint("choose three channels with `channels`");
  if (records.size() > kMostDevices)
    throw usage_error("E0870")
        .says("a cornered hat takes {} devices at most", kMostDevices)
        .hint("choose some with `channels`");
  for (const auto& record : records)
    if (record.size() != records[0].size())
      throw usage_error("E0870").says("the records of a cornered hat must have one length");
}

std::vector<double> difference_of(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = a[i] - b[i];
  return out;
}

/// Symmetric, one value for each two devices.
class PairTable {
 public:
  explicit PairTable(std::size_t n) : n_(n), value_(n * n) {}
  double& at(std::size_t i, std::size_t j) { return value_[std::min(i, j) * n_ + std::max(i, j)]; }
  double at(std::size_t i, std::size_t j) const { return value_[std::min(i, j) * n_ + std::max(i, j)]; }

 private:
  std::size_t n_;
  std::vector<double> value_;
};

std::vector<double> least_squares(const PairTable& s, std::size_t n) {
  std::vector<double> sums(n);
  double total = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      if (j != i) sums[i] += s.at(i, j);
  for (const double sum : sums) total += sum / 2;
  const auto devices = static_cast<double>(n);
  for (double& sum : sums) sum = (sum - total / (devices - 1)) / (devices - 2);
  return sums;
}

/// Of v_i, the weights of s in it being a for its own pairs and -b for all others; a sum over pairs of pairs.
double hat_variance_sd(const std::vector<double>& v, std::size_t i, double dof) {
  const std::size_t n = v.size();
  const auto devices = static_cast<double>(n);
  const double of_others = -1 / ((devices - 1) * (devices - 2));
  const double own = 1 / (devices - 2) + of_others;
  const auto weight = [&](std::size_t j, std::size_t k) { return j == i || k == i ? own : of_others; };
  const auto noise = [&](std::size_t j) { return std::max(0.0, v[j]); };
  double sum = 0;
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t k = j + 1; k < n; ++k) {
      const double same = noise(j) + noise(k);
      sum += weight(j, k) * weight(j, k) * same * same;
    }
  // Pairs of pairs that share device j.
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t l = 0; l < n; ++l)
        if (k != j && l != j && k != l) sum += weight(j, k) * weight(j, l) * noise(j) * noise(j);
  return std::sqrt(std::max(0.0, 2 * sum / dof));
}

HatPoint hat_point(const AllanPoint& like, double variance, double sd) {
  HatPoint point;
  point.m = like.m;
  point.tau_s = like.tau_s;
  point.terms = like.terms;
  point.variance = variance;
  point.variance_sd = sd;
  point.deviation = variance < 0 ? std::nan("") : std::sqrt(variance);
  point.status = variance < 0                ? HatStatus::negative
                 : variance < kResolved * sd ? HatStatus::not_resolved
                                             : HatStatus::resolved;
  return point;
}

double dof_of(DeviationType type, const AllanPoint& point, double dt_s, Term noise = Term::white) {
  const DeviationRow& row = deviation_row(type);
  const bool exact = row.family == DeviationFamily::differences;
  const std::uint64_t stride = exact && !row.overlapping ? point.m : 1;
  Mixture theta{};
  theta[static_cast<std::size_t>(noise)] = 1;
  return equivalent_dof(exact ? type : DeviationType::oadev, theta, point.m, std::max<std::uint64_t>(1, point.terms),
                        stride, dt_s);
}

void note_negative(CorneredHat& hat) {
  std::size_t negative = 0, all = 0;
  for (const auto& points : hat.devices)
    for (const HatPoint& point : points) {
      ++all;
      negative += point.status == HatStatus::negative ? 1 : 0;
    }
  if (negative > 0)
    hat.notes.push_back(
        fmt::format("{} of {} variances are negative: there the noise of the other devices hides the device, or the "
                    "devices are not independent",
                    negative, all));
}

}  // namespace

CorneredHat cornered_hat(std::span<const std::vector<double>> records, double dt_s, const AllanOptions& options) {
  check_records(records);
  if (options.type == DeviationType::mtie || options.type == DeviationType::theobr ||
      options.type == DeviationType::theoh)
    throw usage_error("E0870")
        .says("{} of a difference is not the sum over two devices", name_of(options.type))
        .hint("oadev, mdev, ohdev and all other mean squares serve");
  const std::size_t n = records.size();
  std::vector<std::vector<AllanCurve>> curves(n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      curves[i].push_back(allan_deviation(difference_of(records[i], records[j]), dt_s, options));
  CorneredHat hat;
  hat.type = options.type;
  hat.devices.resize(n);
  hat.notes = curves[0][0].notes;
  for (const AllanPoint& like : curves[0][0].points) {
    PairTable s(n);
    bool everywhere = true;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 1; j < n; ++j) {
        const auto& points = curves[i][j - i - 1].points;
        const auto at = std::lower_bound(points.begin(), points.end(), like.m,
                                         [](const AllanPoint& p, std::uint64_t m) { return p.m < m; });
        everywhere = everywhere && at != points.end() && at->m == like.m;
        if (everywhere) s.at(i, j) = at->deviation * at->deviation;
      }
    if (!everywhere) continue;
    const std::vector<double> v = least_squares(s, n);
    const double dof = dof_of(options.type, like, dt_s);
    for (std::size_t i = 0; i < n; ++i) hat.devices[i].push_back(hat_point(like, v[i], hat_variance_sd(v, i, dof)));
  }
  note_negative(hat);
  return hat;
}

namespace {

/// Mean product of second differences of two phases at m, over 2 tau^2; terms that touch a gap of either are left out.
struct MeanProduct {
  double value = 0;
  std::uint64_t terms = 0;
};

std::vector<double> phase_of_log(const std::vector<double>& record, DataKind kind, double dt_s) {
  std::vector<double> x;
  double first = std::nan(""), sum = 0;
  for (const double v : record)
    if (std::isnan(first) && std::isfinite(v)) first = v;
  if (kind == DataKind::phase) {
    for (const double v : record) x.push_back(v - first);
    return x;
  }
  x.push_back(0);
  for (const double v : record) x.push_back(sum += (v - first) * dt_s);
  return x;
}

MeanProduct mean_product(const std::vector<double>& a, const std::vector<double>& b, std::size_t m, double tau_s) {
  MeanProduct out;
  for (std::size_t i = 0; i + 2 * m < a.size(); ++i) {
    const double product =
        ((a[i + 2 * m] - a[i + m]) - (a[i + m] - a[i])) * ((b[i + 2 * m] - b[i + m]) - (b[i + m] - b[i]));
    if (!std::isfinite(product)) continue;
    out.value += product;
    ++out.terms;
  }
  if (out.terms > 0) out.value /= 2 * tau_s * tau_s * static_cast<double>(out.terms);
  return out;
}

/// The term whose degrees of freedom a difference has at an averaging factor: by its noise type there, or the last
/// one that its readings were enough for.
Term noise_at(const std::vector<NoiseType>& types, std::uint64_t m) {
  int alpha = 0;
  for (const NoiseType& type : types)
    if (type.m <= m) alpha = type.alpha;
  return alpha > 0 ? Term::quantization : alpha == 0 ? Term::white : alpha < -1 ? Term::walk : Term::flicker;
}

}  // namespace

CorneredHat cornered_hat_of_differences(std::span<const std::vector<double>> differences, double dt_s,
                                        const AllanOptions& options) {
  check_records(differences);
  if (differences.size() != 3 || options.type != DeviationType::oadev)
    throw usage_error("E0870").says(
        "differences of devices are taken three at a time, a - b, b - c and c - a, for the overlapping Allan "
        "deviation");
  std::vector<std::vector<double>> x;
  for (const auto& record : differences) x.push_back(phase_of_log(record, options.data, dt_s));
  for (const auto& phase : x)  // a sum has no value behind a gap
    if (options.data == DataKind::rate && std::isnan(phase.back()))
      throw usage_error("E0870").says("differences of rates are taken without missing samples");
  CorneredHat hat;
  hat.devices.resize(3);
  std::array<std::vector<NoiseType>, 3> types;
  for (std::size_t i = 0; i < 3; ++i) types[i] = lag1_noise_types(x[i], dt_s);
  for (const AllanPoint& like : allan_deviation(differences[0], dt_s, options).points) {
    const auto product = [&](std::size_t i, std::size_t j) {
      return mean_product(x[i], x[j], detail::in_memory(like.m), like.tau_s);
    };
    std::array<double, 3> own{}, dof{};
    for (std::size_t i = 0; i < 3; ++i) {
      const MeanProduct square = product(i, i);
      AllanPoint point = like;
      point.terms = square.terms;
      own[i] = square.value;
      dof[i] = dof_of(DeviationType::oadev, point, dt_s, noise_at(types[i], like.m));
    }
    for (std::size_t i = 0; i < 3; ++i) {  // in the differences i and i - 1, with either sign
      const std::size_t j = (i + 2) % 3;
      const MeanProduct both = product(i, j);
      AllanPoint point = like;
      point.terms = both.terms;
      const double fewer = std::min(dof[i], dof[j]),
                   of_device = std::min(fewer, dof_of(DeviationType::oadev, point, dt_s));
      const double sd = std::sqrt(own[i] * own[j] / fewer + both.value * both.value / of_device);
      hat.devices[i].push_back(hat_point(point, -both.value, sd));
    }
  }
  note_negative(hat);
  return hat;
}

}  // namespace libchar
