// Sweeps of options: their forms, ranges and grids.

#include <catch2/catch.hpp>

#include "libchar/replay/replay.hpp"

using namespace libchar;
using Catch::Contains;
using Catch::StartsWith;

TEST_CASE("sweeps: a value, a list, a range") {
  const Sweep list = parse_sweep("minque.gamma=.9,0.99,.999", "--sweep");
  CHECK(list.algorithm == "minque");
  CHECK(list.option == "gamma");
  CHECK(list.values == std::vector<double>{0.9, 0.99, 0.999});
  CHECK(parse_sweep("perceptron.neurons=3..6", "--sweep").values == std::vector<double>{3, 4, 5, 6});
  const std::vector<double> wide = parse_sweep("perceptron.neurons=1..60", "--sweep").values;
  CHECK(wide.front() == 1);
  CHECK(wide.back() == 60);
  CHECK(wide.size() <= 12);
  for (std::size_t i = 1; i < wide.size(); ++i) CHECK(wide[i] > wide[i - 1]);
}

TEST_CASE("sweeps: refused with the form that is right") {
  for (const char* text : {"minque.gamma", "gamma=1", "minque.gamma=", "minque.gamma=.9,", "minque.gamma=a",
                           "perceptron.neurons=9..", "minque.gamma=.9...99"})
    CHECK_THROWS_WITH(parse_sweep(text, "--sweep"), Contains("E0963") && Contains("--sweep"));
  for (const char* text : {"perceptron.neurons=9..3", "minque.gamma=.9....99"})
    CHECK_THROWS_WITH(parse_sweep(text, "--sweep"), StartsWith("--sweep: error E0201"));
  CHECK_THROWS_WITH(parse_sweep("minque.gamma=.9,.99", "--set", 1), Contains("E0963"));
  CHECK_THROWS_WITH(parse_sweep("minque.gama=.9", "--sweep"), Contains("gamma"));
  CHECK_THROWS_WITH(parse_sweep("minke.gamma=.9", "--sweep"), Contains("minque"));
  CHECK_THROWS(parse_sweep("minque.gamma=2", "--sweep"));
}

TEST_CASE("sweeps: several of one algorithm make a grid, others stay as they are") {
  const auto all =
      swept({parse_sweep("minque.gamma=.9,.99", "--sweep"), parse_sweep("perceptron.neurons=3..4", "--sweep"),
             parse_sweep("perceptron.starts=1,2", "--sweep")},
            {{"mean", {}, 0, 0}, {"minque", {{"gamma", 0.5}}, 0, 0}});
  REQUIRE(all.size() == 7);
  CHECK(all[0].name == "mean");
  CHECK(all[1].options == std::vector<std::pair<std::string, double>>{{"gamma", 0.9}});
  CHECK(all[2].options == std::vector<std::pair<std::string, double>>{{"gamma", 0.99}});
  CHECK(all[3].options == std::vector<std::pair<std::string, double>>{{"neurons", 3}, {"starts", 1}});
  CHECK(all[6].options == std::vector<std::pair<std::string, double>>{{"neurons", 4}, {"starts", 2}});
}
