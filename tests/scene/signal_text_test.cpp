#include <catch2/catch.hpp>

#include "libchar/core/error.hpp"
#include "libchar/scene/text/typed_text.hpp"

using namespace libchar;
using Catch::Contains;

TEST_CASE("a signal in one line says what the map of a scene says") {
  const SignalSpec sine = parse_signal("sine,amplitude=2,frequency_hz=0.5,offset=-1", "`truth`");
  CHECK(sine.kind == "sine");
  CHECK(sine.amplitude == 2);
  CHECK(sine.frequency_hz == 0.5);
  CHECK(sine.offset == -1);
  const SignalSpec constant = parse_signal("-2.5", "`truth`");
  CHECK(constant.kind == "constant");
  CHECK(constant.value == -2.5);
  CHECK(parse_signal("zero", "`truth`").kind == "zero");
  const SignalSpec recorded = parse_signal("recording,file=log.csv,channel=x", "`truth`");
  CHECK(recorded.file == "log.csv");
  CHECK(recorded.channel == "x");
  CHECK(recorded.samples.empty());
}

TEST_CASE("a signal that cannot be read is refused at its place") {
  CHECK_THROWS_WITH(parse_signal("sine,2", "`truth`"), Contains("`truth`: error E0721") && Contains("KIND,key=value"));
  CHECK_THROWS_WITH(parse_signal("sinus", "`truth`"), Contains("`truth`") && Contains("did you mean sine?"));
  CHECK_THROWS_WITH(parse_signal("sine,amplitud=1", "`truth`"), Contains("did you mean amplitude?"));
  CHECK_THROWS_WITH(parse_signal("ramp", "`truth`"), Contains("slope is missing"));
}
