#include "libchar/log/ros/messages/message_program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/log/recording.hpp"
#include "libchar/log/ros/messages/message_definition.hpp"

namespace libchar {
namespace {

constexpr int kDeepest = 24;
constexpr std::size_t kMostNodes = 50000;  // fields of fields that are gone through

std::uint64_t size_of_primitive(Primitive kind) {
  switch (kind) {
    case Primitive::boolean:
    case Primitive::i8:
    case Primitive::u8:
      return 1;
    case Primitive::i16:
    case Primitive::u16:
      return 2;
    case Primitive::i32:
    case Primitive::u32:
    case Primitive::f32:
      return 4;
    default:
      return 8;
  }
}

std::uint64_t alignment_of(Wire wire, Primitive kind) {
  if (wire == Wire::ros1) return 1;
  if (kind == Primitive::time) return 4;
  return std::min<std::uint64_t>(size_of_primitive(kind), wire == Wire::cdr ? 8 : 4);
}

std::uint64_t padding(std::uint64_t position, std::uint64_t alignment) {
  return (alignment - position % alignment) % alignment;
}

template <typename T>
T load(const std::byte* from, bool swap) {
  using Bits = std::conditional_t<sizeof(T) == 1, std::uint8_t,
                                  std::conditional_t<sizeof(T) == 2, std::uint16_t,
                                                     std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>>;
  Bits bits = 0;
  std::memcpy(&bits, from, sizeof bits);
  if (swap) {
    if constexpr (sizeof(T) == 2) bits = __builtin_bswap16(bits);
    if constexpr (sizeof(T) == 4) bits = __builtin_bswap32(bits);
    if constexpr (sizeof(T) == 8) bits = __builtin_bswap64(bits);
  }
  return std::bit_cast<T>(bits);
}

constexpr std::int64_t kSecond = 1000000000;

std::int64_t saturated(std::int64_t seconds, std::int64_t nanoseconds) {
  return seconds * kSecond + nanoseconds;  // 2^32 seconds fit
}

std::int64_t load_time(const std::byte* from, Primitive kind, bool swap) {
  if (kind == Primitive::time1) return saturated(load<std::uint32_t>(from, swap), load<std::uint32_t>(from + 4, swap));
  if (kind == Primitive::duration1)
    return saturated(load<std::int32_t>(from, swap), load<std::int32_t>(from + 4, swap));
  return saturated(load<std::int32_t>(from, swap), load<std::uint32_t>(from + 4, swap));
}

// Microseconds of a stamp that is a plain number (px4_msgs).
std::int64_t stamp_of_number(const std::byte* from, bool swap) {
  const auto us = load<std::uint64_t>(from, swap);
  return us < std::uint64_t{1} << 53U ? static_cast<std::int64_t>(us) * 1000 : std::numeric_limits<std::int64_t>::max();
}

struct Walk {
  const std::byte* data = nullptr;
  std::uint64_t size = 0, at = 0;
  bool swap = false;
  double* row = nullptr;
  std::int64_t* stamp = nullptr;
  std::uint64_t* rounded = nullptr;
  bool other_length = false;
};

double count_rounded(double value, bool exact, std::uint64_t* rounded) {
  if (!exact) ++*rounded;
  return value;
}

double load_number(const std::byte* from, Primitive kind, const Walk& walk) {
  const bool swap = walk.swap;
  switch (kind) {
    case Primitive::boolean:
      return load<std::uint8_t>(from, swap) != 0 ? 1 : 0;
    case Primitive::i8:
      return load<std::int8_t>(from, swap);
    case Primitive::u8:
      return load<std::uint8_t>(from, swap);
    case Primitive::i16:
      return load<std::int16_t>(from, swap);
    case Primitive::u16:
      return load<std::uint16_t>(from, swap);
    case Primitive::i32:
      return load<std::int32_t>(from, swap);
    case Primitive::u32:
      return load<std::uint32_t>(from, swap);
    case Primitive::i64: {
      const auto whole = load<std::int64_t>(from, swap);
      const auto value = static_cast<double>(whole);
      return count_rounded(value, value < 0x1p63 && static_cast<std::int64_t>(value) == whole, walk.rounded);
    }
    case Primitive::u64: {
      const auto whole = load<std::uint64_t>(from, swap);
      const auto value = static_cast<double>(whole);
      return count_rounded(value, value < 0x1p64 && static_cast<std::uint64_t>(value) == whole, walk.rounded);
    }
    case Primitive::f32:
      return load<float>(from, swap);
    case Primitive::f64:
      return load<double>(from, swap);
    default: {
      const std::int64_t ns = load_time(from, kind, swap);
      const std::int64_t whole_s = ns / kSecond;
      return static_cast<double>(whole_s) + static_cast<double>(ns % kSecond) * 1e-9;
    }
  }
}

void take(const std::byte* from, Primitive kind, std::uint32_t slot, Walk& walk) {
  if (slot == kStampSlot)
    *walk.stamp = kind == Primitive::u64 ? stamp_of_number(from, walk.swap) : load_time(from, kind, walk.swap);
  else
    walk.row[slot] = load_number(from, kind, walk);
}

bool advance(Walk& walk, std::uint64_t bytes) {
  if (walk.size - walk.at < bytes) return false;
  walk.at += bytes;
  return true;
}

// A count or the length of a text.
bool read_count(Wire wire, Walk& walk, std::uint64_t& count) {
  if (!advance(walk, padding(walk.at, alignment_of(wire, Primitive::u32)))) return false;
  if (walk.size - walk.at < 4) return false;
  count = load<std::uint32_t>(walk.data + walk.at, walk.swap);
  walk.at += 4;
  return true;
}

bool walk_steps(const MessageProgram& program, Walk& walk);

bool walk_texts(Wire wire, std::uint64_t count, Walk& walk) {
  for (std::uint64_t i = 0; i < count; ++i) {
    std::uint64_t length = 0;
    if (!read_count(wire, walk, length) || !advance(walk, length)) return false;
  }
  return true;
}

bool walk_numbers(const ProgramStep& step, Wire wire, std::uint64_t count, Walk& walk) {
  if (count != step.slots.size() && !step.slots.empty()) walk.other_length = true;
  if (count == 0) return true;
  const std::uint64_t size = size_of_primitive(step.number);
  if (!advance(walk, padding(walk.at, alignment_of(wire, step.number)))) return false;
  if ((walk.size - walk.at) / size < count) return false;
  const std::size_t listed = std::min(detail::in_memory(count), step.slots.size());
  for (std::size_t i = 0; i < listed; ++i)
    if (step.slots[i] != kNoSlot) take(walk.data + walk.at + i * size, step.number, step.slots[i], walk);
  walk.at += count * size;
  return true;
}

bool walk_messages(const ProgramStep& step, std::uint64_t count, Walk& walk) {
  if (step.counted && count != step.elements.size() && !step.elements.empty()) walk.other_length = true;
  if (step.rest.empty()) return true;
  // Every element has a byte at least, so that no count keeps this loop going beyond the message.
  if (walk.size - walk.at < count) return false;
  for (std::uint64_t i = 0; i < count; ++i)
    if (!walk_steps(i < step.elements.size() ? step.elements[detail::in_memory(i)] : step.rest.front(), walk))
      return false;
  return true;
}

bool walk_stretch(const ProgramStep& step, Wire wire, Walk& walk) {
  const FixedStretch& stretch = step.stretch[wire == Wire::ros1 ? 0 : walk.at & 7U];
  if (walk.size - walk.at < stretch.bytes) return false;
  const std::byte* begin = walk.data + walk.at;
  for (const Take& one : stretch.takes) take(begin + one.offset, one.kind, one.slot, walk);
  walk.at += stretch.bytes;
  return true;
}

bool walk_steps(const MessageProgram& program, Walk& walk) {
  for (const ProgramStep& step : program.steps) {
    if (step.kind == ProgramStep::Kind::stretch) {
      if (!walk_stretch(step, program.wire, walk)) return false;
      continue;
    }
    std::uint64_t count = step.count;
    if (step.counted && !read_count(program.wire, walk, count)) return false;
    const bool well = step.kind == ProgramStep::Kind::texts     ? walk_texts(program.wire, count, walk)
                      : step.kind == ProgramStep::Kind::numbers ? walk_numbers(step, program.wire, count, walk)
                                                                : walk_messages(step, count, walk);
    if (!well) return false;
  }
  return true;
}

// A number in a stretch that is being laid out; `count` of them with fields from `field` on, or none with any.
struct Piece {
  Primitive kind;
  std::uint64_t count;
  std::size_t field;  // of the first; kNoSlot = no fields
};

class Compiler {
 public:
  Compiler(const MessageTypes& types, const CompileOptions& options) : types_(types), options_(options) {
    walk_.data = options.example.data();
    walk_.size = options.example.size();
    if (options.wire != Wire::ros1 && walk_.size >= 4) {
      walk_.swap = read_encapsulation(options.example).big_endian;
      walk_.data += 4;
      walk_.size -= 4;
    }
    has_example_ = !options.example.empty();
  }

