#pragma once
// An .npz archive of named one-dimensional arrays (NumPy enhancement proposal 1 in an uncompressed zip archive, APPNOTE
// 6.3.3, ZIP64 above 4 GiB), which numpy.load reads with allow_pickle=False.

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace libchar {

class NpzWriter {
 public:
  /// `take` gets the bytes of the archive, a piece after the other. Sizes and places from `wide_from` on stand in
  /// extensions (tests have no four gigabytes).
  explicit NpzWriter(std::function<void(std::string_view)> take,
                     std::uint64_t wide_from = std::numeric_limits<std::uint32_t>::max())
      : take_(std::move(take)), wide_from_(wide_from) {}

  void add(const std::string& name, std::span<const double> values);
  void add(const std::string& name, std::span<const std::uint64_t> values);
  void add(const std::string& name, std::span<const std::uint8_t> values);
  /// Texts of fixed width ('<U12'), in UTF-8; what is not is escaped. Asked for several times: the array is four bytes
  /// for each character of the longest, and is never in memory as a whole.
  void add(const std::string& name, std::size_t count, const std::function<const std::string&(std::size_t)>& text);
  /// The directory of the archive; nothing may follow.
  void finish();

 private:
  struct Member {
    std::string name;
    std::uint32_t crc = 0;
    std::uint64_t bytes = 0, at = 0;
  };
  /// Whoever has the data gives them to whoever asks, a piece after the other, twice: for the checksum, which stands in
  /// front, and to be written.
  using GiveData = std::function<void(const std::function<void(std::string_view)>&)>;
  void add_array(const std::string& name, const std::string& type, std::size_t count, std::uint64_t bytes,
                 const GiveData& give);
  void add_bytes(const std::string& name, const std::string& type, std::size_t count, std::string_view data);
  void finish_directory(std::uint64_t at, std::uint64_t size);
  void put(std::string_view bytes);

  std::function<void(std::string_view)> take_;
  std::uint64_t wide_from_, written_ = 0;
  std::vector<Member> members_;
};

}  // namespace libchar
