#pragma once
// Tables and lists of a page, their texts escaped.

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/characterize/characterization_view.hpp"
#include "libchar/characterize/judgement.hpp"
#include "libchar/characterize/limits.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/table/table.hpp"
#include "libchar/core/text/markup.hpp"
#include "libchar/core/text/text_table.hpp"
#include "libchar/log/recording.hpp"
#include "libchar/lot/device_record.hpp"
#include "libchar/replay/view/replay_view.hpp"
#include "libchar/report/detail/tables/coefficients.hpp"

namespace libchar {
// Untrusted text (channel names, file names, cells) on its way into a page or a table: one function for each context.

/// For text between tags: & < > " ' become entities; control, bidirectional and zero-width
/// characters and bytes that are not UTF-8 become visible escapes.
std::string html_text(std::string_view text);
/// A sentence: options in backticks (`still`) become code.
std::string html_prose(std::string_view text);

/// For a value inside double quotes of a tag: as html_text, and nothing else may stand there unquoted.
std::string html_attribute(std::string_view text);

/// A folder or file relative to the page, for an address inside double quotes of a tag: what is no letter, digit or one
/// of -._~ becomes %HH, so that no part of a name is a scheme, a host, a query or a fragment.
std::string html_address(std::string_view path);

/// A document for the inside of <script type="application/json">: '<', '>' and '&' as \u003c…, so that neither
/// "</script>" nor "<!--" can end or change the element, and everything beyond ASCII escaped.
std::string json_in_script(const Json& document);

/// For the inside of an HTML comment: "--" cannot occur, so the comment ends where we end it.
std::string html_comment(std::string_view text);

namespace detail {

/// Of a recording: gaps of its stamps, the samples in them, and the most samples that one channel lacks.
struct MissingSamples {
  std::uint64_t gaps = 0, in_gaps = 0, of_a_channel = 0;
};
/// "1 gap, 1 001 samples missing", "no gaps in time, up to 4 samples of a channel missing"; numbers within the tags.
std::string missing_text(const MissingSamples& missing, std::string_view open = "", std::string_view close = "");

}  // namespace detail

/// How a table stands on a page.
struct PageTable {
  const char* css = "";
  bool cards = false;     ///< its css has "cards": on a narrow screen a row is values behind heads
  bool sorted = false;    ///< its script sorts by the numbers
  std::size_t most = 0;   ///< rows shown; 0: all
  std::size_t of = 0;     ///< rows that there are, beside those that were made; 0: none
  const char* rest = "";  ///< file beside the page that has all of them
};

/// Title, table and note. Heads begin with a capital, but names stay as they are; a table whose heads are all empty has
/// none.
std::string html_table(const Table& table, const PageTable& look = {});

/// As many as a page has of a list of any length: a table has no more rows.
template <class T>
std::span<const T> first_of(const std::vector<T>& all, std::size_t most) {
  return std::span(all).first(std::min(most, all.size()));
}

/// What can be unfolded; `summary` is HTML, escaped already.
std::string folded(const std::string& summary, const std::string& body, bool open = false);
/// A word in the colour of what it says.
std::string html_chip(std::string_view word, std::optional<Tint> tint);
/// "✓ good", "! caution", "✗ do not use": with its colour a sign and a word.
std::string rating_badge(Rating rating);
std::string_view rating_sign(Rating rating);
/// The worst first, with their help; those behind the fifth can be unfolded. Nothing where there is none.
std::string findings_list(const std::vector<Finding>& findings);
/// "<ul>…": nothing when there is no item.
std::string bullet_list(const std::vector<std::string>& items, std::string_view css_class);

// The frame of every page: one file that carries its data, scripts and styles, and asks for nothing from anywhere.
//
// The content security policy names each script and the style by its SHA-256, so that nothing else
// can run even if an escape were forgotten.

struct PageParts {
  std::string title;    ///< what kind of report
  std::string subject;  ///< of what: a file's or scene's name, untrusted
  std::string script;   ///< goes behind page_common.js
  std::string style;
  bool all_numbers = true;  ///< its data are the whole document: it can be saved from the page
};

/// The whole page: `body` is HTML, `data` the document for its script (json_in_script).
std::string html_page(const PageParts& parts, const std::string& body, const std::string& data);

/// As a shell wants it typed: words quoted where they need it.
std::string command_line(const std::vector<std::string>& command);
/// <details> with a document, "" when there is none.
std::string settings_details(const Json& document);
/// Commands to go on with.
std::string next_part(const std::vector<std::string>& commands);
/// Rows of a table of facts: file, format, size and digest of an input; program and command.
void add_input_file(Table& facts, const LogInfo& log);
void add_program(Table& facts, const std::vector<std::string>& command);
Cell digest_cell(const LogInfo& log);
/// "Repairs and warnings": a table by kind, or "None."
std::string warnings_part(const Findings& warnings);

// Empty figures that page.js draws into.

struct PlotText {
  std::string title, axis, unit, caption;  ///< `axis`: short, the title says it in full
};

/// An empty figure for page.js to draw `kind` into.
std::string plot_figure(const char* kind, std::size_t index, const PlotText& text, const std::string& channel);
/// The same of several channels, by their indices.
std::string plot_figure(const char* kind, const std::vector<std::size_t>& indices, const PlotText& text,
                        const std::string& of);

/// The record in time, with what was found in it; "" where no samples are.
std::string trace_plot(const ChannelView& channel, std::size_t index, const LogInfo& log);

/// The Allan curves of a group in one figure; "" where there are none.
std::string group_plot(const CharacterizationView& view, const ChannelGroup& group);

/// The Allan and spectrum figures of a channel, as far as there is something to draw.
std::string curve_plots(const ChannelView& channel, std::size_t index);

// What the reports of several recordings share (runs of a sensor, a lot of devices).

/// A table of channels, its first column the name of what they are recorded in.
Table channels_table(const char* recordings);
/// A row a channel.
void add_channels(Table& table, const DeviceRecord& record, const std::string& name);

/// The name, with a link to the page in that folder, relative to this one ("": none).
Cell report_cell(const std::string& name, const std::string& folder);

/// Input files with their hashes, where they are in memory; the command.
std::string many_provenance(std::span<const Characterization> recordings, const std::vector<std::string>& command);

/// The head of a document about them, with their settings.
Json many_head(const std::string& format, std::span<const Characterization> recordings,
               const std::vector<std::string>& command);

// The judgement of limits as each output shows it.

/// A section of the page.
std::string limits_section(const LimitReport& report);

// The alignment and the error budget of a replay, in each of its reports; "" without an alignment.

std::string alignment_text(const ReplayView& view, const TextLook& look);
std::string alignment_markdown(const ReplayView& view);
std::string alignment_html(const ReplayView& view);

}  // namespace libchar
