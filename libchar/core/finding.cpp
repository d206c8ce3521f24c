#include "libchar/core/finding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <set>

#include "libchar/core/detail/finding_table.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/text/text_table.hpp"

namespace libchar {
namespace {

std::vector<std::string_view> split(std::string_view text, std::string_view by) {
  std::vector<std::string_view> out;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(by, at), text.size());
    out.push_back(text.substr(at, end - at));
    at = end + by.size();
  }
  return out;
}

// "N:too-large, K"
std::vector<Finding::Effect> effects_in(std::string_view cell) {
  std::vector<Finding::Effect> out;
  if (cell.empty()) return out;
  for (const std::string_view part : split(cell, ", ")) {
    const std::vector<std::string_view> words = split(part, ":");
    Finding::Effect& effect = out.emplace_back(Finding::Effect{find_enum<Affected>(words[0]).value()});
    if (words.size() > 1) effect.direction = find_enum<Direction>(words[1]).value();
  }
  return out;
}

std::vector<FindingKind> kinds_in(std::string_view table) {
  std::vector<FindingKind> out;
  for (const std::string_view line : split(table, "\n")) {
    if (line.empty() || line[0] == '#') continue;
    const std::vector<std::string_view> cells = split(line, "\t");
    assert(cells.size() == 6);
    out.push_back(
        {cells[0], find_enum<Severity>(cells[1]).value(), cells[2], cells[3], cells[4], effects_in(cells[5])});
  }
  return out;
}

}  // namespace

std::span<const FindingKind> finding_kinds() {
  static const std::vector<FindingKind> kinds = kinds_in(finding_table());
  return kinds;
}

const FindingKind* find_finding_kind(std::string_view code) {
  const auto kinds = finding_kinds();
  const auto found =
      std::lower_bound(kinds.begin(), kinds.end(), code,
                       [](const FindingKind& kind, std::string_view wanted) { return kind.code < wanted; });
  return found != kinds.end() && found->code == code ? &*found : nullptr;
}

Finding finding(std::string_view code, std::string sentence, std::string phrase) {
  const FindingKind* kind = find_finding_kind(code);
  assert(kind != nullptr);
  Finding out;
  out.code = code;
  if (kind != nullptr) {
    out.severity = kind->severity;
    out.effects = kind->effects;
  }
  out.phrase = phrase.empty() ? as_part(sentence) : std::move(phrase);
  out.sentence = std::move(sentence);
  return out;
}

Severity worst_of(std::span<const Finding> findings) {
  Severity worst = Severity::note;
  for (const Finding& one : findings) worst = std::max(worst, one.severity);
  return worst;
}

bool has(std::span<const Finding> findings, std::string_view code) {
  return std::any_of(findings.begin(), findings.end(), [&](const Finding& one) { return one.code == code; });
}

