#include "libchar/log/flight/dataflash_format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/binary/file.hpp"

namespace libchar {

// A message is 0xa3 0x95, its type, and as many bytes as its FMT says. It counts when another one begins behind it, or
// the end: of one that lost bytes on its way the rest would be wrong numbers. From where that is not so the next such
// message is looked for byte by byte, and what lies between is counted.

namespace {

constexpr std::byte kFirstMagic{0xa3}, kSecondMagic{0x95};
constexpr std::size_t kDataflashLookedBack = 512;  // a longest message and the front of the next

/// Where the fill at the end of a log begins: pages of flash that were not written are 0xff or 0.
std::uint64_t dataflash_fill(const BinaryFile& file) {
  constexpr std::size_t kStep = 65536;
  std::array<std::byte, kStep> bytes;
  std::uint64_t begin = file.size();
  std::byte fill{0};
  while (begin > 0) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(begin, kStep));
    file.read(begin - count, std::span(bytes).first(count));
    if (begin == file.size()) fill = bytes[count - 1];
    if (fill != std::byte{0} && fill != std::byte{0xff}) return begin;
    std::size_t kept = count;
    while (kept > 0 && bytes[kept - 1] == fill) --kept;
    begin -= count - kept;
    if (kept > 0) return begin;
  }
  return begin;
}

}  // namespace

DataflashWalk::DataflashWalk(const BinaryFile& file, std::size_t block_bytes, const DataflashFormats& formats,
                             Findings& losses)
    : window_(file, block_bytes, kDataflashLookedBack),
      end_(file.size()),
      fill_(dataflash_fill(file)),
      formats_(&formats),
      losses_(&losses) {}

// Do the two magic bytes stand here, with a type behind them?
bool DataflashWalk::is_front(std::uint64_t byte) {
  if (end_ - byte < kDataflashFront) return false;
  const std::byte* front = window_.at(byte, kDataflashFront);
  return front[0] == kFirstMagic && front[1] == kSecondMagic;
}

// Bytes of the message here, 0 when none begins here, its type is not known or the end cuts it.
std::size_t DataflashWalk::whole_length(std::uint64_t byte) {
  if (!is_front(byte)) return 0;
  const std::size_t length = formats_->length(std::to_integer<std::uint8_t>(window_.at(byte, kDataflashFront)[2]));
  return length <= end_ - byte ? length : 0;
}

bool DataflashWalk::cut_by_end(std::uint64_t byte) {
  if (end_ - byte >= kDataflashFront)
    return is_front(byte) &&
           formats_->length(std::to_integer<std::uint8_t>(window_.at(byte, kDataflashFront)[2])) > end_ - byte;
  const std::byte* rest = window_.at(byte, static_cast<std::size_t>(end_ - byte));
  return end_ == byte || (rest[0] == kFirstMagic && (end_ - byte == 1 || rest[1] == kSecondMagic));
}

bool DataflashWalk::well_followed(std::uint64_t byte) {
  return byte == end_ || byte >= fill_ || is_front(byte) || cut_by_end(byte);
}

bool DataflashWalk::next(DataflashMessage& message) {
  std::size_t length = 0;
  while (position_ < end_) {
    length = whole_length(position_);
    if (length > 0 && well_followed(position_ + length)) break;
    pass_over_damage();
  }
  if (position_ >= end_) return false;
  const std::byte* whole = window_.at(position_, length);
  message.byte = position_;
  message.type = std::to_integer<std::uint8_t>(whole[2]);
  message.body = {whole + kDataflashFront, length - kDataflashFront};
  position_ += length;
  return true;
}

std::uint64_t DataflashWalk::next_good(std::uint64_t byte) {
  for (; end_ - byte >= kDataflashFront; ++byte) {
    const std::size_t length = whole_length(byte);
    if (length > 0 && well_followed(byte + length)) return byte;
  }
  return end_;
}

void DataflashWalk::pass_over_damage() {
  const std::uint64_t from = position_;
  if (from >= fill_) {
    position_ = end_;
    return;
  }
  position_ = next_good(from + 1);
  const std::string place = fmt::format("byte {}", from);
  const std::uint64_t bytes = std::min(position_, std::max(fill_, from + 1)) - from;
  if (position_ == end_ && cut_by_end(from))
    losses_->add("cut_message",
                 fmt::format("the log ends inside a message: its last {} bytes were left out", end_ - from), place);
  else if (is_front(from) && whole_length(from) == 0)
    losses_->add("unknown_message", "messages of types that the log does not define were left out", place);
  else
    losses_->add("damaged_bytes", "bytes that are not a message were left out, and messages among them are lost", place,
                 bytes);
}

