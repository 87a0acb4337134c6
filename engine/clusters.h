// engine/clusters.h -- connected clusters of touching particles, and how they wind around the box.
//
// Percolation as in engine/contact_network.h. A path along contacts that closes on an image of its
// first particle has a winding (m_x, m_y, m_z) of whole numbers; those of a cluster form a lattice,
// of which up to three independent ones are kept, reduced in the order y, x, z of the components
// (the sheared images mix x into y, never y into x).
#pragma once
#include "engine/frame.h"

#include <vector>

namespace sigmaflow {

struct Cluster {
    int size = 0;                                            // particles
    bool flow = false, gradient = false, vorticity = false;  // percolates along
};

/// Every particle is in one cluster; those without contacts are clusters of size 1. The contacts of
/// the frame may begin and end at any images of their particles.
std::vector<Cluster> clusters(const Frame& frame);

}
