#include "engine/contact_network.h"

#include "engine/clusters.h"
#include "engine/error.h"
#include "engine/pairs.h"
#include "engine/units.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

namespace sigmaflow {

namespace {

int constraints(const ContactForce& c)
{
    return c.frictional && !c.sliding ? 3 : 1;
}

double share(double part, double whole)
{
    return whole > 0 ? part / whole : 0;
}

double close_pair_count(const State& state, double close_gap)
{
    return static_cast<double>(close_pairs(state, 0, close_gap).size());
}

/// What is left of the network without rattlers.
void count_backbone(const Frame& frame, int least_contacts, ContactNetwork& result)
{
    const std::vector<bool> loose = rattlers(frame, least_contacts);
    const double n = frame.state.size();
    const auto removed = static_cast<double>(std::count(loose.begin(), loose.end(), true));
    double contacts = 0, constrained = 0;
    for (const ContactForce& c : frame.contacts) {
        if (loose[c.i] || loose[c.j]) continue;
        contacts += 1;
        constrained += constraints(c);
    }
    result.rattler_fraction = share(removed, n);
    result.net_contact_number = share(2 * contacts, n - removed);
    result.net_constraint_number = share(constrained, n - removed);
}

void count_clusters(const Frame& frame, ContactNetwork& result)
{
    const double n = frame.state.size();
    double largest = 0, number = 0;
    for (const Cluster& cluster : clusters(frame)) {
        largest = std::max(largest, static_cast<double>(cluster.size));
        number += cluster.size > 1;
        result.percolates_flow = std::max(result.percolates_flow, double(cluster.flow));
        result.percolates_gradient = std::max(result.percolates_gradient, double(cluster.gradient));
        result.percolates_vorticity =
            std::max(result.percolates_vorticity, double(cluster.vorticity));
    }
    result.cluster_number = share(number, n);
    result.largest_cluster_fraction = share(largest, n);
}

RelativeForces relative(std::vector<std::vector<double>> forces)
{
    RelativeForces result{.mean = 0, .frames = std::move(forces), .largest = 0};
    double sum = 0, count = 0;
    for (const auto& frame : result.frames) {
        sum = std::accumulate(frame.begin(), frame.end(), sum);
        count += static_cast<double>(frame.size());
    }
    if (!(sum > 0)) return {.mean = 0, .frames = {}, .largest = 0};
    result.mean = sum / count;
    for (auto& frame : result.frames)
        for (double& force : frame) {
            force /= result.mean;
            result.largest = std::max(result.largest, force);
        }
    return result;
}

bool belongs(const ContactForce& c, ContactSet set)
{
    return set == ContactSet::all || (c.frictional && (set == ContactSet::frictional || c.sliding));
}

}

std::span<const NetworkField> network_fields()
{
    static constexpr NetworkField fields[] = {
        {"contact_number", "-", "touching neighbours per particle",
         &ContactNetwork::contact_number},
        {"frictional_contact_number", "-", "frictional touching neighbours per particle",
         &ContactNetwork::frictional_contact_number},
        {"rattler_fraction", "-", "share of the particles that are rattlers",
         &ContactNetwork::rattler_fraction},
        {"net_contact_number", "-", "contact number without rattlers",
         &ContactNetwork::net_contact_number},
        {"frictional_particle_fraction", "-", "share of the particles with frictional contacts",
         &ContactNetwork::frictional_particle_fraction},
        {"frictional_contact_fraction", "-", "frictional share of the contacts",
         &ContactNetwork::frictional_contact_fraction},
        {"frictional_pair_fraction", "-", "frictional contacts over close pairs",
         &ContactNetwork::frictional_pair_fraction},
        {"sliding_fraction", "-", "sliding share of the frictional contacts",
         &ContactNetwork::sliding_fraction},
        {"constraint_number", "-", "constraints per particle: sticking 3, others 1",
         &ContactNetwork::constraint_number},
        {"net_constraint_number", "-", "constraints per particle without rattlers",
         &ContactNetwork::net_constraint_number},
        {"cluster_number", "-", "clusters of two or more particles, per particle",
         &ContactNetwork::cluster_number},
        {"largest_cluster_fraction", "-", "share of the particles in the largest cluster",
         &ContactNetwork::largest_cluster_fraction},
        {"percolates_flow", "-", "1 if a cluster percolates along the flow",
         &ContactNetwork::percolates_flow},
        {"percolates_gradient", "-", "1 if a cluster percolates along the gradient",
         &ContactNetwork::percolates_gradient},
        {"percolates_vorticity", "-", "1 if a cluster percolates along the vorticity",
         &ContactNetwork::percolates_vorticity},
        {"mean_normal_force", "F*", "of the contacts", &ContactNetwork::mean_normal_force},
        {"mean_tangential_force", "F*", "of the frictional contacts",
         &ContactNetwork::mean_tangential_force},
    };
    return fields;
}

std::vector<bool> rattlers(const Frame& frame, int least_contacts)
{
    const auto n = static_cast<std::size_t>(frame.state.size());
    std::vector<std::vector<int>> partners(n);
    for (const ContactForce& c : frame.contacts) {
        partners[c.i].push_back(c.j);
        partners[c.j].push_back(c.i);
    }
    std::vector<int> left(n), loose;
    std::vector<bool> removed(n, false);
    for (std::size_t i = 0; i < n; ++i) {
        left[i] = static_cast<int>(partners[i].size());
        if (left[i] < least_contacts) loose.push_back(static_cast<int>(i));
    }
    while (!loose.empty()) {
        const int i = loose.back();
        loose.pop_back();
        removed[i] = true;
        // a particle falls below the limit once
        for (const int j : partners[i])
            if (left[j]-- == least_contacts) loose.push_back(j);
    }
    return removed;
}

ContactNetwork contact_network(const Frame& frame, const NetworkParameters& p)
{
    if (p.least_contacts < 1 || !(p.close_gap >= 0))
        throw Error(ErrorKind::input, "contact_network",
                    "needs least_contacts >= 1 and close_gap >= 0, got " +
                        std::to_string(p.least_contacts) + " and " + std::to_string(p.close_gap));
    ContactNetwork result;
    const double n = frame.state.size(), contacts = static_cast<double>(frame.contacts.size());
    double frictional = 0, sliding = 0, constrained = 0, normal = 0, tangential = 0;
    std::vector<bool> has_friction(frame.state.radius.size(), false);
    for (const ContactForce& c : frame.contacts) {
        constrained += constraints(c);
        normal += c.normal_force;
        if (!c.frictional) continue;
        frictional += 1;
        sliding += c.sliding;
        tangential += c.tangential_force.norm();
        has_friction[c.i] = has_friction[c.j] = true;
    }
    result.contact_number = share(2 * contacts, n);
    result.frictional_contact_number = share(2 * frictional, n);
    result.frictional_particle_fraction =
        share(static_cast<double>(std::count(has_friction.begin(), has_friction.end(), true)), n);
    result.frictional_contact_fraction = share(frictional, contacts);
    result.frictional_pair_fraction = share(frictional, close_pair_count(frame.state, p.close_gap));
    result.sliding_fraction = share(sliding, frictional);
    result.constraint_number = share(constrained, n);
    result.mean_normal_force = share(normal, contacts);
    result.mean_tangential_force = share(tangential, frictional);
    count_backbone(frame, p.least_contacts, result);
    count_clusters(frame, result);
    return result;
}

std::vector<Mat3> fabric_tensors(std::span<const Frame> frames, ContactSet set)
{
    std::vector<Mat3> result;
    for (const Frame& frame : frames) {
        Mat3 sum = Mat3::Zero();
        double count = 0;
        for (const ContactForce& c : frame.contacts) {
            if (!belongs(c, set)) continue;
            const Vec3 n = (c.end - c.start).normalized();
            sum += n * n.transpose();
            count += 1;
        }
        if (count > 0) result.emplace_back(sum / count);
    }
    return result;
}

PlaneAnisotropy plane_anisotropy(std::span<const Mat3> tensors)
{
    PlaneAnisotropy result;
    if (tensors.empty()) return result;
    Mat3 mean = Mat3::Zero();
    for (const Mat3& f : tensors) mean += f / static_cast<double>(tensors.size());
    const auto stretch = [](const Mat3& f) { return f(flow, flow) - f(gradient, gradient); };
    const auto skew = [](const Mat3& f) { return f(flow, gradient) + f(gradient, flow); };
    const double x = stretch(mean), y = skew(mean), size = std::hypot(x, y);
    if (size <= 0) return result;
    double angle = std::atan2(y, x) / 2;
    if (angle < 0) angle += pi;
    std::vector<double> along, turned;
    for (const Mat3& f : tensors) {
        along.push_back((x * stretch(f) + y * skew(f)) / size);
        turned.push_back((angle + (x * skew(f) - y * stretch(f)) / (2 * size * size)) * 180 / pi);
    }
    result.anisotropy = estimate_mean(along);
    result.angle = estimate_mean(turned);
    return result;
}

ContactShares contact_shares(std::span<const Frame> frames)
{
    int most = 0;
    for (const Frame& frame : frames)
        for (const int z : frame.contact_number) most = std::max(most, z);
    std::vector<std::vector<double>> series(static_cast<std::size_t>(most) + 1);
    for (const Frame& frame : frames) {
        for (auto& one : series) one.push_back(0);
        for (const int z : frame.contact_number)
            series[static_cast<std::size_t>(z)].back() +=
                1 / static_cast<double>(frame.contact_number.size());
    }
    ContactShares result;
    for (const auto& one : series) result.share.push_back(estimate_mean(one));
    return result;
}

RelativeForces normal_forces(std::span<const Frame> frames)
{
    std::vector<std::vector<double>> forces(frames.size());
    for (std::size_t k = 0; k < frames.size(); ++k)
        for (const ContactForce& c : frames[k].contacts) forces[k].push_back(c.normal_force);
    return relative(std::move(forces));
}

RelativeForces tangential_forces(std::span<const Frame> frames)
{
    std::vector<std::vector<double>> forces(frames.size());
    for (std::size_t k = 0; k < frames.size(); ++k)
        for (const ContactForce& c : frames[k].contacts)
            if (c.frictional) forces[k].push_back(c.tangential_force.norm());
    return relative(std::move(forces));
}

}
