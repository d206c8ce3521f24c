#pragma once
// Tables made of objects (lines of JSON, messages that ROS prints): an object is a row, and what is nested in it is a
// column called by its path (imu.gyro[0]).

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "libchar/log/csv/made_text.hpp"

namespace libchar::csv {

/// A number or a text of an object.
struct ObjectCell {
  std::string path, text;
  bool quoted = false;
};

struct MadeObject {
  std::string text;  ///< as it is in the file
  std::vector<ObjectCell> cells;
  bool broken = false;  ///< a row that cannot be read
};

class ObjectRows : public MadeText {
 public:
  ObjectRows(std::function<std::size_t(char*, std::size_t)> stored, std::string file)
      : from_{std::move(stored)}, file_(std::move(file)) {}
  void finish(Findings& findings) const final;

 protected:
  /// The next one; counts it in `objects_`.
  virtual std::optional<MadeObject> next() = 0;
  /// The whole file is one object.
  virtual void alone(const MadeObject&) const {}
  bool more(std::string& text) final;
  std::string place() const;

  Feed from_;
  std::string file_;
  std::uint64_t objects_ = 0;

 private:
  void learn(std::string& text);
  void row(const MadeObject& object, std::string& text);

  std::uint64_t late_ = 0;
  std::string first_late_;
  std::deque<MadeObject> head_;
  std::unordered_map<std::string, std::size_t> columns_;
};

/// By the first bytes: messages as `rostopic echo` and `ros2 topic echo` print them.
bool is_echo(std::string_view front);

/// Text of a table, a row for each message.
std::unique_ptr<Unpacker> open_echo_rows(std::function<std::size_t(char*, std::size_t)> stored,
                                         const std::string& file);

}  // namespace libchar::csv
