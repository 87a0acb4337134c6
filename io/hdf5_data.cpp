#include "io/hdf5_data.h"

#include "io/atomic_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <functional>
#include <numeric>
#include <string_view>
#include <utility>

namespace sigmaflow::io {
namespace {

constexpr hsize_t chunk_values = 1024;  // at least, if a row is not longer

/// What HDF5 knows about the call that has just failed.
struct Failure {
    int error_number = 0;  // of the system; 0 if it was not the cause
    std::string reason;    // the innermost description
};

herr_t collect(unsigned depth, const H5E_error2_t* record, void* result)
{
    Failure& failure = *static_cast<Failure*>(result);
    if (depth == 0) failure.reason = record->desc;
    // HDF5 keeps the system's error number in its text only: "... errno = 28, error message ..."
    constexpr std::string_view key = "errno = ";
    if (const char* found = std::strstr(record->desc, key.data()))
        std::sscanf(found + key.size(), "%d", &failure.error_number);
    return 0;
}

Failure last_failure()
{
    Failure failure;
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, collect, &failure);
    return failure;
}

Error failed_write(const std::string& where)
{
    const Failure failure = last_failure();
    if (failure.error_number != 0) return write_error(where, failure.error_number);
    return Error(ErrorKind::file, where, "cannot be written: " + failure.reason);
}

Error failed_read(const std::string& where)
{
    const Failure failure = last_failure();
    return Error(ErrorKind::input, where, "cannot be read: " + failure.reason);
}

std::string place_of(hid_t object, const std::string& entry)
{
    std::array<char, 1024> file{}, path{};
    H5Fget_name(object, file.data(), file.size());
    H5Iget_name(object, path.data(), path.size());
    const std::string object_path = std::strcmp(path.data(), "/") == 0 ? "" : path.data();
    return std::string(file.data()) + ':' + object_path + '/' + entry;
}

Hdf5Handle written(hid_t id, Hdf5Handle::Close close, const std::string& where)
{
    if (id < 0) throw failed_write(where);
    return Hdf5Handle(id, close);
}

Hdf5Handle read(hid_t id, Hdf5Handle::Close close, const std::string& where)
{
    if (id < 0) throw failed_read(where);
    return Hdf5Handle(id, close);
}

/// HDF5 must not print, and must not try to write again at the end of the program what could not be
/// written before.
void quiet()
{
    H5dont_atexit();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Hdf5Handle file_access()
{
    Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    // Objects and attributes of HDF5 1.8: attributes may be longer than 64 KiB.
    H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V110);
    H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG);
    H5Pset_file_locking(access.id(), true, true);  // not on file systems that have no locks
    return access;
}

Hdf5Handle space_of(const Shape& shape)
{
    if (shape.empty()) return Hdf5Handle(H5Screate(H5S_SCALAR), H5Sclose);
    return Hdf5Handle(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                      H5Sclose);
}

Hdf5Handle text_type(std::size_t length)
{
    Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.id(), length);
    H5Tset_cset(type.id(), H5T_CSET_UTF8);
    return type;
}

/// Type on disk: the same number, little-endian.
hid_t stored_type(hid_t native)
{
    if (H5Tequal(native, H5T_NATIVE_DOUBLE) > 0) return H5T_IEEE_F64LE;
    if (H5Tequal(native, H5T_NATIVE_INT32) > 0) return H5T_STD_I32LE;
    if (H5Tequal(native, H5T_NATIVE_INT64) > 0) return H5T_STD_I64LE;
    return H5T_STD_U8LE;
}

hsize_t product(const Shape& shape)
{
    return std::accumulate(shape.begin(), shape.end(), hsize_t{1}, std::multiplies<>());
}

Shape with_rows(hsize_t rows, const Shape& row_shape)
{
    Shape shape{rows};
    shape.insert(shape.end(), row_shape.begin(), row_shape.end());
    return shape;
}

std::string shape_text(const Shape& shape)
{
    std::string text;
    for (const hsize_t length : shape) text += (text.empty() ? "" : " x ") + std::to_string(length);
    return '[' + text + ']';
}

}

Hdf5Group::Hdf5Group(Hdf5Handle handle, std::filesystem::path file, std::string name)
    : handle_(std::move(handle)), file_(std::move(file)), name_(std::move(name))
{
}

Hdf5Group Hdf5Group::create_file(const std::filesystem::path& path)
{
    quiet();
    const Hdf5Handle access = file_access();
    const hid_t id = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id());
    return Hdf5Group(written(id, H5Fclose, path.string()), path, "");
}

