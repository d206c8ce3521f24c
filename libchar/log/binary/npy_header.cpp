#include "libchar/log/binary/npy_header.hpp"

#include <fmt/format.h>

#include <charconv>

#include "libchar/core/error.hpp"
#include "libchar/core/text/utf8.hpp"
#include "libchar/log/binary/file.hpp"

namespace libchar {
namespace {

// One pass over the literal {'descr': …, 'fortran_order': …, 'shape': …}: its structure is fixed,
// so no recursion is needed.
class Literal {
 public:
  Literal(std::string_view text, std::uint64_t first_byte, const std::string& file)
      : text_(text), first_byte_(first_byte), file_(file) {}

  void read(NpyHeader& header) {
    expect('{');
    bool descr = false, order = false, shape = false;
    while (peek() != '}') {
      const std::size_t at = position_;
      const std::string key = string();
      bool& seen = key == "descr"           ? descr
                   : key == "fortran_order" ? order
                   : key == "shape"         ? shape
                                            : refuse_key(key, at);
      if (seen) refuse("E0406", "a key stands twice in the header", key, at);
      seen = true;
      expect(':');
      if (key == "descr")
        read_descr(header);
      else if (key == "shape")
        header.shape = read_shape();
      else
        header.fortran_order = read_bool();
      if (peek() == ',')
        ++position_;
      else if (peek() != '}')
        refuse("E0407", "expected , or } in the header", word(), position_);
    }
    ++position_;
    skip_blanks();
    if (position_ != text_.size())
      refuse("E0407", "text stands behind the header's }", word(), position_);
    if (!descr || !order || !shape)
      refuse("E0407",
             fmt::format("the header has no key \"{}\"",
                         !descr   ? "descr"
                         : !order ? "fortran_order"
                                  : "shape"),
             "",
             0);
  }

 private:
  [[noreturn]] void refuse(const char* code,
                           std::string what,
                           std::string_view got,
                           std::size_t at,
                           std::string field = "",
                           std::string hint = "") const {
    const std::string name = field.empty() ? "" : ", field " + field;
    throw Error({ErrorKind::input,
                 code,
                 fmt::format("{} (byte {}{})", file_, first_byte_ + at, name),
                 std::move(what),
                 std::string(got),
                 std::move(hint)});
  }
  bool& refuse_key(const std::string& key, std::size_t at) const {
    refuse("E0406",
           "unknown key in the header; a .npy header has descr, fortran_order and shape",
           key,
           at);
  }

  void skip_blanks() {
    while (position_ < text_.size() && (text_[position_] == ' ' || text_[position_] == '\t' ||
                                        text_[position_] == '\n' || text_[position_] == '\r'))
      ++position_;
  }
  char peek() {
    skip_blanks();
    return position_ < text_.size() ? text_[position_] : '\0';
  }
  std::string_view word() const { return text_.substr(std::min(position_, text_.size()), 40); }
  void expect(char c) {
    if (peek() != c)
      refuse("E0407", fmt::format("expected {} in the header", c), word(), position_);
    ++position_;
  }

  std::string string() {
    const char quote = peek();
    if (quote != '\'' && quote != '"')
      refuse("E0407", "expected a quoted string in the header", word(), position_);
    std::string value;
    for (++position_; position_ < text_.size() && text_[position_] != quote; ++position_) {
      if (text_[position_] == '\\') {
        const char next = position_ + 1 < text_.size() ? text_[position_ + 1] : '\0';
        if (next != '\\' && next != '\'' && next != '"')
          refuse("E0407", "unsupported escape in a name", word(), position_);
        ++position_;
      }
      value += text_[position_];
    }
    if (position_ >= text_.size())
      refuse("E0407", "a string in the header does not end", "", position_);
    ++position_;
    return value;
  }

  bool read_bool() {
    const std::size_t at = (skip_blanks(), position_);
    for (const auto& [name, value] : {std::pair{"True", true}, std::pair{"False", false}}) {
      if (text_.substr(position_).starts_with(name)) {
        position_ += std::string_view(name).size();
        return value;
      }
    }
    refuse("E0407", "fortran_order is neither True nor False", word(), at);
  }

