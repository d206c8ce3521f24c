// MATLAB files: version 4, version 5 (with and without compression) and version 7.3, which is HDF5 behind 512 bytes of
// text.

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/arrays/array_tables.hpp"
#include "libchar/log/arrays/log_array.hpp"
#include "libchar/log/arrays/matlab4.hpp"
#include "libchar/log/arrays/packed_array.hpp"
#include "libchar/log/binary/file.hpp"
#include "libchar/log/detail/format.hpp"

namespace libchar {
namespace {

// MATLAB files of version 5 (save -v6 and -v7, SciPy's savemat, Octave's -mat7-binary) as a container of arrays.
// Source: MathWorks, MAT-File Format (R2023b), chapter 1: 128 bytes of header, then data elements,
// compressed or not, matrices within matrices. Read here and not by a library: in constant memory
// where elements are compressed, and without trust in any length.

constexpr std::size_t kHeaderBytes = 128, kMaxStructDepth = 16, kMaxMatrices = 100000;
constexpr std::uint64_t kMaxSmallElement = 1U << 20U;  // dimensions, names: whatever is held in memory

// Data types of elements.
enum : std::uint32_t { kInt8 = 1, kMatrix = 14, kCompressed = 15 };
// Classes of arrays.
enum : std::uint32_t {
  kCell = 1,
  kStruct = 2,
  kObject = 3,
  kChar = 4,
  kSparse = 5,
  kDouble = 6,
  kUint64 = 15,
  kOpaque = 17
};
constexpr std::uint32_t kLogicalFlag = 0x02, kComplexFlag = 0x08;

std::optional<NumberType> number_type_of(std::uint32_t type) {
  switch (type) {
    case 1:
      return NumberType::i8;
    case 2:
      return NumberType::u8;
    case 3:
      return NumberType::i16;
    case 4:
      return NumberType::u16;
    case 5:
      return NumberType::i32;
    case 6:
      return NumberType::u32;
    case 7:
      return NumberType::f32;
    case 9:
      return NumberType::f64;
    case 12:
      return NumberType::i64;
    case 13:
      return NumberType::u64;
    default:
      return std::nullopt;
  }
}

// Bytes of the file, or of a compressed element, in order.
class Source {
 public:
  Source(const BinaryFile& file, PackedStretch stretch, bool big_endian)
      : file_(file), stretch_(stretch), bytes_(file, stretch, "compressed element"), big_endian_(big_endian) {}

  std::uint64_t position() const { return bytes_.position(); }
  const PackedStretch& stretch() const { return stretch_; }
  bool big_endian() const { return big_endian_; }
  std::uint64_t left() const { return stretch_.bytes - bytes_.position(); }
  void skip(std::uint64_t count) { bytes_.skip(count); }
  std::string text(std::uint64_t count) {
    std::string out(static_cast<std::size_t>(count), '\0');
    bytes_.read(std::as_writable_bytes(std::span(out)));
    return out;
  }
  std::uint32_t u32() { return u32_of(text(4), 0); }
  std::uint32_t u32_of(std::string_view bytes, std::size_t at) const {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
      value = value << 8U | static_cast<unsigned char>(bytes[at + (big_endian_ ? i : 3 - i)]);
    return value;
  }
  [[noreturn]] void refuse(std::string what) const {
    throw input_error("E0464", fmt::format("{} (byte {})", file_.path(),
                                           stretch_.first_byte +
                                               (stretch_.packing == Packing::stored ? position() : std::uint64_t{0})))
        .says(std::move(what))
        .hint("save it again, or copy it again");
  }

