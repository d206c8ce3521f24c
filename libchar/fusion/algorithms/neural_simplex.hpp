#pragma once
// Neural simplex [RV chapter 6, figure 6.1, there future work; Phan et al. 2020, after Sha's Simplex 2001]:
//
//   estimate_k = network_k  where the decision module trusts it,  else baseline_k
//
// Baseline: `minque`, which needs nothing and finds faults. Network: a perceptron on the sensors and their recent past,
// learnt from the reference (taught_network.hpp has the decision module's rules). Where a sensor fails, the adaptation
// module learns it again without that sensor, in slices behind the run. Without a reference the network learns from the
// baseline's own past (past_network.hpp). Nothing leads before it has been better on what it has not seen.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/algorithms/minque.hpp"
#include "libchar/fusion/detail/simplex/past_network.hpp"
#include "libchar/fusion/detail/simplex/taught_network.hpp"

namespace libchar::fusion {

struct NeuralSimplex {
  static constexpr Description description{
      .name = "neural-simplex",
      .title = "Neural simplex: MINQUE, and a network where it is better",
      .source = "[RV 6]; Phan et al. 2020",
      .complexity = "O(n h), h hidden neurons; O((n h)^2) while it learns",
      .needs = {.max_channels = 100, .more_than_inputs = 2, .reference_helps = true, .accepts_missing = true},
      .learning_complexity = "O((n h)^2) an iteration",
      .withstands = 3};
  static constexpr std::array options{
      Option{"neurons", "", 8, 1, 64, "h: hidden neurons of the network", true},
      Option{"past", "", 4, 1, 6, "instants of the past that the network sees: 1, 4, 16 … samples ago", true},
      Option{"most_samples", "samples", 2000, 200, 1e6,
             "kept of the learning window, a quarter of them to judge what was learnt", true},
      Option{"most_weights", "", 200, 10, 1e4, "of the network; wide arrays get fewer neurons", true},
      Option{"starts", "", 2, 1, 100, "trainings from different random weights", true},
      Option{"seed", "", 1, 0, 9007199254740992.0, "of the random weights and choices", true},
      Option{"retraining", "", 1, 0, 1,
             "1: learns again in the run, without sensors that fail, and from its own past; 0: neither", true}};

  NeuralSimplex(const Array& array, const Settings& settings);
  NeuralSimplex(const NeuralSimplex&) = delete;
  NeuralSimplex& operator=(const NeuralSimplex&) = delete;
  static double cost_ns(const Array& array, const Settings& settings);
  void learn(const Sample& y, const Sample& truth);
  void skip(const Sample& y);
  void finish_learning();
  void exchange(LearntExchange& with);
  Estimate step(const Sample& y);
  Eigen::VectorXd variances() const { return baseline_.variances(); }
  const FaultLog& faults() const { return baseline_.faults(); }
  const HandOverLog& hand_overs() const { return log_; }
  void remarks(Findings& warnings) const;

 private:
  void shift(const Sample& y);
  void note_left_out(const Minque& baseline);
  Lead choose(const Estimate& baseline, Estimate& out);
  bool judge_past(double x, double variance);
  void watch_network(bool good);
  void teach();
  bool pick_set();

  std::size_t n_;
  TanhNetwork shape_;
  struct {
    std::size_t lags, most_rows, starts;
    std::uint64_t seed;
    bool retraining;
  } plan_;
  Minque baseline_;
  struct {
    std::optional<Minque> baseline;  // of the learning window
    std::optional<TaughtRows> rows;
    std::optional<Teaching> teaching;
    bool taught = false;
  } learning_;
  std::optional<double> origin_;
  RecentPast past_;
  TaughtNetwork network_, retrained_;
  PastNetwork own_past_;
  HandOverLog log_;
  struct {
    Lead lead = Lead::baseline;
    std::int64_t now = 0;
    int bad = 0;  // instants in a row at which no network of the reference was right
    std::int64_t led[4] = {};
  } run_;
  // Who is absent, and without whom it was tried to learn again.
  std::vector<char> left_out_, tried_, set_;
  std::vector<int> absent_;
  std::vector<double> y_, variance_;
};

}  // namespace libchar::fusion
