#include "libchar/replay/detail/plan/tilt_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fusion/tilt_angle.hpp"

namespace libchar::detail {
namespace {

constexpr double kWindow_s = 1;
constexpr std::int64_t kShortest = 16;      ///< samples
constexpr double kFewest = 30;              ///< changes
constexpr double kMoves = 0.02;             ///< rad from window to window: less is no rotation to judge by
constexpr double kSure = 0.7, kNone = 0.3;  ///< correlations
constexpr double kScale = 1.3;              ///< ratio of the sizes

}  // namespace

TiltCheck::TiltCheck(const fusion::TiltChannels& channels, double rate_hz)
    : channels_(channels),
      step_s_(1 / rate_hz),
      length_(std::max(kShortest, clamped_whole<std::int64_t>(std::round(kWindow_s * rate_hz)))) {}

void TiltCheck::push(const Eigen::MatrixXd& samples) {
  for (Eigen::Index k = 0; k < samples.cols(); ++k) {
    const fusion::Sample y(samples.data() + k * samples.outerStride(), samples.rows());
    const fusion::TiltSample sample = fusion::tilt_sample(channels_, y);
    if (std::isfinite(sample.rate) && std::isfinite(sample.angle)) {
      integrated_ += sample.rate * step_s_;
      now_.integral += integrated_;
      now_.x += y[channels_.accelerometer_x];
      now_.z += y[channels_.accelerometer_z];
    } else {
      now_.whole = false;
    }
    now_.count += 1;
    if (static_cast<std::int64_t>(now_.count) == length_) close();
  }
}

void TiltCheck::close() {
  const double g = now_.integral / now_.count, a = std::atan2(now_.x, now_.z);
  const double rate = (integrated_ - now_.from) / (now_.count * step_s_);
  if (now_.whole && has_last_) {
    const double dg = g - last_g_, da = fusion::wrapped(a - last_a_);
    if (std::abs(da) < std::numbers::pi / 2) {
      n_ += 1;
      g_ += dg;
      a_ += da;
      gg_ += dg * dg;
      ga_ += dg * da;
      aa_ += da * da;
      const double change = rate - last_rate_, e = dg - da;
      rr_ += change * change;
      re_ += change * e;
      ee_ += e * e;
    }
  }
  has_last_ = now_.whole;
  last_g_ = g;
  last_a_ = a;
  last_rate_ = rate;
  now_ = {};
  now_.from = integrated_;
}

// 0: none that is resolved.
double TiltCheck::delay_s() const {
  constexpr double kSignificant = 6, kSamples = 2;
  if (!(rr_ > 0)) return 0;
  const double delay = re_ / rr_, left = std::max(0.0, ee_ - delay * re_);
  const bool resolved = std::abs(delay) > kSignificant * std::sqrt(left / (n_ * rr_)) &&
                        std::abs(delay) > kSamples * step_s_ && left < ee_ / 2;
  return resolved ? delay : 0;
}

void TiltCheck::tell(Findings& warnings) const {
  if (n_ < kFewest) return;
  const double gg = std::max(0.0, gg_ / n_ - g_ / n_ * (g_ / n_)), aa = std::max(0.0, aa_ / n_ - a_ / n_ * (a_ / n_)),
               ga = ga_ / n_ - g_ / n_ * (a_ / n_);
  const double rate = std::sqrt(gg), angle = std::sqrt(aa);
  if (!(angle > kMoves)) return;
  const double r = rate > 0 ? ga / (rate * angle) : 0, ratio = rate / angle;
  const auto say = [&](const std::string& sentence, Severity severity) {
    warnings.add("tilt_contradicts", sentence).severity = severity;
  };
  if (r < -kSure)
    say("the gyroscope turns the other way than gravity does: the sign of the gyroscope or of an accelerometer is "
        "wrong, or the two accelerometer axes are exchanged",
        Severity::bad);
  else if (r > kSure && (ratio > kScale || ratio < 1 / kScale))
    say(fmt::format("the gyroscope reads {} times the rate at which gravity turns: its unit or scale is wrong",
                    brief_text(ratio, 3)),
        Severity::bad);
  else if (const double delay = delay_s(); r > kSure && delay != 0)
    say(fmt::format("the {} {} late: what is fused is of two times", delay > 0 ? "accelerometers are" : "gyroscope is",
                    duration_text(std::abs(delay))),
        Severity::caution);
  else if (std::abs(r) < kNone)
    say("the gyroscope does not turn as gravity does: it is another axis, or it does not work", Severity::caution);
}

}  // namespace libchar::detail
