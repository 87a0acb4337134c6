#include "io/hdf5_group.h"

#include "io/atomic_file.h"

#include <algorithm>
#include <utility>

namespace sigmaflow::io {
namespace {

constexpr std::size_t longest_text = std::size_t{64} << 20;

/// HDF5 must not print, must not try again at the end of the program to write what could not be
/// written before, and must neither follow a file to other files nor load code that it names.
void prepare()
{
    H5dont_atexit();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    H5Lunregister(H5L_TYPE_EXTERNAL);
    H5PLset_loading_state(0);
}

Hdf5Handle file_access()
{
    Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    // The structures of HDF5 1.8: checksums, and attributes may be longer than 64 KiB.
    H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V110);
    H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG);
    H5Pset_file_locking(access.id(), true, true);  // not on file systems that have no locks
    return access;
}

/// An attribute with a single value.
Hdf5Handle open_attribute(const Hdf5Group& group, const std::string& name)
{
    const std::string where = group.where(name);
    Hdf5Handle attribute = opened(H5Aopen(group.id(), name.c_str(), H5P_DEFAULT), H5Aclose, where);
    const Hdf5Handle space(H5Aget_space(attribute.id()), H5Sclose);
    if (H5Sget_simple_extent_npoints(space.id()) != 1)
        throw Error(ErrorKind::input, where, "must be a single value");
    return attribute;
}

}

Hdf5Group::Hdf5Group(Hdf5Handle handle, std::filesystem::path file, std::string name)
    : handle_(std::move(handle)), file_(std::move(file)), name_(std::move(name))
{
}

Hdf5Group Hdf5Group::create_file(const std::filesystem::path& path)
{
    prepare();
    const Hdf5Handle access = file_access();
    const Hdf5Handle creation = without_times(H5P_FILE_CREATE);
    const hid_t id = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.id(), access.id());
    return Hdf5Group(created(id, H5Fclose, path.string()), path, "");
}

Hdf5Group Hdf5Group::open_file(const std::filesystem::path& path)
{
    prepare();
    first_bytes(path, 1);  // names the reason if the file cannot be read
    const Hdf5Handle access = file_access();
    const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id());
    return Hdf5Group(opened(id, H5Fclose, path.string()), path, "");
}

Hdf5Group Hdf5Group::create_group(const std::string& name) const
{
    const Hdf5Handle creation = without_times(H5P_GROUP_CREATE);
    const hid_t group = H5Gcreate2(id(), name.c_str(), H5P_DEFAULT, creation.id(), H5P_DEFAULT);
    return Hdf5Group(created(group, H5Gclose, where(name)), file_, name_ + '/' + name);
}

Hdf5Group Hdf5Group::open_group(const std::string& name) const
{
    const hid_t group = H5Gopen2(id(), name.c_str(), H5P_DEFAULT);
    return Hdf5Group(opened(group, H5Gclose, where(name)), file_, name_ + '/' + name);
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

void write_attribute(hid_t object, const std::string& where, const std::string& name, hid_t stored,
                     hid_t native, const Shape& shape, const void* values)
{
    const std::string place = where + '/' + name;
    const Hdf5Handle space = data_space(shape);
    const Hdf5Handle attribute =
        created(H5Acreate2(object, name.c_str(), stored, space.id(), H5P_DEFAULT, H5P_DEFAULT),
                H5Aclose, place);
    if (H5Awrite(attribute.id(), native, values) < 0) throw failed_write(place);
}

void write_text(hid_t object, const std::string& where, const std::string& name,
                const std::string& text)
{
    // A text of no bytes is not allowed; the byte behind the last one is NUL.
    const Hdf5Handle type = text_type(std::max<std::size_t>(1, text.size()));
    write_attribute(object, where, name, type.id(), type.id(), {}, text.c_str());
}

void write_words(const Hdf5Group& group, const std::string& name,
                 const std::vector<std::string>& words)
{
    const Hdf5Handle type = text_type(words.front().size());
    std::string joined;
    for (const std::string& word : words) joined += word;
    write_attribute(group.id(), group.where(), name, type.id(), type.id(), {words.size()},
                    joined.data());
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

double read_number(const Hdf5Group& group, const std::string& name)
{
    const Hdf5Handle attribute = open_attribute(group, name);
    double value = 0;
    if (H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, &value) < 0)
        throw failed_read(group.where(name));
    return value;
}

std::string read_text(const Hdf5Group& group, const std::string& name)
{
    const Hdf5Handle attribute = open_attribute(group, name);
    const Hdf5Handle stored(H5Aget_type(attribute.id()), H5Tclose);
    if (H5Tget_class(stored.id()) != H5T_STRING || H5Tis_variable_str(stored.id()) != 0)
        throw Error(ErrorKind::input, group.where(name), "must be a text of fixed length");
    const std::size_t length = H5Tget_size(stored.id());
    if (length > longest_text)
        throw Error(ErrorKind::input, group.where(name),
                    "must not be longer than " + std::to_string(longest_text) + " bytes, got " +
                        std::to_string(length));
    std::string text(length, '\0');
    const Hdf5Handle type = text_type(text.size());
    if (H5Aread(attribute.id(), type.id(), text.data()) < 0) throw failed_read(group.where(name));
    text.resize(text.find_last_not_of('\0') + 1);
    return text;
}

}
