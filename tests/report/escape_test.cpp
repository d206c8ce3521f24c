#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "libchar/core/text/markup.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "tests/report/synthetic.hpp"

using namespace libchar;

TEST_CASE("text and attribute: no character that could leave its place survives") {
  CHECK(html_text("<img src=x onerror=alert(1)>") == "&lt;img src=x onerror=alert(1)&gt;");
  CHECK(html_attribute("\" onmouseover='x'") == "&quot; onmouseover=&#39;x&#39;");
  CHECK(html_text("a & b &lt;") == "a &amp; b &amp;lt;");
  CHECK(html_text("µ°√²·") == "µ°√²·");
  CHECK(html_text("a\xE2\x80\xAE"
                  "b") == "a\\u{202E}b");  // right-to-left override
  CHECK(html_text("bad\xFF") == "bad\\xFF");
  for (const std::string& name : test::hostile_names()) {
    CHECK(html_text(name).find_first_of("<>\"'") == std::string::npos);
    CHECK(html_attribute(name).find_first_of("<>\"'") == std::string::npos);
  }
}

TEST_CASE("prose: options in backticks are code, all else is text") {
  CHECK(html_prose("Use the stretch (`still` auto).") == "Use the stretch (<code>still</code> auto).");
  CHECK(html_prose("`from_s` and `to_s`") == "<code>from_s</code> and <code>to_s</code>");
  for (const char* plain : {"`", "``", "a ` b", "`A`", "`a b`", "`a", "a`"}) CHECK(html_prose(plain) == plain);
  CHECK(html_prose("`<b>`") == "`&lt;b&gt;`");
  for (const std::string& name : test::hostile_names())
    if (name.find('`') == std::string::npos) CHECK(html_prose(name) == html_text(name));
}

TEST_CASE("json in a script element: reads back to the same, and cannot end the element") {
  for (const std::string& name : test::hostile_names()) {
    const Json document = {{"name", json_text(name)}};
    const std::string inside = json_in_script(document);
    CHECK(inside.find_first_of("<>&") == std::string::npos);
    CHECK(inside.find("\xE2\x80\xA8") == std::string::npos);
    CHECK(Json::parse(inside) == document);
  }
}

TEST_CASE("csv cell: quoted as RFC 4180 says, and never a formula") {
  CHECK(csv_cell("gyr_x") == "gyr_x");
  CHECK(csv_cell("a,b") == "\"a,b\"");
  CHECK(csv_cell("say \"hi\"") == "\"say \"\"hi\"\"\"");
  CHECK(csv_cell("two\nlines") == "\"two\nlines\"");
  for (const char* start : {"=", "+", "-", "@", "\t"}) CHECK(csv_cell(std::string(start) + "1")[0] == '\'');
  CHECK(csv_cell("\r1") == "\"'\r1\"");
  CHECK(csv_cell("=HYPERLINK(\"x\")") == "\"'=HYPERLINK(\"\"x\"\")\"");
  CHECK(csv_cell("").empty());
}

TEST_CASE("html comment: only its own end ends it") {
  for (const char* text : {"a-->b", "a--!>b", "-----", "--"}) CHECK(html_comment(text).find("--") == std::string::npos);
  CHECK(html_comment("plain - text") == "plain - text");
}
