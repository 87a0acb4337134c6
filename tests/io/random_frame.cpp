#include "tests/io/random_frame.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

namespace sigmaflow::testing_io {
namespace {

class Numbers {
public:
    explicit Numbers(unsigned seed, Extremes extremes = Extremes::any_double)
        : random_(seed), extremes_(extremes)
    {
    }

    double next()
    {
        using Limits = std::numeric_limits<double>;
        static constexpr std::array awkward{
            -0.0,          Limits::denorm_min(), -3 * Limits::denorm_min(),
            Limits::max(), Limits::lowest(),     Limits::infinity(),
            0.1,           1 + Limits::epsilon()};
        if (random_() % 8 == 0) {
            const double value = awkward.at(random_() % awkward.size());
            const bool large = std::abs(value) > 1e150;
            return large && extremes_ == Extremes::finite_norm ? std::copysign(1e100, value)
                                                               : value;
        }
        return std::normal_distribution<double>()(random_);
    }
    double positive() { return std::uniform_real_distribution<double>(0.5, 3)(random_); }
    bool flag() { return random_() % 2 == 0; }
    Vec3 vector() { return Vec3(next(), next(), next()); }
    std::vector<Vec3> vectors(std::size_t count)
    {
        std::vector<Vec3> result(count);
        for (Vec3& v : result) v = vector();
        return result;
    }
    Mat3 tensor()
    {
        Mat3 result;
        for (int k = 0; k < 9; ++k) result.data()[k] = next();
        return result;
    }

private:
    std::mt19937_64 random_;
    Extremes extremes_;
};

void add(Bits& list, double value)
{
    list.push_back(std::bit_cast<std::uint64_t>(value));
}
void add(Bits& list, int value)
{
    list.push_back(static_cast<std::uint64_t>(value));
}
void add(Bits& list, bool value)
{
    list.push_back(value);
}
template <int Columns>
void add(Bits& list, const Eigen::Matrix<double, 3, Columns>& value)
{
    for (int k = 0; k < value.size(); ++k) add(list, value.data()[k]);
}
template <class T>
void add(Bits& list, const std::vector<T>& values)
{
    list.push_back(values.size());
    for (const T& value : values) add(list, value);
}

}

Sample random_sample(unsigned seed)
{
    Numbers numbers(seed);
    Sample sample;
    for (const SampleField& field : sample_fields()) sample.*field.value = numbers.next();
    return sample;
}

Frame random_frame(int particles, int contacts, unsigned seed, Extremes extremes)
{
    Numbers numbers(seed, extremes);
    const auto n = static_cast<std::size_t>(particles);
    Frame frame;
    State& state = frame.state;
    state.box.length = Vec3(numbers.positive(), numbers.positive(), numbers.positive());
    state.box.offset = numbers.next();
    state.position = numbers.vectors(n);
    for (std::size_t k = 0; k < n; ++k) state.radius.push_back(k % 2 == 0 ? 1.0 : 1.4);
    state.strain = numbers.next();
    state.time = numbers.next();
    frame.sample = random_sample(seed + 1);
    frame.volume_fraction = numbers.positive();
    frame.velocity = numbers.vectors(n);
    frame.angular_velocity = numbers.vectors(n);
    frame.nonaffine_velocity = numbers.vectors(n);
    for (std::size_t k = 0; k < n; ++k) {
        frame.nonaffine_speed.push_back(numbers.next());
        frame.contact_number.push_back(static_cast<int>(k % 7));
        frame.particle_stress.push_back(numbers.tensor());
    }
    frame.species = species(state);
    for (int k = 0; k < contacts; ++k) {
        state.contacts.push_back({k, k + 1, numbers.vector(), numbers.vector(), numbers.flag()});
        frame.contacts.push_back({k, particles - 1, numbers.vector(), numbers.vector(),
                                  numbers.next(), numbers.next(), numbers.vector(), numbers.flag(),
                                  numbers.flag()});
    }
    return frame;
}

Bits bits(const Sample& sample)
{
    Bits list;
    for (const SampleField& field : sample_fields()) add(list, sample.*field.value);
    return list;
}

Bits bits(const State& state)
{
    Bits list;
    add(list, state.box.length);
    add(list, state.box.offset);
    add(list, state.position);
    add(list, state.radius);
    add(list, state.strain);
    add(list, state.time);
    for (const Contact& contact : state.contacts) {
        add(list, contact.i);
        add(list, contact.j);
        add(list, contact.spring);
        add(list, contact.rolling);
        add(list, contact.sliding);
    }
    return list;
}

Bits bits(const Frame& frame)
{
    Bits list = bits(frame.state);
    const Bits sample = bits(frame.sample);
    list.insert(list.end(), sample.begin(), sample.end());
    add(list, frame.volume_fraction);
    add(list, frame.velocity);
    add(list, frame.angular_velocity);
    add(list, frame.nonaffine_velocity);
    add(list, frame.nonaffine_speed);
    add(list, frame.contact_number);
    add(list, frame.species);
    add(list, frame.particle_stress);
    for (const ContactForce& contact : frame.contacts) {
        add(list, contact.i);
        add(list, contact.j);
        add(list, contact.start);
        add(list, contact.end);
        add(list, contact.xi);
        add(list, contact.normal_force);
        add(list, contact.tangential_force);
        add(list, contact.sliding);
        add(list, contact.frictional);
    }
    return list;
}

TemporaryFolder::TemporaryFolder()
{
    std::string name = (std::filesystem::temp_directory_path() / "sigmaflow_io_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder " + name);
    path_ = name;
}

TemporaryFolder::~TemporaryFolder()
{
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::vector<std::string> TemporaryFolder::files() const
{
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_))
        names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
}

}
