#include "io/atomic_file.h"
#include "io/json_document.h"
#include "io/particles_vtp.h"

#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkExecutive.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

namespace sigmaflow::io {
namespace {

/// Keeps what VTK would print: the first error.
void keep_message(vtkObject*, unsigned long, void* message, void* text)
{
    auto& kept = *static_cast<std::string*>(message);
    if (kept.empty() && text != nullptr) kept = static_cast<const char*>(text);
}

vtkNew<vtkCallbackCommand> listener(std::string& message)
{
    vtkNew<vtkCallbackCommand> command;
    command->SetCallback(keep_message);
    command->SetClientData(&message);
    return command;
}

/// The message without "ERROR: In <source file>, line <n>" and "<class> (<address>):".
std::string essence(const std::string& message)
{
    const std::size_t address = message.rfind("): ");
    std::string text = address == std::string::npos ? message : message.substr(address + 3);
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
    return text.empty() ? "unknown reason" : text;
}

std::string escaped(const std::string& text)
{
    std::string result;
    for (const char c : text) {
        if (c == '&')
            result += "&amp;";
        else if (c == '<')
            result += "&lt;";
        else if (c == '"')
            result += "&quot;";
        else
            result += c;
    }
    return result;
}

}

void write_vtp(const std::filesystem::path& path, vtkPolyData* data)
{
    std::string message;
    const auto command = listener(message);
    vtkNew<vtkXMLPolyDataWriter> writer;
    writer->AddObserver(vtkCommand::ErrorEvent, command);
    writer->SetInputData(data);
    writer->SetDataModeToBinary();
    writer->SetCompressorTypeToZLib();
    writer->WriteToOutputStringOn();  // the file itself is written in one way for all formats
    if (writer->Write() == 0)
        throw Error(ErrorKind::file, path.string(), "cannot be written: " + essence(message));
    write_file(path, writer->GetOutputString());
}

namespace {

std::string place(const std::filesystem::path& path, const std::string& text, std::size_t offset)
{
    const auto begin = text.begin(), here = begin + static_cast<std::ptrdiff_t>(offset);
    const auto lines = std::count(begin, here, '\n');
    const std::size_t line_break = offset == 0 ? std::string::npos : text.rfind('\n', offset - 1);
    const std::size_t column = line_break == std::string::npos ? offset + 1 : offset - line_break;
    return path.string() + ':' + std::to_string(lines + 1) + ':' + std::to_string(column);
}

/// What makes XML parsers run for ever: definitions that grow without end or name other files (VTK
/// writes none), tags without end, and endless numbers of tags.
void check_xml(const std::string& text, const std::filesystem::path& path)
{
    constexpr std::size_t longest_tag = 4096, most_tags = 10'000;
    const auto refuse = [&](std::size_t offset, const std::string& problem) {
        throw Error(ErrorKind::input, place(path, text, offset), problem);
    };
    const std::size_t end = std::min(text.find("<AppendedData"), text.size());
    std::size_t tags = 0;
    for (std::size_t at = text.find('<'); at < end; at = text.find('<', at + 1)) {
        if (text.compare(at, 9, "<!DOCTYPE") == 0 || text.compare(at, 8, "<!ENTITY") == 0)
            refuse(at, "must not define XML entities");
        if (std::min(text.find('>', at), text.size()) - at > longest_tag)
            refuse(at,
                   "must not have a tag of more than " + std::to_string(longest_tag) + " bytes");
        if (++tags > most_tags)
            refuse(at, "must not have more than " + std::to_string(most_tags) + " tags");
    }
}

}

vtkSmartPointer<vtkPolyData> read_vtp(const std::filesystem::path& path)
{
    const std::string text = read_file(path);
    check_xml(text, path);
    std::string message;
    const auto command = listener(message);
    vtkNew<vtkXMLPolyDataReader> reader;
    reader->AddObserver(vtkCommand::ErrorEvent, command);
    reader->SetReaderErrorObserver(command);
    reader->SetParserErrorObserver(command);
    reader->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, command);
    reader->ReadFromInputStringOn();
    reader->SetInputString(text);
    reader->Update();
    vtkSmartPointer<vtkPolyData> data = reader->GetOutput();
    if (!message.empty() || reader->GetErrorCode() != 0)
        throw Error(ErrorKind::input, path.string(), "must be VTK polydata: " + essence(message));
    return data;
}

namespace {

/// Number of arrays; each must have one entry for each of `count` points or cells.
std::size_t check_arrays(vtkDataSetAttributes* data, vtkIdType count, const std::string& where)
{
    for (int k = 0; k < data->GetNumberOfArrays(); ++k) {
        vtkAbstractArray* array = data->GetAbstractArray(k);
        if (array->GetNumberOfTuples() != count)
            throw Error(ErrorKind::input, where + ": " + (array->GetName() ? array->GetName() : ""),
                        "must have " + std::to_string(count) + " entries, got " +
                            std::to_string(array->GetNumberOfTuples()));
    }
    return static_cast<std::size_t>(data->GetNumberOfArrays());
}

/// Every cell must have points that exist.
void check_cells(vtkPolyData* data, const std::string& where)
{
    vtkNew<vtkIdList> ids;
    for (vtkCellArray* cells :
         {data->GetVerts(), data->GetLines(), data->GetPolys(), data->GetStrips()}) {
        if (cells == nullptr || !cells->IsValid())
            throw Error(ErrorKind::input, where, "offsets must ascend within the connectivity");
        for (vtkIdType cell = 0; cell < cells->GetNumberOfCells(); ++cell) {
            cells->GetCellAtId(cell, ids);
            for (vtkIdType k = 0; k < ids->GetNumberOfIds(); ++k)
                if (ids->GetId(k) < 0 || ids->GetId(k) >= data->GetNumberOfPoints())
                    throw Error(ErrorKind::input, where,
                                "must be points >= 0 and < " +
                                    std::to_string(data->GetNumberOfPoints()) + ", got " +
                                    std::to_string(ids->GetId(k)));
        }
    }
}

}

VtpSummary check_vtp(const std::filesystem::path& path)
{
    const vtkSmartPointer<vtkPolyData> data = read_vtp(path);
    if (data->GetPoints() == nullptr)
        throw Error(ErrorKind::input, path.string() + ": Points", "must be numbers, three a point");
    for (vtkIdType k = 0; k < data->GetNumberOfPoints(); ++k) {
        const double* point = data->GetPoint(k);
        if (!std::isfinite(point[0]) || !std::isfinite(point[1]) || !std::isfinite(point[2]))
            throw Error(ErrorKind::input, path.string() + ": Points",
                        "must be finite, point " + std::to_string(k) + " is not");
    }
    check_cells(data, path.string() + ": connectivity");
    VtpSummary summary;
    summary.points = static_cast<std::size_t>(data->GetNumberOfPoints());
    summary.cells = static_cast<std::size_t>(data->GetNumberOfCells());
    summary.arrays =
        check_arrays(data->GetPointData(), data->GetNumberOfPoints(),
                     path.string() + ": PointData") +
        check_arrays(data->GetCellData(), data->GetNumberOfCells(), path.string() + ": CellData");
    return summary;
}

void write_pvd(const std::filesystem::path& path, const std::vector<SeriesEntry>& entries)
{
    std::string text =
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
        "  <Collection>\n";
    for (const SeriesEntry& entry : entries)
        text += "    <DataSet timestep=\"" + number_text(entry.time) + "\" part=\"0\" file=\"" +
                escaped(entry.file) + "\"/>\n";
    text += "  </Collection>\n</VTKFile>\n";
    write_file(path, text);
}

}
