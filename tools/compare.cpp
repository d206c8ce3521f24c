// sensorchar compare A.json B.json: two replay reports side by side, for people and for continuous
// integration.

#include <algorithm>
#include <memory>

#include "libchar/core/error.hpp"
#include "libchar/core/sha256.hpp"
#include "libchar/core/text.hpp"
#include "libchar/model/model_reader.hpp"
#include "libchar/report/comparison.hpp"
#include "verbs.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct CompareVerb {
  std::string a, b;
  std::vector<std::string> checks;
  bool unlike = false, json = false, markdown = false;
};

LogInfo as_input(const std::string& file, const std::string& text) {
  LogInfo out;
  out.file = file;
  Sha256 hash;
  hash.update(text);
  out.sha256 = hash.finish();
  out.bytes = text.size();
  return out;
}

void refuse_unlike(const Comparison& c) {
  if (c.differences.empty()) return;
  const std::size_t more = c.differences.size() - 1;
  throw Error(
      {ErrorKind::input,
       "E0923",
       c.b.file,
       c.differences[0] + (more == 0 ? "" : " (and " + std::to_string(more) + " more differences)"),
       "",
       "errors of unlike scenes say nothing about algorithms; --unlike compares them all the "
       "same"});
}

std::string text_for_people(const Comparison& c) {
  std::string out = "A: " + printable(c.a.file) + " (" + printable(c.a.scene) +
                    ")\nB: " + printable(c.b.file) + " (" + printable(c.b.scene) + ")\n";
  for (const std::string& sentence : c.differences) out += "unlike: " + printable(sentence) + "\n";
  auto rows = comparison_table(c);
  for (auto& row : rows)
    for (std::string& cell : row) cell = printable(cell);
  out += "\n" + table(rows);
  const auto add = [&](const auto& list, const char* where) {
    for (const auto& [label, why] : list)
      out += printable(label) + " ran in " + where + " only" +
             (why.empty() ? "" : ": " + printable(why)) + "\n";
  };
  add(c.only_a, "A");
  add(c.only_b, "B");
  return out;
}

void run_compare(Session& session, const CompareVerb& verb) {
  std::vector<Check> checks;
  for (const std::string& text : verb.checks) checks.push_back(check_from_words(text));
  if (verb.json && verb.markdown)
    throw Error(
        {ErrorKind::usage, "E0205", "--markdown", "does not go with --json", "", "choose one"});
  const std::string text_a = read_document_text(verb.a), text_b = read_document_text(verb.b);
  const Comparison comparison =
      compare_replays(read_reported_replay(text_a, verb.a), read_reported_replay(text_b, verb.b));
  if (!verb.unlike) refuse_unlike(comparison);
  if (verb.json) {
    const LogInfo a = as_input(verb.a, text_a), b = as_input(verb.b, text_b);
    Json out = document_head(session, "replay-comparison", {&a, &b});
    out.update(comparison_json(comparison, checks));
    print(dump_json(out));
  } else {
    print(verb.markdown ? comparison_markdown(comparison, checks) : text_for_people(comparison));
  }
  std::vector<std::string> all;
  for (const Check& check : checks)
    for (const std::string& sentence : breaches(comparison, check)) all.push_back(sentence);
  if (all.empty()) return;
  for (std::size_t i = 1; i < all.size(); ++i) say("sensorchar: " + printable(all[i]));
  throw Error({ErrorKind::check, "E0925", "--fail-if", all[0], "", ""});
}

}  // namespace

void add_compare(CLI::App& app, Session& session) {
  const auto verb = std::make_shared<CompareVerb>();
  CLI::App* sub = add_verb(app,
                           session,
                           "compare",
                           "Two reports of replay side by side; refuses unlike scenes",
                           [&session, verb] { run_compare(session, *verb); });
  sub->add_option("A", verb->a, "report.json of a replay, the baseline")->required();
  sub->add_option("B", verb->b, "report.json of a replay, what is compared with it")->required();
  sub->add_option(
         "--fail-if",
         verb->checks,
         "exit with 6 when B exceeds A by more: [LABEL:]METRIC+LIMIT, METRIC one of rmse, "
         "regret, ns_per_sample, peak_bytes, LIMIT in % or absolute (\"rmse+5%\"); may be repeated")
      ->type_name("CHECK")
      ->allow_extra_args(false);
  sub->add_flag("--unlike", verb->unlike, "compare unlike scenes all the same");
  sub->add_flag("--json", verb->json, "print one JSON document instead of the table");
  sub->add_flag("--markdown", verb->markdown, "print Markdown, for a pull request");
}

}  // namespace sensorchar
