#include "libchar/fusion/algorithms/neural_simplex.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "libchar/core/text/readable.hpp"

namespace libchar::fusion {
namespace {

/// Instants without a right network before one is learnt again, and without a sample before a sensor is away.
constexpr int kPatience = 200, kAway = 50;

TanhNetwork shape_of(std::size_t n, const Settings& settings) {
  const std::size_t inputs = 1 + n + static_cast<std::size_t>(settings["past"]);
  const auto most = (static_cast<std::size_t>(settings["most_weights"]) - 1) / (inputs + 2);
  return {inputs, std::min(static_cast<std::size_t>(settings["neurons"]), std::max<std::size_t>(most, 1))};
}

}  // namespace

NeuralSimplex::NeuralSimplex(const Array& array, const Settings& settings)
    : n_(static_cast<std::size_t>(array.channels)),
      shape_(shape_of(n_, settings)),
      plan_{static_cast<std::size_t>(settings["past"]), static_cast<std::size_t>(settings["most_samples"]),
            static_cast<std::size_t>(settings["starts"]), static_cast<std::uint64_t>(settings["seed"]),
            settings["retraining"] == 1},
      baseline_(array, Settings(Minque::options)),
      past_(n_, plan_.lags),
      network_(n_, plan_.lags, shape_),
      retrained_(n_, plan_.lags, shape_),
      own_past_(plan_.seed),
      left_out_(n_),
      tried_(n_),
      set_(n_),
      absent_(n_),
      y_(n_),
      variance_(n_) {
  if (array.learning_samples <= 0) return;
  learning_.rows.emplace(n_, plan_.lags, plan_.most_rows, array.learning_samples, plan_.seed);
  Array window = array;
  window.fault_free_samples = 0;
  learning_.baseline.emplace(window, Settings(Minque::options));
}

double NeuralSimplex::cost_ns(const Array& array, const Settings& settings) {
  const auto n = static_cast<double>(array.channels);
  const TanhNetwork shape = shape_of(static_cast<std::size_t>(array.channels), settings);
  return 60 * n + 15.0 * static_cast<double>(shape.hidden) + 1000;
}

// Everything the network sees is relative to one sample: an offset costs no digits.
void NeuralSimplex::shift(const Sample& y) {
  if (!origin_)
    for (const double sample : y)
      if (usable(sample) && !origin_) origin_ = sample;
  for (std::size_t i = 0; i < n_; ++i) y_[i] = y[static_cast<Eigen::Index>(i)] - origin_.value_or(0);
}

void NeuralSimplex::note_left_out(const Minque& baseline) {
  for (std::size_t i = 0; i < n_; ++i) left_out_[i] = baseline.leaves_out(i) ? 1 : 0;
}

void NeuralSimplex::learn(const Sample& y, const Sample& truth) {
  if (!learning_.rows) return;
  const Estimate baseline = learning_.baseline->step(y);
  shift(y);
  past_.push(y_.data());
  const bool whole = complete(y);
  if (whole && usable(truth[0]))
    learning_.rows->add(past_, truth[0] - *origin_, baseline.x[0] - *origin_);
  else
    learning_.rows->skip();
}

void NeuralSimplex::skip(const Sample& y) {
  if (!learning_.rows) return;
  learning_.baseline->step(y);
  shift(y);
  past_.push(y_.data());
  learning_.rows->skip();
}

void NeuralSimplex::finish_learning() {
  if (!learning_.rows || learning_.taught) return;
  TaughtRows& rows = *learning_.rows;
  rows.put_in_order();
  past_.forget();
  if (rows.training() >= 2 * shape_.size() && rows.held_out() >= 4 * Teaching::kBlocks) {
    learning_.teaching.emplace(rows, plan_.lags, shape_, plan_.seed);
    for (std::size_t i = 0; i < n_; ++i) variance_[i] = learning_.baseline->noise_variance(i);
    learning_.teaching->begin(std::vector<char>(n_, 1), variance_.data());
    learning_.teaching->finish_at_once(plan_.starts);
    network_ = learning_.teaching->made();
    learning_.taught = true;
  }
  learning_.baseline.reset();
}

void NeuralSimplex::exchange(LearntExchange& with) {
  double taught = learning_.taught ? 1 : 0;
  with.number("taught", taught);
  if (taught == 0) return;
  double origin = origin_.value_or(0);
  with.number("origin", origin);
  origin_ = origin;
  network_.exchange(with);
  if (with.taking_in()) network_.start_over();
}

/// Both halves of the array by the baseline's variances: even and odd sensors.
bool NeuralSimplex::judge_past(double x, double variance) {
  double sum[2] = {}, inverse[2] = {};
  for (std::size_t i = 0; i < n_; ++i) {
    if (!usable(y_[i]) || left_out_[i] != 0 || !(variance_[i] > 0)) continue;
    sum[i % 2] += (y_[i] - x) / variance_[i];
    inverse[i % 2] += 1 / variance_[i];
  }
  const double all = inverse[0] + inverse[1];
  double half[2], weight[2];
  for (int a = 0; a < 2; ++a) {
    half[a] = inverse[a] > 0 ? x + sum[a] / inverse[a] : x;
    weight[a] = all > 0 && std::isfinite(all) ? inverse[a] / all : 0;
  }
  return own_past_.judge(x, variance, half, weight);
}

Lead NeuralSimplex::choose(const Estimate& baseline, Estimate& out) {
  const BaselineView view{baseline.x[0] - *origin_, baseline.variance[0], left_out_.data()};
  const auto give = [&](double x, double variance, Lead lead) {
    out = Estimate::scalar(x + *origin_, variance);
    return lead;
  };
  const bool network = network_.right && network_.judge(past_, y_.data(), view);
  const bool retrained = retrained_.right && retrained_.judge(past_, y_.data(), view);
  const bool own = plan_.retraining && judge_past(view.x, view.variance);
  watch_network(network || retrained);
  if (network) return give(network_.x(), network_.variance(), Lead::network);
  if (retrained) return give(retrained_.x(), retrained_.variance(), Lead::retrained);
  if (own) return give(own_past_.x(), own_past_.variance(), Lead::past);
  return Lead::baseline;
}

void NeuralSimplex::watch_network(bool good) {
  for (std::size_t i = 0; i < n_; ++i) absent_[i] = usable(y_[i]) ? 0 : std::min(absent_[i] + 1, kAway);
  run_.bad = good ? 0 : std::min(run_.bad + 1, kPatience);
  if (learning_.teaching && plan_.retraining) teach();
}

/// Those that are here and not left out; where they disagree, without the one that is furthest off.
bool NeuralSimplex::pick_set() {
  std::size_t here = 0;
  bool less = false;
  for (std::size_t i = 0; i < n_; ++i) {
    set_[i] = left_out_[i] == 0 && absent_[i] < kAway ? 1 : 0;
    here += set_[i] != 0 ? 1 : 0;
    less = less || set_[i] == 0;
  }
  if (!less) {
    const int worst = network_.worst(tried_);
    if (worst < 0 || network_.reason() != HandOverReason::inconsistent) return false;
    set_[static_cast<std::size_t>(worst)] = 0;
    tried_[static_cast<std::size_t>(worst)] = 1;
    --here;
  }
  return here >= 2 && !std::equal(set_.begin(), set_.end(), retrained_.set.used.begin());
}

void NeuralSimplex::teach() {
  Teaching& teaching = *learning_.teaching;
  if (teaching.busy()) {
    if (teaching.advance()) retrained_ = teaching.made();
    return;
  }
  if (!network_.right || run_.bad < kPatience) return;
  run_.bad = 0;
  if (pick_set()) teaching.begin(set_, variance_.data());
}

Estimate NeuralSimplex::step(const Sample& y) {
  Estimate out = baseline_.step(y);
  shift(y);
  past_.push(y_.data());
  note_left_out(baseline_);
  for (std::size_t i = 0; i < n_; ++i) variance_[i] = baseline_.noise_variance(i);
  const Estimate baseline = out;
  const Lead lead = origin_ ? choose(baseline, out) : Lead::baseline;
  if (lead != run_.lead) {
    HandOverReason reason = HandOverReason::right;
    if (lead == Lead::baseline || static_cast<int>(lead) > static_cast<int>(run_.lead))
      reason = run_.lead == Lead::past        ? own_past_.reason()
               : run_.lead == Lead::retrained ? retrained_.reason()
               : run_.lead == Lead::network   ? network_.reason()
                                              : HandOverReason::right;
    log_.note({run_.now, lead, reason});
    run_.lead = lead;
  }
  ++run_.led[static_cast<std::size_t>(lead)];
  ++run_.now;
  return out;
}

void NeuralSimplex::remarks(Findings& warnings) const {
  baseline_.remarks(warnings);
  const std::int64_t led = run_.now - run_.led[0];
  if (run_.now > 0 && led > 0)
    warnings.add("network_led",
                 "a network led in " + brief_text(100 * static_cast<double>(led) / static_cast<double>(run_.now), 2) +
                     " % of the run, " + std::to_string(log_.events().size() + log_.dropped()) + " hand-overs");
  if (learning_.taught && !network_.right && learning_.teaching)
    warnings.add(
        "network_not_better",
        "gives its baseline: on what it had not learnt, its network's error was " +
            brief_text(std::sqrt(learning_.teaching->network_square() / learning_.teaching->baseline_square()), 3) +
            " times that of the baseline");
}

}  // namespace libchar::fusion
