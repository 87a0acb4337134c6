#include "io/json_document.h"
#include "io/run_file.h"
#include "io/run_parameters.h"
#include "io/run_schema.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace sigmaflow::io {
namespace {

/// Length of a dataset with one dimension; all its values are in the file.
hsize_t rows_of(const Hdf5Group& group, const std::string& name)
{
    const Shape shape = dataset_shape(group, name);
    if (shape.size() != 1)
        throw Error(ErrorKind::input, group.where(name),
                    "must have one dimension, got " + std::to_string(shape.size()));
    return checked_size(group, name, shape);
}

Shape joined(std::initializer_list<hsize_t> front, const Shape& back)
{
    Shape shape(front);
    shape.insert(shape.end(), back.begin(), back.end());
    return shape;
}

template <class T>
std::vector<T> element_values(const Hdf5Group& parent, const std::string& name, const Shape& shape)
{
    return read_dataset<T>(parent.open_group(name), "value", shape);
}

std::vector<Sample> read_samples(const Hdf5Group& group, hsize_t count)
{
    std::vector<Sample> samples(count);
    for (const SampleField& field : sample_fields()) {
        const auto values = element_values<double>(group, std::string(field.name), {count});
        for (std::size_t k = 0; k < count; ++k) samples[k].*field.value = values[k];
    }
    return samples;
}

/// They are indices.
void require_pair(const Hdf5Group& group, std::size_t row, std::int64_t i, std::int64_t j,
                  std::int64_t particles)
{
    if (i < 0 || i >= j || j >= particles)
        throw Error(ErrorKind::input, group.where("j"),
                    "row " + std::to_string(row) + " must be a pair i < j < " +
                        std::to_string(particles) + ", got " + std::to_string(i) + ", " +
                        std::to_string(j));
}

/// The rows of a frame lie within the table.
void require_rows(const Hdf5Group& group, std::size_t frame, std::int64_t first, std::int64_t count,
                  std::int64_t size)
{
    if (first < 0 || count < 0 || first > size || count > size - first)
        throw Error(ErrorKind::input, group.where("count"),
                    "frame " + std::to_string(frame) + " must lie within " + std::to_string(size) +
                        " rows, got " + std::to_string(count) + " from " + std::to_string(first));
}

/// The lists of every frame.
template <class Row>
std::vector<std::vector<Row>> read_ragged(const Hdf5Group& group, hsize_t frames, int particles)
{
    const auto first = read_dataset<std::int64_t>(group, "first", {frames});
    const auto count = read_dataset<std::int64_t>(group, "count", {frames});
    std::vector<Row> all(rows_of(group, "i"));
    visit_columns(static_cast<const Row*>(nullptr), [&](auto name, auto, auto access) {
        using Value = Stored<Member<Row, decltype(access)>>;
        const Shape shape = joined({all.size()}, Value::shape());
        const auto values = read_dataset<typename Value::Number>(group, name, shape);
        const std::size_t width = all.empty() ? 0 : values.size() / all.size();
        for (std::size_t k = 0; k < all.size(); ++k)
            Value::get(values.data() + k * width, access(all[k]));
    });
    for (std::size_t k = 0; k < all.size(); ++k)
        require_pair(group, k, all[k].i, all[k].j, particles);

    std::vector<std::vector<Row>> lists(frames);
    const auto size = static_cast<std::int64_t>(all.size());
    for (std::size_t k = 0; k < frames; ++k) {
        require_rows(group, k, first[k], count[k], size);
        lists[k].assign(all.begin() + first[k], all.begin() + first[k] + count[k]);
    }
    return lists;
}

void read_particle_arrays(const Hdf5Group& trajectory, std::vector<Frame>& frames,
                          std::size_t particles)
{
    visit_particle_arrays([&](auto name, auto, auto access) {
        using Element = ArrayElement<decltype(access)>;
        using Value = Stored<Element>;
        const Shape shape = joined({frames.size(), particles}, Value::shape());
        const auto values = element_values<typename Value::Number>(trajectory, name, shape);
        if (frames.empty()) return;
        const std::size_t width = values.size() / frames.size() / particles;
        const auto* next = values.data();
        for (Frame& frame : frames) {
            access(frame).resize(particles);
            for (Element& value : access(frame)) {
                Value::get(next, value);
                next += width;
            }
        }
    });
}

void read_boxes_and_clock(const Hdf5Group& file, const Hdf5Group& trajectory,
                          std::vector<Frame>& frames)
{
    const hsize_t count = frames.size();
    const Hdf5Group box = trajectory.open_group("box");
    const auto time = read_dataset<double>(trajectory.open_group("position"), "time", {count});
    const auto edges = element_values<double>(box, "edges", {count, 3, 3});
    const auto offset = element_values<double>(box, "offset", {count});
    const auto strain = element_values<double>(file.open_group("state"), "strain", {count});
    const auto fraction = element_values<double>(
        file.open_group("observables").open_group("trajectory"), "volume_fraction", {count});
    for (std::size_t k = 0; k < count; ++k) {
        State& state = frames[k].state;
        state.box.length = Vec3(edges[9 * k], edges[9 * k + 4], edges[9 * k + 8]);
        state.box.offset = offset[k];
        state.strain = strain[k];
        state.time = time[k];
        frames[k].volume_fraction = fraction[k];
    }
}

std::vector<double> read_radii(const Hdf5Group& trajectory)
{
    const hsize_t particles = rows_of(trajectory, "radius");
    const auto radius = read_dataset<double>(trajectory, "radius", {particles});
    if (particles == 0)
        throw Error(ErrorKind::input, trajectory.where("radius"), "must have particles, got 0");
    for (const double value : radius)
        if (!(value > 0))
            throw Error(ErrorKind::input, trajectory.where("radius"),
                        "must be > 0 [a], got " + number_text(value));
    return radius;
}

std::vector<Frame> read_frames(const Hdf5Group& file)
{
    const Hdf5Group trajectory = file.open_group("particles").open_group("trajectory");
    const hsize_t count = rows_of(trajectory.open_group("position"), "time");
    const std::vector<double> radius = read_radii(trajectory);
    const hsize_t particles = radius.size();
    const auto kind = read_dataset<std::int32_t>(trajectory, "species", {particles});
    const auto samples =
        read_samples(file.open_group("observables").open_group("trajectory"), count);
    const int size = static_cast<int>(particles);
    auto springs =
        read_ragged<Contact>(file.open_group("state").open_group("contacts"), count, size);
    auto contacts = read_ragged<ContactForce>(file.open_group("contacts"), count, size);

    std::vector<Frame> frames(count);
    read_boxes_and_clock(file, trajectory, frames);
    read_particle_arrays(trajectory, frames, particles);
    for (std::size_t k = 0; k < count; ++k) {
        frames[k].sample = samples[k];
        frames[k].species.assign(kind.begin(), kind.end());
        frames[k].state.radius = radius;
        frames[k].state.contacts = std::move(springs[k]);
        frames[k].contacts = std::move(contacts[k]);
    }
    return frames;
}

Hdf5Group open_run(const std::filesystem::path& path)
{
    Hdf5Group file = Hdf5Group::open_file(path);
    const double schema = read_number(file, "sigmaflow_schema");
    if (schema != run_schema_version && schema != oldest_run_schema_version)
        throw Error(ErrorKind::input, path.string(),
                    "must have the schema " + std::to_string(oldest_run_schema_version) + " or " +
                        std::to_string(run_schema_version) + " of this sigmaflow, got " +
                        number_text(schema));
    return file;
}

hsize_t sample_count(const Hdf5Group& observables)
{
    const std::string first(sample_fields().front().name);
    return rows_of(observables.open_group(first), "time");
}

}

