#include "libchar/core/text/text.hpp"

#include <catch2/catch.hpp>
#include <cctype>
#include <cstring>
#include <limits>

#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/spelling.hpp"

using namespace libchar;

TEST_CASE("printable escapes everything a terminal would obey") {
  CHECK(printable("plain °/√h") == "plain °/√h");
  CHECK(printable("a\x1b[31mb\n") == "a\\x1B[31mb\\n");
  CHECK(printable("a\xE2\x80\xAE"
                  "b") == "a\\u{202E}b");
  CHECK(printable("\xB0") == "\\xB0");
  CHECK(printable("\xC2\x9B") == "\\x9B");
  CHECK(printable("abcdef", 3) == "abc…");
}

TEST_CASE("the first and the last of each range of invisible characters are escaped") {
  struct Row {
    const char *text, *shown;
  };
  for (const Row& row :
       {Row{"\x1F", "\\x1F"},       Row{"\x20", "\x20"},        Row{"\x7E", "\x7E"},        Row{"\x7F", "\\x7F"},
        Row{"\u009F", "\\x9F"},     Row{"\u00A0", "\u00A0"},    Row{"\u0100", "\u0100"},    Row{"\u061C", "\\u{061C}"},
        Row{"\u200A", "\u200A"},    Row{"\u200B", "\\u{200B}"}, Row{"\u200F", "\\u{200F}"}, Row{"\u2010", "\u2010"},
        Row{"\u2027", "\u2027"},    Row{"\u2028", "\\u{2028}"}, Row{"\u202E", "\\u{202E}"}, Row{"\u202F", "\u202F"},
        Row{"\u2060", "\\u{2060}"}, Row{"\u2069", "\\u{2069}"}, Row{"\u206A", "\u206A"},    Row{"\uFEFF", "\\u{FEFF}"}})
    CHECK(printable(row.text) == row.shown);
}

TEST_CASE("a word of a shell is bare only where a shell takes it as it is") {
  CHECK(shell_word("") == "''");
  CHECK(shell_word("it's") == "'it'\\''s'");
  for (int c = 1; c < 128; ++c) {
    if (c == '\'') continue;
    const bool bare = std::isalnum(c) != 0 || std::strchr("_-./:,+=@%", c) != nullptr;
    const std::string word = std::string("a") + static_cast<char>(c);
    INFO(c);
    CHECK(shell_word(word) == (bare ? word : "'" + word + "'"));
  }
}

TEST_CASE("numbers read back to the same double, in YAML as numbers") {
  CHECK(shortest(0.1) == "0.1");
  CHECK(shortest_yaml(200) == "200.0");
  CHECK(shortest_yaml(1e-5) == "1.0e-05");
  CHECK(parse_double(shortest(1.0 / 3)) == 1.0 / 3);
  for (const char* bad : {"1,5", "0x1p3", "1.5abc", "1e400", "1e-400", "", " 1", "+1", "nan", "inf"})
    CHECK_FALSE(parse_double(bad));
}

TEST_CASE("spelling help finds slips, not strangers") {
  CHECK(nearest("gyro_y", {"gyro_x", "accel_x"}) == "gyro_x");
  CHECK(nearest("chanels", {"channels", "offset"}) == "channels");
  CHECK_FALSE(nearest("temperature", {"x", "y"}));
  CHECK(edit_distance("ab", "ba") == 1);
}
