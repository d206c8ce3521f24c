#include "libchar/fusion/detail/fault/fault_baseline.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/lanes.hpp"
#include "libchar/core/numeric/median.hpp"

#if defined(LIBCHAR_X86_64)
#include <emmintrin.h>
#endif

namespace libchar::fusion {
namespace {

/// Beyond it a residual is not learnt from, and its square proves nothing more.
constexpr double kClip = 6;
constexpr double kMostRecent = 1e6;
/// P(|z| > FaultBaseline::kTail) of Gaussian noise; beyond four times as much the tails are heavy.
constexpr double kGaussTail = 6.33e-5, kHeavy = 4;
constexpr double kUntoldClip = 4, kFewestForTail = 1500, kChance = 1.5;
/// Long-run variance ratio that nothing is known of, and blocks that it is worth.
constexpr double kUntoldRatio = 16, kUntoldBlocks = 8;
/// An excess below this is scatter.
constexpr double kLeastExcess = 1.35;
/// Deviation of a gain and of a delay in samples before anything is known of them.
constexpr double kPriorGain = 0.05, kPriorDelay = 1;
/// Blocks that the long-run variances remember.
constexpr double kBlockMemory = 64;

// Four sensors at once: what stands of a kind in the group at q.
#define LIBCHAR_GROUP(kind) LIBCHAR_FOUR(q + 4 * FaultBaseline::kind)
#define LIBCHAR_GROUP_TO(kind) LIBCHAR_FOUR_TO(q + 4 * FaultBaseline::kind)
/// v between -end and end. (A function would not be of the lanes.)
#define LIBCHAR_CUT(v, end) ((v) < -(end) ? -(end) : (v) > (end) ? (end) : (v))

/// f, here and y to x, dx, y less its slow mean, and the means of f.
LIBCHAR_LANES void predict_all_lanes(double* q, double* y, std::size_t padded) {
  const double a = 1 / FaultBaseline::kMeanMemory;
  for (std::size_t i = 0; i < padded; i += 4, q += FaultBaseline::kStride) {
    const Four here = LIBCHAR_GROUP(kHere), f = LIBCHAR_GROUP(kF);
    const Four mean_f = LIBCHAR_GROUP(kMeanF), square_x = LIBCHAR_GROUP(kSquareX);
    const Four square_dx = LIBCHAR_GROUP(kSquareDx);
    const Four centred = here * (f - mean_f);
    const Four step = here * LIBCHAR_GROUP(kHadF) * (f - LIBCHAR_GROUP(kLastF));
    LIBCHAR_GROUP_TO(kX) = centred;
    LIBCHAR_GROUP_TO(kDx) = step;
    LIBCHAR_FOUR_TO(y + i) =
        LIBCHAR_FOUR(y + i) - (LIBCHAR_GROUP(kBias) + LIBCHAR_GROUP(kGain) * centred + LIBCHAR_GROUP(kDelay) * step);
    LIBCHAR_GROUP_TO(kMeanF) = mean_f + a * centred;
    LIBCHAR_GROUP_TO(kSquareX) = square_x + here * a * (centred * centred - square_x);
    LIBCHAR_GROUP_TO(kSquareDx) = square_dx + here * a * (step * step - square_dx);
    LIBCHAR_GROUP_TO(kLastF) = f;
    LIBCHAR_GROUP_TO(kHadF) = here;
  }
}
constexpr InLanes<predict_all_lanes> predict_all;

/// The square roots of four numbers that are not negative. (The compiler keeps a way to errno open
/// and takes them one by one.)
inline void take_roots(double* four) {
#if defined(LIBCHAR_X86_64)
  _mm_storeu_pd(four, _mm_sqrt_pd(_mm_loadu_pd(four)));
  _mm_storeu_pd(four + 2, _mm_sqrt_pd(_mm_loadu_pd(four + 2)));
#else
  for (int i = 0; i < 4; ++i) four[i] = std::sqrt(four[i]);
#endif
}

/// Where the bank reads.
struct Evidence {
  double *z, *present, *uz, *uu, *zz;
};

/// e and s to z, the sums of the block, and the evidence of the bank.
LIBCHAR_LANES void standardise_all_lanes(double* q, const Evidence& out, std::size_t padded, double inverse_excess) {
  const double a = 1 / FaultBaseline::kRecent, b = 1 / FaultBaseline::kLevelMemory;
  const double root = std::sqrt(inverse_excess);
  constexpr double kMost = FaultBaseline::kMostDeviations;
  const Four least = {-kMost, -kMost, -kMost, -kMost};
  const Four most = -least;
  const Four tail = {FaultBaseline::kTail, FaultBaseline::kTail, FaultBaseline::kTail, FaultBaseline::kTail};
  const Four most_recent = {kMostRecent, kMostRecent, kMostRecent, kMostRecent};
  for (std::size_t i = 0; i < padded; i += 4, q += FaultBaseline::kStride) {
    const Four x = LIBCHAR_GROUP(kX), dx = LIBCHAR_GROUP(kDx), here = LIBCHAR_GROUP(kHere);
    const Four variance = LIBCHAR_GROUP(kS) * LIBCHAR_GROUP(kStartMargin) * LIBCHAR_GROUP(kMotion) +
                          LIBCHAR_GROUP(kBiasVar) + LIBCHAR_GROUP(kGainVar) * (x * x) +
                          LIBCHAR_GROUP(kDelayVar) * (dx * dx);
    double* const one_over = q + 4 * FaultBaseline::kRoot;
    LIBCHAR_FOUR_TO(one_over) = 1 / variance;
    take_roots(one_over);
    const Four standard = here * LIBCHAR_GROUP(kE) * LIBCHAR_FOUR(one_over);
    const Four low = standard < least ? least : standard;
    const Four z = low > most ? most : low;
    LIBCHAR_GROUP_TO(kZ) = z;
    const Four end = LIBCHAR_GROUP(kClip);
    const Four level = LIBCHAR_GROUP(kLevel), scale = LIBCHAR_GROUP(kScaleBias);
    const Four risen = z - (1 - scale * scale) * level;
    const Four moved = risen * (LIBCHAR_GROUP(kScaleGain) * root);
    const Four shifted = z * (scale * root);
    const Four c = LIBCHAR_CUT(z, end), shift = LIBCHAR_CUT(shifted, end);
    const Four now = here * LIBCHAR_GROUP(kArmed), u = x * LIBCHAR_GROUP(kUnitX) * now;
    LIBCHAR_FOUR_TO(out.z + i) = now * shift;
    LIBCHAR_FOUR_TO(out.present + i) = now;
    LIBCHAR_FOUR_TO(out.uz + i) = u * LIBCHAR_CUT(moved, end);
    LIBCHAR_GROUP_TO(kLevel) = level + here * b * (c - level);
    LIBCHAR_FOUR_TO(out.uu + i) = u * u;
    LIBCHAR_FOUR_TO(out.zz + i) = now * ((c * c * inverse_excess - 1) * LIBCHAR_GROUP(kScaleNoise) + 1);
    LIBCHAR_GROUP_TO(kSumZ) = LIBCHAR_GROUP(kSumZ) + z;
    LIBCHAR_GROUP_TO(kSumXz) = LIBCHAR_GROUP(kSumXz) + x * risen;
    LIBCHAR_GROUP_TO(kSumXx) = LIBCHAR_GROUP(kSumXx) + x * x;
    LIBCHAR_GROUP_TO(kSumZz) = LIBCHAR_GROUP(kSumZz) + z * z;
    LIBCHAR_GROUP_TO(kSumN) = LIBCHAR_GROUP(kSumN) + here;
    LIBCHAR_GROUP_TO(kSumTail) = LIBCHAR_GROUP(kSumTail) + (z * z > tail * tail ? here : here * 0);
    LIBCHAR_GROUP_TO(kCount) = LIBCHAR_GROUP(kCount) + here;
    const Four square = z * z < most_recent ? z * z : most_recent, recent = LIBCHAR_GROUP(kRecentSquare);
    LIBCHAR_GROUP_TO(kRecentSquare) = recent + here * a * (square - recent);
  }
}
constexpr InLanes<standardise_all_lanes> standardise_all;

/// B <- max(B (1 - k), floor), b <- b + k e: with t = z / sqrt(S), k e = B t.
LIBCHAR_LANES void learn_all_lanes(double* q, const double* tops, double frozen, std::size_t padded) {
  const Four least = {-kClip, -kClip, -kClip, -kClip}, most = -least, none = {0, 0, 0, 0};
  for (std::size_t i = 0; i < padded; i += 4, q += FaultBaseline::kStride) {
    const Four z = LIBCHAR_GROUP(kZ), root = LIBCHAR_GROUP(kRoot), x = LIBCHAR_GROUP(kX);
    const Four bias_var = LIBCHAR_GROUP(kBiasVar), gain_var = LIBCHAR_GROUP(kGainVar);
    const Four delay_var = LIBCHAR_GROUP(kDelayVar);
    const Four learns = LIBCHAR_FOUR(tops + i) <= frozen ? LIBCHAR_GROUP(kHere) : none;
    const Four low = z < least ? least : z;
    const Four t = (low > most ? most : low) * root;
    const Four over = root * root;
    const Four kb = learns * bias_var;
    const Four kg = learns * x * gain_var;
    const Four kd = learns * LIBCHAR_GROUP(kDx) * delay_var;
    LIBCHAR_GROUP_TO(kBias) = LIBCHAR_GROUP(kBias) + kb * t;
    LIBCHAR_GROUP_TO(kGain) = LIBCHAR_GROUP(kGain) + kg * t;
    LIBCHAR_GROUP_TO(kDelay) = LIBCHAR_GROUP(kDelay) + kd * t;
    const Four b = bias_var - kb * kb * over, b_floor = LIBCHAR_GROUP(kBiasFloor);
    const Four g = gain_var - kg * kg * over, g_floor = LIBCHAR_GROUP(kGainFloor);
    const Four d = delay_var - kd * kd * over, d_floor = LIBCHAR_GROUP(kDelayFloor);
    LIBCHAR_GROUP_TO(kBiasVar) = b > b_floor ? b : b_floor;
    LIBCHAR_GROUP_TO(kGainVar) = g > g_floor ? g : g_floor;
    LIBCHAR_GROUP_TO(kDelayVar) = d > d_floor ? d : d_floor;
  }
}
constexpr InLanes<learn_all_lanes> learn_all;

#undef LIBCHAR_GROUP
#undef LIBCHAR_GROUP_TO
#undef LIBCHAR_CUT

// A sum with the slope t is worth e^S of false alarms while E exp(t z - t^2/2) <= 1. A share p of samples beyond c adds
// p exp(t c - t^2/2) to it, of the steepest row at most kTailPart. Short of tails that are heavier than Gauss's,
// nothing is cut: the steepest row answers a gross fault at once.
double clip_of(double tails, double of, double most) {
  constexpr double kSteepest = 2.8, kTailPart = 0.2, kLeast = 2.5;
  if (of < kFewestForTail) return kUntoldClip;
  if (tails <= kChance + kHeavy * kGaussTail * of) return most;
  return std::max(kLeast, (kSteepest * kSteepest / 2 + std::log(kTailPart * of / tails)) / kSteepest);
}

double believed(double ratio, double blocks, bool trusted) {
  // What the scatter of so few blocks alone would show is not believed.
  const double scatter = 1 + 3.5 * std::sqrt(2 / std::max(blocks, 1.0));
  if ((trusted || blocks >= 16) && ratio <= scatter) return 1;
  return std::max(ratio, 1.0) * (trusted || blocks >= 16 ? 1 + std::sqrt(2 / std::max(blocks, 1.0)) : scatter);
}

}  // namespace

FaultBaseline::FaultBaseline(std::size_t sensors)
    : n(sensors),
      padded(CusumBank::padded(sensors)),
      block(padded / 4 * kStride, 0.0),
      here(column(kHere)),
      armed(column(kArmed)),
      f(column(kF)),
      mean_f(column(kMeanF)),
      last_f(column(kLastF)),
      had_f(column(kHadF)),
      x(column(kX)),
      square_x(column(kSquareX)),
      square_dx(column(kSquareDx)),
      bias(column(kBias)),
      gain(column(kGain)),
      delay(column(kDelay)),
      bias_var(column(kBiasVar)),
      gain_var(column(kGainVar)),
      delay_var(column(kDelayVar)),
      bias_floor(column(kBiasFloor)),
      gain_floor(column(kGainFloor)),
      delay_floor(column(kDelayFloor)),
      e(column(kE)),
      s(column(kS)),
      z(column(kZ)),
      count(column(kCount)),
      unit_x(column(kUnitX)),
      start_margin(column(kStartMargin)),
      scale_bias(column(kScaleBias)),
      scale_gain(column(kScaleGain)),
      scale_noise(column(kScaleNoise)),
      sum_z(column(kSumZ)),
      sum_xz(column(kSumXz)),
      sum_xx(column(kSumXx)),
      sum_zz(column(kSumZz)),
      sum_n(column(kSumN)),
      sum_tail(column(kSumTail)),
      clip(column(kClip)),
      recent(column(kRecentSquare)),
      y(padded, 0.0),
      long_run(padded) {
  for (SensorColumn* one : {&bias_var, &s, &start_margin, &recent, &scale_bias, &scale_gain, &scale_noise})
    one->fill(1);
  column(kMotion).fill(1);
  clip.fill(kUntoldClip);
  gain_var.fill(kPriorGain * kPriorGain);
  delay_var.fill(kPriorDelay * kPriorDelay);
}

SensorColumn FaultBaseline::column(Kind kind) { return {block.data() + 4 * kind, kStride, padded}; }

void FaultBaseline::predict() { predict_all(block.data(), y.data(), padded); }

void FaultBaseline::standardise(CusumSample& sample) {
  standardise_all(block.data(),
                  {sample.z.data(), sample.present.data(), sample.uz.data(), sample.uu.data(), sample.zz.data()},
                  padded, 1 / excess);
}

void FaultBaseline::find_motion() {
  if (!long_run.motion.any()) return;
  SensorColumn motion = column(kMotion);
  for (std::size_t i = 0; i < n; ++i) motion[i] = long_run.motion.at(i, x[i]);
}

void FaultBaseline::learn_motion(const std::vector<double>& tops, double frozen) {
  for (std::size_t i = 0; i < n; ++i)
    if (here[i] != 0 && tops[i] <= frozen) long_run.motion.add(i, x[i], z[i] * std::sqrt(motion(i)));
}

void FaultBaseline::renew_motion(double samples) {
  long_run.motion.renew(samples);
  if (!long_run.motion.any()) column(kMotion).fill(1);
}

void FaultBaseline::learn(const std::vector<double>& tops, double frozen) {
  learn_all(block.data(), tops.data(), frozen, padded);
}

void FaultBaseline::find_excess(const int* index, int m, std::vector<double>& scratch) {
  scratch.clear();
  for (int k = 0; k < m; ++k) scratch.push_back(recent[static_cast<std::size_t>(index[k])]);
  // The lower of the two in the middle: half of the sensors may be wrong.
  const double median = median_in_place(scratch, Middle::lower);
  excess = median > kLeastExcess ? median : 1;
}

void FaultBaseline::renew(double count_memory, std::vector<double>& scratch) {
  scratch.clear();
  for (std::size_t i = 0; i < n; ++i)
    if (here[i] != 0) scratch.push_back(s[i]);
  const double usual = scratch.empty() ? 0 : median_in_place(scratch, Middle::lower);
  for (std::size_t i = 0; i < n; ++i) {
    const double memory = std::clamp(count[i], 100.0, kMemory);
    const auto least = [&](double square, double prior) { return 1 / (memory * square / s[i] + 1 / (prior * prior)); };
    bias_floor[i] = s[i] / memory;
    gain_floor[i] = least(square_x[i], kPriorGain);
    delay_floor[i] = least(square_dx[i], kPriorDelay);
    // Where the input rests there is nothing that a gain could show: x is noise, in which the residual has a part.
    // (Of a sensor that is taken for the best by far s says little: the middle of all does.) Outliers are in both.
    const double rest = std::max(usual, clip[i] < kMostDeviations ? 16 * s[i] : 0);
    unit_x[i] = square_x[i] < rest ? 0 : 1 / std::sqrt(std::max(square_x[i], 16 * s[i]));
    start_margin[i] = 1 + 2 * std::sqrt(2 / std::clamp(count[i], 8.0, count_memory));
  }
}

void FaultBaseline::end_block(bool trusted, const std::vector<double>& tops, double frozen) {
  for (std::size_t i = 0; i < n; ++i) {
    const double m = sum_n[i];
    if (m < kLeastOfBlock || tops[i] > frozen) continue;
    const double off = sum_zz[i] - m;
    long_run.blocks[i] += 1;
    const double a = std::max(1 / kBlockMemory, 1 / (long_run.blocks[i] + 1));
    const auto follow = [&](double& ratio, double now) { ratio += a * (std::min(now, 1e4) - ratio); };
    follow(long_run.bias[i], sum_z[i] * sum_z[i] / m);
    follow(long_run.gain[i], sum_xx[i] > 0 ? sum_xz[i] * sum_xz[i] / sum_xx[i] : 1);
    follow(long_run.noise[i], off * off / (2 * m));
    const double b = std::min(long_run.blocks[i], kBlockMemory);
    const double bias_ratio = believed(long_run.bias[i], b, trusted);
    scale_bias[i] = 1 / std::sqrt(bias_ratio);
    scale_gain[i] = 1 / std::sqrt(believed(long_run.gain[i], b, trusted));
    // What so few samples cannot tell is taken for heavy.
    const double kept = std::min(1.0, kBlockMemory * kBlock / (long_run.tails_of[i] + m));
    long_run.tails[i] = kept * (long_run.tails[i] + sum_tail[i]);
    long_run.tails_of[i] = kept * (long_run.tails_of[i] + m);
    clip[i] = clip_of(long_run.tails[i], long_run.tails_of[i], long_run.most_clip);
    // A mean that wanders is no noise either.
    scale_noise[i] = 1 / std::max(std::sqrt(believed(long_run.noise[i], b, trusted)), bias_ratio);
  }
  clear_block();
}

void FaultBaseline::expect_outliers() {
  long_run.most_clip = kUntoldClip;
  for (std::size_t i = 0; i < n; ++i) clip[i] = std::min(clip[i], long_run.most_clip);
}

void FaultBaseline::clear_block() {
  for (SensorColumn* v : {&sum_z, &sum_xz, &sum_xx, &sum_zz, &sum_n, &sum_tail}) v->fill(0);
}

void FaultBaseline::forget_blocks(bool trusted) {
  const double ratio = trusted ? 1 : kUntoldRatio;
  for (std::vector<double>* v : {&long_run.bias, &long_run.gain, &long_run.noise})
    std::fill(v->begin(), v->end(), ratio);
  for (SensorColumn* v : {&scale_bias, &scale_gain}) v->fill(1 / std::sqrt(ratio));
  scale_noise.fill(1 / ratio);
  std::fill(long_run.blocks.begin(), long_run.blocks.end(), trusted ? 0.0 : kUntoldBlocks);
  clear_block();
}

}  // namespace libchar::fusion