namespace {

constexpr std::size_t kNameBytes = 4, kFormatBytes = 16, kLabelBytes = 64;

struct Letter {
  char letter;
  NumberType type;
  std::uint32_t bytes;
  double divisor = 1;
  bool text = false;
};

constexpr std::array kLetters = {
    Letter{'b', NumberType::i8, 1},          Letter{'B', NumberType::u8, 1},
    Letter{'h', NumberType::i16, 2},         Letter{'H', NumberType::u16, 2},
    Letter{'i', NumberType::i32, 4},         Letter{'I', NumberType::u32, 4},
    Letter{'q', NumberType::i64, 8},         Letter{'Q', NumberType::u64, 8},
    Letter{'g', NumberType::f16, 2},         Letter{'f', NumberType::f32, 4},
    Letter{'d', NumberType::f64, 8},         Letter{'c', NumberType::i16, 2, 100},
    Letter{'C', NumberType::u16, 2, 100},    Letter{'e', NumberType::i32, 4, 100},
    Letter{'E', NumberType::u32, 4, 100},    Letter{'L', NumberType::i32, 4, 1e7},
    Letter{'M', NumberType::u8, 1},          Letter{'a', NumberType::i16, 2 * kDataflashArray},
    Letter{'n', NumberType::u8, 4, 1, true}, Letter{'N', NumberType::u8, 16, 1, true},
    Letter{'Z', NumberType::u8, 64, 1, true}};

const Letter* find_letter(char letter) {
  const auto found =
      std::find_if(kLetters.begin(), kLetters.end(), [&](const Letter& row) { return row.letter == letter; });
  return found == kLetters.end() ? nullptr : &*found;
}

std::vector<std::string> split_labels(const std::string& labels) {
  std::vector<std::string> names;
  for (std::size_t from = 0; from <= labels.size();) {
    const std::size_t comma = std::min(labels.find(',', from), labels.size());
    names.push_back(labels.substr(from, comma - from));
    from = comma + 1;
  }
  return names;
}

// The label at this place, made unique.
std::string field_name(const std::vector<std::string>& labels, std::size_t position, std::set<std::string>& taken) {
  std::string name = position < labels.size() ? labels[position] : "";
  if (name.empty()) name = fmt::format("field{}", position);
  const std::string base = name;
  for (int again = 2; !taken.insert(name).second; ++again) name = fmt::format("{}_{}", base, again);
  return name;
}

void add_dataflash_fields(const std::vector<std::string>& labels, DataflashKind& kind) {
  std::set<std::string> taken;
  std::uint32_t byte = 0;
  for (std::size_t position = 0; position < kind.format.size(); ++position) {
    const Letter* letter = find_letter(kind.format[position]);
    if (letter == nullptr) {
      kind.why_not = fmt::format("its format has the letter {}", printable(kind.format.substr(position, 1)));
      return;
    }
    DataflashField field;
    field.name = field_name(labels, position, taken);
    field.letter = letter->letter;
    field.type = letter->type;
    field.position = position;
    field.byte = byte;
    field.text = letter->text;
    field.array = letter->letter == 'a';
    field.divisor = letter->divisor;
    byte += letter->bytes;
    kind.fields.push_back(std::move(field));
  }
  if (byte + kDataflashFront != kind.length)
    kind.why_not = fmt::format("its format makes {} bytes and its length says {}", byte + kDataflashFront, kind.length);
}

bool is_clock(const std::string& name) { return name == "TimeUS" || name == "SampleUS" || name == "TimeMS"; }

// The same number as a division where that is exact: n / 100 is nearer to what was meant than n · 0.01.
void set_scale(DataflashField& field, double multiplier) {
  const double inverse = std::round(1 / multiplier);
  const bool divides = multiplier < 1 && std::abs(inverse * multiplier - 1) < 1e-12;
  field.factor = divides ? 1 : multiplier;
  field.divisor = divides ? inverse : 1;
}

}  // namespace

const DataflashField* DataflashKind::find(std::string_view wanted, char letter) const {
  for (const DataflashField& field : fields)
    if (field.name == wanted && field.letter == letter) return &field;
  return nullptr;
}

std::string dataflash_text(std::span<const std::byte> bytes) {
  const std::string_view all(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return std::string(all.substr(0, all.find('\0')));
}

bool is_dataflash_fmt(std::span<const std::byte> body) {
  if (body.size() != kDataflashFmtLength - kDataflashFront) return false;
  if (std::to_integer<std::size_t>(body[1]) < kDataflashFront) return false;
  const std::string name = dataflash_text(body.subspan(2, kNameBytes));
  const std::string format = dataflash_text(body.subspan(2 + kNameBytes, kFormatBytes));
  const auto plain = [](const std::string& text) {
    return std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < 0x7f; });
  };
  return !name.empty() && plain(name) && plain(format);
}

