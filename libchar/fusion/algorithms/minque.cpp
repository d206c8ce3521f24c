#include "libchar/fusion/algorithms/minque.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/fusion/detail/variances/weighted_mean.hpp"

namespace libchar::fusion {
namespace {

ReweightingOptions reweighting(const Settings& s) {
  return {s["gamma"], s["damping"], s["floor"], s["floor_largest"], s["start_variance"]};
}

FaultWatchOptions watching(const Settings& s) {
  return {s["fault_gamma"], s["fault_threshold"], static_cast<std::int64_t>(s["recovery_samples"])};
}

/// A moment of rounding errors proves no fault.
constexpr double kRounding = 1e4;

/// Relative standard deviation of a variance above which a reader must know.
constexpr double kPoorlyKnownVariance = 0.5;

/// Square of a residual over its variance that makes a sample an outlier, and of all others together, per degree of
/// freedom, which then agree.
constexpr double kOutlier = 64, kAgreeing = 9;
/// Outliers are rare: where they are not, variances or the model are wrong, and learn from them.
constexpr double kMostOutliers = 0.05, kOutlierMemory = 1.0 / 128;

/// A second moment can only be judged by variances that are known clearly better than itself.
bool shorter(double fault_gamma, double gamma) { return 1 - fault_gamma >= 5 * (1 - gamma); }

}  // namespace

Minque::Minque(const Array& array, const Settings& settings)
    : scalar_(static_cast<std::size_t>(array.channels), reweighting(settings)),
      watch_(static_cast<std::size_t>(array.channels), watching(settings)),
      asked_(settings["fault_detection"] == 2),
      detection_(asked_ && shorter(settings["fault_gamma"], settings["gamma"])),
      // The variances must have settled before they can accuse a channel.
      armed_from_(std::max<std::int64_t>(array.fault_free_samples,
                                         clamped_whole<std::int64_t>(std::ceil(1 / (1 - settings["gamma"]))))),
      inputs_(array.inputs()),
      present_(static_cast<std::size_t>(array.channels)),
      m_(static_cast<int>(array.channels)),
      names_(array.names) {
  std::iota(present_.begin(), present_.end(), 0);
  if (settings["fault_detection"] == 1)
    detector_.emplace(
        array, FaultDetectorOptions{settings["false_alarm_s"], static_cast<std::int64_t>(settings["recovery_window"])});
  if (!array.one_common_input()) general_.emplace(array.observation_matrix, reweighting(settings));
}

Estimate Minque::step(const Sample& y) { return general_ ? step_with(*general_, y) : step_with(scalar_, y); }

template <class Variances>
Estimate Minque::step_with(Variances& variances, const Sample& y) {
  if (detector_) detect(variances, y);
  // Where the last instant was complete, this one is taken to be, and looked at when it shows that it is not.
  if (!all_in_use() || !variances.started() || (detector_ && detector_->set_changed())) use_present(y);
  const auto fuse = [&] { return m_ > 0 ? variances.fuse(y.data(), present_.data(), m_) : std::nan(""); };
  // Written so that NaN fails.
  const auto good = [](double x) { return std::abs(x) <= kLargestSample; };
  double x = fuse();
  if (!good(x) && all_in_use()) {
    use_present(y);
    x = fuse();
  }
  Estimate estimate = Estimate::none(inputs_);
  if (good(x)) {
    const bool outlier = left_out_outlier(variances);
    if (outlier) x = fuse();
    const bool judged = detector_ && detector_->set_changed();
    const bool found = judged || (detection_ && found_fault(variances));
    if (found && !judged) {
      use_present(y);
      x = fuse();
    }
    if (good(x)) estimate = variances.estimate();
    if (good(x) && detection_ && watch_.count_out() > 0) check_recovery(variances, y);
    // What a failing channel has done to the residuals of this instant is not to be learnt, unless it goes on.
    const bool learns = !outlier || outliers_ > kMostOutliers;
    if (good(x) && outlier && learns) {
      use_present(y);
      fuse();
    }
    if (good(x) && !found && learns) variances.update();
  }
  ++now_;
  return estimate;
}

/// The detector judges the instant first: the estimate is made of those that it leaves in.
template <class Variances>
void Minque::detect(Variances& variances, const Sample& y) {
  detector_->step(y.data());
  if (!variances.started()) return;
  for (const VarianceChange& change : detector_->changes()) {
    const auto i = static_cast<std::size_t>(change.channel);
    variances.assume(i, variances.variance(i) * change.ratio);
  }
}

bool Minque::all_in_use() const { return m_ == static_cast<int>(present_.size()) && count_out() == 0; }

void Minque::use_present(const Sample& y) {
  m_ = 0;
  for (int i = 0; i < static_cast<int>(y.size()); ++i)
    if (usable(y[i]) && !out(static_cast<std::size_t>(i))) present_[static_cast<std::size_t>(m_++)] = i;
}

/// Of one instant: the sample that is far from all others where these agree. The sums of the detector need more.
template <class Variances>
bool Minque::left_out_outlier(const Variances& variances) {
  if (!detector_ || !variances.started() || m_ < inputs_ + 2) return false;
  const double* const r = variances.residuals();
  const double* const expected = variances.residual_variances();
  const double least = kRounding * variances.rounding();
  const auto far = [&](int i) { return r[i] * r[i] > kOutlier * std::max(expected[i], least); };
  bool outlier = std::any_of(present_.begin(), present_.begin() + m_, far);
  int worst = 0;
  double all = 0, largest = 0;
  for (int k = 0; outlier && k < m_; ++k) {
    const int i = in_use(k);
    const double ratio = r[i] * r[i] / std::max(expected[i], least);
    all += r[i] * r[i] / variances.variance(static_cast<std::size_t>(i));
    if (ratio <= largest) continue;
    largest = ratio;
    worst = k;
  }
  // Without the sample the sum of squares is smaller by its own ratio.
  outlier = outlier && all - largest < kAgreeing * static_cast<double>(m_ - 1 - inputs_);
  outliers_ += kOutlierMemory * ((outlier ? 1 : 0) - outliers_);
  if (!outlier) return false;
  std::copy(present_.begin() + worst + 1, present_.begin() + m_, present_.begin() + worst);
  --m_;
  return true;
}

/// Takes out the worst channel, if one is beyond its threshold.
template <class Variances>
bool Minque::found_fault(const Variances& variances) {
  if (!variances.started() || m_ < inputs_ + 2) return false;
  const double least = kRounding * variances.rounding();
  const double* const expected = variances.residual_variances();
  const int* const all = present_.data();
  if (!watch_.beyond(variances.residuals(), expected, least, all, m_) || now_ < armed_from_) return false;
  const int where = watch_.worst(all, m_);
  for (int k = 0; k < m_; ++k) watch_.forget(static_cast<std::size_t>(in_use(k)));
  watch_.take_out(static_cast<std::size_t>(where), now_);
  return true;
}

template <class Variances>
void Minque::check_recovery(const Variances& variances, const Sample& y) {
  const double least = kRounding * variances.rounding();
  for (std::size_t i = 0; i < variances.size(); ++i) {
    const double sample = y[static_cast<Eigen::Index>(i)];
    if (!watch_.out(i) || !usable(sample)) continue;
    const double expectation = std::max(variances.innovation_variance(i), least);
    if (watch_.calmed(i, variances.innovation(i, sample), expectation)) watch_.let_in(i, now_ + 1);
  }
}

void Minque::remarks(Findings& warnings) const {
  if (detector_) detector_->remarks(names_, warnings);
  if (asked_ && !detection_)
    warnings.add("faults_not_watched",
                 "no faults are looked for: the memory of the variances (gamma) is not five times that of the fault "
                 "rule (fault_gamma)");
  if (general_ || !scalar_.started()) return;
  std::vector<double> direction;
  if (scalar_.blindness(direction) <= kPoorlyKnownVariance) return;
  std::string names;
  for (std::size_t i = 0; i < direction.size(); ++i)
    if (std::abs(direction[i]) > 0.3) names += (names.empty() ? "" : ", ") + channel_name(names_, i);
  warnings.add("variances_not_identifiable",
               "cannot tell the variances of these channels apart (their sum is known, the other channels are "
               "too noisy to divide it): " +
                   names);
}

Eigen::MatrixXd Minque::weights() const { return general_ ? general_->weights() : scalar_.weights(); }

Eigen::VectorXd Minque::variances() const {
  const std::vector<double>& v = general_ ? general_->variances() : scalar_.variances();
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

}  // namespace libchar::fusion
