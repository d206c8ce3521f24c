#include "libchar/core/document/document.hpp"

#include <sys/resource.h>

#include <catch2/catch.hpp>
#include <functional>
#include <nlohmann/json.hpp>

#include "libchar/core/document/schema.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/process/sanitizer.hpp"

using namespace libchar;

namespace {

std::string refusal(const std::string& text) {
  try {
    parse_yaml_document(text, "f");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::string schema_refusal(const std::string& text, const std::function<void(const MapReader&)>& read) {
  const Document document = parse_yaml_document(text, "f");
  try {
    read(MapReader(document, "f", "", {"alpha", "beta", "list"}));
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("document: every key and value remembers its place") {
  const Document d = parse_yaml_document("a: 1\nb:\n  - x: 2.5\n    y: no\n", "f");
  REQUIRE(d.find("b") != nullptr);
  const Document& item = d.find("b")->value.list.at(0);
  CHECK(item.find("y")->line == 4);
  CHECK(item.find("y")->column == 5);
  CHECK(item.find("y")->value.column == 8);
  CHECK(item.find("y")->value.text == "no");
  CHECK(item.find("x")->value.number == 2.5);
  CHECK_FALSE(item.find("x")->value.whole);
  CHECK(d.find("a")->value.whole);
  CHECK(as_json(d).dump() == R"({"a":1,"b":[{"x":2.5,"y":"no"}]})");
}

TEST_CASE("document: what YAML allows and nobody means is refused with its place") {
  CHECK(refusal("a: &a 1\nb: *a\n").starts_with("f:1:4"));
  CHECK(refusal("version: 1\nversion: 2\n").starts_with("f:2:1"));
  CHECK(refusal("version: 1\n---\nversion: 1\n").find("second document") != std::string::npos);
  CHECK(refusal("version: 1\nx: !!python/object 1\n").starts_with("f:2:4"));
  CHECK(refusal(std::string("version: 1\0\n", 12)).starts_with("f:1:11"));
  CHECK(refusal("a: {x: 1}\nb: {<<: 1}\n").starts_with("f:2:5"));
  CHECK(refusal("").starts_with("f:1:1"));
  CHECK(refusal("version: 1\nchannels:\n\tgx: 1\n").starts_with("f:3:1"));
  CHECK(refusal("version: 1\n" + std::string(1100, 'k') + ": 1\n").starts_with("f:2:1"));
  CHECK(refusal(std::string(400, '[') + std::string(400, ']')).find("64 levels") != std::string::npos);
  CHECK(refusal("version: 1\nchannels: {gx: {N: 1.0e-").starts_with("f:2:"));
}

TEST_CASE("document: text that is no UTF-8, and text of the largest size, are told what is wrong") {
  CHECK(refusal("a: \"\xB0\"\n") == "f (byte 4): error E0522: is not valid UTF-8");
  CHECK_THAT(refusal(std::string(kMaxDocumentBytes, ' ')), Catch::Contains("is empty"));
  CHECK_THAT(refusal(std::string(kMaxDocumentBytes + 1, ' ')),
             Catch::Contains("16777217 bytes exceeds the limit of 16777216"));
  std::string list = "[", lines = "- 1\n";
  for (std::size_t k = 1; k < detail::kMaxDocumentValues; ++k) {  // the list is a value, too
    list += k > 1 ? ",1" : "1";
    lines += "- 1\n";
  }
  CHECK(parse_json_document(list + "]", "f").list.size() == detail::kMaxDocumentValues - 1);
  CHECK_THROWS_WITH(parse_json_document(list + ",1]", "f"), Catch::Contains("more than 500000 values"));
  CHECK_THAT(refusal(lines), Catch::Contains("more than 500000 values"));
}

TEST_CASE("document: what opens brackets and closes none is refused before the parser has read it to its end") {
  // yaml-cpp keeps 200 bytes for each bracket until it knows that the first one is no key.
  for (const char* piece : {"[", "{", "[a,", "[ \n", "[[],[],"}) {
    CAPTURE(piece);
    std::string text = "key: ";
    while (text.size() < 3'000'000) text += piece;
    rusage before{}, after{};
    ::getrusage(RUSAGE_SELF, &before);
    CHECK_THAT(refusal(text), Catch::Contains("f:1") || Catch::Contains("f:2"));
    ::getrusage(RUSAGE_SELF, &after);
    constexpr long kMost = 200 * 1024, kOfSanitizer = LIBCHAR_SANITIZED_THREADS ? 4 : 1;  // kB; its heap keeps shadows
    CHECK(after.ru_maxrss - before.ru_maxrss < kMost * kOfSanitizer);
  }
  std::string numbers = "key: [[1";  // one that can be read at once
  while (numbers.size() < 400'000) numbers += ", 1";
  CHECK(parse_yaml_document(numbers + "]]", "f").find("key")->value.list.at(0).list.size() > 100'000);
}

TEST_CASE("document: whole numbers of either sign stay whole") {
  const Json j =
      as_json(parse_yaml_document("a: -3\nb: -9223372036854775808\nc: 18446744073709551615\nd: 0\ne: -1.0\n", "f"));
  CHECK(j.dump() == R"({"a":-3,"b":-9223372036854775808,"c":18446744073709551615,"d":0,"e":-1.0})");
}

TEST_CASE("document: JSON gives the same tree") {
  const Document json = parse_json_document(R"({"a":1,"b":[{"x":2.5,"y":"no"}],"c":true})", "f.json");
  CHECK(as_json(json).dump() == R"({"a":1,"b":[{"x":2.5,"y":"no"}],"c":true})");
  CHECK(json.find("a")->value.whole);
  CHECK_FALSE(json.find("b")->value.list[0].find("x")->value.whole);
}

TEST_CASE("document: JSON knows the places of its keys and values") {
  const Document json = parse_json_document(
      "\xEF\xBB\xBF{\"a\": -1.5e3, \"b\":\n [true,{\"q\\\"\": \"x\\\\\"}, null,7],\n\"c\":[]}\n", "f");
  const auto place = [](const auto& node) { return std::pair(node.line, node.column); };
  CHECK(place(json) == std::pair(1, 1));
  CHECK(place(*json.find("a")) == std::pair(1, 2));
  CHECK(place(json.find("a")->value) == std::pair(1, 7));
  CHECK(json.find("a")->value.text == "-1.5e3");
  CHECK(place(*json.find("b")) == std::pair(1, 15));
  const Document& list = json.find("b")->value;
  CHECK(place(list) == std::pair(2, 2));
  CHECK(place(list.list[0]) == std::pair(2, 3));
  CHECK(place(list.list[1]) == std::pair(2, 8));
  CHECK(place(list.list[1].map[0]) == std::pair(2, 9));
  CHECK(list.list[1].map[0].key == "q\"");
  CHECK(place(list.list[1].map[0].value) == std::pair(2, 16));
  CHECK(place(list.list[2]) == std::pair(2, 24));
  CHECK(place(list.list[3]) == std::pair(2, 29));
  CHECK(place(json.find("c")->value) == std::pair(3, 5));
}

TEST_CASE("schema: refusals name place, key and the nearest valid key") {
  const auto number = [](const MapReader& m) { m.number("alpha", kNotNegative); };
  CHECK(schema_refusal("alpha: 1\nbetta: 2\n", number) ==
        "f:2:1: error E0540: unknown key; got \"betta\"; hint: did you mean beta?");
  for (const char* value : {"010", "1:30", ".inf", ".nan", "1e400", "-1e-3", "1,5", "1e-3 rad/s", "[1]", "true"}) {
    INFO(value);
    CHECK(schema_refusal(std::string("beta: 1\nalpha: ") + value + "\n", number).starts_with("f:2:8: error"));
  }
  CHECK(schema_refusal("alpha: 1e-05\n", number).empty());
  CHECK(schema_refusal("beta: 1\n", number).find("alpha is missing") != std::string::npos);
  CHECK(schema_refusal("alpha: null\n", number).find("alpha is missing") != std::string::npos);
  const auto list = [](const MapReader& m) { m.list("list"); };
  CHECK(schema_refusal("list: [1, 2]\n", list).empty());
  CHECK(schema_refusal("alpha: 1\nlist: 3\n", list).starts_with("f:2:7: error E0541: list: expected a list"));
  // A refusal quotes what stands there, and stands where that is.
  const auto refuse = [](const MapReader& m) { m.refuse("alpha", "no", "hint"); };
  CHECK_THAT(schema_refusal("beta: 1\nalpha: hello\n", refuse),
             Catch::StartsWith("f:2:8") && Catch::Contains("alpha: no; got \"hello\""));
  CHECK_THAT(schema_refusal("beta: 1\n", refuse), Catch::StartsWith("f:1:1") && !Catch::Contains("got"));
  CHECK_FALSE(schema_refusal("alpha: 1.0\n", [](const MapReader& m) { m.count("alpha"); }).empty());
  CHECK(schema_refusal("alpha: 18446744073709551615\n", [](const MapReader& m) {
          CHECK(m.count("alpha") == 18446744073709551615ULL);
        }).empty());
  CHECK(schema_refusal("alpha: scael\n", [](const MapReader& m) {
          m.word("alpha", {"scale", "bias"});
        }).find("did you mean scale?") != std::string::npos);
  CHECK_FALSE(schema_refusal("alpha: [2, 1]\n", [](const MapReader& m) { m.interval("alpha"); }).empty());
}

TEST_CASE("schema: another format and a newer version are refused by name") {
  const auto check = [](const std::string& text) -> std::string {
    try {
      check_format(parse_yaml_document(text, "f"), "f", "scene", 1);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  CHECK(check("format: scene\nversion: 1\n").empty());
  CHECK(check("format: scene\nversion: 99\n").starts_with("f:2:10: error E0546: version 99"));
  CHECK(check("format: scene\n").starts_with("f:1:1"));
  CHECK(check("format: scene\nversion: 1.0\n").starts_with("f:2:10"));
  CHECK(check("format: sensor-model\nversion: 1\n").starts_with("f:1:9"));
  CHECK(check("hello").starts_with("f:1:1"));
}
