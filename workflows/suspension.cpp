#include "workflows/suspension.h"

#include "io/model_fields.h"

#include <nlohmann/json.hpp>

namespace sigmaflow::workflows {

io::Field comment_field()
{
    constexpr std::size_t longest = 100'000;
    return {.name = "comment",
            .help = "free text; not used",
            .kind = io::FieldKind::text,
            .length = {0, longest},
            .read = [](const io::JsonNode& node) { node.text(longest); },
            .write = [] { return nlohmann::ordered_json(); }};
}

void Suspension::describe(io::Fields& f)
{
    f("particles", packing.particles, io::Integers{2, 1'000'000}, "-", "number of spheres");
    f("volume_fraction", packing.volume_fraction, io::above_to(0, 1), "-",
      "volume of the spheres over volume of the box, met exactly; at most random close packing, "
      "0.64 for equal spheres, 0.6528 for the default mixture");
    f("size_ratio", packing.size_ratio, io::between(1, 10), "-",
      "radius of the large spheres; the small ones have radius 1");
    f("small_volume_share", packing.small_volume_share, io::between(0, 1), "-",
      "share of the solid volume in small spheres");
    f("radii", packing.radii, io::Length{2, 1'000'000}, io::between(0.01, 100), "a",
      "radii of all spheres, instead of size_ratio and small_volume_share");
    f("box_shape", packing.box_shape, io::between(0.01, 100), "-",
      "ratios of the box lengths along flow, gradient and vorticity");
    f("seed", packing.seed, "seed of the random packing; the same seed gives the same run");
    f.group("model", "physical parameters",
            [this](io::Fields& inner) { io::describe(inner, model); });
    f.add(comment_field());
}

namespace {

// Given radii replace the mixture.
void check_radii(PackingParameters& packing, const io::JsonNode& object)
{
    for (const char* other : {"size_ratio", "small_volume_share"})
        if (object.has(other))
            throw object.error_at_key(other, "radii already says how large the spheres are");
    const int given = static_cast<int>(packing.radii.size());
    if (object.has("particles") && packing.particles != given)
        throw object.member("particles")
            .wrong("must be the number of radii, " + std::to_string(given));
    packing.particles = given;
}

}

void Suspension::check(const io::JsonNode& object)
{
    if (const auto node = object.find("model")) io::check_model(model, *node);
    if (!packing.radii.empty()) check_radii(packing, object);
    largest_volume_fraction = random_close_packing(packing_radii(packing));
    if (const auto value = object.find("volume_fraction"))
        check_volume_fraction(packing.volume_fraction, *value);
}

void Suspension::check_volume_fraction(double volume_fraction, const io::JsonNode& value) const
{
    if (volume_fraction > largest_volume_fraction)
        throw value.wrong("must be <= " + io::number_text(largest_volume_fraction) +
                          ", random close packing of these spheres");
}

}
