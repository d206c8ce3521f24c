#include "libchar/replay/detail/plan/tilt_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
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
constexpr double kScaleByReference = 0.05;  ///< that of the rate, beyond one

}  // namespace

TiltCheck::TiltCheck(const fusion::TiltChannels& channels, double rate_hz)
    : channels_(channels),
      step_s_(1 / rate_hz),
      length_(std::max(kShortest, clamped_whole<std::int64_t>(std::round(kWindow_s * rate_hz)))) {}

void TiltCheck::push(const Eigen::MatrixXd& samples, const Eigen::MatrixXd& truth) {
  for (Eigen::Index k = 0; k < samples.cols(); ++k) {
    const fusion::Sample y(samples.data() + k * samples.outerStride(), samples.rows());
    const fusion::TiltSample sample = fusion::tilt_sample(channels_, y);
    const double reference = truth.rows() > 0 ? truth(0, k) : std::numeric_limits<double>::quiet_NaN();
    if (std::isfinite(reference)) turned_ = fusion::unwrapped_near(reference, turned_);
    now_.reference += std::isfinite(reference) ? turned_ : reference;
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
  const double g = now_.integral / now_.count, a = std::atan2(now_.x, now_.z), r = now_.reference / now_.count;
  const double rate = (integrated_ - now_.from) / (now_.count * step_s_);
  if (now_.whole && has_last_) {
    const double dg = g - last_.g, da = fusion::wrapped(a - last_.a), dr = r - last_.r;
    if (std::abs(da) < std::numbers::pi / 2) {
      gravity_.push(dg, da);
      const double change = rate - last_.rate, e = dg - da;
      rr_ += change * change;
      re_ += change * e;
      ee_ += e * e;
    }
    if (std::isfinite(dr)) {
      rate_by_reference_.push(dg, dr);
      if (std::abs(da) < std::numbers::pi / 2) gravity_by_reference_.push(da, dr);
    }
  }
  has_last_ = now_.whole;
  last_ = {g, a, r, rate};
  now_ = {};
  now_.from = integrated_;
}

void TiltCheck::Pair::push(double da, double db) {
  n += 1;
  a += da;
  b += db;
  aa += da * da;
  ab += da * db;
  bb += db * db;
}

bool TiltCheck::Pair::moves() const { return n >= kFewest && std::sqrt(bb / n - b / n * (b / n)) > kMoves; }

double TiltCheck::Pair::correlation() const {
  const double both = std::sqrt((aa - a * a / n) * (bb - b * b / n));
  return both > 0 ? (ab - a * b / n) / both : 0;
}

double TiltCheck::Pair::ratio() const { return std::sqrt(std::max(0.0, aa - a * a / n) / (bb - b * b / n)); }

bool TiltCheck::Pair::opposite() const { return n >= kFewest && correlation() < -kSure; }

bool TiltCheck::Pair::other_size() const {
  return n >= kFewest && std::abs(correlation()) > kSure && (ratio() > kScale || ratio() < 1 / kScale);
}

// 0: none that is resolved.
double TiltCheck::delay_s() const {
  constexpr double kSignificant = 6, kSamples = 2;
  if (!(rr_ > 0)) return 0;
  const double delay = re_ / rr_, left = std::max(0.0, ee_ - delay * re_);
  const bool resolved = std::abs(delay) > kSignificant * std::sqrt(left / (gravity_.n * rr_)) &&
                        std::abs(delay) > kSamples * step_s_ && left < ee_ / 2;
  return resolved ? delay : 0;
}

// Which of the two it is.
std::string TiltCheck::by_reference() const {
  const auto wrong = [](const Pair& pair) { return pair.opposite() || pair.other_size(); };
  const auto right = [&](const Pair& pair) { return pair.correlation() > kSure && !wrong(pair); };
  if (wrong(rate_by_reference_) && right(gravity_by_reference_)) return "; by the reference it is the gyroscope";
  if (wrong(gravity_by_reference_) && right(rate_by_reference_)) return "; by the reference it is the accelerometers";
  return "";
}

// Gyroscope and gravity agree.
void TiltCheck::tell_reference(Findings& warnings) const {
  const Pair &rate = rate_by_reference_, &gravity = gravity_by_reference_;
  const auto say = [&](const std::string& sentence, Severity severity) {
    warnings.add("tilt_contradicts", sentence).severity = severity;
  };
  if (rate.n < kFewest) return;
  const double r = rate.correlation(), ratio = rate.ratio();
  if (rate.opposite() && gravity.opposite())
    say("the reference turns the other way than gyroscope and gravity do: its sign is wrong, or that of both",
        Severity::bad);
  else if (rate.other_size() && gravity.other_size())
    say(fmt::format("the reference turns {} times as far as gyroscope and gravity do: its unit or scale is wrong",
                    brief_text(1 / ratio, 3)),
        Severity::bad);
  else if (r > kSure && (ratio * r > 1 + kScaleByReference || ratio < r * (1 - kScaleByReference)))
    say(fmt::format("the gyroscope reads {} times the rate at which the reference turns: its scale is wrong",
                    brief_text(ratio, 3)),
        Severity::caution);
  else if (std::abs(r) < kNone && std::abs(gravity.correlation()) < kNone)
    say("the reference does not turn as gyroscope and gravity do: it is another angle, or of another time",
        Severity::caution);
}

void TiltCheck::tell(Findings& warnings) const {
  if (!gravity_.moves()) return;
  const double r = gravity_.correlation(), ratio = gravity_.ratio();
  const auto say = [&](const std::string& sentence, Severity severity) {
    warnings.add("tilt_contradicts", sentence + by_reference()).severity = severity;
  };
  if (gravity_.opposite())
    say("the gyroscope turns the other way than gravity does: the sign of the gyroscope or of an accelerometer is "
        "wrong, or the two accelerometer axes are exchanged",
        Severity::bad);
  else if (r > kSure && gravity_.other_size())
    say(fmt::format("the gyroscope reads {} times the rate at which gravity turns: its unit or scale is wrong",
                    brief_text(ratio, 3)),
        Severity::bad);
  else if (const double delay = delay_s(); r > kSure && delay != 0)
    say(fmt::format("the {} {} late: what is fused is of two times", delay > 0 ? "accelerometers are" : "gyroscope is",
                    duration_text(std::abs(delay))),
        Severity::caution);
  else if (std::abs(r) < kNone)
    say("the gyroscope does not turn as gravity does: it is another axis, or it does not work", Severity::caution);
  else
    tell_reference(warnings);
}

}  // namespace libchar::detail