Hdf5Group Hdf5Group::open_file(const std::filesystem::path& path)
{
    quiet();
    std::FILE* const readable = std::fopen(path.c_str(), "rb");
    if (readable == nullptr)
        throw Error(ErrorKind::missing, path.string(),
                    std::string("cannot be read: ") + std::strerror(errno));
    std::fclose(readable);
    const Hdf5Handle access = file_access();
    const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id());
    return Hdf5Group(read(id, H5Fclose, path.string()), path, "");
}

Hdf5Group Hdf5Group::create_group(const std::string& name) const
{
    const hid_t group = H5Gcreate2(id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    return Hdf5Group(written(group, H5Gclose, where(name)), file_, name_ + '/' + name);
}

Hdf5Group Hdf5Group::open_group(const std::string& name) const
{
    const hid_t group = H5Gopen2(id(), name.c_str(), H5P_DEFAULT);
    return Hdf5Group(read(group, H5Gclose, where(name)), file_, name_ + '/' + name);
}

std::string Hdf5Group::where(const std::string& entry) const
{
    return file_.string() + ':' + name_ + (entry.empty() ? "" : '/' + entry);
}

void Hdf5Group::link(const std::string& name, const Hdf5Group& other,
                     const std::string& other_name) const
{
    if (H5Lcreate_hard(other.id(), other_name.c_str(), id(), name.c_str(), H5P_DEFAULT,
                       H5P_DEFAULT) < 0)
        throw failed_write(where(name));
}

void Hdf5Group::flush() const
{
    if (H5Fflush(id(), H5F_SCOPE_GLOBAL) < 0) throw failed_write(file_.string());
}

void Hdf5Group::close()
{
    if (!handle_.close()) throw failed_write(file_.string());
}

void write_raw(hid_t object, const std::string& attribute, hid_t type, const Shape& shape,
               const void* values)
{
    const Hdf5Handle space = space_of(shape);
    const bool text = H5Tget_class(type) == H5T_STRING;
    const hid_t id = H5Acreate2(object, attribute.c_str(), text ? type : stored_type(type),
                                space.id(), H5P_DEFAULT, H5P_DEFAULT);
    if (id < 0) throw failed_write(place_of(object, attribute));
    const Hdf5Handle created(id, H5Aclose);
    if (H5Awrite(id, type, values) < 0) throw failed_write(place_of(object, attribute));
}

void write_text(hid_t object, const std::string& attribute, const std::string& text)
{
    const Hdf5Handle type = text_type(H5T_VARIABLE);
    const char* const content = text.c_str();
    write_raw(object, attribute, type.id(), {}, &content);
}

void write_words(hid_t object, const std::string& attribute, const std::vector<std::string>& words)
{
    const Hdf5Handle type = text_type(words.front().size());
    std::string joined;
    for (const std::string& word : words) joined += word;
    write_raw(object, attribute, type.id(), {words.size()}, joined.data());
}

std::vector<std::string> attribute_names(const Hdf5Group& group)
{
    std::vector<std::string> names;
    const auto add = [](hid_t, const char* name, const H5A_info_t*, void* list) -> herr_t {
        static_cast<std::vector<std::string>*>(list)->push_back(name);
        return 0;
    };
    if (H5Aiterate2(group.id(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names) < 0)
        throw failed_read(group.where());
    return names;
}

namespace {

/// An attribute with a single value.
Hdf5Handle single_attribute(const Hdf5Group& group, const std::string& attribute)
{
    const std::string where = place_of(group.id(), attribute);
    Hdf5Handle opened = read(H5Aopen(group.id(), attribute.c_str(), H5P_DEFAULT), H5Aclose, where);
    const Hdf5Handle space(H5Aget_space(opened.id()), H5Sclose);
    if (H5Sget_simple_extent_npoints(space.id()) != 1)
        throw Error(ErrorKind::input, where, "must be a single value");
    return opened;
}

}

double read_number(const Hdf5Group& group, const std::string& attribute)
{
    const Hdf5Handle opened = single_attribute(group, attribute);
    double value = 0;
    if (H5Aread(opened.id(), H5T_NATIVE_DOUBLE, &value) < 0)
        throw failed_read(place_of(group.id(), attribute));
    return value;
}

std::string read_text(const Hdf5Group& group, const std::string& attribute)
{
    const std::string where = place_of(group.id(), attribute);
    const Hdf5Handle opened = single_attribute(group, attribute);
    const Hdf5Handle stored(H5Aget_type(opened.id()), H5Tclose);
    if (H5Tget_class(stored.id()) != H5T_STRING || H5Tis_variable_str(stored.id()) <= 0)
        throw Error(ErrorKind::input, where, "must be a text");
    char* content = nullptr;
    const Hdf5Handle type = text_type(H5T_VARIABLE);
    if (H5Aread(opened.id(), type.id(), &content) < 0) throw failed_read(where);
    std::string text(content == nullptr ? "" : content);
    H5free_memory(content);
    return text;
}

GrowingDataset::GrowingDataset(const Hdf5Group& group, const std::string& name, hid_t type,
                               const Shape& row_shape, const std::string& unit)
    : where_(group.where(name)), row_shape_(row_shape), row_size_(product(row_shape))
{
    const Shape none = with_rows(0, row_shape), unlimited = with_rows(H5S_UNLIMITED, row_shape);
    const Shape chunk = with_rows(std::max<hsize_t>(1, chunk_values / row_size_), row_shape);
    const int rank = static_cast<int>(none.size());
    const Hdf5Handle space(H5Screate_simple(rank, none.data(), unlimited.data()), H5Sclose);
    const Hdf5Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_chunk(layout.id(), rank, chunk.data());
    H5Pset_fletcher32(layout.id());
    const hid_t id = H5Dcreate2(group.id(), name.c_str(), stored_type(type), space.id(),
                                H5P_DEFAULT, layout.id(), H5P_DEFAULT);
    dataset_ = written(id, H5Dclose, where_);
    if (!unit.empty()) write_text(id, "unit", unit);
}

void GrowingDataset::append(hid_t type, const void* values, hsize_t count)
{
    if (count == 0) return;
    const Shape added = with_rows(count, row_shape_), all = with_rows(rows_ + count, row_shape_);
    Shape start(added.size(), 0);
    start.front() = rows_;
    if (H5Dset_extent(dataset_.id(), all.data()) < 0) throw failed_write(where_);
    const Hdf5Handle space(H5Dget_space(dataset_.id()), H5Sclose);
    H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, added.data(), nullptr);
    const Hdf5Handle memory = space_of(added);
    if (H5Dwrite(dataset_.id(), type, memory.id(), space.id(), H5P_DEFAULT, values) < 0)
        throw failed_write(where_);
    rows_ += count;
}

Shape dataset_shape(const Hdf5Group& group, const std::string& name)
{
    const std::string where = group.where(name);
    const Hdf5Handle dataset =
        read(H5Dopen2(group.id(), name.c_str(), H5P_DEFAULT), H5Dclose, where);
    const Hdf5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    const int rank = H5Sget_simple_extent_ndims(space.id());
    if (rank < 0) throw failed_read(where);
    Shape shape(static_cast<std::size_t>(rank));
    H5Sget_simple_extent_dims(space.id(), shape.data(), nullptr);
    return shape;
}

hsize_t checked_size(const Hdf5Group& group, const std::string& name, const Shape& shape)
{
    const std::string where = group.where(name);
    const Shape found = dataset_shape(group, name);
    if (found != shape)
        throw Error(ErrorKind::input, where,
                    "must have the shape " + shape_text(shape) + ", got " + shape_text(found));
    // Nothing is compressed, so a damaged shape cannot ask for more memory than the file has bytes.
    const Hdf5Handle dataset(H5Dopen2(group.id(), name.c_str(), H5P_DEFAULT), H5Dclose);
    const Hdf5Handle type(H5Dget_type(dataset.id()), H5Tclose);
    const hsize_t stored = H5Dget_storage_size(dataset.id());
    if (stored / H5Tget_size(type.id()) < product(shape))
        throw Error(ErrorKind::input, where,
                    "must hold all values of the shape " + shape_text(shape) + ", holds " +
                        std::to_string(stored) + " bytes");
    return product(shape);
}

void read_raw(const Hdf5Group& group, const std::string& name, hid_t type, void* values)
{
    const std::string where = group.where(name);
    const Hdf5Handle dataset =
        read(H5Dopen2(group.id(), name.c_str(), H5P_DEFAULT), H5Dclose, where);
    const Hdf5Handle stored(H5Dget_type(dataset.id()), H5Tclose);
    if (H5Tequal(stored.id(), stored_type(type)) <= 0)
        throw Error(ErrorKind::input, where, "has another type of number");
    if (H5Dread(dataset.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
        throw failed_read(where);
}

}
