// The smallest verb, for the test that one file is all a verb takes.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "verb.hpp"

namespace sensorchar {
namespace {

struct CountWords {
  std::vector<std::string> words;
  bool json = false;
};

void run_count_words(const Session& session, const CountWords& verb) {
  if (!verb.json) return print(fmt::format("{}\n", verb.words.size()));
  libchar::Json document = document_head(session, "words", {});
  document["words"] = verb.words.size();
  print(libchar::dump_json(document));
}

std::function<void()> add_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<CountWords>();
  options.add_texts("WORD", verb->words, "words to count");
  options.add_flag("--json", verb->json, "one JSON document");
  return [&session, verb] { run_count_words(session, *verb); };
}

}  // namespace

VerbEntry verb_count_words() { return {11, "count-words", "How many words there are", add_options}; }

}  // namespace sensorchar
