#pragma once
// The log formats: what each is called, which files it takes, what it can hold. Readers, writers, the command line,
// scenes and docs/formats.md go by this table; detail/format.hpp has the functions behind it.

#include <string>
#include <string_view>
#include <vector>

namespace libchar {

struct LogFormat {
  std::string_view name;   ///< the word for it in options: "csv"
  std::string_view title;  ///< as tables of formats list it: "CSV"
  std::string_view brief;  ///< its files in a help text; "" = the first suffix
  /// Files of this format by their name, whatever they hold.
  std::vector<std::string_view> suffixes = {};
  std::string_view otherwise;  ///< what else is taken for this format; "" = what looks like it
  /// Does a file hold them? "yes", "no", or where.
  std::string_view names = "yes", units = "yes", rate = "by stamps", start = "yes";
  /// Default for writing as this format; none = never written.
  std::vector<std::string_view> written_suffixes = {};
  bool writes_names = true;  ///< a file that is written says names and units of its channels
  bool writes_rate = false;  ///< … and its sampling rate
  /// … and has a column of stamps, unless `WriteOptions::time_column` is off.
  bool writes_stamps = false;
  bool topics = false;          ///< may hold several streams, each with a clock of its own
  bool time_sources = false;    ///< its messages may have several stamps (`ReadOptions::time_source`)
  bool text = false;            ///< a table of text, which has a dialect
  bool rows_at_places = false;  ///< a row can be read without those before it
  bool from_pipes = false;      ///< can be read from standard input and named pipes
};

/// ".csv, .npy, raw with sidecar": the files that are read, for help texts.
std::string readable_files();

/// What an option that names a format to read may say: "auto" and the names in alphabetical order.
std::vector<std::string> format_words();
/// The same for a format to write.
std::vector<std::string> written_format_words();

/// ".csv, .npy, .f64, .f32, .bin, .raw": the suffixes that say which format to write.
std::string written_suffixes();

}  // namespace libchar
