// engine/archive.h -- values as bytes and back, bit by bit: what checkpoints are made of.
//
// ArchiveWriter and ArchiveReader walk the same list of members: a type takes part by a function
//   template <class Archive> void archive(Archive& a, T& value) { a(value.x, value.y); }
// (or a member `archive(a)` where the members are private). Numbers are stored as they lie in
// memory, lists with their length first. The reader trusts nothing: it never reads beyond the bytes
// it was given, and a length must fit into what is left before memory is taken for it. What the
// numbers mean is checked by whoever reads them.
// Errors: input ("ends too early", ...), without a place.
#pragma once
#include "engine/error.h"

#include <Eigen/Core>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

namespace sigmaflow {

static_assert(std::endian::native == std::endian::little, "archives are little-endian");

namespace archives {

template <class T>
concept Number = std::is_arithmetic_v<T> && !std::is_same_v<T, bool>;
/// Vec3, Mat3, ...
template <class T>
concept Fixed = std::is_base_of_v<Eigen::PlainObjectBase<T>, T> && T::SizeAtCompileTime >
0;
/// Stored as its bytes in memory; other types ask for it by a member type `stored_as_bytes`.
template <class T>
concept Plain = Number<T> || Fixed<T> || requires
{
    typename T::stored_as_bytes;
};
template <class T, class Archive>
concept HasMember = requires(T& value, Archive& a)
{
    value.archive(a);
};

template <class T>
constexpr bool is_vector = false;
template <class T>
constexpr bool is_vector<std::vector<T>> = true;
template <class T>
constexpr bool is_array = false;
template <class T, std::size_t N>
constexpr bool is_array<std::array<T, N>> = true;
template <class T>
constexpr bool is_optional = false;
template <class T>
constexpr bool is_optional<std::optional<T>> = true;
template <class T>
constexpr bool is_variant = false;
template <class... T>
constexpr bool is_variant<std::variant<T...>> = true;

}

class ArchiveWriter {
public:
    static constexpr bool reads = false;

    template <class... T>
    void operator()(const T&... values)
    {
        (put(values), ...);
    }
    /// `size` bytes without their number.
    void raw(const void* bytes, std::size_t size)
    {
        bytes_.append(static_cast<const char*>(bytes), size);
    }
    const std::string& bytes() const { return bytes_; }

private:
    template <class T>
    void put(const T& value)
    {
        if constexpr (std::is_same_v<T, bool>) {
            put(static_cast<std::uint8_t>(value));
        } else if constexpr (archives::Plain<T>) {
            raw(static_cast<const void*>(&value), sizeof value);
        } else if constexpr (std::is_same_v<T, std::string>) {
            put(std::uint64_t{value.size()});
            raw(value.data(), value.size());
        } else if constexpr (archives::is_vector<T>) {
            put(std::uint64_t{value.size()});
            if constexpr (archives::Plain<typename T::value_type>)
                raw(static_cast<const void*>(value.data()),
                    value.size() * sizeof(typename T::value_type));
            else
                for (const auto& one : value) put(one);
        } else if constexpr (archives::is_array<T>) {
            for (const auto& one : value) put(one);
        } else if constexpr (archives::is_optional<T>) {
            put(value.has_value());
            if (value) put(*value);
        } else if constexpr (archives::is_variant<T>) {
            put(static_cast<std::uint8_t>(value.index()));
            std::visit([&](const auto& one) { put(one); }, value);
        } else if constexpr (archives::HasMember<T, ArchiveWriter>) {
            const_cast<T&>(value).archive(*this);  // writing only reads
        } else {
            archive(*this, const_cast<T&>(value));
        }
    }

    std::string bytes_;
};

class ArchiveReader {
public:
    static constexpr bool reads = true;

    /// The bytes must outlive the reader.
    explicit ArchiveReader(std::string_view bytes) : rest_(bytes) {}

    template <class... T>
    void operator()(T&... values)
    {
        (get(values), ...);
    }
    void raw(void* bytes, std::size_t size)
    {
        need(size);
        if (size > 0) std::memcpy(bytes, rest_.data(), size);
        rest_.remove_prefix(size);
    }
    std::size_t left() const { return rest_.size(); }
    /// Error(input) if there are bytes left.
    void finish() const
    {
        if (!rest_.empty()) refuse(std::to_string(rest_.size()) + " bytes too many");
    }
    [[noreturn]] static void refuse(const std::string& problem)
    {
        throw Error(ErrorKind::input, "", problem);
    }

private:
    void need(std::size_t size) const
    {
        if (size > rest_.size()) refuse("ends too early");
    }

    /// Bytes that a T takes at least.
    template <class T>
    static std::size_t least_size()
    {
        static const std::size_t size = [] {
            ArchiveWriter writer;
            writer(T{});
            return std::max<std::size_t>(1, writer.bytes().size());
        }();
        return size;
    }

    template <class T>
    void get(T& value)
    {
        if constexpr (std::is_same_v<T, bool>) {
            std::uint8_t byte = 0;
            get(byte);
            if (byte > 1) refuse("must have 0 or 1, got " + std::to_string(byte));
            value = byte == 1;
        } else if constexpr (archives::Plain<T>) {
            raw(static_cast<void*>(&value), sizeof value);
        } else if constexpr (std::is_same_v<T, std::string>) {
            value.resize(count(1));
            raw(value.data(), value.size());
        } else if constexpr (archives::is_vector<T>) {
            using Item = typename T::value_type;
            value.clear();
            if constexpr (archives::Plain<Item>) {
                value.resize(count(sizeof(Item)));
                raw(static_cast<void*>(value.data()), value.size() * sizeof(Item));
            } else {
                value.resize(count(least_size<Item>()));
                for (auto& one : value) get(one);
            }
        } else if constexpr (archives::is_array<T>) {
            for (auto& one : value) get(one);
        } else if constexpr (archives::is_optional<T>) {
            bool there = false;
            get(there);
            value.reset();
            if (there) get(value.emplace());
        } else if constexpr (archives::is_variant<T>) {
            std::uint8_t index = 0;
            get(index);
            if (index >= std::variant_size_v<T>) refuse("has an unknown kind of value");
            get_alternative(value, index, std::make_index_sequence<std::variant_size_v<T>>());
        } else if constexpr (archives::HasMember<T, ArchiveReader>) {
            value.archive(*this);
        } else {
            archive(*this, value);
        }
    }

    template <class T, std::size_t... I>
    void get_alternative(T& value, std::size_t index, std::index_sequence<I...>)
    {
        ((I == index ? get(value.template emplace<I>()) : void()), ...);
    }

    std::size_t count(std::size_t size_of_one)
    {
        std::uint64_t number = 0;
        get(number);
        if (number > rest_.size() / size_of_one) refuse("ends too early");
        return static_cast<std::size_t>(number);
    }

    std::string_view rest_;
};

}
