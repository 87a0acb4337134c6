#include "engine/error.h"
#include "engine/random.h"
#include "engine/relaxation_fit.h"
#include "engine/statistics.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace sigmaflow {

namespace {

using namespace relaxation_fit;
using Eigen::VectorXd;

void require(bool good, const std::string& problem)
{
    if (!good) throw Error(ErrorKind::input, "relaxation", problem);
}

using Members = std::vector<std::vector<double>>;

/// The mean of `count` members, the k-th one being member(k).
template <class Member>
VectorXd mean_of(const Members& members, std::size_t count, Member member)
{
    const auto size = static_cast<Eigen::Index>(members[0].size());
    VectorXd mean = VectorXd::Zero(size);
    for (std::size_t k = 0; k < count; ++k)
        mean += Eigen::Map<const VectorXd>(members[member(k)].data(), size);
    return mean / static_cast<double>(count);
}

double mean_correlation_time(const Members& members, const VectorXd& mean)
{
    double sum = 0;
    for (const std::vector<double>& member : members) {
        const VectorXd deviation = Eigen::Map<const VectorXd>(member.data(), mean.size()) - mean;
        sum += estimate_mean({deviation.data(), member.size()}).correlation_time;
    }
    return std::max(0.5, sum / static_cast<double>(members.size()));
}

std::vector<double> errors_of_mean(const Members& members, const VectorXd& mean)
{
    const auto count = static_cast<double>(members.size());
    VectorXd squares = VectorXd::Zero(mean.size());
    for (const std::vector<double>& member : members)
        squares += (Eigen::Map<const VectorXd>(member.data(), mean.size()) - mean).cwiseAbs2();
    const VectorXd errors = (squares / (count * (count - 1))).cwiseSqrt();
    // where all members agree by chance, the error is not 0
    const double floor = std::max(1e-6 * errors.maxCoeff(), 1e-12 * mean.cwiseAbs().maxCoeff());
    const VectorXd kept = errors.cwiseMax(std::max(floor, 1e-280));
    return {kept.data(), kept.data() + kept.size()};
}

/// Half the width of the central 68.3 % of the values.
double half_width(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    const auto at = [&](double share) {
        const double place = share * static_cast<double>(values.size() - 1);
        const auto k = std::min(static_cast<std::size_t>(place), values.size() - 2);
        return values[k] + (place - static_cast<double>(k)) * (values[k + 1] - values[k]);
    };
    return (at(0.841344746) - at(0.158655254)) / 2;
}

void set_errors(Relaxation& result, const std::vector<Relaxation>& refits)
{
    const auto width = [&](const auto& value_of) {
        std::vector<double> values;
        for (const Relaxation& one : refits) values.push_back(value_of(one).mean);
        return half_width(std::move(values));
    };
    result.plateau.standard_error = width([](const Relaxation& r) { return r.plateau; });
    result.initial.standard_error = width([](const Relaxation& r) { return r.initial; });
    for (std::size_t i = 0; i < result.terms.size(); ++i) {
        RelaxationTerm& term = result.terms[i];
        term.amplitude.standard_error =
            width([i](const Relaxation& r) { return r.terms[i].amplitude; });
        term.relaxation_strain.standard_error =
            width([i](const Relaxation& r) { return r.terms[i].relaxation_strain; });
    }
}

}

Relaxation fit_relaxation(std::span<const double> strain, std::span<const double> value,
                          std::span<const double> error, int exponentials, const KnownEnds& known)
{
    const Data data = data_of(strain, value, error, exponentials, known);
    return fit(data, minimised(data, start(data, exponentials)), 0.5);
}

Relaxation fit_relaxation(std::span<const double> strain, std::span<const double> value,
                          std::span<const double> error, int exponentials)
{
    return fit_relaxation(strain, value, error, exponentials, {});
}

Relaxation fit_relaxation_of_members(std::span<const double> strain, const Members& members,
                                     int exponentials, int resamples, std::uint64_t seed)
{
    require(members.size() >= 3, "needs at least 3 members, got " + std::to_string(members.size()));
    require(resamples >= 10, "needs at least 10 resamples, got " + std::to_string(resamples));
    for (const std::vector<double>& member : members)
        require(member.size() == strain.size(), "needs one value of every member for every strain");
    const std::size_t count = members.size();
    const VectorXd mean = mean_of(members, count, [](std::size_t k) { return k; });
    Data data = data_of(strain, {mean.data(), strain.size()}, errors_of_mean(members, mean),
                        exponentials, {});
    const VectorXd best = minimised(data, start(data, exponentials));
    Relaxation result = fit(data, best, mean_correlation_time(members, mean));
    std::vector<Relaxation> refits;
    for (int r = 0; r < resamples; ++r) {
        data.value = mean_of(members, count, [&](std::size_t k) {
            const double u = uniform(seed, static_cast<std::uint32_t>(r), k);
            return std::min(static_cast<std::size_t>(u * static_cast<double>(count)), count - 1);
        });
        refits.push_back(values_at(data, minimised(data, best)));
    }
    set_errors(result, refits);
    result.resolved = is_resolved(data, result);
    return result;
}

}
