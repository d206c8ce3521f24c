#include "libchar/log/read.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "libchar/core/axis_name.hpp"
#include "libchar/core/file/log_files.hpp"
#include "libchar/core/process/work.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/quantity_text.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/channel_names.hpp"
#include "libchar/log/csv/head/other_content.hpp"
#include "libchar/log/csv/unpacker.hpp"
#include "libchar/log/detail/format.hpp"
#include "libchar/log/detail/unused_options.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/log/reading_fields.hpp"
#include "libchar/log/time/channel_rates.hpp"
#include "libchar/log/time/grid.hpp"

namespace libchar {
namespace {

std::string front_of(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) throw input_error("E0101", path).says(std::string("cannot open: ") + std::strerror(errno));
  struct stat status {};
  if (::fstat(descriptor, &status) == 0 && S_ISDIR(status.st_mode)) {
    ::close(descriptor);
    throw input_error("E0101", path)
        .says("is a folder, a file was expected")
        .hint(
            "of folders those of CSV files are read, and those of rosbag2, which have a metadata.yaml (ros2 bag "
            "reindex writes one)");
  }
  std::string bytes(4096, '\0');
  // Only of a regular file can the front be read twice.
  const ssize_t n = S_ISREG(status.st_mode) ? ::pread(descriptor, bytes.data(), bytes.size(), 0) : 0;
  ::close(descriptor);
  bytes.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
  return bytes;
}

// Of compressed files only text is read, whatever the name in front of ".gz" says; a name that says
// otherwise is refused.
const Format& packed_format(const std::string& path) {
  const Format* const text = find_format("csv");
  const Format* const named = format_by_suffix(path.substr(0, path.rfind('.')));
  if (named == nullptr || named == text) return *text;
  throw input_error("E0330", path)
      .says("compressed {} is not read, only compressed text is", named->about.name)
      .hint("unpack it first: gunzip, unzstd or unxz");
}

// A magic number decides before the name, and the name before what else the content looks like: a
// .csv that holds something else is told so by the CSV reader.
const Format& format_of(const std::string& path, const ReadOptions& options) {
  if (options.format != "auto") {
    if (const Format* format = find_format(options.format)) return *format;
    const auto words = format_words();
    throw usage_error("E0202", path)
        .says("unknown log format")
        .got(options.format)
        .hint("use {} or {}", fmt::join(words.begin(), words.end() - 1, ", "), words.back());
  }
  if (read_once(path)) {  // looking into a pipe takes from it
    for (const Format& format : formats())
      if (format.about.from_pipes) return format;
  }
  if (is_rosbag2(path)) return *find_format("rosbag2");
  if (detail::is_folder_of_tables(path)) return *find_format("tables");
  const std::string front = front_of(path);
  const csv::Packing packing = csv::packing_of(front);
  if (packing != csv::Packing::none && packing < csv::Packing::json) return packed_format(path);
  for (const Format& format : formats())
    if (format.certain != nullptr && format.certain(front)) return format;
  csv::refuse_document(front, path);
  if (const Format* format = format_by_suffix(path)) return *format;
  for (const Format& format : formats())
    if (format.sniff != nullptr && format.sniff(path, front)) return format;
  csv::refuse_other_format(front, path);
  const auto words = format_words();
  throw input_error("E0102", path)
      .says("neither text nor an array file, and no sidecar describes it")
      .hint("`format` {}, or write FILE.json (docs: raw binary)", fmt::join(words.begin() + 1, words.end(), "|"));
}

// What the user knows of the channels and the log does not say.
void name_channels(std::vector<Channel>& channels, const ReadOptions& options) {
  const auto refuse = [&](const char* flag, std::size_t count) {
    std::string read;
    for (std::size_t c = 0; c < std::min<std::size_t>(channels.size(), 12); ++c)
      read += (c == 0 ? "" : ", ") + channels[c].name;
    throw usage_error("E0205", flag)
        .says("{} given, and {} channel{} read: {}{}", count, channels.size(), channels.size() == 1 ? " is" : "s are",
              read, channels.size() > 12 ? ", …" : "")
        .hint("one for each channel that is read, in that order");
  };
  if (!options.names.empty() && options.names.size() != channels.size()) refuse("`names`", options.names.size());
  if (options.units.size() > 1 && options.units.size() != channels.size()) refuse("`units`", options.units.size());
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (!options.names.empty()) channels[c].name = options.names[c];
    if (!options.units.empty()) channels[c].unit = options.units[options.units.size() == 1 ? 0 : c];
  }
}