 private:
  const BinaryFile& file_;
  PackedStretch stretch_;
  PackedBytes bytes_;
  bool big_endian_;
};

/// The tag in front of every element.
struct Tag {
  std::uint32_t type = 0;
  std::uint64_t bytes = 0;
  std::uint64_t padding = 0;  // behind them, to a multiple of 8
};

// Four bytes or fewer may stand in the second half of the tag itself.
Tag read_tag(Source& from, std::uint64_t end) {
  if (from.position() > end || end - from.position() < 8) from.refuse("ends within an element");
  const std::uint32_t first = from.u32();
  Tag tag;
  if (first > 0xFFFF) {
    tag = {first & 0xFFFFU, first >> 16U, 0};
    if (tag.bytes > 4) from.refuse("has a small element of more than 4 bytes");
    tag.padding = 4 - tag.bytes;
  } else {
    tag = {first, from.u32(), 0};
    tag.padding = tag.type == kCompressed ? 0 : (8 - tag.bytes % 8) % 8;
  }
  if (tag.bytes > end - from.position())
    from.refuse("has an element that is longer than what holds it: it is cut or damaged");
  return tag;
}

// The padding of the last element may be missing.
void skip_padding(Source& from, const Tag& tag, std::uint64_t end) {
  from.skip(std::min(tag.padding, end - from.position()));
}

std::string read_small(Source& from, const Tag& tag, std::uint64_t end) {
  if (tag.bytes > kMaxSmallElement) from.refuse("has a name or a shape of more than a megabyte");
  std::string bytes = from.text(tag.bytes);
  skip_padding(from, tag, end);
  return bytes;
}

struct MatrixHead {
  std::uint32_t kind = 0, flags = 0;
  std::vector<std::uint64_t> shape;
  std::string name;
  std::string type;  ///< class of an object
};

MatrixHead read_head(Source& from, std::uint64_t end) {
  MatrixHead head;
  Tag tag = read_tag(from, end);
  const std::string flags = read_small(from, tag, end);
  if (flags.size() != 8) from.refuse("has an array without its flags");
  head.kind = from.u32_of(flags, 0) & 0xFFU;
  head.flags = from.u32_of(flags, 0) >> 8U & 0xFFU;
  if (head.kind == kOpaque) {  // an object: its name, "MCOS", its class
    for (std::string* text : {&head.name, &head.type, &head.type}) {
      tag = read_tag(from, end);
      *text = read_small(from, tag, end);
    }
    return head;
  }
  tag = read_tag(from, end);
  const std::string extents = read_small(from, tag, end);
  if (extents.size() % 4 != 0 || extents.size() > 128) from.refuse("has an array of a senseless shape");
  for (std::size_t at = 0; at < extents.size(); at += 4) {
    const std::uint32_t extent = from.u32_of(extents, at);
    if (extent > 0x7FFFFFFFU) from.refuse("has an array with a negative dimension");
    head.shape.push_back(extent);
  }
  tag = read_tag(from, end);
  if (tag.type != kInt8) from.refuse("has an array without a name");
  head.name = read_small(from, tag, end);
  return head;
}

std::string why_not_class(const MatrixHead& head) {
  switch (head.kind) {
    case kCell:
      return "is a cell array; save its contents as arrays";
    case kObject:
      return "is an object";
    case kChar:
      return "is text";
    case kSparse:
      return "is sparse; save full(x)";
    default:
      break;
  }
  if (head.kind == kOpaque)
    return fmt::format("is an object ({}); save its numbers, e.g. t = seconds(tt.Time); x = tt.Variables;", head.type);
  if (head.kind > kUint64) return "is a function";
  if (head.kind < kDouble) return "is of an unknown class";
  if ((head.flags & kLogicalFlag) != 0) return "holds truth values";
  if ((head.flags & kComplexFlag) != 0) return "holds complex numbers";
  return "";
}

std::uint64_t elements_of(const MatrixHead& head) {
  std::uint64_t count = 1;
  for (const std::uint64_t extent : head.shape)
    if (__builtin_mul_overflow(count, extent, &count)) return ~std::uint64_t{0};
  return count;
}

class Matlab5File final : public ArrayContainer {
 public:
  explicit Matlab5File(const std::string& path) : file_(path) {
    const std::string head = file_.head(kHeaderBytes);
    if (head.size() < kHeaderBytes)
      throw input_error("E0464", file_.path())
          .says("ends at byte {}, inside the {} bytes of a MATLAB file's header", head.size(), kHeaderBytes)
          .hint("copy it again");
    if (head.substr(126) != "IM" && head.substr(126) != "MI")
      throw input_error("E0464", file_.path())
          .says("does not begin like a MATLAB file")
          .hint("save it by MATLAB's -v7, SciPy or Octave's -mat7-binary");
    big_endian_ = head.substr(126) == "MI";
    Source top(file_, {0, file_.size(), file_.size(), Packing::stored}, big_endian_);
    top.skip(kHeaderBytes);
    while (top.left() >= 8) {
      const Tag tag = read_tag(top, file_.size());
      const std::uint64_t end = top.position() + tag.bytes;
      if (tag.type == kCompressed)
        add_compressed(top.position(), tag.bytes);
      else if (tag.type == kMatrix)
        add_matrix(top, end, "", 0);
      top.skip(end - top.position());
      skip_padding(top, tag, file_.size());
    }
    if (top.left() > 0) top.refuse("ends within an element: it is cut");
  }

