// What the doctor tries.
#include "engine/evaluation.h"
#include "engine/packing.h"
#include "io/atomic_file.h"
#include "io/guarded.h"
#include "io/json_document.h"
#include "io/particles_vtp.h"
#include "io/run_file.h"
#include "render/fonts.h"
#include "render/particles.h"
#include "workflows/doctor.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/vfs.h>
#include <unistd.h>
#include <vtkPolyData.h>
#include <cerrno>
#include <clocale>
#include <cstring>
#include <functional>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;
using Level = Finding::Level;

namespace {

/// The text that the check returns, or a failure with its mend: what the Error says, if it says
/// more than the mend.
Finding tried(const std::string& name, ErrorKind kind, const std::string& mend,
              const std::function<std::string()>& check)
{
    const io::GuardLimits limits{
        .memory = std::size_t{8} << 30, .cpu_seconds = 4, .wall_seconds = 4};
    try {
        return {name, Level::ok, io::guarded(name, limits, check), "", kind};
    } catch (const Error& error) {
        const bool ours = error.kind() == ErrorKind::no_space || error.kind() == ErrorKind::file;
        return {name, Level::fail, error.what(), mend, ours ? error.kind() : kind};
    }
}

[[noreturn]] void differs(const std::string& what)
{
    throw Error(ErrorKind::input, "", what + " is read back as something else");
}

Frame small_frame()
{
    PackingParameters parameters;
    parameters.particles = 30;
    parameters.volume_fraction = 0.3;
    const State state = random_packing(parameters);
    Workspace workspace;
    return make_frame(state, evaluate_in_detail(state, Model(), ImposedStress{1}, workspace));
}

/// A file of the check, removed whatever happens.
struct Scrap {
    fs::path path;
    explicit Scrap(const fs::path& folder, const std::string& ending)
        : path(folder / (".sigmaflow-doctor-" + std::to_string(::getpid()) + ending))
    {
    }
    ~Scrap()
    {
        std::error_code ignored;
        for (const char* ending : {"", ".part", ".tmp"})
            fs::remove(path.string() + ending, ignored);
    }
};

std::string drawn_pixel()
{
    render::ParticleView view;
    view.width = view.height = 64;
    view.colour_bar = view.triad = view.outline = view.ambient_occlusion = false;
    const Frame frame = small_frame();
    const Vec3& box = frame.state.box.length;
    view.box_length = {box.x(), box.y(), box.z()};
    const auto particles = io::particles_polydata(frame);
    const render::Image image = render::render_particles(particles, view);
    for (int k = 0; k < image.width * image.height; ++k)
        if (std::memcmp(image.rgb.data() + 3 * k, image.rgb.data(), 3) != 0)
            return "spheres are drawn off-screen and read back";
    throw Error(ErrorKind::rendering, "", "the picture of a suspension is blank");
}

bool is_network(const fs::path& folder, std::string& name)
{
    struct statfs status {};
    if (::statfs(folder.c_str(), &status) != 0) return false;
    const struct {
        unsigned long magic;
        const char* name;
    } known[] = {{0x6969, "NFS"},        {0xff534d42, "CIFS"}, {0xfe534d42, "SMB"},
                 {0x0bd00bd3, "Lustre"}, {0x47504653, "GPFS"}, {0x19830326, "BeeGFS"},
                 {0x65735546, "FUSE"}};
    for (const auto& one : known)
        if (static_cast<unsigned long>(status.f_type) == one.magic) {
            name = one.name;
            return true;
        }
    return false;
}

}

Finding examine_pictures()
{
    return tried("pictures", ErrorKind::rendering,
                 "apt-get install libegl1 libgl1-mesa-dri; everything else works without",
                 [] { return drawn_pixel(); });
}

Finding examine_fonts()
{
    return tried("fonts", ErrorKind::rendering,
                 "apt-get install fonts-dejavu-core fonts-dejavu-extra", [] {
                     const render::Fonts fonts;
                     for (const render::Face face : {render::Face::upright, render::Face::italic})
                         if (fonts.outline("σ", face).contours.empty())
                             throw Error(ErrorKind::rendering, "", "a Greek letter has no outline");
                     return "DejaVu, upright and italic";
                 });
}

