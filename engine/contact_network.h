// engine/contact_network.h -- who touches whom in one frame: numbers, rattlers, clusters, fabric.
//
// Contact number    Z = 2 N_c/n.
// Rattlers          particles with fewer contacts than `least_contacts`; they and their contacts
// are
//                   taken away, again and again, until none is left (the k-core of the network).
//                   With friction two contacts can hold a sphere, without it takes four.
// Constraints       of the relative motion of two surfaces: 3 where a contact sticks (the normal
// and
//                   two tangential directions), 1 where it slides or has no friction (the direction
//                   of slip tells that of the force). Per particle and without rattlers, a rigid
//                   network needs 6, the degrees of freedom of a sphere that friction can turn, or
//                   3 without friction (counting of Maxwell, Phil. Mag. 27, 294, 1864; sliding
//                   contacts: Shundyak, van Hecke & van Saarloos, Phys. Rev. E 75, 010301, 2007).
// Fabric tensor     sum of n n over the contacts, divided by their number (Satake, IUTAM conference
// on
//                   deformation and failure of granular materials, 1982, 63); its trace is 1.
// Clusters          of touching particles. A cluster percolates if a path in it leads from a
// particle
//                   to an image of the same particle. With the lattice of images
//                     m_x (Lx, 0, 0) + m_y (D, Ly, 0) + m_z (0, 0, Lz)
//                   and all paths of the cluster: along the gradient if one has m_y != 0, along the
//                   vorticity if one has m_z != 0, and along the flow if one has m_y = 0, m_x != 0.
//                   These do not depend on which of the images above is called the nearest.
// Close pairs       surfaces at most `close_gap` [a] apart, touching ones included.
//
// Tests: chains, rings and helices of known winding; nested trees; lattices of known fabric; offset
// of the box moved by Lx; images of the particles; all pairs as a slow twin.
#pragma once
#include "engine/frame.h"
#include "engine/statistics.h"

#include <array>
#include <span>
#include <string_view>
#include <vector>

namespace sigmaflow {

struct NetworkParameters {
    int least_contacts = 2;  // of a particle that is no rattler [-] >= 1
    double close_gap = 0.1;  // [a] >= 0
};

/// The numbers of one frame; what has no contacts at all is 0.
struct ContactNetwork {
    double contact_number = 0, frictional_contact_number = 0;
    double rattler_fraction = 0;
    double net_contact_number = 0;            // without rattlers
    double frictional_particle_fraction = 0;  // with at least one frictional contact
    double frictional_contact_fraction = 0;   // of the contacts
    double frictional_pair_fraction = 0;      // of the close pairs
    double sliding_fraction = 0;              // of the frictional contacts
    double constraint_number = 0;             // per particle
    double net_constraint_number = 0;
    double cluster_number = 0;  // clusters of at least two particles, per particle
    double largest_cluster_fraction = 0;
    double percolates_flow = 0, percolates_gradient = 0, percolates_vorticity = 0;  // 0 or 1
    double mean_normal_force = 0, mean_tangential_force = 0;  // [F*]; the latter of frictional ones
};

struct NetworkField {
    std::string_view name, unit, meaning;
    double ContactNetwork::*value;
};
std::span<const NetworkField> network_fields();

/// Errors: input (least_contacts < 1, close_gap < 0).
ContactNetwork contact_network(const Frame& frame, const NetworkParameters& parameters);

/// Whether each particle is a rattler [n].
std::vector<bool> rattlers(const Frame& frame, int least_contacts);

enum class ContactSet { all, frictional, sliding };
/// Empty without such contacts.
std::vector<Mat3> fabric_tensors(std::span<const Frame> frames, ContactSet set);

/// The deviatoric part in the shear plane of the mean of tensors F that belong to frames:
///   anisotropy  sqrt((F_xx - F_yy)^2 + 4 F_xy^2), the difference of the principal values
///   angle       of the larger principal direction from the flow, atan2(2 F_xy, F_xx - F_yy)/2,
///               in [0, 180) [degrees]; compression by shear is at 135
/// Their errors are those of their linear parts in the deviations of the frames.
struct PlaneAnisotropy {
    Estimate anisotropy, angle;
};
PlaneAnisotropy plane_anisotropy(std::span<const Mat3> tensors);

/// counts[z] = share of the particles with z contacts, for the contact numbers of all frames.
struct ContactShares {
    std::vector<Estimate> share;
};
ContactShares contact_shares(std::span<const Frame> frames);

/// Sizes of the forces of all frames over the mean of all of them, by frame.
struct RelativeForces {
    double mean = 0;  // [F*]
    std::vector<std::vector<double>> frames;
    double largest = 0;  // [mean]
};
RelativeForces normal_forces(std::span<const Frame> frames);
/// Of frictional contacts.
RelativeForces tangential_forces(std::span<const Frame> frames);

}
