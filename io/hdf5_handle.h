// io/hdf5_handle.h -- an HDF5 identifier that is closed at the end of its scope, and nothing else.
#pragma once
#include <hdf5.h>

#include <utility>

namespace sigmaflow::io {

class Hdf5Handle {
public:
    using Close = herr_t (*)(hid_t);

    Hdf5Handle() = default;
    Hdf5Handle(hid_t id, Close close_function) : id_(id), close_(close_function) {}
    ~Hdf5Handle() { close(); }
    Hdf5Handle(Hdf5Handle&& other) noexcept
        : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_)
    {
    }
    Hdf5Handle& operator=(Hdf5Handle&& other) noexcept
    {
        std::swap(id_, other.id_);
        std::swap(close_, other.close_);
        return *this;
    }

    bool valid() const { return id_ >= 0; }
    hid_t id() const { return id_; }

    /// True if there was nothing to close or closing succeeded.
    bool close()
    {
        const hid_t id = std::exchange(id_, H5I_INVALID_HID);
        return id < 0 || close_(id) >= 0;
    }

private:
    hid_t id_ = H5I_INVALID_HID;
    Close close_ = nullptr;
};

}
