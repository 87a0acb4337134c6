// render/particle_series.h -- one view for several pictures: a film in which neither the camera nor
// the colours jump.
//
// The colours cover the values of all pictures as those of one picture are covered
// (render/particles.h), the camera the particles of all of them.
#pragma once
#include "render/particles.h"

namespace sigmaflow::render {

class ParticleSeries {
public:
    explicit ParticleSeries(ParticleView view) : view_(std::move(view)) {}

    /// `contacts` for pictures of chains, otherwise null. Errors: input (no such array).
    void add(vtkPolyData* particles, vtkPolyData* contacts);
    /// The view with `colour_minimum`, `colour_maximum` (where they were not given) and `seen`.
    ParticleView view() const;

private:
    ParticleView view_;
    std::vector<double> values_;
    bool whole_numbers_ = false;
    Position low_{}, high_{};  // of everything but the box
    bool empty_ = true;
    void include(const Position& centre, double radius);
};

}
