#pragma once
// What a program has on disk under temporary names. The list lets a signal's handler take it away and end the program
// at once, wherever it is: in a library's loop that never asks, or in a reading that does not return.

#include <filesystem>
#include <string>

namespace libchar {

/// `path` is a temporary file of this process until it is forgotten (renamed, removed, or written down for the next
/// run).
void remember_unfinished(const std::string& path);
void forget_unfinished(const std::string& path) noexcept;

/// While one lives outputs get their names: a process that ends now would leave some with and some without.
class GivingNames {
 public:
  GivingNames();
  ~GivingNames();
  GivingNames(const GivingNames&) = delete;
  GivingNames& operator=(const GivingNames&) = delete;
};

enum class Discarded {
  nothing_written,  ///< no output has got its name
  some_written,     ///< outputs of this process are there, whole
  not_now           ///< outputs are getting their names: ask again when they have
};

/// For the handler of a signal that ends the process right after: removes what is unfinished. Safe in handlers (it
/// allocates nothing, and no thread can be within the list while one of its own handlers runs). Unless it says not_now,
/// whoever opens or names an output afterwards waits for ever.
Discarded discard_unfinished() noexcept;

/// A file for reading and writing in `folder` ("" is the current one) that has no name: it is gone when its descriptor
/// is closed, however the program ends. -1 and errno where the folder does not let it be.
int open_nameless(const std::filesystem::path& folder);

}  // namespace libchar