// "NAME=VALUE" of `channel_scale`, `channel_unit` and `channel_rate`: the value of the last word that fits the channel.
std::optional<std::string> value_for(const std::vector<std::string>& words, const std::string& channel) {
  std::optional<std::string> found;
  for (const std::string& word : words) {
    const std::size_t sign = word.rfind('=');
    if (sign == std::string::npos || sign == 0 || sign + 1 == word.size())
      throw usage_error("E0331")
          .says("expected NAME=VALUE for a channel")
          .got(word)
          .hint("such as `channel_scale` gx=1/16.4 or `channel_unit` 'gyro*=deg/s'");
    if (matches(word.substr(0, sign), channel)) found = word.substr(sign + 1);
  }
  return found;
}

// The rows of a log whose channels have rates of their own.
std::unique_ptr<RowSource> with_stated_rates(std::unique_ptr<RowSource> rows, const ReadOptions& options) {
  const auto rate_of = [](const std::string& text) {
    double uncertainty = 0;
    const double rate = parse_rate_hz(text, uncertainty);
    if (uncertainty > 0) throw usage_error("E0331", "`channel_rate`").says("a rate without uncertainty").got(text);
    return rate;
  };
  double fastest = options.rate_hz.value_or(0);
  for (const std::string& word : options.unsaid.channel_rate)
    fastest = std::max(fastest, rate_of(word.substr(word.rfind('=') + 1)));
  std::vector<Channel> channels = rows->info().channels;
  name_channels(channels, options);
  std::vector<double> rates;
  for (const std::string& word : options.unsaid.channel_rate)  // rates of channels that are not read say what rows are
    if (options.channels.empty() && std::none_of(channels.begin(), channels.end(), [&](const Channel& channel) {
          return matches(word.substr(0, word.rfind('=')), channel.name);
        }))
      throw usage_error("E0331", "`channel_rate`").says("no channel has this name").got(word);
  for (const Channel& channel : channels) {
    const auto stated = value_for(options.unsaid.channel_rate, channel.name);
    if (!stated && !options.rate_hz)
      throw usage_error("E0331", "`channel_rate`")
          .says("no rate is given for {}", printable(channel.name))
          .hint("`rate_hz` HZ is that of all others, `channels` '!{}' leaves it out", printable(channel.name));
    rates.push_back(stated ? rate_of(*stated) : *options.rate_hz);
  }
  return with_rates(std::move(rows), std::move(rates), fastest);
}

std::unique_ptr<RowSource> open_log(const std::string& path, const ReadOptions& options) {
  const Format& format = format_of(path, options);
  refuse_unused_options(format.about, options);
  std::unique_ptr<RowSource> rows = open_rows(format, path, options);
  return options.unsaid.channel_rate.empty() ? std::move(rows) : with_stated_rates(std::move(rows), options);
}

using ScaleNotes = std::map<std::string, std::vector<std::string>>;  // what was done, to which channels

// What makes values in the unit that a log states values in the one that is asked for; 1 where one of
// them is not known.
double conversion(const std::string& stated, const Channel& channel) {
  const auto from = find_unit(stated), to = find_unit(channel.unit);
  if (!from || !to || channel.unit == "1") return 1;
  if (const auto factor = Unit::sample_factor(stated, channel.unit)) return *factor;
  throw usage_error("E0331")
      .says("values of {} in {} are not converted to {}{}", printable(channel.name), printable(stated, 20),
            printable(channel.unit, 20), from->quantity == to->quantity ? "" : ", a unit of another quantity")
      .hint("`channel_scale` {}=1, if only the name of the unit is wrong", channel.name);
}

