// Kinds of findings: the table is whole; counted findings merge; the worst come first.

#include "libchar/core/finding.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

using namespace libchar;

TEST_CASE("findings: the table is in the order of its codes, and each says what it is") {
  const auto kinds = finding_kinds();
  REQUIRE(kinds.size() > 100);
  CHECK(std::is_sorted(kinds.begin(), kinds.end(),
                       [](const FindingKind& a, const FindingKind& b) { return a.code < b.code; }));
  for (const FindingKind& kind : kinds) {
    CAPTURE(kind.code);
    CHECK_FALSE(kind.title.empty());
    CHECK(kind.meaning.ends_with('.'));
    CHECK((kind.remedy.empty() || kind.remedy.ends_with('.')));
    CHECK(find_finding_kind(kind.code) == &kind);
    // What is no mere note changes something, or says what to do.
    if (kind.severity == Severity::bad)
      CHECK_FALSE((kind.effects.empty() && kind.code != "no_fit" && kind.code != "no_value"));
  }
  CHECK(find_finding_kind("no such thing") == nullptr);
}

TEST_CASE("findings: severity and effects come from the code, the phrase from the sentence") {
  const Finding held = finding("held_values", "Each value is recorded 7 times.");
  CHECK(held.severity == Severity::caution);
  CHECK(held.phrase == "each value is recorded 7 times");
  REQUIRE(held.effects.size() == 1);
  CHECK(held.effects[0] == Finding::Effect{Affected::white, Direction::too_large});
}

TEST_CASE("findings: cases of one code are counted, with their first three places") {
  Findings a, b;
  a.add("gap", "gaps in the stamps", "line 1");
  a.add("gap", "other words", "line 2", 3);
  b.add("jitter", "stamps scatter");
  b.add("gap", "gaps", "line 9");
  b.add("gap", "gaps", "line 10");
  a.merge(b);
  REQUIRE(a.list().size() == 2);
  CHECK(a.find("gap")->count == 6);
  CHECK(sentence_of(*a.find("gap")) == "6 × gaps in the stamps (first: line 1, line 2, line 9)");
  CHECK(a.find("backward_timestamp") == nullptr);
}

TEST_CASE("findings: what was said of a case is not lost where records are merged") {
  Findings reader, whole;
  reader.add("jitter", "stamps scatter").severity = Severity::bad;
  whole.merge(reader);
  CHECK(whole.find("jitter")->severity == Severity::bad);
  reader.add("gap", "gaps").where.time_s = {{1, 2}};
  Findings other;
  other.add("jitter", "stamps scatter");
  other.merge(reader);
  CHECK(other.find("jitter")->severity == Severity::bad);
  CHECK(other.find("jitter")->count == 2);
  CHECK(other.find("gap")->where.time_s.size() == 1);
}

TEST_CASE("findings: the worst first, in their order otherwise") {
  const std::vector<Finding> all =
      worst_first({finding("gap", "a"), finding("motion", "b"), finding("no_fit", "c"), finding("spiky", "d")});
  CHECK(all[0].code == "no_fit");
  CHECK(all[1].code == "motion");
  CHECK(all[2].code == "spiky");
  CHECK(worst_of(all) == Severity::bad);
  CHECK(worst_of({}) == Severity::note);
}

TEST_CASE("findings: a cell of a table carries what is no note, and reads back") {
  Finding motion = finding("motion", "It moved at 3 s."), resampled = finding("held_values", "Held.");
  motion.severity = Severity::bad;
  resampled.severity = Severity::caution;
  const std::vector<Finding> known = {finding("blank_line", "Blank."), motion, resampled, resampled};
  CHECK(detail::findings_cell(known) == "motion:bad held_values:caution");
  CHECK(detail::findings_cell({}).empty());
  const std::vector<Finding> read = detail::findings_in_cell("motion:bad held_values:caution");
  REQUIRE(read.size() == 2);
  CHECK(read[0].severity == Severity::bad);
  CHECK(read[0].effects == motion.effects);
  CHECK(read[1].severity == Severity::caution);
  CHECK(detail::findings_cell(read) == "motion:bad held_values:caution");
  for (const char* other : {"", "none", "motion", "motion:worse", ":bad", "see page 3", "no_such_code:bad"})
    CHECK(detail::findings_in_cell(other).empty());
  const std::string asked = detail::findings_in_cell("missing_mark:bad")[0].sentence;
  CHECK(asked.find("values? One") != std::string::npos);
  std::vector<Finding> all;
  detail::add_cautions(all, known, "gx");
  detail::add_cautions(all, known, "gx");
  REQUIRE(all.size() == 2);
  CHECK(all[0].subject == "gx");
}
