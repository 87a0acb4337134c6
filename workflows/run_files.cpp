#include "workflows/run_files.h"

#include "io/case_file.h"
#include "io/paraview_view.h"

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

/// A file to append to: as it was at the checkpoint, or new.
template <class File>
File growing(const Context& context, const std::string& name)
{
    const std::filesystem::path path = context.folder.path() / name;
    if (const Checkpoint* saved = context.keeper.saved()) return File(path, saved->mark(name));
    return File(path);
}

/// The folder of the step, without what an earlier attempt has left.
std::string cleared(Context& context)
{
    context.folder.remove(context.step_name + "/" + failure_name);
    if (!context.keeper.saved()) context.folder.remove_leftovers(context.step_name);
    context.folder.file(context.step_name + "/" + series_name);
    return context.step_name + "/";
}

}

RunFiles::RunFiles(Context& context, const Model& model, const Control& control, bool for_paraview)
    : context_(context),
      model_(model),
      folder_(cleared(context)),
      for_paraview_(for_paraview),
      run_{.name = context.step_name,
           .control = control,
           .volume_fraction = volume_fraction(context.state),
           .particles = context.state.size(),
           .file = context.folder.path() / (folder_ + run_name),
           .series = {},
           .start_up = {},
           .jammed = false,
           .continues = context.last_run},
      csv_(growing<io::SeriesWriter>(context, folder_ + series_name)),
      journal_(growing<io::RunJournal>(context, folder_ + journal_name))
{
    if (context.keeper.saved())
        io::read_journal(journal_path(),
                         {[&](const Sample& sample, bool on_grid) { note(sample, on_grid); },
                          [&](const Frame& frame) { note(frame); }});
}

std::filesystem::path RunFiles::journal_path() const
{
    return context_.folder.path() / (folder_ + journal_name);
}

void RunFiles::note(const Sample& sample, bool on_grid)
{
    last_sample_ = sample;
    if (on_grid) run_.series.push_back(sample);
}

void RunFiles::note(const Frame& frame)
{
    if (!for_paraview_) return;
    for (auto* list : {&particles_, &contacts_}) {
        const char* name = list == &particles_ ? "particles" : "contacts";
        list->push_back({frame.state.strain, numbered(name, list->size())});
        context_.folder.file(folder_ + list->back().file);
        context_.folder.file(folder_ + name + ".pvd");
    }
    context_.folder.file(folder_ + io::view_script_name);
}

void RunFiles::append(const Sample& sample, bool on_grid)
{
    csv_.append(sample);
    journal_.append(sample, on_grid);
    note(sample, on_grid);
}

void RunFiles::append(const Frame& frame)
{
    journal_.append(frame);
    note(frame);
    if (!for_paraview_) return;
    io::write_vtp(context_.folder.file(folder_ + particles_.back().file),
                  io::particles_polydata(frame));
    io::write_vtp(context_.folder.file(folder_ + contacts_.back().file),
                  io::contacts_polydata(frame));
    if (particles_.size() == 1)
        io::write_file(context_.folder.file(folder_ + io::view_script_name), io::view_script());
    // rewritten with every frame, so that ParaView can follow a run and survives its end
    io::write_pvd(context_.folder.file(folder_ + "particles.pvd"), particles_);
    io::write_pvd(context_.folder.file(folder_ + "contacts.pvd"), contacts_);
}

std::vector<FileMark> RunFiles::marks()
{
    return {{folder_ + series_name, csv_.mark()}, {folder_ + journal_name, journal_.mark()}};
}

std::filesystem::path RunFiles::write_failure(const State& state)
{
    const std::filesystem::path path = context_.folder.path() / (folder_ + failure_name);
    io::write_case(path, state, model_, run_.control);
    return path;
}

void RunFiles::write_hdf5()
{
    io::RunWriter hdf5(context_.folder.file(folder_ + run_name), context_.state, model_,
                       run_.control, context_.provenance);
    io::read_journal(journal_path(), {[&](const Sample& sample, bool) { hdf5.append(sample); },
                                      [&](const Frame& frame) { hdf5.append(frame); }});
    hdf5.finish();
}

Run& RunFiles::finish()
{
    csv_.finish();
    journal_.finish();
    write_hdf5();
    io::write_case(context_.folder.file(folder_ + state_name), context_.state, model_,
                   run_.control);
    context_.last_run = run_.name;
    return context_.runs.emplace_back(std::move(run_));
}

}
