#include "libchar/log/arrays/hdf5_worker.hpp"

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/process/late_library.hpp"
#include "libchar_have.hpp"

#if LIBCHAR_HAVE_HDF5

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <utility>

namespace libchar {
namespace {

#ifdef LIBCHAR_LATE_HDF5
detail::LateLibrary hdf5(LIBCHAR_LATE_HDF5);
#define L(name) LIBCHAR_LATE(hdf5, name);
// clang-format off
L(H5Aclose) L(H5Aexists) L(H5Aget_space) L(H5Aget_type) L(H5Aiterate2) L(H5Aopen) L(H5Aread) L(H5Dclose)
L(H5Dget_create_plist) L(H5Dget_space) L(H5Dget_type) L(H5Dopen2) L(H5Dread) L(H5Eset_auto2) L(H5Fclose) L(H5Fopen)
L(H5Gclose) L(H5Gopen2) L(H5Literate) L(H5Oget_info_by_name2) L(H5PLset_loading_state) L(H5P_CLS_DATASET_ACCESS_ID_g)
L(H5Pclose) L(H5Pcreate) L(H5Pget_chunk) L(H5Pget_external_count) L(H5Pget_filter2) L(H5Pget_layout)
L(H5Pget_nfilters) L(H5Pset_chunk_cache) L(H5Sclose) L(H5Scopy) L(H5Screate_simple) L(H5Sget_simple_extent_dims)
L(H5Sget_simple_extent_ndims) L(H5Sget_simple_extent_npoints) L(H5Sget_simple_extent_type) L(H5Sselect_hyperslab)
L(H5T_NATIVE_DOUBLE_g) L(H5T_NATIVE_FLOAT_g) L(H5T_NATIVE_INT16_g) L(H5T_NATIVE_INT32_g) L(H5T_NATIVE_INT64_g)
L(H5T_NATIVE_INT8_g) L(H5T_NATIVE_UINT16_g) L(H5T_NATIVE_UINT32_g) L(H5T_NATIVE_UINT64_g) L(H5T_NATIVE_UINT8_g)
L(H5Tarray_create2) L(H5Tclose) L(H5Tcopy) L(H5Tcreate) L(H5Tget_array_dims2) L(H5Tget_class) L(H5Tget_member_index)
L(H5Tget_member_name) L(H5Tget_member_type) L(H5Tget_nmembers) L(H5Tget_sign) L(H5Tget_size) L(H5Tget_super)
L(H5Tinsert) L(H5Tis_variable_str) L(H5check_version) L(H5free_memory) L(H5open)
// clang-format on
#undef L
                                                        bool is_here() {
  return hdf5.is_here();
}
#else
bool is_here() { return true; }
#endif

// What H5Oget_info_by_name2 fills in; 1.12 gave the plain name to another structure.
#if H5_VERSION_GE(1, 12, 0)
using ObjectInfo = H5O_info1_t;
#else
using ObjectInfo = H5O_info_t;
#endif

constexpr std::size_t kMaxDepth = 32, kMaxObjects = 100000, kMaxMemberBytes = 1U << 20U;
constexpr std::uint64_t kMaxChunk = std::uint64_t{256} << 20U;
constexpr std::uint64_t kMostAnswer = std::uint64_t{256} << 20U;

// A handle of the library, given back at the end of its scope.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  Handle& operator=(Handle&&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

Handle type_handle(hid_t id) { return {id, H5Tclose}; }

/// How a dataset is read, once it was found sound.
struct Reader {
  Handle dataset, memory_type;
  std::vector<hsize_t> shape;  // as stored
  std::uint64_t element_bytes = 0;
};

// The type in memory of a number in a file; nothing when it is none of ours.
std::optional<NumberType> number_of(hid_t type) {
  const std::size_t bytes = H5Tget_size(type);
  if (H5Tget_class(type) == H5T_FLOAT) return bytes <= 4 ? NumberType::f32 : NumberType::f64;
  if (H5Tget_class(type) != H5T_INTEGER || bytes > 8) return std::nullopt;
  const bool is_signed = H5Tget_sign(type) == H5T_SGN_2;
  if (bytes == 1) return is_signed ? NumberType::i8 : NumberType::u8;
  if (bytes == 2) return is_signed ? NumberType::i16 : NumberType::u16;
  if (bytes <= 4) return is_signed ? NumberType::i32 : NumberType::u32;
  return is_signed ? NumberType::i64 : NumberType::u64;
}

hid_t native_of(NumberType type) {
  switch (type) {
    case NumberType::f32:
    case NumberType::f16:
      return H5T_NATIVE_FLOAT;
    case NumberType::f64:
      return H5T_NATIVE_DOUBLE;
    case NumberType::i8:
      return H5T_NATIVE_INT8;
    case NumberType::u8:
      return H5T_NATIVE_UINT8;
    case NumberType::i16:
      return H5T_NATIVE_INT16;
    case NumberType::u16:
      return H5T_NATIVE_UINT16;
    case NumberType::i24:
    case NumberType::i32:
      return H5T_NATIVE_INT32;
    case NumberType::u32:
      return H5T_NATIVE_UINT32;
    case NumberType::i64:
      return H5T_NATIVE_INT64;
    case NumberType::u64:
      break;
  }
  return H5T_NATIVE_UINT64;
}

const char* why_no_number(hid_t type) {
  switch (H5Tget_class(type)) {
    case H5T_STRING:
      return "is text";
    case H5T_REFERENCE:
      return "holds references (a cell array?)";
    case H5T_ENUM:
      return "holds truth values or words";
    case H5T_VLEN:
      return "has rows of different lengths";
    case H5T_OPAQUE:
    case H5T_BITFIELD:
      return "holds opaque bytes";
    case H5T_COMPOUND:
      return "holds records or complex numbers";
    case H5T_TIME:
      return "holds calendar times";
    default:
      return "is of a type that is not read";
  }
}

std::string member_name(hid_t type, unsigned i) {
  char* const name = H5Tget_member_name(type, i);
  if (name == nullptr) return "";
  std::string text(name);
  H5free_memory(name);
  return text;
}

// numpy and MATLAB write complex numbers as a pair.
bool is_complex(hid_t type) {
  if (H5Tget_nmembers(type) != 2) return false;
  const std::string first = member_name(type, 0), second = member_name(type, 1);
  return (first == "r" && second == "i") || (first == "real" && second == "imag");
}

// A number or a small array of numbers, as a field of a record.
bool read_member(hid_t type, ElementField& field, std::string& why_not) {
  Handle number = type_handle(H5Tcopy(type));
  if (H5Tget_class(type) == H5T_ARRAY) {
    hsize_t extents[H5S_MAX_RANK];
    const int rank = H5Tget_array_dims2(type, extents);
    for (int d = 0; d < rank; ++d)
      if (__builtin_mul_overflow(field.count, extents[d], &field.count)) field.count = 0;
    field.array = true;
    if (field.count == 0 || field.count > 10000) {
      why_not = "has a shape that is not read";
      return false;
    }
    const Handle base = type_handle(H5Tget_super(type));
    const auto known = number_of(base);
    if (!known) why_not = why_no_number(base);
    if (known) field.number.type = *known;
    return known.has_value();
  }
  const auto known = number_of(number);
  if (!known) why_not = why_no_number(number);
  if (known) field.number.type = *known;
  return known.has_value();
}

// Of the shape that the member has in the file: the library converts between equal shapes only.
hid_t native_member(hid_t member, const ElementField& field) {
  const hid_t number = native_of(field.number.type);
  if (!field.array) return H5Tcopy(number);
  hsize_t extents[H5S_MAX_RANK];
  const int rank = H5Tget_array_dims2(member, extents);
  return H5Tarray_create2(number, static_cast<unsigned>(std::max(rank, 1)), extents);
}

// The fields of a record that are numbers, packed; the library reads just these. Those of a record within it have its
// name in front.
hid_t packed_record(hid_t type, LogArray& array, const std::string& front, std::size_t depth) {
  constexpr std::size_t kDeepest = 8;
  struct Member {
    std::string name;
    std::uint64_t byte;
    Handle type;
  };
  std::vector<Member> members;
  const std::uint64_t first = array.element_bytes;
  for (int i = 0; i < H5Tget_nmembers(type) && array.element_bytes <= kMaxMemberBytes; ++i) {
    const auto k = static_cast<unsigned>(i);
    const Handle member = type_handle(H5Tget_member_type(type, k));
    const std::string name = member_name(type, k);
    const std::uint64_t byte = array.element_bytes;
    if (H5Tget_class(member) == H5T_COMPOUND && !is_complex(member) && depth < kDeepest) {
      Handle inner = type_handle(packed_record(member, array, front + name + ".", depth + 1));
      if (inner) members.push_back({name, byte - first, std::move(inner)});
      continue;
    }
    ElementField field;
    field.name = front + name;
    std::string why;
    if (!read_member(member, field, why)) {
      array.left_out.push_back(field.name + " " + why);
      continue;
    }
    field.byte = byte;
    array.element_bytes += field.count * size_of(field.number.type);
    members.push_back({name, byte - first, type_handle(native_member(member, field))});
    array.fields.push_back(std::move(field));
  }
  if (members.empty() || array.element_bytes > kMaxMemberBytes) return -1;
  const hid_t memory = H5Tcreate(H5T_COMPOUND, static_cast<std::size_t>(array.element_bytes - first));
  for (const Member& member : members)
    H5Tinsert(memory, member.name.c_str(), static_cast<std::size_t>(member.byte), member.type);
  return memory;
}

hid_t record_type(hid_t type, LogArray& array) {
  if (is_complex(type)) {
    array.why_not = "holds complex numbers";
    return -1;
  }
  const hid_t memory = packed_record(type, array, "", 0);
  if (memory < 0)
    array.why_not = array.fields.empty() ? "is a record without a number" : "has records of more than a megabyte";
  return memory;
}

hid_t memory_type(hid_t type, LogArray& array) {
  if (H5Tget_class(type) == H5T_COMPOUND) return record_type(type, array);
  const auto number = number_of(type);
  if (!number) {
    array.why_not = why_no_number(type);
    return -1;
  }
  array.fields.push_back({"", "", {*number, false}, 0, 1, false, false});
  array.element_bytes = size_of(*number);
  return H5Tcopy(native_of(*number));
}

// What would read other files, run other code or take memory without bound; "" when nothing does.
std::string why_not_stored_so(hid_t plist, std::uint64_t element_bytes) {
  const H5D_layout_t layout = H5Pget_layout(plist);
  if (layout == H5D_VIRTUAL) return "is a virtual dataset, whose parts in other files are never read";
  if (H5Pget_external_count(plist) != 0) return "is stored in another file, which is never read";
  for (int i = 0; i < H5Pget_nfilters(plist); ++i) {
    char name[64] = "";
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(plist, static_cast<unsigned>(i), &flags, &values, nullptr, sizeof name, name, &config);
    if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE && filter != H5Z_FILTER_FLETCHER32)
      return fmt::format("is packed by filter {} {}; deflate and shuffle are read", filter, name);
  }
  if (layout != H5D_CHUNKED) return "";
  hsize_t chunk[H5S_MAX_RANK];
  const int rank = H5Pget_chunk(plist, H5S_MAX_RANK, chunk);
  std::uint64_t bytes = element_bytes;
  for (int d = 0; d < rank; ++d)
    if (__builtin_mul_overflow(bytes, chunk[d], &bytes)) bytes = kMaxChunk + 1;
  return bytes > kMaxChunk ? "has chunks of more than 256 MB" : "";
}

// Chunks that a block of rows touches are kept, so that the next block does not inflate them again.
hid_t access_of(hid_t plist, std::uint64_t element_bytes, const std::vector<hsize_t>& shape) {
  const hid_t access = H5Pcreate(H5P_DATASET_ACCESS);
  if (H5Pget_layout(plist) != H5D_CHUNKED) return access;
  hsize_t chunk[H5S_MAX_RANK];
  const int rank = H5Pget_chunk(plist, H5S_MAX_RANK, chunk);
  std::uint64_t bytes = element_bytes, across = 1;
  for (int d = 0; d < rank && d < static_cast<int>(shape.size()); ++d) {
    bytes *= chunk[d];
    const auto k = static_cast<std::size_t>(d);
    if (shape[k] <= 1024) across *= (shape[k] + chunk[d] - 1) / std::max<hsize_t>(chunk[d], 1);
  }
  const std::uint64_t wanted =
      std::min(std::max<std::uint64_t>(2 * bytes * std::min<std::uint64_t>(across, 4096), 1U << 20U),
               std::max<std::uint64_t>(2 * bytes, 64U << 20U));
  H5Pset_chunk_cache(access, 10007, static_cast<std::size_t>(wanted), 0.75);
  return access;
}

std::string text_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return "";
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  if (!attribute) return "";
  const Handle type = type_handle(H5Aget_type(attribute));
  const Handle space(H5Aget_space(attribute), H5Sclose);
  if (H5Tget_class(type) != H5T_STRING || H5Sget_simple_extent_npoints(space) != 1) return "";
  if (H5Tis_variable_str(type) > 0) {
    char* text = nullptr;
    const Handle memory = type_handle(H5Tcopy(type));
    if (H5Aread(attribute, memory, &text) < 0 || text == nullptr) return "";
    std::string out(text, ::strnlen(text, 64));
    H5free_memory(text);
    return out;
  }
  const std::size_t bytes = H5Tget_size(type);
  if (bytes == 0 || bytes > 4096) return "";
  std::string out(bytes, '\0');
  if (H5Aread(attribute, type, out.data()) < 0) return "";
  out.resize(::strnlen(out.data(), std::min<std::size_t>(bytes, 64)));
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out;
}