// "load [g]" is in grams: no unit of an acceleration, and of no quantity that this program knows.
bool is_in_grams(const Channel& channel) { return channel.unit == "g" && detail::names_mass(channel.name); }

// Names and units as they are asked for; counts become values, by `channel_scale`, else by a number in the unit, and
// values in another unit of the log are converted. Returns the factors, and says in `notes` what was done.
std::vector<double> dress_channels(std::vector<Channel>& channels, const ReadOptions& options, ScaleNotes* notes) {
  std::vector<double> factors(channels.size(), 1);
  const std::vector<Channel> stated = channels;
  name_channels(channels, options);
  for (std::size_t c = 0; c < channels.size(); ++c) {
    Channel& channel = channels[c];
    std::string count;
    const auto said = value_for(options.channel_unit, channel.name);
    if (said) channel.unit = *said;
    if (!said && is_in_grams(channel)) channel.unit = "gram";
    const auto counts = count_unit(channel.unit);
    if (counts) {
      channel.unit = counts->unit;
      factors[c] = counts->factor;
    }
    if (const auto scale = value_for(options.channel_scale, channel.name)) {
      const auto factor = parse_factor(*scale);
      if (!factor)
        throw usage_error("E0331", "`channel_scale`")
            .says("the factor of a channel must be a number other than 0")
            .got(*scale)
            .hint("such as 0.05 or 1/16.4");
      factors[c] = *factor;
    } else if (!counts) {
      factors[c] = conversion(stated[c].unit, channel);
      if (factors[c] != 1) count = "converted: 1 " + printable(stated[c].unit);
    }
    channel.stated = stated[c].unit;
    channel.factor = factors[c];
    if (factors[c] == 1) continue;
    channel.integer = false;
    if (notes != nullptr)
      (*notes)[fmt::format("{} is {}{}{}", count.empty() ? "one count" : count, brief_text(factors[c], 6),
                           channel.unit.empty() ? "" : " ", printable(channel.unit))]
          .push_back(printable(channel.name));
  }
  return factors;
}

// A slip in the name of a channel must not pass.
void warn_of_unused(const std::vector<Channel>& channels, const ReadOptions& options, Findings& warnings) {
  for (const auto* words : {&options.channel_scale, &options.channel_unit})
    for (const std::string& word : *words)
      if (std::none_of(channels.begin(), channels.end(),
                       [&](const Channel& channel) { return matches(word.substr(0, word.rfind('=')), channel.name); }))
        warnings.add("unused_option", "`channel_scale` and `channel_unit` for channels that are not read", word);
}

// A symbol of a quantity that nothing is said of, such as "mA", or a count.
bool is_other_symbol(std::string_view symbol) {
  static constexpr std::string_view kSymbols[] = {
      "A",   "B",   "C",   "F", "H",  "J",  "L",  "N",  "S",  "W",  "m",   "l",   "kg",   "lm",  "lx",    "lux",   "cd",
      "mol", "ohm", "Ohm", "Ω", "dB", "Ah", "Wh", "VA", "Nm", "px", "raw", "bit", "bits", "LSB", "count", "counts"};
  const auto is_one = [](std::string_view text) {
    return std::find(std::begin(kSymbols), std::end(kSymbols), text) != std::end(kSymbols);
  };
  for (const std::string_view prefix : {"", "n", "µ", "μ", "u", "m", "c", "k", "M", "G"})
    if (symbol.starts_with(prefix) && is_one(symbol.substr(prefix.size()))) return true;
  return find_unit(symbol).has_value();
}