  CompiledMessage compile(std::string_view type) {
    Place place;
    CompiledMessage result;
    result.program = compile_type(std::string(type), place);
    result.problem = problem_;
    result.fields = std::move(fields_);
    result.stamp = stamp_;
    result.oversized = oversized_;
    return result;
  }

 private:
  // Where a field stands: what it inherits from those around it.
  struct Place {
    std::string prefix;
    std::string unit;
    bool usual = true;
    bool listed = true;  // its numbers are fields
    int depth = 0;
  };

  // What is being laid out: steps so far, and the stretch that is open.
  struct Draft {
    MessageProgram program;
    std::vector<Piece> open;
  };

  MessageProgram compile_type(const std::string& type, const Place& place) {
    Draft draft;
    draft.program.wire = options_.wire;
    add_type(type, place, draft);
    close(draft);
    return std::move(draft.program);
  }

  void add_type(const std::string& type, const Place& place, Draft& draft) {
    const MessageType* found = find_type(type);
    if (found == nullptr) return fail(fmt::format("the definition of {} is missing", type));
    if (place.depth > kDeepest) return fail(fmt::format("{} is nested too deep", type));
    // An empty type has one byte in CDR.
    if (found->fields.empty() && options_.wire != Wire::ros1) add_piece({Primitive::u8, 1, kNoSlot}, draft);
    for (const MessageField& field : found->fields) {
      if (!problem_.empty()) return;
      if (++nodes_ > kMostNodes) return fail("its definition is too large");
      add_field(type, field, place, draft);
    }
  }

