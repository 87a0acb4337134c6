// workflows/run_files.h -- the files of one shearing step, in a folder named after the step.
//
//   series.csv, run.h5           time series; frames too in run.h5
//   particles.pvd, contacts.pvd  collections for ParaView of vtk/particles_00000.vtp, ...
//   state.json                   the last state, for `sigmaflow evaluate`
#pragma once
#include "io/particles_vtp.h"
#include "io/run_file.h"
#include "io/series_csv.h"
#include "workflows/step.h"

namespace sigmaflow::workflows {

class RunFiles {
public:
    RunFiles(Context& context, const Control& control);

    void append(const Sample& sample, bool on_grid);
    /// `for_paraview`: also as VTK files.
    void append(const Frame& frame, bool for_paraview);
    /// Completes the files. The run is then one of context.runs.
    Run& finish();

    const std::vector<Sample>& series() const { return run_.series; }

private:
    Context& context_;
    std::string folder_;  // relative to the run folder
    Run run_;
    io::SeriesWriter csv_;
    io::RunWriter hdf5_;
    std::vector<io::SeriesEntry> particles_, contacts_;
};

}