// "lux", "µA", "m/s", "kg m^2": of other quantities than those whose units are converted, and no slip.
bool has_other_unit(std::string unit) {
  for (const std::string_view sign : {"·", "²", "³", "⁻", "¹"})
    for (std::size_t at; (at = unit.find(sign)) != std::string::npos;) unit.replace(at, sign.size(), " ");
  constexpr std::string_view kBetween = " */^()-.0123456789";
  for (std::size_t from = unit.find_first_not_of(kBetween); from != std::string::npos;) {
    const std::size_t to = std::min(unit.find_first_of(kBetween, from), unit.size());
    if (!is_other_symbol(std::string_view(unit).substr(from, to - from))) return false;
    from = unit.find_first_not_of(kBetween, to);
  }
  return true;
}

// Some quantities have units that no list has; a slip must not look like one of them. Formats that are no tables of
// text have their units from lists of their own.
void warn_of_units(const LogInfo& info, const ReadOptions& options, Findings& warnings) {
  const bool somebody_wrote_them = info.format == "csv" || !options.units.empty() || !options.channel_unit.empty();
  for (const Channel& channel : info.channels)
    if (somebody_wrote_them && !channel.unit.empty() && !find_unit(channel.unit) && !has_other_unit(channel.unit))
      warnings.add("unknown_unit",
                   "units that are not known: kept as written, nothing is converted; `channel_unit` states another",
                   fmt::format("{} [{}]", channel.name, channel.unit));
}

[[noreturn]] void refuse_empty(const LogInfo& info) {
  throw input_error("E0318", info.file)
      .says(info.channels.size() == 1 ? fmt::format("column {} has no finite value", info.channels[0].name)
                                      : fmt::format("none of {} columns has a finite value", info.channels.size()))
      .hint("`channels` chooses others");
}

// Passes blocks on and remembers which channels had a value at all.
struct Watch final : BlockSink {
  Watch(BlockSink& sink, const ReadOptions& reading) : next(sink), options(reading) {}
  void begin(const LogInfo& so_far) override {
    seen.assign(so_far.channels.size(), false);
    LogInfo named = so_far;
    factors = dress_channels(named.channels, options, nullptr);
    scales = std::any_of(factors.begin(), factors.end(), [](double f) { return f != 1; });
    scaled.resize(scales ? factors.size() : 0);
    next.begin(named);
  }
  void block(const SampleBlock& samples) override {
    for (std::size_t c = 0; c < seen.size(); ++c) {
      for (std::size_t i = 0; i < samples.rows && !seen[c]; ++i) seen[c] = !std::isnan(samples.channels[c][i]);
    }
    if (scales)
      next.block(scaled_block(samples));
    else
      next.block(samples);
  }
  SampleBlock scaled_block(const SampleBlock& samples) {
    SampleBlock out = samples;
    for (std::size_t c = 0; c < factors.size(); ++c) {
      if (factors[c] == 1) continue;
      scaled[c].resize(std::max(scaled[c].size(), samples.rows));
      for (std::size_t i = 0; i < samples.rows; ++i) scaled[c][i] = samples.channels[c][i] * factors[c];
      out.channels[c] = scaled[c].data();
    }
    return out;
  }
  BlockSink& next;
  const ReadOptions& options;
  std::vector<bool> seen;
  std::vector<double> factors;  // of the channels
  bool scales = false;          // one of them is not 1
  std::vector<std::vector<double>> scaled;
};

void check_numbers(const ReadOptions& options) {
  if (options.rate_hz && !(*options.rate_hz >= kRates.lowest && *options.rate_hz <= kRates.highest))
    throw usage_error("E0201", "`rate_hz`")
        .says("the rate must be a positive frequency, from 1 nHz to 1 THz")
        .got(shortest(*options.rate_hz));
  if (options.from_s && options.to_s && !(*options.from_s < *options.to_s))
    throw usage_error("E0201", "`to_s`").says("the window is empty: `to_s` does not lie after `from_s`");
}

}  // namespace