struct Collected {
  std::string group;
  std::vector<SaidNumber>* said;
};

herr_t collect_number(hid_t object, const char* name, const H5A_info_t*, void* to) {
  auto* const collected = static_cast<Collected*>(to);
  if (collected->said->size() >= 1000 || std::strlen(name) > 256) return 0;
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  if (!attribute) return 0;
  const Handle type = type_handle(H5Aget_type(attribute));
  const Handle space(H5Aget_space(attribute), H5Sclose);
  const H5T_class_t kind = H5Tget_class(type);
  if ((kind != H5T_INTEGER && kind != H5T_FLOAT) || H5Sget_simple_extent_npoints(space) != 1) return 0;
  double value = 0;
  if (H5Aread(attribute, H5T_NATIVE_DOUBLE, &value) >= 0) collected->said->push_back({collected->group, name, value});
  return 0;
}

void collect_numbers(hid_t object, const std::string& group, std::vector<SaidNumber>& said) {
  Collected collected{group, &said};
  H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect_number, &collected);
}

// MATLAB's datasets say what they are, and have the first dimension last.
std::string why_not_matlab(hid_t dataset, const std::string& kind) {
  if (H5Aexists(dataset, "MATLAB_object_decode") > 0)
    return fmt::format("is an object ({}); save its numbers, e.g. t = seconds(tt.Time); x = tt.Variables;", kind);
  if (kind == "char") return "is text";
  if (kind == "logical") return "holds truth values";
  if (kind == "cell") return "is a cell array; save its contents as arrays";
  if (H5Aexists(dataset, "MATLAB_empty") > 0) return "is empty";
  static const std::set<std::string> numbers = {"double", "single", "int8",   "uint8", "int16",
                                                "uint16", "int32",  "uint32", "int64", "uint64"};
  return numbers.contains(kind) ? "" : fmt::format("is of class {}", kind);
}

