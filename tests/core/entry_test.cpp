#include "libchar/core/document/entry.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "libchar/core/document/document.hpp"

using namespace libchar;

TEST_CASE("entries: a list has a dash an element, in blocks or in flow as the element says") {
  Entry block, flow, list;
  block.form = Entry::Form::block;
  block.below = {{"a", 1.5}, {"b", std::string("x")}};
  flow.form = Entry::Form::flow;
  flow.below = block.below;
  list.key = "parts";
  list.form = Entry::Form::list;
  list.below = {block, flow, block};
  const std::string yaml = yaml_of({list, {"last", std::uint64_t{3}}});
  CHECK(yaml ==
        "parts:\n"
        "  - a: 1.5\n"
        "    b: \"x\"\n"
        "  - {a: 1.5, b: \"x\"}\n"
        "  - a: 1.5\n"
        "    b: \"x\"\n"
        "last: 3\n");
  CHECK(as_json(parse_yaml_document(yaml, "f")) == json_of({list, {"last", std::uint64_t{3}}}));
}
