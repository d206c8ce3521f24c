#pragma once
// What the readers of a scene's blocks share: refusals, names, files.

#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/schema.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/scene/scene.hpp"
#include "libchar/scene/scene_paths.hpp"

namespace libchar {

// ---- refusals ----

/// "WHERE: error CODE: KEY: …"
Refusal scene_refusal(const char* code, const MapReader& at, std::string_view key);

/// The same about a value that stands in a list.
Refusal scene_refusal_at(const char* code,
                         const MapReader& at,
                         const Document& node,
                         const std::string& path);

/// A scalar: a name, a path, a number.
bool is_scalar(const Document& node);

/// Names go into logs, reports and terminals: no zero byte, a warning about what cannot be printed.
void check_scene_text(const MapReader& at,
                      const Document& node,
                      const std::string& path,
                      Scene& scene);

/// The word at `key`, one of `names`; else E0738 with the nearest of them.
std::size_t index_of_name(const MapReader& at,
                          std::string_view key,
                          const std::string& name,
                          const std::vector<std::string>& names,
                          const std::string& what);

/// From 1 to 1024.
void check_oversampling(const MapReader& at, std::uint64_t oversampling);

// ---- files ----

/// The path behind `key`, checked, and noted in `scene.files`.
std::string scene_file_of(const MapReader& at,
                          std::string_view key,
                          const SceneFolder& folder,
                          Scene& scene);

/// A path, or a map with a path and how to read the file.
std::string scene_recording_of(const MapReader& at,
                               std::string_view key,
                               const SceneFolder& folder,
                               ReadOptions& reading,
                               Scene& scene);

}  // namespace libchar
