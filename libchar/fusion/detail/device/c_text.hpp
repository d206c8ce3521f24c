#pragma once
// The steps of fusion algorithms in C99, operation by operation as in the library, so that doubles have the same bits.
// Words in capitals are replaced by numbers.

#include <string_view>

namespace libchar::fusion {

/// averages.cpp: Mean.
inline constexpr std::string_view kMeanInC = R"(
static int estimate(fusion_state *s, const fusion_real *y, fusion_real *x, fusion_real *variance) {
  fusion_real base = 0, sum = 0, a = 0, b = 0, noise = 0;
  int i, present = 0;
  (void)s;
  for (i = 0; i + 1 < N; i += 2) {
    a += y[i] - y[0];
    b += y[i + 1] - y[0];
  }
  if (i < N) a += y[i] - y[0];
  sum = a + b;
  *variance = VARIANCE;
  if (FABS(sum) <= LARGEST) {
    *x = y[0] + sum / N;
    return 1;
  }
  sum = 0;
  for (i = 0; i < N; ++i) {
    if (!usable(y[i])) continue;
    if (present == 0) base = y[i];
    sum += y[i] - base;
    noise += level[i];
    ++present;
  }
  if (present == 0) return 0;
  *x = base + sum / (fusion_real)present;
  *variance = noise / (fusion_real)(present * present);
  return 1;
}
)";

/// weighted_mean.hpp.
inline constexpr std::string_view kWeightedInC = R"(
static int estimate(fusion_state *s, const fusion_real *y, fusion_real *x, fusion_real *variance) {
  fusion_real sum = 0, used = 0, even = 0, a = 0, b = 0;
  int i, first = 0, present = 0;
  (void)s;
  for (i = 0; i + 1 < N; i += 2) {
    a += weight[i] * (y[i] - y[0]);
    b += weight[i + 1] * (y[i + 1] - y[0]);
  }
  if (i < N) a += weight[i] * (y[i] - y[0]);
  sum = a + b;
  *variance = VARIANCE;
  if (FABS(sum) <= LARGEST) {
    *x = y[0] + sum;
    return 1;
  }
  while (first < N && !usable(y[first])) ++first;
  if (first == N) return 0;
  sum = 0;
  for (i = first; i < N; ++i) {
    if (!usable(y[i])) continue;
    sum += weight[i] * (y[i] - y[first]);
    even += y[i] - y[first];
    used += weight[i];
    ++present;
  }
  *x = used > 0 ? y[first] + sum / used : y[first] + even / (fusion_real)present;
  *variance = used > 0 ? VARIANCE / used : -1;
  return 1;
}
)";

/// least_squares.cpp: LearntMean.
inline constexpr std::string_view kLeastSquaresInC = R"(
static int estimate(fusion_state *s, const fusion_real *y, fusion_real *x, fusion_real *variance) {
  fusion_real a = 0, sum = 0, used = 0, even = 0;
  int i, present = 0;
  (void)s;
  for (i = 0; i < N; ++i) a += direct[i] * (y[i] - y[0]);
  *x = a + TOTAL * y[0] + SHIFT;
  *variance = VARIANCE;
  if (FABS(*x) <= LARGEST) return 1;
  for (i = 0; i < N; ++i) {
    fusion_real corrected;
    if (!usable(y[i]) || weight[i] == 0) continue;
    corrected = (y[i] - bias[i]) / gain[i];
    sum += weight[i] * corrected;
    used += weight[i];
    even += corrected;
    ++present;
  }
  if (present == 0) return 0;
  *x = (used > R(0.05) * ALL ? sum * (ALL / used) : even / (fusion_real)present) + CONSTANT;
  *variance = -1;
  return 1;
}
)";

