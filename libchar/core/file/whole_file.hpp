#pragma once
// Output files are whole or absent: written under no name (or a temporary one) in the target's folder, flushed to disk
// and given their name only by commit(). Until then they are locked: no other run, here or on another machine, takes
// them for litter.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace libchar {

class WholeFile {
 public:
  /// Opens for writing. Throws Error(output) when `path` exists and `overwrite` is false or the file is read-only, or
  /// when the folder cannot be written. A file that is overwritten hands on its owner, group and rights. A device, a
  /// pipe or an open file of this process (/dev/stdout) is written through as bytes come: it can be neither replaced
  /// nor kept back.
  explicit WholeFile(std::string path, bool overwrite = false);
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;
  WholeFile(WholeFile&& other) noexcept;
  /// Discards everything unless commit() was called.
  ~WholeFile();

  void write(std::string_view bytes);
  void write(const void* data, std::size_t size) { write({static_cast<const char*>(data), size}); }
  /// Replaces bytes at `offset` that were written before (for headers that hold a count). Throws Error(output) where
  /// more was written than is kept back and the file is a pipe.
  void rewrite(std::size_t offset, std::string_view bytes);
  /// All bytes get to the disk.
  void flush_to_disk();
  /// Everything of commit() that can fail for want of space or rights, short of taking the name. The folder is locked.
  void prepare();
  /// Throws Error(output) where the name has been taken since: by a folder, or, unless files are overwritten,
  /// by anything.
  void refuse_taken() const;
  /// fsync, the name, fsync of the folder, which is locked meanwhile. Throws Error(output) and leaves an older
  /// file untouched on failure.
  void commit();
  /// The same in a folder that is locked already.
  void commit_in_locked_folder();
  const std::string& path() const { return path_; }
  /// A device, a pipe or an open file of this process, which is written through and has its name already.
  bool special() const { return special_; }
  /// After prepare(): the name under which the file waits for its own; empty for a device or pipe.
  const std::string& temporary() const { return temporary_; }
  /// After prepare(): somebody else gives the file its name; the destructor leaves it where it is.
  void hand_over();

 private:
  bool open_through();
  void flush();
  void close_device();
  bool link_to(const std::string& name) const;
  bool take_free_name();
  [[noreturn]] void fail(std::string_view doing) const;
  std::string path_, temporary_, buffer_;
  int descriptor_ = -1;
  std::int64_t begin_ = 0;  ///< place of our first byte in the file; negative where nothing can be gone back to
  bool flushed_ = false, on_disk_ = false, overwrite_ = false, special_ = false;
};

/// The path leads to a device, a pipe or an open file of this process (/dev/stdout): its folder is not a place for
/// files.
bool writes_through(const std::string& path);

/// Throws what the constructor of WholeFile would, before any work is done for the file; leaves nothing behind.
void check_output(const std::string& path, bool overwrite);

/// New names in the folder get to the disk: best effort, not every file system lets a folder be synchronised.
void sync_folder(const std::string& folder);

/// One call for small files.
void write_whole_file(const std::string& path, std::string_view bytes, bool overwrite = false);

}  // namespace libchar
