// The contract: options by name, reasons not to run, the registry.

#include <catch2/catch.hpp>
#include <set>

#include "libchar/core/error.hpp"
#include "libchar/fusion/why_not.hpp"
#include "tests/fusion/vectors.hpp"

using namespace libchar;
using namespace libchar::fusion;

namespace {

std::string code_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.problem().code + " " + error.problem().hint;
  }
  return "";
}

constexpr std::array kTable{Option{"forgetting", "", 0.99, 0, 1, "how much is kept"},
                            Option{"length", "samples", 5, 1, 9, "of a window", true}};

}  // namespace

TEST_CASE("options: set by name, within their range") {
  Settings settings{std::span<const Option>(kTable)};
  CHECK(settings["forgetting"] == 0.99);
  settings.set("length", 7);
  CHECK(settings["length"] == 7);
  CHECK(code_of([&] { settings.set("forgeting", 0.5); }) == "E0850 did you mean forgetting?");
  CHECK(code_of([&] { settings.set("colour", 0.5); }) == "E0850 its options are forgetting, length");
  for (const double bad : {-0.1, 1.1, std::nan(""), std::numeric_limits<double>::infinity()})
    CHECK(code_of([&] { settings.set("forgetting", bad); }) == "E0851 ");
  CHECK(code_of([&] { settings.set("length", 2.5); }) == "E0851 ");
  CHECK(settings["forgetting"] == 0.99);
}

TEST_CASE("every description is complete, every option's default is in its range") {
  std::set<std::string_view> names;
  for (const Entry& entry : algorithms()) {
    INFO(entry.description->name);
    CHECK(names.insert(entry.description->name).second);
    CHECK_FALSE(entry.description->title.empty());
    CHECK_FALSE(entry.description->source.empty());
    CHECK_FALSE(entry.description->complexity.empty());
    const Needs& needs = entry.description->needs;
    CHECK((needs.reference || needs.reference_throughout || needs.reference_helps) ==
          !entry.description->learning_complexity.empty());
    for (const Option& option : entry.options) {
      INFO(option.name);
      CHECK_FALSE(option.meaning.empty());
      Settings settings(entry.options);
      CHECK_NOTHROW(settings.set(option.name, option.standard));
    }
  }
  CHECK(code_of([] { algorithm("maen"); }) == "E0853 did you mean mean?");
}

TEST_CASE("why_not: a sentence for each thing that is missing") {
  const auto needing = [](const Needs& needs) { return Description{"foo", "Foo", "here", "O(n)", needs}; };
  Array two = test::array(2);
  CHECK(why_not(needing({}), two).empty());
  CHECK(why_not(needing({.min_channels = 3}), two) == "needs at least 3 channels; this scene has 2");
  CHECK(why_not(needing({.max_channels = 2}), two).empty());
  CHECK(why_not(needing({.max_channels = 2}), test::array(3)) ==
        "takes at most 2 channels (its memory grows with their square); this scene has 3");
  CHECK(why_not(needing({.more_than_inputs = 2}), two) ==
        "needs at least 3 channels for 1 input; this scene has 2 (the difference of two channels tells the sum of "
        "their variances, not which is the noisier)");
  CHECK(why_not(needing({.noise_levels = true}), two) ==
        "needs the noise level of each sensor: give `models`, noise or a stretch at rest");
  two.noise_levels = Eigen::Vector2d(1, 0);
  CHECK_FALSE(why_not(needing({.noise_levels = true}), two).empty());
  two.noise_levels = Eigen::Vector2d(1, 2);
  CHECK(why_not(needing({.noise_levels = true}), two).empty());
  CHECK_FALSE(why_not(needing({.reference = true}), two).empty());
  two.learning_samples = 10;
  CHECK(why_not(needing({.reference = true}), two).empty());
  CHECK(why_not(needing({.learning_samples = 11, .reference = true}), two) ==
        "learns from at least 11 instants; the learning window has 10");
  CHECK_FALSE(why_not(needing({.reference_throughout = true}), two).empty());
  CHECK_FALSE(why_not(needing({.fault_free_start = true}), two).empty());
  CHECK_FALSE(why_not(needing({.rate = true}), two).empty());
  CHECK_FALSE(why_not(needing({.tilt = true}), two).empty());
  two.observation_matrix = Eigen::MatrixXd::Ones(2, 1);
  CHECK(why_not(needing({}), two).empty());
  two.observation_matrix(1, 0) = 2;
  CHECK_FALSE(why_not(needing({}), two).empty());
  CHECK(why_not(needing({.observation_matrix = true}), two).empty());
  two.observation_matrix = Eigen::MatrixXd::Ones(2, 3);
  CHECK(why_not(needing({}), two) == "estimates one input; this scene has 3");
  two.observation_matrix = Eigen::MatrixXd::Ones(2, kMaxStates + 1);
  CHECK_FALSE(why_not(needing({.observation_matrix = true}), two).empty());
  two.tilt = TiltChannels{};
  CHECK_FALSE(why_not(needing({}), two).empty());
}

TEST_CASE("fault rules have names") {
  CHECK(name(FaultRule::variance) == "variance");
  CHECK(name(FaultRule::residual_moment) == "residual_moment");
  CHECK(name(FaultRule::bias) == "bias");
  CHECK(name(FaultRule::saturated) == "saturated");
}

TEST_CASE("what cannot run is refused with the same sentence after its name") {
  for (const Entry& entry : algorithms()) {
    INFO(entry.description->name);
    const Array none = test::array(0);
    const std::string sentence = why_not(*entry.description, none);
    REQUIRE_FALSE(sentence.empty());
    try {
      entry.make(none, Settings(entry.options));
      FAIL("made");
    } catch (const Error& error) {
      CHECK(error.problem().what == std::string(entry.description->name) + " " + sentence);
    }
  }
}

TEST_CASE("why_not: gains that do not tell the inputs apart") {
  Array array;
  array.channels = 4;
  array.observation_matrix = Eigen::MatrixXd::Ones(4, 2);
  const Description& mean = *algorithm("mean").description;
  CHECK_THAT(why_not(mean, array), Catch::Contains("tell the inputs apart"));
  array.observation_matrix.col(1) << 1, 1, 1, 1 + 1e-14;
  CHECK_FALSE(why_not(mean, array).empty());
  array.observation_matrix.col(1) << 1e-9, 1e-9, 1e-9, 2e-9;  // another unit is no reason
  CHECK(why_not(mean, array).empty());
  array.observation_matrix.col(1).setZero();
  CHECK_FALSE(why_not(mean, array).empty());
}