  const std::vector<LogArray>& arrays() const override { return arrays_; }
  std::uint64_t bytes_read() const override { return std::min(consumed_, file_.size()); }
  std::vector<std::string> dialect() const override {
    return {fmt::format("MATLAB 5{}, {}{}", compressed_ ? ", compressed" : "", plural(arrays_.size(), "array"),
                        big_endian_ ? ", big endian" : "")};
  }
  std::unique_ptr<ArrayCursor> open(std::size_t array, const ArrayRows& rows,
                                    const std::vector<std::uint64_t>& columns) override {
    return open_packed_array(file_, places_[array], rows, columns, consumed_);
  }

 private:
  // How long it is unpacked stands in the tag within; no more than that is read.
  void add_compressed(std::uint64_t first_byte, std::uint64_t packed) {
    compressed_ = true;
    const std::uint64_t most = packed > (~std::uint64_t{0}) / kDeflateRatio ? packed : packed * kDeflateRatio;
    Source inner(file_, {first_byte, packed, most, Packing::zlib}, big_endian_);
    const Tag tag = read_tag(inner, most);
    if (tag.type == kMatrix) add_matrix(inner, inner.position() + tag.bytes, "", 0);
  }

  void leave_out(const std::string& group, std::string name, std::string why) {
    LogArray array;
    array.group = group;
    array.name = std::move(name);
    array.why_not = std::move(why);
    arrays_.push_back(std::move(array));
    places_.emplace_back();
  }

  void add_matrix(Source& from, std::uint64_t end, const std::string& group, std::size_t depth,
                  const std::string& called = "") {
    if (++matrices_ > kMaxMatrices) from.refuse("holds more than 100000 arrays");
    if (end == from.position()) return leave_out(group, called, "is empty");
    MatrixHead head = read_head(from, end);
    if (!called.empty()) head.name = called;
    if (head.name.empty()) return;  // MATLAB's own, behind its objects
    if (head.kind == kStruct) return add_struct(from, end, head, group, depth);
    if (std::string why = why_not_class(head); !why.empty()) return leave_out(group, head.name, std::move(why));
    add_numbers(from, end, head, group);
  }

