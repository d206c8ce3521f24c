// The .npz format: a ZIP archive of .npy arrays (numpy.savez, numpy.savez_compressed). NumPy writes
// a ZIP64 field into every local header, and members stand at any byte.

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/arrays/array_tables.hpp"
#include "libchar/log/arrays/packed_array.hpp"
#include "libchar/log/arrays/zip_directory.hpp"
#include "libchar/log/binary/file.hpp"
#include "libchar/log/binary/npy_header.hpp"
#include "libchar/log/detail/format.hpp"

namespace libchar {
namespace {

constexpr std::string_view kArraySuffix = ".npy";

// Names with '/' are groups.
std::pair<std::string, std::string> group_and_name(std::string path) {
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos) return {"", std::move(path)};
  return {path.substr(0, slash), path.substr(slash + 1)};
}

// What an array is that a sentence refuses, and what makes the archive as a whole unreadable.
bool only_this_array(const std::string& code) { return code == "E0404" || code == "E0408" || code == "E0409"; }

class NpzFile final : public ArrayContainer {
 public:
  explicit NpzFile(const std::string& path) : file_(path) {
    for (const ZipMember& member : read_zip_directory(file_))
      if (!member.name.ends_with('/')) add_member(member);
  }

  const std::vector<LogArray>& arrays() const override { return arrays_; }
  std::uint64_t bytes_read() const override { return std::min(consumed_, file_.size()); }

  std::vector<std::string> dialect() const override {
    return {fmt::format("ZIP archive of {}, {}", plural(arrays_.size(), "array"),
                        packings_.size() == 2           ? "some compressed"
                        : packings_.contains("deflate") ? "compressed"
                                                        : "not compressed")};
  }

  std::unique_ptr<ArrayCursor> open(std::size_t array, const ArrayRows& rows,
                                    const std::vector<std::uint64_t>& columns) override {
    return open_packed_array(file_, members_[array], rows, columns, consumed_);
  }

 private:
  void add_member(const ZipMember& member) {
    const bool array = member.name.ends_with(kArraySuffix);
    LogArray seen;
    std::tie(seen.group, seen.name) =
        group_and_name(array ? member.name.substr(0, member.name.size() - kArraySuffix.size()) : member.name);
    PackedArray packed{member.stretch, printable(member.name), 0, 0, member.crc, false};
    if (!array)
      seen.why_not = "is not a .npy array";
    else if (!member.why_not.empty())
      seen.why_not = member.why_not;
    else
      read_header(seen, packed);
    if (seen.why_not.empty()) packings_.insert(member.stretch.packing == Packing::stored ? "stored" : "deflate");
    arrays_.push_back(std::move(seen));
    members_.push_back(std::move(packed));
  }

  void read_header(LogArray& seen, PackedArray& packed) {
    std::string front(static_cast<std::size_t>(std::min<std::uint64_t>(packed.stretch.bytes, 12 + kMaxNpyHeader)),
                      '\0');
    PackedBytes(file_, packed.stretch, packed.name).read(std::as_writable_bytes(std::span(front)));
    const std::string where = fmt::format("{}, {}", file_.path(), packed.name);
    NpyHeader header;
    try {
      header = parse_npy_header(front, packed.stretch.bytes, where);
    } catch (const Error& error) {
      if (!only_this_array(error.problem().code)) throw;
      seen.why_not = error.problem().what;
      return;
    }
    for (const NpyField& field : header.fields)
      seen.fields.push_back({field.name, "", field.number, field.byte, field.count, field.array, false});
    seen.element_bytes = packed.element_bytes = header.item_bytes;
    seen.shape = header.shape;
    seen.first_fastest = header.fortran_order;
    packed.data_byte = header.data_byte;
    check_size(header, packed, where);
  }

  static void check_size(const NpyHeader& header, const PackedArray& packed, const std::string& where) {
    std::uint64_t bytes = header.item_bytes;
    bool fits = true;
    for (const std::uint64_t extent : header.shape) fits = fits && !__builtin_mul_overflow(bytes, extent, &bytes);
    // If one dimension is 0 the others are not checked, and the array is left out.
    if (fits && bytes <= packed.stretch.bytes - header.data_byte) return;
    throw input_error("E0410", where)
        .says("is truncated: its shape needs more than the {} bytes there are", packed.stretch.bytes - header.data_byte)
        .hint("copy it again");
  }

  BinaryFile file_;
  std::vector<LogArray> arrays_;
  std::vector<PackedArray> members_;  // beside arrays_
  std::set<std::string_view> packings_;
  std::uint64_t consumed_ = 0;
};

std::unique_ptr<TopicReader> open_npz(const std::string& path, const ReadOptions&) {
  return array_tables(std::make_unique<NpzFile>(path), path);
}

// A ZIP archive whose first member is an array; spreadsheets are ZIP archives too.
bool certain_npz(std::string_view first_bytes) {
  if (!first_bytes.starts_with("PK\x03\x04") || first_bytes.size() < 30) return false;
  const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(first_bytes[i])); };
  return first_bytes.substr(30, byte(26) + 256 * byte(27)).ends_with(kArraySuffix);
}

bool sniff_npz(const std::string& path, std::string_view first_bytes) {
  return certain_npz(first_bytes) || path.ends_with(".npz");
}

}  // namespace

Format npz_format() {
  Format row;
  row.about.name = "npz";
  row.about.title = "NumPy archive";
  row.about.suffixes = {".npz"};
  row.about.units = "as suffixes";
  row.about.rate = "by a time array, or fs";
  row.about.start = "by a time array";
  row.about.topics = true;
  row.certain = certain_npz;
  row.sniff = sniff_npz;
  row.topics = open_npz;
  return row;
}

}  // namespace libchar
