#include "libchar/fusion/detail/fault_baseline.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/lanes.hpp"

namespace libchar::fusion {
namespace {

/// Beyond it a residual is not learnt from, and its square proves nothing more.
constexpr double kClip = 6, kMostDeviations = 1e6;
constexpr double kMostRecent = 1e6;
/// Long-run variance ratio that nothing is known of, and blocks that it is worth.
constexpr double kUntoldRatio = 16, kUntoldBlocks = 8;
/// An excess below this is scatter.
constexpr double kLeastExcess = 1.35;
/// Deviation of a gain and of a delay in samples before anything is known of them.
constexpr double kPriorGain = 0.05, kPriorDelay = 1;
/// Blocks that the long-run variances remember.
constexpr double kBlockMemory = 64;

/// Arrays are padded to fours: loops need no rest.
constexpr std::size_t whole_fours(std::size_t n) {
  return n / 4 * 4;
}

struct MeanOf {
  double *x, *dx, *mean_f, *last_f, *had_f, *square_x, *square_dx, *y;
};
struct Coefficients {
  double *bias, *gain, *delay, *bias_var, *gain_var, *delay_var;
  const double *bias_floor, *gain_floor, *delay_floor;
};

LIBCHAR_WIDE_LANES void predict_all(const MeanOf& m,
                                    const Coefficients& c,
                                    const double* f_in,
                                    const double* here_in,
                                    std::size_t padded) {
  const std::size_t n = whole_fours(padded);
  double* __restrict const x = m.x;
  double* __restrict const dx = m.dx;
  double* __restrict const mean_f = m.mean_f;
  double* __restrict const last_f = m.last_f;
  double* __restrict const had_f = m.had_f;
  double* __restrict const square_x = m.square_x;
  double* __restrict const square_dx = m.square_dx;
  double* __restrict const y = m.y;
  const double* __restrict const f = f_in;
  const double* __restrict const here = here_in;
  const double* __restrict const b = c.bias;
  const double* __restrict const g = c.gain;
  const double* __restrict const d = c.delay;
  const double a = 1 / FaultBaseline::kMeanMemory;
  for (std::size_t i = 0; i < n; ++i) {
    const double centred = here[i] * (f[i] - mean_f[i]);
    const double step = here[i] * had_f[i] * (f[i] - last_f[i]);
    x[i] = centred;
    dx[i] = step;
    y[i] -= b[i] + g[i] * centred + d[i] * step;
    mean_f[i] += a * centred;
    square_x[i] += here[i] * a * (centred * centred - square_x[i]);
    square_dx[i] += here[i] * a * (step * step - square_dx[i]);
    last_f[i] = f[i];
    had_f[i] = here[i];
  }
}

struct Standardised {
  double *z, *root, *sum_z, *sum_xz, *sum_xx, *sum_zz, *sum_n, *count, *recent;
  double *out_z, *out_present, *out_uz, *out_uu, *out_zz;
};
struct Expected {
  const double *e, *s, *start_margin, *bias_var, *gain_var, *delay_var, *x, *dx, *here, *armed,
      *unit_x;
  const double *scale_bias, *scale_gain, *scale_noise;
  double inverse_excess;
};

LIBCHAR_WIDE_LANES void standardise_all(const Expected& in,
                                        const Standardised& out,
                                        std::size_t padded) {
  const std::size_t n = whole_fours(padded);
  double* __restrict const z = out.z;
  double* __restrict const root = out.root;
  const double* __restrict const e = in.e;
  const double* __restrict const s = in.s;
  const double* __restrict const start_margin = in.start_margin;
  const double* __restrict const b = in.bias_var;
  const double* __restrict const g = in.gain_var;
  const double* __restrict const d = in.delay_var;
  const double* __restrict const x = in.x;
  const double* __restrict const dx = in.dx;
  const double* __restrict const here = in.here;
  for (std::size_t i = 0; i < n; ++i) {
    const double variance =
        s[i] * start_margin[i] + b[i] + g[i] * (x[i] * x[i]) + d[i] * (dx[i] * dx[i]);
    const double one_over = std::sqrt(1 / variance);
    const double standard = here[i] * e[i] * one_over;
    const double low = standard < -kMostDeviations ? -kMostDeviations : standard;
    root[i] = one_over;
    z[i] = low > kMostDeviations ? kMostDeviations : low;
  }
}

LIBCHAR_WIDE_LANES void evidence_all(const Expected& in,
                                     const Standardised& out,
                                     std::size_t padded) {
  const std::size_t n = whole_fours(padded);
  const double* __restrict const z = out.z;
  const double* __restrict const x = in.x;
  const double* __restrict const here = in.here;
  const double* __restrict const armed = in.armed;
  const double* __restrict const unit_x = in.unit_x;
  const double* __restrict const scale_bias = in.scale_bias;
  const double* __restrict const scale_gain = in.scale_gain;
  const double* __restrict const scale_noise = in.scale_noise;
  double* __restrict const out_z = out.out_z;
  double* __restrict const present = out.out_present;
  double* __restrict const uz = out.out_uz;
  double* __restrict const uu = out.out_uu;
  double* __restrict const zz = out.out_zz;
  const double inverse_excess = in.inverse_excess, root = std::sqrt(inverse_excess);
  for (std::size_t i = 0; i < n; ++i) {
    const double now = here[i] * armed[i], u = x[i] * unit_x[i] * now;
    out_z[i] = now * z[i] * scale_bias[i] * root;
    present[i] = now;
    uz[i] = u * z[i] * scale_gain[i] * root;
    uu[i] = u * u;
    zz[i] = now * ((z[i] * z[i] * inverse_excess - 1) * scale_noise[i] + 1);
  }
}

LIBCHAR_WIDE_LANES void sums_all(const Expected& in, const Standardised& out, std::size_t padded) {
  const std::size_t n = whole_fours(padded);
  const double* __restrict const z = out.z;
  const double* __restrict const x = in.x;
  const double* __restrict const here = in.here;
  double* __restrict const sum_z = out.sum_z;
  double* __restrict const sum_xz = out.sum_xz;
  double* __restrict const sum_xx = out.sum_xx;
  double* __restrict const sum_zz = out.sum_zz;
  double* __restrict const sum_n = out.sum_n;
  double* __restrict const count = out.count;
  double* __restrict const recent = out.recent;
  const double a = 1 / FaultBaseline::kRecent;
  for (std::size_t i = 0; i < n; ++i) {
    sum_z[i] += z[i];
    sum_xz[i] += x[i] * z[i];
    sum_xx[i] += x[i] * x[i];
    sum_zz[i] += z[i] * z[i];
    sum_n[i] += here[i];
    count[i] += here[i];
    const double square = z[i] * z[i] < kMostRecent ? z[i] * z[i] : kMostRecent;
    recent[i] += here[i] * a * (square - recent[i]);
  }
}

/// B <- max(B (1 - k), floor), b <- b + k e: with t = z / sqrt(S), k e = B t.
LIBCHAR_WIDE_LANES void learn_all(const Coefficients& c,
                                  const double* z_in,
                                  const double* root_in,
                                  const double* x_in,
                                  const double* dx_in,
                                  const double* learns_in,
                                  std::size_t padded) {
  const std::size_t n = whole_fours(padded);
  double* __restrict const bias = c.bias;
  double* __restrict const gain = c.gain;
  double* __restrict const delay = c.delay;
  double* __restrict const bias_var = c.bias_var;
  double* __restrict const gain_var = c.gain_var;
  double* __restrict const delay_var = c.delay_var;
  const double* __restrict const bias_floor = c.bias_floor;
  const double* __restrict const gain_floor = c.gain_floor;
  const double* __restrict const delay_floor = c.delay_floor;
  const double* __restrict const z = z_in;
  const double* __restrict const root = root_in;
  const double* __restrict const x = x_in;
  const double* __restrict const dx = dx_in;
  const double* __restrict const learns = learns_in;
  for (std::size_t i = 0; i < n; ++i) {
    const double low = z[i] < -kClip ? -kClip : z[i];
    const double t = (low > kClip ? kClip : low) * root[i];
    const double over = root[i] * root[i];
    const double kb = learns[i] * bias_var[i];
    const double kg = learns[i] * x[i] * gain_var[i];
    const double kd = learns[i] * dx[i] * delay_var[i];
    bias[i] += kb * t;
    gain[i] += kg * t;
    delay[i] += kd * t;
    const double b = bias_var[i] - kb * kb * over;
    const double g = gain_var[i] - kg * kg * over;
    const double d = delay_var[i] - kd * kd * over;
    bias_var[i] = b > bias_floor[i] ? b : bias_floor[i];
    gain_var[i] = g > gain_floor[i] ? g : gain_floor[i];
    delay_var[i] = d > delay_floor[i] ? d : delay_floor[i];
  }
}

double believed(double ratio, double blocks, bool trusted) {
  // What the scatter of so few blocks alone would show is not believed.
  const double scatter = 1 + 3.5 * std::sqrt(2 / std::max(blocks, 1.0));
  if (trusted || blocks >= 16) return ratio <= scatter ? 1 : ratio;
  return std::max(ratio, 1.0);
}

}  // namespace

FaultBaseline::FaultBaseline(std::size_t sensors) : n(sensors), padded(CusumBank::padded(sensors)) {
  for (std::vector<double>* v :
       {&here,       &armed,      &learns,      &f,         &mean_f, &last_f, &had_f,
        &x,          &dx,         &square_x,    &square_dx, &bias,   &gain,   &delay,
        &bias_floor, &gain_floor, &delay_floor, &y,         &e,      &z,      &count,
        &unit_x,     &sum_z,      &sum_xz,      &sum_xx,    &sum_zz, &sum_n,  &blocks})
    v->assign(padded, 0);
  for (std::vector<double>* v : {&bias_var,
                                 &s,
                                 &root,
                                 &start_margin,
                                 &recent,
                                 &long_bias,
                                 &long_gain,
                                 &long_noise,
                                 &scale_bias,
                                 &scale_gain,
                                 &scale_noise})
    v->assign(padded, 1);
  gain_var.assign(padded, kPriorGain * kPriorGain);
  delay_var.assign(padded, kPriorDelay * kPriorDelay);
}

void FaultBaseline::predict() {
  predict_all({x.data(),
               dx.data(),
               mean_f.data(),
               last_f.data(),
               had_f.data(),
               square_x.data(),
               square_dx.data(),
               y.data()},
              {bias.data(),
               gain.data(),
               delay.data(),
               nullptr,
               nullptr,
               nullptr,
               nullptr,
               nullptr,
               nullptr},
              f.data(),
              here.data(),
              padded);
}

void FaultBaseline::standardise(CusumSample& sample) {
  const Expected in{e.data(),
                    s.data(),
                    start_margin.data(),
                    bias_var.data(),
                    gain_var.data(),
                    delay_var.data(),
                    x.data(),
                    dx.data(),
                    here.data(),
                    armed.data(),
                    unit_x.data(),
                    scale_bias.data(),
                    scale_gain.data(),
                    scale_noise.data(),
                    1 / excess};
  const Standardised out{z.data(),
                         root.data(),
                         sum_z.data(),
                         sum_xz.data(),
                         sum_xx.data(),
                         sum_zz.data(),
                         sum_n.data(),
                         count.data(),
                         recent.data(),
                         sample.z.data(),
                         sample.present.data(),
                         sample.uz.data(),
                         sample.uu.data(),
                         sample.zz.data()};
  standardise_all(in, out, padded);
  evidence_all(in, out, padded);
  sums_all(in, out, padded);
}

void FaultBaseline::learn() {
  learn_all({bias.data(),
             gain.data(),
             delay.data(),
             bias_var.data(),
             gain_var.data(),
             delay_var.data(),
             bias_floor.data(),
             gain_floor.data(),
             delay_floor.data()},
            z.data(),
            root.data(),
            x.data(),
            dx.data(),
            learns.data(),
            padded);
}

void FaultBaseline::find_excess(const int* index, int m, std::vector<double>& scratch) {
  scratch.clear();
  for (int k = 0; k < m; ++k) scratch.push_back(recent[static_cast<std::size_t>(index[k])]);
  const auto middle = scratch.begin() + m / 2;
  std::nth_element(scratch.begin(), middle, scratch.end());
  // The lower of the two in the middle: half of the sensors may be wrong.
  const double median = m % 2 == 1 ? *middle : *std::max_element(scratch.begin(), middle);
  excess = median > kLeastExcess ? median : 1;
}

void FaultBaseline::renew(double count_memory) {
  for (std::size_t i = 0; i < n; ++i) {
    const double memory = std::clamp(count[i], 100.0, kMemory);
    const auto least = [&](double square, double prior) {
      return 1 / (memory * square / s[i] + 1 / (prior * prior));
    };
    bias_floor[i] = s[i] / memory;
    gain_floor[i] = least(square_x[i], kPriorGain);
    delay_floor[i] = least(square_dx[i], kPriorDelay);
    // Where the input stands still there is nothing that a gain could show.
    unit_x[i] = 1 / std::sqrt(std::max(square_x[i], 16 * s[i]));
    start_margin[i] = 1 + 2 * std::sqrt(2 / std::clamp(count[i], 8.0, count_memory));
  }
}

void FaultBaseline::end_block(bool trusted, const std::vector<double>& tops, double frozen) {
  for (std::size_t i = 0; i < n; ++i) {
    const double m = sum_n[i];
    if (m < kBlock / 8 || tops[i] > frozen) continue;
    const double off = sum_zz[i] - m;
    blocks[i] += 1;
    const double a = std::max(1 / kBlockMemory, 1 / (blocks[i] + 1));
    const auto follow = [&](double& ratio, double now) {
      ratio += a * (std::min(now, 1e4) - ratio);
    };
    follow(long_bias[i], sum_z[i] * sum_z[i] / m);
    follow(long_gain[i], sum_xx[i] > 0 ? sum_xz[i] * sum_xz[i] / sum_xx[i] : 1);
    follow(long_noise[i], off * off / (2 * m));
    const double b = std::min(blocks[i], kBlockMemory);
    const double bias_ratio = believed(long_bias[i], b, trusted);
    scale_bias[i] = 1 / std::sqrt(bias_ratio);
    scale_gain[i] = 1 / std::sqrt(believed(long_gain[i], b, trusted));
    // A mean that wanders is no noise either.
    scale_noise[i] = 1 / std::max(std::sqrt(believed(long_noise[i], b, trusted)), bias_ratio);
  }
  clear_block();
}

void FaultBaseline::clear_block() {
  for (std::vector<double>* v : {&sum_z, &sum_xz, &sum_xx, &sum_zz, &sum_n})
    std::fill(v->begin(), v->end(), 0.0);
}

void FaultBaseline::forget_blocks(bool trusted) {
  const double ratio = trusted ? 1 : kUntoldRatio;
  for (std::vector<double>* v : {&long_bias, &long_gain, &long_noise})
    std::fill(v->begin(), v->end(), ratio);
  for (std::vector<double>* v : {&scale_bias, &scale_gain})
    std::fill(v->begin(), v->end(), 1 / std::sqrt(ratio));
  std::fill(scale_noise.begin(), scale_noise.end(), 1 / ratio);
  std::fill(blocks.begin(), blocks.end(), trusted ? 0.0 : kUntoldBlocks);
  clear_block();
}

}  // namespace libchar::fusion
