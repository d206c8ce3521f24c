#pragma once
// Partial states as bytes: what one machine has found of its part of a log, for another to go on from. Every number
// comes back with the bits it had, on any machine, and changed bytes are detected, never read:
//
//   magic (8 bytes) | version (4) | length of the content (8) | kind (text) and content | SHA-256 of all before it (32)
//
// Integers and doubles are little-endian, a long double is its 64-bit mantissa and exponent, a text or a list has its
// length in front.
//
// A layout is said once: `at(sums.samples, sums.power)` writes members where `at` is a writer, and fills them where
// it is a reader.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace libchar {

class StateWriter {
 public:
  /// `kind`: what the content is ("stretch"); `version`: of its layout.
  StateWriter(std::string_view kind, std::uint32_t version);
  /// Room for this many more bytes, so that growing does not take twice the memory.
  void reserve(std::size_t bytes) { bytes_.reserve(bytes_.size() + bytes); }

  void number(std::uint64_t value);
  void real(double value) { number(std::bit_cast<std::uint64_t>(value)); }
  void wide(long double value);
  void flag(bool value) { bytes_ += value ? '\1' : '\0'; }
  void text(std::string_view value);
  void texts(std::span<const std::string> values);
  void reals(std::span<const double> values);
  void numbers(std::span<const std::uint64_t> values);
  void flags(std::span<const unsigned char> values);

  template <class... T>
  void operator()(const T&... values) {
    (put(values), ...);
  }
  /// A few values, their number in front.
  template <class... T>
  void group(std::string_view, const T&... values) {
    number(sizeof...(values));
    (put(values), ...);
  }
  /// Each part by `layout`, their number in front.
  template <class T, class Layout>
  void list(const std::vector<T>& parts, std::size_t, Layout layout) {
    number(parts.size());
    for (const T& part : parts) layout(part);
  }

  /// With length and digest. The writer is done.
  std::string finish();

 private:
  void put(std::uint64_t value) { number(value); }
  void put(double value) { real(value); }
  void put(long double value) { wide(value); }
  void put(bool value) { flag(value); }
  void put(const std::string& value) { text(value); }
  void put(const std::vector<std::string>& values) { texts(values); }
  void put(const std::vector<double>& values) { reals(values); }
  void put(const std::vector<std::uint64_t>& values) { numbers(values); }
  void put(const std::vector<unsigned char>& values) { flags(values); }

  std::string bytes_;
};

class StateReader {
 public:
  /// `name`: of the state, for messages. The bytes must stay. Throws Error(input) unless they are whole, of this kind
  /// and version.
  StateReader(std::string_view bytes, std::string name, std::string_view kind, std::uint32_t version);

  std::uint64_t number();
  double real() { return std::bit_cast<double>(number()); }
  long double wide();
  bool flag();
  std::string text();
  std::vector<std::string> texts();
  std::vector<double> reals();
  std::vector<std::uint64_t> numbers();
  std::vector<unsigned char> flags();
  /// Number of elements of a list; each takes at least `least` bytes.
  std::size_t count(std::size_t least);

  template <class... T>
  void operator()(T&... values) {
    (get(values), ...);
  }
  /// Refuses another number of them as contradicting `what`.
  template <class... T>
  void group(std::string_view what, T&... values) {
    if (number() != sizeof...(values)) refuse(what);
    (get(values), ...);
  }
  /// `least`: bytes that a part takes.
  template <class T, class Layout>
  void list(std::vector<T>& parts, std::size_t least, Layout layout) {
    parts.resize(count(least));
    for (T& part : parts) layout(part);
  }

  const std::string& name() const { return name_; }
  /// Throws Error(input): the content contradicts itself. No whole state of ours does.
  [[noreturn]] void refuse(std::string_view what) const;
  /// Throws Error(input) unless all was read.
  void finish() const;

 private:
  std::string_view take(std::size_t bytes);
  void get(std::uint64_t& value) { value = number(); }
  void get(double& value) { value = real(); }
  void get(long double& value) { value = wide(); }
  void get(bool& value) { value = flag(); }
  void get(std::string& value) { value = text(); }
  void get(std::vector<std::string>& values) { values = texts(); }
  void get(std::vector<double>& values) { values = reals(); }
  void get(std::vector<std::uint64_t>& values) { values = numbers(); }
  void get(std::vector<unsigned char>& values) { values = flags(); }

  std::string name_;
  std::string_view rest_;
};

}  // namespace libchar
