#pragma once
// Arrays of one length in one group are the columns of one table, which is a topic: np.savez('log.npz', t=t, gyr=gyr,
// acc=acc) is a table of the fields t, gyr_0, gyr_1… Which arrays belong together, how they are turned, what fields are
// called, which single number is a sampling rate, and blocks of rows: here, for every container.

#include <memory>
#include <string>

#include "libchar/log/arrays/log_array.hpp"
#include "libchar/log/topics/topic_reader.hpp"

namespace libchar {

/// The tables of a container as topics. Throws Error(input) when two arrays have one name (E0307).
std::unique_ptr<TopicReader> array_tables(std::unique_ptr<ArrayContainer> container, const std::string& path);

/// A HDF5 file as a container: the formats hdf5 and matlab (version 7.3) open it. `kind` stands in the dialect
/// ("HDF5"). Throws Error(input): E0465 for what cannot be read, E0467 when the library is not built in.
std::unique_ptr<ArrayContainer> open_hdf5_file(const std::string& path, const std::string& kind);

}  // namespace libchar
