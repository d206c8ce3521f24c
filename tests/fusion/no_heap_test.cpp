// `step` makes no trip to the heap, in any algorithm, on sound samples and on bad ones. Counted at
// malloc itself (linker option --wrap) and at operator new, so it sees Eigen's memory and everybody
// else's.

#include <catch2/catch.hpp>
#include <cstdlib>
#include <new>

#include "libchar/core/error.hpp"
#include "tests/fusion/scenes.hpp"
#include "tests/fusion/vectors.hpp"

namespace {
bool watching = false;
long trips = 0;
void count() {
  if (watching) ++trips;
}
}  // namespace

extern "C" {
void* __real_malloc(std::size_t);
void* __real_calloc(std::size_t, std::size_t);
void* __real_realloc(void*, std::size_t);
void* __wrap_malloc(std::size_t size);
void* __wrap_calloc(std::size_t number, std::size_t size);
void* __wrap_realloc(void* old, std::size_t size);
void* __wrap_malloc(std::size_t size) {
  count();
  return __real_malloc(size);
}
void* __wrap_calloc(std::size_t number, std::size_t size) {
  count();
  return __real_calloc(number, size);
}
void* __wrap_realloc(void* old, std::size_t size) {
  count();
  return __real_realloc(old, size);
}
}

void* operator new(std::size_t size) {
  if (void* const memory = std::malloc(size != 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

using namespace libchar;
using namespace libchar::fusion;

TEST_CASE("the heap is watched") {
  trips = 0;
  watching = true;
  {
    const Eigen::VectorXd volatile_size = Eigen::VectorXd::Zero(100 + trips);
    std::vector<double> plain(static_cast<std::size_t>(volatile_size.size()));
    plain.back() = volatile_size[0];
  }
  watching = false;
  CHECK(trips >= 2);
}

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
  auto runner = entry.make(scene.given, settings);
  try {
    runner->learn(scene.y, scene.truth);
    runner->finish_learning();
  } catch (const Error&) {
    return -1;
  }
  Eigen::MatrixXd x(scene.given.inputs(), scene.y.cols()), variance = x;
  trips = 0;
  watching = true;
  runner->run(scene.y, x, variance);
  watching = false;
  return trips;
}

}  // namespace

TEST_CASE("no heap in step: every algorithm with every switch, every scene") {
  auto all = test::fusion_scenes();
  all.push_back(test::tilt_scene());
  all.push_back(test::lever_scene());
  std::size_t tried = 0;
  for (const test::FusionScene& scene : all)
    for (const Entry& entry : algorithms()) {
      if (!why_not(*entry.card, scene.given).empty()) continue;
      if (entry.card->name == "perceptron" && !scene.benign) continue;  // one learning is enough
      for (const Settings& settings : variants(entry)) {
        std::string values;
        for (const double value : settings.values()) values += std::to_string(value) + " ";
        INFO(entry.card->name << " with " << values << "on " << scene.name);
        const long made = trips_of(entry, settings, scene);
        CHECK(made <= 0);
        if (made >= 0) ++tried;
      }
    }
  CHECK(tried > 200);
}
