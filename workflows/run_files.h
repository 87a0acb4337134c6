// workflows/run_files.h -- the files of one shearing step, in a folder named after the step.
//
//   series.csv                   time series, while the step runs and afterwards
//   run.journal                  samples and frames while the step runs (io/run_journal.h)
//   run.h5                       both, made of the journal at the end
//   particles.pvd, contacts.pvd  collections for ParaView of vtk/particles_00000.vtp, ...
//   view.py                      shows the particles in ParaView (io/paraview_view.h)
//   state.json                   the last state, for `sigmaflow evaluate`
// A step that goes on from a checkpoint finds its files as they were then: rows and frames that
// came later are made again.
#pragma once
#include "io/particles_vtp.h"
#include "io/run_file.h"
#include "io/run_journal.h"
#include "io/series_csv.h"
#include "workflows/checkpoint.h"
#include "workflows/step.h"

namespace sigmaflow::workflows {

class RunFiles {
public:
    /// `for_paraview`: frames also as VTK files.
    RunFiles(Context& context, const Model& model, const Control& control, bool for_paraview);

    /// `on_grid`: at a multiple of the series interval, unlike the last sample of a run that ran
    /// out of time.
    void append(const Sample& sample, bool on_grid);
    void append(const Frame& frame);
    /// How far the growing files have come, for a checkpoint; everything up to there is on the
    /// disk.
    std::vector<FileMark> marks();
    /// Writes the state before a failure, for `sigmaflow evaluate`; returns the path.
    std::filesystem::path write_failure(const State& state);
    /// Completes the files. The run is then one of context.runs.
    Run& finish();

    /// On the grid of the series interval.
    const std::vector<Sample>& series() const { return run_.series; }
    const Sample& last_sample() const { return last_sample_; }

private:
    void note(const Sample& sample, bool on_grid);
    void note(const Frame& frame);
    void write_hdf5();
    std::filesystem::path journal_path() const;

    Context& context_;
    const Model model_;
    std::string folder_;  // relative to the run folder
    bool for_paraview_;
    Run run_;
    Sample last_sample_;
    io::SeriesWriter csv_;
    io::RunJournal journal_;
    std::vector<io::SeriesEntry> particles_, contacts_;
};

}
