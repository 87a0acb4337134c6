// workflows/jamming_report.h -- what a search for the stress of jamming has found: table, picture,
// verdict.
#pragma once
#include "engine/jamming.h"
#include "workflows/pictures.h"
#include "workflows/shearing.h"

#include <vector>

namespace sigmaflow::workflows {

/// One stress, tried.
struct Tried {
    double stress = 0;
    Outcome outcome = Outcome::undecided;
    double strain = 0;          // when it ended [-]
    double viscosity = 0;       // of the last window [eta0]; 0: no window
    double force_residual = 0;  // at its end
    long steps = 0;
};

/// One start at one volume fraction.
struct Found {
    double volume_fraction = 0;
    std::uint64_t seed = 0;
    bool is_packed = true;  // there is a packing without overlaps
    JammingBracket bracket;
    std::vector<Tried> tried;
    bool has_jammed = false;
    Tried unjamming, reversal;  // if it has jammed
};

template <class Archive>
void archive(Archive& a, Tried& t)
{
    a(t.stress, t.outcome, t.strain, t.viscosity, t.force_residual, t.steps);
}

template <class Archive>
void archive(Archive& a, Found& f)
{
    a(f.volume_fraction, f.seed, f.is_packed, f.bracket.flows, f.bracket.jams, f.tried,
      f.has_jammed, f.unjamming, f.reversal);
}

struct JammingSearch {
    int particles = 0;
    double lowest_stress = 0, highest_stress = 0;  // [sigma0]
};

/// <step>.csv, <step>.png and the results; `all` in the order of volume fractions.
void report_jamming(Context& context, const std::vector<Found>& all, const JammingSearch& search,
                    const PictureSize& size);

}
