#include "io/run_file.h"

#include "io/atomic_file.h"
#include "io/run_parameters.h"
#include "io/run_schema.h"

#include <optional>
#include <utility>

namespace sigmaflow::io {
namespace {

constexpr std::size_t most_waiting_samples = 256;  // written together

/// Numbers the recorded instants, so that equal steps are equal times in all of the file.
class Instants {
public:
    std::int64_t at(double time)
    {
        if (step_ < 0 || time != last_) ++step_;
        last_ = time;
        return step_;
    }

private:
    std::int64_t step_ = -1;
    double last_ = 0;
};

/// Step and time of H5MD elements that are sampled together: stored once, linked into every
/// element.
class Clock {
public:
    Clock(const Hdf5Group& parent, const std::string& first_element)
        : home_(parent.create_group(first_element)),
          step_(grow<std::int64_t>(home_, "step", {}, "")),
          time_(grow<double>(home_, "time", {}, "1/rate0"))
    {
    }

    /// The values of a new element; those of the first element belong into the home of the clock.
    template <class T>
    GrowingDataset element(const Hdf5Group& parent, const std::string& name, const Shape& shape,
                           const std::string& unit) const
    {
        if (parent.where(name) == home_.where()) return grow<T>(home_, "value", shape, unit);
        const Hdf5Group group = parent.create_group(name);
        group.link("step", home_, "step");
        group.link("time", home_, "time");
        return grow<T>(group, "value", shape, unit);
    }

    void tick(std::int64_t step, double time)
    {
        step_.append(std::vector<std::int64_t>{step});
        time_.append(std::vector<double>{time});
    }

private:
    Hdf5Group home_;
    GrowingDataset step_, time_;
};

/// The scalars of samples, one element each.
class SampleTable {
public:
    SampleTable(const Hdf5Group& parent, const Clock& clock)
    {
        for (const SampleField& field : sample_fields())
            columns_.push_back(clock.element<double>(parent, std::string(field.name), {},
                                                     std::string(field.unit)));
    }

    void append(const std::vector<Sample>& samples)
    {
        auto next = columns_.begin();
        for (const SampleField& field : sample_fields()) {
            std::vector<double> values;
            for (const Sample& sample : samples) values.push_back(sample.*field.value);
            (next++)->append(values);
        }
    }

private:
    std::vector<GrowingDataset> columns_;
};

/// Lists of a different length in every frame: the rows first[k] ... first[k] + count[k] - 1 belong
/// to frame k.
template <class Row>
class RaggedTable {
public:
    explicit RaggedTable(const Hdf5Group& group)
        : first_(grow<std::int64_t>(group, "first", {}, "")),
          count_(grow<std::int64_t>(group, "count", {}, ""))
    {
        visit_columns(static_cast<const Row*>(nullptr), [&](auto name, auto unit, auto access) {
            using Value = Stored<Member<Row, decltype(access)>>;
            columns_.push_back(grow<typename Value::Number>(group, name, Value::shape(), unit));
        });
    }

    void append(const std::vector<Row>& rows)
    {
        first_.append(std::vector<std::int64_t>{rows_});
        count_.append(std::vector<std::int64_t>{static_cast<std::int64_t>(rows.size())});
        rows_ += static_cast<std::int64_t>(rows.size());
        auto next = columns_.begin();
        visit_columns(static_cast<const Row*>(nullptr), [&](auto, auto, auto access) {
            using Value = Stored<Member<Row, decltype(access)>>;
            std::vector<typename Value::Number> values;
            for (const Row& row : rows) Value::put(access(row), values);
            (next++)->append(values);
        });
    }

private:
    GrowingDataset first_, count_;
    std::vector<GrowingDataset> columns_;
    std::int64_t rows_ = 0;
};

/// The edge vectors of the box as rows; the second one carries the Lees-Edwards offset.
std::vector<double> box_edges(const Box& box)
{
    return {box.length.x(), 0, 0, box.offset, box.length.y(), 0, 0, 0, box.length.z()};
}

/// Everything that is stored per frame.
class FrameTables {
public:
    FrameTables(const Hdf5Group& file, const Hdf5Group& trajectory, const Hdf5Group& observables,
                const State& first)
        : particles_(static_cast<std::size_t>(first.size())),
          clock_(trajectory, "position"),
          samples_(observables, clock_),
          springs_(file.create_group("state").create_group("contacts")),
          contacts_(file.create_group("contacts"))
    {
        const Hdf5Group box = trajectory.create_group("box"), state = file.open_group("state");
        write_number<std::int32_t>(box, "dimension", 3);
        write_words(box, "boundary", {"periodic", "periodic", "periodic"});
        scalars_.push_back(clock_.element<double>(box, "edges", {3, 3}, "a"));
        scalars_.push_back(clock_.element<double>(box, "offset", {}, "a"));
        scalars_.push_back(clock_.element<double>(state, "strain", {}, "-"));
        scalars_.push_back(clock_.element<double>(observables, "volume_fraction", {}, "-"));
        visit_particle_arrays([&](auto name, auto unit, auto access) {
            using Value = Stored<ArrayElement<decltype(access)>>;
            Shape shape = Value::shape();
            shape.insert(shape.begin(), particles_);
            arrays_.push_back(
                clock_.element<typename Value::Number>(trajectory, name, shape, unit));
        });
    }