/// perceptron.cpp, tanh_network.hpp.
inline constexpr std::string_view kPerceptronInC = R"(
static int estimate(fusion_state *s, const fusion_real *y, fusion_real *x, fusion_real *variance) {
  fusion_real z[N], out = OUTPUT_BIAS;
  int i, j;
  (void)s;
  for (i = 0; i < N; ++i) {
    if (!usable(y[i])) return 0; /* it needs every sensor */
    z[i] = deviation[i] > 0 ? (y[i] - mean[i]) / deviation[i] : 0;
  }
  for (j = 0; j < HIDDEN; ++j) {
    fusion_real sum = input_bias[j];
    for (i = 0; i < N; ++i) sum += input_weight[j * N + i] * z[i];
    out += output_weight[j] * TANH(sum);
  }
  *x = TARGET_MEAN + TARGET_DEVIATION * out;
  *variance = VARIANCE;
  return 1;
}
)";

/// bias_filter.cpp in its steady state.
inline constexpr std::string_view kVirtualInC = R"(
static int estimate(fusion_state *s, const fusion_real *y, fusion_real *x, fusion_real *variance) {
  fusion_real residual[N], base = 0, sum = 0, used = 0;
  int i, k, first = 1;
  for (i = 0; i < N; ++i) {
    if (!usable(y[i])) continue;
    if (first) base = y[i];
    first = 0;
  }
  for (i = 0; i < N; ++i) residual[i] = usable(y[i]) ? y[i] - base : 0;
  for (k = 0; k < STATES; ++k) residual[channel[k]] -= s->drift[k];
  for (i = 0; i < N; ++i) {
    if (!usable(y[i])) continue;
    sum += weight[i] * residual[i];
    used += weight[i];
  }
  if (first || !(used > R(0.001))) {
    for (k = 0; k < STATES; ++k) s->drift[k] *= pole[k];
    if (s->now < 0xffffffffu) ++s->now;
    return 0;
  }
  if (used < NEARLY_ONE) sum /= used;
  for (i = 0; i < N; ++i)
    if (!usable(y[i])) residual[i] = sum; /* tells nothing about drifts */
  for (k = 0; k < STATES; ++k) {
    fusion_real change = 0;
    for (i = 0; i < N; ++i) change += gain[k * N + i] * residual[i];
    s->drift[k] = (s->drift[k] + change) * pole[k];
  }
  *x = base + sum;
  while (s->epoch + 1 < EPOCHS && s->now >= since[s->epoch + 1]) ++s->epoch;
  *variance = used < NEARLY_ONE ? variance_of[s->epoch] / used : variance_of[s->epoch];
  if (s->now < 0xffffffffu) ++s->now;
  return 1;
}
)";

/// tilt_complementary.cpp.
inline constexpr std::string_view kTiltInC = R"(
static fusion_real wrapped(fusion_real angle) {
  const fusion_real turn = 2 * PI;
  return FABS(angle) <= PI ? angle : angle - turn * ROUND(angle / turn);
}

static int estimate(fusion_state *s, const fusion_real *y, fusion_real *x, fusion_real *variance) {
  const fusion_real ax = y[ACCELEROMETER_X], az = y[ACCELEROMETER_Z], turn = 2 * PI;
  const int heard = usable(ax) && usable(az) && (ax != 0 || az != 0);
  const fusion_real angle = heard ? ATAN2(ax, az) : 0;
  fusion_real predicted, gravity, share = 1 - LAMBDA;
  if (usable(y[GYROSCOPE])) s->rate = y[GYROSCOPE];
  *variance = -1;
  if (!s->known) {
    s->heard = 1;
    if (!heard) return 0;
    s->known = 1;
    *x = s->angle = angle;
    return 1;
  }
  s->steps += 1;
  predicted = s->angle + s->rate * DT;
  if (!heard) {
    *x = s->angle = wrapped(predicted);
    return 1;
  }
  gravity = ROUND((predicted - angle) / turn);
  gravity = gravity == 0 ? angle : angle + gravity * turn;
  s->heard += 1;
  if (s->steps < START && 1 / s->heard > share) share = 1 / s->heard;
  *x = s->angle = wrapped((1 - share) * predicted + share * gravity);
  return 1;
}
)";

