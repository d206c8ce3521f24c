#include "libchar/core/document/enum_table.hpp"

#include <catch2/catch.hpp>

namespace {
enum class Fruit { apple, pear, none };
enum class Bare { a };
enum class Side { one, two, both };
}  // namespace

template <>
inline constexpr auto libchar::enum_table<Fruit> = std::to_array<libchar::EnumWord<Fruit>>({{Fruit::pear, "pear"},
                                                                                            {Fruit::apple, "apple"}});

template <>
inline constexpr auto libchar::enum_table<Side> = libchar::enum_words<Side, "one-sided two both">;

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

TEST_CASE("words in the order of the enum are one text") {
  STATIC_REQUIRE(enum_table<Side>.size() == 3);
  STATIC_REQUIRE(name_of(Side::one) == "one-sided");
  STATIC_REQUIRE(find_enum<Side>("both") == Side::both);
  CHECK(words_of<Side>() == std::vector<std::string>{"one-sided", "two", "both"});
}