LogInfo read_log_head(const std::string& log, const ReadOptions& options) {
  check_numbers(options);
  const std::string path = named_log_file(log);
  LogInfo info = open_log(path, options)->info();
  dress_channels(info.channels, options, nullptr);
  warn_of_unused(info.channels, options, info.warnings);
  warn_of_units(info, options, info.warnings);
  return info;
}

LogInfo log_listing(const std::string& log, const ReadOptions& options) {
  const std::string path = named_log_file(log);
  const Format& format = format_of(path, options);
  LogInfo info;
  info.file = path;
  info.format = format.about.name;
  if (format.topics == nullptr) return info;
  const auto reader = format.topics(path, options);
  info.topics = reader->topics();
  info.dialect = reader->dialect();
  if (!info.topics.empty()) reader->finish(info.warnings);
  std::error_code none;
  for (const std::string& file : files_of_log(path))
    if (const auto bytes = std::filesystem::file_size(file, none); !none) info.bytes += bytes;
  return info;
}

namespace {

/// What the grid of instants knows better than the head of the log.
void take_grid(const LogInfo& known, LogInfo& info) {
  info.rows = known.rows;
  info.rows_used = known.rows_used;
  info.rows_dropped = known.rows_dropped;
  info.rows_outside = known.rows_outside;
  info.samples = known.samples;
  if (!known.time.from_stamps && !(known.time.rate_hz > 0)) return;
  TimeBase time = known.time;
  time.column = info.time.column;
  time.unit = info.time.unit;
  time.unit_ns = info.time.unit_ns;
  time.unit_guessed = info.time.unit_guessed;
  if (!time.start_ns) time.start_ns = info.time.start_ns;
  info.time = time;
}

void refuse_without_samples(const LogInfo& info, const ReadOptions& options) {
  if (info.rows == 0) throw input_error("E0322", info.file).says("no data rows");
  if (info.samples == 0 && (options.from_s || options.to_s))
    throw usage_error("E0319", info.file)
        .says("the stretch of time that was chosen holds no sample")
        .hint("inspect says how long the log is");
}

/// Refuses a whole log without a finite value; warns of channels without one.
void judge_values(const Watch& watch, LogInfo& info, const ReadOptions& options, Findings& warnings) {
  if (info.samples == 0) return;
  const bool whole = !options.from_s && !options.to_s;
  if (whole && std::none_of(watch.seen.begin(), watch.seen.end(), std::identity{})) refuse_empty(info);
  for (std::size_t c = 0; c < watch.seen.size(); ++c)
    if (!watch.seen[c])
      warnings.add("no_finite_value", "channels without any finite value", "channel " + info.channels[c].name);
  for (std::size_t c = 0; c < watch.seen.size(); ++c) {
    if (!(info.channels[c].every > 1)) continue;
    Finding& slow = warnings.add(
        "slow_channel",
        "channels with a clock of their own among the rows of others: in the grid of the table samples are missing",
        fmt::format("channel {}, every {} rows", info.channels[c].name, brief_text(info.channels[c].every, 3)));
    if (slow.help.empty())
      slow.help.push_back({"Read it alone: it has a grid of its own.", {{"channels", info.channels[c].name}}});
  }
  for (const Channel& channel : info.channels) {
    if (channel.own_clock.empty()) continue;
    Finding& own = warnings.add("own_stamps",
                                "channels with stamps of their own in another column: at those of the table their rate "
                                "is wrong",
                                fmt::format("channel {}, stamps in {}", channel.name, channel.own_clock));
    own.help.push_back({fmt::format("{} by its own stamps.", channel.name),
                        {{"time_column", channel.own_clock}, {"channels", channel.name}}});
  }
  const auto by_every = [](const Channel& a, const Channel& b) { return a.every < b.every; };
  const auto [fast, slow] = std::minmax_element(info.channels.begin(), info.channels.end(), by_every);
  if (info.channels.size() < 2 || !(fast->every > 1) || !(info.time.rate_hz > 0)) return;  // rows are of the fastest
  warnings.add("slow_channel", "", {}, 0)
      .help.push_back({"A replay interpolates each by its own stamps to one grid.",
                       {{"resample_hz", shortest(rounded(info.time.rate_hz / slow->every, 3))}}});
}

/// The next rows, with what is marked as missing missing: by the number in the file, or by what it is in the
/// channel's unit, as messages print it.
bool next_rows(RowSource& source, const ReadOptions& options, RowBlock& block, Findings& warnings) {
  if (!source.next(block, warnings)) return false;
  if (options.missing.marks.empty()) return true;
  std::vector<Channel> channels = source.info().channels;
  const std::vector<double> factors = dress_channels(channels, options, nullptr);
  for (const double mark : options.missing.marks)
    for (std::size_t c = 0; c < block.columns.size(); ++c) {
      std::uint64_t count = 0;
      for (double& value : std::span(block.columns[c]).first(block.rows)) {
        if (value != mark && value * factors[c] != mark) continue;
        value = kMissing;
        ++count;
      }
      if (count == 0) continue;
      warnings.add("missing_value", "values that mean \"no reading\", as was said: missing", channels[c].name, count);
    }
  return true;
}

/// The head with the names and units that the channels have in the end.
LogInfo named_info(const RowSource& source, const ReadOptions& options) {
  LogInfo info = source.info();
  ScaleNotes scaled;
  dress_channels(info.channels, options, &scaled);
  for (const Channel& channel : info.channels)
    if (channel.unit == "gram" && channel.stated == "g")
      info.guesses.push_back(
          fmt::format("unit of {0}: gram, by its name (`channel_unit` {0}=g says otherwise)", printable(channel.name)));
  for (const auto& [count, names] : scaled) info.dialect.push_back(count + ": " + first_names(names));
  return info;
}

}  // namespace