/// minque.cpp, reweighted_variances.cpp, fault_watch.hpp.
inline constexpr std::string_view kMinqueStateInC =
    R"(  fusion_real v[N], inverse[N], r[N], p[N], shown[N], gathered[N], moment[N], work[N];
  fusion_real first[16 * N];
  fusion_real fused, x, rounding, gathered_gain, last_gain, gathered_rounding;
  uint32_t index[N], present[N], calm[N];
  uint32_t m, use, instants, gathered_instants, first_instants, started, count_out, not_begun, now;
  unsigned char out[N];
)";

inline constexpr std::string_view kMinqueStartInC = R"(  {
    int i;
    for (i = 0; i < N; ++i) {
      s->v[i] = START;
      s->inverse[i] = 1 / START;
      s->shown[i] = 1;
      s->moment[i] = -1;
      s->present[i] = (uint32_t)i;
      s->index[i] = (uint32_t)N;
    }
    s->use = N;
    s->not_begun = N;
    s->fused = 1;
    s->started = STARTED;
    s->last_gain = LASTING;
  }
)";

inline constexpr std::string_view kMinqueInC = R"(
static void weigh(fusion_state *s) {
  fusion_real sum = 0;
  uint32_t k;
  for (k = 0; k < s->m; ++k) sum += s->inverse[s->index[k]];
  s->fused = 1 / sum;
  for (k = 0; k < s->m; ++k) s->p[s->index[k]] = s->inverse[s->index[k]] * s->fused;
  for (k = 0; k < s->m; ++k) s->shown[s->index[k]] = s->v[s->index[k]] - s->fused;
}

static void renew(fusion_state *s, fusion_real a) {
  const fusion_real lambda = DAMPING * a, g = s->gathered_gain;
  const fusion_real smallest = SMALLEST_SHARE > lambda ? SMALLEST_SHARE : lambda;
  fusion_real b[N], s1 = 0, s2 = 0, pm, scale, um, t, largest = 0, others = 0, lowest;
  fusion_real *e = s->work;
  uint32_t k, heaviest = s->index[0];
  for (k = 0; k < s->m; ++k) {
    const uint32_t i = s->index[k];
    const fusion_real information = 1 - 2 * s->p[i] + lambda;
    b[i] = s->gathered[i] * s->inverse[i] - g * (1 - s->p[i]);
    e[i] = 1 / (information > smallest ? information : smallest);
    if (k > 0 && s->p[i] > s->p[heaviest]) heaviest = i;
  }
  for (k = 0; k < s->m; ++k) {
    const uint32_t i = s->index[k];
    const fusion_real pe = i == heaviest ? 0 : s->p[i] * e[i];
    s1 += pe * b[i];
    s2 += pe * s->p[i];
  }
  pm = s->p[heaviest];
  scale = (1 + s2) / pm;
  um = (b[heaviest] * scale - s1) / (pm + (1 - 2 * pm + lambda) * scale);
  t = (pm * um + s1) / (1 + s2);
  for (k = 0; k < s->m; ++k) {
    const uint32_t i = s->index[k];
    e[i] = 1 + (b[i] - s->p[i] * t) * e[i];
  }
  e[heaviest] = 1 + um;
  for (k = 0; k < s->m; ++k) {
    const uint32_t i = s->index[k];
    s->v[i] *= e[i];
    others += i == heaviest ? 0 : s->inverse[i];
    largest = s->v[i] > largest ? s->v[i] : largest;
  }
  lowest = FLOOR / others;
  if (largest * FLOOR_LARGEST > lowest) lowest = largest * FLOOR_LARGEST;
  if (s->gathered_rounding > lowest) lowest = s->gathered_rounding;
  for (k = 0; k < s->m; ++k) {
    const uint32_t i = s->index[k];
    if (!(s->v[i] > lowest)) s->v[i] = lowest;
    s->inverse[i] = 1 / s->v[i];
  }
  for (k = 0; k < N; ++k) s->gathered[k] = 0;
  s->gathered_gain = 0;
  s->gathered_instants = 0;
  weigh(s);
}