  void add_numbers(Source& from, std::uint64_t end, const MatrixHead& head, const std::string& group) {
    const Tag tag = read_tag(from, end);
    const auto number = number_type_of(tag.type);
    const std::uint64_t count = elements_of(head);
    if (!number) from.refuse(fmt::format("has an array of type {}, which is not a number", tag.type));
    if (count > tag.bytes || count * size_of(*number) != tag.bytes)
      from.refuse(
          fmt::format("has an array {} whose shape does not fit its {} bytes", printable(head.name), tag.bytes));
    LogArray array;
    array.group = group;
    array.name = head.name;
    array.shape = head.shape;
    array.first_fastest = true;
    // Doubles that are whole may be stored as small integers: what they are is what their class says.
    const bool real = head.kind == kDouble || head.kind == kDouble + 1;
    array.fields.push_back({"", "", {*number, from.big_endian()}, 0, 1, false, real});
    array.element_bytes = size_of(*number);
    places_.push_back({from.stretch(), printable(head.name), from.position(), array.element_bytes, std::nullopt,
                       from.stretch().packing != Packing::stored && group.empty()});
    // Nothing behind the elements is looked at again.
    places_.back().stretch.bytes = from.position() + tag.bytes;
    arrays_.push_back(std::move(array));
  }

  // Fields of all elements of a struct array in turn: the name of each once, then one matrix a field.
  void add_struct(Source& from, std::uint64_t end, const MatrixHead& head, const std::string& group,
                  std::size_t depth) {
    const std::string path = group.empty() ? head.name : group + "/" + head.name;
    Tag tag = read_tag(from, end);
    const std::string length = read_small(from, tag, end);
    if (length.size() != 4) from.refuse("has a struct without the length of its names");
    const std::uint32_t each = from.u32_of(length, 0);
    tag = read_tag(from, end);
    const std::string names = read_small(from, tag, end);
    if (each == 0 || names.size() % each != 0) from.refuse("has a struct with broken names");
    const std::uint64_t elements = elements_of(head), fields = names.size() / each;
    if (depth >= kMaxStructDepth) return leave_out(group, head.name, "is nested too deeply");
    for (std::uint64_t e = 0; e < elements; ++e) {
      for (std::uint64_t f = 0; f < fields; ++f) {
        if (from.position() >= end) from.refuse("has a struct that ends before its fields do");
        tag = read_tag(from, end);
        if (tag.type != kMatrix) from.refuse("has a struct with a field that is not an array");
        const std::uint64_t field_end = from.position() + tag.bytes;
        const std::string_view field(names.data() + f * each, each);
        add_matrix(from, field_end, elements == 1 ? path : fmt::format("{}_{}", path, e), depth + 1,
                   std::string(field.substr(0, field.find('\0'))));
        from.skip(field_end - from.position());
        skip_padding(from, tag, end);
      }
      if (fields == 0) break;
    }
  }

  BinaryFile file_;
  bool big_endian_ = false, compressed_ = false;
  std::size_t matrices_ = 0;
  std::vector<LogArray> arrays_;
  std::vector<PackedArray> places_;  // beside arrays_
  std::uint64_t consumed_ = 0;
};

// Throws Error(input): E0464 for what is broken, with its byte.
std::unique_ptr<ArrayContainer> open_matlab5_file(const std::string& path) {
  return std::make_unique<Matlab5File>(path);
}

bool is_matlab_73(std::string_view first_bytes) {
  return first_bytes.starts_with("MATLAB 7.3 MAT-file") || first_bytes.starts_with("\x89HDF");
}

bool certain_matlab(std::string_view first_bytes) {
  return first_bytes.starts_with("MATLAB 5.0 MAT-file") || first_bytes.starts_with("MATLAB 7.3 MAT-file");
}

std::unique_ptr<TopicReader> open_matlab(const std::string& path, const ReadOptions&) {
  const std::string head = BinaryFile(path).head(32);
  if (is_matlab4(head)) return array_tables(open_matlab4_file(path), path);
  return array_tables(is_matlab_73(head) ? open_hdf5_file(path, "MATLAB 7.3") : open_matlab5_file(path), path);
}

}  // namespace

Format matlab_format() {
  Format row;
  row.about.name = "matlab";
  row.about.title = "MATLAB";
  row.about.suffixes = {".mat"};
  row.about.units = "as suffixes";
  row.about.rate = "by a time array, or fs";
  row.about.start = "by a time array";
  row.about.topics = true;
  row.certain = certain_matlab;
  row.topics = open_matlab;
  return row;
}

}  // namespace libchar