    void append(const Frame& frame, std::int64_t step)
    {
        const State& state = frame.state;
        scalars_[0].append(box_edges(state.box));
        scalars_[1].append(std::vector<double>{state.box.offset});
        scalars_[2].append(std::vector<double>{state.strain});
        scalars_[3].append(std::vector<double>{frame.volume_fraction});
        auto next = arrays_.begin();
        visit_particle_arrays([&](auto name, auto, auto access) {
            const auto& list = access(frame);
            if (list.size() != particles_)
                throw Error(ErrorKind::internal, name,
                            "must have " + std::to_string(particles_) + " entries, got " +
                                std::to_string(list.size()));
            using Value = Stored<ArrayElement<decltype(access)>>;
            std::vector<typename Value::Number> values;
            for (const auto& value : list) Value::put(value, values);
            (next++)->append(values);
        });
        samples_.append({frame.sample});
        springs_.append(state.contacts);
        contacts_.append(frame.contacts);
        clock_.tick(step, state.time);
    }

private:
    std::size_t particles_;
    Clock clock_;
    SampleTable samples_;
    RaggedTable<Contact> springs_;
    RaggedTable<ContactForce> contacts_;
    std::vector<GrowingDataset> scalars_, arrays_;
};

void write_h5md(const Hdf5Group& file, const Provenance& provenance)
{
    write_number<std::int32_t>(file, "sigmaflow_schema", run_schema_version);
    const Hdf5Group h5md = file.create_group("h5md");
    write_numbers<std::int32_t>(h5md, "version", {1, 1});
    const auto author = provenance.find("author");
    write_text(h5md.create_group("author"), "name",
               author == provenance.end() ? "unknown" : author->second);
    const Hdf5Group creator = h5md.create_group("creator");
    write_text(creator, "name", "sigmaflow");
    write_text(creator, "version", SIGMAFLOW_VERSION);
}

}

struct RunWriter::Impl {
    std::filesystem::path path, part;
    Hdf5Group file;
    std::vector<double> radius;
    Instants instants = {};
    std::vector<Sample> waiting = {};
    std::vector<std::int64_t> waiting_steps = {};
    // All datasets; gone when the file is closed.
    struct Tables {
        Clock clock;
        SampleTable series;
        FrameTables frames;
    };
    std::optional<Tables> tables = {};

    void write_waiting()
    {
        tables->series.append(waiting);
        for (std::size_t k = 0; k < waiting.size(); ++k)
            tables->clock.tick(waiting_steps[k], waiting[k].time);
        waiting.clear();
        waiting_steps.clear();
    }
};

RunWriter::RunWriter(const std::filesystem::path& path, const State& first, const Model& model,
                     const Control& control, const Provenance& provenance)
{
    if (first.size() == 0)
        throw Error(ErrorKind::input, path.string(), "needs at least one particle, got 0");
    std::filesystem::path part = path;
    part += ".part";
    const Hdf5Group& file = (impl_ = std::make_unique<Impl>(
                                 Impl{path, part, Hdf5Group::create_file(part), first.radius}))
                                ->file;
    write_h5md(file, provenance);
    write_parameters(file, {model, control});
    const Hdf5Group texts = file.create_group("provenance");
    for (const auto& [name, text] : provenance) write_text(texts, name, text);

    const Hdf5Group trajectory = file.create_group("particles").create_group("trajectory");
    const std::vector<int> kind = species(first);
    write_dataset(trajectory, "radius", first.radius, "a");
    write_dataset(trajectory, "species", std::vector<std::int32_t>(kind.begin(), kind.end()), "");
    const Hdf5Group observables = file.create_group("observables");
    const Hdf5Group of_frames = observables.create_group("trajectory");
    Clock clock(observables, std::string(sample_fields().front().name));
    SampleTable series(observables, clock);
    impl_->tables.emplace(Impl::Tables{std::move(clock), std::move(series),
                                       FrameTables(file, trajectory, of_frames, first)});
    flush();
}

RunWriter::~RunWriter() = default;
RunWriter::RunWriter(RunWriter&&) noexcept = default;

void RunWriter::append(const Sample& sample)
{
    impl_->waiting.push_back(sample);
    impl_->waiting_steps.push_back(impl_->instants.at(sample.time));
    if (impl_->waiting.size() >= most_waiting_samples) impl_->write_waiting();
}

void RunWriter::append(const Frame& frame)
{
    if (frame.state.radius != impl_->radius)
        throw Error(ErrorKind::internal, impl_->path.string(),
                    "the radii must not change in a run");
    impl_->tables->frames.append(frame, impl_->instants.at(frame.state.time));
}

void RunWriter::flush()
{
    impl_->write_waiting();
    impl_->file.flush();
}

void RunWriter::finish()
{
    flush();
    impl_->tables.reset();
    impl_->file.close();
    commit_file(impl_->part, impl_->path);
}

}
