#include "workflows/checkpoint.h"

#include "engine/archive.h"
#include "io/atomic_file.h"
#include "io/sealed_file.h"
#include "workflows/manifest.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sigmaflow::workflows {

namespace {

constexpr io::Seal seal{"checkpoint", 1};
constexpr double largest_share = 0.01;  // of the run time that checkpoints may take

std::filesystem::path path_of(const RunFolder& folder, std::uint64_t generation)
{
    return folder.own_file("checkpoint." + std::to_string(generation % 2));
}

}

std::string rounded_text(double strain)
{
    return io::number_text(std::round(strain * 1e4) / 1e4);
}

const io::Mark& Checkpoint::mark(const std::string& name) const
{
    for (const FileMark& file : files)
        if (file.name == name) return file.mark;
    throw Error(ErrorKind::input, name, "is not in the checkpoint");
}

Checkpoint parse_checkpoint(std::string_view content, const std::string& file)
{
    const std::string bytes = io::unsealed(content, seal, file);
    Checkpoint result;
    try {
        ArchiveReader a(bytes);
        a(result);
        a.finish();
        if (!std::isfinite(result.strain)) ArchiveReader::refuse("has a strain that is not finite");
    } catch (const Error& error) {
        throw error.within(file);
    }
    return result;
}

Checkpoint read_checkpoint(const std::filesystem::path& path)
{
    return parse_checkpoint(io::sealed_content(path), path.string());
}

std::optional<Checkpoint> newest_checkpoint(const RunFolder& folder,
                                            const std::set<std::string>& finished,
                                            std::vector<std::string>& warnings)
{
    std::optional<Checkpoint> newest;
    std::vector<std::string> problems;
    for (const std::uint64_t slot : {0, 1}) {
        const std::filesystem::path path = path_of(folder, slot);
        std::error_code ignored;
        if (!std::filesystem::exists(path, ignored)) continue;
        try {
            Checkpoint one = read_checkpoint(path);
            if (finished.contains(one.step.key)) continue;
            for (const FileMark& file : one.files) io::verify(folder.path() / file.name, file.mark);
            if (!newest || one.generation > newest->generation) newest = std::move(one);
        } catch (const Error& error) {
            problems.push_back(error.what());
        }
    }
    if (!newest && !problems.empty())
        throw Error(
            ErrorKind::missing, folder.path().string(),
            "no checkpoint can be used (" + problems.front() + "); --force begins the step anew");
    for (const std::string& problem : problems)
        warnings.push_back(problem + "; the checkpoint of " + newest->written + " is used");
    return newest;
}

std::vector<std::string> stored_steps(const RunFolder& folder)
{
    std::vector<std::string> names;
    for (const std::uint64_t slot : {0, 1}) {
        try {
            names.push_back(read_checkpoint(path_of(folder, slot)).step.name);
        } catch (const Error&) {  // none, or damaged
        }
    }
    return names;
}

void remove_checkpoints(const RunFolder& folder)
{
    std::error_code ignored;
    for (const std::uint64_t slot : {0, 1}) std::filesystem::remove(path_of(folder, slot), ignored);
}

void Keeper::begin(const StepIdentity& step, std::optional<Checkpoint> saved)
{
    step_ = step;
    saved_ = std::move(saved);
    generation_ = saved_ ? saved_->generation : 0;
    stored_ = Clock::now();
}

bool Keeper::due() const
{
    const std::chrono::duration<double> passed = Clock::now() - stored_;
    const double interval = interval_ > 0 ? std::max(interval_, cost_ / largest_share) : 0;
    return passed.count() >= interval || interruption_.asked(cost_);
}

void Keeper::keep(double strain, std::vector<FileMark> files, std::string run)
{
    const Clock::time_point begin = Clock::now();
    saved_.reset();  // no longer needed, and it may be large
    const Checkpoint checkpoint{.generation = ++generation_,
                                .written = utc_now(),
                                .arithmetic = arithmetic(),
                                .step = step_,
                                .strain = strain,
                                .files = std::move(files),
                                .run = std::move(run)};
    ArchiveWriter a;
    a(checkpoint);
    io::write_sealed(path_of(folder_, generation_), seal, a.bytes());
    stored_ = Clock::now();
    cost_ = std::chrono::duration<double>(stored_ - begin).count();
    if (const auto reason = interruption_.asked(cost_))
        throw Error(ErrorKind::interrupted, step_.name,
                    *reason + "; stored at strain " + rounded_text(strain) +
                        ", the same command goes on from there");
}

void Keeper::stop_if_asked(const std::string& next) const
{
    if (const auto reason = interruption_.asked())
        throw Error(ErrorKind::interrupted, step_.name, *reason + "; the same command " + next);
}

}
