#include "libchar/core/document/enum_table.hpp"

#include <catch2/catch.hpp>

namespace {
enum class Fruit { apple, pear, none };
enum class Bare { a };
}  // namespace

template <>
inline constexpr auto libchar::enum_table<Fruit> =
    libchar::enum_words<Fruit>({{Fruit::pear, "pear"}, {Fruit::apple, "apple"}});

using namespace libchar;

TEST_CASE("an enum's table gives its words, in the order of the rows, and back") {
  CHECK(words_of<Fruit>() == std::vector<std::string>{"pear", "apple"});
  CHECK(name_of(Fruit::apple) == "apple");
  CHECK(name_of(Fruit::none).empty());
  CHECK(find_enum<Fruit>("pear") == Fruit::pear);
  CHECK_FALSE(find_enum<Fruit>("Pear"));
  CHECK_FALSE(find_enum<Fruit>(""));
  STATIC_REQUIRE(EnumWithTable<Fruit>);
  STATIC_REQUIRE_FALSE(EnumWithTable<Bare>);
  STATIC_REQUIRE_FALSE(EnumWithTable<int>);
}