static fusion_real middle(fusion_state *s, const fusion_real *y) {
  fusion_real *sorted = s->work;
  uint32_t k, j;
  for (k = 0; k < s->m; ++k) {
    const fusion_real value = y[s->index[k]];
    for (j = k; j > 0 && sorted[j - 1] > value; j -= 1) sorted[j] = sorted[j - 1];
    sorted[j] = value;
  }
  return s->m % 2 == 1 ? sorted[s->m / 2] : (sorted[s->m / 2 - 1] + sorted[s->m / 2]) / 2;
}

static fusion_real fuse(fusion_state *s, const fusion_real *y) {
  fusion_real lanes[4] = {0, 0, 0, 0}, base, shift, ulp;
  uint32_t k, lane;
  int same = s->use == s->m;
  for (k = 0; same && k < s->m; ++k) same = s->index[k] == s->present[k];
  if (!same) {
    if (s->gathered_gain > 0) renew(s, s->last_gain);
    s->m = s->use;
    for (k = 0; k < s->m; ++k) s->index[k] = s->present[k];
    for (k = 0; k < N; ++k) s->p[k] = 0;
    weigh(s);
  }
  if (!s->started) {
    s->x = middle(s, y);
    for (k = 0; k < s->m; ++k) s->r[s->index[k]] = y[s->index[k]] - s->x;
  } else {
    base = y[s->index[0]];
    for (k = 0; k + 4 <= s->m; k += 4)
      for (lane = 0; lane < 4; ++lane)
        lanes[lane] += s->p[s->index[k + lane]] * (y[s->index[k + lane]] - base);
    for (lane = 0; k < s->m; ++k, ++lane) lanes[lane] += s->p[s->index[k]] * (y[s->index[k]] - base);
    shift = (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
    for (k = 0; k < s->m; ++k) s->r[s->index[k]] = (y[s->index[k]] - base) - shift;
    s->x = base + shift;
  }
  ulp = EPSILON * s->x;
  s->rounding = ulp * ulp > TINY ? ulp * ulp : TINY;
  return s->x;
}

static void start_from_pairs(fusion_state *s) {
  fusion_real largest = 0, lowest;
  int i, j, k;
  for (i = 0; i < N; ++i) s->v[i] = -1;
  for (i = 1; i < N; ++i)
    for (j = 0; j < i; ++j) {
      fusion_real sum = 0, half;
      int count = 0;
      for (k = 0; k < 16; ++k) {
        const fusion_real d = s->first[k * N + i] - s->first[k * N + j];
        if (!(FABS(d) <= 2 * LARGEST)) continue;
        sum += d * d;
        ++count;
      }
      if (count == 0) continue;
      half = sum / (2 * (fusion_real)count);
      if (s->v[i] < 0 || half < s->v[i]) s->v[i] = half;
      if (s->v[j] < 0 || half < s->v[j]) s->v[j] = half;
    }
  for (i = 0; i < N; ++i) largest = s->v[i] > largest ? s->v[i] : largest;
  lowest = largest * LEAST_RATIO > s->rounding ? largest * LEAST_RATIO : s->rounding;
  for (i = 0; i < N; ++i) {
    if (s->v[i] < 0) s->v[i] = largest;
    if (!(s->v[i] > lowest)) s->v[i] = lowest;
    s->inverse[i] = 1 / s->v[i];
  }
  s->instants = 16;
  s->started = 1;
  weigh(s);
}

static void update(fusion_state *s, const fusion_real *y) {
  fusion_real a = LASTING, squares = 0;
  uint32_t k;
  if (s->m < 3) return; /* two sensors tell the sum of their variances only */
  if (!s->started) {
    fusion_real *row = s->first + s->first_instants * N;
    for (k = 0; k < s->m; ++k) squares += s->r[s->index[k]] * s->r[s->index[k]];
    if (!(squares > 0)) return;
    for (k = 0; k < N; ++k) row[k] = -3 * LARGEST;
    for (k = 0; k < s->m; ++k) row[s->index[k]] = y[s->index[k]];
    if (++s->first_instants == 16) start_from_pairs(s);
    return;
  }
  if (!FORGETS && !((fusion_real)s->instants * LASTING > 1)) {
    ++s->instants;
    a = 1 / ((fusion_real)s->instants + 10);
    a = a > LASTING ? a : LASTING;
  }
  s->gathered_gain += a;
  s->last_gain = a;
  s->gathered_rounding = s->rounding;
  for (k = 0; k < s->m; ++k)
    s->gathered[s->index[k]] += a * (s->r[s->index[k]] * s->r[s->index[k]]);
  if (s->gathered_gain >= R(0.0079) || ++s->gathered_instants >= 16) renew(s, a);
}

static void use_present(fusion_state *s, const fusion_real *y) {
  uint32_t i;
  s->use = 0;
  for (i = 0; i < N; ++i)
    if (usable(y[i]) && !s->out[i]) s->present[s->use++] = i;
}

static void begin_moment(fusion_state *s, uint32_t i) {
  if (!(s->moment[i] < 0)) return;
  s->moment[i] = 1;
  s->not_begun -= 1;
}

static void forget(fusion_state *s, uint32_t i) {
  if (!(s->moment[i] < 0)) ++s->not_begun;
  s->moment[i] = -1;
}

static int found_fault(fusion_state *s) {
  const fusion_real least = NOISE_OF_ROUNDING * s->rounding;
  fusion_real largest = 0;
  uint32_t k, where;
  int beyond = 0;
  if (!s->started || s->use < 3) return 0;
  for (k = 0; s->not_begun > 0 && k < s->use; ++k) begin_moment(s, s->present[k]);
  where = s->present[0];
  for (k = 0; k < s->use; ++k) {
    const uint32_t i = s->present[k];
    const fusion_real expected = s->shown[i] > least ? s->shown[i] : least;
    s->moment[i] += FAULT_GAIN * (s->r[i] * s->r[i] / expected - s->moment[i]);
    beyond = beyond || s->moment[i] > THRESHOLD;
    if (s->moment[i] > largest) {
      largest = s->moment[i];
      where = i;
    }
  }
  if (!beyond || s->now < ARMED) return 0;
  for (k = 0; k < s->use; ++k) forget(s, s->present[k]);
  s->out[where] = 1;
  s->calm[where] = 0;
  ++s->count_out;
  return 1;
}

static void check_recovery(fusion_state *s, const fusion_real *y) {
  const fusion_real least = NOISE_OF_ROUNDING * s->rounding;
  uint32_t i;
  for (i = 0; i < N; ++i) {
    const fusion_real r = y[i] - s->x;
    fusion_real expected = s->v[i] + s->fused;
    if (!s->out[i] || !usable(y[i])) continue;
    expected = expected > least ? expected : least;
    begin_moment(s, i);
    s->moment[i] += FAULT_GAIN * (r * r / expected - s->moment[i]);
    s->calm[i] = s->moment[i] > THRESHOLD ? 0 : s->calm[i] + 1;
    if (s->moment[i] > 2 * THRESHOLD) s->moment[i] = 2 * THRESHOLD;
    if (s->calm[i] < RECOVERY) continue;
    s->out[i] = 0;
    s->count_out -= 1;
    forget(s, i);
  }
}

static int estimate(fusion_state *s, const fusion_real *y, fusion_real *x, fusion_real *variance) {
  int found = 0, good;
  if (s->use < N || s->count_out > 0 || !s->started) use_present(s, y);
  good = s->use > 0 && usable(fuse(s, y));
  if (!good && s->use == N && s->count_out == 0) {
    use_present(s, y);
    good = s->use > 0 && usable(fuse(s, y));
  }
  if (good && WATCHES) found = found_fault(s);
  if (found) {
    use_present(s, y);
    good = s->use > 0 && usable(fuse(s, y));
  }
  if (good) {
    *x = s->x;
    *variance = s->started ? s->fused : -1;
    if (WATCHES && s->count_out > 0) check_recovery(s, y);
    if (!found) update(s, y);
  }
  ++s->now;
  if (s->now == 0xffffffffu) s->now = 0xfffffffeu;
  return good;
}
)";

}  // namespace libchar::fusion
