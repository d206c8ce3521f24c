#include <catch2/catch.hpp>

#include "libchar/core/file/output_files.hpp"
#include "libchar/core/text/text.hpp"

using namespace libchar;

TEST_CASE("a channel name never becomes a path") {
  CHECK(file_name_for("../../etc/x") == "_.._.._etc_x");
  CHECK(file_name_for("") == "_");
  CHECK(file_name_for("gyro_x") == "gyro_x");
  CHECK(file_name_for("a b:c\\d\ne") == "a_b_c_d_e");
}

TEST_CASE("letters of any script stay, what is invisible or no text does not") {
  CHECK(file_name_for("Beschleunigung ä") == "Beschleunigung_ä");
  CHECK(file_name_for("гироскоп Ω 加速度") == "гироскоп_Ω_加速度");
  CHECK(file_name_for("a\u202Eb\u00A0c\u200Bd") == "a_b_c_d");
  CHECK(file_name_for("a\xFF\xC3z") == "a__z");
}

TEST_CASE("the ends of each range of unusual characters become _, their neighbours stay") {
  const auto stays = [](std::uint32_t code) {
    std::string character;
    append_utf8(character, code);
    return file_name_for("x" + character) == "x" + character;
  };
  for (const std::uint32_t code : {0x80U, 0xA0U, 0xADU, 0x61CU, 0x1680U, 0x180EU, 0x2000U, 0x2010U, 0x206FU, 0x3000U,
                                   0xE000U, 0xF000U, 0xF8FFU, 0xFEFFU, 0xFFF0U, 0xFFFFU}) {
    INFO(std::hex << code);
    CHECK_FALSE(stays(code));
  }
  for (const std::uint32_t code : {0xA1U, 0xACU, 0xAEU, 0x61BU, 0x61DU, 0x167FU, 0x1681U, 0x180DU, 0x180FU, 0x1FFFU,
                                   0x2070U, 0x2FFFU, 0x3001U, 0xD7FFU, 0xF900U, 0xFEFEU, 0xFF00U, 0xFFEFU}) {
    INFO(std::hex << code);
    CHECK(stays(code));
  }
  for (const char* character : {"x\U00010000", "x\U000DFFFF"}) CHECK(file_name_for(character) == character);
  for (const char* character : {"x\U000E0000", "x\U0010FFFF"}) CHECK(file_name_for(character) == "x_");
}

TEST_CASE("names are cut to 100 bytes between characters") {
  for (int shift = 0; shift < 4; ++shift) {
    std::string name(static_cast<std::size_t>(shift), 'x');
    for (int i = 0; i < 60; ++i) name += "加";
    const std::string file = file_name_for(name);
    CHECK(file.size() <= 100);
    CHECK(file.size() >= 97);
    CHECK(first_invalid_utf8(file) == std::string_view::npos);
  }
}

TEST_CASE("two channels never share a file, on file systems that ignore capitals too") {
  std::set<std::string> taken;
  CHECK(unused_file_name_for("a/b", taken) == "a_b");
  CHECK(unused_file_name_for("a b", taken) == "a_b_2");
  CHECK(unused_file_name_for("A:B", taken) == "A_B_3");
  CHECK(unused_file_name_for("a_b_2", taken) == "a_b_2_2");
  CHECK(unused_file_name_for("Ä", taken) == "Ä");
  CHECK(unused_file_name_for("ä", taken) == "ä_2");
  CHECK(unused_file_name_for("ж", taken) == "ж");
  CHECK(unused_file_name_for("Ж", taken) == "Ж_2");
  const std::string long_name(150, 'q');
  CHECK(unused_file_name_for(long_name, taken) == std::string(100, 'q'));
  CHECK(unused_file_name_for(long_name + "r", taken) == std::string(98, 'q') + "_2");
  CHECK(taken.size() == 10);
}