StoredRun read_run(const std::filesystem::path& path)
{
    const Hdf5Group file = open_run(path);
    const RunParameters parameters = read_parameters(file);
    StoredRun run;
    run.model = parameters.model;
    run.control = parameters.control;
    const Hdf5Group texts = file.open_group("provenance");
    for (const std::string& name : attribute_names(texts))
        run.provenance[name] = read_text(texts, name);
    const Hdf5Group observables = file.open_group("observables");
    run.series = read_samples(observables, sample_count(observables));
    run.frames = read_frames(file);
    return run;
}

namespace {

template <class T>
void check_values(const Hdf5Group& group, const std::string& name, const Shape& shape)
{
    read_in_parts<T>(group, name, shape, [](hsize_t, const std::vector<T>&) {});
}

void check_finite(const Hdf5Group& group, const std::string& name, const Shape& shape)
{
    read_in_parts<double>(group, name, shape, [&](hsize_t first, const std::vector<double>& part) {
        const auto wrong =
            std::find_if(part.begin(), part.end(), [](double x) { return !std::isfinite(x); });
        if (wrong != part.end())
            throw Error(ErrorKind::input, group.where(name),
                        "must be finite, got " + number_text(*wrong) + " from row " +
                            std::to_string(first) + " on");
    });
}

void check_samples(const Hdf5Group& group, hsize_t count)
{
    for (const SampleField& field : sample_fields())
        check_values<double>(group.open_group(std::string(field.name)), "value", {count});
}

/// The table of Row and which of its rows belong to which frame.
template <class Row>
void check_ragged(const Hdf5Group& group, hsize_t frames, std::size_t particles)
{
    const hsize_t rows = rows_of(group, "i");
    const auto first = read_dataset<std::int64_t>(group, "first", {frames});
    const auto count = read_dataset<std::int64_t>(group, "count", {frames});
    for (std::size_t k = 0; k < frames; ++k)
        require_rows(group, k, first[k], count[k], static_cast<std::int64_t>(rows));
    visit_columns(static_cast<const Row*>(nullptr), [&](auto name, auto, auto access) {
        using Value = Stored<Member<Row, decltype(access)>>;
        check_values<typename Value::Number>(group, name, joined({rows}, Value::shape()));
    });
    read_in_parts<std::int32_t>(group, "i", {rows}, [&](hsize_t begin, const auto& i) {
        std::vector<std::int32_t> j(i.size());
        read_rows(group, "j", native_type<std::int32_t>(), begin, {j.size()}, j.data());
        for (std::size_t k = 0; k < i.size(); ++k)
            require_pair(group, begin + k, i[k], j[k], static_cast<std::int64_t>(particles));
    });
}

void check_frames(const Hdf5Group& file, const Hdf5Group& trajectory, hsize_t count,
                  std::size_t particles)
{
    check_values<std::int32_t>(trajectory, "species", {particles});
    const Hdf5Group box = trajectory.open_group("box");
    check_finite(box.open_group("edges"), "value", {count, 3, 3});
    check_finite(box.open_group("offset"), "value", {count});
    check_finite(file.open_group("state").open_group("strain"), "value", {count});
    const Hdf5Group scalars = file.open_group("observables").open_group("trajectory");
    check_finite(scalars.open_group("volume_fraction"), "value", {count});
    check_samples(scalars, count);
    visit_particle_arrays([&](auto name, auto, auto access) {
        using Value = Stored<ArrayElement<decltype(access)>>;
        const Shape shape = joined({count, particles}, Value::shape());
        const Hdf5Group element = trajectory.open_group(name);
        if (std::string(name) == "position")
            check_finite(element, "value", shape);
        else
            check_values<typename Value::Number>(element, "value", shape);
    });
    check_ragged<Contact>(file.open_group("state").open_group("contacts"), count, particles);
    check_ragged<ContactForce>(file.open_group("contacts"), count, particles);
}

}

