#include "libchar/fleet/detail/log_seen.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include "libchar/core/file/file_text.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/fleet/detail/result_store.hpp"

namespace libchar {

std::string digest_of_log(const std::string& path) {
  constexpr std::size_t kPieceOfLog = std::size_t{1} << 20U;
  Sha256 hash;
  for_pieces_of_file(path, kPieceOfLog, [&](std::string_view piece) { hash.update(piece); });
  return hash.finish();
}

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostSeen = std::size_t{1} << 16U;

}  // namespace

std::optional<std::string> log_as_seen(const std::string& log) {
  struct stat status {};
  if (::stat(log.c_str(), &status) != 0) return std::nullopt;
  return fmt::format("{}\n{} {}.{:09}\n", log, status.st_size, status.st_mtim.tv_sec, status.st_mtim.tv_nsec);
}

bool needs_log_seen(const FleetUnit& unit) { return unit.stated || unit.kind == UnitKind::stretch; }

void write_log_seen(const fs::path& folder, const std::string& seen) {
  write_whole_file((folder / kSeenFile).string(), seen, true);
}

bool is_log_seen(const fs::path& fleet, const std::string& id, const std::string& log) {
  const fs::path file = fleet / "results" / result_folder(id) / kSeenFile;
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return false;
  const std::string found = file_text(file.string(), kMostSeen);
  const std::optional<std::string> now = log_as_seen(log);
  return now ? found == *now : found.starts_with(log + "\n");
}

bool result_counts(const fs::path& fleet, const FleetUnit& unit) {
  return !needs_log_seen(unit) || is_log_seen(fleet, unit.id, unit.log);
}

namespace fs = std::filesystem;

std::string absolute_path(const std::string& named, const fs::path& folder) {
  if (named.empty()) return "";
  return (fs::path(named).is_absolute() ? fs::path(named) : folder / named).lexically_normal().string();
}

fs::path folder_of_file(const std::string& path) { return fs::absolute(path).parent_path(); }

}  // namespace libchar
