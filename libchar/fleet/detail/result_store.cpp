#include "libchar/fleet/detail/result_store.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <functional>
#include <system_error>

#include "libchar/characterize/stretches.hpp"
#include "libchar/core/file/file_owner.hpp"
#include "libchar/core/file/file_text.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"

namespace libchar {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kWorking = ".working-";
constexpr std::string_view kDamaged = ".damaged-";
constexpr std::size_t kMostRecord = std::size_t{64} << 20U;

/// ".working-ID-PLACE-PROCESS-NUMBER"
std::string working_name(const std::string& id) {
  static std::atomic<int> number{0};
  return fmt::format("{}{}-{}-{}-{}", kWorking, id, detail::place_of_process(), ::getpid(), number++);
}

/// Of a worker of this place that is no more.
bool is_litter(const std::string& name) {
  const std::string mine = fmt::format("-{}-", detail::place_of_process());
  const std::size_t at = name.find(mine);
  if (!name.starts_with(kWorking) || at == std::string::npos) return false;
  const std::string rest = name.substr(at + mine.size());
  detail::FileOwner owner{detail::place_of_process()};
  std::from_chars(rest.data(), rest.data() + rest.size(), owner.process);
  return owner.process > 0 && owner.process != ::getpid() && owner.is_gone();
}

void remove_litter_in(const fs::path& folder) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (is_litter(entry.path().filename().string())) fs::remove_all(entry.path(), ignored);
}

std::string digest_of(std::string_view text) {
  Sha256 hash;
  hash.update(text);
  return hash.finish();
}

/// Whether `published` says the same of the log it was computed from, where `mine` says anything of it.
bool same_log(const fs::path& mine, const fs::path& published) {
  constexpr std::size_t kMost = std::size_t{1} << 16U;
  if (!fs::exists(mine / kSeenFile)) return true;
  return fs::exists(published / kSeenFile) &&
         file_text((mine / kSeenFile).string(), kMost) == file_text((published / kSeenFile).string(), kMost);
}

[[noreturn]] void damaged(const fs::path& file, const std::string& why) {
  throw input_error("E0791", file.string())
      .says("this result is damaged: " + why)
      .hint("run the unit again: a damaged result counts as none");
}

/// The text under the digest in the first line.
std::string checked_text(const fs::path& file, std::size_t most) {
  std::string text = file_text(file.string(), most);
  constexpr std::size_t kDigits = 64;
  if (text.size() < kDigits + 1 || text[kDigits] != '\n') damaged(file, "it is cut");
  const std::string digest = text.substr(0, kDigits);
  text.erase(0, kDigits + 1);
  if (digest_of(text) != digest) damaged(file, "its content is not that of its digest");
  return text;
}

std::vector<std::string> folders_of_results(const fs::path& fleet,
                                            const std::function<bool(const std::string& name)>& wanted) {
  std::vector<std::string> out;
  std::error_code ignored;
  for (const auto& group : fs::directory_iterator(fleet / "results", ignored))
    for (const auto& entry : fs::directory_iterator(group.path(), ignored))
      if (std::string name = entry.path().filename().string(); wanted(name)) out.push_back(std::move(name));
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

void refuse_unwritable(const fs::path& path, int number) {
  throw output_error("E0790", path.string()).says("cannot be written: " + std::generic_category().message(number));
}

void make_fleet_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) refuse_unwritable(folder, error.value());
}

std::string result_folder(const std::string& id) { return id.substr(0, 2) + "/" + id; }

ResultFolder::ResultFolder(const fs::path& fleet, const std::string& id) : fleet_(fleet), id_(id) {
  const fs::path parent = (fleet / "results" / result_folder(id)).parent_path();
  make_fleet_folder(parent);
  remove_litter_in(parent);
  path_ = parent / working_name(id);
  make_fleet_folder(path_);
}

ResultFolder::~ResultFolder() {
  std::error_code ignored;
  if (!published_) fs::remove_all(path_, ignored);
}

bool ResultFolder::publish() {
  const fs::path final_name = fleet_ / "results" / result_folder(id_);
  sync_folder(path_.string());
  for (int attempt = 0; attempt < 3; ++attempt) {
    if (::rename(path_.c_str(), final_name.c_str()) == 0) {
      published_ = true;
      sync_folder(final_name.parent_path().string());
      return true;
    }
    if (errno != EEXIST && errno != ENOTEMPTY) refuse_unwritable(final_name, errno);
    if (has_result(fleet_, id_, fs::exists(path_ / state_file(0))) && same_log(path_, final_name)) return false;
    const fs::path aside = final_name.parent_path() / (std::string(kDamaged) + working_name(id_).substr(1));
    if (::rename(final_name.c_str(), aside.c_str()) != 0 && errno != ENOENT) refuse_unwritable(final_name, errno);
  }
  return false;
}

void write_record(const fs::path& folder, const DeviceRecord& record) {
  const std::string text = device_record_text(record);
  write_whole_file((folder / kRecordFile).string(), digest_of(text) + "\n" + text);
}

std::optional<DeviceRecord> stored_record(const fs::path& fleet, const std::string& id) {
  const fs::path file = fleet / "results" / result_folder(id) / kRecordFile;
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return std::nullopt;
  return parse_device_record(checked_text(file, kMostRecord), file.string());
}

std::string state_file(std::size_t channel) { return fmt::format("state-{}.bin", channel + 1); }

std::vector<std::string> stored_states(const fs::path& fleet, const std::string& id) {
  const fs::path folder = fleet / "results" / result_folder(id);
  std::error_code ignored;
  std::vector<std::string> files;
  if (!fs::exists(folder / state_file(0), ignored)) return files;
  for (std::uint64_t channels = 1; files.size() < channels;) {
    files.push_back((folder / state_file(files.size())).string());
    channels = stretch_head(state_in_file(files.back())).channels;
  }
  return files;
}

bool has_result(const fs::path& fleet, const std::string& id, bool of_stretch) {
  try {
    return of_stretch ? !stored_states(fleet, id).empty() : stored_record(fleet, id).has_value();
  } catch (const Error&) {
    return false;
  }
}

std::vector<std::string> published(const fs::path& fleet) {
  return folders_of_results(fleet, [](const std::string& name) { return name[0] != '.'; });
}

std::vector<std::string> unpublished(const fs::path& fleet) {
  return folders_of_results(fleet, [](const std::string& name) { return name.starts_with(kWorking); });
}

}  // namespace libchar
