#include "io/atomic_file.h"
#include "io/json_document.h"
#include "io/particles_vtp.h"

#include <vtkCallbackCommand.h>
#include <vtkExecutive.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>
#include <cctype>
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

vtkSmartPointer<vtkPolyData> read_vtp(const std::filesystem::path& path)
{
    std::string message;
    const auto command = listener(message);
    vtkNew<vtkXMLPolyDataReader> reader;
    reader->AddObserver(vtkCommand::ErrorEvent, command);
    reader->SetReaderErrorObserver(command);
    reader->SetParserErrorObserver(command);
    reader->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, command);
    reader->ReadFromInputStringOn();
    reader->SetInputString(read_file(path));
    reader->Update();
    vtkSmartPointer<vtkPolyData> data = reader->GetOutput();
    if (!message.empty() || reader->GetErrorCode() != 0)
        throw Error(ErrorKind::input, path.string(), "must be VTK polydata: " + essence(message));
    return data;
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
