// Writes a run of 4 frames as run.h5, series.csv and ParaView series into a folder, for the readers
// in Python: read_with_h5py.py and open_in_paraview.py. All numbers follow simple formulas, which
// the readers know, too.
#include "io/particles_vtp.h"
#include "io/run_file.h"
#include "io/series_csv.h"

#include <vtkPolyData.h>
#include <filesystem>
#include <iostream>

namespace {

using namespace sigmaflow;

constexpr int particles = 6;
constexpr int frames = 4;

Sample example_sample(int step)
{
    Sample sample;
    double value = step / 7.0;
    for (const SampleField& field : sample_fields()) sample.*field.value = value += 0.1;
    sample.strain = 0.25 * step;
    sample.time = step / 3.0;
    return sample;
}

Frame example_frame(int step)
{
    Frame frame;
    State& state = frame.state;
    state.box = {Vec3(20, 10, 5), 2.5 * step};
    state.strain = 0.25 * step;
    state.time = step / 3.0;
    for (int i = 0; i < particles; ++i) {
        state.position.emplace_back(3 * i + 0.1 * step, i + 0.5, 2.5);
        state.radius.push_back(i % 2 == 0 ? 1 : 1.4);
        const Vec3 nonaffine(0.01 * i * step, -0.02 * i, 0.5);
        frame.nonaffine_velocity.push_back(nonaffine);
        frame.velocity.push_back(nonaffine + Vec3(state.position.back().y(), 0, 0));
        frame.angular_velocity.emplace_back(0, 0, -0.5 - i);
        frame.nonaffine_speed.push_back(nonaffine.norm());
        frame.contact_number.push_back(i % 3);
        Mat3 stress;
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column) stress(row, column) = 10 * row + column + i;
        frame.particle_stress.push_back(stress);
    }
    frame.species = species(state);
    frame.volume_fraction = 0.3;
    frame.sample = example_sample(step);
    for (int k = 0; k < step; ++k) {  // frame k has k contacts
        state.contacts.push_back({k, k + 1, Vec3(k, step, 0.1), Vec3(0, k, 0.3), k % 2 == 1});
        frame.contacts.push_back({k, k + 1, state.position[static_cast<std::size_t>(k)],
                                  state.position[static_cast<std::size_t>(k + 1)], -0.01 * k,
                                  1.5 * k + step, Vec3(3, 0, 4), k % 2 == 1, true});
    }
    return frame;
}

void write_example(const std::filesystem::path& folder)
{
    std::filesystem::create_directories(folder);
    io::RunWriter run(folder / "run.h5", example_frame(0).state, {}, ImposedStress{2},
                      {{"version", "example"}, {"seed", "42"}});
    io::SeriesWriter series(folder / "series.csv");
    std::vector<io::SeriesEntry> particle_files, contact_files;
    for (int step = 0; step < 300; ++step) {
        run.append(example_sample(step));
        series.append(example_sample(step));
        if (step >= frames) continue;
        const Frame frame = example_frame(step);
        const std::string number = std::to_string(step) + ".vtp";
        run.append(frame);
        io::write_vtp(folder / ("particles_" + number), io::particles_polydata(frame));
        io::write_vtp(folder / ("contacts_" + number), io::contacts_polydata(frame));
        particle_files.push_back({frame.state.strain, "particles_" + number});
        contact_files.push_back({frame.state.strain, "contacts_" + number});
    }
    io::write_vtp(folder / "box.vtp", io::box_polydata(example_frame(0).state.box));
    io::write_pvd(folder / "particles.pvd", particle_files);
    io::write_pvd(folder / "contacts.pvd", contact_files);
    series.finish();
    run.finish();
}

}

int main(int count, char** arguments)
{
    if (count != 2) {
        std::cerr << "usage: write_example_run FOLDER\n";
        return 64;
    }
    try {
        write_example(arguments[1]);
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
