// io/hdf5_data.h -- groups, attributes and datasets of numbers; used by the run file only.
//
// Types: double, int32, int64, uint8 (little-endian on disk) and UTF-8 texts. Every failure is an
// Error
// "<file>:<path in the file>: <problem>": while writing no_space or file, told apart by the
// system's error number; while reading input. HDF5 itself prints nothing.
#pragma once
#include "engine/error.h"
#include "io/hdf5_handle.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <type_traits>
#include <vector>

namespace sigmaflow::io {

using Shape = std::vector<hsize_t>;

/// The type of T in memory.
template <class T>
hid_t native_type()
{
    if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
    if constexpr (std::is_same_v<T, std::int32_t>) return H5T_NATIVE_INT32;
    if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
    if constexpr (std::is_same_v<T, std::uint8_t>) return H5T_NATIVE_UINT8;
}

/// A group of an open file, or its root.
class Hdf5Group {
public:
    /// Errors: file, no_space.
    static Hdf5Group create_file(const std::filesystem::path& path);
    /// For reading. Errors: missing (cannot be read), input (not an HDF5 file, or cut off).
    static Hdf5Group open_file(const std::filesystem::path& path);

    Hdf5Group create_group(const std::string& name) const;
    Hdf5Group open_group(const std::string& name) const;
    hid_t id() const { return handle_.id(); }
    /// "<file>:<path of the entry>" for error messages.
    std::string where(const std::string& entry = "") const;

    /// A second name, in this group, for a dataset of another group.
    void link(const std::string& name, const Hdf5Group& other, const std::string& other_name) const;
    /// Hands everything to the operating system.
    void flush() const;
    /// Of the root, when all others are gone: the file is complete.
    void close();

private:
    Hdf5Group(Hdf5Handle handle, std::filesystem::path file, std::string name);

    Hdf5Handle handle_;
    std::filesystem::path file_;
    std::string name_;  // "" for the root
};

void write_text(hid_t object, const std::string& attribute, const std::string& text);
/// Words of equal length.
void write_words(hid_t object, const std::string& attribute, const std::vector<std::string>& words);
void write_raw(hid_t object, const std::string& attribute, hid_t type, const Shape& shape,
               const void* values);
template <class T>
void write_number(hid_t object, const std::string& attribute, T value)
{
    write_raw(object, attribute, native_type<T>(), {}, &value);
}
template <class T>
void write_numbers(hid_t object, const std::string& attribute, const std::vector<T>& values)
{
    write_raw(object, attribute, native_type<T>(), {values.size()}, values.data());
}

std::vector<std::string> attribute_names(const Hdf5Group& group);
/// An attribute that is one text, or one number of any type.
std::string read_text(const Hdf5Group& group, const std::string& attribute);
double read_number(const Hdf5Group& group, const std::string& attribute);

/// A dataset to which rows are added: chunked, with Fletcher32 checksums.
class GrowingDataset {
public:
    GrowingDataset(const Hdf5Group& group, const std::string& name, hid_t type,
                   const Shape& row_shape, const std::string& unit);

    /// T is the type of the dataset; the size of `values` a multiple of the size of a row.
    template <class T>
    void append(const std::vector<T>& values)
    {
        append(native_type<T>(), values.data(), values.size() / row_size_);
    }
    hsize_t rows() const { return rows_; }

private:
    void append(hid_t type, const void* values, hsize_t count);

    Hdf5Handle dataset_;
    std::string where_;
    Shape row_shape_;
    hsize_t row_size_ = 1, rows_ = 0;
};

template <class T>
GrowingDataset grow(const Hdf5Group& group, const std::string& name, const Shape& row_shape,
                    const std::string& unit)
{
    return GrowingDataset(group, name, native_type<T>(), row_shape, unit);
}

template <class T>
void write_dataset(const Hdf5Group& group, const std::string& name, const std::vector<T>& values,
                   const std::string& unit)
{
    grow<T>(group, name, {}, unit).append(values);
}

Shape dataset_shape(const Hdf5Group& group, const std::string& name);
void read_raw(const Hdf5Group& group, const std::string& name, hid_t type, void* values);
/// Number of values in a shape; Error(input) if the dataset has another one.
hsize_t checked_size(const Hdf5Group& group, const std::string& name, const Shape& shape);

/// All values of a dataset, which must have this shape.
template <class T>
std::vector<T> read_dataset(const Hdf5Group& group, const std::string& name, const Shape& shape)
{
    std::vector<T> values(checked_size(group, name, shape));
    read_raw(group, name, native_type<T>(), values.data());
    return values;
}

}
