// `step` makes no trip to the heap with any switch of any algorithm thrown, on sound samples and on
// bad ones (properties_test.cpp has the defaults).

#include <catch2/catch.hpp>

#include "libchar/core/error.hpp"
#include "libchar/fusion/why_not.hpp"
#include "tests/fusion/heap_counter.hpp"
#include "tests/fusion/scenes.hpp"
#include "tests/fusion/vectors.hpp"

using namespace libchar;
using namespace libchar::fusion;

namespace {

/// The defaults, then each switch thrown on its own.
std::vector<Settings> variants(const Entry& entry) {
  std::vector<Settings> all{Settings(entry.options)};
  for (const Option& option : entry.options)
    if (option.whole && option.low == 0 && option.high == 1) {
      Settings other(entry.options);
      other.set(option.name, 1 - option.standard);
      all.push_back(other);
    }
  return all;
}

/// Trips to the heap while the scene runs; -1 when the algorithm says that it cannot learn it.
long trips_of(const Entry& entry, const Settings& settings, const test::FusionScene& scene) {
  auto runner = entry.make(scene.array, settings);
  try {
    runner->learn(scene.y, scene.truth);
    if (entry.looks_ahead(settings)) runner->look(scene.y);
    runner->finish_learning();
  } catch (const Error&) {
    return -1;
  }
  Eigen::MatrixXd x(scene.array.inputs(), scene.y.cols()), variance = x;
  const std::size_t before = test::heap_trips();
  runner->run(scene.y, x, variance);
  return static_cast<long>(test::heap_trips() - before);
}

}  // namespace

TEST_CASE("no heap in step: every algorithm with every switch, every scene") {
  auto all = test::fusion_scenes();
  all.push_back(test::tilt_scene());
  all.push_back(test::lever_scene());
  std::size_t tried = 0;
  for (const test::FusionScene& scene : all)
    for (const Entry& entry : algorithms()) {
      if (!why_not(*entry.description, scene.array).empty()) continue;
      if (entry.description->name == "perceptron" && !scene.benign) continue;  // one learning is enough
      for (const Settings& settings : variants(entry)) {
        std::string values;
        for (const double value : settings.values()) values += std::to_string(value) + " ";
        INFO(entry.description->name << " with " << values << "on " << scene.name);
        const long made = trips_of(entry, settings, scene);
        CHECK(made <= 0);
        if (made >= 0) ++tried;
      }
    }
  CHECK(tried > 200);
}
