#include "workflows/run_files.h"

#include "io/case_file.h"

#include <vtkPolyData.h>
#include <cstdio>

namespace sigmaflow::workflows {

namespace {

std::string numbered(const char* name, std::size_t number)
{
    char text[64];
    std::snprintf(text, sizeof text, "vtk/%s_%05zu.vtp", name, number);
    return text;
}

}

RunFiles::RunFiles(Context& context, const Control& control)
    : context_(context),
      folder_(context.step_name + "/"),
      run_{.name = context.step_name,
           .control = control,
           .volume_fraction = volume_fraction(context.state),
           .particles = context.state.size(),
           .file = context.folder.file(folder_ + "run.h5"),
           .series = {},
           .start_up = {},
           .jammed = false,
           .continues = context.last_run},
      csv_(context.folder.file(folder_ + "series.csv")),
      hdf5_(run_.file, context.state, context.suspension.model, control, context.provenance)
{
}

void RunFiles::append(const Sample& sample, bool on_grid)
{
    csv_.append(sample);
    hdf5_.append(sample);
    if (on_grid) run_.series.push_back(sample);
}

void RunFiles::append(const Frame& frame, bool for_paraview)
{
    hdf5_.append(frame);
    hdf5_.flush();
    if (!for_paraview) return;
    const std::string particles = numbered("particles", particles_.size());
    const std::string contacts = numbered("contacts", contacts_.size());
    const double strain = frame.state.strain;
    io::write_vtp(context_.folder.file(folder_ + particles), io::particles_polydata(frame));
    io::write_vtp(context_.folder.file(folder_ + contacts), io::contacts_polydata(frame));
    particles_.push_back({strain, particles});
    contacts_.push_back({strain, contacts});
    // rewritten with every frame, so that ParaView can follow a run and survives its end
    io::write_pvd(context_.folder.file(folder_ + "particles.pvd"), particles_);
    io::write_pvd(context_.folder.file(folder_ + "contacts.pvd"), contacts_);
}

Run& RunFiles::finish()
{
    csv_.finish();
    hdf5_.finish();
    io::write_case(context_.folder.file(folder_ + "state.json"), context_.state,
                   context_.suspension.model, run_.control);
    context_.last_run = run_.name;
    return context_.runs.emplace_back(std::move(run_));
}

}
