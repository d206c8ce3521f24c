#pragma once
// Records sorted into devices and into groups of channels that can be compared.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libchar/lot/device_record.hpp"

namespace libchar {

/// Indices into the records.
struct LotPlace {
  std::uint32_t recording = 0, channel = 0;
};

struct LotGroup {
  std::string type, name,
      channel_unit;  ///< the name of a channel or of a kind; the unit in its canonical spelling
  bool of_kind = false;
  std::vector<LotPlace> places;        ///< those of one member follow each other
  std::vector<std::uint32_t> member;   ///< of each place: 0, 1, … in order
  std::vector<std::uint32_t> devices;  ///< of each member
};

struct SortedRecords {
  std::vector<std::size_t> order;      ///< by type, batch, device, log, without copies
  std::vector<std::size_t> device_of;  ///< of each record; kNoDevice: a copy
  std::vector<std::size_t> first;      ///< recording of each device
  std::vector<std::string> batch;      ///< of each device
  std::vector<std::string> notes;
};
inline constexpr std::size_t kNoDevice = static_cast<std::size_t>(-1);

SortedRecords sorted_records(std::span<const DeviceRecord> records);

/// The unit, or "no unit".
std::string unit_title(const std::string& channel_unit);

/// Channels of one type, name and unit; and, where a type has several of one kind and unit, all of them. Kinds first.
std::vector<LotGroup> lot_groups(std::span<const DeviceRecord> records,
                                 const SortedRecords& sorted);

/// Channels of one type and name, and unlike units; records made with unlike settings or versions.
std::vector<std::string> unlike_records(std::span<const DeviceRecord> records,
                                        const SortedRecords& sorted,
                                        const std::vector<LotGroup>& groups);

}  // namespace libchar