std::string why_no_rows(const LogInfo& log) {
  const Format* format = find_format(log.format);
  if (format == nullptr || !format->about.rows_at_places)
    return fmt::format("its rows have no fixed places ({})", log.format);
  if (!log.time.column.empty())
    return fmt::format("it has stamps (column {}), which say where a sample belongs only once all are read",
                       printable(log.time.column));
  return "";
}

LogInfo read_rows(const std::string& path, const ReadOptions& options, std::uint64_t first, std::uint64_t end,
                  BlockSink& sink, ChannelRange channels) {
  check_numbers(options);
  ReadOptions whole = options;
  whole.from_s = whole.to_s = std::nullopt;
  whole.hash = false;
  const auto source = open_log(path, whole);
  std::string why_not = why_no_rows(source->info());
  if (why_not.empty() && !source->restrict_rows(first, end, channels))
    why_not = fmt::format("its rows have no fixed places ({})", source->info().format);
  if (!why_not.empty())
    throw usage_error("E0726", path).says("cannot be read in stretches: " + why_not).hint("convert it to .npy first");
  Findings warnings;
  Watch watch(sink, whole);
  TimeGrid grid(*source, whole, watch, warnings);
  RowBlock block;
  while (next_rows(*source, options, block, warnings)) grid.push(block);
  LogInfo known;
  grid.finish(known);
  source->finish(warnings);
  LogInfo info = named_info(*source, whole);
  take_grid(known, info);
  if (first == 0 && channels.first == 0) {  // what is said of the whole log is said once
    warn_of_unused(info.channels, whole, warnings);
    warn_of_units(info, whole, warnings);
  }
  info.warnings = std::move(warnings);
  return info;
}

