// Step "contacts": who touches whom, how many contacts slide, where they point and what they carry.
#include "engine/contact_network.h"
#include "io/atomic_file.h"
#include "workflows/pictures.h"
#include "workflows/steps.h"
#include "workflows/stored_frames.h"

#include <array>
#include <limits>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<std::pair<const char*, ContactSet>, 3> contact_sets{
    {{"all", ContactSet::all},
     {"frictional", ContactSet::frictional},
     {"sliding", ContactSet::sliding}}};

std::string frames_csv(const std::vector<Frame>& frames, const std::vector<ContactNetwork>& list)
{
    std::string text = "# one frame a row";
    for (const NetworkField& field : network_fields())
        text.append("; ").append(field.name).append(": ").append(field.meaning);
    text += "; forces in F*\nstrain";
    for (const NetworkField& field : network_fields()) text.append(",").append(field.name);
    for (std::size_t k = 0; k < frames.size(); ++k) {
        text += "\n" + io::number_text(frames[k].state.strain);
        for (const NetworkField& field : network_fields())
            text += "," + io::number_text(list[k].*field.value);
    }
    return text + "\n";
}

std::string shares_csv(const ContactShares& shares)
{
    std::string text =
        "# share of the particles with so many contacts\ncontacts,share,standard_error";
    for (std::size_t z = 0; z < shares.share.size(); ++z)
        text += "\n" + std::to_string(z) + cells(shares.share[z]);
    return text + "\n";
}

std::string forces_csv(const Histogram& normal, const Histogram& tangential)
{
    std::string text =
        "# probability densities of normal and tangential forces (these of frictional contacts), "
        "each over its own mean; force: centre of the bin [mean force]\n"
        "force,normal,normal_error,tangential,tangential_error";
    for (std::size_t k = 0; k < normal.density.size(); ++k) {
        text += "\n" + io::number_text(normal.centre(k)) +
                cells(normal.density[k], normal.standard_error[k]);
        text += tangential.frames > 0 ? cells(tangential.density[k], tangential.standard_error[k])
                                      : ",,";
    }
    return text + "\n";
}

/// Empty bins have no place on a logarithmic axis.
render::Series drawn(const Histogram& histogram, const std::string& label, render::Marker marker)
{
    render::Series series;
    series.label = label;
    series.marker = marker;
    series.line_width = 1.5;
    for (std::size_t k = 0; k < histogram.density.size(); ++k) {
        const double density = histogram.density[k], error = histogram.standard_error[k];
        series.x.push_back(histogram.centre(k));
        series.y.push_back(density > 0 ? density : nan);
        series.y_error.push_back(error < density ? error : nan);
    }
    return series;
}

Json fabric_json(const std::vector<Mat3>& tensors)
{
    Mat3 mean = Mat3::Zero();
    for (const Mat3& f : tensors) mean += f / static_cast<double>(tensors.size());
    Json tensor;
    for (int row = 0; row < 3; ++row) tensor.push_back({mean(row, 0), mean(row, 1), mean(row, 2)});
    const PlaneAnisotropy plane = plane_anisotropy(tensors);
    return {{"tensor", tensor},
            {"anisotropy", estimate_json(plane.anisotropy, "-")},
            {"angle", estimate_json(plane.angle, "degrees")}};
}

struct Contacts {
    FrameChoice choice;
    int rattler_contacts = 0;
    double close_gap = 0.1, force_bin = 0.2;
    PictureSize size;

    void describe(io::Fields& f)
    {
        choice.describe(f);
        f("rattler_contacts", rattler_contacts, io::Integers{0, 12}, "-",
          "particles with fewer contacts are rattlers and taken away, again and again; 0: 2 with "
          "friction, 4 without");
        f("close_gap", close_gap, io::between(0, 10), "a",
          "pairs whose surfaces are nearer are close: frictional_pair_fraction is the share of "
          "them that has frictional contacts");
        f("force_bin", force_bin, io::between(0.01, 10), "mean force",
          "width of the bins of the force distributions");
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        choice.validate(node, plan);
        plan.needs.plotted_pixels = size.pixels();
    }