  std::uint64_t number() {
    skip_blanks();
    const std::size_t at = position_;
    std::uint64_t value = 0;
    if (peek() == '-') refuse("E0408", "a dimension is negative", word(), at);
    const auto [end, status] =
        std::from_chars(text_.data() + position_, text_.data() + text_.size(), value);
    if (status == std::errc::result_out_of_range)
      refuse("E0408", "a dimension is too large", word(), at);
    if (status != std::errc()) refuse("E0407", "expected a dimension (a whole number)", word(), at);
    position_ = static_cast<std::size_t>(end - text_.data());
    if (position_ < text_.size() && text_[position_] == 'L')
      ++position_;  // Python 2 wrote long integers so
    return value;
  }

  // "(4,)", "(2, 3)", "()"; "(4)" is no tuple.
  std::vector<std::uint64_t> read_shape() {
    const std::size_t at = (skip_blanks(), position_);
    expect('(');
    std::vector<std::uint64_t> shape;
    bool comma = true;
    while (peek() != ')') {
      if (!comma) refuse("E0407", "expected , between dimensions", word(), position_);
      if (shape.size() == 32) refuse("E0408", "the array has more than 32 dimensions", "", at);
      shape.push_back(number());
      comma = peek() == ',';
      if (comma) ++position_;
    }
    ++position_;
    if (shape.size() == 1 && !comma)
      refuse("E0407",
             "the shape is not a tuple: one dimension is written (4,)",
             text_.substr(at, position_ - at),
             at);
    return shape;
  }

  // "<f8" and its kin; everything that is not a plain number is refused by what it is.
  NumberFormat number_type(const std::string& type,
                           std::size_t at,
                           const std::string& field) const {
    const char order = type.empty() ? '\0' : type[0];
    const bool marked = order == '<' || order == '>' || order == '|' || order == '=';
    const std::string kind = marked ? type.substr(1) : type;
    const auto no = [&](std::string what, std::string hint) {
      refuse("E0409", std::move(what), type, at, field, std::move(hint));
    };
    switch (kind.empty() ? '\0' : kind[0]) {
      case 'O':
        no("holds Python objects (pickled code), which are never read",
           "save numbers: array.astype(float)");
        break;
      case 'c':
        no("holds complex numbers", "save real and imaginary parts as two columns");
        break;
      case 'U':
      case 'S':
      case 'a':
        no("holds text, not numbers", "save numbers: array.astype(float)");
        break;
      case 'M':
      case 'm':
        no("holds calendar times",
           "save them as integers: array.astype('datetime64[ns]').astype('int64')");
        break;
      case 'V':
        no("holds opaque bytes", "save numbers: array.astype(float)");
        break;
      case 'b':
        if (kind == "b1") no("holds truth values, not samples", "save numbers: array.astype('u1')");
        break;
      default:
        break;
    }
    static constexpr std::pair<std::string_view, NumberType> kKinds[] = {{"f2", NumberType::f16},
                                                                         {"f4", NumberType::f32},
                                                                         {"f8", NumberType::f64},
                                                                         {"i1", NumberType::i8},
                                                                         {"i2", NumberType::i16},
                                                                         {"i4", NumberType::i32},
                                                                         {"i8", NumberType::i64},
                                                                         {"u1", NumberType::u8},
                                                                         {"u2", NumberType::u16},
                                                                         {"u4", NumberType::u32},
                                                                         {"u8", NumberType::u64}};
    for (const auto& [name, number] : kKinds)
      if (kind == name && (marked || size_of(number) == 1)) return {number, order == '>'};
    no("is of a type that is not read; f2, f4, f8, i1 to i8 and u1 to u8 are",
       kind == "f16" || kind == "f12" ? "save doubles: array.astype('f8')" : "");
    return {};
  }

  void add_field(NpyHeader& header, NpyField field) const {
    std::uint64_t bytes = 0;
    if (__builtin_mul_overflow(field.count, size_of(field.number.type), &bytes) ||
        field.count > kMaxColumns)
      refuse("E0408", fmt::format("has more than {} columns", kMaxColumns), "", 0, field.name);
    field.byte = header.item_bytes;
    header.item_bytes += bytes;
    header.fields.push_back(std::move(field));
  }

  void read_descr(NpyHeader& header) {
    if (peek() != '[') {
      const std::size_t at = position_;
      add_field(header, {"", number_type(string(), at, ""), 1, false, 0});
      return;
    }
    header.structured = true;
    ++position_;
    while (peek() != ']') {
      read_field(header);
      if (peek() == ',')
        ++position_;
      else if (peek() != ']')
        refuse("E0407", "expected , or ] in descr", word(), position_);
    }
    ++position_;
    if (header.fields.empty()) refuse("E0409", "the record has no field that holds numbers", "", 0);
  }

