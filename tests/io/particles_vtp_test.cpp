#include "io/particles_vtp.h"

#include "io/atomic_file.h"
#include "tests/io/expect_error.h"
#include "tests/io/random_frame.h"
#include "tests/io/small_disk.h"

#include <gtest/gtest.h>

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkIdList.h>
#include <vtkInformation.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUtilities.h>
#include <bit>
#include <set>

namespace sigmaflow::io {
namespace {

using testing_io::expect_error;
using testing_io::TemporaryFolder;

Frame random_frame(int particles, int contacts, unsigned seed)
{
    return testing_io::random_frame(particles, contacts, seed, testing_io::Extremes::finite_norm);
}

std::set<std::string> names(vtkFieldData* data)
{
    std::set<std::string> result;
    for (int k = 0; k < data->GetNumberOfArrays(); ++k) result.insert(data->GetArrayName(k));
    return result;
}

/// Bitwise, so that -0 and denormals count.
void expect_same(double value, double expected, const std::string& what)
{
    EXPECT_EQ(std::bit_cast<std::uint64_t>(value), std::bit_cast<std::uint64_t>(expected)) << what;
}

vtkSmartPointer<vtkPolyData> through_file(const TemporaryFolder& folder,
                                          const vtkSmartPointer<vtkPolyData>& data)
{
    write_vtp(folder / "data.vtp", data);
    return read_vtp(folder / "data.vtp");
}

double field_value(vtkPolyData* data, const char* name, int component = 0)
{
    return data->GetFieldData()->GetArray(name)->GetComponent(component, 0);
}

TEST(ParticlesVtp, KeepsEveryNumberThroughTheFile)
{
    const TemporaryFolder folder;
    const Frame frame = random_frame(57, 20, 1);
    const auto data = through_file(folder, particles_polydata(frame));
    ASSERT_EQ(data->GetNumberOfPoints(), 57);
    ASSERT_EQ(data->GetNumberOfVerts(), 57);
    vtkPointData* points = data->GetPointData();
    for (vtkIdType p = 0; p < 57; ++p) {
        const auto k = static_cast<std::size_t>(p);
        for (int axis = 0; axis < 3; ++axis) {
            expect_same(data->GetPoint(p)[axis], frame.state.position[k][axis], "position");
            const auto component = [&](const char* name) {
                return points->GetArray(name)->GetComponent(p, axis);
            };
            expect_same(component("velocity"), frame.velocity[k][axis], "velocity");
            expect_same(component("nonaffine_velocity"), frame.nonaffine_velocity[k][axis], "na");
            expect_same(component("angular_velocity"), frame.angular_velocity[k][axis], "omega");
            for (int column = 0; column < 3; ++column)
                expect_same(points->GetArray("stress")->GetComponent(p, 3 * axis + column),
                            frame.particle_stress[k](axis, column), "stress");
        }
        expect_same(points->GetArray("radius")->GetComponent(p, 0), frame.state.radius[k],
                    "radius");
        expect_same(points->GetArray("nonaffine_speed")->GetComponent(p, 0),
                    frame.nonaffine_speed[k], "speed");
        EXPECT_EQ(points->GetArray("contact_number")->GetComponent(p, 0), frame.contact_number[k]);
        EXPECT_EQ(points->GetArray("species")->GetComponent(p, 0), frame.species[k]);
        EXPECT_EQ(points->GetArray("id")->GetComponent(p, 0), static_cast<double>(p));
    }
}

TEST(ParticlesVtp, HasTheArraysUnitsAndActiveScalarsThatParaViewUsersSee)
{
    const TemporaryFolder folder;
    const auto data = through_file(folder, particles_polydata(random_frame(5, 2, 2)));
    EXPECT_EQ(
        names(data->GetPointData()),
        (std::set<std::string>{"nonaffine_speed", "radius", "velocity", "nonaffine_velocity",
                               "angular_velocity", "contact_number", "species", "stress", "id"}));
    EXPECT_STREQ(data->GetPointData()->GetScalars()->GetName(), "nonaffine_speed");
    EXPECT_STREQ(data->GetPointData()->GetVectors()->GetName(), "velocity");
    vtkDataArray* stress = data->GetPointData()->GetArray("stress");
    ASSERT_EQ(stress->GetNumberOfComponents(), 9);
    EXPECT_STREQ(stress->GetComponentName(1), "XY");
    EXPECT_STREQ(stress->GetComponentName(8), "ZZ");
    EXPECT_STREQ(stress->GetInformation()->Get(vtkDataArray::UNITS_LABEL()), "sigma0 a^3");
}

TEST(ParticlesVtp, CarriesTheInstantAsFieldData)
{
    const TemporaryFolder folder;
    const Frame frame = random_frame(4, 1, 3);
    for (const auto& polydata : {particles_polydata(frame), contacts_polydata(frame)}) {
        const auto data = through_file(folder, polydata);
        expect_same(field_value(data, "TimeValue"), frame.state.strain, "TimeValue");
        expect_same(field_value(data, "strain"), frame.state.strain, "strain");
        expect_same(field_value(data, "time"), frame.state.time, "time");
        expect_same(field_value(data, "shear_rate"), frame.sample.shear_rate, "rate");
        expect_same(field_value(data, "shear_stress"), frame.sample.shear_stress, "stress");
        expect_same(field_value(data, "volume_fraction"), frame.volume_fraction, "phi");
        expect_same(field_value(data, "box_offset"), frame.state.box.offset, "offset");
        vtkDataArray* length = data->GetFieldData()->GetArray("box_length");
        ASSERT_EQ(length->GetNumberOfTuples(), 3);
        for (int axis = 0; axis < 3; ++axis)
            expect_same(length->GetComponent(axis, 0), frame.state.box.length[axis], "length");
    }
}

TEST(ContactsVtp, AreLinesFromCentreToCentreWithTheirForces)
{
    const TemporaryFolder folder;
    const Frame frame = random_frame(30, 17, 4);
    const auto data = through_file(folder, contacts_polydata(frame));
    ASSERT_EQ(data->GetNumberOfLines(), 17);
    EXPECT_EQ(names(data->GetCellData()),
              (std::set<std::string>{"normal_force", "tangential_force", "xi", "sliding",
                                     "frictional", "i", "j"}));
    EXPECT_STREQ(data->GetCellData()->GetScalars()->GetName(), "normal_force");
    vtkCellData* cells = data->GetCellData();
    for (vtkIdType c = 0; c < 17; ++c) {
        const ContactForce& contact = frame.contacts[static_cast<std::size_t>(c)];
        vtkNew<vtkIdList> ends;
        data->GetCellPoints(c, ends);
        ASSERT_EQ(ends->GetNumberOfIds(), 2);
        for (int axis = 0; axis < 3; ++axis) {
            expect_same(data->GetPoint(ends->GetId(0))[axis], contact.start[axis], "start");
            expect_same(data->GetPoint(ends->GetId(1))[axis], contact.end[axis], "end");
        }
        const auto value = [&](const char* name) {
            return cells->GetArray(name)->GetComponent(c, 0);
        };
        expect_same(value("normal_force"), contact.normal_force, "normal force");
        expect_same(value("tangential_force"), contact.tangential_force.norm(), "tangential force");
        expect_same(value("xi"), contact.xi, "xi");
        EXPECT_EQ(value("sliding"), contact.sliding);
        EXPECT_EQ(value("frictional"), contact.frictional);
        EXPECT_EQ(value("i"), contact.i);
        EXPECT_EQ(value("j"), contact.j);
        for (const vtkIdType end : {ends->GetId(0), ends->GetId(1)})
            expect_same(data->GetPointData()->GetArray("normal_force_point")->GetComponent(end, 0),
                        contact.normal_force, "point force");
    }
}

TEST(ContactsVtp, MayBeNone)
{
    const TemporaryFolder folder;
    const auto data = through_file(folder, contacts_polydata(random_frame(3, 0, 5)));
    EXPECT_EQ(data->GetNumberOfLines(), 0);
    EXPECT_EQ(data->GetNumberOfPoints(), 0);
    EXPECT_TRUE(data->GetCellData()->HasArray("normal_force"));
}

TEST(BoxVtp, HasTwelveEdgesOfTheBoxLengths)
{
    const TemporaryFolder folder;
    const auto data = through_file(folder, box_polydata({Vec3(2, 3, 5), 0.7}));
    ASSERT_EQ(data->GetNumberOfLines(), 12);
    double total = 0;
    for (vtkIdType line = 0; line < 12; ++line) {
        vtkNew<vtkIdList> ends;
        data->GetCellPoints(line, ends);
        const Vec3 from(data->GetPoint(ends->GetId(0)));
        total += (Vec3(data->GetPoint(ends->GetId(1))) - from).norm();
    }
    EXPECT_DOUBLE_EQ(total, 4 * (2 + 3 + 5));
    double bounds[6];
    data->GetBounds(bounds);
    EXPECT_EQ(std::vector<double>(bounds, bounds + 6), (std::vector<double>{0, 2, 0, 3, 0, 5}));
}

TEST(ParticlesVtp, RefusesAFrameWithMissingNumbers)
{
    Frame frame = random_frame(3, 0, 6);
    frame.velocity.pop_back();
    expect_error(ErrorKind::internal, {"3 entries, got 2"}, [&] { particles_polydata(frame); });
}

TEST(WriteVtp, StoresInlineBinaryBecauseParaViewOfDebian12ReadsNoAppendedData)
{
    const TemporaryFolder folder;
    write_vtp(folder / "data.vtp", particles_polydata(random_frame(200, 50, 7)));
    const std::string text = read_file(folder / "data.vtp");
    EXPECT_NE(text.find("format=\"binary\""), std::string::npos);
    EXPECT_NE(text.find("vtkZLibDataCompressor"), std::string::npos);
    EXPECT_EQ(text.find("format=\"appended\""), std::string::npos);
    EXPECT_EQ(text.find("format=\"ascii\""), std::string::npos);
}

TEST(WriteVtp, ReportsWhatCannotBeWritten)
{
    const TemporaryFolder folder;
    const auto data = particles_polydata(random_frame(1000, 50, 8));
    write_file(folder / "file", "");
    expect_error(ErrorKind::file, {"file/data.vtp", "Not a directory"},
                 [&] { write_vtp(folder / "file/data.vtp", data); });
    const int code =
        testing_io::with_file_size_limit(20000, [&] { write_vtp(folder / "data.vtp", data); });
    EXPECT_EQ(code, static_cast<int>(ErrorKind::no_space));
    EXPECT_EQ(folder.files(), std::vector<std::string>{"file"});
}

TEST(ReadVtp, RefusesForeignAndBrokenFilesQuietly)
{
    const TemporaryFolder folder;
    write_vtp(folder / "good.vtp", particles_polydata(random_frame(10, 0, 9)));
    const std::string good = read_file(folder / "good.vtp");
    testing::internal::CaptureStderr();
    write_file(folder / "text.vtp", "not xml at all");
    write_file(folder / "half.vtp", good.substr(0, good.size() / 2));
    write_file(folder / "empty.vtp", "");
    for (const std::string name : {"text.vtp", "half.vtp", "empty.vtp"})
        expect_error(ErrorKind::input, {name, "must be VTK polydata"},
                     [&] { read_vtp(folder / name); });
    expect_error(ErrorKind::missing, {"none.vtp"}, [&] { read_vtp(folder / "none.vtp"); });
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(WritePvd, IsWellFormedAndHasTheExactTimes)
{
    const TemporaryFolder folder;
    const std::vector<SeriesEntry> entries{
        {0, "frames/particles_0000.vtp"}, {0.1, "a&b<c>\"d\".vtp"}, {1.0 / 3, "last.vtp"}};
    write_pvd(folder / "series.pvd", entries);
    const auto root = vtkSmartPointer<vtkXMLDataElement>::Take(
        vtkXMLUtilities::ReadElementFromFile((folder / "series.pvd").c_str()));
    ASSERT_NE(root, nullptr);
    EXPECT_STREQ(root->GetAttribute("type"), "Collection");
    vtkXMLDataElement* collection = root->FindNestedElementWithName("Collection");
    ASSERT_NE(collection, nullptr);
    ASSERT_EQ(collection->GetNumberOfNestedElements(), 3);
    for (int k = 0; k < 3; ++k) {
        vtkXMLDataElement* element = collection->GetNestedElement(k);
        EXPECT_STREQ(element->GetName(), "DataSet");
        const SeriesEntry& entry = entries[static_cast<std::size_t>(k)];
        EXPECT_EQ(std::stod(element->GetAttribute("timestep")), entry.time);
        EXPECT_EQ(element->GetAttribute("file"), entry.file);
    }
}

}
}
