// Lets libFuzzer change JSON as JSON in two of three cases: a value becomes a number from the edge,
// a copy of another value or another text, members and elements come and go. Bytes alone hardly
// ever get past the parser.
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* bytes, std::size_t count, std::size_t most);

namespace {

using Json = nlohmann::ordered_json;
using Random = std::minstd_rand;

std::size_t below(Random& random, std::size_t count)
{
    return random() % count;
}

template <class Items>
auto& one_of(Random& random, Items& items)
{
    return items[below(random, items.size())];
}

void collect(Json& node, std::vector<Json*>& nodes)
{
    nodes.push_back(&node);
    if (node.is_structured())
        for (Json& inner : node) collect(inner, nodes);
}

std::string mutated(std::string text)
{
    const std::size_t count = text.size(), most = count + 16;
    text.resize(most);
    text.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(text.data()), count, most));
    return text;
}

Json number(Random& random, const Json& old)
{
    static const std::array<Json, 24> edges{0,
                                            -0.0,
                                            1,
                                            -1,
                                            2,
                                            3,
                                            0.5,
                                            0.01,
                                            0.64,
                                            1e-6,
                                            1e9,
                                            1e3,
                                            1e4,
                                            1e15,
                                            5e-324,
                                            2.3e-308,
                                            1.7e308,
                                            -1.7e308,
                                            10000000,
                                            9007199254740992.,
                                            9007199254740993,
                                            2147483648,
                                            std::numeric_limits<std::int64_t>::min(),
                                            std::numeric_limits<std::uint64_t>::max()};
    if (!old.is_number() || below(random, 2) == 0) return one_of(random, edges);
    const double x = old.get<double>();
    const std::array<double, 6> near{x + 1, x - 1, 2 * x, x / 2, -x, std::nextafter(x, 1e300)};
    return one_of(random, near);
}

void mutate_members(Random& random, Json& node, const Json& copy)
{
    if (below(random, 2) == 0 && !node.empty())
        node.erase(std::next(node.begin(), static_cast<long>(below(random, node.size()))));
    else if (node.is_array())
        node.insert(node.begin() + static_cast<long>(below(random, node.size() + 1)), copy);
    else if (copy.is_object())  // members of another object
        for (const auto& [key, value] : copy.items())
            if (below(random, 2) == 0) node[key] = value;
}

void mutate(Random& random, Json& root)
{
    std::vector<Json*> nodes;
    collect(root, nodes);
    Json& node = *one_of(random, nodes);
    const Json copy = *one_of(random, nodes);
    const std::size_t kind = below(random, 8);
    if (kind < 4 && node.is_structured())
        mutate_members(random, node, copy);
    else if (kind < 5)
        node = copy;
    else if (kind < 6 && node.is_string())
        node = mutated(node.get<std::string>());
    else if (kind < 7 && node.is_boolean())
        node = !node.get<bool>();
    else
        node = number(random, node);
}

}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* bytes, std::size_t count,
                                               std::size_t most, unsigned seed)
{
    Random random(seed);
    if (below(random, 3) == 0) return LLVMFuzzerMutate(bytes, count, most);
    Json root = Json::parse(bytes, bytes + count, nullptr, /*allow_exceptions=*/false);
    if (root.is_discarded()) return LLVMFuzzerMutate(bytes, count, most);
    for (std::size_t k = 1 + below(random, 3); k > 0; --k) mutate(random, root);
    const std::string text = root.dump(-1, ' ', false, nlohmann::detail::error_handler_t::replace);
    if (text.size() > most) return LLVMFuzzerMutate(bytes, count, most);
    std::copy(text.begin(), text.end(), bytes);
    return text.size();
}
