#include "libchar/log/recording_json.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "libchar/core/document/coefficient_fields.hpp"
#include "libchar/core/document/document.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/core/process/version.hpp"
#include "libchar/log/binary/sidecar.hpp"

namespace libchar {
namespace {

// ---- the head of a document ----

const Fields<DocumentHead::File>& input_fields() {
  using T = DocumentHead::File;
  static const Fields<T> rows = always(Fields<T>{
      field<&T::path>("path"),
      field<&T::sha256>("sha256", {.known = when<[](const T& f) { return !f.sha256.empty(); }>}),
      field<&T::bytes>("bytes"),
  });
  return rows;
}

const Fields<DocumentHead::Found>& file_finding_fields() {
  using T = DocumentHead::Found;
  static const Fields<T> rows = {field<&T::file>("file"), beside<&T::finding>(finding_fields())};
  return rows;
}

}  // namespace

const Fields<DocumentHead>& document_head_fields() {
  using T = DocumentHead;
  static const Fields<T> tool = always(Fields<T>{
      computed<[](const T&) { return std::string("sensorchar"); }>("name"),
      field<&T::program>("version"),
      computed<[](const T&) { return build(); }>("build"),
  });
  static const Fields<T> rows = always(Fields<T>{
      field<&T::format>("format"),
      computed<[](const T&) { return std::uint64_t{1}; }>("version"),
      level<T>("tool", tool, {.meaning = "the program that wrote the document"}),
      field<&T::command>("command", {.meaning = "its words"}),
      list_of<&T::input>("input", input_fields(), {.meaning = "each file read"}),
      list_of<&T::findings>("findings", file_finding_fields()),
  });
  return rows;
}

namespace {

// ---- a recording ----

struct DescribedRecording {
  LogInfo info;
  std::vector<DescribedChannel> channels;
};

const Fields<Channel>& topic_field_fields() {
  static const Fields<Channel> rows =
      always(Fields<Channel>{field<&Channel::name>("name"), field<&Channel::unit>("unit")});
  return rows;
}

const Fields<LogTopic>& topic_fields() {
  using T = LogTopic;
  static const Fields<T> rows = always(Fields<T>{
      field<&T::name>("name"),
      field<&T::type>("type"),
      field<&T::rows>("rows"),
      field<&T::rate_hz>("rate_hz", {.known = when<[](const T& t) { return 0 < t.rate_hz; }>}),
      field<&T::why_not>("why_not", {.meaning = "why no field can be read"}),
      list_of<&T::fields>("fields", topic_field_fields()),
  });
  return rows;
}

void write_repairs(const Field& row, const DescribedRecording& recording, std::vector<Entry>& out) {
  Entry counts = part_entry(std::string(row.key), {});
  for (const Finding& w : recording.info.warnings.list()) counts.below.push_back({w.code, w.count});
  out.push_back(std::move(counts));
}

bool has_rate(const DescribedRecording& recording) { return recording.info.time.rate_hz > 0; }

bool has_topics(const DescribedRecording& recording) { return !recording.info.topics.empty(); }

}  // namespace

const Fields<DescribedChannel>& described_channel_fields() {
  using T = DescribedChannel;
  using Q = ChannelQuality;
  static const auto kSampled = when<[](const T& c) { return 0 < c.quality.samples; }>;
  static const auto kVaries = when<[](const T& c) { return c.quality.minimum < c.quality.maximum; }>;
  static const Fields<Trace> trace = always(Fields<Trace>{
      field<&Trace::block>("samples_per_block"),
      field<&Trace::low>("low", {.meaning = "smallest sample of each block"}),
      field<&Trace::high>("high", {.meaning = "largest"}),
  });
  static const Fields<T> own = {field<&T::channel, &Channel::rate_hz>(
                                    "own_rate_hz", {.unit = "Hz", .meaning = "of a channel on a grid of its own"}),
                                maybe_part<&T::trace>("trace", trace)};
  static const Fields<T> rows = joined(
      always(Fields<T>{
          field<&T::channel, &Channel::name>("name"),
          field<&T::channel, &Channel::unit>("unit"),
          field<&T::quality, &Q::missing>("missing"),
          field<&T::quality, &Q::beyond>("beyond_range", {.meaning = "of the missing ones: too large to be measured"}),
          field<&T::quality, &Q::samples>("samples"),
          field<&T::channel, &Channel::integer>("integer"),
          field<&T::quality, &Q::mean>("mean"),
          field<&T::quality, &Q::standard_deviation>("standard_deviation"),
          field<&T::quality, &Q::minimum>("minimum", {.known = kSampled}),
          field<&T::quality, &Q::maximum>("maximum", {.known = kSampled}),
          field<&T::quality, &Q::resolution>("resolution"),
          field<&T::quality, &Q::distinct_values>("distinct_values"),
          field<&T::quality, &Q::saturated>("saturated"),
          field<&T::quality, &Q::longest_stuck>("longest_stuck"),
          field<&T::quality, &Q::difference_kurtosis>("difference_kurtosis", {.known = kVaries}),
          field<&T::quality, &Q::float32>("float32"),
          field<&T::quality, &Q::float32_step>("float32_step"),
          list_of<&T::quality, &Q::findings>("findings", finding_fields()),
      }),
      own);
  return rows;
}

namespace {

const Fields<DescribedRecording>& recording_fields() {
  using T = DescribedRecording;
  using L = LogInfo;
  using B = TimeBase;
  static const auto kHashed = when<[](const T& r) { return !r.info.sha256.empty(); }>;
  static const Fields<T> rows = always(Fields<T>{
      field<&T::info, &L::file>("file"),
      field<&T::info, &L::sha256>("sha256", {.known = kHashed}),
      field<&T::info, &L::bytes>("bytes"),
      field<&T::info, &L::format>("format", {.meaning = "of the log"}),
      field<&T::info, &L::rows>("rows", {.meaning = "used, dropped and outside the window"}),
      field<&T::info, &L::rows_used>("rows_used"),
      field<&T::info, &L::rows_dropped>("rows_dropped"),
      field<&T::info, &L::rows_outside>("rows_outside"),
      field<&T::info, &L::samples>("samples"),
      list_of<&T::channels>("channels", described_channel_fields()),
      field<&T::info, &L::time, &B::rate_hz>("rate_hz", {.known = when<has_rate>}),
      field<&T::info, &L::time, &B::jitter_s>("jitter_s"),
      field<&T::info, &L::time, &B::max_deviation_s>("max_deviation_s"),
      field<&T::info, &L::time, &B::gaps>("gaps"),
      field<&T::info, &L::time, &B::missing_samples>("missing_samples"),
      field<&T::info, &L::time, &B::column>("time_column"),
      field<&T::info, &L::time, &B::unit>("time_unit"),
      field<&T::info, &L::time, &B::unit_guessed>("time_unit_guessed"),
      field<&T::info, &L::time, &B::from_stamps>("rate_from_stamps"),
      field<&T::info, &L::time, &B::start_ns>("start_ns", {.meaning = "stamp of the first sample"}),
      written<T, write_repairs>("repairs", "counts", {.meaning = "counts by kind"}),
      field<&T::info, &L::guesses>("guesses"),
      field<&T::info, &L::dialect>("dialect"),
      field<&T::info, &L::topic>("topic",
                                 {.meaning = "that was read", .written = Written::if_known, .known = when<has_topics>}),
      list_of<&T::info, &L::topics>(
          "topics", topic_fields(),
          {.meaning = "of a log with several streams", .written = Written::if_known, .known = when<has_topics>}),
  });
  return rows;
}

}  // namespace

Json document_head(std::string_view format, const std::vector<std::string>& command,
                   const std::vector<const LogInfo*>& logs, const Findings& of_result) {
  DocumentHead head{std::string(format), std::string(version()), command, {}, {}};
  for (const LogInfo* log : logs) {
    head.input.push_back({log->file, log->sha256, log->bytes});
    for (const Finding& w : log->warnings.list()) head.findings.push_back({log->file, w});
  }
  for (const Finding& w : of_result.list()) head.findings.push_back({"", w});
  return document_of(document_head_fields(), head);
}

std::span<const Field> recording_rows() { return recording_fields().rows; }

std::span<const Field> sidecar_rows() { return sidecar_fields().rows; }

LogInfo document_info(const std::string& path) {
  const std::string text = read_document_text(path);
  Sha256 hash;
  hash.update(text);
  LogInfo info;
  info.file = path;
  info.sha256 = hash.finish();
  info.bytes = text.size();
  return info;
}

Json recording_json(const LogInfo& log, const std::vector<ChannelQuality>& qualities,
                    const std::vector<Trace>& traces) {
  DescribedRecording out{log, {}};
  for (std::size_t i = 0; i < std::min(log.channels.size(), qualities.size()); ++i) {
    out.channels.push_back({log.channels[i], qualities[i]});
    if (i < traces.size()) out.channels.back().trace = traces[i];
  }
  return document_of(recording_fields(), out);
}

}  // namespace libchar
