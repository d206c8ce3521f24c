#pragma once
// The command line in a few functions. Only command_line.cpp knows the parser behind them:
// its templates are compiled there once, not in every verb.

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/enum_table.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace sensorchar {

struct Session;
struct VerbEntry;

/// An option or argument that was added, for what is said about few of them.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}
  Option& required();
  /// The heading in the help under which it stands.
  Option& group(const std::string& heading);
  /// What stands for its value in the help ("FILE").
  Option& value_name(const std::string& name);
  /// Lists: one value after each flag, which may hold several separated by commas.
  Option& separated_by_commas();
  /// Lists: exactly one value after each flag.
  Option& one_value_each();
  Option& excludes(const Option& other);

 private:
  CLI::Option* option_;
};

/// The options of one verb. Names are "FILE" (an argument by its place), "--force", or "-o,--output".
/// Variables must live until the verb has run, and keep their value where an option is not given;
/// defaults must stand in `help`. What an option refuses is Error(usage) that names the option.
class VerbOptions {
 public:
  explicit VerbOptions(CLI::App& app) : app_(&app) {}

  Option add_flag(const std::string& names, bool& value, const std::string& help);
  Option add_text(const std::string& names, std::string& value, const std::string& help);
  Option add_texts(const std::string& names,
                   std::vector<std::string>& values,
                   const std::string& help);
  /// `read` gets the text; `value_name` stands for it in the help.
  Option add_parsed(const std::string& names,
                    const std::string& value_name,
                    std::function<void(const std::string&)> read,
                    const std::string& help);
  Option add_number(const std::string& names,
                    std::optional<double>& value,
                    const std::string& help,
                    double lowest = -std::numeric_limits<double>::max(),
                    double highest = std::numeric_limits<double>::max());
  Option add_number(const std::string& names,
                    double& value,
                    const std::string& help,
                    double lowest = -std::numeric_limits<double>::max(),
                    double highest = std::numeric_limits<double>::max());
  Option add_count(const std::string& names,
                   std::uint64_t& value,
                   const std::string& help,
                   std::uint64_t lowest = 0,
                   std::uint64_t highest = std::numeric_limits<std::uint64_t>::max());
  /// Seconds ("90", "1.5h").
  Option add_duration(const std::string& names,
                      std::optional<double>& seconds,
                      const std::string& help);
  /// Hertz ("200", "1.5kHz").
  Option add_rate(const std::string& names, std::optional<double>& hertz, const std::string& help);
  /// Bytes ("4096", "64KiB").
  Option add_bytes(const std::string& names, std::uint64_t& bytes, const std::string& help);
  /// A value of an enum by its word (core/enum_table.hpp).
  template <libchar::EnumWithTable Enum>
  Option add_enum(const std::string& names, Enum& value, const std::string& help) {
    return add_word(names, libchar::words_of<Enum>(), help, [&value](const std::string& word) {
      value = *libchar::find_enum<Enum>(word);
    });
  }
  /// One of a few words; a wrong one is refused with the nearest right one.
  Option add_choice(const std::string& names,
                    std::string& value,
                    std::vector<std::string> words,
                    const std::string& help);

 private:
  Option add_word(const std::string& names,
                  std::vector<std::string> words,
                  const std::string& help,
                  std::function<void(const std::string&)> use);

  CLI::App* app_;
};

/// A program with verbs.
class CommandLine {
 public:
  /// `footer` is the last line of the help.
  CommandLine(const std::string& program,
              const std::string& what,
              const std::string& version,
              const std::string& footer);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// Adds a verb with its options and those that every verb has (--quiet).
  void add(const VerbEntry& verb, Session& session);
  /// Parses argv and runs the verb that was chosen. Returns what is to be printed instead (--help,
  /// --version), or nothing. Throws Error(usage) for what cannot be understood, and whatever the
  /// verb throws.
  std::optional<std::string> run(const std::vector<std::string>& argv);

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace sensorchar
