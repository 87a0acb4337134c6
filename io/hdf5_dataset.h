// io/hdf5_dataset.h -- datasets of numbers: growing row by row when written, read as a whole.
//
// Errors "<file>:<path in the file>: <problem>": file, no_space while writing, input while reading.
#pragma once
#include "io/hdf5_group.h"

#include <algorithm>
#include <string>
#include <vector>

namespace sigmaflow::io {

/// A dataset to which rows are added: chunked, with Fletcher32 checksums, not compressed.
class GrowingDataset {
public:
    /// An empty unit writes no attribute `unit`.
    GrowingDataset(const Hdf5Group& group, const std::string& name, hid_t native,
                   const Shape& row_shape, const std::string& unit);

    /// T is the type of the dataset; the size of `values` a multiple of the size of a row.
    template <class T>
    void append(const std::vector<T>& values)
    {
        append(native_type<T>(), values.data(), values.size() / row_size_);
    }
    hsize_t rows() const { return rows_; }
    /// Writes what is still in memory; the destructor does that too, but cannot report a failure.
    void close();

private:
    void append(hid_t native, const void* values, hsize_t count);

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
    GrowingDataset dataset = grow<T>(group, name, {}, unit);
    dataset.append(values);
    dataset.close();
}

Shape dataset_shape(const Hdf5Group& group, const std::string& name);

/// Number of values in this shape. Error(input) if the dataset has another one, or if the file does
/// not hold them all: a damaged shape must not ask for more memory than the file has bytes.
hsize_t checked_size(const Hdf5Group& group, const std::string& name, const Shape& shape);

void read_values(const Hdf5Group& group, const std::string& name, hid_t native, void* values);

/// `rows` is the shape of the part to read: some rows from `first` on.
void read_rows(const Hdf5Group& group, const std::string& name, hid_t native, hsize_t first,
               const Shape& rows, void* values);

/// Some rows of a dataset of this shape after another, about a megabyte at a time:
/// use(first, values).
template <class T, class Use>
void read_in_parts(const Hdf5Group& group, const std::string& name, const Shape& shape,
                   const Use& use)
{
    checked_size(group, name, shape);
    constexpr hsize_t part = 131072;  // values
    const Shape row_shape(shape.begin() + 1, shape.end());
    const hsize_t width = std::max<hsize_t>(1, product(row_shape));
    std::vector<T> values;
    for (hsize_t first = 0; first < shape.front();) {
        const hsize_t rows = std::min(shape.front() - first, std::max<hsize_t>(1, part / width));
        values.resize(rows * width);
        read_rows(group, name, native_type<T>(), first, with_rows(rows, row_shape), values.data());
        use(first, values);
        first += rows;
    }
}

/// All values of a dataset, which must have this shape and be stored as T.
template <class T>
std::vector<T> read_dataset(const Hdf5Group& group, const std::string& name, const Shape& shape)
{
    std::vector<T> values(checked_size(group, name, shape));
    read_values(group, name, native_type<T>(), values.data());
    return values;
}

}