class Worker {
 public:
  void list(const std::string& path) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    H5PLset_loading_state(0);
    file_ = std::make_unique<Handle>(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    if (!*file_) {
      listing.refusal = "the HDF5 library cannot open it: it is cut, damaged or of a newer version";
      return;
    }
    const Handle root(H5Gopen2(*file_, "/", H5P_DEFAULT), H5Gclose);
    if (!root)
      listing.refusal = "its root group is damaged";
    else
      walk(root, "", 0);
  }

  /// The elements of a question; empty when they cannot be read.
  std::vector<std::byte> read(const Hdf5Question& q) const {
    const std::size_t array = detail::in_memory(q.array);
    if (array >= readers_.size() || !readers_[array]) return {};
    const Reader& reader = *readers_[array];
    std::vector<hsize_t> start(reader.shape.size(), 0), count = reader.shape;
    if (!select(q, start, count)) return {};
    std::uint64_t bytes = reader.element_bytes;
    for (const hsize_t n : count)
      if (__builtin_mul_overflow(bytes, n, &bytes) || bytes > kMostAnswer) return {};
    std::vector<std::byte> out(static_cast<std::size_t>(bytes));
    const Handle file_space(H5Dget_space(reader.dataset), H5Sclose);
    if (!start.empty() &&
        H5Sselect_hyperslab(file_space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) < 0)
      return {};
    const Handle memory_space(
        start.empty() ? H5Scopy(file_space) : H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr),
        H5Sclose);
    if (H5Dread(reader.dataset, reader.memory_type, memory_space, file_space, H5P_DEFAULT, out.data()) < 0) return {};
    return out;
  }

  Hdf5Listing listing;

 private:
  struct Visit {
    Worker* worker;
    std::string group;
    std::size_t depth;
  };

  void walk(hid_t group, const std::string& name, std::size_t depth) {
    collect_numbers(group, name, listing.said);
    Visit visit{this, name, depth};
    H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, visit_link, &visit);
  }

  static herr_t visit_link(hid_t group, const char* name, const H5L_info_t* link, void* to) {
    const auto* const visit = static_cast<const Visit*>(to);
    return visit->worker->add_link(group, name, *link, *visit);
  }

  herr_t add_link(hid_t group, const std::string& name, const H5L_info_t& link, const Visit& visit) {
    const std::string path = visit.group.empty() ? name : visit.group + "/" + name;
    if (++objects_ > kMaxObjects || name.size() > 1024 || path.size() > 4096) return 1;
    if (visit.group.empty() && name.starts_with('#')) return 0;  // MATLAB's own
    if (link.type != H5L_TYPE_HARD) {
      listing.left_out.push_back(path + (link.type == H5L_TYPE_SOFT
                                             ? " is a soft link"
                                             : " is a link to another file, which is never followed"));
      return 0;
    }
    ObjectInfo about;
    if (H5Oget_info_by_name2(group, name.c_str(), &about, H5O_INFO_BASIC, H5P_DEFAULT) < 0) {
      listing.left_out.push_back(path + " is damaged");
      return 0;
    }
    if (!seen_.insert(about.addr).second) return 0;  // a second name of the same thing
    if (about.type == H5O_TYPE_GROUP)
      add_group(group, name, path, visit.depth);
    else if (about.type == H5O_TYPE_DATASET)
      add_dataset(group, name, visit.group);
    return 0;
  }

  void add_group(hid_t parent, const std::string& name, const std::string& path, std::size_t depth) {
    const Handle group(H5Gopen2(parent, name.c_str(), H5P_DEFAULT), H5Gclose);
    if (!group) return listing.left_out.push_back(path + " is damaged");
    if (H5Aexists(group, "MATLAB_sparse") > 0) return listing.left_out.push_back(path + " is sparse");
    if (depth < kMaxDepth) walk(group, path, depth + 1);
  }

  void add_dataset(hid_t parent, const std::string& name, const std::string& group) {
    LogArray array;
    array.group = group;
    array.name = name;
    readers_.push_back(open_dataset(parent, array));
    listing.arrays.push_back(std::move(array));
  }

  static std::unique_ptr<Reader> open_dataset(hid_t parent, LogArray& array) {
    Handle first(H5Dopen2(parent, array.name.c_str(), H5P_DEFAULT), H5Dclose);
    const auto no = [&](std::string why) {
      array.why_not = std::move(why);
      return nullptr;
    };
    if (!first) return no("is damaged");
    const Handle plist(H5Dget_create_plist(first), H5Pclose);
    if (std::string why = why_not_stored_so(plist, 1); !why.empty()) return no(std::move(why));
    const std::string matlab = text_attribute(first, "MATLAB_class");
    if (!matlab.empty())
      if (std::string why = why_not_matlab(first, matlab); !why.empty()) return no(std::move(why));
    const Handle type = type_handle(H5Dget_type(first));
    const Handle space(H5Dget_space(first), H5Sclose);
    if (!type || !space) return no("is damaged");
    if (H5Sget_simple_extent_type(space) == H5S_NULL) return no("is empty");
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 0 || rank > 32) return no("has a shape that is not read");
    std::vector<hsize_t> shape(static_cast<std::size_t>(rank));
    if (rank > 0) H5Sget_simple_extent_dims(space, shape.data(), nullptr);
    Handle memory = type_handle(memory_type(type, array));
    if (!memory) return no(array.why_not.empty() ? "is of a type that is not read" : array.why_not);
    if (std::string why = why_not_stored_so(plist, array.element_bytes); !why.empty()) return no(std::move(why));
    describe(first, matlab, shape, array);
    const Handle access(access_of(plist, array.element_bytes, shape), H5Pclose);
    Handle dataset(H5Dopen2(parent, array.name.c_str(), access), H5Dclose);
    if (!dataset) return no("is damaged");
    return std::make_unique<Reader>(
        Reader{std::move(dataset), std::move(memory), std::move(shape), array.element_bytes});
  }

  static void describe(hid_t dataset, const std::string& matlab, const std::vector<hsize_t>& shape, LogArray& array) {
    array.shape.assign(shape.begin(), shape.end());
    if (!matlab.empty()) {
      std::reverse(array.shape.begin(), array.shape.end());
      array.first_fastest = true;
    }
    for (const char* name : {"units", "unit", "Units", "Unit", "UNITS"}) {
      const std::string unit = text_attribute(dataset, name);
      if (unit.empty()) continue;
      for (ElementField& field : array.fields) field.unit = unit;
      break;
    }
    collect_numbers(dataset, "", array.said);
  }

  // Rows run along the first dimension that is longer than 1, or the last one (planar).
  static bool select(const Hdf5Question& q, std::vector<hsize_t>& start, std::vector<hsize_t>& count) {
    std::vector<std::size_t> longer;
    for (std::size_t d = 0; d < count.size(); ++d)
      if (count[d] != 1) longer.push_back(d);
    if (longer.empty()) return q.row == 0 && q.rows == 1;
    const std::size_t along = q.planar != 0 ? longer.back() : longer.front();
    if (q.row > count[along] || q.rows > count[along] - q.row || q.rows == 0) return false;
    start[along] = q.row;
    count[along] = q.rows;
    if (q.planar == 0) return true;
    std::uint64_t column = q.column;
    for (std::size_t d = count.size(); d-- > 0;) {
      if (d == along) continue;
      start[d] = column % count[d];
      column /= count[d];
      count[d] = 1;
    }
    return column == 0;
  }

  std::unique_ptr<Handle> file_;
  std::vector<std::unique_ptr<Reader>> readers_;  // beside listing.arrays
  std::set<haddr_t> seen_;
  std::size_t objects_ = 0;
};

