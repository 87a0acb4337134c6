#include "io/hdf5_types.h"

#include "io/atomic_file.h"

#include <cstdio>
#include <cstring>
#include <limits>
#include <string_view>

namespace sigmaflow::io {
namespace {

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

}

hsize_t product(const Shape& shape)
{
    hsize_t result = 1;
    for (const hsize_t length : shape)
        if (__builtin_mul_overflow(result, length, &result))
            return std::numeric_limits<hsize_t>::max();
    return result;
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

Hdf5Handle data_space(const Shape& shape)
{
    if (shape.empty()) return Hdf5Handle(H5Screate(H5S_SCALAR), H5Sclose);
    const int rank = static_cast<int>(shape.size());
    return Hdf5Handle(H5Screate_simple(rank, shape.data(), nullptr), H5Sclose);
}

hid_t stored_type(hid_t native)
{
    if (H5Tequal(native, H5T_NATIVE_DOUBLE) > 0) return H5T_IEEE_F64LE;
    if (H5Tequal(native, H5T_NATIVE_INT32) > 0) return H5T_STD_I32LE;
    if (H5Tequal(native, H5T_NATIVE_INT64) > 0) return H5T_STD_I64LE;
    return H5T_STD_U8LE;
}

Hdf5Handle without_times(hid_t property_class)
{
    Hdf5Handle list(H5Pcreate(property_class), H5Pclose);
    H5Pset_obj_track_times(list.id(), false);
    return list;
}

Hdf5Handle text_type(std::size_t length)
{
    Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.id(), length);
    H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
    H5Tset_cset(type.id(), H5T_CSET_UTF8);
    return type;
}

Error failed_write(const std::string& where)
{
    const Failure failure = last_failure();
    if (failure.error_number != 0) return write_error(where, failure.error_number);
    return Error(ErrorKind::file, where, "cannot be written: " + failure.reason);
}

Error failed_read(const std::string& where)
{
    return Error(ErrorKind::input, where, "cannot be read: " + last_failure().reason);
}

Hdf5Handle created(hid_t id, Hdf5Handle::Close close, const std::string& where)
{
    if (id < 0) throw failed_write(where);
    return Hdf5Handle(id, close);
}

Hdf5Handle opened(hid_t id, Hdf5Handle::Close close, const std::string& where)
{
    if (id < 0) throw failed_read(where);
    return Hdf5Handle(id, close);
}

}
