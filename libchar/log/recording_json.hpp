#pragma once
// What a document says about the recordings it comes from: one description for every verb. Keys may
// be added; none changes its meaning or goes.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/fields.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

/// What every document that is made from logs says first.
struct DocumentHead {
  std::string format;
  std::string program;  ///< version of the program that wrote it
  std::vector<std::string> command;
  struct File {
    std::string path, sha256;  ///< `sha256` empty: not known
    std::uint64_t bytes = 0;
  };
  std::vector<File> input;
  struct Found {
    std::string file;
    Finding finding;
  };
  std::vector<Found> findings;
};
const Fields<DocumentHead>& document_head_fields();

/// {"format":FORMAT,"version":1,"tool":{name,version},"command":[…],"input":[{path,sha256,bytes}…],
/// "findings":[{file,code,severity,sentence,count,…}]}: the head of every document that is made from logs.
Json document_head(std::string_view format, const std::vector<std::string>& command,
                   const std::vector<const LogInfo*>& logs, const Findings& of_result = {});

/// What `input` says of a small file that was read whole, a model or a report: its path, digest and size. Throws
/// Error(input) where it cannot be read.
LogInfo document_info(const std::string& path);

struct DescribedChannel {
  Channel channel;
  ChannelQuality quality;
  std::optional<Trace> trace = {};
};
/// Name, unit and what the samples of a channel say about the instrument.
const Fields<DescribedChannel>& described_channel_fields();

/// File, channels, time base and repairs; `qualities` has one element per channel of `log`; so has `traces`, or none.
Json recording_json(const LogInfo& log, const std::vector<ChannelQuality>& qualities,
                    const std::vector<Trace>& traces = {});

/// Schemas of a recording, and of the sidecar of a raw binary log.
std::span<const Field> recording_rows();
std::span<const Field> sidecar_rows();

}  // namespace libchar
