// engine/pair_distances.h -- all pairs within a distance of the order of the box, where cells would
// not help.
//
// Every pair is looked at, by vectors: some milliseconds for the ten million pairs of 4500
// particles. Nearest images in the sheared box; `reach` is at most half the smallest box length, so
// that there is one image. Tested by the users, engine/pair_correlation and engine/nonaffine_field.
#pragma once
#include "engine/state.h"

#include <cmath>
#include <vector>

namespace sigmaflow {

class PairDistances {
public:
    explicit PairDistances(const State& state);

    /// visit(i, j, d, r) for all i < j with r = |d| < reach, d from i to the nearest image of j.
    template <class Visit>
    void each(double reach, const Visit& visit)
    {
        const double square = reach * reach;
        for (int i = 0; i + 1 < n_; ++i) {
            find_from(i);
            for (int j = i + 1; j < n_; ++j)
                if (r2_[j] < square) visit(i, j, Vec3(dx_[j], dy_[j], dz_[j]), std::sqrt(r2_[j]));
        }
    }

private:
    void find_from(int i);

    Box box_;
    int n_;
    std::vector<double> x_, y_, z_, dx_, dy_, dz_, r2_;
};

}