std::vector<Finding> worst_first(std::vector<Finding> findings) {
  std::stable_sort(findings.begin(), findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
  return findings;
}

std::string as_part(const std::string& whole) {
  std::string sentence = whole;
  while (!sentence.empty() && sentence.back() == '.') sentence.pop_back();
  const auto is_in = [&](std::size_t i, char first, char last) {
    return sentence.size() > i && sentence[i] >= first && sentence[i] <= last;
  };
  if (is_in(0, 'A', 'Z') && is_in(1, 'a', 'z')) sentence[0] = static_cast<char>(sentence[0] - 'A' + 'a');
  return sentence;
}

void detail::add_cautions(std::vector<Finding>& to, std::span<const Finding> from, const std::string& subject) {
  for (Finding one : from) {
    one.subject = subject;
    if (one.severity != Severity::note && std::find(to.begin(), to.end(), one) == to.end())
      to.push_back(std::move(one));
  }
}

std::string detail::findings_cell(std::span<const Finding> findings) {
  std::string out;
  std::set<std::string_view> named;
  for (const Finding& one : findings)
    if (one.severity != Severity::note && named.insert(one.code).second)
      out += (out.empty() ? "" : " ") + one.code + ":" + std::string(name_of(one.severity));
  return out;
}

std::vector<Finding> detail::findings_in_cell(std::string_view cell) {
  std::vector<Finding> out;
  for (const std::string_view word : split(cell, " ")) {
    const std::size_t colon = std::min(word.find(':'), word.size());
    const FindingKind* kind = find_finding_kind(word.substr(0, colon));
    const auto severity = find_enum<Severity>(word.substr(std::min(colon + 1, word.size())));
    if (kind == nullptr || !severity) continue;
    const std::string title(kind->title), meaning(kind->meaning);
    const char* const stop = title.ends_with('?') ? "" : ".";
    out.push_back(
        finding(kind->code, fmt::format("In the recording of this curve: {}{} {}", title, stop, meaning), title));
    out.back().severity = *severity;
  }
  return out;
}

std::string settings_text(const Finding::Help& help) {
  std::string out;
  for (const Finding::Setting& one : help.options)
    out += (out.empty() ? " (`" : " `") + one.option + "` " + shell_word(one.value);
  return out.empty() ? out : out + ")";
}

namespace {

/// The remedies behind a sentence; `all`: those too that no option does.
std::string remedies_behind(const Finding& one, bool all) {
  std::string out;
  for (const Finding::Help& help : one.help) {
    if (!all && help.options.empty()) continue;
    const std::string& before = out.empty() ? one.sentence : out;
    std::string what = help.sentence;
    if (what.ends_with('.')) what.pop_back();
    out += (before.ends_with('.') || before.ends_with('?') ? " " : ". ") + printable(what + settings_text(help)) + ".";
  }
  return out;
}

}  // namespace

std::string with_help(const Finding& one) { return printable(one.sentence) + remedies_behind(one, true); }

std::string findings_text(std::span<const Finding> findings, std::size_t most, bool colours) {
  const std::vector<Finding> all = worst_first({findings.begin(), findings.end()});
  std::string out;
  for (std::size_t i = 0; i < std::min(most, all.size()); ++i) {
    const Severity severity = all[i].severity;
    const Tint tint = severity == Severity::bad       ? Tint::bad
                      : severity == Severity::caution ? Tint::doubtful
                                                      : Tint::absent;
    out += "  " + tinted(name_of(severity), tint, colours) + ": " + with_help(all[i]) + "\n";
  }
  if (all.size() > most) out += "  and " + plural(all.size() - most, "finding") + " more\n";
  return out;
}

std::string sentence_of(const Finding& one) {
  std::string line;
  if (one.count != 1) line = std::to_string(one.count) + " × ";
  line += printable(one.sentence);
  const std::vector<std::string>& rows = one.where.rows;
  if (!rows.empty()) {
    line += one.count > rows.size() ? " (first: " : " (";
    for (std::size_t i = 0; i < rows.size(); ++i) line += (i ? ", " : "") + printable(rows[i]);
    line += ")";
  }
  return line;
}

std::string detail::help_of(const Finding& one) { return remedies_behind(one, false); }

std::string one_line(const Finding& one, std::string_view file, bool colours) {
  const bool note = one.severity == Severity::note;
  return printable(file) + ": " + tinted(note ? "note" : "warning", note ? Tint::absent : Tint::doubtful, colours) +
         ": " + sentence_of(one) + detail::help_of(one);
}

Finding& Findings::entry(std::string_view code, std::string_view sentence) {
  const auto found = std::find_if(list_.begin(), list_.end(), [&](const Finding& one) { return one.code == code; });
  if (found != list_.end()) return *found;
  list_.push_back(finding(code, std::string(sentence)));
  list_.back().count = 0;
  return list_.back();
}

Finding& Findings::add(std::string_view code, std::string_view sentence, std::string_view place, std::uint64_t count) {
  Finding& one = entry(code, sentence);
  one.count += count;
  if (!place.empty() && one.where.rows.size() < 3) one.where.rows.emplace_back(place);
  return one;
}

void Findings::merge(const Findings& other) {
  for (const Finding& later : other.list_) {
    if (find(later.code) == nullptr) {
      list_.push_back(later);
      continue;
    }
    Finding& one = entry(later.code, later.sentence);
    one.count += later.count;
    one.severity = std::max(one.severity, later.severity);
    if (one.help.empty()) one.help = later.help;
    for (const std::string& row : later.where.rows)
      if (one.where.rows.size() < 3) one.where.rows.push_back(row);
  }
}

void Findings::remove(std::string_view code) {
  std::erase_if(list_, [&](const Finding& one) { return one.code == code; });
}

const Finding* Findings::find(std::string_view code) const {
  const auto found = std::find_if(list_.begin(), list_.end(), [&](const Finding& one) { return one.code == code; });
  return found == list_.end() ? nullptr : &*found;
}

}  // namespace libchar
