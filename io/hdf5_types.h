// io/hdf5_types.h -- types, shapes and errors of HDF5; used by the other hdf5_* files and run_*.
//
// Numbers: double, int32, int64, uint8, little-endian on disk. Texts: UTF-8 of fixed length,
// because HDF5 guards them with checksums; texts of variable length it does not, and crashes on
// wrong bytes.
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

/// The largest number there is instead of an overflow.
hsize_t product(const Shape& shape);
/// The shape of a list of rows.
Shape with_rows(hsize_t rows, const Shape& row_shape);
/// "[2 x 20 x 3]"
std::string shape_text(const Shape& shape);
/// An empty shape is a single value.
Hdf5Handle data_space(const Shape& shape);

/// The type of T in memory.
template <class T>
hid_t native_type()
{
    if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
    if constexpr (std::is_same_v<T, std::int32_t>) return H5T_NATIVE_INT32;
    if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
    if constexpr (std::is_same_v<T, std::uint8_t>) return H5T_NATIVE_UINT8;
}
/// The same on disk.
hid_t stored_type(hid_t native);
/// A property list by which no time is stored: the same numbers make the same file.
Hdf5Handle without_times(hid_t property_class);
/// Texts of `length` bytes, in memory and on disk.
Hdf5Handle text_type(std::size_t length);

/// The Error of the HDF5 call that has just failed, to be made before any other call. While
/// writing: no_space or file, told apart by the system's error number; while reading: input.
Error failed_write(const std::string& where);
Error failed_read(const std::string& where);

/// Takes an identifier; throws if there is none.
Hdf5Handle created(hid_t id, Hdf5Handle::Close close, const std::string& where);
Hdf5Handle opened(hid_t id, Hdf5Handle::Close close, const std::string& where);

}