  const MessageType* find_type(const std::string& type) const {
    const auto found = types_.find(type);
    return found != types_.end() ? &found->second : nullptr;
  }

  void add_field(const std::string& type, const MessageField& field, const Place& around, Draft& draft) {
    Place place = around;
    place.prefix += (around.prefix.empty() ? "" : ".") + field.name;
    const KnownMember known = known_member(type, field.name);
    if (!known.unit.empty()) place.unit = known.unit;
    if (!known.usual) place.usual = false;
    ++place.depth;
    if (field.kind == Primitive::wide_text)
      return fail(fmt::format("its field {} is wide text (wstring)", place.prefix));
    if (field.kind == Primitive::text) return add_texts(field, draft);
    if (field.kind == Primitive::message) return add_messages(field, place, draft);
    add_numbers(type, field, place, draft);
  }

  void add_texts(const MessageField& field, Draft& draft) {
    close(draft);
    ProgramStep step;
    step.kind = ProgramStep::Kind::texts;
    step.counted = field.repeat == Repeat::variable;
    step.count = field.count;
    draft.program.least_bytes += 4;
    draft.program.steps.push_back(std::move(step));
    follow(draft.program.steps.back());
  }

  // The example is walked beside the compilation.
  void follow(const ProgramStep& step) {
    if (!has_example_) return;
    MessageProgram one;
    one.wire = options_.wire;
    one.steps.push_back(step);
    if (!walk_steps(one, walk_)) misfit();
  }

  // An example that is not of the type: whoever decodes it finds out.
  void misfit() { has_example_ = false; }

  bool room_for(std::uint64_t count) {
    if (count <= kListedElements && fields_.size() + count <= kMostNumbers) return true;
    oversized_ = true;
    return false;
  }

