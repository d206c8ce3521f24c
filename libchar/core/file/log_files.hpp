#pragma once
// The files of one log: rosbag2 records into a folder of parts, which its metadata.yaml lists in order.
// Readers read them, and whoever asks whether a log is still what it was takes the digest of them all.

#include <filesystem>
#include <string>
#include <vector>

namespace libchar {

/// The file by which a log is named: the metadata.yaml of a folder of rosbag2, else the path itself.
std::string named_log_file(const std::string& path);

/// Is this file the metadata.yaml of rosbag2?
bool is_rosbag2(const std::string& file);

namespace detail {
/// Is this a folder with files of CSV (.csv, .tsv), as phones write one for each sensor?
bool is_folder_of_tables(const std::string& path);

/// Is this in the folder or below it, links followed?
bool is_beneath(const std::filesystem::path& file, const std::filesystem::path& folder);

/// Is this below /proc or /sys? Some of what the kernel shows there calls itself a regular file and has no end.
bool is_of_the_kernel(const std::filesystem::path& file);
}  // namespace detail

/// Of a folder of tables these in the order of their names; else the file itself and, of a metadata.yaml of rosbag2,
/// the parts behind it in their order, all of its folder. Throws Error(input) for a part that is not there and a list
/// that cannot be read.
std::vector<std::string> files_of_log(const std::string& file);

/// What to call a log in the names of files: its name without suffix, of a recording of rosbag2 that of its folder.
std::string stem_of_log(const std::string& file);

/// What to call logs side by side: by their stems, by their whole paths where two have one.
std::vector<std::string> names_of_logs(const std::vector<std::string>& files);

}  // namespace libchar
