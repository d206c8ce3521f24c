// The tables of keys in docs/ are those that the readers and writers use. With LIBCHAR_WRITE_DOCS
// set in the environment they are brought up to date.

#include "libchar/core/document/fields.hpp"
#include "libchar/log/binary/sidecar.hpp"
#include "libchar/log/reading_fields.hpp"
#include "libchar/model/model_fields.hpp"
#include "libchar/model/noise_limits.hpp"
#include "libchar/scene/detail/scene_fields.hpp"
#include "tests/support/docs_table.hpp"

using namespace libchar;

namespace {

template <class T>
void check_table(const std::string& file, const std::string& name, const Fields<T>& fields) {
  test::check_docs_table(file, "keys", name, markdown_table(fields));
}

}  // namespace

TEST_CASE("the tables of keys in docs are those of the readers") {
  check_table("models.md", "sensor model", model_fields());
  check_table("recordings.md", "limits", limits_fields());
  check_table("recordings.md", "limit", limit_block_fields());
  check_table("formats.md", "sidecar", sidecar_fields());
  check_table("scenes.md", "scene", scene_fields());
  check_table("scenes.md", "sensor", sensor_fields());
  check_table("scenes.md", "reference", reference_fields());
  test::check_docs_table("scenes.md", "keys", "signal kinds", signal_kinds_table());
  check_table("scenes.md", "align", align_fields());
  check_table("scenes.md", "tilt", tilt_fields());
  check_table("scenes.md", "fault", fault_fields());
  check_table("scenes.md", "simulation", simulation_fields());
  check_table("scenes.md", "recording", scene_reading_fields());
}