DataflashFormats::DataflashFormats() { rewind(); }

void DataflashFormats::rewind() {
  current_.fill(std::nullopt);
  lengths_.fill(0);
  lengths_[kDataflashFmt] = kDataflashFmtLength;
  changed_behind_ = false;
  used_.assign(kinds_.size(), false);
}

bool DataflashFormats::take(std::uint8_t type, std::span<const std::byte> body) {
  if (type == kDataflashFmt) {
    define(body);
    return true;
  }
  if (!current_[type]) return false;
  const DataflashKind& kind = kinds_[*current_[type]];
  switch (kind.why_not.empty() ? kind.role : DataflashRole::data) {
    case DataflashRole::units_of_kind:
      take_units(kind, body);
      return true;
    case DataflashRole::unit:
      take_unit(kind, body);
      return true;
    case DataflashRole::multiplier:
      take_multiplier(kind, body);
      return true;
    case DataflashRole::data:
      return false;
  }
  return false;
}

void DataflashFormats::define(std::span<const std::byte> body) {
  if (!is_dataflash_fmt(body)) return;
  const auto type = std::to_integer<std::uint8_t>(body[0]);
  if (type == kDataflashFmt) return;
  const std::string text(reinterpret_cast<const char*>(body.data()), body.size());
  const auto [place, fresh] = kind_of_definition_.try_emplace(text, kinds_.size());
  if (fresh) {
    DataflashKind kind;
    kind.type = type;
    kind.length = std::to_integer<std::uint8_t>(body[1]);
    kind.name = dataflash_text(body.subspan(2, kNameBytes));
    kind.format = dataflash_text(body.subspan(2 + kNameBytes, kFormatBytes));
    const auto labels = split_labels(dataflash_text(body.subspan(2 + kNameBytes + kFormatBytes, kLabelBytes)));
    add_dataflash_fields(labels, kind);
    for (std::size_t i = 0; i < kind.fields.size(); ++i)
      if (kind.fields[i].name == "I" && kind.fields[i].type == NumberType::u8 && !kind.fields[i].text)
        kind.instance = i;
    if (kind.name == "FMTU") kind.role = DataflashRole::units_of_kind;
    if (kind.name == "UNIT") kind.role = DataflashRole::unit;
    if (kind.name == "MULT") kind.role = DataflashRole::multiplier;
    kinds_.push_back(std::move(kind));
    used_.push_back(false);
  }
  current_[type] = place->second;
  lengths_[type] = kinds_[place->second].length;
}

void DataflashFormats::take_units(const DataflashKind& kind, std::span<const std::byte> body) {
  const DataflashField* of = kind.find("FmtType", 'B');
  const DataflashField* units = kind.find("UnitIds", 'N');
  const DataflashField* multipliers = kind.find("MultIds", 'N');
  if (of == nullptr || units == nullptr || multipliers == nullptr) return;
  const auto target = current_[std::to_integer<std::uint8_t>(body[of->byte])];
  if (!target) return;
  const Meaning meaning{dataflash_text(body.subspan(units->byte, kFormatBytes)),
                        dataflash_text(body.subspan(multipliers->byte, kFormatBytes))};
  DataflashKind& described = kinds_[*target];
  for (std::size_t i = 0; i < described.fields.size(); ++i) {
    const DataflashField& field = described.fields[i];
    const bool marked = field.position < meaning.units.size() && meaning.units[field.position] == '#';
    if (!marked || field.text || is_float(field.type) || size_of(field.type) != 1) continue;
    if (described.instance != i && used_[*target]) changed_behind_ = true;
    described.instance = i;
    break;
  }
  meanings_[*target] = meaning;
}

void DataflashFormats::take_unit(const DataflashKind& kind, std::span<const std::byte> body) {
  const DataflashField* id = kind.find("Id", 'b');
  const DataflashField* label = kind.find("Label", 'Z');
  if (id != nullptr && label != nullptr)
    units_[static_cast<char>(body[id->byte])] = dataflash_text(body.subspan(label->byte, kLabelBytes));
}

