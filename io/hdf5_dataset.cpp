#include "io/hdf5_dataset.h"

#include <algorithm>

namespace sigmaflow::io {
namespace {

constexpr hsize_t chunk_values = 1024;  // at least; a row that is longer is a chunk of its own
constexpr hsize_t checksum_bytes = 4;

Shape chunk_of(const Shape& row_shape)
{
    return with_rows(std::max<hsize_t>(1, chunk_values / std::max<hsize_t>(1, product(row_shape))),
                     row_shape);
}

Hdf5Handle open_dataset(const Hdf5Group& group, const std::string& name)
{
    return opened(H5Dopen2(group.id(), name.c_str(), H5P_DEFAULT), H5Dclose, group.where(name));
}

/// HDF5 reads zeros for a chunk that it does not find, and the list of chunks has no checksum.
void require_all_chunks(const Hdf5Handle& dataset, const Shape& shape, const std::string& where)
{
    const Hdf5Handle layout(H5Dget_create_plist(dataset.id()), H5Pclose);
    Shape chunk(shape.size());
    if (H5Pget_chunk(layout.id(), static_cast<int>(chunk.size()), chunk.data()) < 0)
        throw failed_read(where);
    // as written; other sizes would ask for other amounts of memory than the values need
    if (chunk != chunk_of({shape.begin() + 1, shape.end()}))
        throw Error(ErrorKind::input, where, "has chunks of the shape " + shape_text(chunk));
    const Hdf5Handle type(H5Dget_type(dataset.id()), H5Tclose);
    const hsize_t with_checksum = product(chunk) * H5Tget_size(type.id()) + checksum_bytes;
    for (hsize_t row = 0; row < shape.front(); row += chunk.front()) {
        const Shape start = with_rows(row, Shape(shape.size() - 1, 0));
        unsigned skipped_filters = 0;
        haddr_t address = HADDR_UNDEF;
        hsize_t bytes = 0;
        if (H5Dget_chunk_info_by_coord(dataset.id(), start.data(), &skipped_filters, &address,
                                       &bytes) < 0)
            throw failed_read(where);
        if (address == HADDR_UNDEF || skipped_filters != 0 || bytes != with_checksum)
            throw Error(ErrorKind::input, where,
                        "must have values with a checksum from row " + std::to_string(row) + " on");
    }
}

}

GrowingDataset::GrowingDataset(const Hdf5Group& group, const std::string& name, hid_t native,
                               const Shape& row_shape, const std::string& unit)
    : where_(group.where(name)), row_shape_(row_shape), row_size_(product(row_shape))
{
    const Shape none = with_rows(0, row_shape), unlimited = with_rows(H5S_UNLIMITED, row_shape);
    const Shape chunk = chunk_of(row_shape);
    const int rank = static_cast<int>(none.size());
    const Hdf5Handle space(H5Screate_simple(rank, none.data(), unlimited.data()), H5Sclose);
    const Hdf5Handle layout = without_times(H5P_DATASET_CREATE);
    H5Pset_chunk(layout.id(), rank, chunk.data());
    H5Pset_fletcher32(layout.id());
    dataset_ = created(H5Dcreate2(group.id(), name.c_str(), stored_type(native), space.id(),
                                  H5P_DEFAULT, layout.id(), H5P_DEFAULT),
                       H5Dclose, where_);
    if (!unit.empty()) write_text(dataset_.id(), where_, "unit", unit);
}

void GrowingDataset::append(hid_t native, const void* values, hsize_t count)
{
    if (count == 0) return;
    const Shape added = with_rows(count, row_shape_), all = with_rows(rows_ + count, row_shape_);
    Shape start(added.size(), 0);
    start.front() = rows_;
    if (H5Dset_extent(dataset_.id(), all.data()) < 0) throw failed_write(where_);
    const Hdf5Handle space(H5Dget_space(dataset_.id()), H5Sclose);
    H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, added.data(), nullptr);
    const Hdf5Handle memory = data_space(added);
    if (H5Dwrite(dataset_.id(), native, memory.id(), space.id(), H5P_DEFAULT, values) < 0)
        throw failed_write(where_);
    rows_ += count;
}

void GrowingDataset::close()
{
    if (!dataset_.close()) throw failed_write(where_);
}

Shape dataset_shape(const Hdf5Group& group, const std::string& name)
{
    const Hdf5Handle dataset = open_dataset(group, name);
    const Hdf5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    const int rank = H5Sget_simple_extent_ndims(space.id());
    if (rank < 0) throw failed_read(group.where(name));
    Shape shape(static_cast<std::size_t>(rank));
    H5Sget_simple_extent_dims(space.id(), shape.data(), nullptr);
    return shape;
}

hsize_t checked_size(const Hdf5Group& group, const std::string& name, const Shape& shape)
{
    const Shape found = dataset_shape(group, name);
    if (found != shape)
        throw Error(ErrorKind::input, group.where(name),
                    "must have the shape " + shape_text(shape) + ", got " + shape_text(found));
    // Nothing is compressed: the values need at least their own size.
    const Hdf5Handle dataset = open_dataset(group, name);
    const Hdf5Handle type(H5Dget_type(dataset.id()), H5Tclose);
    const hsize_t bytes = H5Dget_storage_size(dataset.id());
    if (bytes / std::max<std::size_t>(1, H5Tget_size(type.id())) < product(shape))
        throw Error(ErrorKind::input, group.where(name),
                    "must hold all values of the shape " + shape_text(shape) + ", holds " +
                        std::to_string(bytes) + " bytes");
    require_all_chunks(dataset, shape, group.where(name));
    return product(shape);
}

namespace {

Hdf5Handle open_as(const Hdf5Group& group, const std::string& name, hid_t native)
{
    Hdf5Handle dataset = open_dataset(group, name);
    const Hdf5Handle stored(H5Dget_type(dataset.id()), H5Tclose);
    if (H5Tequal(stored.id(), stored_type(native)) <= 0)
        throw Error(ErrorKind::input, group.where(name), "has another type of number");
    return dataset;
}

}

void read_values(const Hdf5Group& group, const std::string& name, hid_t native, void* values)
{
    const Hdf5Handle dataset = open_as(group, name, native);
    if (H5Dread(dataset.id(), native, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
        throw failed_read(group.where(name));
}

void read_rows(const Hdf5Group& group, const std::string& name, hid_t native, hsize_t first,
               const Shape& rows, void* values)
{
    const Hdf5Handle dataset = open_as(group, name, native);
    const Hdf5Handle space(H5Dget_space(dataset.id()), H5Sclose), memory = data_space(rows);
    Shape start(rows.size(), 0);
    start.front() = first;
    if (H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, rows.data(),
                            nullptr) < 0 ||
        H5Dread(dataset.id(), native, memory.id(), space.id(), H5P_DEFAULT, values) < 0)
        throw failed_read(group.where(name));
}

}