  void add_numbers(const std::string& type, const MessageField& field, const Place& place, Draft& draft) {
    if (field.repeat != Repeat::variable) {
      const bool listed = place.listed && room_for(field.count);
      Piece piece{field.kind, field.count, listed ? fields_.size() : kNoSlot};
      if (listed && is_stamp(type, field, place)) stamp_ = fields_.size();
      if (listed) list_fields(field, place, field.count);
      return add_piece(piece, draft);
    }
    close(draft);
    ProgramStep step;
    step.kind = ProgramStep::Kind::numbers;
    step.counted = true;
    step.number = field.kind;
    const std::uint64_t count = place.listed ? example_count() : 0;
    if (count > 0 && room_for(count)) {
      const std::size_t first = fields_.size();
      list_fields(field, place, count);
      for (std::size_t i = 0; i < count; ++i) step.slots.push_back(slot(first + i));
    }
    draft.program.least_bytes += 4;
    const bool wanted = std::any_of(step.slots.begin(), step.slots.end(), [](std::uint32_t s) { return s != kNoSlot; });
    if (!wanted) step.slots.clear();
    draft.program.wanted |= wanted;
    draft.program.lists |= wanted;
    draft.program.steps.push_back(std::move(step));
    skip_in_example(draft.program.steps.back());
  }

  // The example has no row to write into.
  void skip_in_example(const ProgramStep& step) {
    ProgramStep bare = step;
    bare.slots.clear();
    follow(bare);
  }

  void list_fields(const MessageField& field, const Place& place, std::uint64_t count) {
    const bool seconds =
        field.kind == Primitive::time || field.kind == Primitive::time1 || field.kind == Primitive::duration1;
    for (std::uint64_t i = 0; i < count; ++i) {
      NumberField number;
      number.name = field.repeat == Repeat::once ? place.prefix : fmt::format("{}[{}]", place.prefix, i);
      number.unit = seconds ? "s" : place.unit;
      number.kind = field.kind;
      number.usual = place.usual;
      fields_.push_back(std::move(number));
    }
  }

  bool is_stamp(const std::string& type, const MessageField& field, const Place& place) const {
    if (stamp_ != kNoSlot || field.repeat != Repeat::once) return false;
    const bool time = field.kind == Primitive::time || field.kind == Primitive::time1;
    if (time && field.name == "stamp") return (place.depth == 2 && type == "std_msgs/Header") || place.depth == 1;
    return place.depth == 1 && field.kind == Primitive::u64 && field.name == "timestamp" &&
           type.starts_with("px4_msgs/");
  }

  std::uint32_t slot(std::size_t field) const {
    return field < options_.slots.size() ? options_.slots[field] : kNoSlot;
  }

  // How many elements the example has here, without going on in it.
  std::uint64_t example_count() const {
    if (!has_example_) return 0;
    Walk ahead = walk_;
    std::uint64_t count = 0;
    return read_count(options_.wire, ahead, count) ? count : 0;
  }

  void add_messages(const MessageField& field, const Place& place, Draft& draft) {
    if (field.repeat == Repeat::once) return add_type(field.type, place, draft);
    close(draft);
    Place bare = place;
    bare.listed = false;
    const bool example = std::exchange(has_example_, false);
    MessageProgram rest = compile_type(field.type, bare);
    has_example_ = example;
    if (!problem_.empty()) return;
    ProgramStep step;
    step.kind = ProgramStep::Kind::messages;
    step.counted = field.repeat == Repeat::variable;
    step.count = field.count;
    if (rest.least_bytes > 0) step.rest.push_back(std::move(rest));
    std::uint64_t count = step.count;
    if (step.counted) {
      count = place.listed ? example_count() : 0;
      if (has_example_ && !read_count(options_.wire, walk_, count)) misfit();
    }
    add_elements(field, place, count, step);
    draft.program.least_bytes += step.counted ? 4 : step.rest.empty() ? 0 : 1;
    const auto any = [&](auto what) { return std::any_of(step.elements.begin(), step.elements.end(), what); };
    const bool wanted = any([](const MessageProgram& p) { return p.wanted; });
    draft.program.lists |= (wanted && step.counted) || any([](const MessageProgram& p) { return p.lists; });
    draft.program.wanted |= wanted;
    if (!wanted) step.elements.clear();
    draft.program.steps.push_back(std::move(step));
  }

