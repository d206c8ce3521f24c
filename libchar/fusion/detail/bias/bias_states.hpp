#pragma once
// A sensor's drift as states of first order, b_k+1 = phi b_k + w, var(w) = drive:
//   Gauss-Markov     phi = exp(-dt/tau), drive = sigma^2 (1 - phi^2), starts with variance sigma^2
//   flicker B        sum of Gauss-Markov processes a decade apart in tau, each of variance B^2 ln(10)/pi:
//                    their densities add up to B^2/(2 pi f) within 6 %       (van der Ziel 1950; Keshner 1982)
//   walk K           drive K^2 dt, tau ten times the slowest flicker, starts with variance zero
// Flicker is followed between the frequency where white noise hides it and the one where the walk does.

#include <Eigen/Core>
#include <vector>

#include "libchar/fusion/array.hpp"

namespace libchar::fusion {

struct BiasStates {
  Eigen::VectorXd pole, drive, start;  ///< phi, variance a step, variance before the first instant
  std::vector<Eigen::Index> channel;   ///< whose samples it is in
  Eigen::Index size() const { return pole.size(); }
};

/// `slowest_s`: no process of flicker is slower.
BiasStates bias_states(const std::vector<NoiseModel>& models, double rate_hz, double slowest_s);

}  // namespace libchar::fusion
