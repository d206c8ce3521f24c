#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <span>

#include "help/flag_names.hpp"
#include "help/generate.hpp"
#include "libchar/core/parallel/thread_limit.hpp"
#include "libchar/core/process/free_memory.hpp"
#include "libchar/core/process/version.hpp"
#include "verb.hpp"

namespace {
constexpr std::size_t kPageColumns = 100;  ///< of help that is not for a terminal
}

int main(int argc, char** argv) {
  using namespace sensorchar;
  libchar::detail::keep_freed_blocks();
  take_closed_streams();
  install_signal_handlers();
  std::set_terminate(end_in_a_sentence);
  end_aborts_in_a_sentence();
  Session session;
  const std::span<char*> words(argv, static_cast<std::size_t>(argc));
  // Small enough that nothing has to be taken from the heap before somebody watches.
  struct Call {
    Session& session;
    std::span<char*> words;
  } const call{session, words};
  return exit_code_of(session, [&call] {
    call.session.command.assign(call.words.begin(), call.words.end());
    libchar::keep_to_threads_given();
    CommandLine line(
        "sensorchar", "Measure sensor noise, export noise models and compare sensor fusion, from recordings.",
        fmt::format("sensorchar {} ({})", libchar::version(), libchar::build()), "Begin with: sensorchar inspect LOG");
    std::vector<std::string> names;
    for (const VerbEntry& verb : verbs()) names.push_back(verb.name);
    const std::vector<std::string> command = with_joined_verb(call.session.command, names);
    // The options of the verb that is named; of all where a page or a refusal may show them.
    const bool one = command.size() > 1 && std::find(names.begin(), names.end(), command[1]) != names.end();
    for (const VerbEntry& verb : verbs())
      if (!one || verb.name == command[1]) line.add(verb, call.session);
    ProgramUsage usage = line.usage();
    usage.released = SENSORCHAR_RELEASED;
    const auto page = generated(usage, command, columns_of_stdout().value_or(kPageColumns));
    if (page) return print(*page);
    for (const VerbUsage& verb : usage.verbs)
      if (command.size() > 1 && verb.name == command[1])
        for (const OptionUsage& option : verb.options)
          call.session.flags.insert(option.flags.begin(), option.flags.end());
    set_flags_of_verb(call.session.flags);
    set_memory_hint(call.session);
    if (const auto text = line.run(call.session.command)) print(*text);
  });
}