    /// Distributions of the forces, if there are any.
    void write_forces(Context& context, const std::vector<Frame>& frames,
                      const std::string& title) const
    {
        const RelativeForces normal = normal_forces(frames), tangential = tangential_forces(frames);
        if (normal.frames.empty()) {
            context.results["forces"] = "no contacts, no distribution of forces";
            return;
        }
        constexpr int most_bins = 1000;
        const double largest = std::max(normal.largest, tangential.largest);
        const int bins = std::clamp(static_cast<int>(largest / force_bin) + 1, 1, most_bins);
        const Histogram n = histogram(normal.frames, 0, bins * force_bin, bins);
        const Histogram t = histogram(tangential.frames, 0, bins * force_bin, bins);
        io::write_file(context.folder.file(context.step_name + "_forces.csv"), forces_csv(n, t));
        render::Plot plot = size.plot();
        plot.title = title;
        plot.x.title = "force $F$/⟨$F$⟩";
        plot.y.title = "probability density";
        plot.x.minimum = 0;
        plot.y.logarithmic = true;
        plot.series.push_back(drawn(n, "normal", render::Marker::circle));
        if (t.frames > 0)
            plot.series.push_back(
                drawn(t, "tangential, frictional contacts", render::Marker::triangle));
        write_plot(context, context.step_name + "_forces", plot);
    }

    void write_shares(Context& context, const std::vector<Frame>& frames,
                      const std::string& title) const
    {
        const ContactShares shares = contact_shares(frames);
        io::write_file(context.folder.file(context.step_name + "_per_particle.csv"),
                       shares_csv(shares));
        render::Plot plot = size.plot();
        plot.title = title;
        plot.x.title = "contacts of a particle";
        plot.y.title = "share of the particles";
        plot.x.minimum = -0.5;
        plot.x.maximum = static_cast<double>(shares.share.size()) - 0.5;
        plot.y.minimum = 0;
        render::Series series;
        series.marker = render::Marker::circle;
        series.line_width = 1.5;
        for (std::size_t z = 0; z < shares.share.size(); ++z) {
            series.x.push_back(static_cast<double>(z));
            series.y.push_back(shares.share[z].mean);
            series.y_error.push_back(shares.share[z].standard_error);
        }
        plot.series.push_back(std::move(series));
        write_plot(context, context.step_name, plot);
    }

    void run(Context& context) const
    {
        const Run& run = context.run(choice.of);
        const auto [model, frames] = choice.read(context);
        if (frames.empty()) return;
        int least = rattler_contacts;
        if (least == 0) least = model.friction_static > 0 ? 2 : 4;
        const NetworkParameters parameters{.least_contacts = least, .close_gap = close_gap};
        std::vector<ContactNetwork> networks;
        for (const Frame& frame : frames) networks.push_back(contact_network(frame, parameters));
        io::write_file(context.folder.file(context.step_name + ".csv"),
                       frames_csv(frames, networks));

        context.results["rattlers_have_fewer_contacts_than"] = parameters.least_contacts;
        for (const NetworkField& field : network_fields()) {
            std::vector<double> series;
            for (const ContactNetwork& network : networks) series.push_back(network.*field.value);
            const Estimate estimate = estimate_mean(series);
            if (field.name == "contact_number")
                context.results["errors_reliable"] = estimate.reliable;
            context.results[std::string(field.name)] = estimate_json(estimate, field.unit);
        }
        Json fabric;
        for (const auto& [name, set] : contact_sets) {
            const std::vector<Mat3> tensors = fabric_tensors(frames, set);
            if (!tensors.empty()) fabric[name] = fabric_json(tensors);
        }
        if (!fabric.is_null()) {
            context.results["fabric_anisotropy"] = fabric["all"]["anisotropy"];
            context.results["fabric_angle"] = fabric["all"]["angle"];
            context.results["fabric"] = std::move(fabric);
        }
        const std::string title = title_text(run.volume_fraction, run.control, run.particles);
        write_shares(context, frames, title);
        write_forces(context, frames, title);
    }
};

}

StepKind contacts_step()
{
    return step_kind<Contacts>(
        "contacts",
        "contact numbers, rattlers, constraints, clusters, fabric and forces of the contacts");
}

}
