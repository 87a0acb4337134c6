// Any bytes as a case file. The state of an accepted one, written, reads back bit by bit.
#include "io/case_file.h"
#include "tests/fuzz/fuzzing.h"

#include <algorithm>
#include <bit>
#include <nlohmann/json.hpp>

using namespace sigmaflow;

namespace {

bool same(double a, double b)
{
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same(const Vec3& a, const Vec3& b)
{
    return same(a.x(), b.x()) && same(a.y(), b.y()) && same(a.z(), b.z());
}

bool same(const Contact& a, const Contact& b)
{
    return a.i == b.i && a.j == b.j && same(a.spring, b.spring) && same(a.rolling, b.rolling) &&
           a.sliding == b.sliding;
}

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b)
{
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const T& x, const T& y) { return same(x, y); });
}

bool same(const State& a, const State& b)
{
    return same(a.box.length, b.box.length) && same(a.box.offset, b.box.offset) &&
           same(a.position, b.position) && same(a.radius, b.radius) && same(a.contacts, b.contacts);
}

}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count)
{
    const auto one = fuzzing::accepted("fuzz", [&] {
        const auto document = io::JsonDocument::parse(fuzzing::as_text(bytes, count), "fuzz");
        return io::read_case(document.root());
    });
    if (!one) return 0;
    const auto again = io::JsonDocument::parse(io::state_json(one->state).dump(), "again");
    fuzzing::promise(same(io::read_state(again.root()), one->state),
                     "a written state reads back bit by bit");
    return 0;
}