RunSummary check_run(const std::filesystem::path& path)
{
    const Hdf5Group file = open_run(path);
    RunSummary summary;
    summary.control = read_parameters(file).control;
    const Hdf5Group texts = file.open_group("provenance");
    for (const std::string& name : attribute_names(texts)) read_text(texts, name);
    const Hdf5Group observables = file.open_group("observables");
    const Hdf5Group trajectory = file.open_group("particles").open_group("trajectory");
    summary.samples = sample_count(observables);
    check_samples(observables, summary.samples);
    summary.frames = rows_of(trajectory.open_group("position"), "time");
    check_values<double>(trajectory.open_group("position"), "time", {summary.frames});
    const std::vector<double> radius = read_radii(trajectory);
    summary.particles = radius.size();
    summary.largest_radius = *std::max_element(radius.begin(), radius.end());
    check_frames(file, trajectory, summary.frames, summary.particles);
    if (summary.frames == 0) return summary;
    const auto edges =
        element_values<double>(trajectory.open_group("box"), "edges", {summary.frames, 3, 3});
    summary.narrowest_box = std::min({edges[0], edges[4], edges[8]});
    const Shape frames{summary.frames};
    summary.strain = element_values<double>(file.open_group("state"), "strain", frames).back();
    summary.volume_fraction =
        element_values<double>(observables.open_group("trajectory"), "volume_fraction", frames)
            .front();
    return summary;
}

}
