#pragma once
// What the targets of fleets share: tasks whose names fit what is in them, and a folder for what is read from one.

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "libchar/characterize/settings.hpp"
#include "libchar/core/document/document.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/core/document/schema.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/process/version.hpp"
#include "libchar/fleet/unit.hpp"

namespace fuzz {

/// What the name of a task is made of. Throws Error as parse_unit does, and for keys that parse_unit would name.
inline libchar::FleetUnit named_content(const libchar::Document& document) {
  using namespace libchar;
  std::vector<std::string> keys;
  for (const DocumentEntry& entry : document.map) keys.push_back(entry.key);
  const MapReader at(document, "t.json", "", keys);
  FleetUnit unit;
  unit.kind = *find_enum<UnitKind>(at.word("kind", words_of<UnitKind>()));
  unit.sha256 = at.text("sha256");
  unit.reports = at.flag_or("reports", true);
  if (unit.kind == UnitKind::join) unit.parts = at.texts("parts");
  if (unit.kind == UnitKind::stretch) {
    const std::vector<double> ends = at.numbers("leaves");
    if (ends.size() == 2 && ends[0] >= 0 && ends[1] >= 0 && ends[0] < 1e15 && ends[1] < 1e15)
      unit.stretch = {static_cast<std::uint64_t>(ends[0]), static_cast<std::uint64_t>(ends[1])};
  }
  CharacterizeOptions options;
  read_fields(characterize_fields(), at.map("config", keys_of(characterize_fields())), options);
  unit.options = std::make_shared<const CharacterizeOptions>(options);
  return unit;
}

/// The task under the name of its content: else nothing but the name would be looked at. Text that
/// is no task stays as it is.
inline std::string named_task(std::string_view text) {
  using namespace libchar;
  try {
    const Document document = parse_document(text, "t.json");
    Json tree = as_json(document);
    if (!tree.is_object()) return std::string(text);
    tree["version_of_program"] = version();
    tree["id"] = unit_id(named_content(document));
    return tree.dump();
  } catch (const Error&) {
    return std::string(text);
  }
}

/// In memory where the machine has a place for that; removed with the object.
class Folder {
 public:
  Folder() {
    const std::filesystem::path fast = "/dev/shm";
    const auto where = std::filesystem::is_directory(fast) ? fast : std::filesystem::temp_directory_path();
    path_ = where / ("libchar-fuzz-" + std::to_string(::getpid()));
    std::filesystem::create_directories(path_);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    std::ofstream(path_ / name, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace fuzz