LogInfo read_log(const std::string& log, const ReadOptions& options, BlockSink& sink, Progress& progress) {
  check_numbers(options);
  const std::string path = named_log_file(log);
  const auto source = open_log(path, options);
  Findings warnings;
  Watch watch(sink, options);
  TimeGrid grid(*source, options, watch, warnings);
  RowBlock block;
  const std::string what = "reading " + path;
  bool more = true;
  while (more && next_rows(*source, options, block, warnings)) {
    more = grid.push(block);
    const std::uint64_t total = source->bytes_total();
    progress.update(total > 0 ? static_cast<double>(source->bytes_read()) / static_cast<double>(total) : -1, what);
  }
  LogInfo known;
  grid.finish(known);
  source->finish(warnings);
  LogInfo info = named_info(*source, options);
  warn_of_unused(info.channels, options, warnings);
  take_grid(known, info);
  for (std::size_t c = 0; c < info.channels.size(); ++c)
    info.channels[c].every = std::max(info.channels[c].every, grid.clocks().every(c));
  refuse_without_samples(info, options);
  judge_values(watch, info, options, warnings);
  warn_of_units(info, options, warnings);
  info.sha256 = source->sha256();
  info.bytes = std::max(info.bytes, source->bytes_read());
  info.warnings = std::move(warnings);
  count_work(WorkKind::passes, 1);
  count_work(WorkKind::rows, info.rows);
  return info;
}

namespace {

struct Collector final : BlockSink {
  void begin(const LogInfo& so_far) override {
    samples.resize(so_far.channels.size());
    meters.resize(so_far.channels.size());
  }
  void block(const SampleBlock& block) override {
    for (std::size_t c = 0; c < samples.size(); ++c) {
      samples[c].insert(samples[c].end(), block.channels[c], block.channels[c] + block.rows);
      meters[c].push({block.channels[c], block.rows});
    }
  }
  std::vector<std::vector<double>> samples;
  std::vector<QualityMeter> meters;
};

}  // namespace

Recording read_recording(const std::string& path, const ReadOptions& options, Progress& progress) {
  Collector collector;
  Recording recording;
  recording.info = read_log(path, options, collector, progress);
  recording.samples = std::move(collector.samples);
  for (std::size_t c = 0; c < recording.info.channels.size(); ++c) {
    const ChannelQuality quality = collector.meters[c].finish();
    for (const Finding& one : quality.findings)
      if (one.code == "quantization_limited")
        recording.info.warnings.add(one.code, one.sentence, recording.info.channels[c].name);
  }
  return recording;
}

StampedRows read_stamped_rows(const std::string& log, const ReadOptions& options, Progress& progress) {
  const std::string path = named_log_file(log);
  const auto source = open_log(path, options);
  StampedRows out;
  Findings warnings;
  RowBlock block;
  while (next_rows(*source, options, block, warnings)) {
    const auto rows = static_cast<std::ptrdiff_t>(block.rows);
    out.samples.resize(block.columns.size());
    for (std::size_t c = 0; c < block.columns.size(); ++c)
      out.samples[c].insert(out.samples[c].end(), block.columns[c].begin(), block.columns[c].begin() + rows);
    if (!block.time_ns.empty())
      out.time_ns.insert(out.time_ns.end(), block.time_ns.begin(), block.time_ns.begin() + rows);
    out.info.rows += block.rows;
    progress.update(-1, "reading " + path);
  }
  source->finish(warnings);
  const std::uint64_t rows = out.info.rows;
  out.info = source->info();
  out.info.rows = rows;
  out.samples.resize(out.info.channels.size());
  const std::vector<double> factors = dress_channels(out.info.channels, options, nullptr);
  for (std::size_t c = 0; c < factors.size(); ++c)
    for (double& value : out.samples[c]) value *= factors[c];
  out.info.warnings = std::move(warnings);
  return out;
}

bool read_once(const std::string& path) {
  std::error_code none;
  const auto status = std::filesystem::status(path, none);
  return path == "-" || std::filesystem::is_fifo(status) || std::filesystem::is_character_file(status);
}

}  // namespace libchar
