#pragma once
// What a replay will read, learn and run, and what it leaves out, with the reason.

#include <cstdint>
#include <string>
#include <vector>

#include "libchar/fusion/array.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/replay/detail/align/instants.hpp"
#include "libchar/replay/detail/blind_share.hpp"
#include "libchar/replay/detail/plan/sensor_knowledge.hpp"
#include "libchar/replay/replay.hpp"

namespace libchar {

struct PlannedAlgorithm {
  std::string label;
  const fusion::Entry* entry = nullptr;
  fusion::Settings settings;
  std::string why;        ///< why it does not run, without its name ("needs …"); empty: it runs
  bool asked = true;      ///< false: run for `no_skip` alone, shown nowhere
  bool helped = false;    ///< there is a reference in a learning window, which it does not need
  BlindShare blind = {};  ///< how much of the run its scores without a reference are made of
  bool runs() const { return why.empty(); }
  bool learns_before() const { return entry->description->needs.reference || helped; }
  bool learns_run() const { return entry->description->needs.reference_throughout; }
  bool looks_ahead() const { return entry->looks_ahead(settings); }
};

struct ReplayPlan {
  fusion::Array array;
  std::vector<Eigen::Index> live;  ///< sensors that have samples; empty: all of them
  TimeWindow learning, evaluation;
  std::int64_t learn_from = 0, learn_to = 0;  ///< instants of the learning window; equal: none
  std::int64_t run_from = 0, run_to = 0;
  std::int64_t warm_up = 0;  ///< instants of the run that are not scored
  std::size_t block = 0;
  bool learning_pass = false;      ///< some algorithm learns in the learning window
  bool run_learning_pass = false;  ///< some bound learns on the run itself
  bool looking_pass = false;       ///< some algorithm looks at the run before it estimates
  bool without_reference = false;  ///< leave-one-out and split arrays
  std::vector<PlannedAlgorithm> algorithms;
  std::vector<PlannedAlgorithm> optimum;  ///< bounds that tell the optimum of the scene
  Findings warnings;
};

/// The scene as it is replayed: where a reference could teach, and nothing says when and what, the first half of the
/// recording does, and terms of an alignment are tried.
Scene taught(const Scene& scene, const ReplayOptions& options);

/// Throws Error(input) for unknown algorithms or options of the scene (with place), windows outside
/// the recording, an empty run.
ReplayPlan make_plan(const Scene& scene, const ReplayOptions& options, const Instants& instants,
                     const SensorKnowledge& knowledge);

/// H of a scene, a row a sensor; empty: one input, seen alike by all.
Eigen::MatrixXd observations(const Scene& scene, std::size_t inputs);

/// The same array with some of its channels only; `channels` empty: all of them.
fusion::Array subset(const fusion::Array& array, const std::vector<Eigen::Index>& channels);

}  // namespace libchar