std::string with_length(std::string_view bytes) {
  const std::uint64_t size = bytes.size();
  std::string out(sizeof size, '\0');
  std::memcpy(out.data(), &size, sizeof size);
  return out.append(bytes);
}

class AnsweringHdf5 final : public Answering {
 public:
  explicit AnsweringHdf5(std::string path) : path_(std::move(path)) {
    ::setenv("HDF5_PLUGIN_PATH", "", 1);
    ::setenv("HDF5_USE_FILE_LOCKING", "FALSE", 1);
  }
  std::size_t question_bytes() const override { return sizeof(Hdf5Question); }
  std::string begin() override {
    worker_.list(path_);
    return with_length(encode(worker_.listing));
  }
  std::string answer(std::span<const std::byte> bytes) override {
    Hdf5Question question;
    std::memcpy(&question, bytes.data(), sizeof question);
    const std::vector<std::byte> elements = worker_.read(question);
    if (elements.empty()) return std::string(sizeof(std::uint64_t), '\xFF');
    return with_length({reinterpret_cast<const char*>(elements.data()), elements.size()});
  }

 private:
  std::string path_;
  Worker worker_;
};

}  // namespace

bool hdf5_is_here() { return is_here(); }

std::unique_ptr<Answering> answering_hdf5(const std::string& path) { return std::make_unique<AnsweringHdf5>(path); }

}  // namespace libchar

#else  // without HDF5

namespace libchar {

bool hdf5_is_here() { return false; }

std::unique_ptr<Answering> answering_hdf5(const std::string&) {
  return nullptr;  // who asks has asked hdf5_is_here()
}

}  // namespace libchar

#endif
