// workflows/checkpoint.h -- the stored middle of a step, from which it goes on bit by bit.
//
// Two generations, .sigmaflow/checkpoint.0 and .1: a new one replaces the older file, so that a
// valid one exists at every instant after the first. The files that a step appends to are stored by
// their length and checksum; going on cuts them back. A checkpoint that is damaged, or whose files
// are not what they were, is passed over for the one before, with a warning.
// Errors: file, no_space; missing (there are checkpoints, but none can be used).
#pragma once
#include "io/appended_file.h"
#include "workflows/interruption.h"
#include "workflows/step_record.h"

#include <chrono>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

struct FileMark {
    std::string name;  // relative to the run folder
    io::Mark mark;
};

template <class Archive>
void archive(Archive& a, FileMark& f)
{
    a(f.name, f.mark);
}

struct Checkpoint {
    std::uint64_t generation = 0;
    std::string written;     // when, UTC
    std::string arithmetic;  // of the processor: another one gives other last bits
    StepIdentity step;
    double strain = 0;  // of the step so far [-]
    std::vector<FileMark> files;
    std::string run;  // what the step needs to go on

    /// Error(input) if the step has no such file.
    const io::Mark& mark(const std::string& name) const;
};

template <class Archive>
void archive(Archive& a, Checkpoint& c)
{
    a(c.generation, c.written, c.arithmetic, c.step, c.strain, c.files, c.run);
}

/// A strain for people, with four decimals at most.
std::string rounded_text(double strain);

/// The bytes of a checkpoint file; `file` stands for the file in error messages. Errors: input.
Checkpoint parse_checkpoint(std::string_view content, const std::string& file);

/// Errors: missing, input.
Checkpoint read_checkpoint(const std::filesystem::path& path);

/// The newest one that can be used; what is wrong with a newer one goes to `warnings`. Those of
/// finished steps (by their keys), which could not be removed then, do not count.
std::optional<Checkpoint> newest_checkpoint(const RunFolder& folder,
                                            const std::set<std::string>& finished,
                                            std::vector<std::string>& warnings);
/// Names of the steps that the checkpoints belong to, as far as they can be read.
std::vector<std::string> stored_steps(const RunFolder& folder);
void remove_checkpoints(const RunFolder& folder);

/// Decides when the running step is stored and whether it goes on.
class Keeper {
public:
    /// interval [s] >= 0: between two checkpoints; 0: after every step.
    Keeper(const RunFolder& folder, const Interruption& interruption, double interval)
        : folder_(folder), interruption_(interruption), interval_(interval)
    {
    }

    /// A step begins, or goes on from a checkpoint.
    void begin(const StepIdentity& step, std::optional<Checkpoint> saved);
    const StepIdentity& step() const { return step_; }
    /// The checkpoint that the running step goes on from, if it does.
    const Checkpoint* saved() const { return saved_ ? &*saved_ : nullptr; }

    /// True when the step should be stored now.
    bool due() const;
    /// Stores the step; Error(interrupted) afterwards if the run was asked to stop.
    void keep(double strain, std::vector<FileMark> files, std::string run);
    /// For steps without checkpoints. Error(interrupted) if the run was asked to stop; it says what
    /// the same command will do.
    void stop_if_asked(const std::string& next = "begins this step anew") const;

private:
    using Clock = std::chrono::steady_clock;

    const RunFolder& folder_;
    const Interruption& interruption_;
    double interval_, cost_ = 0;  // [s]; what storing took
    StepIdentity step_;
    std::optional<Checkpoint> saved_;
    std::uint64_t generation_ = 0;
    Clock::time_point stored_;
};

}
