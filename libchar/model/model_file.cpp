// A YAML library prints 200 for 200.0 and 0.33333333333333331 for a third, and a number such as 1e-05
// is text to YAML 1.1 readers: core/fields writes numbers with a decimal point that read back to the
// same double.

#include "libchar/model/model_file.hpp"

#include "libchar/model/model_fields.hpp"

namespace libchar {

std::string model_yaml(const SensorModel& model) {
  return "# Noise of one sensor channel. Keys name each term in full.\n" +
         yaml_of(model_entries(model));
}

}  // namespace libchar