void DataflashFormats::take_multiplier(const DataflashKind& kind, std::span<const std::byte> body) {
  const DataflashField* id = kind.find("Id", 'b');
  const DataflashField* factor = kind.find("Mult", 'd');
  if (id == nullptr || factor == nullptr) return;
  double value = 0;
  read_numbers(body.data() + factor->byte, 0, {NumberType::f64, false}, {&value, 1});
  // Written as doubles, many are floats that were widened: 1e-6 stands as 9.999999974752427e-07.
  const double short_of_it = rounded(value, 7);
  if (std::isfinite(value) && short_of_it > 0) multipliers_[static_cast<char>(body[id->byte])] = short_of_it;
}

namespace {

constexpr std::array<std::string_view, 8> kFamilies = {"GYR", "ACC", "IMU", "MAG", "BARO", "BAR", "ARSP", "ISBD"};

constexpr std::array<std::string_view, 13> kNoSample = {
    "TimeUS", "TimeMS", "SampleUS", "SMS", "Offset", "GndTemp", "GHz", "AHz", "OfsX", "OfsY", "OfsZ", "Primary", "Pri"};

// "IMU2" is of the family IMU: older versions have a message for each sensor.
std::string_view family_of(std::string_view message) {
  const auto found = std::find_if(kFamilies.begin(), kFamilies.end(), [&](std::string_view family) {
    if (!message.starts_with(family)) return false;
    const std::string_view rest = message.substr(family.size());
    return rest.empty() || (rest.size() == 1 && rest[0] >= '1' && rest[0] <= '9');
  });
  return found == kFamilies.end() ? std::string_view() : *found;
}

bool is_axis(std::string_view field, std::string_view front) {
  return field.size() == front.size() + 1 && field.starts_with(front) && field.back() >= 'X' && field.back() <= 'Z';
}

/// The unit of a field as ArduPilot writes it in all versions; "" where it is not known.
std::string dataflash_unit(std::string_view message, std::string_view field) {
  const std::string_view family = family_of(message);
  if (family == "GYR" || family == "IMU" || family == "ACC") {
    if (is_axis(field, "Gyr")) return "rad/s";
    if (is_axis(field, "Acc")) return "m/s^2";
    if (field == "Temp" || field == "T") return "degC";
  }
  if (family == "MAG" && is_axis(field, "Mag")) return "mGauss";
  if (family == "BARO" || family == "BAR") {
    if (field == "Press") return "Pa";
    if (field == "Temp") return "degC";
    if (field == "Alt") return "m";
  }
  return "";
}

/// A UNIT's label as a unit: "UNKNOWN" and "instance" are none, "deglatitude" is "deg", "m/s/s" is "m/s^2".
std::string plain_unit(std::string_view label) {
  if (label == "UNKNOWN" || label == "instance" || label == "satellites") return "";
  if (label == "deglatitude" || label == "deglongitude" || label == "degheading") return "deg";
  if (label == "m/s/s") return "m/s^2";
  if (label == "rad/s/s") return "rad/s^2";
  if (label == "deg/s/s") return "deg/s^2";
  return std::string(label);
}

}  // namespace

void DataflashFormats::apply_units() {
  contradictions_.clear();
  for (std::size_t k = 0; k < kinds_.size(); ++k) {
    const auto meaning = meanings_.find(k);
    if (meaning != meanings_.end()) apply_units(kinds_[k], meaning->second.units, meaning->second.multipliers);
    for (DataflashField& field : kinds_[k].fields) {
      if (meaning == meanings_.end() && field.unit.empty()) field.unit = dataflash_unit(kinds_[k].name, field.name);
      if (!is_clock(field.name)) continue;
      field.unit = field.name == "TimeMS" ? "ms" : "us";
      field.factor = field.divisor = 1;
    }
  }
}

void DataflashFormats::apply_units(DataflashKind& kind, const std::string& units, const std::string& multipliers) {
  for (DataflashField& field : kind.fields) {
    if (field.text || is_clock(field.name)) continue;
    if (field.position < units.size())
      if (const auto unit = units_.find(units[field.position]); unit != units_.end())
        field.unit = plain_unit(unit->second);
    // '-' stands for none and '?' for a multiplier that is not known.
    if (field.position >= multipliers.size()) continue;
    const char id = multipliers[field.position];
    const auto multiplier = multipliers_.find(id);
    if (id == '-' || id == '?' || multiplier == multipliers_.end()) continue;
    const double by_letter = find_letter(field.letter)->divisor;
    set_scale(field, multiplier->second);
    if (by_letter != 1 && field.divisor != by_letter) contradictions_.push_back(kind.name + "." + field.name);
  }
}

bool dataflash_sensor(std::string_view message) { return !family_of(message).empty(); }

bool dataflash_no_sample(std::string_view field) {
  return field.starts_with("MO") || std::find(kNoSample.begin(), kNoSample.end(), field) != kNoSample.end();
}

}  // namespace libchar
