#pragma once
// Which batch each device of a fleet is of. A batch is of a production lot: a device has one, whatever its recordings say.

#include <span>
#include <string>
#include <vector>

#include "libchar/lot/device_record.hpp"

namespace libchar {

struct DeviceBatches {
  std::vector<std::size_t> device_of;  ///< of each record; devices are numbered as they come
  /// Of each device: the first, in natural order, of the batches stated by its recordings.
  std::vector<std::string> batch;
  /// Devices with recordings in several, by name and where they count; empty: none.
  std::string note;
};

/// One name and type is one device.
DeviceBatches device_batches(std::span<const DeviceRecord> records);

/// "batch 7", "no batch".
std::string batch_title(const std::string& batch);

}  // namespace libchar