  // Programs of the first elements, each with fields of its own, and the example up to the end of the last.
  void add_elements(const MessageField& field, const Place& place, std::uint64_t count, ProgramStep& step) {
    if (step.rest.empty()) return;
    const bool listed = place.listed && room_for(count) && (!step.counted || has_example_);
    for (std::uint64_t i = 0; listed && i < count && problem_.empty(); ++i) {
      Place element = place;
      element.prefix += fmt::format("[{}]", i);
      step.elements.push_back(compile_type(field.type, element));
    }
    if (listed || !has_example_) return;
    if (walk_.size - walk_.at < count) return misfit();
    for (std::uint64_t i = 0; i < count && has_example_; ++i)
      if (!walk_steps(step.rest.front(), walk_)) misfit();
  }

  void add_piece(const Piece& piece, Draft& draft) {
    if (piece.count == 0) return;
    draft.open.push_back(piece);
    const std::uint64_t size = size_of_primitive(piece.kind);
    draft.program.least_bytes = std::min<std::uint64_t>(draft.program.least_bytes + size * piece.count, kHuge);
  }

  // Lays the open stretch out for every position that it may begin at.
  void close(Draft& draft) {
    if (draft.open.empty()) return;
    ProgramStep step;
    const std::size_t variants = options_.wire == Wire::ros1 ? 1 : 8;
    for (std::size_t v = 0; v < variants; ++v) {
      FixedStretch& stretch = step.stretch[v];
      for (const Piece& piece : draft.open) {
        stretch.bytes += padding(v + stretch.bytes, alignment_of(options_.wire, piece.kind));
        const std::uint64_t size = size_of_primitive(piece.kind);
        for (std::uint64_t i = 0; piece.field != kNoSlot && i < piece.count; ++i)
          if (const std::uint32_t to = slot(piece.field + detail::in_memory(i)); to != kNoSlot)
            stretch.takes.push_back({stretch.bytes + i * size, piece.kind, to});
        stretch.bytes = std::min<std::uint64_t>(stretch.bytes + size * piece.count, kHuge);
      }
    }
    draft.open.clear();
    draft.program.wanted |= !step.stretch[0].takes.empty();
    if (has_example_) {
      const FixedStretch& here = step.stretch[options_.wire == Wire::ros1 ? 0 : walk_.at & 7U];
      if (!advance(walk_, here.bytes)) misfit();
    }
    draft.program.steps.push_back(std::move(step));
  }

  void fail(std::string problem) {
    if (problem_.empty()) problem_ = std::move(problem);
  }

  static constexpr std::uint64_t kHuge = std::uint64_t{1} << 50U;

  const MessageTypes& types_;
  const CompileOptions& options_;
  Walk walk_;
  bool has_example_ = false, oversized_ = false;
  std::size_t nodes_ = 0;
  std::vector<NumberField> fields_;
  std::size_t stamp_ = kNoSlot;
  std::string problem_;
};

}  // namespace

Encapsulation read_encapsulation(std::span<const std::byte> message) {
  Encapsulation result;
  if (message.size() < 4 || message[0] != std::byte{0}) return result;
  switch (std::to_integer<int>(message[1])) {
    case 0:
    case 1:
      result.wire = Wire::cdr;
      break;
    case 6:
    case 7:
      result.wire = Wire::cdr2;
      break;
    default:
      return result;
  }
  result.known = true;
  result.big_endian = (std::to_integer<int>(message[1]) & 1) == 0;
  return result;
}

CompiledMessage compile_message(const MessageTypes& types, std::string_view type, const CompileOptions& options) {
  return Compiler(types, options).compile(type);
}

Decoded run_program(const MessageProgram& program, std::span<const std::byte> message, std::span<double> row,
                    std::int64_t& stamp, std::uint64_t& rounded) {
  Walk walk;
  walk.data = message.data();
  walk.size = message.size();
  walk.row = row.data();
  walk.stamp = &stamp;
  walk.rounded = &rounded;
  std::uint64_t spare = 0;  // bytes that a writer may put behind
  if (program.wire != Wire::ros1) {
    const Encapsulation found = read_encapsulation(message);
    if (!found.known || found.wire != program.wire) return Decoded::misfit;
    walk.swap = found.big_endian;
    walk.data += 4;
    walk.size -= 4;
    spare = 3;
  }
  if (program.lists) std::fill(row.begin(), row.end(), kMissing);
  if (!walk_steps(program, walk)) return Decoded::misfit;
  if (walk.size - walk.at > spare) return Decoded::misfit;
  return walk.other_length ? Decoded::other_length : Decoded::well;
}

}  // namespace libchar