Finding examine_hdf5(const fs::path& folder)
{
    return tried("hdf5", ErrorKind::file, "apt-get install --reinstall libhdf5-103-1", [&] {
        const Scrap scrap(folder, ".h5");
        const Frame frame = small_frame();
        io::RunWriter writer(scrap.path, frame.state, Model(), ImposedStress{1}, {});
        writer.append(frame.sample);
        writer.append(frame);
        writer.finish();
        const io::StoredRun stored = io::read_run(scrap.path);
        if (stored.frames.size() != 1 || stored.frames[0].state.position != frame.state.position)
            differs("a frame");
        return "a frame is written and read back, bit by bit";
    });
}

Finding examine_vtk(const fs::path& folder)
{
    return tried("vtk", ErrorKind::file, "apt-get install --reinstall libvtk9.1", [&] {
        const Scrap scrap(folder, ".vtp");
        const Frame frame = small_frame();
        io::write_vtp(scrap.path, io::particles_polydata(frame));
        const auto stored = io::read_vtp(scrap.path);
        if (stored->GetNumberOfPoints() != frame.state.size()) differs("a file");
        for (int i = 0; i < frame.state.size(); ++i)
            for (int axis = 0; axis < 3; ++axis)
                if (stored->GetPoint(i)[axis] != frame.state.position[i][axis])
                    differs("a position");
        return "particles are written and read back, bit by bit";
    });
}

Finding examine_folder(const fs::path& folder)
{
    constexpr double little = 1e9;  // bytes
    Finding found =
        tried("folder", ErrorKind::file,
              "give a folder that you can write to: sigmaflow doctor DIR, and run --out "
              "DIR; if the disk is full, free some of it",
              [&] {
                  const Scrap scrap(folder, ".txt");
                  const std::string text(20000, 'x');
                  io::write_file(scrap.path, text);  // with fsync and rename
                  if (io::read_file(scrap.path) != text) differs("a file");
                  return folder.string() + ": written, synced, renamed and read back";
              });
    std::error_code error;
    const fs::space_info space = fs::space(folder, error);
    if (error || found.level == Level::fail) return found;
    found.text += ", " + std::to_string(space.available / 1'000'000) + " MB left";
    if (static_cast<double>(space.available) < little) {
        found.level = Level::warn;
        found.mend = "free some of the disk: a run of 500 particles needs some 100 MB";
    }
    return found;
}

Finding examine_lock(const fs::path& folder)
{
    Finding found = tried(
        "lock", ErrorKind::file,
        "use a folder on a local disk, or have the network file system mounted with locks", [&] {
            const int first = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
            const int second = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
            if (first < 0 || second < 0)
                throw Error(ErrorKind::file, "",
                            std::string("cannot be opened: ") + std::strerror(errno));
            if (::flock(first, LOCK_EX | LOCK_NB) != 0)
                return std::string(errno == EWOULDBLOCK
                                       ? "held by a run that writes here"
                                       : throw Error(ErrorKind::file, "", std::strerror(errno)));
            if (::flock(second, LOCK_EX | LOCK_NB) == 0)
                throw Error(ErrorKind::file, "", "two locks on one folder at the same time");
            return std::string("a second writer is kept out");
        });
    std::string network;
    if (found.level == Level::ok && is_network(folder, network)) {
        found.level = Level::warn;
        found.text += "; " + network + ": perhaps not one on another machine";
        found.mend = "start a folder's runs from one machine only";
    }
    return found;
}

Finding examine_locale()
{
    const char* const mend =
        "export LC_ALL=C.UTF-8, or install the locale: apt-get install locales";
    Finding found = tried("locale", ErrorKind::input, mend, [] {
        // other programs' libraries may set it: numbers must not depend on it
        const bool known = std::setlocale(LC_ALL, "") != nullptr;
        const std::string text = io::number_text(0.5);
        const auto document = io::JsonDocument::parse("[0.5]", "[0.5]");
        const double back = document.root().element(0).number();
        if (text != "0.5" || back != 0.5) differs("0.5, written as " + text + ",");
        if (!known) return std::string("?");
        return std::string("numbers keep their point (here: \"") +
               std::localeconv()->decimal_point + "\")";
    });
    if (found.text == "?") {
        found.level = Level::warn;
        found.text =
            "the locale of LANG or LC_ALL is not installed; C is used, numbers keep their "
            "point";
        found.mend = mend;
    }
    return found;
}

}