  // ('gyr', '<f8', (3,)); the last part is optional.
  void read_field(NpyHeader& header) {
    expect('(');
    if (peek() == '(')
      refuse("E0409", "a field has a title besides its name, which is not read", word(), position_);
    NpyField field;
    field.name = string();
    expect(',');
    const std::size_t at = (skip_blanks(), position_);
    if (peek() == '[')
      refuse("E0409",
             "is a record within a record, which is not read",
             word(),
             at,
             field.name,
             "save it flat, one field a channel");
    const std::string type = string();
    if (peek() == ',') ++position_;
    if (peek() != ')') {
      field.array = true;
      const std::size_t shape_at = position_;
      const std::vector<std::uint64_t> shape =
          peek() == '(' ? read_shape() : std::vector<std::uint64_t>{number()};
      for (const std::uint64_t extent : shape)
        if (__builtin_mul_overflow(field.count, extent, &field.count))
          refuse("E0408", "the shape overflows", "", shape_at, field.name);
    }
    expect(')');
    if (field.name.empty() && type.starts_with("|V")) return skip_padding(header, type, at);
    for (const NpyField& other : header.fields)
      if (other.name == field.name) refuse("E0307", "two fields have one name", field.name, at);
    if (field.name.empty()) refuse("E0409", "a field has no name", type, at);
    if (field.count == 0) refuse("E0408", "the field holds no number", "", at, field.name);
    field.number = number_type(type, at, field.name);
    add_field(header, std::move(field));
  }

  // NumPy writes the holes of an aligned record as ('', '|V4').
  void skip_padding(NpyHeader& header, const std::string& type, std::size_t at) const {
    std::uint64_t bytes = 0;
    const auto [end, status] = std::from_chars(type.data() + 2, type.data() + type.size(), bytes);
    if (status != std::errc() || end != type.data() + type.size() || bytes > (1U << 20U))
      refuse("E0409", "padding of a senseless size", type, at);
    header.item_bytes += bytes;
  }

  std::string_view text_;
  std::uint64_t first_byte_;
  const std::string& file_;
  std::size_t position_ = 0;
};

void check_magic(std::string_view bytes, const std::string& file) {
  const auto refuse = [&](std::string what, const char* hint) {
    throw Error({ErrorKind::input,
                 "E0404",
                 file + " (byte 0)",
                 std::move(what),
                 std::string(bytes.substr(0, 8)),
                 hint});
  };
  if (bytes.starts_with("PK\x03\x04"))
    refuse("is a ZIP archive (.npz), not one array", "`format` npz reads it");
  constexpr std::string_view kMark = "\x93NUMPY";
  if (!bytes.starts_with(kMark)) refuse(wrong_start(bytes, kMark, "a .npy file"), "");
}

}  // namespace

NpyHeader parse_npy_header(std::string_view bytes,
                           std::uint64_t file_bytes,
                           const std::string& file) {
  check_magic(bytes, file);
  const auto refuse = [&](int byte, std::string what) {
    throw Error(
        {ErrorKind::input, "E0405", fmt::format("{} (byte {})", file, byte), std::move(what)});
  };
  if (bytes.size() < 10) refuse(static_cast<int>(bytes.size()), "ends within its header");
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[i]));
  };
  NpyHeader header;
  header.major = static_cast<int>(byte(6));
  if (header.major < 1 || header.major > 3)
    refuse(6, fmt::format("has version {}.{}; versions 1, 2 and 3 are read", byte(6), byte(7)));
  std::uint64_t length = byte(8) | byte(9) << 8U;
  std::size_t begin = 10;
  if (header.major >= 2) {
    if (bytes.size() < 12) refuse(static_cast<int>(bytes.size()), "ends within its header");
    length |= byte(10) << 16U | byte(11) << 24U;
    begin = 12;
  }
  if (length > file_bytes - begin)
    refuse(8, fmt::format("header length {} exceeds the file size {}", length, file_bytes));
  if (length > kMaxNpyHeader)
    refuse(8, fmt::format("header length {} exceeds the limit of {}", length, kMaxNpyHeader));
  std::string literal(bytes.substr(begin, length));
  if (header.major < 3)
    literal = latin1_to_utf8(literal);
  else if (const std::size_t bad = first_invalid_utf8(literal); bad != std::string::npos)
    refuse(static_cast<int>(begin + bad), "the header is not valid UTF-8");
  Literal(literal, begin, file).read(header);
  header.data_byte = begin + length;
  return header;
}

}  // namespace libchar
