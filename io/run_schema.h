// io/run_schema.h -- the datasets of run.h5: the one list that the writer and the reader go
// through.
//
// visit(name, unit, access) is called for every dataset; access(object) is a reference to the
// member that is stored. Schema with meanings: io/README.md. A change of a name or a meaning needs
// a new run_schema_version.
#pragma once
#include "engine/frame.h"
#include "io/hdf5_dataset.h"

#include <cstdint>
#include <type_traits>
#include <vector>

namespace sigmaflow::io {

/// 2: the steps of H5MD count the recorded instants of the whole file. In schema 1, which is read as
/// well, samples and frames were counted by themselves.
inline constexpr int run_schema_version = 2, oldest_run_schema_version = 1;

/// Per particle and frame, elements of /particles/trajectory; the first one is H5MD's position.
template <class Visit>
void visit_particle_arrays(const Visit& visit)
{
    visit(
        "position", "a", [](auto& frame) -> auto& { return frame.state.position; });
    visit(
        "velocity", "a rate0", [](auto& frame) -> auto& { return frame.velocity; });
    visit(
        "angular_velocity", "rate0", [](auto& frame) -> auto& { return frame.angular_velocity; });
    visit(
        "nonaffine_velocity", "a rate0",
        [](auto& frame) -> auto& { return frame.nonaffine_velocity; });
    visit(
        "nonaffine_speed", "-", [](auto& frame) -> auto& { return frame.nonaffine_speed; });
    visit(
        "contact_number", "-", [](auto& frame) -> auto& { return frame.contact_number; });
    visit(
        "stress", "sigma0 a^3", [](auto& frame) -> auto& { return frame.particle_stress; });
}

/// Rows of /state/contacts: what a contact remembers.
template <class Visit>
void visit_columns(const Contact*, const Visit& visit)
{
    visit(
        "i", "", [](auto& contact) -> auto& { return contact.i; });
    visit(
        "j", "", [](auto& contact) -> auto& { return contact.j; });
    visit(
        "spring", "a", [](auto& contact) -> auto& { return contact.spring; });
    visit(
        "rolling", "a", [](auto& contact) -> auto& { return contact.rolling; });
    visit(
        "sliding", "", [](auto& contact) -> auto& { return contact.sliding; });
}

/// Rows of /contacts: what a contact does.
template <class Visit>
void visit_columns(const ContactForce*, const Visit& visit)
{
    visit(
        "i", "", [](auto& contact) -> auto& { return contact.i; });
    visit(
        "j", "", [](auto& contact) -> auto& { return contact.j; });
    visit(
        "start", "a", [](auto& contact) -> auto& { return contact.start; });
    visit(
        "end", "a", [](auto& contact) -> auto& { return contact.end; });
    visit(
        "xi", "-", [](auto& contact) -> auto& { return contact.xi; });
    visit(
        "normal_force", "F*", [](auto& contact) -> auto& { return contact.normal_force; });
    visit(
        "tangential_force", "F*", [](auto& contact) -> auto& { return contact.tangential_force; });
    visit(
        "sliding", "", [](auto& contact) -> auto& { return contact.sliding; });
    visit(
        "frictional", "", [](auto& contact) -> auto& { return contact.frictional; });
}

/// How a value is stored: double, int32 or (bool) uint8; vectors [3], tensors [3 x 3] row by row.
template <class T>
struct Stored {
    using Number =
        std::conditional_t<std::is_same_v<T, double>, double,
                           std::conditional_t<std::is_same_v<T, bool>, std::uint8_t, std::int32_t>>;
    static Shape shape() { return {}; }
    static void put(const T& value, std::vector<Number>& to)
    {
        to.push_back(static_cast<Number>(value));
    }
    static void get(const Number* from, T& value) { value = static_cast<T>(*from); }
};

template <int Columns>
struct Stored<Eigen::Matrix<double, 3, Columns>> {
    using Value = Eigen::Matrix<double, 3, Columns>;
    using Number = double;
    static Shape shape() { return Columns == 1 ? Shape{3} : Shape{3, Columns}; }
    static void put(const Value& value, std::vector<double>& to)
    {
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < Columns; ++column) to.push_back(value(row, column));
    }
    static void get(const double* from, Value& value)
    {
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < Columns; ++column) value(row, column) = *from++;
    }
};

/// The type of the member that `access` refers to, or of the elements if it is a list.
template <class Object, class Access>
using Member = std::remove_cvref_t<std::invoke_result_t<Access, Object&>>;
template <class Access>
using ArrayElement = typename Member<Frame, Access>::value_type;

}
