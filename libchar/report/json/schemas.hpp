#pragma once
// JSON Schemas (draft 2020-12) of documents that rows describe. Those of other documents are files in docs/schema.

#include "libchar/core/document/json.hpp"

namespace libchar {

/// "allan.schema.json" and its schema, and so on: an object.
Json schemas();

}  // namespace libchar
