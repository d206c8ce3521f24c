#pragma once
// Where the results of units are: DIR/results/AB/ID/, a folder for each, whole or absent. A worker
// fills a folder of its own and gives it its name at the end (rename(2)): of two workers on one
// unit the second finds the name taken and lets go of its own, and a worker that is killed leaves
// nothing that is taken for a result. Nothing here looks at a clock.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libchar/lot/device_record.hpp"

namespace libchar {

/// Throws Error(output) for a failed call of the system and its number.
[[noreturn]] void refuse_unwritable(const std::filesystem::path& path, int number);

/// With those above it. Throws Error(output).
void make_fleet_folder(const std::filesystem::path& folder);

/// "ab/abcdef…": the folder of a unit below DIR/results.
std::string result_folder(const std::string& id);

/// A folder that only this worker sees until it is published; removed with all that is in it unless it was.
class ResultFolder {
 public:
  /// Throws Error(output). What workers of this machine that are no more left beside it is removed.
  ResultFolder(const std::filesystem::path& fleet, const std::string& id);
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  /// Gives it its name. False: another worker was first, whose result stays. One that is not whole,
  /// or of a log that was another when it was read (log_seen.hpp), is put aside under another name.
  bool publish();

 private:
  std::filesystem::path fleet_, path_;
  std::string id_;
  bool published_ = false;
};

/// What a unit of a log or a join ends with, in its folder.
void write_record(const std::filesystem::path& folder, const DeviceRecord& record);

/// Nothing where there is no result. Throws Error(input) for one that is damaged, by name.
std::optional<DeviceRecord> stored_record(const std::filesystem::path& fleet, const std::string& id);

/// The file with the partial state of a channel (from 0) of a stretch, in the folder of its result.
std::string state_file(std::size_t channel);
/// The files of all channels of a stretch; none where there is no result. Throws Error(input) for
/// one that is damaged, by name.
std::vector<std::string> stored_states(const std::filesystem::path& fleet, const std::string& id);

/// Whether there is a whole result; a damaged one is none.
bool has_result(const std::filesystem::path& fleet, const std::string& id, bool of_stretch);

/// The units that have a folder of results, whole or damaged.
std::vector<std::string> published(const std::filesystem::path& fleet);

/// Folders that workers are filling, or were when they were killed.
std::vector<std::string> unpublished(const std::filesystem::path& fleet);

inline constexpr const char* kRecordFile = "device.record";
inline constexpr const char* kSeenFile = "log.seen";

}  // namespace libchar
