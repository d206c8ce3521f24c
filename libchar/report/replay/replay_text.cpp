#include "libchar/report/replay/replay_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/replay/view/algorithm_words.hpp"
#include "libchar/report/detail/html/alignment_pieces.hpp"
#include "libchar/report/detail/replay_words.hpp"
#include "libchar/report/detail/tables/replay_tables.hpp"

namespace libchar {
std::string replay_text(const ReplayView& view, std::size_t width) {
  std::string text = printable(view.title) + ": ";
  for (const std::string& fact : run_facts(view)) text += printable(fact) + "\n";
  text += "\n" + terminal_table(algorithms_table(view), {width}, "") + kStarNote + "\n";
  for (const std::string& skipped : skipped_words(view))
    text += "skipped " + printable(skipped) + "\n";
  text += alignment_text(view, {width});
  text += "\n" + printable(fmt::format("{}", fmt::join(view.shown_verdict, " "))) + "\n";
  return text;
}

namespace {

std::string option_text(const fusion::Option& option) {
  return fmt::format("{:<28}   {} = {}{}  {}\n",
                     "",
                     option.name,
                     brief_text(option.standard, 6),
                     option.unit.empty() ? "" : " " + std::string(option.unit),
                     option.meaning);
}

}  // namespace

std::string algorithms_text() {
  std::string text;
  std::vector<std::string_view> watched;
  std::span<const fusion::Option> watching;
  for (const fusion::Entry& entry : fusion::algorithms()) {
    if (entry.own_options < entry.options.size()) {
      watched.push_back(entry.description->name);
      watching = entry.options.subspan(entry.own_options);
    }
    text += fmt::format("{:<28} {}\n", entry.description->name, entry.description->title);
    for (const std::string& need : needs_in_words(*entry.description))
      text += fmt::format("{:<28}   needs {}\n", "", need);
    for (const fusion::Option& option : entry.options.first(entry.own_options))
      text += option_text(option);
  }
  if (watched.empty()) return text;
  text += fmt::format("\n  beside their own options {} have\n", fmt::join(watched, ", "));
  for (const fusion::Option& option : watching) text += option_text(option);
  return text;
}

}  // namespace libchar
