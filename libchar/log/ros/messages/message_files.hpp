#pragma once
// Definitions of message types in .msg files: those of a folder of packages, and of an installed ROS.

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace libchar {

class MessageFiles {
 public:
  /// Every .msg file below `folder`; "" is none. Error(usage) where there is none.
  explicit MessageFiles(const std::string& folder);
  /// The text of "my_msgs/Reading" and of the types that it uses, as a log would hold it; "" where it has no file.
  std::string given(std::string_view type) const;
  /// The same of packages that are installed (AMENT_PREFIX_PATH, /opt/ros).
  static std::string installed(std::string_view type);

 private:
  std::map<std::string, std::vector<std::filesystem::path>, std::less<>> by_name_;  // "Reading"
};

}  // namespace libchar
