#include "libchar/replay/detail/run_medians.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/median.hpp"

namespace libchar {
namespace {

constexpr std::int64_t kNotes = 128;
/// Of the sum of weights: medians that share less of it are not those of one set of weights.
constexpr double kLeastSum = 0.1;

void add(std::vector<std::vector<double>>& series, const Eigen::VectorXd& values) {
  series.resize(static_cast<std::size_t>(values.size()));
  for (Eigen::Index i = 0; i < values.size(); ++i) series[static_cast<std::size_t>(i)].push_back(values(i));
}

void take_medians(std::vector<std::vector<double>> notes, std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::erase_if(notes[i], [](double v) { return !std::isfinite(v); });
    if (!notes[i].empty()) values[i] = median_in_place(notes[i]);
  }
}

double sum_of(const std::vector<double>& values) {
  double out = 0;
  for (const double value : values) out += value;
  return out;
}

}  // namespace

void RunMedians::set_length(std::int64_t instants) { every_ = std::max<std::int64_t>(1, instants / kNotes); }

void RunMedians::note(const std::optional<Eigen::MatrixXd>& weights, const std::optional<Eigen::VectorXd>& variances) {
  // Where nothing was fused the weights have no sum, and mean nothing.
  const bool fused = weights && weights->cols() == 1 && weights->allFinite() && weights->array().abs().sum() > 0;
  if (fused) add(weights_, weights->col(0));
  if (variances) add(variances_, *variances);
}

void RunMedians::take(std::vector<double>& weights, std::vector<double>& variances) const {
  if (variances_.size() == variances.size()) take_medians(variances_, variances);
  if (weights_.empty() || weights_.size() != weights.size()) return;
  std::vector<double> sums(weights_[0].size());
  for (std::size_t k = 0; k < sums.size(); ++k)
    for (const std::vector<double>& of_sensor : weights_) sums[k] += of_sensor[k];
  take_medians(weights_, weights);
  const double sum = sum_of(weights), wanted = median_in_place(sums, Middle::lower);
  if (sum == wanted || !(std::abs(sum) > kLeastSum * std::abs(wanted))) return;
  for (double& weight : weights) weight *= wanted / sum;
}

}  // namespace libchar
