// io/hdf5_group.h -- an HDF5 file, its groups and their attributes.
//
// Errors "<file>:<path in the file>: <problem>": file, no_space while writing, input while reading.
#pragma once
#include "io/hdf5_types.h"

#include <filesystem>
#include <string>
#include <vector>

namespace sigmaflow::io {

/// A group of an open file, or its root.
class Hdf5Group {
public:
    /// Replaces an older file.
    static Hdf5Group create_file(const std::filesystem::path& path);
    /// For reading. Errors: missing (cannot be read), input (not an HDF5 file, or cut off).
    static Hdf5Group open_file(const std::filesystem::path& path);

    Hdf5Group create_group(const std::string& name) const;
    Hdf5Group open_group(const std::string& name) const;
    hid_t id() const { return handle_.id(); }
    /// "<file>:<path of the entry>", or of the group itself, for error messages.
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

// Attributes of a group or dataset; `where` names the object.
void write_attribute(hid_t object, const std::string& where, const std::string& name, hid_t stored,
                     hid_t native, const Shape& shape, const void* values);
/// Trailing NUL bytes are lost.
void write_text(hid_t object, const std::string& where, const std::string& name,
                const std::string& text);

inline void write_text(const Hdf5Group& group, const std::string& name, const std::string& text)
{
    write_text(group.id(), group.where(), name, text);
}
/// A list of words of equal length.
void write_words(const Hdf5Group& group, const std::string& name,
                 const std::vector<std::string>& words);

template <class T>
void write_number(const Hdf5Group& group, const std::string& name, T value)
{
    write_attribute(group.id(), group.where(), name, stored_type(native_type<T>()),
                    native_type<T>(), {}, &value);
}
template <class T>
void write_numbers(const Hdf5Group& group, const std::string& name, const std::vector<T>& values)
{
    write_attribute(group.id(), group.where(), name, stored_type(native_type<T>()),
                    native_type<T>(), {values.size()}, values.data());
}

std::vector<std::string> attribute_names(const Hdf5Group& group);
/// An attribute that is one text, or one number of any type.
std::string read_text(const Hdf5Group& group, const std::string& name);
double read_number(const Hdf5Group& group, const std::string& name);

}
