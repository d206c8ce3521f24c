#include "libchar/report/replay/replay_markdown.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html/alignment_pieces.hpp"
#include "libchar/report/detail/replay_words.hpp"
#include "libchar/report/detail/tables/replay_tables.hpp"

namespace libchar {
namespace {

std::string section(const char* head, const Table& table) {
  return table.rows.empty() ? "" : fmt::format("\n## {}\n\n", head) + table_text(table);
}

std::string several_inputs(const ReplayView& view) {
  std::string out;
  for (const Table& table : input_tables(view)) out += "\n" + table_text(table);
  return out;
}

std::string faults_section(const ReplayView& view) {
  if (view.result->faults.empty()) return "";
  const Table detection = detection_table(view);
  return section("Faults", faults_table(view)) +
         (detection.rows.empty() ? "" : "\n" + table_text(detection));
}

std::string markdown_list(const char* head, const std::vector<std::string>& items) {
  std::string out;
  for (const std::string& item : items) out += "- " + markdown_text(item) + "\n";
  return out.empty() ? "" : fmt::format("\n## {}\n\n", head) + out;
}

std::vector<std::string> warning_words(const ReplayView& view) {
  std::vector<std::string> out;
  const auto add = [&](const std::string& of, const Findings& warnings) {
    for (const Finding& w : warnings.list())
      out.push_back(of + w.sentence + (w.count > 1 ? fmt::format(" ({} ×)", w.count) : ""));
  };
  add("", view.result->warnings);
  for (const LogInfo& log : view.result->logs) add(log.file + ": ", log.warnings);
  for (std::string& remark : remark_words(view)) out.push_back(std::move(remark));
  return out;
}

}  // namespace

std::string replay_markdown(const ReplayView& view) {
  std::string out =
      fmt::format("# {}\n\n{}\n\n",
                  markdown_text(view.title),
                  markdown_text(fmt::format("{}", fmt::join(view.shown_verdict, " "))));
  out += markdown_text(fmt::format("{}", fmt::join(run_facts(view), " "))) + "\n\n" +
         table_text(algorithms_table(view)) + "\n" + markdown_text(kStarNote) + "\n";
  return out + markdown_list("Skipped", skipped_words(view)) + several_inputs(view) +
         alignment_markdown(view) + section("Sensors", sensors_table(view)) + faults_section(view) +
         markdown_list("Warnings", warning_words(view));
}

std::string replay_markdown(const ReplayResult& result) {
  return replay_markdown(replay_view(result));
}

}  // namespace libchar
